# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the robots of a selection keep to each other, and to the slowest of their links."""


def slowest_link(robots):
    """Return the selected robot whose link takes longest, or None where none is known.

    :param robots: :class:`mhri.core.screen.views.RobotView` of all
    """
    timed = [robot for robot in robots if robot.selected and robot.figures.round_trip_s is not None]
    return max(timed, key=lambda robot: robot.figures.round_trip_s, default=None)


def pace_words(robots, together, share):
    """Return in words what the robots keep to.

    :param robots: :class:`mhri.core.screen.views.RobotView` of all
    :param together: whether all are held to what the slowest can do
    :param share: how much of each command is passed on, in (0, 1]; less than 1: a link is slow
    """
    if share < 1.0:
        worst = slowest_link(robots)
        return '{:.0f} % of the speed: {}'.format(100.0 * share, 'a link is slow' if worst is None
                                                  else 'the link to {} takes {:.0f} ms'.format(
                                                      worst.name, 1e3 * worst.figures.round_trip_s))
    return _together(robots) if together else 'each does its best'


def _together(robots):
    """Say what all of a selection are held to."""
    known = [robot for robot in robots if robot.selected and robot.max_linear_mps is not None]
    if not known:
        return 'all as the slowest'
    slowest = min(known, key=lambda robot: (robot.max_linear_mps, robot.max_angular_rad_s))
    turner = min(known, key=lambda robot: (robot.max_angular_rad_s, robot.max_linear_mps))
    names = slowest.name if slowest is turner or \
        slowest.max_angular_rad_s == turner.max_angular_rad_s else \
        '{} and {}'.format(slowest.name, turner.name)
    return 'all as {}: at most {:.2f} m/s, {:.2f} rad/s'.format(
        names, slowest.max_linear_mps, turner.max_angular_rad_s)
