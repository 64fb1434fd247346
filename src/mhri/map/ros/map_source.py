# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map: a file of map_server, published as ``/map``, or the one of another publisher.

Interfaces: ``/map`` (``nav_msgs/OccupancyGrid``, latched; occupancy in [0, 100], -1 for unknown):
published if a file is given, else subscribed: by the tasks as bytes, by a screen while it shows
the map.
"""
import os

from geometry_msgs.msg import Quaternion
from nav_msgs.msg import OccupancyGrid
import numpy
import rospy
from rospy.numpy_msg import numpy_msg

from mhri.base.config import ConfigError
from mhri.base.geometry import Pose
from mhri.graph.ros.messages import bytes_of
from mhri.graph.ros.resources import read_text
from mhri.graph.ros.stream import Stream
from mhri.map.floor import Floor
from mhri.map.grid import grid_of, GridError, picture_size, read_map, size_problem
from mhri.robots.ros.convert import turn_of, yaw_of

TOPIC, FRAME = '/map', 'map'
# Cells as a numpy array: a map of 4 million cells as Python numbers takes a second.
GridMessage = numpy_msg(OccupancyGrid)


def grid_of_message(message):
    """Return the :class:`Grid` of a ``nav_msgs/OccupancyGrid``.

    :raises GridError: it is invalid; the text names the problem
    """
    info, place, turn = message.info, message.info.origin.position, message.info.origin.orientation
    # Many leave the orientation at zeros, which is an unturned map for every program that shows it.
    heading_rad = yaw_of(turn) if any((turn.x, turn.y, turn.z, turn.w)) else 0.0
    return grid_of(info.resolution, Pose(place.x, place.y, heading_rad), info.width, info.height,
                   message.data)


def map_stream():
    """Return the :class:`Stream` of the :class:`Grid` of ``/map``."""
    return Stream([TOPIC], GridMessage, lambda message, note: grid_of_message(message),
                  buff_size=2 ** 25)


def load_map(path):
    """Return the :class:`mhri.map.grid.Grid` of a YAML file of map_server.

    :raises ConfigError: names the file, the key and the remedy
    :raises OSError: it cannot be read
    """
    def load_image(name):
        """Return the picture; its path is relative to the folder of the file."""
        from mhri.base.opencv import cv2  # imported late, only needed with a file
        image = os.path.join(os.path.dirname(os.path.abspath(path)), name)
        if not os.path.isfile(image):
            return None
        with open(image, 'rb') as file:
            size = picture_size(file.read(1000))
        # Check the size before decoding: a large picture would take half a minute and all memory.
        problem = size and size_problem(1.0, Pose(0.0, 0.0, 0.0), *size)
        if problem:
            raise ConfigError(path, 'image', problem)
        return cv2.imread(image, cv2.IMREAD_UNCHANGED)

    return read_map(read_text(path), path, load_image)


def grid_message(grid):
    """Return the ``nav_msgs/OccupancyGrid`` of a grid, in the frame ``map``."""
    message = GridMessage()
    message.header.frame_id, message.header.stamp = FRAME, rospy.Time.now()
    info, origin = message.info, grid.origin
    info.map_load_time, info.resolution = message.header.stamp, grid.resolution_m
    info.height, info.width = grid.cells.shape
    info.origin.position.x, info.origin.position.y = origin.x_m, origin.y_m
    info.origin.orientation = Quaternion(0.0, 0.0, *turn_of(origin.heading_rad))
    message.data = grid.cells.reshape(-1)
    return message


def publish_map(grid):
    """Publish a grid as ``/map``, latched; return the publisher, which the caller must keep."""
    publisher = rospy.Publisher(TOPIC, GridMessage, queue_size=1, latch=True)
    publisher.publish(grid_message(grid))
    return publisher


class MapSource:
    """The current map.

    :param grid: the grid of a file, to be published; None: that of another publisher
    """

    def __init__(self, grid=None):
        self._grid = grid
        self._bytes = None
        self._publisher = None
        self._floor_of = None
        #: the :class:`Floor` of the newest processed map, None before the first
        self.floor = None

    def start(self):
        """Publish the map, or subscribe to it (blocking: calls the master)."""
        if self._grid is not None:
            self._publisher = publish_map(self._grid)
        else:
            rospy.Subscriber(TOPIC, bytes_of(OccupancyGrid), self._on_message, queue_size=1,
                             buff_size=1 << 24)

    def _on_message(self, message):
        # Parsed on request: mapping programs publish the whole map again and again.
        self._bytes = message._buff

    @property
    def is_there(self):
        """Whether there is a map."""
        return self._grid is not None or self._bytes is not None

    def grid(self):
        """Return the newest :class:`Grid`, None without a map.

        :raises GridError: the published map is invalid
        """
        buff = self._bytes
        if self._grid is not None or buff is None:
            return self._grid
        try:
            message = OccupancyGrid().deserialize_numpy(buff, numpy)
        except Exception as error:  # genpy may raise anything for malformed bytes
            raise GridError('no map: {}'.format(error))
        return grid_of_message(message)

    def look(self):
        """Compute the free floor of a new map (slow for a large one)."""
        newest = self._grid or self._bytes
        if newest is self._floor_of:
            return
        self._floor_of = newest
        try:
            grid = self.grid()
        except GridError as error:
            rospy.logwarn('the tasks do without the map: %s', error)
            grid = None
        self.floor = grid and Floor(grid)
