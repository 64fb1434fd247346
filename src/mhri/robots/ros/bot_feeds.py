# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The data of a robot on the screen: a feed for each view, open while it is requested."""
import threading

import rospy

from mhri.base.tf_tree import OdometryFrames
from mhri.base.view_rows import FLOOR_CAMERA, load, RECORD, RGB, SCAN, VIEW_ROWS
from mhri.robots.ros.streams import MOCAP

#: key of a second feed of the scans, for the map, which reads them at its own pace
MAP_SCAN = 'scan on the map'
_FLOOR_CAMERA_FEED = 'mhri.sensors.ros.floor_camera.FloorCameraFeed'


class BotFeeds:
    """The feeds of one robot; the GUI thread requests them, a worker opens and closes them.

    :param robot: the robot's name
    :param robot_type: :class:`mhri.base.robot_types.RobotType`; kept as an attribute
    :param worker: :class:`mhri.graph.ros.worker.Worker` for the calls to the master
    """

    def __init__(self, robot, robot_type, worker):
        self.robot_type = robot_type
        #: its tf frames, empty until the first message of its odometry
        self.frames = OdometryFrames()
        #: other streams of the robot that count refused messages, for :meth:`refused`
        self.others = {}
        self._robot = robot
        self._worker = worker
        rows = [(row.key, row.key, row.feed) for row in VIEW_ROWS]
        rows += [(MAP_SCAN, key, feed) for key, _, feed in rows if key == SCAN]
        rows += [(FLOOR_CAMERA, RGB, _FLOOR_CAMERA_FEED)]
        made = {key: load(feed).of(robot, robot_type, row) for key, row, feed in rows}
        self._feeds = {key: feed for key, feed in made.items() if feed is not None}
        self._feeds[MOCAP.key] = MOCAP.stream(robot, robot_type)
        self._wishes = {}
        self._wanted = frozenset()
        self._open = frozenset()
        self._switching = threading.Lock()

    def offers(self):
        """Return the keys of the views available for a robot of this type."""
        return frozenset(self._feeds) - {MOCAP.key, MAP_SCAN, FLOOR_CAMERA} | (
            {RECORD} if self.robot_type.imu else frozenset())

    def request(self, keys, user='tile'):
        """Choose the feeds of one user from now on; returns at once.

        :param user: a feed is open while any user requests it
        """
        self._wishes[user] = frozenset(keys) & frozenset(self._feeds)
        wanted = frozenset().union(*self._wishes.values())
        if wanted != self._wanted:
            self._wanted = wanted
            self._worker.do(self._switch)

    def _switch(self):
        """Open and close feeds until they match the newest request (blocking)."""
        # The worker may be opening feeds while the closing screen closes them.
        with self._switching:
            wanted, before = self._wanted, self._open
            self._open = before & wanted
            for feeds, act in ((before - wanted, 'close'), (wanted - before, 'open')):
                for key in feeds:
                    self._do(key, act)
            self._open = wanted

    def _do(self, key, act):
        try:
            getattr(self._feeds[key], act)()
        except Exception as error:  # of rospy: the other feeds still have to switch
            rospy.logerr('%s: cannot %s its %s: %r', self._robot, act, key, error)

    def close(self):
        """Close every feed (blocking: it asks the master)."""
        self._wanted = frozenset()
        self._switch()

    def get(self, key):
        """Return an open feed, None if it is not requested or not open yet."""
        return self._feeds.get(key) if key in self._open and key in self._wanted else None

    def refused(self):
        """Return {key: impossible messages left out so far} for feeds that had any."""
        counts = {key: feed.refused() for key, feed in [*self._feeds.items(), *self.others.items()]
                  if hasattr(feed, 'refused')}
        return {key: count for key, count in counts.items() if count}

    def bits_per_s(self):
        """Return the bandwidth of this robot's pictures and clouds [bit/s]."""
        feeds = [self.get(row.key) for row in VIEW_ROWS]
        return sum(feed.status().bits_per_s for feed in feeds if hasattr(feed, 'status'))
