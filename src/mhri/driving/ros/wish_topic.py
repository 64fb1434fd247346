# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The operator's wish on ``/robot_controller/robot_select``, without old latched messages."""
from urllib.parse import urlsplit

import rospy

from mhri.driving.operator_lease import Caller
from mhri.driving.settings import Settings
from mhri.driving.topic_owner import LiveMessages
from mhri.graph.ros.rospy_inside import (
    caller_of, latches, link_of, on_publisher_gone, publisher_processes, sender_uri)
from mhri.msg import RobotSelect

WISH = '/robot_controller/robot_select'
# Of wishes that arrive at once, this many of the newest are handled in order: a robot left out and
# included again was deselected in between.
MAX_AT_ONCE = 10


class WishTopic:
    """Subscribes ``/robot_controller/robot_select`` (``mhri/RobotSelect``).

    The first message on a connection whose publisher latches does not count: it may have been
    published long ago, for other robots, at another speed.

    :param on_wish: called with (:class:`Caller`, message) on rospy's threads
    :param on_gone: called with a :class:`Caller` when its connection has ended
    """

    def __init__(self, on_wish, on_gone=lambda caller: None):
        self._on_wish = on_wish
        self._on_gone = on_gone
        self._subscriber = None
        self._live = LiveMessages()

    def start(self):
        """Subscribe the topic."""
        self._subscriber = rospy.Subscriber(WISH, RobotSelect, self._receive,
                                            queue_size=MAX_AT_ONCE, tcp_nodelay=True)
        on_publisher_gone(self._subscriber, self._forget)

    def _receive(self, message):
        caller, link = self._sender(message), link_of(message)
        if not caller.uri:
            return  # connected at this very moment: the wish will be repeated
        if self._live.is_live(caller, link, latches(message)):
            self._on_wish(caller, message)

    def _sender(self, message):
        return _caller(caller_of(message), sender_uri(self._subscriber, message)
                       if self._subscriber else '')

    def _forget(self, name, uri):
        caller = _caller(name, uri)
        self._live.forget(caller)
        self._on_gone(caller)

    def there(self):
        """Return the :class:`Caller` of each connected publisher, as a list."""
        return [_caller(name, uri) for name, uri in publisher_processes(self._subscriber)
                if name] if self._subscriber else []


def _caller(name, uri):
    try:
        return Caller(name, uri or '', urlsplit(uri or '').hostname or '')
    except ValueError:  # a node may register any URI
        return Caller(name, uri)


def wished_settings(message):
    """Return the :class:`Settings` in a wish as a list, at most two: one more than allowed."""
    return [Settings(one.linear_mps, one.angular_rad_s, one.together, one.slow_with_link, one.brake)
            for one in message.settings[:2]]
