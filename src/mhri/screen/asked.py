# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What was asked of a robot beside what it does, where the two differ for longer than a moment."""
from dataclasses import replace
from typing import Dict, Iterable, Optional, Tuple

from mhri.base.views import LIVE, RobotView

# Within 10 %, or within this, the two are the same [m/s], [rad/s].
SAME_SHARE = 0.10
SAME_MPS = 0.03
SAME_RAD_S = 0.05
# For so long they differ while a robot gathers speed, and nobody needs to hear of it [s].
MOMENT_S = 0.7

# m/s and rad/s.
_Speeds = Tuple[float, float]


def differs(asked: float, done: float, least: float) -> bool:
    """Tell whether a speed is another than the one asked for.

    :param least: what is no difference whatever the speeds are; SAME_MPS or SAME_RAD_S
    """
    return abs(asked - done) > max(least, SAME_SHARE * abs(asked))


def _speed(value: float) -> str:
    return ('back ' if value <= -0.005 else '') + '{:.2f}'.format(abs(value))


def _turn(value: float) -> str:
    side = 'left ' if value >= 0.005 else 'right ' if value <= -0.005 else ''
    return '{}{:.2f}'.format(side, abs(value))


def asked_line(robot: RobotView) -> str:
    """Return what was asked for, for the numbers over the picture; '' where the robot does it.

    "asked 0.50 m/s"; "asked 0.50, sent 0.22 m/s" where the robot's own limits, or those of its
    group, let less through.

    :param robot: :class:`mhri.base.views.RobotView`, ``asked`` as
        :class:`AskedAndDone` leaves it
    """
    if robot.asked is None:
        return ''
    linear, turn = robot.asked
    sent_linear, sent_turn = robot.sent_mps, robot.sent_rad_s
    if differs(linear, robot.linear_mps or 0.0, SAME_MPS):
        held = sent_linear is not None and differs(linear, sent_linear, SAME_MPS)
        between = ', sent {}'.format(_speed(sent_linear or 0.0)) if held else ''
        return 'asked {}{} m/s'.format(_speed(linear), between)
    held = sent_turn is not None and differs(turn, sent_turn, SAME_RAD_S)
    between = ', sent {}'.format(_turn(sent_turn or 0.0)) if held else ''
    return 'asked {}{} rad/s'.format(_turn(turn), between)


def asked_and_done(robots: Iterable[RobotView]) -> str:
    """Return "asked 0.50, crawler1 0.20 m/s" of the first robot that does something else, or ''."""
    for robot in robots:
        if robot.asked is not None:
            linear, turn = robot.asked
            done = robot.linear_mps or 0.0
            if differs(linear, done, SAME_MPS):
                return 'asked {}, {} {} m/s'.format(_speed(linear), robot.name, _speed(done))
            return 'asked {}, {} {} rad/s'.format(
                _turn(turn), robot.name, _turn(robot.angular_rad_s or 0.0))
    return ''


class AskedAndDone:
    """Remembers since when each robot has done something else than was asked of it."""

    def __init__(self) -> None:
        self._since: Dict[str, float] = {}

    def compare(self, robots: Iterable[RobotView], asked: Optional[_Speeds],
                now: float) -> Tuple[RobotView, ...]:
        """Return the robots, ``asked`` set where it has differed for :data:`MOMENT_S`.

        :param asked: the operator's command [m/s, rad/s], None where it is not known
        :param now: seconds of a clock that never goes back
        """
        since, robots = self._since, tuple(robots)
        self._since = {robot.name: since.get(robot.name, now) for robot in robots
                       if asked is not None and _does_else(robot, asked)}
        return tuple(replace(robot, asked=asked)
                     if now - self._since.get(robot.name, now) >= MOMENT_S else robot
                     for robot in robots)


def _does_else(robot: RobotView, asked: _Speeds) -> bool:
    """Tell whether a robot that obeys the operator does something else."""
    if not robot.driven or robot.obeys != 'operator' or robot.link != LIVE \
            or robot.linear_mps is None or robot.angular_rad_s is None:
        return False
    return differs(asked[0], robot.linear_mps, SAME_MPS) or \
        differs(asked[1], robot.angular_rad_s, SAME_RAD_S)
