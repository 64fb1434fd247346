# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which of several pads to use, and which profile says what its axes mean."""
from collections import Counter
from dataclasses import dataclass, replace
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

from mhri.base.config import ConfigError
from mhri.devices.profile import parse_profile, Profile

GENERIC = 'generic'
_HEXADECIMAL = set('0123456789abcdef')
# What kernel drivers show beside the pad itself, and devices for the feet.
_NO_PADS = ('motion sensors', 'touchpad', 'accelerometer', 'pedal', 'rudder', 'footswitch')


@dataclass(frozen=True)
class PadInfo:
    """A connected pad: its place in SDL's list, its name, its GUID ('' if not known).

    ``where`` tells it from others of its name, e.g. 'USB 1.2', '' if nothing is known. ``label`` is
    what it is called on the screen, as :func:`tell_apart` says.
    """

    index: int
    name: str
    guid: str = ''
    where: str = ''
    label: str = ''

    @property
    def full_name(self) -> str:
        """Its name and where it is."""
        return ', '.join(filter(None, (self.name, self.where)))


def same_guid(guid: str) -> str:
    """Return a GUID for comparison: lower case, without the check sum of the device's name.

    SDL 2.26 and later put that into the third and fourth byte; older ones have zeros there.
    """
    guid = guid.lower()
    return guid[:4] + '0000' + guid[8:]


def is_guid(text: str) -> bool:
    """Tell whether a text is a GUID of SDL: 32 hexadecimal digits."""
    return len(text) == 32 and set(text.lower()) <= _HEXADECIMAL


def load_profiles(
        files: Iterable[Tuple[str, str, str]]) -> Tuple[List[Profile], List[ConfigError]]:
    """Parse the profiles of all pads; a bad file does not hide the good ones.

    :param files: [(name, path, text)] in the order of preference; the name is the file's
        without its ending, and the profile must say the same
    :returns: ([Profile], [ConfigError])
    """
    profiles: List[Profile] = []
    errors: List[ConfigError] = []
    for name, path, text in files:
        try:
            profile = parse_profile(text, path)
            if profile.name != name:
                raise ConfigError(path, 'name', 'expected {!r} as the file is called, got '
                                  '{!r}'.format(name, profile.name))
        except ConfigError as error:
            errors.append(error)
        else:
            profiles.append(profile)
    return profiles, errors


def choose_profile(profiles: Sequence[Profile], name: str, guid: str = '') -> Tuple[Profile, str]:
    """Return the profile for a pad, and what the operator should know about the choice ('').

    First the one that names its GUID; then the one that names the longest part of its name, since
    'Wireless Controller' is many pads and 'Xbox Wireless Controller' is one; then ``generic``.

    :param profiles: in the order of preference
    :raises LookupError: nothing fits, and there is no profile ``generic``
    """
    if guid:
        for profile in profiles:
            if same_guid(guid) in [same_guid(own) for own in profile.match.guids]:
                return profile, ''
    best: Optional[Profile] = None
    length = 0
    for profile in profiles:
        for part in profile.match.names:
            if part.lower() in name.lower() and len(part) > length:
                best, length = profile, len(part)
    if best is not None:
        return best, ''
    for profile in profiles:
        if profile.name == GENERIC:
            return profile, ('no profile knows this pad: the generic one is used; if it does not '
                             'fit, calibrate it on the page Pad')
    raise LookupError('no profile knows {!r}, and there is no profile {!r}'.format(name, GENERIC))


def is_known(profiles: Sequence[Profile], pad: PadInfo) -> bool:
    """Tell whether a profile names a pad by its GUID or its name."""
    try:
        return not choose_profile(profiles, pad.name, pad.guid)[1]
    except LookupError:
        return False


def only_pads(devices: Iterable[PadInfo]) -> List[PadInfo]:
    """Return those that are no part of another pad, and nothing for the feet."""
    return [pad for pad in devices if not any(part in pad.name.lower() for part in _NO_PADS)]


def tell_apart(pads: Iterable[PadInfo]) -> List[PadInfo]:
    """Return the pads with labels that differ.

    That is its name; of several of one name also where it is, and a number where that does not
    differ either.
    """
    pads = list(pads)
    names = Counter(pad.name for pad in pads)
    seen: Dict[str, int] = {}
    told = []
    for pad in pads:
        label = pad.full_name if names[pad.name] > 1 else pad.name
        seen[label] = seen.get(label, 0) + 1
        told.append(replace(pad, label='{} ({})'.format(label, seen[label])
                            if seen[label] > 1 else label))
    return told


def choose_pad(wanted: object, pads: Iterable[PadInfo], profiles: Sequence[Profile]) -> PadInfo:
    """Return the :class:`PadInfo` to open.

    :param wanted: '' (any: the first that a profile knows, else the first), a whole number (its
        place in the list, from 0), a GUID, its label, or a part of its name in any case
    :raises LookupError: there is none; the text says what was wanted and the remedy
    """
    word = str(wanted).strip()
    pads = tell_apart(only_pads(pads))
    if not pads:
        raise LookupError('none is connected; plug one in, or press its PS button')
    if not word:
        return next((pad for pad in pads if is_known(profiles, pad)), pads[0])
    # One name may be a part of another.
    for pad in sorted(pads, key=lambda pad: word not in (pad.label, pad.full_name)):
        if is_wanted(word, pad):
            return pad
    raise LookupError('{!r} is not connected: plug it in, or choose another pad; connected: '
                      '{}'.format(word, describe(pads)))


def is_wanted(wanted: object, pad: PadInfo) -> bool:
    """Tell whether a pad is the wanted one; '' wants any."""
    word = str(wanted).strip()
    if word.isdigit() and len(word) < 4:
        return pad.index == int(word)
    if is_guid(word):
        return bool(pad.guid) and same_guid(word) == same_guid(pad.guid)
    return word.lower() in pad.full_name.lower() or word == pad.label


def describe(pads: Iterable[PadInfo]) -> str:
    """Return a list of pads in words, each with its index."""
    return ', '.join('{}: {}'.format(pad.index, pad.label or pad.name) for pad in pads) or 'none'
