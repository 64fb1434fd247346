# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sole owner of the places of robots, the marks and the fence.

Interfaces (global names; SI units):

- publishes ``/mhri_tasks/places`` (``mhri/Places``, latched, on change at up to 10 Hz, and at 1 Hz)
- subscribes ``/tf`` and ``/tf_static`` once a robot is known
- keeps places and drawings made by hand in the parameter ``/mhri_tasks/kept``, for a restart of the
  node after a failure

The services are in :mod:`mhri.map.ros.place_services`.
"""
import math
import threading
import time

from geometry_msgs.msg import Point32, Pose2D
import rospy

from mhri.base.config import short
from mhri.base.geometry import composed, inverse
from mhri.map.drawn import Drawn, kept_of, read_kept
from mhri.map.places import Corrections, Place, RobotPlace, tf_problem
from mhri.msg import Mark, Place as PlaceMessage, Places
from mhri.robots.ros.tf_feed import TfFeed

TOPIC, KEPT = '/mhri_tasks/places', '/mhri_tasks/kept'
MAP, WORLD = 'map', 'mhri_world'
# tf is read, and the message published, at every second update of 20 Hz.
PUBLISH_EVERY, MAX_SILENCE_S = 2, 1.0
NOWHERE = Place()


class PlaceKeeper:
    """The places of the sensed robots, for any thread.

    :param seen: :class:`mhri.tasks.ros.sensed_robots.SensedRobots`
    :param map_source: its ``is_there`` is whether there is a map
    :param clock: seconds, monotonic
    :param frames: :class:`TfFeed` that is opened here; None: create one
    """

    def __init__(self, seen, map_source, clock, frames=None):
        self._seen = seen
        self._map = map_source
        self._clock = clock
        self._lock = threading.Lock()
        self._tf = frames or TfFeed(clock)
        self._robots = {}
        self._corrections = {}
        self._places = {}
        self._settling = {}
        self._drawn = Drawn()
        self._looks = 0
        self._published, self._published_at = None, -math.inf
        self._kept = None
        self._frame = WORLD
        self._publisher = None

    def start(self):
        """Restore the stored data, and start publishing (blocking: calls the master)."""
        self._publisher = rospy.Publisher(TOPIC, Places, queue_size=1, latch=True)
        self._restore(rospy.get_param(KEPT, None))
        self._tf.open()

    def _restore(self, value):
        if value is None:
            return
        self._drawn, hand, errors = read_kept(value, KEPT)
        for error in errors:
            rospy.logwarn('left out of what was kept: %s', short(error))
        for name, (origin, odometry, at_s) in hand.items():
            ago_s = max(0.0, time.time() - at_s)
            self._of(name).resume(origin, odometry, self._clock() - ago_s)

    def _of(self, name):
        return self._robots.setdefault(name, RobotPlace())

    def look(self):
        """Process the newest data of the robots, and publish if due."""
        now, robots = self._clock(), self._seen.all()
        self._looks += 1
        frames = [robot.odometry_frame for robot in robots]
        with self._lock:
            for robot in robots:
                self._look_at(robot, frames, now)
            self._places = {robot.name: self._of(robot.name).place(now) for robot in robots}
            self._settling = {
                robot.name: self._corrections.setdefault(robot.name, Corrections()).settling(
                    self._places[robot.name], robot.pose, now)
                for robot in robots if robot.pose is not None}
            for name in set(self._robots) - {robot.name for robot in robots}:
                self._corrections.pop(name, None)
                if self._robots[name].hand is None:
                    del self._robots[name]
            if self._looks % PUBLISH_EVERY == 0:
                self._publish(now)

    def _look_at(self, robot, frames, now):
        """Process the newest data of one robot; called with the lock held."""
        place = self._of(robot.name)
        place.odometry_note = robot.odometry_note
        if robot.odometry is not None and robot.odometry is not place.odometry:
            place.drive(robot.odometry)
        if robot.seen_at is not None and place.seen_at != robot.seen_at[1]:
            place.capture(*robot.seen_at)
        if self._looks % PUBLISH_EVERY:
            return
        problem = tf_problem(self._frame, robot.odometry_frame, frames)
        if problem:
            place.forget_tf(problem if robot.odometry_frame else '')
            return
        found = self._tf.find(self._frame, robot.odometry_frame)
        if found is not None:
            place.update_tf(*found)
        elif self._tf.knows(robot.odometry_frame):
            place.update_tf(None, problem='tf does not lead from {} to {}'.format(
                self._frame, robot.odometry_frame[:60]))

    def _publish(self, now):
        """Publish on a change, and once a second."""
        self._frame = MAP if self._map.is_there or self._tf.knows(MAP) else WORLD
        message = Places(robots=[_place_message(name, place)
                                 for name, place in sorted(self._places.items())],
                         marks=[Mark(name, Pose2D(*_numbers(pose)))
                                for name, pose in sorted(self._drawn.marks.items())],
                         fence=[Point32(x, y, 0.0) for x, y in self._drawn.fence])
        message.header.frame_id = self._frame
        shown = (self._frame, [_shown(place) for place in message.robots], message.marks,
                 message.fence)
        if shown != self._published or now - self._published_at >= MAX_SILENCE_S:
            self._published, self._published_at = shown, now
            message.header.stamp = rospy.Time.now()
            self._publisher.publish(message)

    def keep(self):
        """Store places and drawings made by hand at the master, if they have changed."""
        with self._lock:
            hand = {name: (robot.hand, robot.odometry.pose, time.time() - (
                self._clock() - robot.odometry.at_s)) for name, robot in self._robots.items()
                    if robot.hand is not None}
            kept = kept_of(self._drawn, hand)
            if kept == self._kept or (self._kept is None and not any(kept.values())):
                return
            self._kept = kept
        rospy.set_param(KEPT, kept)

    def place(self, name):
        """Return the :class:`Place` of a robot as of the last update."""
        return self._places.get(name, NOWHERE)

    def settling(self, name):
        """Describe a large correction of a robot's place just now, '' without one."""
        return self._settling.get(name, '')

    def fence(self):
        """Return the corners (x, y) [m] of the fence, () without one."""
        return self._drawn.fence

    def marks(self):
        """Return {name: :class:`Pose`} of the marks."""
        return dict(self._drawn.marks)

    def mark(self, name):
        """Return the :class:`Pose` of a mark, None if it does not exist."""
        return self._drawn.marks.get(name)

    def put(self, name, pose, odometry=None):
        """Place a robot by hand; return why that is impossible, '' on success.

        :param odometry: the matching odometry :class:`Pose`, None: the newest
        """
        with self._lock:
            place = self._of(name)
            if odometry is not None and place.odometry is not None:
                pose = composed(composed(pose, inverse(odometry)), place.odometry.pose)
            return place.put(pose, self._clock())

    def take_back(self, name):
        """Forget the place of a robot set by hand."""
        with self._lock:
            self._of(name).take_back()

    def draw(self, change):
        """Apply a function to the :class:`Drawn`; return its result."""
        with self._lock:
            return change(self._drawn)


def _numbers(pose):
    return (pose.x_m, pose.y_m, pose.heading_rad)


def _place_message(name, place):
    origin = (math.nan,) * 3 if place.odometry is None else _numbers(place.odometry)
    return PlaceMessage(robot=name, by=place.by, text=place.text, age_s=place.age_s,
                        odometry=Pose2D(*origin))


def _shown(place):
    """Return a place for comparison: without its age, rounded to 1 mm."""
    origin = place.odometry
    return (place.robot, place.by, place.text,
            [str(round(number, 3)) for number in (origin.x, origin.y, origin.theta)])
