# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The foot pedal as an input device: which one, of whichever kind, and its readings.

Axes and buttons are those of the contract (see :mod:`mhri.devices.pedals`), whatever the
device, so that they need no profile.
"""
import os

from mhri.devices.io.event_nodes import find_pads
from mhri.devices.io.pedal_axes import candidate_of, PedalAxes
from mhri.devices.io.pedal_keys import PedalKeys
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reader, Remembered
from mhri.devices.pedal_choice import choose, NoPedal, Wish
from mhri.devices.pedals import AXES, DRIVE, KEYS


def _resolved(wish, candidates):
    """Return a wish with a link to a device (as in /dev/input/by-id) resolved."""
    if wish.device.startswith('/'):
        for path in (place for item in candidates for place in item.places):
            if os.path.realpath(path) == os.path.realpath(wish.device):
                return Wish(path, wish.profile)
    return wish


class PedalReader(Reader):
    """Opens the wanted pedal and reads it; call the ``want_`` methods on any thread.

    :param profiles: function returning {name: PedalProfile}; called whenever a pedal is looked
        for, so that a new profile needs no restart
    :param role: DRIVE or ENABLE
    :param sources: {kind: PedalKeys or PedalAxes}, None for the shipped ones
    """

    kind = 'foot pedal'

    def __init__(self, profiles, role=DRIVE, sources=None):
        self._profiles = profiles
        self._wish = self._opened_for = Wish()
        self._sources = sources or {KEYS: PedalKeys(role), AXES: PedalAxes(role)}
        self._open = None
        self.name = ''
        self._find = Remembered(self._found)

    def want_device(self, device):
        """Choose the pedal: see :class:`Wish`; '' leaves it to the profiles.

        Another open pedal is treated like a lost one within 50 ms.
        """
        self._wish = Wish(str(device).strip(), self._wish.profile)

    def want_profile(self, profile):
        """Choose the profile by its name; '' is the one for the device."""
        self._wish = Wish(self._wish.device, str(profile).strip())

    def find(self):
        """Name the connected pedal; see :class:`mhri.devices.io.reader.Reader`."""
        candidates = self._sources[KEYS].look() if KEYS in self._sources else []
        return self._find(self._wish, candidates + [candidate_of(info) for info in find_pads()])

    def _found(self, wish, candidates):
        """Return the name of the pedal to open."""
        try:
            return choose(candidates, _resolved(wish, candidates), self._profiles())[0].name
        except NoPedal as problem:
            raise DeviceAbsent(str(problem))

    def open(self):
        """Open the pedal; see :class:`mhri.devices.io.reader.Reader`."""
        self.close()
        self._opened_for = self._wish
        profiles = self._profiles()
        candidates, problems = self._look(profiles)
        try:
            candidate, profile = choose(candidates, _resolved(self._opened_for, candidates),
                                        profiles)
        except NoPedal as problem:
            raise DeviceAbsent('; '.join([str(problem)] + problems))
        source = self._sources[candidate.kind]
        source.open(candidate, profile)
        self._open, self.name = source, candidate.name
        return '{} with profile {}'.format(candidate, profile.name)

    @property
    def note(self):
        """What the operator must do before every pedal counts, '' if nothing."""
        source = self._open
        return source.note if source else ''

    def _look(self, profiles):
        """Return (candidates, problems) of all kinds of devices asked for."""
        wished = profiles.get(self._opened_for.profile)
        candidates, problems = [], []
        for kind, source in self._sources.items():
            if wished is not None and kind != wished.kind:
                continue
            try:
                candidates += source.look()
            except DeviceAbsent as problem:
                problems.append(str(problem))
        return candidates, problems

    def read(self, timeout_s):
        """Wait for a change; see :class:`mhri.devices.io.reader.Reader`."""
        if self._open is None:
            raise DeviceLost('no foot pedal is open')
        if self._wish != self._opened_for:
            raise DeviceLost('another pedal or profile was asked for')
        return self._open.read(timeout_s)

    def close(self):
        """Give the pedal back; see :class:`mhri.devices.io.reader.Reader`."""
        source, self._open, self.name = self._open, None, ''
        if source is not None:
            source.close()
