# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gathers what a robot's IMU and odometry say, for the graph of its tile."""
import math
import threading
import time

import numpy as np
import rospy

from mhri.base.names import topic_of
from mhri.base.plausible import ACCELERATION, ANGULAR_VELOCITY, QUATERNION, sifted, SPEED
from mhri.base.series import BinRing, IMU_KEYS, ODOMETRY_KEYS, roll_pitch_yaw, Series
from mhri.graph.ros.messages import message_class, MessageMissing
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe

# At most this many samples wait for the next redraw; beyond that the ROS thread sorts them in
# itself.
_MOST_PENDING = 1024
# Of several topics for one thing the first counts, until it has been silent this long [s].
_SILENT_S = 1.0
_NAN = math.nan


def _imu_row(message):
    """Return orientation (x, y, z, w), angular velocity and acceleration; NaN where missing.

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
    return row


def _odometry_row(message):
    """Return forward speed and yaw rate of a ``nav_msgs/Odometry``."""
    twist = message.twist.twist
    return twist.linear.x, twist.angular.z


def _turtle_row(message):
    """Return forward speed and yaw rate of a ``turtlesim/Pose``."""
    return message.linear_velocity, message.angular_velocity


_IMU_KINDS = (QUATERNION,) * 4 + (ANGULAR_VELOCITY,) * 3 + (ACCELERATION,) * 3
_MOTION_KINDS = (SPEED, ANGULAR_VELOCITY)
# Type of message: function that makes a row of one, kind of each value.
_READERS = {'sensor_msgs/Imu': (_imu_row, _IMU_KINDS),
            'nav_msgs/Odometry': (_odometry_row, _MOTION_KINDS),
            'turtlesim/Pose': (_turtle_row, _MOTION_KINDS)}


class _Intake:
    """The samples of one kind, from whichever topic speaks, sorted into a ring in batches."""

    def __init__(self, topics, message_type, keys, prepare, clock):
        self.topics = topics
        self.ring = BinRing(keys)
        self._read, self._kinds = _READERS[message_type]
        self._message_class = message_class(message_type)
        self._prepare = prepare
        self._clock = clock
        self._lock = threading.Lock()
        self._times, self._rows = [], []
        self._rank, self._heard_at = 0, -math.inf
        self._subscribers = []
        self._refusals = [Refusals(topic, clock) for topic in topics]

    def subscribe(self):
        # No queue_size: it would hold for every subscriber of the topic in this program, and a
        # recorder beside this must not lose anything.
        self._subscribers = [
            rospy.Subscriber(topic, self._message_class, self._hear, rank, tcp_nodelay=True)
            for rank, topic in enumerate(self.topics)]

    def unsubscribe(self):
        subscribers, self._subscribers = self._subscribers, []
        for subscriber in subscribers:
            unsubscribe(subscriber)

    def _hear(self, message, rank):
        now = self._clock()
        message = self._refusals[rank].read(message, self._message_class)
        if message is None:
            return
        row, problem = sifted(self._kinds, self._read(message))
        if problem:
            self._refusals[rank].note(problem)
        with self._lock:
            if rank > self._rank and now - self._heard_at < _SILENT_S:
                return
            self._rank, self._heard_at = rank, now
            self._times.append(now)
            self._rows.append(row)
            if len(self._times) >= _MOST_PENDING:
                self._sort_in()

    def _sort_in(self):
        if self._times:
            self.ring.add(self._times, self._prepare(np.array(self._rows)))
            self._times, self._rows = [], []

    def snapshot(self):
        with self._lock:
            self._sort_in()
            return self.ring.copy()

    def age_s(self):
        with self._lock:
            return None if self._heard_at == -math.inf else self._clock() - self._heard_at

    def refused(self):
        return sum(refusals.count for refusals in self._refusals)


def _with_angles(rows):
    """Turn quaternions into roll, pitch and yaw."""
    return np.column_stack((roll_pitch_yaw(rows[:, :4]), rows[:, 4:]))


class ImuFeed:
    """A robot's motion in the last minute; subscribed between :meth:`open` and :meth:`close`.

    All times are times of receipt, since a robot's clock may be off.

    :param robot: the robot's name (namespace)
    :param imu_topics: ``sensor_msgs/Imu``, relative to the namespace, in order of preference
    :param odometry_topics: the same for the odometry
    :param odometry_type: one of :data:`ODOMETRY_TYPES`; left out if not installed here
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the feed of a robot, None for a type with neither an IMU nor odometry."""
        return cls(robot, kind.imu, kind.odometry, kind.odometry_type) \
            if kind.imu or kind.odometry else None

    def __init__(self, robot, imu_topics, odometry_topics, odometry_type='nav_msgs/Odometry',
                 clock=time.monotonic):
        self._clock = clock
        self._intakes = {}
        self._empty = {ODOMETRY_KEYS: BinRing(ODOMETRY_KEYS), IMU_KEYS: BinRing(IMU_KEYS)}
        for keys, topics, message_type, prepare in (
                (IMU_KEYS, imu_topics, 'sensor_msgs/Imu', _with_angles),
                (ODOMETRY_KEYS, odometry_topics, odometry_type, np.asarray)):
            names = [topic_of(robot, topic) for topic in topics]
            try:
                self._intakes[keys] = _Intake(names, message_type, keys, prepare, clock)
            except MessageMissing as error:
                rospy.logwarn('%s: no graph of its odometry: %s', robot, error)

    def open(self):
        """Start listening (blocking: it asks the master)."""
        for intake in self._intakes.values():
            intake.subscribe()

    def close(self):
        """Stop listening (blocking: it asks the master); keep what was heard."""
        for intake in self._intakes.values():
            intake.unsubscribe()

    def take(self):
        """Return the :class:`mhri.base.series.Series` of this moment; cheap at any rate."""
        rings = dict(self._empty)
        rings.update({keys: intake.snapshot() for keys, intake in self._intakes.items()})
        return Series(self._clock(), {key: ring for keys, ring in rings.items() for key in keys})

    def age_s(self):
        """Return the age of the newest IMU message [s]; None before the first, or without IMU."""
        intake = self._intakes.get(IMU_KEYS)
        return intake.age_s() if intake and intake.topics else None

    def refused(self):
        """Return the number of messages with an impossible part, which was left out."""
        return sum(intake.refused() for intake in self._intakes.values())
