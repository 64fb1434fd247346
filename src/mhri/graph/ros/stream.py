# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The newest values of topics: stored on arrival, read at any time."""
import math
import threading
import time
from typing import Any, NamedTuple

import rospy

from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.rospy_inside import unsubscribe


class Newest(NamedTuple):
    """The newest message: its value, its time of arrival [s], and the index of its topic."""

    value: Any
    at_s: float
    number: int


class Stream:
    """Topics with messages of one type, subscribed between :meth:`open` and :meth:`close`.

    rospy has one connection for all subscribers of a topic in a program: the class of the first
    determines the type they all receive, the queue size of the last the messages they miss. So this
    subscribes the real class, on which others may rely, and reads bytes (``rospy.AnyMsg``) if
    another subscriber uses those. Set a queue size only if the program does not record the topic.

    :param topics: absolute names; may be empty
    :param message_class: class of the messages
    :param read: function of a message and of a callback for impossible parts
        (:meth:`mhri.graph.ros.refusals.Refusals.note`); returns its value, or raises
        :exc:`ValueError` to leave it out; default: the message is the value
    :param clock: function that returns monotonic seconds
    :param on_message: called with the :class:`Newest` of each message on its topic's thread; its
        value is None if the message was left out
    :param options: options of ``rospy.Subscriber``
    """

    def __init__(self, topics, message_class, read=lambda message, note: message,
                 clock=time.monotonic, on_message=None, **options):
        self.topics = tuple(topics)
        self._class = message_class
        self._read = read
        self._clock = clock
        self._on_message = on_message
        self._options = options
        self._lock = threading.Lock()
        self._subscribers = []
        self._refusals = [Refusals(topic, clock) for topic in self.topics]
        # {index of the topic: Newest}, and the ones not taken yet.
        self._newest, self._new = {}, {}

    def open(self):
        """Subscribe, unless already done (blocking: calls the master)."""
        if not self._subscribers:
            self._subscribers = [
                rospy.Subscriber(topic, self._class, self._receive, number, tcp_nodelay=True,
                                 **self._options) for number, topic in enumerate(self.topics)]

    def close(self):
        """Unsubscribe and discard the values (blocking: calls the master)."""
        subscribers, self._subscribers = self._subscribers, []
        for subscriber in subscribers:
            unsubscribe(subscriber)
        with self._lock:
            self._newest, self._new = {}, {}

    def _receive(self, message, number):
        newest, refusals = Newest(None, self._clock(), number), self._refusals[number]
        message = refusals.read(message, self._class)
        try:
            if message is not None:
                newest = newest._replace(value=self._read(message, refusals.note))
                with self._lock:
                    self._newest[number] = self._new[number] = newest
        except ValueError as error:
            refusals.note(error)
        if self._on_message is not None:
            self._on_message(newest)

    def newest(self):
        """Return the :class:`Newest` of all topics, None before the first."""
        with self._lock:
            return max(self._newest.values(), key=_at_s, default=None)

    def value(self, within_s=math.inf):
        """Return the newest value, None before the first, or if it is older than a time [s]."""
        newest = self.newest()
        return newest.value if newest and self._clock() - newest.at_s <= within_s else None

    def value_while_connected(self):
        """Return the newest value, None while no publisher is connected.

        For values that are published only once, latched.
        """
        return self.value() if self.connections() else None

    def take(self):
        """Return the :class:`Newest` if it is new since the last call, else None."""
        return max(self.take_each(), key=_at_s, default=None)

    def take_each(self):
        """Return a list of the :class:`Newest` of each topic with a new message since then."""
        with self._lock:
            new, self._new = self._new, {}
        return list(new.values())

    def age_s(self, number=None):
        """Return the age of the newest value [s], None before the first.

        :param number: index of a topic; default: the topic of the newest message
        """
        newest = self.newest() if number is None else self._newest.get(number)
        return None if newest is None else self._clock() - newest.at_s

    def note(self, problem, verdict='is impossible', number=0):
        """Count and log why a value is not used, see :meth:`Refusals.note`."""
        self._refusals[number].note(problem, verdict)

    def refused(self):
        """Return the number of messages that were left out or had an impossible part."""
        return sum(refusals.count for refusals in self._refusals)

    def connections(self):
        """Return the number of connected publishers; 0 while it is closed."""
        return sum(subscriber.get_num_connections() for subscriber in self._subscribers)


def _at_s(newest):
    return newest.at_s
