# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pace of the selected robots: common limits, and slower commands on slow links."""
from typing import Iterable, Optional, Sequence

from mhri.base.views import RobotView


def slowest_link(robots: Iterable[RobotView]) -> Optional[RobotView]:
    """Return the selected robot with the slowest link, or None if no link is known.

    :param robots: :class:`mhri.base.views.RobotView` of all
    """
    timed = [(robot.figures.round_trip_s, robot) for robot in robots
             if robot.selected and robot.figures.round_trip_s is not None]
    return max(timed, key=lambda item: item[0])[1] if timed else None


def pace_words(robots: Sequence[RobotView], together: bool, share: float) -> str:
    """Describe what limits the robots' pace.

    :param robots: :class:`mhri.base.views.RobotView` of all
    :param together: whether all keep to the pace of the slowest
    :param share: fraction of each command that is passed on, in (0, 1]; below 1 on a slow link
    """
    if share < 1.0:
        worst, why = slowest_link(robots), 'a link is slow'
        if worst is not None and worst.figures.round_trip_s is not None:
            why = 'the link to {} takes {:.0f} ms'.format(
                worst.name, 1e3 * worst.figures.round_trip_s)
        return '{:.0f} % of the speed: {}'.format(100.0 * share, why)
    return _together(robots) if together else 'each at top speed'


def _together(robots: Iterable[RobotView]) -> str:
    """Describe the common limits of the selected robots."""
    known = [(robot.max_linear_mps, robot.max_angular_rad_s, robot.name) for robot in robots
             if robot.selected and robot.max_linear_mps is not None
             and robot.max_angular_rad_s is not None]
    if not known:
        return 'all as the slowest'
    linear_mps, turns_rad_s, slowest = min(known, key=lambda item: item[:2])
    _, angular_rad_s, turner = min(known, key=lambda item: (item[1], item[0]))
    names = slowest if turns_rad_s == angular_rad_s else '{} and {}'.format(slowest, turner)
    return 'all as {}: at most {:.2f} m/s, {:.2f} rad/s'.format(names, linear_mps, angular_rad_s)
