# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Relays the pictures that the screens of this program receive, for every other reader of them.

A second connection to a camera would double its load on the radio; this relay stays on the
computer. Publishes ``/panel/pictures`` (``mhri/SeenPicture``): each camera at the largest of the
rates that its readers want, for all of them; a reader that wants fewer leaves some out. Raw
pictures are compressed here, at :data:`RAW_HZ` at most.
"""
import math
import threading
import time

import rospy
from sensor_msgs.msg import CompressedImage, Image

from mhri.camera.images import FrameError
from mhri.camera.ros.recompressed import recompressed
from mhri.camera.shades import Shades
from mhri.camera.transports import PICTURES
from mhri.msg import SeenPicture

# A picture of 640x480 takes 3 ms of a core, a depth picture 9 ms.
RAW_HZ = 5.0


def advertise():
    """Return the publisher (blocking: calls the master)."""
    return rospy.Publisher(PICTURES, SeenPicture, queue_size=4)


class PictureRelay:
    """Relays the pictures of all cameras of one program.

    :param advertise: function that returns the publisher of ``mhri/SeenPicture``
    """

    def __init__(self, clock=time.monotonic, advertise=advertise):
        self._clock = clock
        self._advertise = advertise
        self._lock = threading.Lock()
        self._screens = 0
        self._publisher = None
        self._wishes = {}
        self._due_s = {}
        self._names = {}

    def open(self):
        """Relay for one more screen (blocking: calls the master)."""
        with self._lock:
            self._screens += 1
            if self._publisher is None:
                self._publisher = self._advertise()

    def close(self):
        """Relay for one screen less (blocking: calls the master)."""
        with self._lock:
            self._screens -= 1
            if self._screens:
                return
            publisher, self._publisher = self._publisher, None
        publisher.unregister()

    def limit(self, reader, hz, of_robots=None):
        """Set the rate of each camera that a reader wants [Hz]; -1: all pictures, 0: none.

        :param reader: any hashable value; its last wish counts
        :param of_robots: {robot: rate} of those of which it wants another rate
        """
        wishes = dict(self._wishes)
        wishes[reader] = (hz, dict(of_robots or {}))
        self._wishes = {key: wish for key, wish in wishes.items() if wish[0] or wish[1]}

    def name_of(self, topic):
        """Return ``topic`` of the messages that relay a topic; '' for ''."""
        return self._names.get(topic, topic)

    def relaying(self, topic, receive, kind):
        """Return a function of (type, bytes) that calls ``receive``, and relays the bytes.

        :param kind: 'rgb' or 'depth'
        """
        shades = Shades()

        def heard(message_type, data):
            """Handle a picture (on the thread that received it)."""
            receive(message_type, data)
            if message_type == CompressedImage._type:
                self._pass(topic, data)
            elif message_type == Image._type:
                self._pass_raw(topic, data, kind, shades)
        return heard

    def _pass(self, topic, data):
        publisher = self._due(topic)
        if publisher is not None:
            publisher.publish(topic, bytes(data))

    def _pass_raw(self, topic, data, kind, shades):
        publisher = self._due(topic, 1.0 / RAW_HZ)
        if publisher is None:
            return
        try:
            suffix, message = recompressed(data, kind, shades, self._clock())
        except FrameError as error:
            # Its tile shows the reason.
            rospy.logdebug('%s is not relayed: %s', topic, error)
            return
        self._names[topic] = topic + suffix
        publisher.publish(topic + suffix, message)

    def _wanted_hz(self, topic):
        """Return the largest wanted rate of a camera [Hz], 0 if nobody wants any."""
        robot = topic.split('/')[1]
        return max((math.inf if rate < 0.0 else rate for rate in (
            of_robots.get(robot, hz) for hz, of_robots in self._wishes.values())), default=0.0)

    def _due(self, topic, least_s=0.0):
        """Return the publisher if a picture is due now, else None."""
        publisher, wanted_hz = self._publisher, self._wanted_hz(topic)
        if publisher is None or not wanted_hz or not publisher.get_num_connections():
            return None
        now = self._clock()
        if now < self._due_s.get(topic, 0.0):
            return None
        # Accept pictures a little early: a camera is not synchronised with this clock.
        self._due_s[topic] = now + 0.9 * max(1.0 / wanted_hz, least_s)
        return publisher


PICTURE_RELAY = PictureRelay()
