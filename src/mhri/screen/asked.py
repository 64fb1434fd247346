# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a robot's command with its motion, to show persistent differences."""
from dataclasses import replace
from typing import Callable, Dict, Iterable, Iterator, Optional, Tuple

from mhri.base.limits import Velocity
from mhri.base.views import LIVE, RobotView

# Within 10 %, or within these limits, the two count as equal [m/s], [rad/s].
SAME_SHARE = 0.10
SAME_MPS = 0.03
SAME_RAD_S = 0.05
# Shorter differences are not shown, as a robot needs time to accelerate [s].
MOMENT_S = 0.7


def differs(asked: float, done: float, least: float) -> bool:
    """Return whether a speed differs from the commanded one.

    :param least: tolerance, SAME_MPS or SAME_RAD_S
    """
    return abs(asked - done) > max(least, SAME_SHARE * abs(asked))


def _speed(value: float) -> str:
    return ('back ' if value <= -0.005 else '') + '{:.2f}'.format(abs(value))


def _turn(value: float) -> str:
    side = 'left ' if value >= 0.005 else 'right ' if value <= -0.005 else ''
    return '{}{:.2f}'.format(side, abs(value))


# (field of a velocity and of a robot's view, tolerance, formatter, unit).
_PARTS: Tuple[Tuple[str, float, Callable[[float], str], str], ...] = (
    ('linear_mps', SAME_MPS, _speed, 'm/s'), ('lateral_mps', SAME_MPS, _turn, 'm/s'),
    ('angular_rad_s', SAME_RAD_S, _turn, 'rad/s'))


def _differing(robot: RobotView, asked: Velocity) -> Iterator[
        Tuple[float, float, Optional[float], Callable[[float], str], str]]:
    """Yield (asked, done, sent if limited, formatter, unit) of each component that differs."""
    for key, least, written, unit in _PARTS:
        wanted, done = getattr(asked, key), getattr(robot, key) or 0.0
        if differs(wanted, done, least):
            sent = getattr(robot.sent, key) if robot.sent else wanted
            yield wanted, done, sent if differs(wanted, sent, least) else None, written, unit


def asked_line(robot: RobotView) -> str:
    """Return the command, for the numbers over the picture; '' if the robot follows it.

    E.g. "asked 0.50 m/s", or "asked 0.50, sent 0.22 m/s" if limits of the robot or its group
    reduce the command.

    :param robot: :class:`mhri.base.views.RobotView` with ``asked`` set by :class:`AskedAndDone`
    """
    for asked, _, sent, written, unit in _differing(robot, robot.asked) if robot.asked else ():
        return 'asked {}{} {}'.format(
            written(asked), '' if sent is None else ', sent ' + written(sent), unit)
    return ''


def asked_and_done(robots: Iterable[RobotView]) -> str:
    """Return "asked 0.50, crawler1 0.20 m/s" for the first differing robot, or ''."""
    for robot in robots:
        for asked, done, _, written, unit in _differing(robot, robot.asked) if robot.asked else ():
            return 'asked {}, {} {} {}'.format(written(asked), robot.name, written(done), unit)
    return ''


class AskedAndDone:
    """Tracks since when each robot has differed from its command."""

    def __init__(self) -> None:
        self._since: Dict[str, float] = {}

    def compare(self, robots: Iterable[RobotView], asked: Optional[Velocity],
                now: float) -> Tuple[RobotView, ...]:
        """Return the robots, with ``asked`` set if it has differed for :data:`MOMENT_S`.

        :param asked: the operator's command, None if unknown
        :param now: time [s, monotonic]
        """
        since, robots = self._since, tuple(robots)
        self._since = {robot.name: since.get(robot.name, now) for robot in robots
                       if asked is not None and _does_else(robot, _meant(robot, asked))}
        return tuple(replace(robot, asked=_meant(robot, asked))
                     if asked and now - self._since.get(robot.name, now) >= MOMENT_S else robot
                     for robot in robots)


def _meant(robot: RobotView, asked: Velocity) -> Velocity:
    """Return the command of a robot, without sideways motion if the robot cannot do it."""
    return asked if robot.holonomic else Velocity(asked.linear_mps, asked.angular_rad_s)


def _does_else(robot: RobotView, asked: Velocity) -> bool:
    """Return whether a robot driven by the operator differs from its command."""
    return robot.driven and robot.obeys == 'operator' and robot.link == LIVE \
        and robot.linear_mps is not None and robot.angular_rad_s is not None \
        and any(_differing(robot, asked))
