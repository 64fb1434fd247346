# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Receives requests from pad buttons, voices and labs' own nodes."""
import rospy

from mhri.base.text import tidy_names, tidy_text
from mhri.msg import PanelRequest

# More than this wait only if a program runs wild; the newest are then dropped.
_MOST = 50


class PanelRequests:
    """Hands the messages of ``/panel_in/request`` (``mhri/PanelRequest``) to the GUI thread.

    :param events: a :class:`queue.Queue`; gets ``('request', (action, robots))``
    """

    def __init__(self, events):
        self._events = events
        self._subscriber = rospy.Subscriber('/panel_in/request', PanelRequest, self._hear,
                                            queue_size=10, tcp_nodelay=True)

    def _hear(self, message):
        if self._events.qsize() >= _MOST:
            rospy.logwarn_throttle(1.0, 'too many requests to the panel: {} is dropped'.format(
                tidy_text(message.action)))
            return
        self._events.put(('request', (tidy_text(message.action), tidy_names(message.robots))))

    def unregister(self):
        """Stop listening (blocking: it asks the master)."""
        self._subscriber.unregister()
