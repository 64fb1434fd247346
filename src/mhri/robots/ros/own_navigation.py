# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cancels goals of a robot's own navigation: all of them on request, or those of a dead sender."""
import math

from actionlib_msgs.msg import GoalID
import rospy

from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import caller_of, on_publisher_gone, unsubscribe
from mhri.robots.goal_watch import GoalWatch

try:
    from move_base_msgs.msg import MoveBaseActionGoal
except ImportError:  # without it mhri_tasks uses no robot's own navigation
    MoveBaseActionGoal = None

GOAL, CANCEL = '/{}/move_base/goal', '/{}/move_base/cancel'
# Prefix of the goal ids of mhri_tasks.
PREFIX = 'mhri_tasks:'
# Period of repeating the cancel, for new goals and a navigation that starts later [s].
AGAIN_S = 0.5


class OwnNavigation:
    """Cancels the goals of ``/<robot>/move_base`` without supervision.

    Publishes ``/<robot>/move_base/cancel`` (``actionlib_msgs/GoalID``): with no id and no time,
    which ends every goal (http://wiki.ros.org/actionlib/DetailedDescription), while the operator
    has sole control of the robot, since a navigation commands its robot directly, bypassing the
    mux; and with the id of the last goal of an mhri_tasks that dies or falls silent
    (:class:`mhri.robots.goal_watch.GoalWatch`). To know that id, it subscribes
    ``/<robot>/move_base/goal`` (``move_base_msgs/MoveBaseActionGoal``). Goals of other senders
    outlive them: ``rostopic`` sends one and exits.

    :param name: the robot
    :param on_abandoned: called, on a thread of rospy or in :meth:`tick`, after cancelling the goal
        of a dead or silent mhri_tasks; the goal may have ended before
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, name, on_abandoned, clock):
        self._on_abandoned, self._clock = on_abandoned, clock
        #: the publisher of the cancel
        self.cancel = NonBlockingPublisher(CANCEL.format(name), GoalID)
        self._asked_at = -math.inf
        self._watch = GoalWatch()
        self._goals = None
        if MoveBaseActionGoal is not None:
            self._goals = rospy.Subscriber(GOAL.format(name), MoveBaseActionGoal, self._on_goal,
                                           queue_size=10, tcp_nodelay=True)
            on_publisher_gone(self._goals, self._on_sender_gone)

    def _on_goal(self, message):
        if message.goal_id.id.startswith(PREFIX):
            self._watch.on_goal(caller_of(message), message.goal_id.id, self._clock())

    def _on_sender_gone(self, caller, _uri):
        goal = self._watch.on_gone(caller)
        if goal is not None:
            self._abandon(goal)

    def _abandon(self, goal):
        self.cancel.publish(GoalID(id=goal), urgent=True)
        self._on_abandoned()

    def on_task(self, caller, named, now):
        """Handle the commands for robots on a task.

        :param named: whether they name this robot
        """
        self._watch.on_command(caller, named, now)

    def tick(self, ends, now):
        """Cancel unsupervised goals; while ``ends`` is true all: at once, then twice a second."""
        for goal in self._watch.overdue(now):
            self._abandon(goal)
        if not ends:
            self._asked_at = -math.inf
        elif now - self._asked_at >= AGAIN_S:
            self._asked_at = now
            self.cancel.publish(GoalID(), urgent=True)

    def end(self):
        """Unsubscribe (blocking: it asks the master); the goals of mhri_tasks are cancelled."""
        if self._goals is not None:
            unsubscribe(self._goals)
