# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The operator's wish on ``/robot_controller/robot_select``, and what it says of the past."""
from urllib.parse import urlsplit

import rospy

from mhri.driving.seat import Caller
from mhri.driving.settings import Settings, settings_problem
from mhri.graph.ros.rospy_inside import (
    caller_of, latches, link_of, on_publisher_gone, publisher_processes, sender_uri)
from mhri.msg import RobotSelect


class WishTopic:
    """Subscribes ``/robot_controller/robot_select`` (``mhri/RobotSelect``).

    The first message on a connection whose publisher latches does not count: it may have been
    published long ago, for other robots, at another speed.

    :param on_wish: called with (:class:`Caller`, message) on rospy's threads
    :param on_gone: called with the :class:`Caller` when its connection has ended
    """

    def __init__(self, on_wish, on_gone=lambda caller: None):
        self._on_wish = on_wish
        self._on_gone = on_gone
        self._subscriber = None
        self._known = {}

    def start(self):
        """Begin to listen."""
        self._subscriber = rospy.Subscriber('/robot_controller/robot_select', RobotSelect,
                                            self._hear, queue_size=1, tcp_nodelay=True)
        on_publisher_gone(self._subscriber, self._forget)

    def _hear(self, message):
        caller, link = self._sender(message), link_of(message)
        if not caller.uri:
            return  # connected this very moment: it will be repeated
        if self._known.get(caller) is not link:
            self._known[caller] = link
            if latches(message):
                return
        self._on_wish(caller, message)

    def _sender(self, message):
        return _caller(caller_of(message), sender_uri(self._subscriber, message)
                       if self._subscriber else '')

    def _forget(self, name, uri):
        caller = _caller(name, uri)
        self._known.pop(caller, None)
        self._on_gone(caller)

    def there(self):
        """Return the :class:`Caller` of each publisher that is connected, as a list."""
        return [_caller(name, uri) for name, uri in publisher_processes(self._subscriber)
                if name] if self._subscriber else []


def _caller(name, uri):
    try:
        return Caller(name, uri or '', urlsplit(uri or '').hostname or '')
    except ValueError:  # a node may say any address
        return Caller(name, uri)


def wished_settings(message):
    """Return (:class:`Settings` or None, why the message is refused or None) of a wish."""
    wished = [Settings(one.linear_mps, one.angular_rad_s, one.together, one.slow_with_link,
                       one.brake) for one in message.settings[:2]]
    return (wished or [None])[0], settings_problem(wished)
