# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of the voice: what it heard goes out, and what it needs to know comes in.

Interfaces beside those of :class:`mhri.devices.ros.input_node.InputNode`:

- publishes ``~heard`` (``mhri/Heard``, each utterance), ``/panel_in/request``
  (``mhri/PanelRequest``), ``/mux_in/mode_select`` (``mhri/ControlMode``)
- calls ``/mux/set_stop_all`` (``std_srvs/SetBool``, true) when a stop is heard
- subscribes ``~push_to_talk`` (``std_msgs/Bool``; true counts for ``push_to_talk_s`` of the
  language, 10 s, unless it is sent again), ``/mux/mode`` (``mhri/ControlMode``),
  ``/robot_controller/robot_select`` (``mhri/RobotSelect``)
- reads ``/mhri/robots`` (list of names) and ``/mhri/robot_numbers`` ({name: number}) once a second
while it listens; if the panel has not written them, the operator can call the selected robots
"""
import threading
import time

import rospy
from std_msgs.msg import Bool

from mhri.base.names import name_problem
from mhri.driving.ros.stop_line import LOOK_S, StopLine
from mhri.driving.seat import MOST_ROBOTS
from mhri.graph.ros.in_force import InForce, STOP_SERVICE
from mhri.graph.ros.live_parameter import LiveParameter
from mhri.graph.ros.worker import Worker
from mhri.msg import ControlMode, Heard, PanelRequest, RobotSelect
from mhri.voice.grammar import MODE, PANEL, STOP
from mhri.voice.names import in_places

ROBOTS_PARAMETER = '/mhri/robots'
NUMBERS_PARAMETER = '/mhri/robot_numbers'
VOICE_SOURCE = 'voice'
# A stop that the mux does not take is repeated for this long [s], then reported aloud.
_INSIST_S = 3.0
_RETRY_S = 0.2


def robot_names(value):
    """Return the names in a parameter, which anybody may have set to anything."""
    if not isinstance(value, (list, tuple)):
        return ()
    return tuple(name for name in value[:MOST_ROBOTS] if isinstance(name, str)
                 and name_problem(name) is None)


class VoiceLink:
    """Passes what was heard to the graph, and what the graph says to the reader.

    :class:`mhri.voice.io.voice.VoiceReader` calls ``on_heard`` and ``on_act``; they return at once.
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._reader = None
        self._lock = threading.Lock()
        self._listed = self._selected = ()
        self._numbers = {}
        self._heard = rospy.Publisher('~heard', Heard, queue_size=10)
        self._request = rospy.Publisher('/panel_in/request', PanelRequest, queue_size=10)
        self._mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        self._line = StopLine(rospy.get_name())
        # A stop that is heard must not need the master.
        self._stopper = Worker('stop_all', self._line.connect, LOOK_S).start()

    def start(self, reader, wanted):
        """Start listening to the graph.

        :param reader: :class:`mhri.voice.io.voice.VoiceReader`
        :param wanted: ``threading.Event``, set while the node listens
        """
        self._reader = reader
        rospy.Subscriber('~push_to_talk', Bool, self._on_push, queue_size=10, tcp_nodelay=True)
        # An older mux may keep its end of the line.
        force = InForce(STOP_SERVICE, on_new=lambda caller: self._stopper.do(self._line.close))
        force.start().subscribe('/mux/mode', ControlMode, self._on_mode, queue_size=10)
        rospy.Subscriber('/robot_controller/robot_select', RobotSelect, self._on_selection,
                         queue_size=1)
        LiveParameter(NUMBERS_PARAMETER, {}, self._on_numbers, wanted).start()
        LiveParameter(ROBOTS_PARAMETER, [], self._on_robots, wanted).start()

    def _on_push(self, message):
        self._reader.push_to_talk(message.data)

    def _on_mode(self, message):
        self._reader.set_drives(message.source == VOICE_SOURCE)

    def _on_robots(self, value):
        with self._lock:
            self._listed = robot_names(value)
            self._tell_robots()

    def _on_numbers(self, value):
        with self._lock:
            self._numbers = value
            self._tell_robots()

    def _tell_robots(self):
        """Tell the reader which robots can be called; call it with the lock held."""
        self._reader.set_robots(in_places(self._listed, self._numbers) if self._listed
                                else self._selected)

    def _on_selection(self, message):
        with self._lock:
            # A robot once seen keeps its number.
            self._selected = tuple(dict.fromkeys(
                self._selected + robot_names(message.robots)))[:MOST_ROBOTS]
            self._tell_robots()

    def on_heard(self, heard):
        """Publish what was heard."""
        message = Heard(text=heard.text, command=heard.command, accepted=heard.accepted,
                        reason=heard.reason, confidence=heard.confidence)
        message.stamp = rospy.Time.now()
        self._heard.publish(message)

    def on_act(self, command):
        """Carry out a command that is not a motion."""
        if command.kind == STOP:
            self._stopper.do(self._stop_all)
        elif command.kind == MODE:
            self._mode.publish(source=command.action)
        elif command.kind == PANEL:
            self._request.publish(action=command.action, robots=command.robots)

    def _stop_all(self):
        """Engage stop-all, on the worker; insist for a while."""
        deadline = self._clock() + _INSIST_S
        wait_s = 0.0
        while not rospy.is_shutdown():
            time.sleep(wait_s)
            done, words = self._line.call(True)
            if done:
                return
            if self._clock() > deadline:
                rospy.logerr('a stop was heard, but not taken: %s', words)
                return
            wait_s = _RETRY_S
