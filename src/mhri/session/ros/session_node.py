# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The session on the graph: services, what it does now, and its lines."""
import json

from diagnostic_msgs.msg import DiagnosticStatus
import rospy
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.msg import SessionEvent, SessionState
from mhri.recording.recording import size_text
from mhri.srv import AddNote, AddNoteResponse, MarkSession, MarkSessionResponse

# How often it is looked at, and how often it is told while it is recorded [s].
LOOK_S, TELL_S = 0.25, 1.0


class SessionNode:
    """What ``/mhri_session`` offers.

    Services ``record`` (``std_srvs/SetBool``), ``mark`` (``mhri/MarkSession``), ``note``
    (``mhri/AddNote``), ``still`` (``std_srvs/Trigger``). Topics ``state`` (``mhri/SessionState``,
    latched, on change and at 1 Hz while it records) and ``events`` (``mhri/SessionEvent``).

    :param make: :class:`mhri.session.ros.session.Session`, called with ``types``, ``options`` and
        a function of an event
    :param at_once: begin to record at once
    """

    def __init__(self, make, types, options, at_once=False):
        self._events = rospy.Publisher('~events', SessionEvent, queue_size=200)
        self._state = rospy.Publisher('~state', SessionState, queue_size=1, latch=True)
        self.session = make(types, options, self._tell)
        self._at_once = at_once
        self._told = None
        self._told_s = 0.0

    def run(self):
        """Serve until shut down; then close everything."""
        session = self.session
        session.start()
        rospy.Service('~record', SetBool, lambda asked: SetBoolResponse(
            *session.record(asked.data)))
        rospy.Service('~mark', MarkSession, lambda asked: MarkSessionResponse(
            *session.mark(asked.text)))
        rospy.Service('~note', AddNote, lambda asked: AddNoteResponse(
            *session.note(asked.id, asked.text)))
        rospy.Service('~still', Trigger, lambda _: TriggerResponse(*session.still()))
        publish_diagnostics({'session': self._diagnose})
        if self._at_once:
            session.record(True)
        wait = rospy.rostime.wallsleep
        while not rospy.is_shutdown():
            session.look()
            self._tell_state()
            wait(LOOK_S)
        session.close()

    def _tell(self, event):
        """Publish an event of the session."""
        if not rospy.is_shutdown():
            self._events.publish(SessionEvent(
                rospy.Time.from_sec(event.wall), event.kind, event.severity, event.robot,
                event.text, json.dumps(event.data) if event.data else ''))

    def _tell_state(self):
        """Publish what it does, where that has changed or a second is over."""
        status = self.session.status()
        told = (status.recording, status.folder, status.marks, status.problem,
                tuple(self.session.robots.kinds), self.session.pictures_hz)
        now_s = rospy.get_rostime().to_sec()
        if told == self._told and not (status.recording and abs(now_s - self._told_s) >= TELL_S):
            return
        self._told, self._told_s = told, now_s
        message = SessionState(
            recording=status.recording, folder=status.folder,
            since=rospy.Time.from_sec(status.since),
            lasts=rospy.Duration.from_sec(status.lasts_s), bytes=status.bytes,
            messages=status.messages, marks=status.marks, robots=list(self.session.robots.kinds),
            cameras=self.session.options.cameras, pictures_hz=self.session.pictures_hz,
            problem=status.problem)
        message.header.stamp = rospy.Time.from_sec(now_s)
        self._state.publish(message)

    def _diagnose(self, report):
        """Fill in a diagnostic status."""
        status = self.session.status()
        report.summary(DiagnosticStatus.WARN if status.problem else DiagnosticStatus.OK,
                       status.problem or ('recording' if status.recording else 'not recording'))
        report.add('Folder', status.folder)
        report.add('Written', size_text(status.bytes))
        report.add('Messages', status.messages)
        report.add('In the ring', size_text(self.session.tap.ring_bytes))
        return report
