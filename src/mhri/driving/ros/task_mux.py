# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Passes the velocities of robots on a task from ``/mux_in/task`` to the gates."""
from geometry_msgs.msg import Twist
import rospy

from mhri.driving.task_relay import MOST_ROBOTS, NOTHING, PASS_ZEROS, TaskRelay
from mhri.graph.ros.prompt import PromptPublisher
from mhri.msg import TeamTwist


class TaskMux:
    """``/mux_in/task`` to ``/robot_controller/task_twist``, both ``mhri/TeamTwist``.

    Published at once for each message that may pass.

    :param lock: held while deciding and publishing, so that nothing follows a stop
    :param allowed: called with the lock held; returns (stopped, enabled, is new)
    """

    def __init__(self, lock, allowed):
        self._lock = lock
        self._allowed = allowed
        self._relay = TaskRelay()
        self._topic = PromptPublisher('/robot_controller/task_twist', TeamTwist)
        self._subscriber = None

    def start(self):
        """Begin to listen."""
        self._subscriber = rospy.Subscriber('/mux_in/task', TeamTwist, self._on_task,
                                            queue_size=1, tcp_nodelay=True)

    def counts(self):
        """Return {words: count} of messages refused and held back."""
        with self._lock:
            counts = {'refused: ' + kind: count for kind, count in self._relay.refused.items()}
            counts.update(('held back: ' + kind, count)
                          for kind, count in self._relay.held.items())
        return counts

    def _on_task(self, message):
        # One more than allowed is enough to see that there are too many.
        robots = message.robots[:MOST_ROBOTS + 1]
        twists = [(twist.linear.x, twist.linear.y, twist.linear.z,
                   twist.angular.x, twist.angular.y, twist.angular.z)
                  for twist in message.twists[:MOST_ROBOTS + 1]]
        with self._lock:
            verdict, problem = self._relay.judge(robots, twists, *self._allowed())
            if verdict != NOTHING:
                if verdict == PASS_ZEROS:
                    message.twists = [Twist() for _ in message.robots]
                self._topic.publish(message)
        if problem:
            rospy.logwarn_throttle(1.0, 'refused from /mux_in/task: {}'.format(problem))
