# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot pedals: what each does, read from a file, and what their values ask for.

A pedal has a value: 0 or 1 for a switch, the fraction of its travel for an axis. All pedals of a
device together give the axes and buttons of a ``sensor_msgs/Joy`` as the mux reads them:
``axes[0]`` left +1 .. right -1, ``axes[1]`` forward +1 .. back -1; ``buttons[0]`` is an enabling
pedal, then comes one button for each pedal in the order of the file.
"""
from dataclasses import dataclass
import math
import re
from typing import AbstractSet, Any, Dict, Iterable, List, Optional, Sequence, Set, Tuple

from mhri.base.config import ConfigError, parse_yaml, Section

DRIVE = 'drive'
ENABLE = 'enable'
ROLES = (DRIVE, ENABLE)
KEYS = 'keys'
AXES = 'axes'

_KEY_NAME = re.compile(r'(KEY|BTN)_[A-Z0-9_]+$')
_USB_ID = re.compile(r'[0-9a-f]{4}:[0-9a-f]{4}$')


@dataclass(frozen=True)
class Pedal:
    """One pedal: where its value comes from, and what a value of 1 does.

    ``keys`` are names as in linux/input-event-codes.h, any of which presses it; or ``axis`` is the
    index of an axis that shows ``rest`` while nobody touches it and ``full`` at full travel. One
    that goes ``both_ways`` from its rest has values in [-1, 1], any other in [0, 1].
    ``forward`` and ``turn`` (left +) are fractions of the operator's limits, in [-1, 1].
    A ``direction`` pedal makes the others drive backward; an ``enabling`` one is the dead-man.
    """

    name: str
    keys: Tuple[str, ...] = ()
    axis: Optional[int] = None
    rest: float = 0.0
    full: float = 1.0
    both_ways: bool = False
    forward: float = 0.0
    turn: float = 0.0
    direction: bool = False
    enabling: bool = False

    def travel(self, raw: Optional[float]) -> Optional[float]:
        """Return the fraction of its travel that an axis shows; overshoot is clipped.

        :returns: None if the axis has shown nothing yet, or nothing that is a number
        """
        if raw is None or not math.isfinite(raw):
            return None
        share = (raw - self.rest) / (self.full - self.rest)
        return max(-1.0 if self.both_ways else 0.0, min(1.0, share))


@dataclass(frozen=True)
class PedalProfile:
    """The pedals of one kind of device, read from ``resource/pedals/<name>.yaml``.

    ``kind`` is KEYS (a foot switch that types) or AXES (rudder pedals, a joystick). ``usb`` holds
    the ``vendor:product`` (hexadecimal) and ``names`` the parts of names, whatever their case, of
    the devices it is for. ``dead_zone`` is the fraction of an axis' travel that counts as rest
    (the remainder is stretched); from ``pressed_at`` on it counts as pressed. A profile that is not
    ``automatic`` is used only on request, by its name.
    """

    name: str
    label: str
    kind: str
    pedals: Tuple[Pedal, ...]
    usb: Tuple[str, ...] = ()
    names: Tuple[str, ...] = ()
    dead_zone: float = 0.0
    pressed_at: float = 0.5
    automatic: bool = True

    def fits(self, usb: str, name: str) -> bool:
        """Tell whether this profile is for a device (``vendor:product``, name)."""
        lower = name.lower()
        return usb in self.usb or any(part.lower() in lower for part in self.names)

    def from_keys(self, held: AbstractSet[str]) -> Tuple[float, ...]:
        """Return the value of each pedal.

        :param held: names of the keys that are down
        """
        return tuple(0.0 if held.isdisjoint(pedal.keys) else 1.0 for pedal in self.pedals)

    def from_axes(self, raw: Sequence[Optional[float]]) -> Tuple[Optional[float], ...]:
        """Return the value of each pedal; None for one whose axis has shown nothing yet.

        :param raw: the axes of the device as a list; None for those that are not known yet
        """
        values = (pedal.travel(raw[pedal.axis] if pedal.axis is not None and pedal.axis < len(raw)
                               else None) for pedal in self.pedals)
        return tuple(None if value is None else self._stretch(value) for value in values)

    def _stretch(self, value: float) -> float:
        """Take the dead zone out of a value."""
        size = abs(value)
        if size <= self.dead_zone:
            return 0.0
        return math.copysign((size - self.dead_zone) / (1.0 - self.dead_zone), value)


class _Direction:
    """Which way the driving pedals go; decided as they are pressed, until they are released.

    A robot must not reverse at full speed because a foot slipped: if the direction pedal changes
    while a driving pedal is pressed, nothing moves until the latter has been released.
    """

    REST, AHEAD, BACK, HOLD = 'rest', 'ahead', 'back', 'hold'
    _SIGN = {REST: 1.0, AHEAD: 1.0, BACK: -1.0, HOLD: 0.0}

    def __init__(self) -> None:
        self.state = self.REST

    def take(self, driving: bool, reverse: bool) -> float:
        """Follow the pedals; return the factor of forward: 1, -1, or 0 for a hold."""
        wanted = self.BACK if reverse else self.AHEAD
        if not driving:
            self.state = self.REST
        elif self.state == self.REST:
            self.state = wanted
        elif self.state != wanted:
            self.state = self.HOLD
        return self._SIGN[self.state]


class PedalState:
    """What the feet ask for; make a new one each time a device is opened.

    A pedal counts once it has been seen released: one held down (by a foot or a fallen book) while
    the device is opened does nothing until it has been let go.

    :param role: DRIVE, or ENABLE: the axes stay at zero, ``buttons[0]`` is what matters
    """

    def __init__(self, profile: PedalProfile, role: str = DRIVE) -> None:
        self._profile = profile
        self._role = role
        self._direction = _Direction()
        self._armed = [False] * len(profile.pedals)
        self._known = False
        self._unknown = [True] * len(profile.pedals)
        marked = tuple(pedal.enabling for pedal in profile.pedals)
        # If the file marks none, any pedal except one that only sets the direction.
        self._enabling = marked if any(marked) else tuple(
            not pedal.direction for pedal in profile.pedals)

    def note(self) -> str:
        """Return what the operator must do before every pedal counts, '' if nothing."""
        if any(self._unknown):
            return 'move once: {} (nothing is known yet of it)'.format(self._names(self._unknown))
        held = [not armed for armed in self._armed]
        return 'release once: {}'.format(self._names(held)) if any(held) else ''

    def _names(self, marks: Iterable[bool]) -> str:
        """Return the names of the pedals that are marked."""
        return ', '.join(pedal.name for pedal, mark in zip(self._profile.pedals, marks) if mark)

    def read(self, values: Sequence[Optional[float]]
             ) -> Optional[Tuple[Tuple[float, float], Tuple[int, ...]]]:
        """Return (axes, buttons) for the values of all pedals, in the order of the profile.

        :param values: in [-1, 1]; None if a pedal's value is not known
        :returns: None until every value has been known once; if a value becomes unknown
            later, everything is zero and must be seen released again
        """
        self._unknown = [value is None for value in values]
        counted = [value for value in values if value is not None]
        if len(counted) < len(values):
            self._armed = [False] * len(values)
            if not self._known:
                return None
            counted = [0.0] * len(values)
        else:
            self._known = True
            self._armed = [armed or value == 0.0 for armed, value in zip(self._armed, counted)]
            counted = [value if armed else 0.0 for armed, value in zip(self._armed, counted)]
        pressed = [abs(value) >= self._profile.pressed_at for value in counted]
        enabled = any(down and counts for down, counts in zip(pressed, self._enabling))
        buttons = (int(enabled),) + tuple(int(down) for down in pressed)
        return self._axes(counted, pressed), buttons

    def _axes(self, values: Sequence[float], pressed: Sequence[bool]) -> Tuple[float, float]:
        """Return (left, forward) of the values."""
        pedals = self._profile.pedals
        forward = sum(value * pedal.forward for value, pedal in zip(values, pedals))
        turn = sum(value * pedal.turn for value, pedal in zip(values, pedals))
        reverse = any(down and pedal.direction for down, pedal in zip(pressed, pedals))
        driving = any(value != 0.0 and pedal.forward != 0.0
                      for value, pedal in zip(values, pedals))
        sign = self._direction.take(driving, reverse)
        if self._role == ENABLE or sign == 0.0:
            return 0.0, 0.0
        # + 0.0 makes a zero of minus zero, which reads badly in every echo.
        return _within_one(turn) + 0.0, _within_one(forward) * sign + 0.0


def _within_one(value: float) -> float:
    """Return the value cut to [-1, 1]."""
    return max(-1.0, min(1.0, value))


def parse_pedal_profile(text: str, origin: str) -> PedalProfile:
    """Return the :class:`PedalProfile` that a YAML text describes.

    :raises ConfigError: names the file and the wrong key
    """
    section = parse_yaml(text, origin)
    name = section.text('name')
    kind = section.text('kind')
    if kind not in (KEYS, AXES):
        raise section.error('kind', 'expected {} or {}, got {!r}'.format(KEYS, AXES, kind))
    rows = section.sections('pedals')
    if not rows:
        raise section.error('pedals', 'name at least one pedal')
    usb, names = _match(section)
    profile = PedalProfile(
        name=name, label=section.text('label', name), kind=kind,
        pedals=tuple(_pedal(row, kind) for row in rows), usb=usb, names=names,
        dead_zone=section.number('dead_zone', 0.0, 0.9, 0.0),
        pressed_at=section.number('pressed_at', 0.01, 1.0, 0.5),
        automatic=section.flag('automatic', True))
    section.close()
    _check_together(section, profile)
    return profile


def _match(section: Section) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
    """Read for which devices a profile is."""
    match = section.section('match', None)
    if match is None:
        return (), ()
    usb = tuple(text.lower() for text in match.texts('usb', ()))
    for text in usb:
        if not _USB_ID.match(text):
            raise match.error('usb', 'expected vendor:product such as "3553:b001" (lsusb shows '
                              'them; with the quotes), got {!r}'.format(text))
    names = match.texts('names', ())
    if not all(name.strip() for name in names):
        raise match.error('names', 'an empty name fits every device')
    match.close()
    return usb, names


def _pedal(row: Section, kind: str) -> Pedal:
    """Read one pedal."""
    name = row.text('name')
    source = _keys(row) if kind == KEYS else _axis(row)
    pedal = Pedal(
        name=name, forward=row.number('forward', -1.0, 1.0, 0.0),
        turn=row.number('turn', -1.0, 1.0, 0.0), direction=row.flag('direction', False),
        enabling=row.flag('enabling', False), **source)
    row.close()
    if pedal.direction and (pedal.forward or pedal.turn):
        raise row.error('direction', 'a pedal that sets the direction cannot drive as well')
    return pedal


def _keys(row: Section) -> Dict[str, Any]:
    """Read the keys of a switch, as what a :class:`Pedal` is made of."""
    keys = row.texts('keys')
    wrong = [key for key in keys if not _KEY_NAME.match(key)]
    if wrong or not keys:
        raise row.error('keys', 'expected names such as KEY_B or BTN_LEFT (evtest shows them), '
                        'got {!r}'.format(wrong[0] if wrong else []))
    return {'keys': keys}


def _axis(row: Section) -> Dict[str, Any]:
    """Read the axis of a pedal, as what a :class:`Pedal` is made of."""
    axis = {'axis': row.index('axis'), 'rest': row.number('rest', -1.0, 1.0, 0.0),
            'full': row.number('full', -1.0, 1.0, 1.0), 'both_ways': row.flag('both_ways', False)}
    if abs(axis['full'] - axis['rest']) < 0.1:
        raise row.error('full', 'must be 0.1 away from rest at least: there would be no travel')
    return axis


def _check_together(section: Section, profile: PedalProfile) -> None:
    """Refuse what each pedal may have, but not all of them together.

    :raises ConfigError: two pedals of one name or key, or nothing that drives
    """
    seen: Set[str] = set()
    for number, pedal in enumerate(profile.pedals):
        for word in (pedal.name,) + pedal.keys:
            if word in seen:
                raise section.error('pedals[{}]'.format(number), '{!r} is there twice'.format(word))
            seen.add(word)
    if not any(pedal.forward or pedal.turn or pedal.enabling for pedal in profile.pedals):
        raise section.error('pedals', 'none of them drives or enables')


def load_pedal_profiles(
        files: Iterable[Tuple[str, str]]) -> Tuple[Dict[str, PedalProfile], List[ConfigError]]:
    """Parse many profiles; one bad file never hides the good ones.

    :param files: pairs (origin, text), the more important first
    :returns: ({name: PedalProfile}, [ConfigError]); of two files with the same name the first
        counts, so that an operator's own file replaces a shipped one
    """
    profiles: Dict[str, PedalProfile] = {}
    errors: List[ConfigError] = []
    for origin, text in files:
        try:
            profile = parse_pedal_profile(text, origin)
        except ConfigError as error:
            errors.append(error)
            continue
        profiles.setdefault(profile.name, profile)
    return profiles, errors
