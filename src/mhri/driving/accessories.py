# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which accessories may act: under the authority of the drive, robot by robot. No ROS, no clock.

A moving part is driving: it acts for the operator in control on robots that are selected, or for a
task on the robot that obeys it, and under the conditions under which the robot itself may move. As
soon as one of them ends, whatever the cause, every moving part of the robot is ended.
"""
import math
from typing import Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from mhri.base.accessories import Accessory, Act, KEEP, LOOKED_AT, READOUT
from mhri.base.reasons import NEUTRAL, NO_LEASE, UNDERTAKER
from mhri.driving.accessory_rule import AccessoryRule, SILENT_S
from mhri.driving.robot_rule import CLOSED, IDLE, OPERATOR, RobotRule, TASK

#: the reason code of a robot that is not selected
NOT_SELECTED = 'not_selected'
# Maximum number of callers without control that are remembered.
MAX_REFUSED = 8
#: (robot, act to send to it now)
Order = Tuple[str, Act]

# The states of a robot in which its moving parts may act, by who asks.
_MOVES = {OPERATOR: (OPERATOR,), TASK: (TASK,), LOOKED_AT: (OPERATOR, IDLE)}


class Authority(NamedTuple):
    """What the drive says of all robots.

    :param leased: whether the operator in control repeats its wish
    :param holds: how often driving had to begin anew, at neutral: another mode, a lost source
    :param undertaken: whether the process that stands by is alive
    """

    leased: bool
    undertaken: bool
    holds: int = 0


class Accessories:
    """The accessories of all robots.

    :param robots: {name: :class:`RobotRule`} of the drive, read only
    :param authority: returns the current :class:`Authority`
    """

    def __init__(self, robots: Mapping[str, RobotRule],
                 authority: Callable[[], Authority]) -> None:
        self._robots, self._authority = robots, authority
        self._rules: Dict[str, Dict[str, AccessoryRule]] = {}
        # {caller: when it was refused last, for want of control}.
        self._refused_at: Dict[str, float] = {}
        # {(robot, key): who asks} of those that have to be ended once they may no longer act.
        self._active: Dict[Tuple[str, str], str] = {}
        # Authority.holds when the last of them began or went on.
        self._holds_then = 0

    def open(self, name: str, specs: Iterable[Accessory], now: float) -> None:
        """Add the accessories of a robot that act, replacing its former ones."""
        self._rules[name] = {spec.key: AccessoryRule(spec, now) for spec in specs
                             if spec.kind != READOUT}

    def close(self, name: str) -> List[Order]:
        """Remove those of a robot; return what ends them."""
        found = self._end(name)
        self._rules.pop(name, None)
        return found

    def of(self, name: str) -> Mapping[str, AccessoryRule]:
        """Return {key: :class:`AccessoryRule`} of a robot; read only."""
        return self._rules.get(name, {})

    def stands(self, name: str, key: str, by: str = OPERATOR) -> str:
        """Return why an accessory would not obey: a code of the reasons, '' if it would."""
        robot, rule = self._robots.get(name), self.of(name).get(key)
        if robot is None or rule is None:
            return CLOSED
        authority = self._authority()
        if by == OPERATOR and not authority.leased:
            return NO_LEASE
        looked_at = rule.spec.of == LOOKED_AT and by == OPERATOR
        if by == OPERATOR and not (robot.selected or looked_at):
            return NOT_SELECTED
        if rule.spec.on_stop == KEEP:
            return robot.held_by or (CLOSED if robot.state == CLOSED else '')
        if not authority.undertaken:
            return UNDERTAKER
        if robot.state in _MOVES[LOOKED_AT if looked_at else by]:
            return ''
        return robot.stop_reason or NOT_SELECTED

    def refuse(self, caller: str, now: float) -> None:
        """Note a caller that is not in control: what it holds it has to release first."""
        self._refused_at = {name: at for name, at in self._refused_at.items()
                            if now - at < SILENT_S}
        if len(self._refused_at) < MAX_REFUSED:
            self._refused_at[caller] = now

    def act(self, robots: Sequence[str], key: str, choice: str, value: Sequence[float], now: float,
            caller: str, by: str = OPERATOR) -> Tuple[List[Order], str]:
        """Handle an action of somebody who may ask; return (what to send, the problem or '').

        :param robots: names; empty: all that are selected, only where ``team`` says so
        :param value: of a held kind, from -1 to 1
        :param by: OPERATOR or TASK
        """
        names = list(robots) or [name for name, robot in self._robots.items() if robot.selected]
        rules = {name: self.of(name)[key] for name in names if key in self.of(name)}
        problem = self._problem(robots, rules, key, choice, value)
        if problem:
            return [], problem
        found: List[Order] = []
        # Another robot does not set off in the middle of a motion, nor one that was held before
        # its caller was in control: the input is released first.
        refused = now - self._refused_at.get(caller, -math.inf) < SILENT_S
        if refused:
            self._refused_at[caller] = now
        holds = refused or self._holds(key, by)
        for name, rule in rules.items():
            stands = self.stands(name, key, by)
            act = None
            if value and not any(value):
                # A release is always allowed.
                self._refused_at.pop(caller, None)
                act = rule.act(choice, value, now)
            elif stands or holds and not rule.held:
                act = rule.skip(now)
                problem = problem or '{}: {} does not act: {}'.format(
                    name, key, stands or NEUTRAL)
            else:
                act = rule.act(choice, value, now)
            if act is not None:
                found.append((name, act))
            self._note(name, rule, by)
        return found, problem

    def _problem(self, robots: Sequence[str], rules: Mapping[str, AccessoryRule], key: str,
                 choice: str, value: Sequence[float]) -> str:
        """Return why an action is impossible whatever the robots' state, '' if it is possible."""
        missing = [name for name in robots if name not in rules]
        if missing or not rules:
            return '{} has no accessory {!r}'.format(
                ', '.join(missing[:5]) or 'no selected robot', key[:40])
        for rule in rules.values():
            problem = rule.spec.problem(choice, value)
            if problem:
                return problem
            if not rule.spec.team and (len(rules) > 1 or not robots):
                return '{} acts on one robot at a time: name it'.format(key)
        return ''

    def _holds(self, key: str, by: str) -> bool:
        """Return whether an accessory of this name is held on any robot."""
        return any(rule.held and self._active.get((name, key), by) == by
                   for name, rules in self._rules.items()
                   for rule in (rules.get(key),) if rule is not None)

    def _note(self, name: str, rule: AccessoryRule, by: str) -> None:
        """Remember whether it has to be ended."""
        if rule.active and rule.spec.moves:
            self._active[name, rule.spec.key] = by
            self._holds_then = self._authority().holds
        else:
            self._active.pop((name, rule.spec.key), None)

    def on_finished(self, name: str, key: str) -> None:
        """Handle the end of the goal of an action: nothing is left to cancel."""
        rule = self.of(name).get(key)
        if rule is not None:
            rule.on_finished()
            self._active.pop((name, key), None)

    def settle(self) -> List[Order]:
        """End what may no longer act; call it after every event. Costs nothing while all rest."""
        found: List[Order] = []
        held = bool(self._active) and self._authority().holds != self._holds_then
        for (name, key), by in list(self._active.items()):
            if held and by == OPERATOR or self.stands(name, key, by):
                found += self._end(name, key)
        return found

    def end_all(self) -> List[Order]:
        """End everything that is active, e.g. when control passes; each is released first."""
        return [order for name, key in list(self._active) for order in self._end(name, key)]

    def _end(self, name: str, only: Optional[str] = None) -> List[Order]:
        found = []
        for key, rule in self.of(name).items():
            if only in (None, key):
                act = rule.end()
                self._active.pop((name, key), None)
                if act is not None:
                    found.append((name, act))
        return found

    def tick(self, now: float) -> List[Order]:
        """Handle the passage of time; return what to send."""
        found: List[Order] = []
        for name, rules in self._rules.items():
            for rule in rules.values():
                act = rule.tick(now)
                if act is not None:
                    found.append((name, act))
                    self._note(name, rule, self._active.get((name, rule.spec.key), OPERATOR))
        return found

    def next_tick(self) -> Optional[float]:
        """Return when to call :meth:`tick` next [s], None if it is not urgent."""
        times = [rule.next_tick() for rules in self._rules.values() for rule in rules.values()]
        return min((time_s for time_s in times if time_s is not None), default=None)
