# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The action server of the tasks: that of actionlib, made robust against a flood of cancels."""
import actionlib
import rospy

# Number of cancels of unknown goals to keep, in case the goals arrive later.
MAX_EARLY = 100


class RunServer(actionlib.ActionServer):
    """actionlib's server with a bounded number of cancels of unknown goals.

    The original compares each cancel with all earlier ones of unknown goals, logs two errors for
    each pair ("uninitialized ServerGoalHandle"), and publishes the ever growing list five times a
    second. A cancel with a stamp in the future makes it refuse all goals until then.
    """

    def internal_cancel_callback(self, goal_id):
        """Handle a cancel (``actionlib_msgs/GoalID``)."""
        with self.lock:
            early = [known for known in self.status_list if known.goal is None]
            if goal_id.id and any(known.status.goal_id.id == goal_id.id for known in early):
                return
            self.status_list = [known for known in self.status_list if known.goal is not None]
            try:
                super().internal_cancel_callback(goal_id)
            finally:
                # The newest one is at the end.
                self.status_list = early[-MAX_EARLY + 1:] + self.status_list
            self.last_cancel = min(self.last_cancel, rospy.Time.now())
