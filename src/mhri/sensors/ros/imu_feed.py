# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gathers the values of a robot's IMU and odometry, for the graph of its tile."""
import math
import threading
import time

import numpy as np
from sensor_msgs.msg import Imu

from mhri.base.plausible import ACCELERATION, ANGULAR_VELOCITY, QUATERNION, sifted
from mhri.base.series import BinRing, IMU_KEYS, ODOMETRY_KEYS, roll_pitch_yaw, Series
from mhri.robots.ros.streams import ODOMETRY, RobotStreams, StreamRow

# At most this many samples wait for the next redraw; then the ROS thread itself adds them to the
# ring.
_MAX_PENDING = 1024
# Of several topics for one quantity the first is used until it has been silent this long [s].
_SILENT_S = 1.0
_NAN = math.nan
_KINDS = (QUATERNION,) * 4 + (ANGULAR_VELOCITY,) * 3 + (ACCELERATION,) * 3


def _read_imu(message, note):
    """Return orientation (x, y, z, w), angular velocity and acceleration; NaN if missing.

    A first covariance of -1 means that the sensor does not measure it (``sensor_msgs/Imu``).
    """
    turn, rate, accel = message.orientation, message.angular_velocity, message.linear_acceleration
    row = (turn.x, turn.y, turn.z, turn.w, rate.x, rate.y, rate.z, accel.x, accel.y, accel.z)
    if message.orientation_covariance[0] == -1.0:
        row = (_NAN,) * 4 + row[4:]
    if message.angular_velocity_covariance[0] == -1.0:
        row = row[:4] + (_NAN,) * 3 + row[7:]
    if message.linear_acceleration_covariance[0] == -1.0:
        row = row[:7] + (_NAN,) * 3
    row, problem = sifted(_KINDS, row)
    if problem:
        note(problem)
    return row


#: orientation, angular velocity and acceleration, see :func:`_read_imu`
IMU = StreamRow('imu', lambda _, kind: (kind.imu, Imu, _read_imu))


class _Intake:
    """The samples of a stream, from the first active topic, added to a ring in batches.

    :param row_of: function from a value of the stream to a row of samples
    :param prepare: function from an array of those to one of the ring's
    """

    def __init__(self, keys, row_of, prepare):
        self.ring = BinRing(keys)
        self._row_of = row_of
        self._prepare = prepare
        self._lock = threading.Lock()
        self._times, self._rows = [], []
        self._rank, self._received_at = 0, -math.inf

    def add(self, newest):
        """Handle the newest message (on a ROS thread)."""
        value, now, rank = newest
        if value is None:
            return
        with self._lock:
            if rank > self._rank and now - self._received_at < _SILENT_S:
                return
            self._rank, self._received_at = rank, now
            self._times.append(now)
            self._rows.append(self._row_of(value))
            if len(self._times) >= _MAX_PENDING:
                self._sort_in()

    def _sort_in(self):
        if self._times:
            self.ring.add(self._times, self._prepare(np.array(self._rows)))
            self._times, self._rows = [], []

    def snapshot(self):
        """Return a copy of the present ring."""
        with self._lock:
            self._sort_in()
            return self.ring.copy()


def _motion_row(reading):
    """Return forward speed and yaw rate from odometry."""
    return reading.motion.linear_mps, reading.motion.angular_rad_s


def _with_angles(rows):
    """Convert quaternions to roll, pitch and yaw."""
    return np.column_stack((roll_pitch_yaw(rows[:, :4]), rows[:, 4:]))


class ImuFeed:
    """A robot's motion in the last minute; subscribed between :meth:`open` and :meth:`close`.

    All times are times of receipt, since a robot's clock may be off. Odometry whose messages are
    not installed is left out.

    :param robot: the robot's name (namespace)
    :param kind: its :class:`mhri.base.robot_types.RobotType`; of several topics for one quantity,
        the first active one is used
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the feed of a robot, None for a type with neither an IMU nor odometry."""
        return cls(robot, kind) if kind.imu or kind.odometry else None

    def __init__(self, robot, kind):
        self._intakes = {IMU: _Intake(IMU_KEYS, tuple, _with_angles),
                         ODOMETRY: _Intake(ODOMETRY_KEYS, _motion_row, np.asarray)}
        self._streams = RobotStreams(robot, kind, self._intakes, time.monotonic, {
            row: intake.add for row, intake in self._intakes.items()})

    def open(self):
        """Subscribe (blocking: it asks the master)."""
        self._streams.open(*self._intakes)

    def close(self):
        """Unsubscribe (blocking: it asks the master); keep the curves."""
        self._streams.close()

    def take(self):
        """Return the present :class:`mhri.base.series.Series`; cheap at any rate of calls."""
        rings = [intake.snapshot() for intake in self._intakes.values()]
        return Series(time.monotonic(), {key: ring for ring in rings for key in ring.keys})

    def age_s(self):
        """Return the age of the newest IMU message [s]; None before the first, or without IMU."""
        return self._streams[IMU].age_s()

    def refused(self):
        """Return the number of messages with an impossible part, which was left out."""
        return sum(self._streams[row].refused() for row in self._intakes)
