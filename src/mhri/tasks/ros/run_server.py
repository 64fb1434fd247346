# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The action server of the tasks: actionlib's, made fit for a storm of cancels."""
import actionlib
import rospy

# So many cancels of goals that nobody knows are kept, in case the goals are still to come.
MOST_EARLY = 100


class RunServer(actionlib.ActionServer):
    """actionlib's server, which shows each cancel of an unknown goal to every cancel that follows.

    That makes two lines of errors in the log for each pair of them ("uninitialized
    ServerGoalHandle"), and a list without end, which it publishes five times a second. And a cancel
    with a stamp in the future made it refuse everybody's goals until then.
    """

    def internal_cancel_callback(self, goal_id):
        """Hear a cancel (``actionlib_msgs/GoalID``)."""
        with self.lock:
            early = [known for known in self.status_list if known.goal is None]
            if goal_id.id and any(known.status.goal_id.id == goal_id.id for known in early):
                return
            self.status_list = [known for known in self.status_list if known.goal is not None]
            try:
                super().internal_cancel_callback(goal_id)
            finally:
                # What has come now stands at the end.
                self.status_list = early[-MOST_EARLY + 1:] + self.status_list
            self.last_cancel = min(self.last_cancel, rospy.Time.now())
