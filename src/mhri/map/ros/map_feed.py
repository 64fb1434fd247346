# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map that everybody shares, and the lasers of all robots; both only while somebody looks."""
import threading
import time

from nav_msgs.msg import OccupancyGrid
import rospy
from rospy.numpy_msg import numpy_msg

from mhri.base.mocap import Pose
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe
from mhri.map.grid import grid_of, GridError
from mhri.robots.ros.convert import yaw_of
from mhri.sensors.ros.lasers import Lasers

MAP_TOPIC = '/map'
# Without numpy a map of a million cells takes rospy 0.1 s, in which no other thread runs.
_FAST_GRID = numpy_msg(OccupancyGrid)


def grid_of_message(message):
    """Return the :class:`Grid` of a ``nav_msgs/OccupancyGrid``.

    :raises GridError: it cannot be; the text says why
    """
    info, place = message.info, message.info.origin.position
    return grid_of(info.resolution, Pose(place.x, place.y, yaw_of(info.origin.orientation)),
                   info.width, info.height, message.data)


class MapFeed:
    """The newest ``/map`` (``nav_msgs/OccupancyGrid``), between :meth:`open` and :meth:`close`."""

    def __init__(self, topic=MAP_TOPIC):
        self._topic = topic
        self._lock = threading.Lock()
        self._subscriber = None
        self._grid = None
        self._refusals = Refusals(topic, time.monotonic)

    def open(self):
        """Begin to listen (blocking: it asks the master)."""
        if self._subscriber is None:
            self._subscriber = rospy.Subscriber(self._topic, _FAST_GRID, self._hear, queue_size=1,
                                                buff_size=2 ** 25)

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        subscriber, self._subscriber = self._subscriber, None
        if subscriber is not None:
            unsubscribe(subscriber)

    def _hear(self, message):
        message = self._refusals.read(message, _FAST_GRID)
        if message is None:
            return
        try:
            grid = grid_of_message(message)
        except GridError as error:
            self._refusals.note(str(error))
            return
        with self._lock:
            self._grid = grid

    def take(self):
        """Return the newest map, None if nothing is new."""
        with self._lock:
            grid, self._grid = self._grid, None
        return grid


class MapScans:
    """The lasers of several robots; the GUI thread asks, a worker opens and closes.

    :param do: function that runs a job with its arguments on a worker
    """

    def __init__(self, do):
        self._do = do
        self._wanted = {}
        self._open = {}

    def want(self, robots):
        """Listen to the lasers of these robots and no others: {name: RobotType}; returns at once.

        Those without a laser are left out.
        """
        wanted = {name: kind for name, kind in robots.items() if kind is not None and kind.scan}
        if wanted != self._wanted:
            self._wanted = wanted
            self._do(self._switch)

    def _switch(self):
        """Open and close feeds until they match the newest wish (blocking, on the worker)."""
        wanted = self._wanted
        for name, (kind, lasers) in list(self._open.items()):
            if wanted.get(name) != kind:
                del self._open[name]
                lasers.close()
        for name, kind in wanted.items():
            if name not in self._open:
                lasers = Lasers(name, kind)
                lasers.open()
                self._open[name] = kind, lasers

    def names(self):
        """Return the robots whose lasers are listened to now."""
        return tuple(self._open)

    def take(self, name, frames):
        """Return the new scans of a robot, as :meth:`Lasers.each` has them."""
        _, lasers = self._open.get(name, (None, None))
        return lasers.each(frames) if lasers is not None else {}

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        self._wanted = {}
        self._switch()
