# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen's client of the session: requests recordings and marks, sends events.

Publishes ``/panel/events`` (``mhri/SessionEvent``), and tells the relay of pictures how many the
recorder keeps; subscribes ``/mhri_session/state`` and ``/mhri_session/marks`` (``mhri/Places``);
calls ``/mhri_session/record``, ``mark``, ``note``, ``still``.
"""
import json
import math
import queue
import time

import rospy
from std_srvs.srv import SetBool, Trigger

from mhri.base.text import tidy_text
from mhri.base.views import FlagView
from mhri.camera.ros.picture_relay import PICTURE_RELAY
from mhri.graph.ros.node_client import NodeClient
from mhri.msg import Places, SessionEvent, SessionState
from mhri.session.flags import MAX_FLAGS
from mhri.session.topics import PANEL_EVENTS
from mhri.session.view import SessionView, SILENT_S
from mhri.srv import AddNote, MarkSession

# Timeout of a service call [s].
CALL_S = 2.0


class SessionClient:
    """The client of the session recorder; every method returns at once.

    ``answers`` is a queue of (request: "record", "mark", "note" or "still"; success; a sentence;
    the mark's name or '').
    """

    def __init__(self):
        self._node = NodeClient('session_client', wait_s=CALL_S)
        self._state = None
        self._heard_at = 0.0
        self._gone = False
        self._flags = ()
        self._events = self._subscriber = None
        self.answers = queue.Queue()

    def start(self):
        """Connect, on a worker; call it after ``rospy.init_node``."""
        self._node.do(self._connect)

    def _connect(self):
        """Open every topic (on the worker, because it calls the master)."""
        self._events = self._node.advertise(PANEL_EVENTS, SessionEvent, queue_size=200)
        self._subscriber = self._node.subscribe('/mhri_session/state', SessionState,
                                                self._on_message, 5)
        self._node.subscribe('/mhri_session/marks', Places, self._on_marks)

    def _on_message(self, message):
        self._heard_at = time.monotonic()
        self._state = message
        self._gone = False
        PICTURE_RELAY.limit(self, message.pictures_hz)

    def _on_marks(self, message):
        frame = tidy_text(message.header.frame_id)
        self._flags = tuple(
            FlagView(tidy_text(mark.name), mark.pose.x, mark.pose.y, frame)
            for mark in message.marks[-MAX_FLAGS:]
            if math.isfinite(mark.pose.x) and math.isfinite(mark.pose.y))

    def flags(self):
        """Return the flags of the session's marks, :class:`mhri.base.views.FlagView` values."""
        return self._flags

    def view(self):
        """Return the current :class:`SessionView`."""
        said, subscriber = self._state, self._subscriber
        if said is None or subscriber is None:
            return SessionView()
        if not subscriber.get_num_connections():
            # The state of a new recorder is unknown until its first message.
            self._gone = True
            PICTURE_RELAY.limit(self, 0.0)
        there = not self._gone and not (
            said.recording and time.monotonic() - self._heard_at > SILENT_S)
        return SessionView(there, said.recording, tidy_text(said.folder), said.lasts.to_sec(),
                           said.bytes, said.marks, tidy_text(said.problem))

    def publish_events(self, events):
        """Publish new :class:`mhri.events.events.Event` values of the event list."""
        if self._events is None:
            return
        for event in events:
            self._events.publish(SessionEvent(
                rospy.Time.from_sec(event.time_s), event.kind, event.severity, event.robot,
                event.text, json.dumps(event.data) if event.data else ''))

    def record(self, on):
        """Request to start or stop the recording."""
        self._ask('record', SetBool, on)

    def mark(self, text=''):
        """Request a mark."""
        self._ask('mark', MarkSession, text)

    def note(self, name, text):
        """Request to save the text of a mark."""
        self._ask('note', AddNote, name, text)

    def still(self):
        """Request a still of every active camera."""
        self._ask('still', Trigger)

    def _ask(self, name, kind, *words):
        """Call a service of the recorder."""
        self._node.request(lambda answer: self._answer(name, answer), '/mhri_session/' + name, kind,
                           *words)

    def _answer(self, name, answer):
        self.answers.put(
            (name, False, 'the recorder of the session does not answer', '') if answer is None else
            (name, answer.success, tidy_text(answer.message), getattr(answer, 'id', '')))

    def close(self):
        """Unregister everything; returns at once."""
        PICTURE_RELAY.limit(self, 0.0)
        self._node.close(forget=True)
