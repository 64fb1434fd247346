# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What one robot senses, for its task: odometry, motion capture, laser and battery."""
import threading
import time

import rospy
from sensor_msgs.msg import BatteryState, LaserScan

from mhri.base.mocap import Pose
from mhri.base.names import topic_of
from mhri.base.tf_tree import frame_name
from mhri.graph.ros.messages import MessageMissing
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe
from mhri.map.places import Odometry, OLD_S
from mhri.robots.pose_track import PoseTrack
from mhri.robots.ros.convert import header_of
from mhri.robots.ros.mocap_feed import MocapFeed
from mhri.robots.ros.odometry import odometry_of
from mhri.robots.ros.robot_link import battery_fraction
from mhri.sensors.brake import NARROW_M, reach_of, SCAN_OLD_S, Surroundings, Unplaced
from mhri.sensors.ros.beams import made_s, read_beams
from mhri.sensors.ros.mounts import Mounts, NoPlace
from mhri.tasks.base import Body
from mhri.tasks.retrace import Trail


class _Newest:
    """The newest message of some topics, read when it is asked for."""

    def __init__(self, topics, message_class, clock, **options):
        self._class = message_class
        self._clock = clock
        self._lock = threading.Lock()
        self.heard_at = None
        self._message = None
        self._refusals = Refusals(', '.join(topics), clock)
        self._subscribers = [rospy.Subscriber(topic, message_class, self._hear, queue_size=1,
                                              tcp_nodelay=True, **options) for topic in topics]

    def _hear(self, message):
        with self._lock:
            self._message, self.heard_at = message, self._clock()

    def take(self):
        """Return the newest message, None where there is none since the last time."""
        with self._lock:
            message, self._message = self._message, None
        return None if message is None else self._refusals.read(message, self._class)

    def note(self, *problem):
        """Say what cannot be, see :meth:`Refusals.note`."""
        self._refusals.note(*problem)

    def age_s(self):
        """Return the age of the newest message [s], None before the first."""
        return None if self.heard_at is None else self._clock() - self.heard_at

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        for subscriber in self._subscribers:
            unsubscribe(subscriber)


class RobotSenses:
    """A robot's odometry and motion capture at all times; the rest from :meth:`open` on.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, None: without tf
    """

    def __init__(self, name, robot_type, clock=time.monotonic, frames=None):
        self.name = name
        self.robot_type = robot_type
        self._clock = clock
        self._begun_at = clock()
        by_depth = self.has_eye and not self.has_laser
        self.body = Body(robot_type.radius_m + (NARROW_M if by_depth else 0.0),
                         robot_type.limits)
        self.trail = Trail()
        # By its odometry: the pose, the newest :class:`Odometry`, and the name of its frame.
        self.pose = self.odometry = None
        self.odometry_frame = ''
        # By motion capture: (pose, when it was heard [s]).
        self.seen_at = None
        self._odometry = self._open_odometry()
        self._depth = self._battery = None
        # One for each laser: {topic: its newest scan}.
        self._scans = {}
        # (scan, when it was heard [s], its stamp [s]), newer than what was looked at.
        self._depth_scan = self._scan_at = None
        self._depth_refusals = Refusals(', '.join(self._topics('depth')), clock)
        self._mounts = Mounts(robot_type, frames)
        self._track = PoseTrack(robot_type.limits.linear_mps)
        self._charge = None
        self._mocap = MocapFeed(name, clock)
        self._mocap.open()
        self._surroundings = Surroundings(self.body.radius_m)
        self._unplaced = Unplaced()

    def _open_odometry(self):
        try:
            message_class, self._read = odometry_of(self.robot_type)
        except MessageMissing as error:
            rospy.logwarn('%s: cannot read its odometry: %s', self.name, error)
            return None
        return _Newest(self.odometry_topics, message_class, self._clock)

    def _topics(self, key):
        return [topic_of(self.name, topic) for topic in getattr(self.robot_type, key)]

    def known_s(self):
        """Return since when the robot is known [s]."""
        return self._clock() - self._begun_at

    def open(self):
        """Begin to listen to laser or depth camera, and battery (blocking: it asks the master)."""
        if not self._scans:
            self._scans = {topic: _Newest([topic], LaserScan, self._clock, buff_size=1 << 20)
                           for topic in self._topics('scan')}
        if self._depth is None and self.has_eye and not self.has_laser:
            # It loads OpenCV, which a start in the middle of a drive does not wait for.
            from mhri.sensors.ros.depth_scans import DepthScans
            self._depth = DepthScans(self.name, self.robot_type.depth, self._mounts,
                                     self._on_depth, self._clock)
            self._depth.open()
        if self._battery is None and self.robot_type.battery:
            self._battery = _Newest(self._topics('battery'), BatteryState, self._clock)

    @property
    def odometry_topics(self):
        """The topics that its odometry may have."""
        return self._topics('odometry')

    @property
    def has_laser(self):
        """Whether robots of its type have a laser."""
        return bool(self.robot_type.scan)

    @property
    def has_eye(self):
        """Whether they have a laser, or at least a depth camera, for the obstacle brake."""
        return self.has_laser or bool(self.robot_type.depth)

    def _on_depth(self, *scan):
        self._depth_scan = scan

    def look(self):
        """Read what has come since the last time."""
        message = self._odometry.take() if self._odometry else None
        if message is not None:
            self._go(message)
        self.seen_at = self._mocap.take() or self.seen_at
        if self.pose is not None:
            self._see()
        battery = self._battery.take() if self._battery else None
        if battery is not None:
            self._charge = battery_fraction(battery)

    def _go(self, message):
        motion = self._read(message)
        if motion.problem:
            self._odometry.note(motion.problem)
        if not motion.is_possible():
            return
        self.pose = Pose(motion.x_m, motion.y_m, motion.heading_rad)
        header = header_of(message, type(message))
        if self._track.follow(self.pose, self._odometry.heard_at,
                              getattr(message, '_connection_header', None),
                              header[1] if header else 0.0):
            self._surroundings.clear()
            self._scan_at = None
        if header is not None:
            self._track.add(header[1], self.pose, self._odometry.heard_at)
            self._mounts.see_odometry(message)
            self.odometry_frame = frame_name(message.header.frame_id)
        self.odometry = Odometry(self.pose, self._odometry.heard_at, header and header[0])
        self.trail.add(self.pose, self._clock())

    def _see(self):
        """Take in what lasers or depth camera have measured, where the robot was at that time."""
        for number, (topic, newest) in enumerate(self._scans.items()):
            heard_at, message = newest.heard_at, newest.take()
            if message is not None:
                try:
                    self._see_scan(read_beams(message, self._mounts, number),
                                   heard_at or self._clock(), made_s(message), topic)
                except NoPlace as problem:
                    self._unplaced.hear(topic, self._clock())
                    newest.note(problem, NoPlace.verdict)
                except ValueError as error:
                    newest.note(error)
        scan, self._depth_scan = self._depth_scan, None
        if scan is not None:
            try:
                self._see_scan(*scan)
            except ValueError as error:
                self._depth_refusals.note(error)

    def _see_scan(self, scan, heard_s, stamp_s, laser=''):
        """Take in a scan.

        :raises ValueError: it is too late for that
        """
        at_s, pose = self._track.moment(stamp_s, heard_s)
        self._unplaced.place(laser)
        if self._surroundings.see(scan, pose or self.pose, at_s, laser):
            self._scan_at = at_s if self._scan_at is None else max(at_s, self._scan_at)

    def looks(self):
        """Return what tells where its laser or depth camera looks, as the brake has it."""
        return self._surroundings.looks(self.pose, reach_of(
            self.body.limits.linear_mps, self.body.radius_m, SCAN_OLD_S))

    def has_unplaced(self):
        """Tell whether nobody says where one of its lasers sits."""
        return self._unplaced.any(self._clock())

    def points(self, robots=()):
        """Return what its laser has met, in its frame, were it where it was heard last.

        :param robots: (ahead, to the left, radius) [m] of robots of which nothing is remembered
        """
        self._surroundings.forget(self.pose, robots)
        return self._surroundings.around(self.pose)

    def captured(self):
        """Return its :class:`Pose` by motion capture, None where that says nothing now."""
        seen_at = self.seen_at
        return seen_at[0] if seen_at and self._clock() - seen_at[1] <= OLD_S else None

    def ages(self):
        """Return {what: age [s], None before the first}, as :class:`Facts` has them."""
        return dict(odometry_age_s=self._odometry.age_s() if self._odometry else None,
                    scan_age_s=None if self._scan_at is None else self._clock() - self._scan_at)

    @property
    def charge(self):
        """Charge of its battery in [0, 1], None where it is not known."""
        return self._charge

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        for feed in (self._odometry, *self._scans.values(), self._depth, self._battery,
                     self._mocap):
            if feed is not None:
                feed.close()
