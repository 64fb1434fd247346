# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The content of the map as plain values: placed robots, goals, marks, the fence."""
from dataclasses import dataclass, field
import math
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from mhri.base.config import ConfigError, parse_yaml
from mhri.base.geometry import composed, Pose
from mhri.base.views import FlagView, LIVE, RobotView
from mhri.map.trail import Trail

Places = Tuple[Tuple[float, float], ...]

# Age at which a place is shown as old [s].
OLD_S = 2.0
# Maximum number of corners of a drawn route.
MAX_CORNERS = 1000


@dataclass(frozen=True)
class Placing:
    """The place of a robot: the origin of its odometry in the frame, None if it is not placed.

    ``text`` names its source, or why it is not placed, and the remedy; ``age_s`` is its age [s],
    None if it does not age.
    """

    origin: Optional[Pose] = None
    text: str = ''
    age_s: Optional[float] = None
    by: str = ''


@dataclass(frozen=True)
class MapMark:
    """A named place."""

    name: str
    pose: Pose


@dataclass(frozen=True)
class PlacesView:
    """The frame: its name, places of robots, marks, corners of the fence.

    ``answers`` is whether the task service reports it.
    """

    frame: str = ''
    robots: Mapping[str, Placing] = field(default_factory=dict)
    marks: Tuple[MapMark, ...] = ()
    fence: Places = ()
    answers: bool = False


@dataclass(frozen=True)
class UnderWay:
    """A running task: its key, its parameters as YAML, its robots."""

    task: str
    parameters: str
    robots: Tuple[str, ...]


@dataclass(frozen=True)
class MapRobot:
    """A robot as drawn on the map; ``pose`` is None if it is not placed, or without odometry.

    ``state`` is its state in a word, ``trouble`` the same if it needs attention, ``text`` the
    source of its place, ``task`` the name of its task, ``old`` whether its place is outdated.
    ``lost`` is "lost 19:23" for a robot that no longer sends, '' for any other.
    ``points`` (n, 2) are its laser points in the frame [m].
    """

    name: str
    number: int = 0
    pose: Optional[Pose] = None
    radius_m: float = 0.25
    selected: bool = False
    driven: bool = False
    looked_at: bool = False
    state: str = ''
    trouble: str = ''
    text: str = ''
    task: str = ''
    old: bool = False
    lost: str = ''
    points: Optional[np.ndarray] = None
    trail: Optional[Trail] = None


@dataclass(frozen=True)
class Goal:
    """The goal of robots: a route of corners, or one corner with a heading."""

    robots: Tuple[str, ...]
    route: Places
    heading_rad: Optional[float] = None
    closed: bool = False


@dataclass(frozen=True)
class Scene:
    """Everything that the map shows at one instant.

    ``flags`` are the marks of the session: where they were made, with their notes.
    """

    frame: str = ''
    robots: Tuple[MapRobot, ...] = ()
    goals: Tuple[Goal, ...] = ()
    leaders: Tuple[Tuple[str, str], ...] = ()
    marks: Tuple[MapMark, ...] = ()
    fence: Places = ()
    answers: bool = True
    flags: Tuple[FlagView, ...] = ()

    def robot(self, name: str) -> Optional[MapRobot]:
        """Return a robot by its name."""
        return next((robot for robot in self.robots if robot.name == name), None)

    def at(self, x_m: float, y_m: float, within_m: float) -> Optional[MapRobot]:
        """Return the robot at a position, or the nearest one within a distance [m]."""
        near = [(math.hypot(robot.pose.x_m - x_m, robot.pose.y_m - y_m), robot.name, robot)
                for robot in self.robots if robot.pose is not None]
        near = [row for row in near if row[0] <= max(within_m, row[2].radius_m)]
        return min(near)[2] if near else None

    def targets(self, clicked: str = '') -> Tuple[str, ...]:
        """Return the addressed robots: the clicked, else the selected, else the one in view.

        :param clicked: the robot that was clicked on the map, '' without one
        """
        if self.robot(clicked) is not None:
            return (clicked,)
        return self.selected or tuple(robot.name for robot in self.robots if robot.looked_at)

    @property
    def selected(self) -> Tuple[str, ...]:
        """The robots that are selected."""
        return tuple(robot.name for robot in self.robots if robot.selected)

    def mark_at(self, x_m: float, y_m: float, within_m: float) -> Optional[MapMark]:
        """Return the mark within a distance of a position [m]."""
        near = [(math.hypot(mark.pose.x_m - x_m, mark.pose.y_m - y_m), mark.name, mark)
                for mark in self.marks]
        near = [row for row in near if row[0] <= within_m]
        return min(near)[2] if near else None

    def bounds(self) -> Optional[Tuple[Tuple[float, float], Tuple[float, float]]]:
        """Return two corners (x, y) [m] around everything placed, None without anything."""
        places = [(robot.pose.x_m, robot.pose.y_m) for robot in self.robots if robot.pose]
        places += [(mark.pose.x_m, mark.pose.y_m) for mark in self.marks]
        places += [(flag.x_m, flag.y_m) for flag in self.flags]
        places += self.fence
        if not places:
            return None
        array = np.array(places)
        least, most = array.min(axis=0), array.max(axis=0)
        return (float(least[0]), float(least[1])), (float(most[0]), float(most[1]))


def own_pose(view: RobotView) -> Optional[Pose]:
    """Return the pose of a robot by odometry, None if it is missing or invalid."""
    if view.x_m is None or view.y_m is None or view.heading_rad is None:
        return None
    pose = Pose(view.x_m, view.y_m, view.heading_rad)
    return pose if pose.is_finite() else None


def state_word(view: RobotView) -> Tuple[str, str]:
    """Return a robot's state in a word, and the same if it needs attention, else ''."""
    if view.link != LIVE:
        return view.link, view.link
    if view.on_task:
        return (view.task.label.lower() + (' waits' if view.task.waits else '') if view.task
                else 'on a task'), ''
    if view.driven:
        return 'driving', ''
    return ('selected' if view.selected else 'standing' if not view.moving else 'moving'), ''


def map_robot(view: RobotView, placing: Optional[Placing], radius_m: float,
              looked_at: bool) -> MapRobot:
    """Return a robot as drawn on the map, without trail and laser points.

    :param placing: its place, None if unknown
    """
    own = own_pose(view)
    origin = placing.origin if placing is not None else None
    pose = composed(origin, own) if origin is not None and own is not None else None
    state, trouble = state_word(view)
    old = view.link != LIVE or placing is not None and (placing.age_s or 0.0) > OLD_S
    return MapRobot(
        view.name, view.number, pose, radius_m, view.selected, view.driven, looked_at, state,
        trouble, _place_text(view, placing, own),
        (view.task.label if view.task else 'task') if view.on_task else '', bool(old))


def _place_text(view: RobotView, placing: Optional[Placing], own: Optional[Pose]) -> str:
    """Describe the source and age of its place, or why it is not placed."""
    if placing is None or placing.origin is None:
        return (placing.text if placing is not None else '') or 'not placed: place it'
    if own is None:
        return 'placed, but without odometry'
    words = placing.text or 'placed'
    if placing.age_s is not None and placing.age_s > OLD_S:
        words += ', {:.0f} s old'.format(placing.age_s)
    if view.link != LIVE and view.age_s is not None:
        words += '; its odometry is {:.0f} s old'.format(view.age_s)
    return words


def goals_of(runs: Sequence[UnderWay]) -> Tuple[Tuple[Goal, ...], Tuple[Tuple[str, str], ...]]:
    """Return the goals of robots on tasks, and pairs (robot, leader), from their parameters."""
    goals: List[Goal] = []
    leaders: List[Tuple[str, str]] = []
    for run in runs:
        values = _parameters(run.parameters)
        route = _route(values.get('route'))
        place = _route([[values.get('x'), values.get('y')]])
        heading = values.get('heading')
        if values.get('frame'):  # by its own odometry, whose origin is unknown
            continue
        if route or place:
            aimed = not route and isinstance(heading, (int, float))
            goals.append(Goal(run.robots, route or place, float(str(heading)) if aimed else None,
                              bool(route)))
        if isinstance(values.get('leader'), str):
            leaders += [(robot, str(values['leader'])) for robot in run.robots]
    return tuple(goals), tuple(leaders)


def _parameters(text: str) -> Dict[str, object]:
    """Return the parameters of a task by name, {} for invalid YAML."""
    names = ('x', 'y', 'heading', 'route', 'leader', 'frame')
    try:
        section = parse_yaml(text or '{}', 'task')
    except ConfigError:
        return {}
    return {name: section.take(name, None) for name in names}


def _route(value: object) -> Places:
    """Return corners of finite numbers, () for anything else."""
    corners: List[Tuple[float, float]] = []
    for row in value[:MAX_CORNERS] if isinstance(value, list) else ():
        if not (isinstance(row, list) and len(row) == 2 and all(
                type(part) in (int, float) and abs(part) < 1e6 for part in row)):
            return ()
        corners.append((float(row[0]), float(row[1])))
    return tuple(corners)
