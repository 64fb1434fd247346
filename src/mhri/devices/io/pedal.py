# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The foot pedal as an input device: choice of a device of any kind, and its readings.

Axes and buttons are those of the contract (see :mod:`mhri.devices.pedals`) for every device, so
that the mux needs no profile.
"""
import os

from mhri.devices.io.event_nodes import find_pads
from mhri.devices.io.pedal_axes import candidate_of, PedalAxes
from mhri.devices.io.pedal_keys import PedalKeys
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reader, CachedLookup
from mhri.devices.pedal_choice import choose, NoPedal, PedalRequest
from mhri.devices.pedals import AXES, DRIVE, KEYS


def _resolved(request, candidates):
    """Return a request with a link to a device (as in /dev/input/by-id) resolved."""
    if request.device.startswith('/'):
        for path in (place for item in candidates for place in item.places):
            if os.path.realpath(path) == os.path.realpath(request.device):
                return PedalRequest(path, request.profile)
    return request


class PedalReader(Reader):
    """Opens the wanted pedal and reads it; call the ``want_`` methods on any thread.

    :param profiles: function that returns {name: PedalProfile}; called whenever it looks for a
        pedal, so that a new profile needs no restart
    :param role: DRIVE or ENABLE
    :param sources: {kind: PedalKeys or PedalAxes}, None for the shipped ones
    """

    kind = 'foot pedal'

    def __init__(self, profiles, role=DRIVE, sources=None):
        self._profiles = profiles
        self._request = self._opened_for = PedalRequest()
        self._sources = sources or {KEYS: PedalKeys(role), AXES: PedalAxes(role)}
        self._open = None
        self.name = ''
        self._find = CachedLookup(self._found)

    def choose_device(self, device):
        """Choose the pedal: see :class:`PedalRequest`; '' chooses by the profiles.

        Another open pedal is treated like a lost one within 50 ms.
        """
        self._request = PedalRequest(str(device).strip(), self._request.profile)

    def choose_profile(self, profile):
        """Choose the profile by its name; '' is the profile for the device."""
        self._request = PedalRequest(self._request.device, str(profile).strip())

    def find(self):
        """Name the connected pedal; see :class:`mhri.devices.io.reader.Reader`."""
        candidates = self._sources[KEYS].look() if KEYS in self._sources else []
        return self._find(self._request, candidates + [candidate_of(info) for info in find_pads()])

    def _found(self, request, candidates):
        """Return the name of the pedal to open."""
        try:
            return choose(candidates, _resolved(request, candidates), self._profiles())[0].name
        except NoPedal as problem:
            raise DeviceAbsent(str(problem))

    def open(self):
        """Open the pedal; see :class:`mhri.devices.io.reader.Reader`."""
        self.close()
        self._opened_for = self._request
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
        """The operator's action needed before every pedal counts, or ''."""
        source = self._open
        return source.note if source else ''

    def _look(self, profiles):
        """Return (candidates, problems) of all requested kinds of devices."""
        requested = profiles.get(self._opened_for.profile)
        candidates, problems = [], []
        for kind, source in self._sources.items():
            if requested is not None and kind != requested.kind:
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
        if self._request != self._opened_for:
            raise DeviceLost('another pedal or profile was asked for')
        return self._open.read(timeout_s)

    def close(self):
        """Release the pedal; see :class:`mhri.devices.io.reader.Reader`."""
        source, self._open, self.name = self._open, None, ''
        if source is not None:
            source.close()
