# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot's laser and depth camera sit on it: by tf, else as its type says."""
import math

import numpy as np

from mhri.base.mocap import Pose
from mhri.base.tf_tree import frame_name, OdometryFrames

# A laser that is tilted by more does not measure in the plane: its frame says nothing [cosine].
_LEVEL = 0.9
# In the robot's frame: a camera that looks ahead, its own frame being optical.
_AHEAD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


class NoPlace(ValueError):
    """Nobody says where a laser sits: what it measures may lie in any direction."""

    #: how to go on from its text, for :meth:`mhri.graph.ros.refusals.Refusals.note`
    verdict = ('is unknown: let tf lead to its frame from that of the robot, or give "lasers" in '
               'the type of the robot')


class Mounts:
    """The places of one robot's sensors.

    ``frames`` are those of its odometry, :class:`mhri.base.tf_tree.OdometryFrames`;
    ``robot_type`` is the robot's.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param tf: :class:`mhri.robots.ros.tf_feed.TfFeed`, None: there is no tf
    """

    def __init__(self, robot_type, tf=None):
        self.robot_type = robot_type
        self._tf = tf
        self.frames = OdometryFrames()

    def see_odometry(self, message):
        """Take in the frames of an odometry message, where its type has them."""
        self.frames = OdometryFrames.of(message)

    def laser(self, frame, number=0):
        """Return (:class:`Pose` of a laser, whether it is mounted upside down).

        :param number: which of its type's ``scan`` it is
        :raises NoPlace: neither tf nor the robot's type says where it sits
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
