# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot's laser and depth camera sit on it: by tf, else as its type says."""
import math

import numpy as np

from mhri.core.map.tf_tree import frame_name
from mhri.core.robots.mocap import Pose

# A laser that is tilted by more does not measure in the plane: its frame says nothing [cosine].
_LEVEL = 0.9
# In the robot's frame: a camera that looks ahead, its own frame being optical.
_AHEAD = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


class Mounts:
    """The places of one robot's sensors.

    ``base`` is the frame of the robot itself, '' until its odometry has named it.

    :param robot_type: :class:`mhri.core.robots.robot_types.RobotType`
    :param frames: :class:`mhri.ros.map.tf_feed.TfFeed`, None: there is no tf
    """

    def __init__(self, robot_type, frames=None):
        self._type = robot_type
        self._frames = frames
        self.base = ''

    def see_odometry(self, message):
        """Take in the robot's frame of an odometry message, where its type has one."""
        self.base = frame_name(getattr(message, 'child_frame_id', ''))

    def laser(self, frame):
        """Return (:class:`Pose` of a laser, whether it is mounted upside down)."""
        matrix = self._matrix(frame)
        if matrix is None or abs(matrix[2, 2]) < _LEVEL:
            return Pose(self._type.laser_x_m, 0.0, 0.0), False
        return Pose(float(matrix[0, 3]), float(matrix[1, 3]),
                    math.atan2(matrix[1, 0], matrix[0, 0])), matrix[2, 2] < 0.0

    def camera(self, frame):
        """Return (matrix of a camera's optical frame in the robot's, whether z is its height)."""
        matrix = self._matrix(frame)
        if matrix is not None:
            return matrix, True
        matrix = np.eye(4)
        matrix[:3, :3] = _AHEAD
        matrix[0, 3], matrix[2, 3] = self._type.depth_x_m, self._type.depth_z_m
        return matrix, self._type.depth_z_m > 0.0

    def _matrix(self, frame):
        frame = frame_name(frame)
        if self._frames is None or not (frame and self.base):
            return None
        return self._frames.matrix(self.base, frame)
