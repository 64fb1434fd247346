# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The scenario of a drill, from its file: plan, robots, targets, timed faults, time limit."""
from dataclasses import dataclass, replace
import math
import re
from typing import Dict, Iterable, List, Optional, Tuple

from mhri.base.config import parse_yaml, Section
from mhri.sim.faults import checked_duration, checked_value, Fault, fault_named, FaultRefused

# Maximum distance from the origin of a plan [m], number of robots, duration of a drill [s].
FARTHEST_M, MAX_ROBOTS, MAX_S = 1000.0, 12, 7200.0
_NAME = re.compile(r'[a-z][a-z0-9_]*\Z')

Point = Tuple[float, float]


@dataclass(frozen=True)
class Target:
    """An object to find, or a place to pass, at x, y [m] of the plan.

    It is found once a robot, the named one or any, is within ``range_m`` of it, without a wall
    between, and has it within ``view_rad`` (full circle: 2 pi) around its heading.
    """

    name: str
    x_m: float
    y_m: float
    range_m: float
    view_rad: float
    robot: str = ''


@dataclass(frozen=True)
class TimedFault:
    """A fault of one robot at a time from the start of the drill; see ``SetFault.srv``.

    ``for_s`` is 0 for the regular delay of a link, which needs no reaction.
    """

    robot: str
    fault: Fault
    value: float
    at_s: float
    for_s: float


@dataclass(frozen=True)
class Scenario:
    """A drill.

    ``plan`` is the file of its building; ``types`` are the types of the robots bot1, bot2, ... as
    in ``sim.launch``. It ends when all targets are found, with ``in_order`` in this order, or
    after ``limit_s``. ``routes`` are the routes of the scripted operator.
    """

    name: str
    title: str
    about: str
    plan: str
    types: Tuple[str, ...]
    targets: Tuple[Target, ...]
    in_order: bool
    faults: Tuple[TimedFault, ...]
    limit_s: float
    routes: Dict[str, Tuple[Point, ...]]

    @property
    def robots(self) -> Tuple[str, ...]:
        """The names of its robots."""
        return tuple('bot{}'.format(number + 1) for number in range(len(self.types)))


def on_links(faults: Iterable[TimedFault], delay_s: float) -> List[TimedFault]:
    """Return faults in order of time, for links with a regular delay in each direction [s].

    A fault's delay is added to the regular one, which is restored at the end of the fault.
    """
    found: List[TimedFault] = []
    for fault in faults:
        if delay_s and fault.fault.key == 'delay':
            found.append(replace(fault, value=delay_s, at_s=fault.at_s + fault.for_s, for_s=0.0))
            fault = replace(fault, value=min(fault.value + delay_s, fault.fault.high))
        found.append(fault)
    return sorted(found, key=lambda each: each.at_s)


def _robot(section: Section, robots: Tuple[str, ...], default: Optional[str] = None) -> str:
    name = section.text('robot') if default is None else section.text('robot', default)
    if name not in robots and name != default:
        raise section.error('robot', 'expected {}, got {!r}'.format(' or '.join(robots), name[:60]))
    return name


def _target(section: Section, robots: Tuple[str, ...]) -> Target:
    target = Target(
        section.text('name'), section.number('x', -FARTHEST_M, FARTHEST_M),
        section.number('y', -FARTHEST_M, FARTHEST_M), section.number('range', 0.05, 20.0),
        math.radians(section.number('view_deg', 1.0, 360.0, 360.0)), _robot(section, robots, ''))
    section.close()
    return target


def _fault(section: Section, robots: Tuple[str, ...]) -> TimedFault:
    robot, key = _robot(section, robots), section.text('fault')
    try:
        fault = fault_named(key)
        value = checked_value(fault, section.number('value', -1e6, 1e6, math.nan))
        for_s = section.number('for', 0.1, MAX_S)
        checked_duration(fault, for_s)
    except FaultRefused as error:
        raise section.error('fault', str(error))
    timed = TimedFault(robot, fault, value, section.number('at', 0.0, MAX_S), for_s)
    section.close()
    return timed


def _route(section: Section, robot: str) -> Tuple[Point, ...]:
    rows = section.take(robot, [])
    if not isinstance(rows, list):
        raise section.error(robot, 'expected a list of places [x, y]')
    points = []
    for row in rows:
        if not (isinstance(row, list) and len(row) == 2 and all(
                type(part) in (int, float) and abs(part) <= FARTHEST_M for part in row)):
            raise section.error(robot, 'expected a place [x, y] in metres, got {!r}'.format(row))
        points.append((float(row[0]), float(row[1])))
    return tuple(points)


def parse_scenario(text: str, origin: str, name: str) -> Scenario:
    """Return the :class:`Scenario` of a YAML text.

    :param name: name of its file, without the extension
    :raises ConfigError: the text is invalid; the error has the file and the key
    """
    top = parse_yaml(text, origin)
    types = top.texts('robots')
    if not 1 <= len(types) <= MAX_ROBOTS or not all(_NAME.match(kind) for kind in types):
        raise top.error('robots', 'expected 1 to {} types, e.g. turtlebot3_burger'.format(
            MAX_ROBOTS))
    robots = tuple('bot{}'.format(number + 1) for number in range(len(types)))
    plan = top.text('plan')
    if not re.match(r'[a-z0-9_]+\.yaml\Z', plan):
        raise top.error('plan', 'expected the name of a file in plans/, got {!r}'.format(plan[:60]))
    routes = top.section('routes')
    scenario = Scenario(
        name, top.text('title'), top.text('about'), plan, types,
        tuple(_target(row, robots) for row in top.sections('targets')),
        top.flag('in_order', False),
        tuple(_fault(row, robots) for row in top.sections('faults')) if 'faults' in top else (),
        top.number('limit_s', 1.0, MAX_S), {robot: _route(routes, robot) for robot in robots})
    routes.close()
    top.close()
    if not scenario.targets:
        raise top.error('targets', 'expected at least one: a drill without any never ends early')
    return scenario
