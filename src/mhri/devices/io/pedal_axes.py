# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pedals that the system sees as joysticks, such as rudder pedals, read through pygame."""
import time

from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reading
from mhri.devices.io.sdl import Joysticks
from mhri.devices.pads import usb_of_guid
from mhri.devices.pedal_choice import Candidate
from mhri.devices.pedals import AXES, DRIVE, PedalState


def candidate_of(info):
    """Return the :class:`Candidate` for a joystick, a :class:`mhri.devices.pads.PadInfo`."""
    places = (info.guid, 'joystick {}'.format(info.index))
    return Candidate(AXES, usb_of_guid(info.guid), info.name,
                     tuple(place for place in places if place))


class PedalAxes:
    """The joysticks of this computer, one of which may be open as pedals.

    :param role: DRIVE or ENABLE
    :param joysticks: stands in for :class:`mhri.devices.io.sdl.Joysticks`
    """

    def __init__(self, role=DRIVE, joysticks=None):
        self._role = role
        self._joysticks = joysticks or Joysticks()
        self._infos = {}
        self._joystick = None
        self._profile = None
        self._state = None
        self._last = None

    def look(self):
        """Return a :class:`Candidate` for each connected joystick.

        :raises DeviceAbsent: pygame or SDL cannot be used
        """
        self._infos = {candidate_of(info): info for info in self._joysticks.look()}
        return list(self._infos)

    def open(self, candidate, profile):
        """Open a candidate of the last :meth:`look`.

        :raises DeviceAbsent: it cannot be opened, or has too few axes
        """
        self.close()
        self._joystick = self._joysticks.open(self._infos[candidate])
        needed = max(pedal.axis for pedal in profile.pedals) + 1
        if self._joystick.axis_count < needed:
            count = self._joystick.axis_count
            self.close()
            raise DeviceAbsent('{} has {} axes, and profile {} needs {}: set ~profile to one that '
                               'fits'.format(candidate, count, profile.name, needed))
        self._profile = profile
        self._state = PedalState(profile, self._role)

    @property
    def note(self):
        """The operator's action needed before every pedal counts, or ''."""
        return self._state.note() if self._state else ''

    def read(self, timeout_s):
        """Return the next reading; None until every axis has reported.

        :raises DeviceLost: the pedals are gone
        """
        if self._joystick is None:
            raise DeviceLost('no pedals are open')
        deadline = time.monotonic() + timeout_s
        while True:
            result = self._state.read(self._profile.from_axes(self._joystick.state()[0]))
            if result is not None and result != self._last:
                self._last = result
                return Reading(*result, self._state.named)
            left_s = deadline - time.monotonic()
            if left_s <= 0.0:
                return None
            self._joystick.wait(left_s)

    def close(self):
        """Release the pedals; does nothing if none are open."""
        joystick, self._joystick, self._last = self._joystick, None, None
        if joystick is not None:
            joystick.close()
