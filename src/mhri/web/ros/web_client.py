# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen's client of mhri_web: says what the screen shows, gives links and takes them back.

Publishes ``/panel/state`` (``mhri/PanelState``), and tells the relay of pictures how many are
watched; subscribes ``/mhri_web/state``, and accepts only the node that serves ``/mhri_web/give``;
calls that and ``/mhri_web/take``.
"""
import queue
import time

import qrcode
import rospy

from mhri.base.text import tidy_text
from mhri.camera.ros.picture_relay import PICTURE_RELAY
from mhri.graph.ros.node_client import NodeClient
from mhri.msg import PanelState, WebState
from mhri.srv import GiveLink, TakeLink
from mhri.web.pacing import LOOKED_AT_HZ
from mhri.web.view import LinkView, ViewerView, WebView

# mhri_web says its state once a second: it is gone after this long without [s].
SILENT_S = 3.5
CALL_S = 2.0
_GIVE, _TAKE = '/mhri_web/give', '/mhri_web/take'


def code_of(url):
    """Return the QR code of a URL: rows of booleans, True for dark, with its quiet margin."""
    code = qrcode.QRCode(error_correction=qrcode.constants.ERROR_CORRECT_M)
    code.add_data(url)
    return code.get_matrix()


class WebClient:
    """The client of mhri_web; every method returns at once.

    ``answers`` is a queue of (request: "give" or "take"; success; a sentence; the link's id and
    its URL, '' for none).

    :param clock: function that returns time [s, monotonic]
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._node = NodeClient('web_client', _GIVE, CALL_S)
        self._view, self._heard_at = WebView(), None
        self._panel = None
        self.answers = queue.Queue()

    def start(self):
        """Connect, on a worker; call it after ``rospy.init_node``."""
        self._node.do(self._connect)

    def _connect(self):
        """Open every topic (on the worker, because it calls the master)."""
        self._panel = self._node.advertise('/panel/state', PanelState, queue_size=1)
        self._node.subscribe('/mhri_web/state', WebState, self._on_state)
        self._node.start()

    def _on_state(self, message):
        self._heard_at = self._clock()
        self._view = WebView(
            True, tidy_text(message.address), tidy_text(message.problem),
            tuple(LinkView(link.id, tidy_text(link.label), link.role, link.may_stop, link.head,
                           link.expires.to_sec()) for link in message.links),
            tuple(ViewerView(one.id, tidy_text(one.label), tidy_text(one.address),
                             one.since.to_sec(), one.holds, one.thinned)
                  for one in message.viewers))
        PICTURE_RELAY.limit(self, message.pictures_hz,
                            dict.fromkeys(message.looked_at, LOOKED_AT_HZ))

    def view(self):
        """Return the current :class:`mhri.web.view.WebView`."""
        if self._heard_at is not None and self._clock() - self._heard_at > SILENT_S:
            self._view, self._heard_at = WebView(), None
            PICTURE_RELAY.limit(self, 0.0)
        return self._view

    @property
    def wanted(self):
        """Whether anybody subscribes what the screen shows."""
        return self._panel is not None and self._panel.get_num_connections() > 0

    def publish(self, state):
        """Publish a ``mhri/PanelState``, with the time of now."""
        state.header.stamp = rospy.Time.now()
        self._panel.publish(state)

    def give(self, label, role, may_stop, head, hours):
        """Request a link, as in ``mhri/GiveLink``."""
        self._ask('give', _GIVE, GiveLink, label, role, may_stop, head, hours)

    def take(self, of):
        """Take a link back, or send a viewer away: its id."""
        self._ask('take', _TAKE, TakeLink, of)

    def _ask(self, name, service, kind, *words):
        self._node.request(lambda answer: self.answers.put(
            (name, False, 'the page does not answer', '', '') if answer is None else
            (name, answer.success, tidy_text(answer.message), getattr(answer, 'id', ''),
             getattr(answer, 'url', ''))), service, kind, *words)

    def close(self, forget=False):
        """Unregister everything; returns at once."""
        PICTURE_RELAY.limit(self, 0.0)
        self._node.close(forget)
