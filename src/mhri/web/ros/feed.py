# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the page shows, from the ROS graph.

Subscribes ``/panel/events`` (``mhri/SessionEvent``) and, while somebody watches, ``/panel/state``
(``mhri/PanelState``) and ``/panel/pictures`` (``mhri/SeenPicture``), of one screen: that of the
operator in control, else of the one that was heard first; ``/mux/state`` (``mhri/DriveState``),
``/mhri_tasks/places`` (``mhri/Places``) and ``/map`` (``nav_msgs/OccupancyGrid``). A callback
converts and hands over.
"""
import time

from nav_msgs.msg import OccupancyGrid
import numpy
import rospy

from mhri.base.opencv import cv2
from mhri.graph.ros.messages import bytes_of
from mhri.graph.ros.node_client import NodeClient
from mhri.graph.ros.rospy_inside import caller_of
from mhri.graph.ros.service_owner import STOP_SERVICE
from mhri.graph.ros.worker import Worker
from mhri.map.grid import GridError
from mhri.map.ros.map_source import grid_of_message, TOPIC as MAP
from mhri.msg import DriveState, PanelState, Places, SeenPicture, SessionEvent
from mhri.web.said import picture_of

#: name of the row of mux.yaml by which the page drives
SOURCE = 'web'
# A screen and the drive say something twice a second at least [s].
SILENT_S = 2.0
_LOOK_S = 0.5


def fields(message):
    """Return the fields of a message without constants and header, as a dict."""
    return {name: getattr(message, name) for name in message.__slots__ if name != 'header'}


def map_picture(grid):
    """Return a grid as PNG in 8 bit grey: 0 occupied, 254 free, 205 unknown; row 0 on top."""
    cells = grid.cells.astype(numpy.int16)
    grey = numpy.where(cells < 0, 205, 254 - cells * 254 // 100).astype(numpy.uint8)
    return cv2.imencode('.png', grey[::-1])[1].tobytes()


class Feed:
    """Hands over to a hub; only :meth:`start` blocks.

    :param hub: :class:`mhri.web.io.hub.Hub`
    """

    def __init__(self, hub):
        self._hub = hub
        self._screen, self._screen_at = '', 0.0
        self._drive, self._drive_at = None, 0.0
        self._map, self._shown, self._version = None, None, 0
        self._picture = b''
        self._watched = ()
        self._tasks = NodeClient('web_tasks', '/mhri_tasks/set_place')
        self._mux = NodeClient('web_drive', STOP_SERVICE)
        self._worker = Worker('web_feed', self._look, _LOOK_S)

    def start(self):
        """Subscribe (blocking: calls the master)."""
        self._mux.subscribe('/mux/state', DriveState, self._on_drive)
        self._mux.start()
        self._tasks.subscribe('/mhri_tasks/places', Places, self._on_places)
        self._tasks.start()
        rospy.Subscriber('/panel/events', SessionEvent, self._on_event, queue_size=100)
        rospy.Subscriber(MAP, bytes_of(OccupancyGrid), self._on_map, queue_size=1,
                         buff_size=1 << 24)
        self._worker.start()

    def close(self):
        """Stop the threads; return at once."""
        for part in (self._mux, self._tasks):
            part.close()
        self._worker.stop()

    def want(self, watched):
        """Subscribe what a screen shows, or no longer; return at once."""
        self._worker.do(self._want, watched)

    def _want(self, watched):
        if watched and not self._watched:
            self._watched = (
                rospy.Subscriber('/panel/state', PanelState, self._on_state, queue_size=1,
                                 tcp_nodelay=True),
                rospy.Subscriber('/panel/pictures', SeenPicture, self._on_picture, queue_size=50,
                                 buff_size=1 << 22, tcp_nodelay=True))
        elif not watched:
            for subscriber in self._watched:
                subscriber.unregister()
            self._watched, self._screen = (), ''

    def _counts(self, message):
        """Return whether a message is from the screen that is shown."""
        return caller_of(message) == self._screen

    def _on_state(self, message):
        caller, now = caller_of(message), time.monotonic()
        operator = self._drive.operator if self._drive else ''
        if caller not in (self._screen, operator) and now - self._screen_at < SILENT_S:
            return
        self._screen, self._screen_at = caller, now
        value = fields(message)
        value['robots'] = [fields(robot) for robot in message.robots]
        self._hub.put('state', value)

    def _on_picture(self, message):
        if self._counts(message):
            found = picture_of(message.picture)
            if found:
                self._hub.show_picture(message.topic, *found)

    def _on_event(self, message):
        if self._counts(message) or not self._screen:
            self._hub.tell({'time_s': message.stamp.to_sec(), 'kind': message.kind,
                            'severity': message.severity, 'robot': message.robot,
                            'text': message.text})

    def _on_places(self, message):
        self._hub.put('places', {
            'frame': message.header.frame_id,
            'marks': [{'name': mark.name, 'x': mark.pose.x, 'y': mark.pose.y}
                      for mark in message.marks],
            'fence': [[corner.x, corner.y] for corner in message.fence]})

    def _on_map(self, message):
        self._map = message._buff

    def _on_drive(self, message):
        self._drive, self._drive_at = message, time.monotonic()
        self._hub.allow(self._problem())

    def _problem(self):
        """Return why the page may not drive, '' if it may."""
        drive = self._drive
        if drive is None or time.monotonic() - self._drive_at > SILENT_S:
            return 'The drive is not heard.'
        return '' if drive.mode == SOURCE else \
            'The operator has not chosen this source: Tablet.'

    def _look(self):
        """Notice that the drive is silent, and a new map (on the worker)."""
        self._hub.allow(self._problem())
        if self._map is self._shown:
            return
        self._shown = self._map
        try:
            grid = grid_of_message(OccupancyGrid().deserialize_numpy(self._shown, numpy))
            picture = map_picture(grid)
        except GridError as error:
            rospy.logwarn_throttle(10.0, 'the page has no map: {}'.format(error))
            return
        if picture == self._picture:
            return
        self._picture, self._version = picture, self._version + 1
        height, width = grid.cells.shape
        self._hub.put_map({
            'version': self._version, 'width': width, 'height': height,
            'resolution_m': grid.resolution_m, 'x': grid.origin.x_m, 'y': grid.origin.y_m,
            'yaw': grid.origin.heading_rad}, picture)
