# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a tile can show of its robot: a feed for each view, opened while it is wanted."""
import threading

import rospy

from mhri.base.tf_tree import OdometryFrames
from mhri.base.view_rows import load, RECORD, VIEW_ROWS
from mhri.robots.ros.mocap_feed import MocapFeed

MOCAP = 'mocap'


class BotFeeds:
    """The feeds of one robot's tile; the GUI thread asks, a worker opens and closes.

    :param robot: the robot's name
    :param robot_type: :class:`mhri.base.robot_types.RobotType`; kept as an attribute
    :param worker: :class:`mhri.graph.ros.worker.Worker` for the calls that ask the master
    """

    def __init__(self, robot, robot_type, worker):
        self.robot_type = robot_type
        #: its tf frames, empty until its odometry has named them
        self.frames = OdometryFrames()
        #: what else is read of the robot, and counts what it refuses
        self.others = {}
        self._robot = robot
        self._worker = worker
        made = {row.key: load(row.feed).of(robot, robot_type, row.key) for row in VIEW_ROWS}
        self._feeds = {key: feed for key, feed in made.items() if feed is not None}
        self._feeds[MOCAP] = MocapFeed(robot)
        self._wanted = frozenset()
        self._open = frozenset()
        self._switching = threading.Lock()

    def offers(self):
        """Return the keys of the views that a robot of this type can have."""
        return frozenset(self._feeds) - {MOCAP} | ({RECORD} if self.robot_type.imu else frozenset())

    def want(self, keys):
        """Choose the views to feed from now on; returns at once."""
        keys = frozenset(keys) & frozenset(self._feeds)
        if keys != self._wanted:
            self._wanted = keys
            self._worker.do(self._switch)

    def _switch(self):
        """Open and close feeds until they match the newest wish (blocking)."""
        # The worker may be opening what the end of the screen closes.
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
        except Exception as error:  # of rospy: it must not keep the others as they are
            rospy.logerr('%s: cannot %s its %s: %r', self._robot, act, key, error)

    def close(self):
        """Close every feed (blocking: it asks the master)."""
        self._wanted = frozenset()
        self._switch()

    def get(self, key):
        """Return an open feed, None if it is not wanted or not open yet."""
        return self._feeds.get(key) if key in self._open and key in self._wanted else None

    def refused(self):
        """Return {key: impossible messages left out so far} for feeds that had any."""
        counts = {key: feed.refused() for key, feed in [*self._feeds.items(), *self.others.items()]
                  if hasattr(feed, 'refused')}
        return {key: count for key, count in counts.items() if count}

    def bits_per_s(self):
        """Return how much of the network this robot's pictures and clouds take now [bit/s]."""
        feeds = [self.get(row.key) for row in VIEW_ROWS]
        return sum(feed.status().bits_per_s for feed in feeds if hasattr(feed, 'status'))
