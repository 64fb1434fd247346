# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the referee of a drill hears of the operator, and how it asks robots to fail.

Subscribes ``/gates/state`` (``mhri/GatesState``: the robots that obey the operator),
``/mux/pushed`` and ``/robot_controller/stop_all`` (``std_msgs/Bool``). Calls
``/<robot>/base/set_fault`` (``mhri/SetFault``).
"""
import threading

import rospy
from std_msgs.msg import Bool

from mhri.drill.referee import Doing
from mhri.graph.ros.node_client import call
from mhri.graph.ros.worker import Worker
from mhri.msg import GatesState, RobotGate
from mhri.sim.faults import ALL
from mhri.srv import SetFault

# A robot that does not take a fault for so long is dead already [s].
CALL_S = 5.0


class OperatorWatch:
    """Knows what the operator does: newest value of each topic."""

    def __init__(self):
        self._lock = threading.Lock()
        self._doing = Doing()
        rospy.Subscriber('/gates/state', GatesState, self._on_gates, queue_size=1)
        for topic, field in (('/mux/pushed', 'pushed'), ('/robot_controller/stop_all', 'stopped')):
            rospy.Subscriber(topic, Bool, self._on_bool, field, queue_size=1)

    def _on_gates(self, state):
        names = tuple(robot.name for robot in state.robots if robot.obeys == RobotGate.OPERATOR)
        self._take(selected=names)

    def _on_bool(self, message, field):
        self._take(**{field: message.data})

    def _take(self, **fields):
        with self._lock:
            self._doing = self._doing._replace(**fields)

    def doing(self):
        """Return the :class:`mhri.drill.referee.Doing` of this moment."""
        with self._lock:
            return self._doing


class FaultCaller:
    """Asks robots to fail, on a thread of its own."""

    def __init__(self, robots):
        self._robots = robots
        self._worker = Worker('faults').start()

    def begin(self, robot, key, value, for_s):
        """Begin a fault, for so many seconds; return at once."""
        self._worker.do(self._call, robot, key, value, for_s)

    def end_all(self):
        """End every fault of every robot, and wait for their answers."""
        for robot in self._robots if not rospy.is_shutdown() else ():
            self._call(robot, ALL, 0.0, -1.0)

    @staticmethod
    def _call(robot, key, value, duration_s):
        answer = call('/{}/base/set_fault'.format(robot), SetFault, key, value, duration_s,
                      wait_s=CALL_S)
        if answer and not answer.success:
            rospy.logwarn('%s refuses the fault: %s', robot, answer.message)
