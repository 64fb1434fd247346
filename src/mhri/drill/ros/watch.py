# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The referee's subscription of the operator's state, and its client of faults.

Subscribes ``/mux/state`` (``mhri/DriveState``: the robots driven by the operator, whether the stick
is held, whether STOP ALL is in force). Calls ``/<robot>/base/set_fault`` (``mhri/SetFault``).
"""
import rospy

from mhri.drill.referee import Doing
from mhri.graph.ros.node_client import call
from mhri.graph.ros.worker import Worker
from mhri.msg import DriveState, RobotDrive
from mhri.sim.faults import ALL
from mhri.srv import SetFault

# A robot that does not answer for this long is already dead [s].
CALL_S = 5.0


class OperatorWatch:
    """Follows the actions of the operator."""

    def __init__(self):
        self._doing = Doing()
        rospy.Subscriber('/mux/state', DriveState, self._on_state, queue_size=1)

    def _on_state(self, state):
        self._doing = Doing(
            selected=tuple(robot.name for robot in state.robots
                           if robot.obeys == RobotDrive.OPERATOR),
            pushed=state.pushed, stopped=state.stop_all)

    def doing(self):
        """Return the current :class:`mhri.drill.referee.Doing`."""
        return self._doing


class FaultCaller:
    """Injects faults, on its own thread."""

    def __init__(self, robots):
        self._robots = robots
        self._worker = Worker('faults').start()

    def begin(self, robot, key, value, for_s):
        """Start a fault with a duration [s]; return at once."""
        self._worker.do(self._call, robot, key, value, for_s)

    def end_all(self):
        """End all faults of all robots, and wait for the answers."""
        for robot in self._robots if not rospy.is_shutdown() else ():
            self._call(robot, ALL, 0.0, -1.0)

    @staticmethod
    def _call(robot, key, value, duration_s):
        answer = call('/{}/base/set_fault'.format(robot), SetFault, key, value, duration_s,
                      wait_s=CALL_S)
        if answer and not answer.success:
            rospy.logwarn('%s refuses the fault: %s', robot, answer.message)
