# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stream thinned on the network: a connection per picture, at a low rate.

A subscriber gets every message of a topic. Requesting a connection from the publisher itself and
resetting it after a message costs an extra 4 to 5 kB, 1 ms of CPU here and about as much there, and
no master call. Opening and closing a subscription instead costs 5 ms here, four calls to the master
and, with a publisher in Python, a whole extra picture (measured on loopback with pictures of 40 kB;
unthinned, 30 Hz take 4 ms of CPU per second).
"""
import select
import threading
import time

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.recording.ros.raw_link import LinkError, RawLink

# A camera with a longer period [s] is not thinned.
TIMEOUT_S = 3.0
CONNECT_S = 1.0
AGAIN_S = 1.0
LOOK_S = 0.1
# Number of pictures read the first time, to measure the rate of the camera.
FIRST = 4


def no_answer(topic):
    """Return the problem of an unresponsive publisher, in plain words and in terms of ROS."""
    return ('its camera is known, but does not answer',
            '{} is registered, but its sender does not answer'.format(topic))


class Samples:
    """Single messages of one topic as bytes; stands in for a :class:`Subscription`.

    The node is not registered as a subscriber: only the publisher lists the connections, while they
    last. ``native_hz`` is the rate of the camera [Hz], None if unknown.

    :param on_bytes: called with (type, bytes-like) on a thread of this object
    :param on_problem: called with a sentence, and with details in terms of ROS, if no publisher
        answers
    :param rate_hz: rate of the samples [Hz], > 0; may be changed
    :param native_hz: rate of the camera [Hz], if already known
    """

    def __init__(self, topic, on_bytes, on_problem, rate_hz, native_hz=None, clock=time.monotonic):
        self.topic = topic
        self.rate_hz = rate_hz
        self.native_hz = native_hz
        self._on_bytes = on_bytes
        self._on_problem = on_problem
        self._clock = clock
        self._ended = threading.Event()
        self._uri = None
        threading.Thread(target=self._run, daemon=True, name='samples ' + topic).start()

    def close(self):
        """Stop; return at once; an open connection closes soon."""
        self._ended.set()

    def _run(self):
        due = self._clock()
        while not self._ended.wait(max(0.0, due - self._clock())):
            taken = False
            try:
                taken = self._take()
            except Exception as error:  # the guard of this thread
                rospy.logerr_throttle(5.0, '{}: taking a picture: {!r}'.format(self.topic, error))
            due = max(due + 1.0 / self.rate_hz, self._clock()) if taken \
                else self._clock() + AGAIN_S

    def _take(self):
        """Read one picture, several if the camera's rate is unknown; return whether one arrived."""
        link = self._connect()
        if link is None:
            return False
        try:
            return self._read(link, 1 if self.native_hz else FIRST)
        except LinkError as error:
            self._uri = None
            self._on_problem(str(error))
            return False
        finally:
            link.cut()

    def _connect(self):
        """Return a connection to the first responding publisher, or None."""
        try:
            for uri in [self._uri] if self._uri else MasterApi(
                    rospy.get_name()).publisher_uris(self.topic):
                try:
                    link = RawLink(self.topic, uri, rospy.get_name(), CONNECT_S)
                    self._uri = uri
                    return link
                except LinkError as error:
                    self._uri = None
                    rospy.logdebug('%s', error)
        except MasterError as error:
            self._on_problem(str(error))
            return None
        self._on_problem(*no_answer(self.topic))
        return None

    def _read(self, link, wanted):
        """Pass on this many messages; return whether one arrived in time.

        :raises LinkError: the publisher is gone
        """
        times = []
        until = self._clock() + TIMEOUT_S
        while len(times) < wanted and self._clock() < until and not self._ended.is_set():
            frames = link.read()
            if not frames:
                select.select([link], [], [], LOOK_S)
            for frame in frames[:wanted - len(times)]:
                times.append(self._clock())
                # Skip the length at the start.
                self._on_bytes(link.fields['type'], memoryview(frame)[4:])
        if len(times) > 1 and times[-1] > times[0]:
            self.native_hz = (len(times) - 1) / (times[-1] - times[0])
        return bool(times)
