# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the pad of one source does with accessories, by the bindings of its profile. No ROS, no
clock.

An input counts once it was at rest: one that is off rest when the device or the shifted layer
changes, when the pad was silent, when another robot is selected, or while the pad may not drive,
has to be let go first. That holds for driving as well, for the sticks of both layers: letting the
shift button go sets nothing in motion.
"""
import math
from typing import (
    AbstractSet, Dict, FrozenSet, List, Mapping, NamedTuple, Optional, Sequence, Tuple)

from mhri.base.accessories import OFF, ON
from mhri.devices.bindings import Binding, Input, TOGGLED
from mhri.devices.profile import is_pressed, Profile, STOP_ALL
from mhri.driving.accessory_rule import AccessoryRule, SILENT_S
from mhri.driving.drive import Drive, Orders


class Use(NamedTuple):
    """What a pad asks of one accessory: a choice (not None), or values from -1 to 1."""

    key: str
    choice: Optional[str] = None
    value: Tuple[float, ...] = ()


class PadAccessories:
    """The bindings of the pad of one source.

    Call :meth:`read` with each message, then :meth:`uses`, or :meth:`act`.
    """

    def __init__(self) -> None:
        self._device: object = None
        self._at = -math.inf
        self._shifted = False
        self._group: Sequence[str] = ()
        self._rows: Sequence[Binding] = ()
        self._travel: Dict[Input, float] = {}
        # Off rest, and not let go since something has changed.
        self._waits: FrozenSet[Input] = frozenset()
        self._down: Sequence[Binding] = ()
        self._held: Dict[str, Tuple[float, ...]] = {}
        # {key: choice that was asked last}
        self._asked: Dict[str, str] = {}

    def read(self, profile: Profile, device: object, axes: Sequence[float],
             buttons: Sequence[int], now: float) -> Tuple[Sequence[float], AbstractSet[str]]:
        """Read a message.

        :param device: identifies the device and its connection
        :returns: (the axes for driving, the actions whose buttons are down)
        """
        sound = all(map(math.isfinite, axes))
        shifted = profile.shift is not None and is_pressed(buttons, profile.shift)
        anew = (device, shifted) != (self._device, self._shifted)
        silent = now - self._at >= SILENT_S
        # Nothing in an unusable message is believed, nor that anything was let go.
        self._device, self._shifted, self._at = device if sound else None, shifted, now
        self._rows = [row for row in profile.bindings if row.shift == shifted] if sound else ()
        current = {row.source for row in self._rows}
        self._travel = {row.source: _travel(profile, row.source, axes, buttons)
                        for row in profile.bindings} if sound else {}
        self._waits = frozenset(
            source for source, travel in self._travel.items() if travel and (
                anew or source in self._waits or silent and source in current))
        hidden = self._waits | (current if shifted else frozenset())
        pressed = profile.pressed(buttons)
        taken = {source.button for source in hidden}
        return (_at_rest(profile, axes, {source.axis for source in hidden}),
                pressed and frozenset(action for button, action in profile.actions
                                      if action in pressed
                                      and (action == STOP_ALL or button not in taken)))

    def uses(self, may_move: bool, group: Sequence[str]) -> List[Use]:
        """Return what the message asks for; what ends comes first.

        :param may_move: whether the pad may drive; else what is held ends, and is let go first
        :param group: the robots that are driven
        """
        if not may_move or group != self._group:
            self._waits |= {row.source for row in self._rows
                            if row.choice is None and self._travel[row.source]}
        self._group = group
        down, totals = [], {}  # type: List[Binding], Dict[str, Tuple[float, float]]
        for row in self._rows:
            travel = 0.0 if row.source in self._waits else self._travel[row.source]
            if row.choice is None:
                x, y = (*row.value, 0.0)[:2]
                before = totals.get(row.key, (0.0, 0.0))
                totals[row.key] = before[0] + travel * x, before[1] + travel * y
            elif row.is_pressed(travel):
                down.append(row)
        sizes = {row.key: len(row.value) for row in self._rows}
        held = {key: tuple(max(-1.0, min(1.0, one)) for one in value[:sizes[key]])
                for key, value in totals.items() if any(value)}
        ended = [Use(key, None, (0.0,) * len(value)) for key, value in self._held.items()
                 if key not in held]
        newly = [Use(row.key, row.choice) for row in down if row not in self._down]
        self._held, self._down = held, down
        return ended + newly + [Use(key, None, value) for key, value in held.items()]

    def act(self, drive: Drive, counts: bool, now: float) -> Tuple[Orders, str]:
        """Carry out what the message asks for, on the selected robots that have the accessory.

        :param counts: whether the message is one of the active source
        :returns: (what to send, what is refused, or '')
        """
        group = [name for name, robot in drive.robots.items() if robot.selected]
        waits_for = drive.waits_for(now)
        orders: Orders = []
        problem = ''
        for use in self.uses(counts and not waits_for, group):
            rules = {name: drive.accessories.of(name)[use.key] for name in group
                     if use.key in drive.accessories.of(name)}
            if not counts and use.choice is not None or not rules and use.value and not any(
                    use.value):
                continue
            if use.choice is not None and waits_for and any(
                    rule.spec.moves for rule in rules.values()):
                problem = '{} does not act: {}'.format(use.key, waits_for)
                continue
            more, refused = drive.on_accessory(
                drive.lease.operator, list(rules), use.key, self._choice(use, rules), use.value,
                now)
            orders += more
            problem = problem or refused
        return orders, problem

    def _choice(self, use: Use, rules: Mapping[str, AccessoryRule]) -> str:
        """Return the choice of a use; a toggle goes by what is reported, else by what was asked."""
        if use.choice != TOGGLED:
            return use.choice or ''
        known = [rule.choice for rule in rules.values() if rule.known]
        now = known[0] if known else self._asked.get(use.key, OFF)
        self._asked[use.key] = OFF if now == ON else ON
        return self._asked[use.key]


def _travel(profile: Profile, source: Input, axes: Sequence[float],
            buttons: Sequence[int]) -> float:
    """Return how far an input is from rest, as the profile reads a stick."""
    travel = source.travel(axes, buttons)
    if source.axis is None:
        return travel
    return 0.0 if abs(travel) <= profile.rests else profile.respond(travel)


def _at_rest(profile: Profile, axes: Sequence[float],
             hidden: AbstractSet[Optional[int]]) -> Sequence[float]:
    """Return axes with those at rest that do not drive now."""
    rests = {axis.index: axis.rest for axis in (profile.forward, profile.turn, profile.sideways)
             if axis and axis.index in hidden}
    return tuple(rests.get(number, value) for number, value in enumerate(axes)) if rests else axes
