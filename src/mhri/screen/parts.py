# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The optional parts of the screen, a row each, in the order in which they appear."""
from typing import Tuple

# (key, class): see :mod:`mhri.base.part`.
PARTS: Tuple[Tuple[str, str], ...] = (
    ('session', 'mhri.session.presenters.session_host.SessionHost'),
    ('doctor', 'mhri.doctor.presenters.doctor_host.DoctorHost'),
    ('pad', 'mhri.devices.presenters.pad_host.PadHost'),
    ('faults', 'mhri.drill.presenters.fault_host.FaultHost'),
    ('drill', 'mhri.drill.presenters.drill_host.DrillHost'),
    ('shelf', 'mhri.session.presenters.session_host.ShelfHost'),
)
