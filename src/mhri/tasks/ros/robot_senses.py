# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collects one robot's sensor data for its task: odometry, motion capture, laser, battery."""
import time

from mhri.base.names import topic_of
from mhri.graph.ros.refusals import Refusals
from mhri.map.places import Odometry, OLD_S
from mhri.robots.pose_track import PoseTrack
from mhri.robots.ros.streams import BATTERY_CHARGE, MOCAP, ODOMETRY, RobotStreams
from mhri.sensors.brake import NARROW_M, reach_of, SCAN_OLD_S, Surroundings, Unplaced
from mhri.sensors.ros.beams import made_s, read_beams, SCAN
from mhri.sensors.ros.mounts import Mounts, NoPlace
from mhri.tasks.base import Body
from mhri.tasks.retrace import Trail


class RobotSenses:
    """A robot's odometry and motion capture, and from :meth:`open` on its other sensors.

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
        # Pose by odometry, the newest :class:`Odometry`, the name of its frame, and what is wrong.
        self.pose = self.odometry = None
        self.odometry_frame = self.odometry_note = ''
        # By motion capture: (pose, time of receipt [s]).
        self.seen_at = None
        self._streams = RobotStreams(name, robot_type, (ODOMETRY, MOCAP, SCAN, BATTERY_CHARGE),
                                     clock, queue_size=1)
        self._depth = None
        # (scan, time of receipt [s], stamp [s]) since the last :meth:`look`.
        self._depth_scan = self._scan_at = None
        self._depth_refusals = Refusals(', '.join(
            topic_of(name, topic) for topic in robot_type.depth), clock)
        self._mounts = Mounts(robot_type, frames)
        self._track = PoseTrack(robot_type.limits.linear_mps)
        self._surroundings = Surroundings(self.body.radius_m)
        self._unplaced = Unplaced()
        # The battery from the start: its first values may be all that tells their unit.
        self._streams.open(ODOMETRY, MOCAP, BATTERY_CHARGE)

    def known_s(self):
        """Return how long the robot has been known [s]."""
        return self._clock() - self._begun_at

    def open(self):
        """Subscribe to laser or depth camera (blocking: calls the master)."""
        self._streams.open(SCAN)
        if self._depth is None and self.has_eye and not self.has_laser:
            # Imported late: it loads OpenCV, which would delay a start during a drive.
            from mhri.sensors.ros.depth_scans import DepthScans
            self._depth = DepthScans(self.name, self.robot_type.depth, self._mounts,
                                     self._on_depth, self._clock)
            self._depth.open()

    @property
    def odometry_topics(self):
        """The possible topics of its odometry."""
        return [topic_of(self.name, topic) for topic in self.robot_type.odometry]

    @property
    def has_laser(self):
        """Whether robots of its type have a laser."""
        return bool(self.robot_type.scan)

    @property
    def has_eye(self):
        """Whether they have a laser or a depth camera for the obstacle brake."""
        return self.has_laser or bool(self.robot_type.depth)

    def _on_depth(self, *scan):
        self._depth_scan = scan

    def look(self):
        """Process the messages received since the last call."""
        newest = self._streams[ODOMETRY].take()
        if newest is not None:
            self.odometry_note = newest.value.motion.note
            if newest.value.motion.pose is not None:
                self._go(newest.value, newest.at_s)
        captured = self._streams[MOCAP].take()
        if captured is not None and captured.value.is_finite():
            self.seen_at = captured[:2]
        if self.pose is not None:
            self._see()

    def _go(self, reading, heard_at):
        motion, header, frames, source = reading
        self.pose = motion.pose
        if self._track.follow(self.pose, heard_at, source, header[1] if header else 0.0):
            self._surroundings.clear()
            self._scan_at = None
        if header is not None:
            self._track.add(header[1], self.pose, heard_at)
            self._mounts.frames = frames
            self.odometry_frame = frames.odometry
        self.odometry = Odometry(self.pose, heard_at, header and header[0])
        self.trail.add(self.pose, self._clock())

    def _see(self):
        """Process the scans, each at the robot's pose at the time of its measurement."""
        scans = self._streams[SCAN]
        for message, heard_at, number in scans.take_each():
            topic = scans.topics[number]
            try:
                self._update_scan(read_beams(message, self._mounts, number), heard_at,
                                  made_s(message), topic)
            except NoPlace as problem:
                self._unplaced.on_scan(topic, self._clock())
                scans.note(problem, NoPlace.verdict, number)
            except ValueError as error:
                scans.note(error, number=number)
        scan, self._depth_scan = self._depth_scan, None
        if scan is not None:
            try:
                self._update_scan(*scan)
            except ValueError as error:
                self._depth_refusals.note(error)

    def _update_scan(self, scan, heard_s, stamp_s, laser=''):
        """Process a scan.

        :raises ValueError: its stamp is too old
        """
        at_s, pose = self._track.moment(stamp_s, heard_s)
        self._unplaced.place(laser)
        if self._surroundings.see(scan, pose or self.pose, at_s, laser):
            self._scan_at = at_s if self._scan_at is None else max(at_s, self._scan_at)

    def looks(self):
        """Return the field of view of its laser or depth camera, as for the brake."""
        return self._surroundings.looks(self.pose, reach_of(
            self.body.limits.linear_mps, self.body.radius_m, SCAN_OLD_S))

    def has_unplaced(self):
        """Return whether the position of one of its lasers is unknown."""
        return self._unplaced.any(self._clock())

    def points(self, robots=()):
        """Return its laser points in its frame, at its newest pose.

        :param robots: (ahead, to the left, radius) [m] of robots, whose points are not remembered
        """
        self._surroundings.forget(self.pose, robots)
        return self._surroundings.around(self.pose)

    def captured(self):
        """Return its :class:`Pose` by motion capture, None without a recent one."""
        seen_at = self.seen_at
        return seen_at[0] if seen_at and self._clock() - seen_at[1] <= OLD_S else None

    def ages(self):
        """Return {name in :class:`Facts`: age [s], None before the first data}."""
        now = self._clock()
        return dict(odometry_age_s=None if self.odometry is None else now - self.odometry.at_s,
                    odometry_note=self.odometry_note,
                    scan_age_s=None if self._scan_at is None else now - self._scan_at)

    @property
    def charge(self):
        """Charge of its battery in [0, 1], None if unknown."""
        return self._streams[BATTERY_CHARGE].value()

    def close(self):
        """Unsubscribe (blocking: calls the master)."""
        self._streams.close()
        if self._depth is not None:
            self._depth.close()
