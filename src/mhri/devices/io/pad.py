# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pad as an input device: choice of pad and profile, and its readings.

Axes are the raw values of SDL, in [-1, 1]. Hats follow as two axes each (right +1, down +1) and as
four buttons each (up, right, down, left), after the axes and buttons of the device.
"""
import logging
import threading
import time

from mhri.devices.io.event_nodes import find_pads
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reader, Reading, CachedLookup
from mhri.devices.io.sdl import Joysticks
from mhri.devices.pads import choose_pad, choose_profile, is_chosen, only_pads, with_labels

_LOG = logging.getLogger(__name__)

RUMBLE_STRENGTH = 0.8
RUMBLE_S = 0.5
# Period of listing the other pads [s].
LOOK_S = 2.0


class PadReader(Reader):
    """Opens the wanted pad and reads it; call :meth:`choose` and :meth:`rumble` on any thread.

    :param profiles: function that returns every :class:`Profile` in the order of preference;
        called whenever a pad is opened, so that a new profile needs no restart
    :param joysticks: stands in for :class:`mhri.devices.io.sdl.Joysticks`
    :param clock: function that returns monotonic seconds
    """

    kind = 'pad'

    def __init__(self, profiles, joysticks=None, clock=time.monotonic):
        self._profiles = profiles
        self._joysticks = joysticks or Joysticks()
        self._clock = clock
        self._wanted = ''
        self._opened_for = ''
        self._rumble = threading.Event()
        self._pad = None
        self._profile = None
        self._driving = ()
        self._rest = ()
        self._last = None
        self._choice = ''
        self._available, self._look_at = (), 0.0
        self.note = ''
        self.name = ''
        self._find = CachedLookup(self._found)

    def choose(self, device):
        """Choose the pad by a part of its name, its GUID or its index; '' is any pad.

        Takes effect within 50 ms: another open pad is treated like a lost one.
        """
        self._wanted = str(device).strip()

    def rumble(self):
        """Shake the pad once, if one is open and can shake."""
        self._rumble.set()

    def find(self):
        """Name the connected pad; see :class:`mhri.devices.io.reader.Reader`."""
        return self._find(self._wanted, find_pads())

    def _found(self, wanted, pads):
        """Return the name of the pad to open."""
        try:
            return choose_pad(wanted, pads, self._profiles()).label
        except LookupError as problem:
            raise DeviceAbsent(str(problem))

    def available(self):
        """Name all connected pads; see :class:`mhri.devices.io.reader.Reader`."""
        now = self._clock()
        if now >= self._look_at:
            self._look_at = now + LOOK_S
            pads = with_labels(only_pads(find_pads()))
            self._available = tuple(pad.label for pad in pads)
            if self._pad is not None:
                self._update_name(pads)
        return self._available

    def _update_name(self, pads):
        """Update the label of the open pad: it depends on the other pads."""
        own = self._pad.info
        self.name = next((pad.label for pad in pads if pad.full_name == own.full_name), self.name)

    def open(self):
        """Open the pad; see :class:`mhri.devices.io.reader.Reader`."""
        self.note = ''
        self._opened_for = self._wanted
        profiles = self._profiles()
        try:
            info = choose_pad(self._opened_for, self._joysticks.look(), profiles)
            profile, note = choose_profile(profiles, info.name, info.guid)
        except LookupError as problem:
            raise DeviceAbsent(str(problem))
        self._pad = self._joysticks.open(info)
        self._profile = profile
        self._driving = (profile.forward.index, profile.turn.index)
        if max(self._driving) >= self._pad.axis_count:
            raise DeviceAbsent('{} has {} axes, and profile {} needs {}: calibrate it on '
                               'the page Pad, or choose another one'.format(
                                   info.name, self._pad.axis_count, profile.name,
                                   max(self._driving) + 1))
        self._rest = rest_of(profile, self._pad.axis_count)
        self._last = None
        self._rumble.clear()
        self._choice = self.note = note
        self.name = info.label
        self._look_at = 0.0
        return '{} with profile {}'.format(info.label, profile.name)

    def read(self, timeout_s):
        """Wait for a change; see :class:`mhri.devices.io.reader.Reader`."""
        deadline = self._clock() + timeout_s
        while True:
            self._apply_requests()
            state = self._pad.state()
            if state != self._last and self._is_known(state[0]):
                self._last = state
                return Reading(tuple(value or 0.0 for value in state[0]), state[1],
                               self._profile.name, self._rest)
            left_s = deadline - self._clock()
            if left_s <= 0.0:
                return None
            self._pad.wait(left_s)

    def _apply_requests(self):
        """Apply the requests of other threads.

        :raises DeviceLost: another pad is wanted
        """
        if self._wanted != self._opened_for:
            if (self._wanted.isdigit() or not is_chosen(self._wanted, self._pad.info)
                    or self._wanted != self.name and self._wanted in self.available()):
                raise DeviceLost('another pad was chosen: {}'.format(self._wanted))
            self._opened_for = self._wanted
        if self._rumble.is_set():
            self._rumble.clear()
            if not self._pad.rumble(RUMBLE_STRENGTH, RUMBLE_S):
                _LOG.debug('%s cannot rumble', self._pad.info.name)

    def _is_known(self, axes):
        """Return whether the driving axes have reported; an assumed 0 could move a robot."""
        unknown = sorted({index for index in self._driving if axes[index] is None})
        self.note = 'move the stick once: nothing is known yet of axis {}'.format(
            ' and '.join(map(str, unknown))) if unknown else self._choice
        return not unknown

    def close(self):
        """Close the pad; see :class:`mhri.devices.io.reader.Reader`."""
        pad, self._pad, self.note, self.name = self._pad, None, '', ''
        self._look_at = 0.0
        if pad is not None:
            pad.close()


def rest_of(profile, axis_count):
    """Return the values of all axes of a released pad, () if all are 0."""
    rest = [0.0] * axis_count
    for axis in (profile.forward, profile.turn):
        rest[axis.index] = axis.rest
    return tuple(rest) if any(rest) else ()
