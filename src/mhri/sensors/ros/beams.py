# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Laser scans: the stream, and the conversions for the obstacle brake and for drawing."""
import math

from sensor_msgs.msg import LaserScan

from mhri.base.plausible import beams_problem, thinned
from mhri.robots.ros.streams import StreamRow
from mhri.sensors.all_round import Sweep
from mhri.sensors.laser_scan import laser_scan
from mhri.sensors.readings import no_return_of, read_ranges

# Maximum duration of a scan [s]: time increments that add up to more are invalid.
SWEEP_S = 0.25
# More than one per pixel around the view; a scan with more is thinned out to this.
MAX_POINTS = 4000


def _possible(message, _):
    problem = beams_problem(len(message.ranges), message.angle_min, message.angle_increment)
    if problem:
        raise ValueError(problem)
    return message


#: ``sensor_msgs/LaserScan`` with possible values; a topic for each laser
SCAN = StreamRow('scan', lambda _, kind: (kind.scan, LaserScan, _possible), 1 << 20)


def made_s(message):
    """Return the time of the last beam of a ``sensor_msgs/LaserScan``, stamped at its first [s]."""
    sweep_s = (len(message.ranges) - 1) * message.time_increment
    return message.header.stamp.to_sec() + (sweep_s if 0.0 < sweep_s <= SWEEP_S else 0.0)


def read_beams(message, mounts=None, number=0):
    """Return a ``sensor_msgs/LaserScan`` as :class:`mhri.sensors.brake.Scan`.

    :param message: of :data:`SCAN`
    :param mounts: :class:`mhri.sensors.ros.mounts.Mounts`; None: the laser is in the centre of the
        robot, is not blind at close range, and follows REP 117
    :param number: index of the laser on its robot
    :raises NoPlace: its mount is unknown
    """
    angles = message.angle_min, message.angle_increment
    limits = message.range_min, message.range_max
    if mounts is None:
        return laser_scan(message.ranges, angles, limits, {}, math.inf)
    kind = mounts.robot_type
    return laser_scan(message.ranges, angles, limits, kind.no_return, kind.radius_m,
                      mounts.laser(message.header.frame_id, number))


def read_sweep(message, no_return):
    """Return the same as a :class:`Sweep` of at most :data:`MAX_POINTS` in the laser's frame.

    Each range is the nearest of the beams around it, NaN if nothing is within reach, it is too
    near, or outside the sensor's stated limits.

    :param no_return: see :class:`mhri.base.robot_types.RobotType`
    """
    readings = read_ranges(message.ranges, message.range_min, message.range_max,
                           no_return_of(no_return, message.range_max))
    ranges, together = thinned(readings.ranges, MAX_POINTS)
    step = message.angle_increment
    return Sweep(ranges, message.angle_min + 0.5 * (together - 1) * step, together * step,
                 message.range_max)
