# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The interface of every task: poses and points in, a velocity and a sentence out.

A task is a plain object, called twenty times a second by :mod:`mhri.tasks.run`, which avoids
obstacles, ends the task when necessary, and brings its robot to rest.
"""
from dataclasses import dataclass, field
import math
from typing import (
    Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union)

import numpy as np

from mhri.base.accessories import Accessory
from mhri.base.config import parse_yaml, Section
from mhri.base.geometry import Pose, within
from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits

# States of a task under way.
RUNNING, WAITING = 'running', 'waiting'
# States of an ended task.
DONE, TIMEOUT, BLOCKED, LOST = 'done', 'timeout', 'blocked', 'lost'
TAKEN_OVER, STOPPED, FAILED = 'taken_over', 'stopped', 'failed'
ENDS = (DONE, TIMEOUT, BLOCKED, LOST, TAKEN_OVER, STOPPED, FAILED)
# States after which the robot may resume the task.
RESUMES = (TAKEN_OVER, STOPPED, LOST, BLOCKED, TIMEOUT)

NOWHERE = np.zeros((0, 2))
MAX_CORNERS = 1000
_TURNS = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
_CIRCLE = np.column_stack((np.cos(_TURNS), np.sin(_TURNS)))
# A parameter of every task: see Values.team.
TEAM = 'team'
# Prefix of the name of a mark: names of robots have no space.
MARK = 'mark '


@dataclass(frozen=True)
class Body:
    """The body of a robot: radius of its enclosing disc [m], and its speed limits."""

    radius_m: float
    limits: Limits


@dataclass(frozen=True)
class Other:
    """Another robot in the same frame.

    ``goes_first`` is true if this robot has to give way: the other is also on a task, and has the
    lower number. ``radius_m`` is the radius of its enclosing disc.
    """

    pose: Pose
    goes_first: bool = False
    radius_m: float = 0.25


@dataclass(frozen=True)
class Senses:
    """The sensor data of a robot at one instant.

    ``pose`` is its pose in the frame of the map if it is placed, else by its own odometry;
    ``odometry`` is always the latter, ``captured`` the pose by motion capture or None.
    ``points`` is an array (n, 2) of laser points in its own frame [m]: x ahead, y to the left.
    ``others`` are the other placed robots by name; none if this robot is not placed. ``fence`` is
    an array (n, 2) of the corners of the fence, in the frame of ``pose`` [m], empty without one.
    ``floor`` is the edge of the free floor of the map around the robot, an array (n, 2) in its own
    frame [m]; tasks also get it as part of ``points``.
    """

    now_s: float
    pose: Pose
    odometry: Pose
    captured: Optional[Pose] = None
    points: np.ndarray = field(default_factory=lambda: NOWHERE)
    others: Mapping[str, Other] = field(default_factory=dict)
    fence: np.ndarray = field(default_factory=lambda: NOWHERE)
    floor: np.ndarray = field(default_factory=lambda: NOWHERE)


class Act(NamedTuple):
    """One use of an accessory of the robot: its key, and the choice, '' for none."""

    key: str
    choice: str = ''


@dataclass(frozen=True)
class Step:
    """The output of a task: the requested velocity, its state, and a sentence about it.

    ``left_m`` is the remaining distance [m], None if that is meaningless; ``said`` are lines to be
    logged once, ``acts`` accessories to be used once.
    """

    velocity: Velocity = ZERO
    state: str = RUNNING
    text: str = ''
    left_m: Optional[float] = None
    said: Tuple[str, ...] = ()
    acts: Tuple[Act, ...] = ()


@dataclass(frozen=True)
class Start:
    """The inputs for starting a task: the robot, its team, its body, and its trail (odometry).

    ``trail_ages_s`` is the age of each point of the trail [s], ``marks`` are named poses in the
    frame of the map, ``drive`` are recorded poses of the robot (odometry), ``accessories`` those of
    its type.
    """

    robot: str
    team: Tuple[str, ...]
    body: Body
    trail: Tuple[Pose, ...] = ()
    trail_ages_s: Tuple[float, ...] = ()
    marks: Mapping[str, Pose] = field(default_factory=dict)
    drive: Tuple[Pose, ...] = ()
    accessories: Tuple[Accessory, ...] = ()

    @property
    def place(self) -> int:
        """Its index in the team."""
        return self.team.index(self.robot)


@dataclass(frozen=True)
class Target:
    """A goal: a position [m], a heading [rad] or None, and whether it is in the odometry frame."""

    x_m: float
    y_m: float
    heading_rad: Optional[float] = None
    by_odometry: bool = False


class Task:
    """One robot's task: a subclass in a file of its own, and a row in :mod:`mhri.tasks.rows`.

    ``pass_by`` names robots that need no clearance, such as the leader of a follower.
    """

    pass_by: Tuple[str, ...] = ()

    def step(self, senses: Senses) -> Step:
        """Return the next step of the robot; called 20 times a second."""
        raise NotImplementedError


Corners = Tuple[Tuple[float, float], ...]
Value = Union[float, str, None, Corners]
Where = Callable[[str], Optional[Pose]]
NUMBER, TEXT, ROUTE = 'number', 'text', 'route'


@dataclass(frozen=True)
class Field:
    """A parameter of a task.

    :param default: None: optional; REQUIRED: required
    :param kind: NUMBER in [least, greatest], TEXT, or ROUTE: a list of [x, y] [m]
    :param choices: allowed values of a TEXT; empty: any
    :param needs_place: whether giving it requires the robot to be placed
    :param whole: whether a NUMBER has to be an integer
    """

    name: str
    unit: str
    text: str
    default: Value
    least: float = math.nan
    greatest: float = math.nan
    kind: str = NUMBER
    choices: Tuple[str, ...] = ()
    needs_place: bool = False
    whole: bool = False


REQUIRED = '\0required'
ODOM = 'odom'
# For tasks that do not require a place on the map.
FRAME = Field('frame', '', 'odom: by its own odometry, no place is needed; else in the frame of '
              'the map', '', kind=TEXT, choices=('', ODOM))


class Values:
    """The parameters of one task, read and checked."""

    def __init__(self, values: Mapping[str, Value], team: Tuple[str, ...] = ()) -> None:
        self._values = dict(values)
        #: the robots of the team, if they differ from the started ones
        self.team = team

    def number(self, name: str) -> float:
        """Return the number of a parameter that was given."""
        value = self._values[name]
        assert isinstance(value, float)
        return value

    def maybe(self, name: str) -> Optional[float]:
        """Return the number of a parameter, None if it was not given."""
        return None if self._values[name] is None else self.number(name)

    def text(self, name: str) -> str:
        """Return the text of a parameter."""
        value = self._values[name]
        assert isinstance(value, str)
        return value

    def route(self, name: str) -> Corners:
        """Return the positions (x, y) [m] of a parameter."""
        value = self._values[name]
        assert isinstance(value, tuple)
        return value

    def is_given(self, row: Field) -> bool:
        """Return whether a parameter differs from its default."""
        return self._values.get(row.name, row.default) != row.default

    def by_odometry(self) -> bool:
        """Return whether positions are in the robot's own odometry frame."""
        return self._values.get(FRAME.name) == ODOM


@dataclass(frozen=True)
class TaskKind:
    """A row: the name of a task, its description, its parameters, and its factory.

    :param make: function (values, start) -> :class:`Task`; it raises ValueError with a sentence
        if the robot cannot be started
    :param needs_place: robots have to be placed in the frame of the map; see :meth:`placed`
    :param slots: function (values, count, where) -> the goals (x, y) [m] in the frame of the map of
        a number of robots, () if unknown; ``where`` returns the :class:`Pose` of a robot by its
        name, of a mark by :data:`MARK` and its name, or None. Robots are assigned to goals so that
        their paths do not cross
    """

    key: str
    label: str
    text: str
    fields: Tuple[Field, ...]
    make: Callable[[Values, Start], Task]
    needs_place: bool = False
    slots: Optional[Callable[[Values, int, Where], Corners]] = None

    def placed(self, values: Values) -> bool:
        """Return whether the task requires a placed robot with these parameters."""
        return (self.needs_place and not values.by_odometry()) or any(
            values.is_given(row) for row in self.fields if row.needs_place)

    def read(self, parameters: str) -> Values:
        """Return the parameters of a YAML text.

        :raises ConfigError: a parameter is invalid; the text names it and the expected value
        """
        origin = 'task ' + self.key
        section = parse_yaml(parameters if parameters.strip() else '{}', origin)
        values = Values({row.name: _value(section, row) for row in self.fields}, _team(section))
        section.close()
        return values


def _team(section: Section) -> Tuple[str, ...]:
    """Return the robots of the team: a robot that continues alone keeps its place in it."""
    names = section.take(TEAM, [])
    if not isinstance(names, list) or len(names) > MAX_CORNERS or len(set(
            map(str, names))) < len(names) or not all(isinstance(name, str) for name in names):
        raise section.error(TEAM, 'expected a list of robots, each once')
    return tuple(names)


def _value(section: Section, row: Field) -> Value:
    if row.default == REQUIRED and row.name not in section:
        raise section.error(row.name, 'is missing: {}{}'.format(
            row.text, ' [{}]'.format(row.unit) if row.unit else ''))
    if row.kind == NUMBER:
        value = section.number(row.name, row.least, row.greatest,
                               row.default if isinstance(row.default, float) else None)
        if row.whole and value is not None and not value.is_integer():
            raise section.error(row.name, 'expected a whole number, got {:g}'.format(value))
        return value
    if row.kind == TEXT:
        return _text(section, row)
    return _route(section, row.name)


def _text(section: Section, row: Field) -> str:
    text = section.text(row.name, row.default if isinstance(row.default, str) else '')
    if row.choices and text not in row.choices:
        raise section.error(row.name, 'expected {}'.format(
            ' or '.join(choice or 'nothing' for choice in row.choices)))
    return text


def _route(section: Section, name: str) -> Corners:
    rows = section.take(name)
    good = isinstance(rows, list) and 1 <= len(rows) <= MAX_CORNERS and all(
        isinstance(row, list) and len(row) == 2 and all(
            type(value) in (int, float) and abs(value) <= 1000.0 for value in row)
        for row in rows)
    if not good or not isinstance(rows, list):
        raise section.error(name, 'expected a list of [x, y] [m], e.g. [[1.0, 0.0], [1.0, 2.0]]')
    return tuple((float(row[0]), float(row[1])) for row in rows)


def turn_to(pose: Pose, x_m: float, y_m: float) -> float:
    """Return the bearing of a position from a pose [rad, (-pi, pi]]."""
    return wrapped(math.atan2(y_m - pose.y_m, x_m - pose.x_m) - pose.heading_rad)


def way(pose: Pose, x_m: float, y_m: float) -> float:
    """Return the distance from a pose to a position [m]."""
    return math.hypot(x_m - pose.x_m, y_m - pose.y_m)


def discs(pose: Pose, others: Iterable[Other], more_m: float) -> np.ndarray:
    """Return the edges of other robots as an array (n, 2) in the frame of a pose [m].

    :param more_m: margin added to their radius, since they move [m]
    """
    seen = np.array(circles(pose, others)).reshape(-1, 3)
    edges: np.ndarray = seen[:, None, :2] + (seen[:, 2:] + more_m)[..., None] * _CIRCLE
    return edges.reshape(-1, 2)


def circles(pose: Pose, others: Iterable[Other]) -> List[Tuple[float, float, float]]:
    """Return (ahead, to the left, radius) [m] of other robots in the frame of a pose."""
    return [within(pose, other.pose) + (other.radius_m,) for other in others]


def wrapped(angle_rad: float) -> float:
    """Return an angle in [-pi, pi]."""
    return math.remainder(angle_rad, 2.0 * math.pi)


def by_key(kinds: Sequence[TaskKind]) -> Dict[str, TaskKind]:
    """Return {key: kind}."""
    return {kind.key: kind for kind in kinds}


def shown(pose: Pose) -> str:
    """Describe a pose."""
    return 'x {:.2f} m, y {:.2f} m, heading {:.0f} degrees'.format(
        pose.x_m, pose.y_m, math.degrees(pose.heading_rad))
