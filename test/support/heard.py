# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The messages of a topic and their rate, for the tests of simulated sensors."""
import threading
import time

import rospy

TIMEOUT_S = 60.0


class Heard:
    """The messages of a topic, each with the time it came."""

    def __init__(self, topic, message_class, good=lambda message: True):
        self._changed = threading.Condition()
        self._good = good
        self.messages = []
        self.topic = topic
        self._subscriber = rospy.Subscriber(topic, message_class, self._on_message,
                                            queue_size=100, buff_size=2 ** 24, tcp_nodelay=True)

    def _on_message(self, message):
        if self._good(message):
            with self._changed:
                self.messages.append((time.monotonic(), message))
                self._changed.notify_all()

    def wait(self, count, begin=None):
        """Wait until so many have come from now on, or after the first ``begin``; return them."""
        with self._changed:
            begin = len(self.messages) if begin is None else begin
            if not self._changed.wait_for(lambda: len(self.messages) >= begin + count, TIMEOUT_S):
                raise AssertionError('only {} messages on {}'.format(
                    len(self.messages) - begin, self.topic))
            return self.messages[begin:begin + count]

    def rate_hz(self, count, begin):
        """Return the rate at which so many messages come after the first ``begin``."""
        found = self.wait(count, begin)
        return (count - 1) / (found[-1][0] - found[0][0])

    def newest(self, good=lambda message: True):
        """Return the first message from now on that is good."""
        deadline = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline:
            message = self.wait(1)[0][1]
            if good(message):
                return message
        raise AssertionError('no such message on {}; the last is {}'.format(self.topic, message))

    def silent_for(self, seconds):
        """Return whether nothing has come for so long."""
        with self._changed:
            return bool(self.messages) and time.monotonic() - self.messages[-1][0] > seconds

    def close(self):
        self._subscriber.unregister()
