# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot switches, which the system sees as keyboards, read through evdev.

The device is grabbed, so that the pedals do not type into an open window, and released on close.
Only the chosen one is grabbed: see :func:`mhri.devices.pedal_choice.choose`.
"""
import errno
import math
import os
import select
import time

import evdev
from evdev import ecodes

from mhri.devices.io.event_nodes import find_switches
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reading
from mhri.devices.pedal_choice import Candidate
from mhri.devices.pedals import DRIVE, KEYS, PedalState

_REMEDY = ('permission denied. Put yourself into the group input (sudo usermod -aG input $USER) '
           'and log in anew, or install the rule resource/pedals/70-mhri-pedals.rules as '
           'doc/input_pedal.md says')

# Minimum duration of a reading [s]: a little more than the minimum period of messages, so that each
# is published before the next replaces it.
_HOLD_S = 0.012


class _Node:
    """One open event node of a switch, and its pressed keys.

    It is grabbed as soon as no key is down: otherwise the desktop would miss the release of a key
    pressed earlier, and repeat it endlessly.
    """

    def __init__(self, path):
        self.path = path
        self._device = evdev.InputDevice(path)
        self._grabbed = False
        self._dropped = False
        self._changed = False
        try:
            self.down = set(self._device.active_keys())
            self._grab()
        except OSError:
            self.close()
            raise

    def fileno(self):
        """Return the descriptor to poll."""
        return self._device.fd

    def reports(self):
        """Read the pending events; yield once for each complete report in which a key changed.

        :raises OSError: the device is gone (ENODEV), or another program has grabbed it (EBUSY)
        """
        for event in self._device.read():
            if event.type == ecodes.EV_KEY and not self._dropped:
                self._changed |= self._key(event)
            elif event.type == ecodes.EV_SYN and event.code == ecodes.SYN_DROPPED:
                self._dropped = True
            elif event.type == ecodes.EV_SYN and event.code == ecodes.SYN_REPORT:
                self._changed |= self._read_again()
                if self._changed:
                    self._changed = False
                    self._grab()
                    yield

    def _key(self, event):
        """Handle a key event; return whether its state changed. Value 2 is an auto-repeat."""
        before = len(self.down)
        if event.value == 1:
            self.down.add(event.code)
        elif event.value == 0:
            self.down.discard(event.code)
        return len(self.down) != before

    def _read_again(self):
        """After lost events read the pressed keys from the kernel; return whether they changed."""
        if not self._dropped:
            return False
        self._dropped = False
        before, self.down = self.down, set(self._device.active_keys())
        return before != self.down

    def _grab(self):
        """Grab the device exclusively once nothing is pressed."""
        if not self._grabbed and not self.down:
            self._device.grab()
            self._grabbed = True

    def close(self):
        """Close the node, which also ends the grab."""
        self._device.close()


class PedalKeys:
    """The foot switches of this computer, one of which may be open.

    :param role: DRIVE or ENABLE
    """

    def __init__(self, role=DRIVE):
        self._role = role
        self._nodes = []
        self._profile = None
        self._state = None
        self._codes = {}
        self._last = None
        self._given = None
        self._waiting = []
        self._next_at = 0.0

    def look(self):
        """Return a :class:`Candidate` for each connected device with keys."""
        return [Candidate(KEYS, switch.usb, switch.name, switch.paths)
                for switch in find_switches()]

    def open(self, candidate, profile):
        """Open and grab a switch.

        :raises DeviceAbsent: permission is missing, another program has grabbed it, or it is gone
        """
        self.close()
        self._codes = key_codes(profile)
        try:
            for path in candidate.places:
                self._nodes.append(_Node(path))
        except OSError as error:
            self.close()
            raise DeviceAbsent('{} is there, but cannot be opened: {}'.format(
                candidate, _reason(error)))
        self._profile = profile
        self._state = PedalState(profile, self._role)
        self._take()

    @property
    def note(self):
        """The operator's action needed before every pedal counts, or ''."""
        return self._state.note() if self._state else ''

    def _take(self):
        """Convert the pressed keys to a reading, and queue it if it is new."""
        held = set().union(*(node.down for node in self._nodes))
        names = {name for name, code in self._codes.items() if code in held}
        axes, buttons = self._state.read(self._profile.from_keys(names))
        reading = Reading(axes, buttons, self._state.named)
        if reading != self._last:
            self._last = reading
            self._queue(reading)

    def _queue(self, reading):
        """Queue a reading behind at most one other.

        However fast a pedal chatters, its present state is at most one reading away. Of the
        readings in between the first is kept; while pressed, preferably one with everything
        released.
        """
        if len(self._waiting) == 2:
            first, second = self._waiting
            pressed = self._given is not None and any(self._given.buttons)
            lifted = pressed and any(first.buttons) and not any(second.buttons)
            self._waiting = [second if lifted else first]
        self._waiting.append(reading)
        while self._waiting and self._waiting[0] in [self._given] + self._waiting[1:]:
            # A repetition, since the readings in between were dropped.
            del self._waiting[0]

    def read(self, timeout_s):
        """Return the next reading, even one shorter than the period of messages.

        :raises DeviceLost: the switch is gone, or another program has grabbed it
        """
        if not self._nodes:
            raise DeviceLost('no foot switch is open')
        deadline = time.monotonic() + timeout_s
        self._wait(0.0)
        while not self._due() and time.monotonic() < deadline:
            until = min(deadline, self._next_at) if self._waiting else deadline
            self._wait(until - time.monotonic())
        if not self._due():
            return None
        self._next_at = time.monotonic() + _HOLD_S
        self._given = self._waiting.pop(0)
        return self._given

    def _due(self):
        """Return whether a reading can be returned."""
        return bool(self._waiting) and time.monotonic() >= self._next_at

    def _wait(self, timeout_s):
        """Wait for the nodes, and handle their reports."""
        poller = select.poll()
        nodes = {node.fileno(): node for node in self._nodes}
        for number in nodes:
            poller.register(number, select.POLLIN)
        for number, events in poller.poll(math.ceil(max(0.0, timeout_s) * 1000.0)):
            try:
                if events & ~select.POLLIN:
                    raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
                for _ in nodes[number].reports():
                    self._take()
            except BlockingIOError:
                continue
            except OSError as error:
                self.close()
                raise DeviceLost('the foot switch {}'.format(
                    'has been unplugged' if error.errno in (errno.ENODEV, errno.EIO)
                    else 'cannot be read any more: ' + _reason(error)))

    def close(self):
        """Release the switch to the desktop, and forget its state."""
        for node in self._nodes:
            node.close()
        self._nodes = []
        self._last = self._given = None
        self._waiting = []
        self._next_at = 0.0


def key_codes(profile):
    """Return {name: code} of all keys of a profile.

    :raises DeviceAbsent: the kernel has no key with that name
    """
    names = [name for pedal in profile.pedals for name in pedal.keys]
    for name in names:
        if name not in ecodes.ecodes:
            raise DeviceAbsent('profile {}: there is no key {!r} (evtest shows the names)'.format(
                profile.name, name))
    return {name: ecodes.ecodes[name] for name in names}


def _reason(error):
    """Return why a device could not be opened, and the remedy."""
    if error.errno in (errno.EACCES, errno.EPERM):
        return _REMEDY
    if error.errno == errno.EBUSY:
        return 'another program has grabbed it (a second mhri_pedal, or a key remapper?); end that'
    return error.strerror or str(error)
