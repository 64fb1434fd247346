# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Marks and fence drawn by the operator, and their storage."""
import math
from typing import Dict, List, Mapping, Optional, Sequence, Tuple

from mhri.base.config import ConfigError, Section
from mhri.base.geometry import Pose
from mhri.base.names import name_problem
from mhri.base.plausible import can_be, PLACE

MAX_MARKS, MAX_CORNERS, MAX_ROBOTS = 64, 200, 64
MIN_AREA_M2 = 0.01
Corner = Tuple[float, float]
# A robot placed by hand: origin of its odometry, its odometry then, time [s].
Put = Tuple[Pose, Pose, float]


def pose_problem(pose: Pose) -> str:
    """Return why a pose is impossible on a map, '' if it is possible."""
    if pose.is_finite() and can_be(PLACE, pose.x_m) and can_be(PLACE, pose.y_m) \
            and abs(pose.heading_rad) <= 1e3:
        return ''
    return 'no such place: x {:.3g} m, y {:.3g} m, heading {:.3g} rad'.format(
        pose.x_m, pose.y_m, pose.heading_rad)


class Drawn:
    """Marks {name: pose} and the corners (x, y) [m] of the fence, in the frame of the map."""

    def __init__(self) -> None:
        self.marks: Dict[str, Pose] = {}
        self.fence: Tuple[Corner, ...] = ()

    def set_mark(self, name: str, pose: Optional[Pose]) -> str:
        """Set a mark, or remove it (None); return the problem, '' on success."""
        if pose is None:
            return '' if self.marks.pop(name, None) is not None else \
                'there is no mark {!r}'.format(name[:64])
        problem = name_problem(name) if name else 'a mark needs a name'
        problem = problem or pose_problem(pose)
        if not problem and name not in self.marks and len(self.marks) >= MAX_MARKS:
            problem = 'there are {} marks already: remove one first'.format(MAX_MARKS)
        if not problem:
            self.marks[name] = pose
        return problem

    def set_fence(self, corners: Sequence[Corner]) -> str:
        """Set the fence, or remove it (no corners); return the problem, '' on success."""
        problem = fence_problem(corners) if corners else ''
        if not problem:
            self.fence = tuple(corners)
        return problem


def fence_problem(corners: Sequence[Corner]) -> str:
    """Return why corners do not form a valid fence, '' if they do."""
    if not 3 <= len(corners) <= MAX_CORNERS:
        return 'a fence has 3 to {} corners, not {}'.format(MAX_CORNERS, len(corners))
    for number, (x, y) in enumerate(corners, 1):
        if not (can_be(PLACE, x) and can_be(PLACE, y)):
            return 'corner {}: {}'.format(number, pose_problem(Pose(x, y, 0.0)))
    twice = math.fsum(one[0] * two[1] - two[0] * one[1]
                      for one, two in zip(corners, [*corners[1:], corners[0]]))
    return 'a fence has to enclose something' if abs(twice) < 2.0 * MIN_AREA_M2 else ''


def kept_of(drawn: Drawn, hand: Mapping[str, Put]) -> Dict[str, object]:
    """Return the stored values as plain data for a parameter; see :func:`read_kept`."""
    return {'marks': {name: _numbers(pose) for name, pose in drawn.marks.items()},
            'fence': [list(corner) for corner in drawn.fence],
            'hand': {name: {'origin': _numbers(put[0]), 'odometry': _numbers(put[1]),
                            'at': put[2]} for name, put in hand.items()}}


def read_kept(value: object, origin: str) -> Tuple[Drawn, Dict[str, Put], List[ConfigError]]:
    """Return (the drawn items, {robot: its placement by hand}, errors).

    :param origin: source of the value, for the errors
    """
    drawn, hand, errors = Drawn(), {}, []
    try:
        section = Section(value, origin)
        marks, robots = section.take('marks', {}), section.named_sections('hand')
        fence = section.take('fence', [])
        section.close()
    except ConfigError as error:
        return drawn, {}, [error]
    for name, row in (marks.items() if isinstance(marks, dict) else ()):
        pose = _pose(row)
        problem = drawn.set_mark(str(name), pose) if pose else 'expected [x, y, heading]'
        if problem:
            errors.append(ConfigError(origin, 'marks.{}'.format(name), problem))
    corners = [_row(row, 2) for row in fence] if isinstance(fence, list) else [None]
    problem = 'expected [x, y] for each corner' if None in corners else \
        drawn.set_fence([(row[0], row[1]) for row in corners if row])
    if problem:
        errors.append(ConfigError(origin, 'fence', problem))
    for name, section in list(robots.items())[:MAX_ROBOTS]:
        try:
            hand[name] = _put(name, section)
        except ConfigError as error:
            errors.append(error)
    return drawn, hand, errors


def _put(name: str, section: Section) -> Put:
    if name_problem(name):
        raise section.error('', 'no robot has this name')
    origin, odometry = _pose(section.take('origin')), _pose(section.take('odometry'))
    at_s = section.number('at', 0.0, 1e11)
    section.close()
    if origin is None or odometry is None:
        raise section.error('origin', 'expected [x, y, heading], and odometry the same')
    return (origin, odometry, at_s)


def _numbers(pose: Pose) -> List[float]:
    return [pose.x_m, pose.y_m, pose.heading_rad]


def _row(row: object, count: int) -> Optional[List[float]]:
    """Return a list of ``count`` numbers, None if it is invalid."""
    if not isinstance(row, list) or len(row) != count or not all(
            type(value) in (int, float) and abs(value) < 1e12 for value in row):
        return None
    return [float(value) for value in row]


def _pose(row: object) -> Optional[Pose]:
    numbers = _row(row, 3)
    pose = Pose(*numbers) if numbers else None
    return pose if pose is not None and not pose_problem(pose) else None
