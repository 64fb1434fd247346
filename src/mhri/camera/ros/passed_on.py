# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Passes the pictures that this screen receives on to the session's recorder.

A second connection to a camera would double what it sends over the radio; this one ends on this
computer. No more pictures are passed on than the recorder keeps; of those that come raw at most
:data:`RAW_HZ`, compressed here.
"""
import time

import rospy
from sensor_msgs.msg import CompressedImage, Image

from mhri.camera.images import FrameError
from mhri.camera.recompressed import recompressed

# A picture of 640x480 costs 3 ms of a core, a depth picture 9 ms.
RAW_HZ = 5.0


class PassedOn:
    """The pictures of all cameras of one program."""

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._publisher = None
        self._period_s = None
        self._due_s = {}

    def open(self, publisher):
        """Pass on through this publisher of ``mhri/SeenPicture``; None: nothing."""
        self._publisher = publisher

    def keep(self, hz):
        """Pass on so many pictures a second of each camera; -1: all, 0: none."""
        self._period_s = None if not hz else max(0.0, 1.0 / hz)

    def hearing(self, topic, hear):
        """Return a function of (type, bytes) that calls another one, and passes the bytes on."""
        def heard(message_type, data):
            """Take a picture (on the thread that received it)."""
            hear(message_type, data)
            if message_type == CompressedImage._type:
                self._pass(topic, data)
            elif message_type == Image._type:
                self._pass_raw(topic, data)
        return heard

    def _pass(self, topic, data):
        publisher = self._due(topic)
        if publisher is not None:
            publisher.publish(topic, bytes(data))

    def _pass_raw(self, topic, data):
        publisher = self._due(topic, 1.0 / RAW_HZ)
        if publisher is None:
            return
        try:
            suffix, message = recompressed(data)
        except FrameError as error:
            # Its tile says so.
            rospy.logdebug('%s is not recorded: %s', topic, error)
            return
        publisher.publish(topic + suffix, message)

    def _due(self, topic, least_s=0.0):
        """Return the publisher if a picture is to be passed on now, else None."""
        publisher, period_s = self._publisher, self._period_s
        if publisher is None or period_s is None or not publisher.get_num_connections():
            return None
        now = self._clock()
        if now < self._due_s.get(topic, 0.0):
            return None
        # A little early is in time: a camera does not keep to the beat of this clock.
        self._due_s[topic] = now + 0.9 * max(period_s, least_s)
        return publisher


PASSED_ON = PassedOn()
