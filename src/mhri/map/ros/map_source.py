# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map: a file of map_server that is published as ``/map``, or what somebody else publishes.

Interfaces: ``/map`` (``nav_msgs/OccupancyGrid``, latched; occupancy in [0, 100], -1 for unknown):
published where a file is given, else subscribed.
"""
import os

from geometry_msgs.msg import Quaternion
from nav_msgs.msg import OccupancyGrid
import numpy
import rospy
from rospy.numpy_msg import numpy_msg

from mhri.base.config import ConfigError
from mhri.base.mocap import Pose
from mhri.graph.ros.messages import bytes_of
from mhri.graph.ros.resources import read_text
from mhri.map.floor import Floor
from mhri.map.grid import grid_of, GridError, picture_size, read_map, size_problem
from mhri.robots.ros.convert import yaw_of

TOPIC, FRAME = '/map', 'map'
# numpy's bytes as they are: a map of 4 million cells as Python numbers takes a second.
GridMessage = numpy_msg(OccupancyGrid)


def load_map(path):
    """Return the :class:`mhri.map.grid.Grid` of a YAML file of map_server.

    :raises ConfigError: names the file, the key and the remedy
    :raises OSError: it cannot be read
    """
    def load_image(name):
        """Return the picture; its path counts from the folder of the file."""
        from mhri.base.opencv import cv2  # without a file, a start does not wait for it
        image = os.path.join(os.path.dirname(os.path.abspath(path)), name)
        if not os.path.isfile(image):
            return None
        with open(image, 'rb') as file:
            size = picture_size(file.read(1000))
        # Before it is unpacked, which takes half a minute and all the memory for a large one.
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
    info.origin.orientation = Quaternion(0.0, 0.0, *_half(origin.heading_rad))
    message.data = grid.cells.reshape(-1)
    return message


def _half(heading_rad):
    return numpy.sin(0.5 * heading_rad), numpy.cos(0.5 * heading_rad)


def publish_map(grid):
    """Publish a grid as ``/map``, latched; return the publisher, which has to be kept."""
    publisher = rospy.Publisher(TOPIC, GridMessage, queue_size=1, latch=True)
    publisher.publish(grid_message(grid))
    return publisher


class MapSource:
    """The map in force.

    :param grid: of a file, which is published; None: the one that somebody else publishes
    """

    def __init__(self, grid=None):
        self._grid = grid
        self._bytes = None
        self._publisher = None
        self._floor_of = None
        #: the :class:`Floor` of the newest map that was looked at, None before
        self.floor = None

    def start(self):
        """Publish it, or listen to it (blocking: it asks the master)."""
        if self._grid is not None:
            self._publisher = publish_map(self._grid)
        else:
            rospy.Subscriber(TOPIC, bytes_of(OccupancyGrid), self._hear, queue_size=1,
                             buff_size=1 << 24)

    def _hear(self, message):
        # Read when somebody asks for it: whoever makes a map publishes all of it again and again.
        self._bytes = message._buff

    @property
    def is_there(self):
        """Whether there is a map."""
        return self._grid is not None or self._bytes is not None

    def grid(self):
        """Return the newest :class:`Grid`, None where there is no map.

        :raises GridError: what is published is no map
        """
        buff = self._bytes
        if self._grid is not None or buff is None:
            return self._grid
        try:
            message = OccupancyGrid().deserialize_numpy(buff, numpy)
        except Exception as error:  # whatever bytes may lead genpy to
            raise GridError('no map: {}'.format(error))
        info, corner = message.info, message.info.origin
        return grid_of(info.resolution, Pose(corner.position.x, corner.position.y,
                                             yaw_of(corner.orientation)),
                       info.width, info.height, message.data)

    def look(self):
        """Work out where the floor of a new map is free (a large one takes a while)."""
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
