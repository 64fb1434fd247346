# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parts of the screen, one per row, in order of appearance."""
from typing import Tuple

# (key, class): see :mod:`mhri.base.part`.
PARTS: Tuple[Tuple[str, str], ...] = (
    ('events', 'mhri.events.presenters.event_presenter.EventPresenter'),
    ('tasks', 'mhri.tasks.presenters.task_presenter.TaskPresenter'),
    ('accessories', 'mhri.accessories.presenters.accessory_presenter.AccessoryPresenter'),
    ('headset', 'mhri.web.presenters.head_presenter.HeadPresenter'),
    ('map', 'mhri.map.presenters.map_presenter.MapPresenter'),
    ('session', 'mhri.session.presenters.session_presenter.SessionPresenter'),
    ('doctor', 'mhri.doctor.presenters.doctor_presenter.DoctorPresenter'),
    ('pad', 'mhri.devices.presenters.pad_presenter.PadPresenter'),
    ('faults', 'mhri.drill.presenters.fault_presenter.FaultPresenter'),
    ('drill', 'mhri.drill.presenters.drill_presenter.DrillPresenter'),
    ('sessions', 'mhri.session.presenters.session_presenter.LibraryPresenter'),
    ('web', 'mhri.web.presenters.web_presenter.WebPresenter'),
)
