# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Inputs of the drive's obstacle brake for one robot: its scans and its pose."""
from contextlib import nullcontext
import threading
import time

from mhri.base.names import topic_of
from mhri.driving.stick_brake import StickBrake
from mhri.graph.ros.messages import MessageMissing
from mhri.graph.ros.refusals import Refusals
from mhri.robots.pose_track import PoseTrack
from mhri.robots.ros.odometry import odometry_of
from mhri.sensors.brake import NARROW_M
from mhri.sensors.ros.beams import made_s, read_beams, SCAN
# It loads OpenCV, which blocks every thread for half a second: import it before the drive starts.
from mhri.sensors.ros.depth_scans import DepthScans
from mhri.sensors.ros.mounts import Mounts, NoPlace

# In this time a robot moves a few centimetres at most [s].
POSE_EVERY_S = 0.04


class BrakeEye:
    """Reads a robot's lasers (``sensor_msgs/LaserScan``) while its brake is requested.

    For robot types without a laser it reads the depth camera, see
    :class:`mhri.sensors.ros.depth_scans.DepthScans`; the sensor's pose on the robot comes from tf,
    see :class:`mhri.sensors.ros.mounts.Mounts`. All messages are read on the threads of the
    sensors; ``brake`` is the :class:`mhri.driving.stick_brake.StickBrake` for the robot's line.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, opened here; None to do without tf
    """

    def __init__(self, name, robot_type, clock=time.monotonic, frames=None):
        self.brake = StickBrake(robot_type.radius_m + (0.0 if robot_type.scan else NARROW_M),
                                bool(robot_type.scan or robot_type.depth))
        self._clock = clock
        self._frames = frames
        self._mounts = Mounts(robot_type, frames)
        self._depth = None
        if robot_type.depth and not robot_type.scan:
            self._depth = DepthScans(name, robot_type.depth, self._mounts, self._on_depth, clock)
        self._scans = SCAN.stream(name, robot_type, clock, self._on_scan, queue_size=1)
        try:
            self._odometry, self._read = odometry_of(robot_type)
        except MessageMissing:
            self._odometry = None
        self._depth_refusals = Refusals(', '.join(
            topic_of(name, topic) for topic in robot_type.depth), clock)
        self._odometry_refusals = Refusals('the odometry of ' + name, clock)
        self._track = PoseTrack(robot_type.limits.linear_mps)
        self._settling = threading.Lock()
        self._seeing = threading.Lock()
        self._pose_at = 0.0

    def switch(self, on):
        """Start or stop reading the sensors; return at once."""
        if on == self.brake.asked:
            return
        self.brake.ask(on)
        if self._scans.topics or self._depth:
            # A request to the master may take a while, and must not delay a command.
            threading.Thread(target=self._settle, name='brake_eye', daemon=True).start()

    def _settle(self):
        with self._settling:
            if self._depth is not None:
                (self._depth.open if self.brake.asked else self._depth.close)()
            (self._scans.open if self.brake.asked else self._scans.close)()
            if self._frames is not None:
                (self._frames.open if self.brake.asked else self._frames.close)(self)

    def on_odometry(self, message, now):
        """Handle the bytes of an odometry message (``rospy.AnyMsg``)."""
        if not self.brake.remembers or self._odometry is None \
                or now - self._pose_at < POSE_EVERY_S:
            return
        self._pose_at = now
        reading = self._read_odometry(message)
        if reading is None or not reading.motion.is_possible():
            return
        motion, header, self._mounts.frames, source = reading
        pose, anew = motion.pose, False
        if pose is not None:
            if header is not None:
                self._track.add(header[1], pose, now)
            anew = self._track.follow(pose, now, source, header[1] if header else 0.0)
        with self._seeing if anew or pose is None else nullcontext():
            self.brake.move(pose, anew)

    def motion(self, message):
        """Return the :class:`Motion` in the bytes of an odometry message, None if unreadable."""
        reading = None if self._odometry is None else self._read_odometry(message)
        return reading and reading.motion

    def _read_odometry(self, message):
        """Return the :class:`Reading` of a message, None if its bytes are malformed."""
        message = self._odometry_refusals.read(message, self._odometry)
        return message and self._read(message, self._odometry_refusals.note)

    def _on_scan(self, newest):
        message, now, laser = newest
        if message is None:
            return
        topic = self._scans.topics[laser]
        try:
            self._see(read_beams(message, self._mounts, laser), now, made_s(message), topic)
        except NoPlace as problem:
            self.brake.on_unplaced_scan(topic, now)
            self._scans.note(problem, NoPlace.verdict, laser)
        except ValueError as error:
            self._scans.note(error, number=laser)

    def _on_depth(self, scan, received_s, stamp_s):
        try:
            self._see(scan, received_s, stamp_s)
        except ValueError as error:
            self._depth_refusals.note(error)

    def _see(self, scan, heard_s, stamp_s, laser=''):
        """Handle a scan, with the robot's pose at the time of the measurement.

        :raises ValueError: the scan is too old for that
        """
        at_s, pose = self._track.moment(stamp_s, heard_s)
        # Each laser has its own thread.
        with self._seeing:
            if self.brake.asked:
                self.brake.see(scan, at_s, pose, laser)

    def close(self):
        """Stop reading the sensors (blocking: calls the master)."""
        self.brake.ask(False)
        self._settle()
