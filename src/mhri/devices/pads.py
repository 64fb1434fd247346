# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The choice of a pad among several, and of its profile."""
from collections import Counter
from dataclasses import dataclass, replace
from typing import Dict, Iterable, List, Sequence, Tuple

from mhri.base.config import ConfigError, parse_all
from mhri.devices.profile import parse_profile, Profile

GENERIC = 'generic'
_HEXADECIMAL = set('0123456789abcdef')
# Extra devices that kernel drivers create for a pad, and devices for the feet.
_NO_PADS = ('motion sensors', 'touchpad', 'accelerometer', 'pedal', 'rudder', 'footswitch')


@dataclass(frozen=True)
class PadInfo:
    """A connected pad: its place in SDL's list, its name, its GUID ('' if unknown).

    ``where`` distinguishes it from others with its name, e.g. 'USB 1.2', '' if unknown. ``label``
    is its name on the screen, see :func:`with_labels`.
    """

    index: int
    name: str
    guid: str = ''
    where: str = ''
    label: str = ''

    @property
    def full_name(self) -> str:
        """Its name and its port."""
        return ', '.join(filter(None, (self.name, self.where)))


def same_guid(guid: str) -> str:
    """Return a GUID for comparison: in lower case, without the check sum of the device's name.

    SDL 2.26 and later put that into the third and fourth byte; older versions have zeros there.
    """
    guid = guid.lower()
    return guid[:4] + '0000' + guid[8:]


def usb_of_guid(guid: str) -> str:
    """Return ``vendor:product`` of a GUID of SDL, '' if it has none.

    Its 16 bytes are bus, check sum, vendor, 0, product, 0, ...: two bytes each, little-endian.
    """
    if len(guid) != 32 or guid[12:16] != '0000' or guid[20:24] != '0000':
        return ''
    vendor, product = (guid[at + 2:at + 4] + guid[at:at + 2] for at in (8, 16))
    return '' if '0000' in (vendor, product) else '{}:{}'.format(vendor, product).lower()


def is_guid(text: str) -> bool:
    """Return whether a text is a GUID of SDL: 32 hexadecimal digits."""
    return len(text) == 32 and set(text.lower()) <= _HEXADECIMAL


def load_profiles(
        files: Iterable[Tuple[str, str]]) -> Tuple[List[Profile], List[ConfigError]]:
    """Parse many profiles, each with the name of its file; a bad file does not affect the others.

    :param files: pairs (path, text), in the order of preference
    """
    return parse_all(files, _parse_named)


def _parse_named(text: str, path: str) -> Profile:
    """Parse a profile, and check that its name is that of its file."""
    profile = parse_profile(text, path)
    name = path.rpartition('/')[2].rpartition('.')[0]
    if profile.name != name:
        raise ConfigError(path, 'name', 'expected {!r} as the file is called, got {!r}'.format(
            name, profile.name))
    return profile


def _may_be(profile: Profile, usb: str) -> bool:
    """Return whether a pad of a vendor and product ('' if unknown) may be one of a profile's."""
    known = [usb_of_guid(guid) for guid in profile.match.guids]
    return not usb or not known or usb in known


def choose_profile(profiles: Sequence[Profile], name: str, guid: str = '') -> Tuple[Profile, str]:
    """Return (profile for a pad, note for the operator, '' without one).

    Profiles with its GUID come first; then the profile with the longest part of its name, since
    'Wireless Controller' matches many pads and 'Xbox Wireless Controller' one; then ``generic``.
    Clones have the names of others, and their buttons elsewhere: a name counts only where vendor
    and product are those of the profile, or one of the two does not say them.

    :param profiles: in the order of preference
    :raises LookupError: nothing matches, and there is no profile ``generic``
    """
    if guid:
        for profile in profiles:
            if same_guid(guid) in [same_guid(own) for own in profile.match.guids]:
                return profile, ''
    parts = [(len(part), -place) for place, profile in enumerate(profiles)
             if _may_be(profile, usb_of_guid(guid))
             for part in profile.match.names if part.lower() in name.lower()]
    if parts:
        return profiles[-max(parts)[1]], ''
    for profile in profiles:
        if profile.name == GENERIC:
            return profile, ('no profile knows this pad: the generic one is used; if it does not '
                             'fit, calibrate it on the page Pad')
    raise LookupError('no profile knows {!r}, and there is no profile {!r}'.format(name, GENERIC))


def is_known(profiles: Sequence[Profile], pad: PadInfo) -> bool:
    """Return whether a profile matches a pad by its GUID or its name."""
    try:
        return not choose_profile(profiles, pad.name, pad.guid)[1]
    except LookupError:
        return False


def only_pads(devices: Iterable[PadInfo]) -> List[PadInfo]:
    """Return the devices without extra devices of a pad, and without pedals."""
    return [pad for pad in devices if not any(part in pad.name.lower() for part in _NO_PADS)]


def with_labels(pads: Iterable[PadInfo]) -> List[PadInfo]:
    """Return the pads with unique labels.

    A label is the name; if several pads have the same name, the port is added, and a number if that
    is the same, too.
    """
    pads = list(pads)
    names = Counter(pad.name for pad in pads)
    seen: Dict[str, int] = {}
    labelled = []
    for pad in pads:
        label = pad.full_name if names[pad.name] > 1 else pad.name
        seen[label] = seen.get(label, 0) + 1
        if seen[label] > 1:
            label = '{} ({})'.format(label, seen[label])
        labelled.append(replace(pad, label=label))
    return labelled


def choose_pad(wanted: object, pads: Iterable[PadInfo], profiles: Sequence[Profile]) -> PadInfo:
    """Return the :class:`PadInfo` to open.

    :param wanted: '' (any: the first with a profile, else the first), a whole number (its place in
        the list, from 0), a GUID, its label, or a part of its name in any case
    :raises LookupError: no pad matches; the text has the request and the remedy
    """
    word = str(wanted).strip()
    pads = with_labels(only_pads(pads))
    if not pads:
        raise LookupError('none is connected; plug one in, or press its PS button')
    if not word:
        return next((pad for pad in pads if is_known(profiles, pad)), pads[0])
    # A name may be a part of another: prefer exact matches.
    for pad in sorted(pads, key=lambda pad: word not in (pad.label, pad.full_name)):
        if is_chosen(word, pad):
            return pad
    raise LookupError('{!r} is not connected: plug it in, or choose another pad; connected: '
                      '{}'.format(word, describe(pads)))


def is_chosen(wanted: object, pad: PadInfo) -> bool:
    """Return whether a pad matches a request; '' matches any."""
    word = str(wanted).strip()
    if word.isdigit() and len(word) < 4:
        return pad.index == int(word)
    if is_guid(word):
        return bool(pad.guid) and same_guid(word) == same_guid(pad.guid)
    return word.lower() in pad.full_name.lower() or word == pad.label


def describe(pads: Iterable[PadInfo]) -> str:
    """Return a list of pads in words, each with its index."""
    return ', '.join('{}: {}'.format(pad.index, pad.label or pad.name) for pad in pads) or 'none'
