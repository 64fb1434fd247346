# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's side of the gates: what they said last, and requests to them.

Subscribes ``/gates/state`` (``mhri/GatesState``, 2 Hz and on change; it believes only the gates in
force, :mod:`mhri.graph.ros.in_force`). Calls ``/gates/take_control`` (``std_srvs/Trigger``) and
``/gates/set_motor_power`` (``std_srvs/SetBool``) on a thread of its own.
"""
import threading
import time

import rospy
from std_srvs.srv import SetBool, Trigger

from mhri.driving.control import who_drives
from mhri.driving.settings import Settings
from mhri.graph.ros.in_force import InForce, Strangers, TAKE_SERVICE
from mhri.graph.ros.worker import Worker
from mhri.msg import GatesState

# They speak at 2 Hz: a message this late is not coming.
SILENT_S = 0.9
POWER_SERVICE = '/gates/set_motor_power'


class GatesClient:
    """What the gates say, and whether they answer; every method returns at once.

    :param on_state: called with (``mhri/GatesState``, received at [s]) on a ROS thread, in order
    :param clock: function that returns seconds, monotonic
    ``strangers`` are nodes that pose as the gates.
    """

    def __init__(self, on_state, clock=time.monotonic):
        self._on_state = on_state
        #: whether there are any: not in a recording by another program
        self.expected = True
        self._clock = clock
        self._lock = threading.Lock()
        self._state = None
        self._robots = {}
        self._heard_at = clock()
        self._first = threading.Event()
        self._topics = []
        self._worker = Worker('gates_calls')
        self.strangers = Strangers()
        self._force = InForce(TAKE_SERVICE, self.strangers.refuse)

    def start(self):
        """Begin to listen; call it after ``rospy.init_node``."""
        self._heard_at = self._clock()
        self._topics = [self._force.subscribe(
            '/gates/state', GatesState, self._hear, queue_size=10, tcp_nodelay=True)]
        self._force.start()
        self._worker.start()
        return self

    def _hear(self, message):
        now = self._clock()
        with self._lock:
            self._state = message
            self._robots = {robot.name: robot for robot in message.robots}
            self._heard_at = now
        self._on_state(message, now)
        self._first.set()

    def wait_first(self):
        """Wait for their first message, if they are running; not on the GUI thread."""
        self._first.wait(SILENT_S)

    def answers(self):
        """Tell whether they were heard lately (a start counts), or nobody expects to."""
        return not self.expected or self._clock() - self._heard_at <= SILENT_S

    def state(self):
        """Return the newest ``mhri/GatesState``, however old; None before the first."""
        return self._state

    def robot(self, name):
        """Return the newest ``mhri/RobotGate`` of a robot; None if the gates do not know it."""
        with self._lock:
            return self._robots.get(name)

    def who(self):
        """Return who is in control, in words; '' if the gates have named nobody."""
        state = self._state
        if state is None or not state.operator:
            return ''
        since = state.since.to_sec()
        return who_drives(state.operator, state.computer,
                          time.strftime('%H:%M', time.localtime(since)) if since else '')

    def settings(self):
        """Return the :class:`Settings` in force, as last heard; None before."""
        said = self._state and self._state.settings
        return Settings(said.linear_mps, said.angular_rad_s, said.together, said.slow_with_link,
                        said.brake) if said and said.linear_mps > 0.0 else None

    def refuses(self, name):
        """Tell whether they have lately refused the selection of a node."""
        return self._state is not None and any(
            line.startswith(name + ': robot_select') for line in self._state.refused)

    def take_control(self, on_answer):
        """Make this node the operator in control.

        :param on_answer: called with (success, a sentence), on the worker
        """
        self._worker.do(self._call, TAKE_SERVICE, Trigger, 'not taken over', on_answer)

    def set_motor_power(self, on, on_answer):
        """Cut the motor power of every robot that offers it (False), or restore it (True).

        :param on_answer: as for :meth:`take_control`
        """
        self._worker.do(self._call, POWER_SERVICE, SetBool, 'motor power unchanged', on_answer, on)

    def _call(self, name, kind, failure, on_answer, *words):
        """Call a service once, over its own connection, and report the result."""
        try:
            rospy.wait_for_service(name, timeout=SILENT_S)
            answer = rospy.ServiceProxy(name, kind)(*words)
        except (rospy.ServiceException, rospy.ROSException, OSError) as error:
            rospy.logwarn('%s: %s', name, error)
            on_answer(False, '{}: the drive service does not answer'.format(failure))
            return
        on_answer(answer.success, answer.message if answer.success else
                  '{}: {}'.format(failure, answer.message))

    def close(self):
        """Stop the worker; returns at once."""
        self._worker.stop()
        self._force.stop()

    def unregister(self):
        """Unregister every topic (blocking: it asks the master)."""
        for topic in self._topics:
            topic.unregister()
