# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen's side of the session: asks for recordings and marks, tells its events and pictures.

Publishes ``/panel/events`` (``mhri/SessionEvent``) and ``/panel/pictures`` (``mhri/SeenPicture``);
subscribes ``/mhri_session/state``; calls ``/mhri_session/record``, ``mark``, ``note``, ``still``.
"""
import queue
import time

import rospy
from std_srvs.srv import SetBool, Trigger

from mhri.base.text import tidy_text
from mhri.camera.ros.passed_on import PASSED_ON
from mhri.graph.ros.node_client import NodeClient
from mhri.msg import SeenPicture, SessionEvent, SessionState
from mhri.session.topics import PANEL_EVENTS, PICTURES
from mhri.session.view import SessionView, SILENT_S
from mhri.srv import AddNote, MarkSession

# A call waits so long for its service [s].
CALL_S = 2.0


class SessionClient:
    """What a screen knows of the session; every method returns at once.

    :param clock: function that returns seconds, monotonic
    ``answers`` is a queue of (what was asked: "record", "mark", "note", "still"; whether it is
    done; a sentence; the mark's name or '').
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._node = NodeClient('session_client', wait_s=CALL_S)
        self._state = None
        self._heard_at = 0.0
        self._gone = False
        self._events = self._pictures = self._subscriber = None
        self.answers = queue.Queue()

    def start(self):
        """Begin, on a worker; call it after ``rospy.init_node``."""
        self._node.do(self._connect)

    def _connect(self):
        """Open every topic (on the worker: it asks the master)."""
        self._events = self._node.advertise(PANEL_EVENTS, SessionEvent, queue_size=200)
        self._pictures = self._node.advertise(PICTURES, SeenPicture, queue_size=4)
        self._subscriber = self._node.subscribe('/mhri_session/state', SessionState, self._hear, 5)
        PASSED_ON.open(self._pictures)

    def _hear(self, message):
        self._heard_at = self._clock()
        self._state = message
        self._gone = False
        PASSED_ON.keep(message.pictures_hz)

    def view(self):
        """Return the :class:`SessionView` of this moment."""
        said, subscriber = self._state, self._subscriber
        if said is None or subscriber is None:
            return SessionView()
        if not subscriber.get_num_connections():
            # What the next one does is unknown until it has said so.
            self._gone = True
        there = not self._gone and not (
            said.recording and self._clock() - self._heard_at > SILENT_S)
        return SessionView(there, said.recording, tidy_text(said.folder), said.lasts.to_sec(),
                           said.bytes, said.marks, tidy_text(said.problem))

    def tell(self, events):
        """Pass on new events of the list, :class:`mhri.events.events.Event` values."""
        if self._events is None:
            return
        for event in events:
            self._events.publish(SessionEvent(
                rospy.Time.from_sec(event.time_s), event.kind, event.severity, event.robot,
                event.text, ''))

    def record(self, on):
        """Ask to record the session, or to end it."""
        self._ask('record', SetBool, on)

    def mark(self, text=''):
        """Ask to mark this moment."""
        self._ask('mark', MarkSession, text)

    def note(self, name, text):
        """Ask to write the text of a mark."""
        self._ask('note', AddNote, name, text)

    def still(self):
        """Ask for a still of every camera in sight."""
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
        """Pass nothing on any more; returns at once."""
        PASSED_ON.open(None)
        self._node.close(forget=True)
