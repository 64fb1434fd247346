# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS interface of the session: services, state and lines."""
import json

from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Pose2D
import rospy
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.msg import Mark, Places, SessionEvent, SessionState
from mhri.recording.recording import size_text
from mhri.srv import AddNote, AddNoteResponse, MarkSession, MarkSessionResponse

# Intervals of updating the session, and of publishing its state while recording [s].
LOOK_S, PUBLISH_S = 0.25, 1.0


class SessionNode:
    """The node ``/mhri_session``.

    Services ``record`` (``std_srvs/SetBool``), ``mark`` (``mhri/MarkSession``), ``note``
    (``mhri/AddNote``), ``still`` (``std_srvs/Trigger``). Topics ``state`` (``mhri/SessionState``,
    latched, on change and at 1 Hz while recording), ``events`` (``mhri/SessionEvent``) and
    ``marks`` (``mhri/Places``, latched, on change: the flags of the session's marks on the map).

    :param make: :class:`mhri.session.ros.session.Session`, called with ``types``, ``options`` and
        a callback for events
    :param at_once: start recording at once
    """

    def __init__(self, make, types, options, at_once=False):
        self._events = rospy.Publisher('~events', SessionEvent, queue_size=200)
        self._state = rospy.Publisher('~state', SessionState, queue_size=1, latch=True)
        self._marks = rospy.Publisher('~marks', Places, queue_size=1, latch=True)
        self.session = make(types, options, self._publish_event)
        self._at_once = at_once
        self._published = self._flags = None
        self._published_s = 0.0

    def run(self):
        """Serve until shutdown; then close the session."""
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
            session.update()
            self._publish_state()
            self._publish_marks()
            wait(LOOK_S)
        session.close()

    def _publish_event(self, event):
        """Publish an event of the session."""
        if not rospy.is_shutdown():
            self._events.publish(SessionEvent(
                rospy.Time.from_sec(event.wall), event.kind, event.severity, event.robot,
                event.text, json.dumps(event.data) if event.data else ''))

    def _publish_marks(self):
        """Publish the flags of the marks on change."""
        frame, flags = self.session.flags()
        if (frame, flags) != self._flags:
            self._flags = frame, flags
            message = Places(marks=[Mark(flag.label, Pose2D(flag.x_m, flag.y_m, 0.0))
                                    for flag in flags])
            message.header.frame_id = frame
            self._marks.publish(message)

    def _publish_state(self):
        """Publish the state on change, and once a second while recording."""
        status = self.session.status()
        news = (status.recording, status.folder, status.marks, status.problem,
                tuple(self.session.robots.kinds), self.session.pictures_hz)
        now_s = rospy.get_rostime().to_sec()
        if news == self._published and not (
                status.recording and abs(now_s - self._published_s) >= PUBLISH_S):
            return
        self._published, self._published_s = news, now_s
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
