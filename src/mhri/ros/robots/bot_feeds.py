# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What one bot window can show of its robot: a row for each view, opened while it is wanted."""
from mhri.core.camera.images import DEPTH, RGB
from mhri.ros.camera.camera_feed import CameraFeed
from mhri.ros.sensors.cloud_feed import CloudFeed
from mhri.ros.sensors.imu_feed import ImuFeed
from mhri.ros.sensors.mocap_feed import MocapFeed
from mhri.ros.sensors.scan_feed import ScanFeed

IMU, SCAN, CLOUD, RECORD, MOCAP = 'imu', 'scan', 'cloud', 'record', 'mocap'

# A further view is a further row: key, whether a type has it, what makes its feed.
_ROWS = (
    (IMU, lambda kind: kind.imu or kind.odometry,
     lambda robot, kind: ImuFeed(robot, kind.imu, kind.odometry, kind.odometry_type)),
    (RGB, lambda kind: kind.rgb, lambda robot, kind: CameraFeed(robot, kind.rgb, RGB)),
    (DEPTH, lambda kind: kind.depth, lambda robot, kind: CameraFeed(robot, kind.depth, DEPTH)),
    (SCAN, lambda kind: kind.scan, lambda robot, kind: ScanFeed(robot, kind.scan)),
    (CLOUD, lambda kind: kind.cloud or kind.depth,
     lambda robot, kind: CloudFeed.of(robot, kind, CLOUD)),
    (MOCAP, lambda kind: True, lambda robot, kind: MocapFeed(robot)),
)


class BotFeeds:
    """The feeds of one robot's window; the GUI thread wishes, a worker opens and closes.

    :param robot: the robot's name
    :param robot_type: :class:`mhri.core.robots.robot_types.RobotType`
    :param worker: :class:`mhri.ros.worker.Worker` for the calls that ask the master
    """

    def __init__(self, robot, robot_type, worker):
        self._robot = robot
        self._type = robot_type
        self._worker = worker
        self._makers = {key: make for key, has, make in _ROWS if has(robot_type)}
        self._feeds = {}
        self._wanted = frozenset()
        self._open = frozenset()

    def offers(self):
        """Return the keys of the views that a robot of this type can have."""
        return frozenset(self._makers) - {MOCAP} | ({RECORD} if self._type.imu else frozenset())

    def want(self, keys):
        """Say which views are to be fed from now on; returns at once."""
        keys = frozenset(keys) & frozenset(self._makers)
        if keys != self._wanted:
            self._wanted = keys
            self._worker.do(self._switch)

    def _switch(self):
        """Open and close until the newest wish is met (blocking, on the worker)."""
        for key in self._open - self._wanted:
            self._feeds[key].close()
        for key in self._wanted - self._open:
            if key not in self._feeds:
                self._feeds[key] = self._makers[key](self._robot, self._type)
            self._feeds[key].open()
        self._open = self._wanted

    def close(self):
        """Close every feed (blocking: it asks the master)."""
        self._wanted = frozenset()
        self._switch()

    def get(self, key):
        """Return an open feed, None where it is not wanted or not open yet."""
        return self._feeds.get(key) if key in self._open and key in self._wanted else None

    def bits_per_s(self):
        """Return what the pictures of this robot take of the network now [bit/s]."""
        feeds = [self.get(key) for key in (RGB, DEPTH)]
        return sum(feed.status().bits_per_s for feed in feeds if feed is not None)
