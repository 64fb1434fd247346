# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot pedals: their profiles, and the Joy message from their values.

A pedal has a value: 0 or 1 for a switch, the fraction of its travel for an axis. All pedals of a
device together make the axes and buttons of a ``sensor_msgs/Joy`` as the mux reads them:
``axes[0]`` left +1 .. right -1, ``axes[1]`` forward +1 .. back -1; ``buttons[0]`` is an enabling
pedal, followed by a button for each pedal in the order of the file.
"""
from dataclasses import dataclass
import math
import re
from typing import AbstractSet, Any, Dict, Iterable, List, Optional, Sequence, Set, Tuple

from mhri.base.config import ConfigError, parse_all, parse_yaml, Section
from mhri.devices.bindings import Binding, Layout, read_bindings
from mhri.devices.profile import Axis, Profile

DRIVE = 'drive'
ENABLE = 'enable'
ROLES = (DRIVE, ENABLE)
KEYS = 'keys'
AXES = 'axes'
# A Joy names the profile of its pedals with this, where they act on accessories.
NAMED = 'pedal:'

_KEY_NAME = re.compile(r'(KEY|BTN)_[A-Z0-9_]+$')
_USB_ID = re.compile(r'[0-9a-f]{4}:[0-9a-f]{4}$')


@dataclass(frozen=True)
class Pedal:
    """One pedal: the source of its value, and the effect of a value of 1.

    ``keys`` are names as in linux/input-event-codes.h, any of which presses it; or ``axis`` is the
    index of an axis with the value ``rest`` while released and ``full`` at full travel. A pedal
    that moves ``both_ways`` from its rest has values in [-1, 1], any other in [0, 1].
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
        """Return the value of the axis as a fraction of its travel; overshoot is clipped.

        :returns: None if the axis has not reported yet, or its value is not a number
        """
        if raw is None or not math.isfinite(raw):
            return None
        share = (raw - self.rest) / (self.full - self.rest)
        return max(-1.0 if self.both_ways else 0.0, min(1.0, share))


@dataclass(frozen=True)
class PedalProfile:
    """The pedals of one kind of device, read from ``resource/pedals/<name>.yaml``.

    ``kind`` is KEYS (a foot switch that types) or AXES (rudder pedals, a joystick). ``usb`` has the
    ``vendor:product`` (hexadecimal) and ``names`` the parts of names, in any case, of its devices.
    ``dead_zone`` is the fraction of an axis' travel that counts as rest (the remainder is
    stretched); from ``pressed_at`` on it counts as pressed. A profile that is not ``automatic`` is
    used only if requested by name. ``bindings`` are pedals that act on accessories instead.
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
    bindings: Tuple[Binding, ...] = ()

    def as_profile(self) -> Profile:
        """Return the meanings of the axes and buttons that its pedals make."""
        return Profile(self.name, Axis(1, 1.0), Axis(0, 1.0), bindings=self.bindings)

    def fits(self, usb: str, name: str) -> bool:
        """Return whether this profile is for a device (``vendor:product``, name)."""
        lower = name.lower()
        return usb in self.usb or any(part.lower() in lower for part in self.names)

    def from_keys(self, held: AbstractSet[str]) -> Tuple[float, ...]:
        """Return the value of each pedal.

        :param held: names of the keys that are down
        """
        return tuple(0.0 if held.isdisjoint(pedal.keys) else 1.0 for pedal in self.pedals)

    def from_axes(self, raw: Sequence[Optional[float]]) -> Tuple[Optional[float], ...]:
        """Return the value of each pedal, None until its axis has reported.

        :param raw: the axes of the device, None if not known yet
        """
        values = (pedal.travel(raw[pedal.axis] if pedal.axis is not None and pedal.axis < len(raw)
                               else None) for pedal in self.pedals)
        return tuple(None if value is None else self._stretch(value) for value in values)

    def _stretch(self, value: float) -> float:
        """Remove the dead zone from a value."""
        size = abs(value)
        if size <= self.dead_zone:
            return 0.0
        return math.copysign((size - self.dead_zone) / (1.0 - self.dead_zone), value)


class _Direction:
    """The direction of the driving pedals, fixed from their press to their release.

    A robot must not reverse at full speed because a foot slipped: if the direction pedal changes
    while a driving pedal is pressed, nothing moves until the latter has been released.
    """

    REST, AHEAD, BACK, HOLD = 'rest', 'ahead', 'back', 'hold'
    _SIGN = {REST: 1.0, AHEAD: 1.0, BACK: -1.0, HOLD: 0.0}

    def __init__(self) -> None:
        self.state = self.REST

    def take(self, driving: bool, reverse: bool) -> float:
        """Update the direction; return the factor of forward: 1, -1, or 0 for a hold."""
        wanted = self.BACK if reverse else self.AHEAD
        if not driving:
            self.state = self.REST
        elif self.state == self.REST:
            self.state = wanted
        elif self.state != wanted:
            self.state = self.HOLD
        return self._SIGN[self.state]


class PedalState:
    """The commands of the feet; make a new one each time a device is opened.

    A pedal counts once it has been released: one that is held down (by a foot or a fallen book)
    while the device is opened has no effect before.

    :param role: DRIVE, or ENABLE: the axes stay at zero, and only ``buttons[0]`` counts
    """

    def __init__(self, profile: PedalProfile, role: str = DRIVE) -> None:
        self._profile = profile
        self._role = role
        self._direction = _Direction()
        self._armed = [False] * len(profile.pedals)
        self._known = False
        self._unknown = [True] * len(profile.pedals)
        marked = tuple(pedal.enabling for pedal in profile.pedals)
        bound = {binding.source.button for binding in profile.bindings}
        # By default every pedal is enabling that drives, or could.
        self._enabling = marked if any(marked) else tuple(
            not pedal.direction and number not in bound
            for number, pedal in enumerate(profile.pedals, 1))
        #: what the Joy has to name as its profile, '' for nothing
        self.named = NAMED + profile.name if profile.bindings and role == DRIVE else ''

    def note(self) -> str:
        """Return the operator's action needed before every pedal counts, or ''."""
        if any(self._unknown):
            return 'move once: {} (nothing is known yet of it)'.format(self._names(self._unknown))
        held = [not armed for armed in self._armed]
        return 'release once: {}'.format(self._names(held)) if any(held) else ''

    def _names(self, marks: Iterable[bool]) -> str:
        """Return the names of the marked pedals."""
        return ', '.join(pedal.name for pedal, mark in zip(self._profile.pedals, marks) if mark)

    def read(self, values: Sequence[Optional[float]]
             ) -> Optional[Tuple[Tuple[float, float], Tuple[int, ...]]]:
        """Return (axes, buttons) for the values of all pedals, in the order of the profile.

        :param values: in [-1, 1], None if unknown
        :returns: None until every value has been known once; if a value becomes unknown later,
            everything is zero, and every pedal must be released again
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
        """Return (left, forward) for the values."""
        pedals = self._profile.pedals
        forward = sum(value * pedal.forward for value, pedal in zip(values, pedals))
        turn = sum(value * pedal.turn for value, pedal in zip(values, pedals))
        reverse = any(down and pedal.direction for down, pedal in zip(pressed, pedals))
        driving = any(value != 0.0 and pedal.forward != 0.0
                      for value, pedal in zip(values, pedals))
        sign = self._direction.take(driving, reverse)
        if self._role == ENABLE or sign == 0.0:
            return 0.0, 0.0
        # + 0.0 turns minus zero into zero, which is easier to read in an echo.
        return _within_one(turn) + 0.0, _within_one(forward) * sign + 0.0


def _within_one(value: float) -> float:
    """Return the value clipped to [-1, 1]."""
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
    pedals = tuple(_pedal(row, kind) for row in rows)
    usb, names = _match(section)
    profile = PedalProfile(
        name=name, label=section.text('label', name), kind=kind,
        pedals=pedals, usb=usb, names=names, bindings=_bindings(section, pedals),
        dead_zone=section.number('dead_zone', 0.0, 0.9, 0.0),
        pressed_at=section.number('pressed_at', 0.01, 1.0, 0.5),
        automatic=section.flag('automatic', True))
    section.close()
    _check_together(section, profile)
    return profile


def _bindings(section: Section, pedals: Sequence[Pedal]) -> Tuple[Binding, ...]:
    """Read which pedals act on accessories: as buttons, by their numbers, the first is 1."""
    taken = {number: 'a pedal that drives, enables or sets the direction'
             for number, pedal in enumerate(pedals, 1)
             if pedal.forward or pedal.turn or pedal.direction or pedal.enabling}
    found = read_bindings(section, Layout(None, {0: 'the enabling pedal', **taken}, {}, ()))
    if not all(binding.source.button in range(1, len(pedals) + 1) for binding in found):
        raise section.error('accessories', 'expected button: the number of a pedal, 1 to {}'.format(
            len(pedals)))
    return found


def _match(section: Section) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
    """Read the devices of a profile."""
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
    """Read the keys of a switch, as arguments of :class:`Pedal`."""
    keys = row.texts('keys')
    wrong = [key for key in keys if not _KEY_NAME.match(key)]
    if wrong or not keys:
        raise row.error('keys', 'expected names such as KEY_B or BTN_LEFT (evtest shows them), '
                        'got {!r}'.format(wrong[0] if wrong else []))
    return {'keys': keys}


def _axis(row: Section) -> Dict[str, Any]:
    """Read the axis of a pedal, as arguments of :class:`Pedal`."""
    axis = {'axis': row.index('axis'), 'rest': row.number('rest', -1.0, 1.0, 0.0),
            'full': row.number('full', -1.0, 1.0, 1.0), 'both_ways': row.flag('both_ways', False)}
    if abs(axis['full'] - axis['rest']) < 0.1:
        raise row.error('full', 'must be 0.1 away from rest at least: there would be no travel')
    return axis


def _check_together(section: Section, profile: PedalProfile) -> None:
    """Check the pedals of a profile against each other.

    :raises ConfigError: two pedals have the same name or key, or none drives
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
    """Parse many profiles; a bad file does not affect the others.

    :param files: pairs (origin, text), in the order of precedence
    :returns: ({name: PedalProfile}, [ConfigError]); of two files with the same name the first
        is used, so that an operator's own file replaces a shipped one
    """
    found, errors = parse_all(files, parse_pedal_profile)
    profiles: Dict[str, PedalProfile] = {}
    for profile in found:
        profiles.setdefault(profile.name, profile)
    return profiles, errors
