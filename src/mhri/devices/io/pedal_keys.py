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

# How long each reading stays the newest [s]: a little more than the shortest time between two
# messages, so that none is replaced before it has been published.
_HOLD_S = 0.012


class _Node:
    """One open event node of a switch, and which of its keys are down.

    It is grabbed as soon as no key is down: otherwise nobody else would see the release of a key
    pressed before, and a desktop would repeat it without end.
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
        """Return what can be waited on."""
        return self._device.fd

    def reports(self):
        """Read what has come; yield once for each complete report in which a key changed.

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
        """Take in a key; return whether its state changed. A 2 is a repetition, not a press."""
        before = len(self.down)
        if event.value == 1:
            self.down.add(event.code)
        elif event.value == 0:
            self.down.discard(event.code)
        return len(self.down) != before

    def _read_again(self):
        """After lost events ask the kernel which keys are down; return whether that is a change."""
        if not self._dropped:
            return False
        self._dropped = False
        before, self.down = self.down, set(self._device.active_keys())
        return before != self.down

    def _grab(self):
        """Grab the device for this program alone, once nothing is pressed."""
        if not self._grabbed and not self.down:
            self._device.grab()
            self._grabbed = True

    def close(self):
        """Close it, which also ends the grab."""
        self._device.close()


class PedalKeys:
    """The foot switches of this computer, one of which may be open.

    :param role: DRIVE or ENABLE
    :param clock: function returning seconds that never go back
    """

    def __init__(self, role=DRIVE, clock=time.monotonic):
        self._role = role
        self._clock = clock
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

        :raises DeviceAbsent: it may not be opened, is grabbed by another, or gone by now
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
        """What the operator must do before every pedal counts, '' if nothing."""
        return self._state.note() if self._state else ''

    def _take(self):
        """Turn what is held now into a reading, and queue it if it is new."""
        held = set().union(*(node.down for node in self._nodes))
        names = {name for name, code in self._codes.items() if code in held}
        axes, buttons = self._state.read(self._profile.from_keys(names))
        reading = Reading(axes, buttons)
        if reading != self._last:
            self._last = reading
            self._queue(reading)

    def _queue(self, reading):
        """Keep a reading until it is asked for, and one that was left behind by it.

        However fast a pedal chatters, what it shows now is never more than one reading away. Of
        those in between the first is kept; under a foot rather one with everything released.
        """
        if len(self._waiting) == 2:
            first, second = self._waiting
            pressed = self._given is not None and any(self._given.buttons)
            lifted = pressed and any(first.buttons) and not any(second.buttons)
            self._waiting = [second if lifted else first]
        self._waiting.append(reading)
        while self._waiting and self._waiting[0] in [self._given] + self._waiting[1:]:
            # No news any more: what lay in between has been left out.
            del self._waiting[0]

    def read(self, timeout_s):
        """Return the next reading, even one that lasted shorter than a message.

        :raises DeviceLost: the switch is gone, or was taken away by another program
        """
        if not self._nodes:
            raise DeviceLost('no foot switch is open')
        deadline = self._clock() + timeout_s
        self._wait(0.0)
        while not self._due() and self._clock() < deadline:
            until = min(deadline, self._next_at) if self._waiting else deadline
            self._wait(until - self._clock())
        if not self._due():
            return None
        self._next_at = self._clock() + _HOLD_S
        self._given = self._waiting.pop(0)
        return self._given

    def _due(self):
        """Tell whether a reading can be returned."""
        return bool(self._waiting) and self._clock() >= self._next_at

    def _wait(self, timeout_s):
        """Wait for the nodes, and take in what they say."""
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
        """Give the switch back to the desktop; forget its state."""
        for node in self._nodes:
            node.close()
        self._nodes = []
        self._last = self._given = None
        self._waiting = []
        self._next_at = 0.0


def key_codes(profile):
    """Return {name: code} of all keys of a profile.

    :raises DeviceAbsent: the kernel knows no key of that name
    """
    names = [name for pedal in profile.pedals for name in pedal.keys]
    for name in names:
        if name not in ecodes.ecodes:
            raise DeviceAbsent('profile {}: there is no key {!r} (evtest shows the names)'.format(
                profile.name, name))
    return {name: ecodes.ecodes[name] for name in names}


def _reason(error):
    """Return why a device could not be opened, and what to do about it."""
    if error.errno in (errno.EACCES, errno.EPERM):
        return _REMEDY
    if error.errno == errno.EBUSY:
        return 'another program has grabbed it (a second mhri_pedal, or a key remapper?); end that'
    return error.strerror or str(error)
