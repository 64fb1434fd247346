# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pose and lens of a robot's camera above the floor, from ``camera_info`` and tf."""
import time

from sensor_msgs.msg import CameraInfo

from mhri.base.names import topic_of
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.subscription import Subscription
from mhri.robots.ros.tf_feed import SHARED
from mhri.sensors.floor import FloorCamera
from mhri.sensors.point_cloud import Lens
from mhri.sensors.ros.cloud_feed import info_topic
from mhri.sensors.ros.mounts import Mounts


class FloorCameraFeed:
    """The camera of a robot, between :meth:`open` and :meth:`close`.

    Subscribes the ``camera_info`` (``sensor_msgs/CameraInfo``) beside ``/<robot>/<rgb>``. The pose
    is that of tf, else that of the robot's type. It is constant: close the feed once it is known.
    """

    @classmethod
    def of(cls, robot, kind, _):
        """Return the feed of a robot, None for a type without a camera."""
        return cls(robot, kind) if kind.rgb else None

    def __init__(self, robot, robot_type):
        self._topics = [info_topic(topic_of(robot, topic)) for topic in robot_type.rgb]
        self._mounts = Mounts(robot_type, SHARED)
        self._refusals = Refusals(robot, time.monotonic)
        self._lines = []
        self._info = None

    def open(self):
        """Subscribe (blocking: it asks the master)."""
        SHARED.open(self)
        self._lines = [Subscription(topic, self._receive) for topic in self._topics]

    def close(self):
        """Unsubscribe (blocking: it asks the master)."""
        lines, self._lines = self._lines, []
        for line in lines:
            line.close()
        SHARED.close(self)

    def _receive(self, _, data):
        """Store the newest message (rospy's thread)."""
        try:
            self._info = CameraInfo().deserialize(bytes(data))
        except Exception as error:  # genpy raises various types for malformed bytes
            self._refusals.note('a sensor_msgs/CameraInfo of these bytes ({!r})'.format(error))

    def take(self, frames):
        """Return the :class:`FloorCamera`, None while its lens or its height is unknown.

        :param frames: :class:`mhri.base.tf_tree.OdometryFrames` of the robot
        """
        info = self._info
        if info is None:
            return None
        self._mounts.frames = frames
        matrix, known = self._mounts.camera(info.header.frame_id)
        found = FloorCamera(matrix, Lens(info.K[0], info.K[4], info.K[2], info.K[5], info.width,
                                         info.height))
        return found if known and found.usable else None
