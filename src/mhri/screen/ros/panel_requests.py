# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Receives requests from pad buttons, voice and a lab's own nodes."""
import rospy

from mhri.base.text import tidy_names, tidy_text
from mhri.msg import PanelRequest

# Only a misbehaving program queues more requests than this; the newest are then dropped.
_MOST = 50


class PanelRequests:
    """Passes messages of ``/panel_in/request`` (``mhri/PanelRequest``) to the GUI thread.

    :param events: a :class:`queue.Queue`; gets ``('request', (action, robots, key, choice))``
    """

    def __init__(self, events):
        self._events = events
        self._subscriber = rospy.Subscriber('/panel_in/request', PanelRequest, self._on_message,
                                            queue_size=10, tcp_nodelay=True)

    def _on_message(self, message):
        if self._events.qsize() >= _MOST:
            rospy.logwarn_throttle(1.0, 'too many requests to the panel: {} is dropped'.format(
                tidy_text(message.action)))
            return
        self._events.put(('request', (
            tidy_text(message.action), tidy_names(message.robots), tidy_text(message.key),
            tidy_text(message.choice))))

    def unregister(self):
        """Unsubscribe (blocking: it calls the master)."""
        self._subscriber.unregister()
