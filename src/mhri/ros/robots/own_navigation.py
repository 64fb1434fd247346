# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The end of what a robot's own navigation drives, whoever sent the goal."""
import math

from actionlib_msgs.msg import GoalID

from mhri.ros.graph.prompt import PromptPublisher

# A goal that somebody sends meanwhile, or a navigation that starts only now, hears it so soon [s].
AGAIN_S = 0.5


class OwnNavigation:
    """Cancels the goals of ``/<robot>/move_base`` while the operator alone has the robot.

    Publishes ``/<robot>/move_base/cancel`` (``actionlib_msgs/GoalID``) with no id and no time,
    which ends every goal (http://wiki.ros.org/actionlib/DetailedDescription). A navigation speaks
    to its robot itself, past the gate, and mhri_tasks, which ends the goals it sent, may hang.

    :param name: the robot
    """

    def __init__(self, name):
        self._cancel = PromptPublisher('/{}/move_base/cancel'.format(name), GoalID)
        self._told_at = -math.inf

    def end_while(self, ends, now):
        """Let it end its goals as long as they must end: at once, and twice a second."""
        if not ends:
            self._told_at = -math.inf
        elif now - self._told_at >= AGAIN_S:
            self._told_at = now
            self._cancel.publish(GoalID(), urgent=True)

    def close(self):
        """Unregister (blocking: it asks the master)."""
        self._cancel.unregister()
