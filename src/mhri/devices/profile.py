# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Profiles: the meanings of the axes and buttons of a device."""
import math
from dataclasses import dataclass, replace
from typing import Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Tuple, Union

from mhri.base.config import parse_yaml, Section
from mhri.base.limits import Velocity, within_limits
from mhri.devices.bindings import Binding, Layout, read_bindings

# Any button is the dead-man button, for a pad with unknown buttons.
ANY = 'any'
# A Twist below this counts as standstill [m/s, rad/s].
_CREEP = 1e-3

# Actions of a button besides driving; the keys of a profile are these plus ``_button``.
STOP_ALL = 'stop_all'
NEXT_ROBOT, PREVIOUS_ROBOT, SELECT_ALL = 'next_robot', 'previous_robot', 'select_all'
ACTIONS = (STOP_ALL, NEXT_ROBOT, PREVIOUS_ROBOT, SELECT_ALL)
# Not part of a calibration: only the profile's file can give it a button.
MARK = 'mark'


class JoyRefused(ValueError):
    """A Joy message cannot be used; ``kind`` is the word under which it is counted."""

    def __init__(self, kind: str, problem: str) -> None:
        self.kind = kind
        super().__init__(problem)


@dataclass(frozen=True)
class Axis:
    """One axis of a device: its index and the sign that makes forward and left positive.

    ``rest`` is the value while the axis is released: 0 for a stick, -1 for the
    triggers of most pads.
    """

    index: int
    scale: float
    rest: float = 0.0

    def read(self, axes: Sequence[float]) -> float:
        """Return the value in [-1, 1], 0 at rest; clip a driver's overshoot."""
        travel = (axes[self.index] - self.rest) / (1.0 + abs(self.rest))
        return max(-1.0, min(1.0, travel * self.scale))


class Stick(NamedTuple):
    """The operator's command, as fractions of the speed limits.

    ``forward``, ``turn`` and ``sideways`` (left +) are in [-1, 1] and already zero while the
    dead-man button is released; ``neutral``: whether the stick itself is at rest; ``held``: whether
    the dead-man button is pressed; ``has_dead_man``: whether the profile has such a button.
    """

    forward: float
    turn: float
    neutral: bool
    held: bool = True
    has_dead_man: bool = False
    sideways: float = 0.0

    def is_zero(self) -> bool:
        """Return whether the command is standstill."""
        return not (self.forward or self.turn or self.sideways)

    def velocity(self, limits: Tuple[float, float]) -> Velocity:
        """Return the commanded :class:`Velocity` for the limits [m/s, rad/s]."""
        velocity = Velocity(self.forward * limits[0], self.turn * limits[1],
                            self.sideways * limits[0])
        return within_limits(velocity, *limits) if self.sideways else velocity


@dataclass(frozen=True)
class Asked:
    """The command of a source of velocities; the arbiter treats it like a :class:`Stick`."""

    wanted: Velocity
    held, has_dead_man = True, False

    @property
    def neutral(self) -> bool:
        """Whether it commands standstill."""
        return self.is_zero()

    def is_zero(self) -> bool:
        """Return whether the command is standstill."""
        return max(map(abs, self.wanted)) < _CREEP

    def velocity(self, limits: Tuple[float, float]) -> Velocity:
        """Return the :class:`Velocity` within the limits [m/s, rad/s], on the same path."""
        return within_limits(self.wanted, *limits)


#: The command of a source, of either kind.
Wanted = Union[Stick, Asked]


def read_twist(linear: Sequence[float], angular: Sequence[float],
               sideways: bool = False) -> Asked:
    """Convert the two vectors of a ``geometry_msgs/Twist`` to an :class:`Asked`.

    Robots drive in the plane: only x of the first and z of the second count [m/s, rad/s].

    :param sideways: y of the first counts, too
    :raises JoyRefused: NaN or infinity anywhere
    """
    if not all(math.isfinite(value) for value in (*linear, *angular)):
        raise JoyRefused('not_finite', 'a Twist with NaN or infinity')
    return Asked(Velocity(linear[0], angular[2], linear[1] if sideways else 0.0))


@dataclass(frozen=True)
class Match:
    """The devices of a profile.

    ``guids`` are SDL's (32 hexadecimal digits), ``names`` are parts of a device's name, in any
    case.
    """

    guids: Tuple[str, ...] = ()
    names: Tuple[str, ...] = ()


@dataclass(frozen=True)
class Profile:
    """The mapping of one device, read from ``resource/pads/<name>.yaml``.

    ``dead_zone`` is the fraction of travel around the centre that counts as zero (the rest is
    stretched, so that full travel stays full speed). ``neutral`` is the fraction within which the
    stick counts as released for the interlock, and commands nothing; it is limited to the dead
    zone, if any. ``curve`` bends the response, from 0, linear, to 1, cubic, for fine control near
    the centre. ``dead_man`` is the button that must be held for anything to move, ``ANY`` for any
    button, None for none. ``turbo`` is a button; while it is not held, everything is multiplied by
    ``without_turbo``. ``actions`` are (button, one of ``ACTIONS`` or ``MARK``). A holonomic robot
    moves sideways by the axis ``sideways``, which a device may lack, or by ``turn`` while
    ``sideways_button`` is held. ``bindings`` act on accessories, some of them only while the button
    ``shift`` is held.
    """

    name: str
    forward: Axis
    turn: Axis
    dead_zone: float = 0.0
    neutral: float = 0.02
    dead_man: Union[int, str, None] = None
    curve: float = 0.0
    turbo: Optional[int] = None
    without_turbo: float = 0.5
    actions: Tuple[Tuple[int, str], ...] = ()
    match: Match = Match()
    sideways: Optional[Axis] = None
    sideways_button: Optional[int] = None
    bindings: Tuple[Binding, ...] = ()
    shift: Optional[int] = None

    def read(self, axes: Sequence[float], buttons: Sequence[int], sideways: bool = False) -> Stick:
        """Convert the axes and buttons of a ``sensor_msgs/Joy`` to a :class:`Stick`.

        :param sideways: whether the sideways axis counts, also for neutral
        :raises JoyRefused: no axes, too few axes or buttons, NaN or infinity anywhere
        """
        if not axes:
            raise JoyRefused('no_axes', 'a Joy message without axes')
        if not all(map(math.isfinite, axes)):
            raise JoyRefused('not_finite', 'a Joy message with NaN or infinity in its axes')
        needed = max(self.forward.index, self.turn.index) + 1
        if len(axes) < needed:
            raise JoyRefused('too_few_axes', 'a Joy message with {} axes; profile {} needs '
                             '{}'.format(len(axes), self.name, needed))
        held = self._held(buttons)
        forward, turn = self.forward.read(axes), self.turn.read(axes)
        aside = 0.0
        if sideways:
            turn, aside = self._aside(axes, buttons, turn)
        # A stick that counts as released moves nothing.
        neutral = max(abs(forward), abs(turn), abs(aside)) <= self.rests
        guarded = self.dead_man is not None
        if neutral or not held:
            return Stick(0.0, 0.0, neutral, held, guarded)
        # A pad without that button is slow, never fast.
        slow = self.turbo is not None and not is_pressed(buttons, self.turbo)
        factor = self.without_turbo if slow else 1.0
        return Stick(factor * self.respond(forward), factor * self.respond(turn), neutral,
                     has_dead_man=guarded, sideways=factor * self.respond(aside))

    @property
    def rests(self) -> float:
        """The fraction of the travel within which a stick counts as released."""
        return min(self.neutral, self.dead_zone) if self.dead_zone else self.neutral

    def _aside(self, axes: Sequence[float], buttons: Sequence[int],
               turn: float) -> Tuple[float, float]:
        """Return (turn, sideways), in [-1, 1]."""
        if self.sideways_button is not None and is_pressed(buttons, self.sideways_button):
            return 0.0, turn
        there = self.sideways is not None and self.sideways.index < len(axes)
        return turn, self.sideways.read(axes) if self.sideways and there else 0.0

    def _held(self, buttons: Sequence[int]) -> bool:
        """Return whether the dead-man button is held; always true without such a button.

        :raises JoyRefused: the device does not have that button
        """
        if self.dead_man is None:
            return True
        if isinstance(self.dead_man, str) and buttons:  # ANY
            return any(buttons)
        if isinstance(self.dead_man, str) or len(buttons) <= self.dead_man:
            raise JoyRefused('too_few_buttons', 'a Joy message with {} buttons; the dead-man '
                             'button of profile {} is {}. Calibrate the pad on the page Pad, '
                             'or set /mux/dead_man to false'.format(
                                 len(buttons), self.name, self.dead_man))
        return bool(buttons[self.dead_man])

    def without_dead_man(self) -> 'Profile':
        """Return the same profile without a dead-man button."""
        return replace(self, dead_man=None)

    def pressed(self, buttons: Sequence[int]) -> FrozenSet[str]:
        """Return the actions whose buttons are down, as a set; missing buttons count as up."""
        if not any(buttons):
            return frozenset()
        return frozenset(action for button, action in self.actions if is_pressed(buttons, button))

    def respond(self, value: float) -> float:
        """Remove the dead zone from the value of an axis, and apply the curve to the rest."""
        size = abs(value)
        if size <= self.dead_zone:
            return 0.0
        size = (size - self.dead_zone) / (1.0 - self.dead_zone)
        return math.copysign((1.0 - self.curve) * size + self.curve * size ** 3, value)


def is_pressed(buttons: Sequence[int], index: int) -> bool:
    """Return whether a button is down; a missing button counts as up."""
    return index < len(buttons) and bool(buttons[index])


def _axis(section: Section) -> Axis:
    """Read ``{axis: 1, scale: -1}``, for a trigger with ``rest: -1``."""
    axis = Axis(section.index('axis'), section.number('scale', -10.0, 10.0, 1.0),
                section.number('rest', -1.0, 1.0, 0.0))
    if axis.scale == 0.0:
        raise section.error('scale', 'must not be 0: the axis would do nothing')
    section.close()
    return axis


def parse_profile(text: str, origin: str) -> Profile:
    """Return the :class:`Profile` that a YAML text describes.

    :raises ConfigError: names the file and the wrong key
    """
    section = parse_yaml(text, origin)
    dead_zone = section.number('dead_zone', 0.0, 0.9, 0.0)
    buttons = [(section.index(action + '_button', None), action) for action in ACTIONS + (MARK,)]
    profile = Profile(
        name=section.text('name'),
        forward=_axis(section.section('forward')),
        turn=_axis(section.section('turn')),
        sideways=_axis(section.section('sideways')) if 'sideways' in section else None,
        sideways_button=section.index('sideways_button', None),
        dead_zone=dead_zone,
        neutral=section.number('neutral', 0.0, 0.9, max(0.02, dead_zone)),
        dead_man=_dead_man(section),
        curve=section.number('curve', 0.0, 1.0, 0.0),
        turbo=section.index('turbo_button', None), shift=section.index('shift_button', None),
        without_turbo=section.number('without_turbo', 0.05, 1.0, 0.5),
        actions=tuple((button, action) for button, action in buttons if button is not None),
        match=_match(section.section('match', None)))
    taken: List[object] = [button for button, _ in profile.actions]
    taken += [profile.turbo, profile.sideways_button]
    for name, button in (('dead_man_button', profile.dead_man), ('shift_button', profile.shift)):
        if button is not None and button in taken:
            raise section.error(name, 'button {} has another meaning already; {} can have no '
                                'other'.format(button, 'a dead-man button'
                                               if name.startswith('dead') else 'it'))
        taken.append(button)
    profile = replace(profile, bindings=read_bindings(section, _layout(profile)))
    if profile.dead_man == ANY and (profile.shift is not None or profile.bindings):
        raise section.error('dead_man_button', 'with any, no button is left for accessories: name '
                            'one')
    section.close()
    return profile


def _layout(profile: Profile) -> Layout:
    """Return what a profile uses for anything but accessories."""
    always: Dict[object, str] = {
        profile.dead_man: 'the dead-man button', profile.shift: 'the shift button',
        profile.turbo: 'turbo', profile.sideways_button: 'sideways',
        **{button: action for button, action in profile.actions if action == STOP_ALL}}
    return Layout(
        profile.shift, {button: meaning for button, meaning in always.items()
                        if isinstance(button, int)}, dict(profile.actions),
        [axis.index for axis in (profile.forward, profile.turn, profile.sideways) if axis])


def _dead_man(section: Section) -> Union[int, str, None]:
    """Read ``dead_man_button: 4`` or ``dead_man_button: any``."""
    value = section.take('dead_man_button', None)
    if value is None:
        return None
    if value == ANY:
        return ANY
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise section.error('dead_man_button', 'expected a whole number from 0 up, or any, got '
                            '{!r}'.format(value))
    return value


def _match(section: Optional[Section]) -> Match:
    """Read ``{guids: [...], names: [...]}``."""
    if section is None:
        return Match()
    match = Match(tuple(guid.lower() for guid in section.texts('guids', ())),
                  section.texts('names', ()))
    for guid in match.guids:
        if len(guid) != 32 or not set(guid) <= set('0123456789abcdef'):
            raise section.error('guids', 'expected 32 hexadecimal digits as SDL shows them, got '
                                '{!r}'.format(guid))
    section.close()
    return match
