# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sends goals to robots with their own navigation, ``/<robot>/move_base``, and monitors them.

Interfaces for each robot with a publisher of ``/<robot>/move_base/status``:

- publishes ``/<robot>/move_base/goal`` (``move_base_msgs/MoveBaseActionGoal``) and
  ``/<robot>/move_base/cancel`` (``actionlib_msgs/GoalID``)
- subscribes ``/<robot>/move_base/status`` (``actionlib_msgs/GoalStatusArray``, 5 Hz)

These are the topics of actionlib's protocol (http://wiki.ros.org/actionlib/DetailedDescription). A
goal is sent only while the mux is connected, which cancels it if this process dies
(:mod:`mhri.robots.ros.own_navigation`); if the mux restarts meanwhile the goal ends, like other
tasks. An unknown goal with an id of this program is cancelled: its cancel was lost, or mux and
mhri_tasks died together.
"""
import math
import threading
import uuid

from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
import rospy

from mhri.graph.ros.announcer import Announcer
from mhri.graph.ros.master_api import MasterApi
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import listeners, unsubscribe
from mhri.robots.ros.convert import turn_of
from mhri.robots.ros.own_navigation import CANCEL, GOAL, MoveBaseActionGoal, PREFIX
from mhri.tasks.base import BLOCKED, DONE, FAILED, LOST, RUNNING, TAKEN_OVER
from mhri.tasks.delegated import Errand

STATUS = '/{}/move_base/status'
# Maximum age of its status [s].
SILENT_S = 2.0
# A goal that is not listed within this time is lost [s].
LISTED_S = 3.0
_ALIVE = (GoalStatus.PENDING, GoalStatus.ACTIVE)
_STATES = {
    GoalStatus.PENDING: (RUNNING, 'its own navigation has the goal'),
    GoalStatus.ACTIVE: (RUNNING, 'its own navigation drives it'),
    GoalStatus.PREEMPTING: (RUNNING, 'its own navigation ends the goal'),
    GoalStatus.RECALLING: (RUNNING, 'its own navigation ends the goal'),
    GoalStatus.SUCCEEDED: (DONE, 'arrived by its own navigation'),
    GoalStatus.ABORTED: (BLOCKED, 'its own navigation found no way'),
    GoalStatus.REJECTED: (FAILED, 'its own navigation refused the goal'),
    # By another goal, or by a cancel: the mux cancels when the operator stops or selects it.
    GoalStatus.PREEMPTED: (TAKEN_OVER, 'its own navigation got another goal, or a cancel'),
    GoalStatus.RECALLED: (TAKEN_OVER, 'its own navigation got another goal, or a cancel')}


class MoveBase(Errand):
    """One robot's navigation.

    :param odometry_frame: function that returns the name of the frame of its odometry
    :param mux: function that returns the caller id of the active mux, '' while unknown
    :param clock: seconds, monotonic
    """

    def __init__(self, name, odometry_frame, mux, clock):
        self._odometry_frame = odometry_frame
        self._mux = mux
        self._clock = clock
        self._lock = threading.Lock()
        self._wanted = self._watched = None
        self._sent_at = self._heard_at = -math.inf
        self._status = {}
        self._goal = NonBlockingPublisher(GOAL.format(name), MoveBaseActionGoal)
        self._cancel = NonBlockingPublisher(CANCEL.format(name), GoalID, queue_size=10)
        self._subscriber = rospy.Subscriber(STATUS.format(name), GoalStatusArray, self._on_status,
                                            queue_size=1, tcp_nodelay=True)

    def close(self):
        """Cancel the goal, and unregister all topics (blocking: calls the master)."""
        self.cancel()
        unsubscribe(self._subscriber)
        for publisher in (self._goal, self._cancel):
            publisher.unregister()

    def _on_status(self, message):
        with self._lock:
            self._heard_at = self._clock()
            self._status = {row.goal_id.id: (row.status, row.text) for row in message.status_list}
            orphans = [goal for goal, (status, _) in self._status.items()
                       if status in _ALIVE and goal.startswith(PREFIX) and goal != self._wanted]
        for goal in orphans:
            self._cancel.publish(GoalID(id=goal))

    def is_ready(self):
        """Return whether it is connected in both directions, and the mux is connected."""
        return self.is_heard() and self._watch() is not None and not self.unheard()

    def is_heard(self):
        """Return whether its status arrives."""
        return self._clock() - self._heard_at < SILENT_S

    def unheard(self):
        """Return (topic, type) of each topic that it should subscribe to but does not."""
        mux = {self._mux()}
        return [(publisher.resolved_name, publisher.type)
                for publisher in (self._goal, self._cancel)
                if not listeners(publisher.links()) - mux]

    def _watch(self):
        """Return the newest connection to the active mux, or None."""
        mux = self._mux()
        return next((link for link in reversed(self._goal.links()) if link.endpoint_id == mux),
                    None)

    def begin(self, by_odometry, in_frame):
        """Send it to a pose, in the frame of its odometry, which every robot has."""
        message = MoveBaseActionGoal()
        # goal_id.stamp stays 0, so that the server sets it: its clock may differ or be simulated,
        # and it refuses goals that are older than the last one.
        message.header.stamp = rospy.Time.now()
        message.goal_id.id = PREFIX + uuid.uuid4().hex
        target = message.goal.target_pose
        target.header.stamp, target.header.frame_id = rospy.Time(0), self._odometry_frame()
        target.pose.position.x, target.pose.position.y = by_odometry.x_m, by_odometry.y_m
        turn = target.pose.orientation
        turn.z, turn.w = turn_of(by_odometry.heading_rad)
        with self._lock:
            self._wanted, self._sent_at = message.goal_id.id, self._clock()
            self._watched = self._watch()
        self._goal.publish(message)

    def look(self):
        """Return (task state, sentence) of the goal."""
        with self._lock:
            now = self._clock()
            status, text = self._status.get(self._wanted, (None, ''))
            silent = now - max(self._heard_at, self._sent_at) > SILENT_S
            unlisted = status is None and now - self._sent_at > LISTED_S
        if silent or unlisted or status == GoalStatus.LOST:
            return LOST, 'its own navigation (move_base) does not answer'
        if self._watch() is not self._watched:
            return LOST, 'the drive service was restarted'
        state, words = _STATES.get(status, _STATES[GoalStatus.PENDING])
        return state, '{} ({})'.format(words, text[:100]) if text and state != RUNNING else words

    def cancel(self):
        """Cancel the goal."""
        with self._lock:
            wanted, self._wanted = self._wanted, None
        if wanted is not None:
            self._cancel.publish(GoalID(id=wanted))


class MoveBases:
    """The :class:`MoveBase` of each robot that has one.

    :param odometry_frame: function from a robot's name to the frame of its odometry
    :param mux: see :class:`MoveBase`
    """

    def __init__(self, odometry_frame, mux, clock):
        self._odometry_frame = odometry_frame
        self._mux = mux
        self._clock = clock
        self._robots = {}
        self._announcer = Announcer(lambda: [
            topic for robot in self._robots.values() if robot.is_heard()
            for topic in robot.unheard()], clock)

    def update(self, names):
        """Update which of these robots have one, and drop the others (blocking).

        One that is there but does not listen is called again.

        :raises MasterError: the master is unavailable
        """
        if MoveBaseActionGoal is None:
            return
        published = {topic for topic, _ in
                     MasterApi(rospy.get_name(), timeout_s=2.0).call('getSystemState')[0]}
        there = {name for name in names if STATUS.format(name) in published}
        for name in set(self._robots) - there:
            self._robots.pop(name).close()
        for name in there - set(self._robots):
            self._robots[name] = MoveBase(
                name, lambda robot=name: self._odometry_frame(robot), self._mux, self._clock)
        self._announcer.announce()

    def get(self, name):
        """Return a robot's :class:`MoveBase`, or None."""
        return self._robots.get(name)
