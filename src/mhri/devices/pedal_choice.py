# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The choice of the pedal among the connected devices, and of its profile."""
from dataclasses import dataclass
import re
from typing import Iterable, List, Mapping, Optional, Sequence, Tuple

from mhri.devices.pedals import AXES, KEYS, PedalProfile

_USB_ID = re.compile(r'[0-9a-fA-F]{4}:[0-9a-fA-F]{4}$')

# The profiles for a device that the operator named, but no profile matches.
GENERIC = {KEYS: 'three_keys', AXES: 'rudder_pedals'}


class NoPedal(LookupError):
    """No device, or more than one, matches; the text has the devices, the reason and the remedy."""


@dataclass(frozen=True)
class Candidate:
    """A connected device.

    ``usb`` is ``vendor:product`` in lower-case hexadecimal or ''; ``places`` are its paths or other
    names; ``kind`` is the kind of its profile.
    """

    kind: str
    usb: str
    name: str
    places: Tuple[str, ...]

    def __str__(self) -> str:
        return '{} ({}{})'.format(self.name or 'a device without a name',
                                  self.usb + ', ' if self.usb else '', ', '.join(self.places[:1]))


@dataclass(frozen=True)
class PedalRequest:
    """The operator's request: ``device`` and ``profile``, '' to choose by the profiles.

    ``device`` is ``vendor:product``, a place (a path or a GUID) or a part of a name in any case.
    """

    device: str = ''
    profile: str = ''

    def fits(self, candidate: Candidate) -> bool:
        """Return whether ``device`` matches a candidate."""
        if _USB_ID.match(self.device):
            return candidate.usb == self.device.lower()
        if self.device in candidate.places or self.device.startswith('/'):
            return self.device in candidate.places
        return self.device.lower() in candidate.name.lower()


def choose(candidates: Iterable[Candidate], request: PedalRequest,
           profiles: Mapping[str, PedalProfile]) -> Tuple[Candidate, PedalProfile]:
    """Return (candidate, profile).

    If several devices match, none is chosen: a guess must never grab an operator's keyboard, and a
    pedal must not drive while the operator presses another one.

    :param profiles: {name: PedalProfile}
    :raises NoPedal: no or several devices match, or the profile is not for such a device
    """
    profile = _requested_profile(request, profiles)
    if request.device:
        found = [item for item in candidates if request.fits(item)]
        wanted = '{!r}'.format(request.device)
    else:
        known = [profile] if profile else _automatic(profiles)
        found = [item for item in candidates if _known_to(item, known)]
        wanted = 'a pedal that profile {!r} is for'.format(
            profile.name) if profile else 'a pedal that a profile is for'
    if profile:
        found = [item for item in found if item.kind == profile.kind]
    if not found:
        raise NoPedal('no foot pedal: looked for {}. Connect it, or set ~device to its '
                      'vendor:product (lsusb shows it), path or name'.format(wanted))
    if len(found) > 1:
        raise NoPedal('{} devices fit {}: {}. Set ~device to the vendor:product or the path of '
                      'one'.format(len(found), wanted, ', '.join(str(item) for item in found)))
    return found[0], profile or _profile_for(found[0], profiles)


def _requested_profile(request: PedalRequest,
                       profiles: Mapping[str, PedalProfile]) -> Optional[PedalProfile]:
    """Return the profile requested by name, None without a request."""
    if not request.profile:
        return None
    if request.profile not in profiles:
        raise NoPedal('no pedal profile {!r}; there are {}'.format(
            request.profile, ', '.join(sorted(profiles)) or 'none'))
    profile = profiles[request.profile]
    if not request.device and not profile.usb and not profile.names:
        raise NoPedal('profile {!r} is for no device in particular: set ~device to the '
                      'vendor:product (lsusb shows it), path or name of yours'.format(profile.name))
    return profile


def _automatic(profiles: Mapping[str, PedalProfile]) -> List[PedalProfile]:
    """Return the profiles that are used automatically."""
    return [profile for profile in profiles.values() if profile.automatic]


def _known_to(candidate: Candidate, profiles: Sequence[PedalProfile]) -> bool:
    """Return whether any of the profiles is for a device."""
    return any(profile.kind == candidate.kind and profile.fits(candidate.usb, candidate.name)
               for profile in profiles)


def _profile_for(candidate: Candidate, profiles: Mapping[str, PedalProfile]) -> PedalProfile:
    """Return the profile of a device, by default the generic one."""
    for profile in _automatic(profiles):
        if _known_to(candidate, [profile]):
            return profile
    name = GENERIC[candidate.kind]
    if name not in profiles:
        raise NoPedal('no profile is for {}: set ~profile'.format(candidate))
    return profiles[name]
