# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What every task is given and what it answers: poses and points in, a velocity and a sentence out.

A task is a plain object: it is asked twenty times a second by :mod:`mhri.tasks.run`, which
keeps it from obstacles, ends it when it has to, and brings its robot to rest.
"""
from dataclasses import dataclass, field
import math
from typing import Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from mhri.base.config import parse_yaml, Section
from mhri.base.limits import Velocity, ZERO
from mhri.base.mocap import Pose
from mhri.base.robot_types import Limits

# How a task is getting on.
RUNNING, WAITING = 'running', 'waiting'
# How it ended.
DONE, TIMEOUT, BLOCKED, LOST = 'done', 'timeout', 'blocked', 'lost'
TAKEN_OVER, STOPPED, FAILED = 'taken_over', 'stopped', 'failed'
ENDS = (DONE, TIMEOUT, BLOCKED, LOST, TAKEN_OVER, STOPPED, FAILED)
# After these a robot may be sent on.
RESUMES = (TAKEN_OVER, STOPPED, LOST, BLOCKED, TIMEOUT)

NOWHERE = np.zeros((0, 2))
MOST_CORNERS = 1000
_TURNS = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
_CIRCLE = np.column_stack((np.cos(_TURNS), np.sin(_TURNS)))
# The parameter that every task has: see Values.team.
TEAM = 'team'
# Before the name of a mark: no robot's name has a space.
MARK = 'mark '


@dataclass(frozen=True)
class Body:
    """What a robot can do: radius of the disc around all of it [m], limits of its speed."""

    radius_m: float
    limits: Limits


@dataclass(frozen=True)
class Other:
    """Another robot that is seen in the same frame.

    ``goes_first`` is true where this robot has to let it pass: it is on a task, too, and has the
    lower number. ``radius_m`` is that of the disc around it.
    """

    pose: Pose
    goes_first: bool = False
    radius_m: float = 0.25


@dataclass(frozen=True)
class Senses:
    """What a robot senses at one instant.

    ``pose`` is its place in the frame of the map where it is placed, else by its own odometry;
    ``odometry`` is the latter in any case, ``captured`` the place by motion capture or None.
    ``points`` is an array (n, 2) of what its laser has met, in its own frame [m]: x ahead, y to the
    left. ``others`` are the other robots that are placed, by their names; none where it is not.
    ``fence`` is an array (n, 2) of the corners of what no task leaves, in the frame of ``pose``
    [m], empty where there is none. ``floor`` is where the free floor of the map ends around the
    robot, an array (n, 2) in its own frame [m]; a task is shown it among ``points`` as well.
    """

    now_s: float
    pose: Pose
    odometry: Pose
    captured: Optional[Pose] = None
    points: np.ndarray = field(default_factory=lambda: NOWHERE)
    others: Mapping[str, Other] = field(default_factory=dict)
    fence: np.ndarray = field(default_factory=lambda: NOWHERE)
    floor: np.ndarray = field(default_factory=lambda: NOWHERE)


@dataclass(frozen=True)
class Step:
    """What a task answers: the velocity it wants, how it is getting on, and that in a sentence.

    ``left_m`` is the way that is left [m], None where that means nothing; ``said`` what is worth a
    line of its own, once.
    """

    velocity: Velocity = ZERO
    state: str = RUNNING
    text: str = ''
    left_m: Optional[float] = None
    said: Tuple[str, ...] = ()


@dataclass(frozen=True)
class Start:
    """Who is started: the robot, its place in the team, its body, and its trail (odometry).

    ``trail_ages_s`` is the age of each place of the trail [s], ``marks`` are named places in the
    frame of the map, and ``drive`` is what a recording says of where it was (odometry).
    """

    robot: str
    team: Tuple[str, ...]
    body: Body
    trail: Tuple[Pose, ...] = ()
    trail_ages_s: Tuple[float, ...] = ()
    marks: Mapping[str, Pose] = field(default_factory=dict)
    drive: Tuple[Pose, ...] = ()

    @property
    def place(self) -> int:
        """Its place in the team, from 0."""
        return self.team.index(self.robot)


@dataclass(frozen=True)
class Target:
    """Where a robot is sent: a place [m], a heading [rad] or None, and in which frame that is."""

    x_m: float
    y_m: float
    heading_rad: Optional[float] = None
    by_odometry: bool = False


class Task:
    """One robot's task: a subclass in a file of its own, and a row in :mod:`mhri.tasks.rows`.

    ``pass_by`` names robots that need no room kept to: whoever is followed is close by intent.
    """

    pass_by: Tuple[str, ...] = ()

    def step(self, senses: Senses) -> Step:
        """Return what the robot shall do now; called 20 times a second."""
        raise NotImplementedError


Corners = Tuple[Tuple[float, float], ...]
Value = Union[float, str, None, Corners]
Where = Callable[[str], Optional[Pose]]
NUMBER, TEXT, ROUTE = 'number', 'text', 'route'


@dataclass(frozen=True)
class Field:
    """A parameter of a task.

    :param default: None: may be left out; REQUIRED: has to be given
    :param kind: NUMBER in [least, greatest], TEXT, or ROUTE: a list of [x, y] [m]
    :param choices: what a TEXT may be; empty: anything
    :param needs_place: where this is given, the robot has to be placed
    :param whole: a NUMBER that counts something
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
# Of a task that needs no place where it is told so.
FRAME = Field('frame', '', 'odom: by its own odometry, no place is needed; else in the frame of '
              'the map', '', kind=TEXT, choices=('', ODOM))


class Values:
    """The parameters of one task, read and checked."""

    def __init__(self, values: Mapping[str, Value], team: Tuple[str, ...] = ()) -> None:
        self._values = dict(values)
        #: robots among which places are counted, where that is not who is started
        self.team = team

    def number(self, name: str) -> float:
        """Return a number that is there."""
        value = self._values[name]
        assert isinstance(value, float)
        return value

    def maybe(self, name: str) -> Optional[float]:
        """Return a number, None where it was left out."""
        return None if self._values[name] is None else self.number(name)

    def text(self, name: str) -> str:
        """Return a text."""
        value = self._values[name]
        assert isinstance(value, str)
        return value

    def route(self, name: str) -> Corners:
        """Return a list of places (x, y) [m]."""
        value = self._values[name]
        assert isinstance(value, tuple)
        return value

    def is_given(self, row: Field) -> bool:
        """Tell whether a parameter is something else than its default."""
        return self._values.get(row.name, row.default) != row.default

    def by_odometry(self) -> bool:
        """Tell whether places are meant in the frame of the robot's own odometry."""
        return self._values.get(FRAME.name) == ODOM


@dataclass(frozen=True)
class TaskKind:
    """A row: what the task is called, what it does, its parameters, and how one is begun.

    :param make: function (values, start) -> :class:`Task`; it raises ValueError with a sentence
        where the robot cannot be started
    :param needs_place: robots have to be placed in the frame of the map; see :meth:`placed`
    :param slots: function (values, count, where) -> the place (x, y) [m] in the frame of the map of
        each of so many robots, none where nobody can tell; ``where`` returns the :class:`Pose` of a
        robot by its name, of a mark by :data:`MARK` and its name, or None. Who takes which is
        chosen so that their ways do not cross
    """

    key: str
    label: str
    text: str
    fields: Tuple[Field, ...]
    make: Callable[[Values, Start], Task]
    needs_place: bool = False
    slots: Optional[Callable[[Values, int, Where], Corners]] = None

    def placed(self, values: Values) -> bool:
        """Tell whether a robot has to be placed for it, with these parameters."""
        return (self.needs_place and not values.by_odometry()) or any(
            values.is_given(row) for row in self.fields if row.needs_place)

    def read(self, parameters: str) -> Values:
        """Return the parameters of a YAML text.

        :raises ConfigError: names the parameter that is wrong, and what would be right
        """
        origin = 'task ' + self.key
        section = parse_yaml(parameters if parameters.strip() else '{}', origin)
        values = Values({row.name: _value(section, row) for row in self.fields}, _team(section))
        section.close()
        return values


def _team(section: Section) -> Tuple[str, ...]:
    """Return the robots among which places are counted: one that is sent on keeps its place."""
    names = section.take(TEAM, [])
    if not isinstance(names, list) or len(names) > MOST_CORNERS or len(set(
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
    good = isinstance(rows, list) and 1 <= len(rows) <= MOST_CORNERS and all(
        isinstance(row, list) and len(row) == 2 and all(
            type(value) in (int, float) and abs(value) <= 1000.0 for value in row)
        for row in rows)
    if not good or not isinstance(rows, list):
        raise section.error(name, 'expected a list of [x, y] [m], e.g. [[1.0, 0.0], [1.0, 2.0]]')
    return tuple((float(row[0]), float(row[1])) for row in rows)


def turn_to(pose: Pose, x_m: float, y_m: float) -> float:
    """Return by how much a robot has to turn to look at a place [rad, (-pi, pi]]."""
    return wrapped(math.atan2(y_m - pose.y_m, x_m - pose.x_m) - pose.heading_rad)


def way(pose: Pose, x_m: float, y_m: float) -> float:
    """Return the way from a pose to a place [m]."""
    return math.hypot(x_m - pose.x_m, y_m - pose.y_m)


def discs(pose: Pose, others: Iterable[Other], more_m: float) -> np.ndarray:
    """Return the edges of other robots as an array (n, 2) in the frame of a pose [m].

    :param more_m: they are taken for so much larger: they move
    """
    seen = np.array(circles(pose, others)).reshape(-1, 3)
    edges: np.ndarray = seen[:, None, :2] + (seen[:, 2:] + more_m)[..., None] * _CIRCLE
    return edges.reshape(-1, 2)


def within(pose: Pose, other: Pose) -> Tuple[float, float]:
    """Return where another pose lies in the frame of a pose: (ahead, to the left) [m]."""
    gap_x, gap_y = other.x_m - pose.x_m, other.y_m - pose.y_m
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return cos * gap_x + sin * gap_y, cos * gap_y - sin * gap_x


def circles(pose: Pose, others: Iterable[Other]) -> List[Tuple[float, float, float]]:
    """Return (ahead, to the left, radius) [m] of other robots in the frame of a pose."""
    return [within(pose, other.pose) + (other.radius_m,) for other in others]


def wrapped(angle_rad: float) -> float:
    """Return an angle in [-pi, pi]."""
    return math.remainder(angle_rad, 2.0 * math.pi)


def beside(pose: Pose, ahead_m: float, left_m: float) -> Tuple[float, float]:
    """Return the place (x, y) [m] that lies ahead and to the left of a pose."""
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return (pose.x_m + ahead_m * cos - left_m * sin, pose.y_m + ahead_m * sin + left_m * cos)


def by_key(kinds: Sequence[TaskKind]) -> Dict[str, TaskKind]:
    """Return {key: kind}."""
    return {kind.key: kind for kind in kinds}


def shown(pose: Pose) -> str:
    """Return a pose for a person."""
    return 'x {:.2f} m, y {:.2f} m, heading {:.0f} degrees'.format(
        pose.x_m, pose.y_m, math.degrees(pose.heading_rad))
