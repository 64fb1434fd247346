# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cancels goals of a robot's own navigation: all of them on request, or those of a dead sender."""
import math

from actionlib_msgs.msg import GoalID
import rospy

from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import caller_of, on_publisher_gone, unsubscribe

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
    mux; and with the id of the last goal of an mhri_tasks that dies. To know that id, it subscribes
    ``/<robot>/move_base/goal`` (``move_base_msgs/MoveBaseActionGoal``). Goals of other senders
    outlive them: ``rostopic`` sends one and exits.

    :param name: the robot
    :param on_abandoned: called, on a thread of rospy, after cancelling the goal of a dead
        mhri_tasks; the goal may have ended before
    """

    def __init__(self, name, on_abandoned):
        self._on_abandoned = on_abandoned
        #: the publisher of the cancel
        self.cancel = NonBlockingPublisher(CANCEL.format(name), GoalID)
        self._asked_at = -math.inf
        # The last goal of each mhri_tasks, by caller id.
        self._sent = {}
        self._goals = None
        if MoveBaseActionGoal is not None:
            self._goals = rospy.Subscriber(GOAL.format(name), MoveBaseActionGoal, self._on_goal,
                                           queue_size=10, tcp_nodelay=True)
            on_publisher_gone(self._goals, self._on_sender_gone)

    def _on_goal(self, message):
        if message.goal_id.id.startswith(PREFIX):
            self._sent[caller_of(message)] = message.goal_id.id

    def _on_sender_gone(self, caller, _uri):
        goal = self._sent.pop(caller, None)
        if goal is not None:
            self.cancel.publish(GoalID(id=goal), urgent=True)
            self._on_abandoned()

    def end_while(self, ends, now):
        """Cancel all goals while ``ends`` is true: at once, then twice a second."""
        if not ends:
            self._asked_at = -math.inf
        elif now - self._asked_at >= AGAIN_S:
            self._asked_at = now
            self.cancel.publish(GoalID(), urgent=True)

    def end(self):
        """Unsubscribe (blocking: it asks the master); the goals of mhri_tasks are cancelled."""
        if self._goals is not None:
            unsubscribe(self._goals)
