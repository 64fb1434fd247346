# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the obstacle brake of the gates knows of a robot: what it sees, and where it is."""
from contextlib import nullcontext
import threading
import time

import rospy
from sensor_msgs.msg import LaserScan

from mhri.base.mocap import Pose
from mhri.base.names import topic_of
from mhri.driving.stick_brake import StickBrake
from mhri.graph.ros.messages import MessageMissing
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe
from mhri.robots.pose_track import PoseTrack
from mhri.robots.ros.convert import header_of
from mhri.robots.ros.odometry import odometry_of
from mhri.sensors.brake import NARROW_M
from mhri.sensors.ros.beams import made_s, read_beams
from mhri.sensors.ros.mounts import Mounts, NoPlace

# A robot is no further from where it was read last than a few centimetres [s].
POSE_EVERY_S = 0.04


class BrakeEye:
    """Reads a robot's lasers (``sensor_msgs/LaserScan``) for its brake, while that is asked for.

    Robots of a type without a laser are read their depth camera, see
    :class:`mhri.sensors.ros.depth_scans.DepthScans`; where either sits tf says, see
    :class:`mhri.sensors.ros.mounts.Mounts`. Everything is read on the threads of the sensors;
    ``brake`` is :class:`mhri.driving.stick_brake.StickBrake`, for the gate to ask.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, opened here; None: without tf
    """

    def __init__(self, name, robot_type, clock=time.monotonic, frames=None):
        self.brake = StickBrake(robot_type.radius_m + (0.0 if robot_type.scan else NARROW_M),
                                bool(robot_type.scan or robot_type.depth))
        self._clock = clock
        self._frames = frames
        self._mounts = Mounts(robot_type, frames)
        self._depth = None
        if robot_type.depth and not robot_type.scan:
            # Not before it is needed: it loads OpenCV, which gates that are started again in the
            # middle of a drive would wait for.
            from mhri.sensors.ros.depth_scans import DepthScans
            self._depth = DepthScans(name, robot_type.depth, self._mounts, self._on_depth, clock)
        self._topics = [topic_of(name, topic) for topic in robot_type.scan]
        try:
            self._odometry, self._read = odometry_of(robot_type)
        except MessageMissing:
            self._odometry = None
        self._refusals = Refusals(', '.join(self._topics or [
            topic_of(name, topic) for topic in robot_type.depth]), clock)
        self._odometry_refusals = Refusals('the odometry of ' + name, clock)
        self._track = PoseTrack(robot_type.limits.linear_mps)
        self._subscribers = []
        self._settling = threading.Lock()
        self._seeing = threading.Lock()
        self._pose_at = 0.0

    def want(self, wanted):
        """Begin or stop to look; returns at once."""
        if wanted == self.brake.asked:
            return
        self.brake.ask(wanted)
        if self._topics or self._depth:
            # Asking the master may take a while, and must not hold up a command.
            threading.Thread(target=self._settle, name='brake_eye', daemon=True).start()

    def _settle(self):
        with self._settling:
            if self._depth is not None:
                (self._depth.open if self.brake.asked else self._depth.close)()
            elif self.brake.asked and not self._subscribers:
                self._subscribers = [
                    rospy.Subscriber(topic, LaserScan, self._on_scan, laser, queue_size=1,
                                     buff_size=1 << 20, tcp_nodelay=True)
                    for laser, topic in enumerate(self._topics)]
            elif not self.brake.asked:
                subscribers, self._subscribers = self._subscribers, []
                for subscriber in subscribers:
                    unsubscribe(subscriber)
            if self._frames is not None:
                (self._frames.open if self.brake.asked else self._frames.close)(self)

    def on_odometry(self, message, now):
        """Take in the bytes of an odometry message (``rospy.AnyMsg``)."""
        if not self.brake.remembers or self._odometry is None \
                or now - self._pose_at < POSE_EVERY_S:
            return
        self._pose_at = now
        source = getattr(message, '_connection_header', None)
        message, motion = self._read_odometry(message)
        if motion is not None and motion.is_possible():
            self._mounts.see_odometry(message)
            pose = Pose(motion.x_m, motion.y_m, motion.heading_rad)
            header = header_of(message, type(message))
            if header is not None:
                self._track.add(header[1], pose, now)
            anew = self._track.follow(pose, now, source, header[1] if header else 0.0)
            with self._seeing if anew else nullcontext():
                self.brake.move(pose, anew)

    def motion(self, message):
        """Return the :class:`Motion` in the bytes of an odometry message, None: there is none."""
        return None if self._odometry is None else self._read_odometry(message)[1]

    def _read_odometry(self, message):
        """Return (the message, its motion), None for what cannot be read; that is counted."""
        message = self._odometry_refusals.read(message, self._odometry)
        motion = None if message is None else self._read(message)
        if motion is not None and motion.problem:
            self._odometry_refusals.note(motion.problem)
        return message, motion

    def _on_scan(self, message, laser):
        now = self._clock()
        message = self._refusals.read(message, LaserScan)
        if message is None:
            return
        try:
            self._see(read_beams(message, self._mounts, laser), now, made_s(message),
                      self._topics[laser])
        except NoPlace as problem:
            self.brake.hear_unplaced(self._topics[laser], now)
            self._refusals.note(problem, NoPlace.verdict)
        except ValueError as error:
            self._refusals.note(error)

    def _on_depth(self, scan, received_s, stamp_s):
        try:
            self._see(scan, received_s, stamp_s)
        except ValueError as error:
            self._refusals.note(error)

    def _see(self, scan, heard_s, stamp_s, laser=''):
        """Take in a scan where the robot was when it was made.

        :raises ValueError: it is too late for that
        """
        at_s, pose = self._track.moment(stamp_s, heard_s)
        # Each laser has a thread of its own.
        with self._seeing:
            if self.brake.asked:
                self.brake.see(scan, at_s, pose, laser)

    def close(self):
        """Stop looking (blocking: it asks the master)."""
        self.brake.ask(False)
        self._settle()
