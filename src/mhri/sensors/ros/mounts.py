# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mounts of a robot's lasers and depth camera: from tf, else from the robot's type."""
import math

import numpy as np

from mhri.base.geometry import Pose
from mhri.base.tf_tree import frame_name, OdometryFrames

# A laser with a greater tilt does not measure in the plane, and its frame is not used [cosine].
_LEVEL = 0.9
# Rotation from the optical frame of a camera that looks ahead into the robot's frame.
_AHEAD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


class NoPlace(ValueError):
    """The mount of a laser is unknown: its measurements may be in any direction."""

    #: continuation of its text, for :meth:`mhri.graph.ros.refusals.Refusals.note`
    verdict = ('is unknown: let tf lead to its frame from that of the robot, or give "lasers" in '
               'the type of the robot')


class Mounts:
    """The mounts of one robot's sensors.

    ``frames`` are the frames of its odometry, :class:`mhri.base.tf_tree.OdometryFrames`.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`, kept as an attribute
    :param tf: :class:`mhri.robots.ros.tf_feed.TfFeed`, None without tf
    """

    def __init__(self, robot_type, tf=None):
        self.robot_type = robot_type
        self._tf = tf
        self.frames = OdometryFrames()

    def laser(self, frame, number=0):
        """Return (:class:`Pose` of a laser, whether it is mounted upside down).

        :param number: its index in ``scan`` of the type
        :raises NoPlace: neither tf nor the robot's type has its mount
        """
        matrix = self._matrix(frame)
        if matrix is None or abs(matrix[2, 2]) < _LEVEL:
            place = self.robot_type.laser_place(number)
            if place is None:
                raise NoPlace('the place of its laser ({}, frame {!r})'.format(
                    self.robot_type.scan[number], frame_name(frame)))
            return Pose(*place), False
        return Pose(float(matrix[0, 3]), float(matrix[1, 3]),
                    math.atan2(matrix[1, 0], matrix[0, 0])), matrix[2, 2] < 0.0

    def camera(self, frame):
        """Return (matrix of a camera's optical frame in the robot's, whether z is its height)."""
        matrix = self._matrix(frame)
        if matrix is not None:
            return matrix, True
        matrix = np.eye(4)
        matrix[:3, :3] = _AHEAD
        matrix[0, 3], matrix[2, 3] = self.robot_type.depth_x_m, self.robot_type.depth_z_m
        return matrix, self.robot_type.depth_z_m > 0.0

    def _matrix(self, frame):
        frame = frame_name(frame)
        if self._tf is None or not frame:
            return None
        base, odometry = self.frames
        matrix = self._tf.matrix(base, frame) if base else None
        if matrix is None and odometry:
            base = self._tf.child_above(odometry, frame)
            matrix = self._tf.matrix(base, frame) if base else None
        return matrix
