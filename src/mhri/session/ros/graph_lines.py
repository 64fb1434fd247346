# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lines of a session, from topics of the drive service and of screens."""
import functools
import time

import genpy
import rospy
from std_msgs.msg import String

from mhri.graph.ros.worker import Worker
from mhri.msg import DriveState, SessionEvent
from mhri.session.lines import GraphWatch, line_of_screen
from mhri.session.ros.moment import read
from mhri.session.topics import DRIVE, fault_topic, PANEL_EVENTS


class GraphLines:
    """Makes lines from messages of the tap, on its own thread.

    :param on_line: called with (kind, severity, robot, text, data, time of day [s], ROS time [s])
    ``watched`` is {topic: callback} for the tap; ``watch`` is the :class:`GraphWatch`.
    """

    def __init__(self, on_line):
        self._on_line = on_line
        self.watch = GraphWatch()
        self._worker = Worker('session_lines')
        self.watched = {topic: self._on_message for topic in (DRIVE, PANEL_EVENTS)}
        self._readers = {DRIVE: (DriveState, self._drive)}
        self._caller = ''

    def follow(self, robots):
        """Also read the faults of these simulated robots."""
        for robot in robots:
            topic = fault_topic(robot)
            self._readers[topic] = String, functools.partial(self._fail, robot)
            self.watched[topic] = self._on_message

    def _fail(self, robot, message):
        return self.watch.faults(robot, message.data)

    def start(self):
        """Start the thread."""
        self._worker.start()

    def _on_message(self, fields, time_ns, frame):
        """Queue a message (on the reading thread)."""
        self._worker.do(self._read, fields, time_ns * 1e-9, time.time(), frame)

    def _read(self, fields, ros_s, wall_s, frame):
        topic, self._caller = fields['topic'], fields.get('callerid', '')
        try:
            if topic == PANEL_EVENTS:
                lines = self._of_screen(read(SessionEvent, frame))
            else:
                kind, take = self._readers[topic]
                lines = take(read(kind, frame))
        except genpy.DeserializationError as error:
            rospy.logwarn_throttle(10.0, '{}: cannot read the message: {}'.format(topic, error))
            return
        for line in lines:
            self._on_line(*line, wall_s, ros_s)

    def _drive(self, said):
        watch = self.watch
        return watch.control(said.operator, said.computer) + watch.mode(said.mode) \
            + watch.stop(said.stop_all) + watch.selection(
                robot.name for robot in said.robots if robot.selected)

    def _of_screen(self, said):
        if self.watch.operator not in ('', self._caller):
            return []
        line = line_of_screen(said.kind, said.severity, said.robot, said.text, said.data)
        return [line] if line else []

    def silence(self, ages_s, now_s, ros_s):
        """Report lost and returned robots; call it only if no screen does.

        Arguments as for :meth:`mhri.session.lines.GraphWatch.silence`.
        """
        self._worker.do(self._silence, dict(ages_s), now_s, ros_s, time.time())

    def _silence(self, ages_s, now_s, ros_s, wall_s):
        for line in self.watch.silence(ages_s, now_s):
            self._on_line(*line, wall_s, ros_s)
