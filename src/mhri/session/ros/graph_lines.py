# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lines of a session from what the graph and the screens say."""
import functools
import time

import genpy
import rospy
from std_msgs.msg import Bool, String

from mhri.graph.ros.worker import Worker
from mhri.msg import ControlMode, GatesState, RobotSelect, SessionEvent
from mhri.session.lines import GraphWatch, line_of_screen
from mhri.session.ros.moment import read
from mhri.session.topics import fault_topic, PANEL_EVENTS

MODE, STOP = '/mux/mode', '/robot_controller/stop_all'
SELECT, GATES = '/robot_controller/robot_select', '/gates/state'


class GraphLines:
    """Reads the topics that lines come from, on a thread of its own.

    :param tell: called with (kind, severity, robot, text, time of day [s], ROS time [s])
    ``watched`` is what the tap is to call for each topic; ``watch`` the :class:`GraphWatch`.
    """

    def __init__(self, tell):
        self._tell = tell
        self.watch = GraphWatch()
        self._worker = Worker('session_lines')
        self.watched = {topic: self._hear for topic in (MODE, STOP, SELECT, GATES, PANEL_EVENTS)}
        self._readers = {
            MODE: (ControlMode, lambda said: self.watch.mode(said.source)),
            STOP: (Bool, lambda said: self.watch.stop(said.data)),
            SELECT: (RobotSelect, self._select),
            GATES: (GatesState, lambda said: self.watch.control(said.operator, said.computer))}
        self._caller = ''

    def follow(self, robots):
        """Read what fails of these simulated robots, too."""
        for robot in robots:
            topic = fault_topic(robot)
            self._readers[topic] = String, functools.partial(self._fail, robot)
            self.watched[topic] = self._hear

    def _fail(self, robot, message):
        return self.watch.faults(robot, message.data)

    def start(self):
        """Begin."""
        self._worker.start()

    def _hear(self, fields, time_ns, frame):
        """Take a message (on the reading thread)."""
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
            rospy.logwarn_throttle(10.0, '{} is no message: {}'.format(topic, error))
            return
        for line in lines:
            self._tell(*line, wall_s, ros_s)

    def _select(self, message):
        """Take the word of the one in control alone: another one's is refused by the gates, too."""
        if self.watch.operator not in ('', self._caller):
            return []
        return self.watch.selection(message.robots)

    def _of_screen(self, said):
        if self.watch.operator not in ('', self._caller):
            return []
        line = line_of_screen(said.kind, said.severity, said.robot, said.text)
        return [line] if line else []

    def silence(self, ages_s, now_s, ros_s):
        """Tell of robots that are lost or back, where no screen does.

        Arguments as for :meth:`mhri.session.lines.GraphWatch.silence`.
        """
        self._worker.do(self._silence, dict(ages_s), now_s, ros_s, time.time())

    def _silence(self, ages_s, now_s, ros_s, wall_s):
        for line in self.watch.silence(ages_s, now_s):
            self._tell(*line, wall_s, ros_s)
