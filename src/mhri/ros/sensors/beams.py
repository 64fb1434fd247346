# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A laser scan as the obstacle brake takes it."""
from mhri.core.driving.brake import Scan
from mhri.core.robots.mocap import Pose
from mhri.core.sensors.plausible import beams_problem, measured_ranges, thinned

# A finer scan is thinned: its nearest beams count.
MOST_BEAMS = 400
# No laser takes longer for a turn [s]: a time between beams that says so is none.
SWEEP_S = 0.25
_MIDDLE = Pose(0.0, 0.0, 0.0)


def made_s(message):
    """Return when a ``sensor_msgs/LaserScan`` was complete [s]: it is stamped as its first beam."""
    sweep_s = (len(message.ranges) - 1) * message.time_increment
    return message.header.stamp.to_sec() + (sweep_s if 0.0 < sweep_s <= SWEEP_S else 0.0)


def read_beams(message, mounts=None, number=0):
    """Return a ``sensor_msgs/LaserScan`` as :class:`mhri.core.driving.brake.Scan`.

    :param mounts: :class:`mhri.ros.sensors.mounts.Mounts`; None: the laser sits in the middle
    :param number: which of the robot's lasers made it
    :raises NoPlace: nobody says where that sits
    :raises ValueError: says what of it cannot be
    """
    problem = beams_problem(len(message.ranges), message.angle_min, message.angle_increment)
    if problem:
        raise ValueError(problem)
    ranges, together = thinned(measured_ranges(
        message.ranges, message.range_min, message.range_max), MOST_BEAMS)
    step = message.angle_increment
    first, step = message.angle_min + 0.5 * (together - 1) * step, together * step
    mount, turned_over = mounts.laser(message.header.frame_id, number) if mounts \
        else (_MIDDLE, False)
    if turned_over:
        first, step = -first, -step
    if step < 0.0:
        # Mounted upside down it counts to the right.
        ranges, first, step = ranges[::-1], first + (len(ranges) - 1) * step, -step
    return Scan(ranges, first, step, message.range_min, message.range_max, mount)
