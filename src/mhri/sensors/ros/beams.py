# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A laser scan as the obstacle brake takes it."""
import math

from mhri.base.plausible import beams_problem
from mhri.sensors.laser_scan import laser_scan

# No laser takes longer for a turn [s]: a time between beams that says so is none.
SWEEP_S = 0.25


def made_s(message):
    """Return when a ``sensor_msgs/LaserScan`` was complete [s]: it is stamped as its first beam."""
    sweep_s = (len(message.ranges) - 1) * message.time_increment
    return message.header.stamp.to_sec() + (sweep_s if 0.0 < sweep_s <= SWEEP_S else 0.0)


def read_beams(message, mounts=None, number=0):
    """Return a ``sensor_msgs/LaserScan`` as :class:`mhri.sensors.brake.Scan`.

    :param mounts: :class:`mhri.sensors.ros.mounts.Mounts`; None: the laser sits in the middle of
        a robot that is as large as it, and sends what REP 117 says
    :param number: which of the robot's lasers made it
    :raises NoPlace: nobody says where that sits
    :raises ValueError: says what of it cannot be
    """
    problem = beams_problem(len(message.ranges), message.angle_min, message.angle_increment)
    if problem:
        raise ValueError(problem)
    angles = message.angle_min, message.angle_increment
    limits = message.range_min, message.range_max
    if mounts is None:
        return laser_scan(message.ranges, angles, limits, {}, math.inf)
    kind = mounts.robot_type
    return laser_scan(message.ranges, angles, limits, kind.no_return, kind.radius_m,
                      mounts.laser(message.header.frame_id, number))
