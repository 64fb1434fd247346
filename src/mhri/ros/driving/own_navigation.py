# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The end of what a robot's own navigation drives, whoever sent the goal."""
from actionlib_msgs.msg import GoalID

from mhri.ros.graph.rospy_inside import PromptPublisher


class OwnNavigation:
    """Cancels the goals of ``/<robot>/move_base`` when the operator alone has the robot.

    Publishes ``/<robot>/move_base/cancel`` (``actionlib_msgs/GoalID``) with no id and no time,
    which ends every goal (http://wiki.ros.org/actionlib/DetailedDescription). A navigation speaks
    to its robot itself, past the gate, and mhri_tasks, which ends the goals it sent, may hang.

    :param name: the robot
    """

    def __init__(self, name):
        self._cancel = PromptPublisher('/{}/move_base/cancel'.format(name), GoalID)
        self._told = ()

    def end_while(self, ends):
        """Let it end its goals, once, if they must end; and again if it connects only now."""
        links = self._cancel.links() if ends else ()
        if links is not self._told:
            if any(all(link is not known for known in self._told) for link in links):
                self._cancel.publish_urgent(GoalID())
            self._told = links

    def close(self):
        """Unregister (blocking: it asks the master)."""
        self._cancel.unregister()
