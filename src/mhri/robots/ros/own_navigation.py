# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The end of what a robot's own navigation drives: whoever sent the goal, or if its sender dies."""
import math

from actionlib_msgs.msg import GoalID
import rospy

from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.rospy_inside import caller_of, on_publisher_gone, unsubscribe

try:
    from move_base_msgs.msg import MoveBaseActionGoal
except ImportError:  # without it mhri_tasks uses no robot's own navigation
    MoveBaseActionGoal = None

GOAL, CANCEL = '/{}/move_base/goal', '/{}/move_base/cancel'
# What the ids of the goals of mhri_tasks begin with.
PREFIX = 'mhri_tasks:'
# A goal that somebody sends meanwhile, or a navigation that starts only now, hears it so soon [s].
AGAIN_S = 0.5


class OwnNavigation:
    """Cancels the goals of ``/<robot>/move_base`` that nobody watches over.

    Publishes ``/<robot>/move_base/cancel`` (``actionlib_msgs/GoalID``): with no id and no time,
    which ends every goal (http://wiki.ros.org/actionlib/DetailedDescription), while the operator
    alone has the robot, since a navigation speaks to its robot itself, past the gate; and with the
    id of the last goal of an mhri_tasks that dies, of which it subscribes
    ``/<robot>/move_base/goal`` (``move_base_msgs/MoveBaseActionGoal``). Goals of others outlive
    whoever sent them: ``rostopic`` sends one and ends.

    :param name: the robot
    :param on_abandoned: called, on a thread of rospy, when the goal of a dead mhri_tasks was
        cancelled; it may have ended before
    """

    def __init__(self, name, on_abandoned):
        self._on_abandoned = on_abandoned
        self._cancel = PromptPublisher(CANCEL.format(name), GoalID)
        self._told_at = -math.inf
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
            self._cancel.publish(GoalID(id=goal), urgent=True)
            self._on_abandoned()

    def end_while(self, ends, now):
        """Let it end its goals as long as they must end: at once, and twice a second."""
        if not ends:
            self._told_at = -math.inf
        elif now - self._told_at >= AGAIN_S:
            self._told_at = now
            self._cancel.publish(GoalID(), urgent=True)

    def close(self):
        """Unregister (blocking: it asks the master); goals of mhri_tasks are cancelled."""
        if self._goals is not None:
            unsubscribe(self._goals)
        self._cancel.unregister()
