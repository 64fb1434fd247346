# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one owner of where robots are placed, of marks and of the fence.

Interfaces (global names; SI units):

- publishes ``/mhri_tasks/places`` (``mhri/Places``, latched, on change at up to 10 Hz, and at 1 Hz)
- subscribes ``/tf`` and ``/tf_static`` once a robot is known
- keeps what was placed and drawn by hand in the parameter ``/mhri_tasks/kept``, since the node is
  started again where it fails

The services are in :mod:`mhri.map.ros.place_services`.
"""
import math
import threading
import time

from geometry_msgs.msg import Point32, Pose2D
import rospy

from mhri.base.config import short
from mhri.map.drawn import Drawn, kept_of, read_kept
from mhri.map.places import composed, Corrections, inverse, Place, RobotPlace, tf_problem
from mhri.msg import Mark, Place as PlaceMessage, Places
from mhri.robots.ros.tf_feed import TfFeed

TOPIC, KEPT = '/mhri_tasks/places', '/mhri_tasks/kept'
MAP, WORLD = 'map', 'mhri_world'
# Of the looks, which are 20 a second: tf and the message take every second one.
TOLD_EVERY, TOLD_AT_LEAST_S = 2, 1.0
NOWHERE = Place()


class PlaceKeeper:
    """The places of the robots that are seen, from any thread.

    :param seen: :class:`mhri.tasks.ros.seen_robots.SeenRobots`
    :param map_source: its ``is_there`` tells whether there is a map
    :param clock: seconds, monotonic
    :param frames: :class:`TfFeed` that is opened here; None: one of its own
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
        self._told, self._told_at = None, -math.inf
        self._kept = None
        self._frame = WORLD
        self._publisher = None

    def start(self):
        """Take up what was kept, and begin to publish (blocking: it asks the master)."""
        self._publisher = rospy.Publisher(TOPIC, Places, queue_size=1, latch=True)
        self._take_up(rospy.get_param(KEPT, None))
        self._tf.open()

    def _take_up(self, value):
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
        """Take in what the robots have said, and publish it where it is time for that."""
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
            if self._looks % TOLD_EVERY == 0:
                self._tell(now)

    def _look_at(self, robot, frames, now):
        """Take in what one robot has said; called with the lock held."""
        place = self._of(robot.name)
        if robot.odometry is not None and robot.odometry is not place.odometry:
            place.drive(robot.odometry)
        if robot.seen_at is not None and place.seen_at != robot.seen_at[1]:
            place.capture(*robot.seen_at)
        if self._looks % TOLD_EVERY:
            return
        problem = tf_problem(self._frame, robot.odometry_frame, frames)
        if problem:
            place.forget_tf(problem if robot.odometry_frame else '')
            return
        found = self._tf.find(self._frame, robot.odometry_frame)
        if found is not None:
            place.see_tf(*found)
        elif self._tf.knows(robot.odometry_frame):
            place.see_tf(None, problem='tf does not lead from {} to {}'.format(
                self._frame, robot.odometry_frame[:60]))

    def _tell(self, now):
        """Publish where something has changed, and once a second."""
        self._frame = MAP if self._map.is_there or self._tf.knows(MAP) else WORLD
        message = Places(robots=[_place_message(name, place)
                                 for name, place in sorted(self._places.items())],
                         marks=[Mark(name, Pose2D(*_numbers(pose)))
                                for name, pose in sorted(self._drawn.marks.items())],
                         fence=[Point32(x, y, 0.0) for x, y in self._drawn.fence])
        message.header.frame_id = self._frame
        told = (self._frame, [_shown(place) for place in message.robots], message.marks,
                message.fence)
        if told != self._told or now - self._told_at >= TOLD_AT_LEAST_S:
            self._told, self._told_at = told, now
            message.header.stamp = rospy.Time.now()
            self._publisher.publish(message)

    def keep(self):
        """Write what was placed and drawn by hand to the master, where that has changed."""
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
        """Return the :class:`Place` of a robot as of the last look."""
        return self._places.get(name, NOWHERE)

    def settling(self, name):
        """Return in words that a robot's place was just corrected by far, '' where it was not."""
        return self._settling.get(name, '')

    def fence(self):
        """Return the corners (x, y) [m] of the fence, () for none."""
        return self._drawn.fence

    def marks(self):
        """Return {name: :class:`Pose`} of the marks."""
        return dict(self._drawn.marks)

    def mark(self, name):
        """Return the :class:`Pose` of a mark, None where there is none."""
        return self._drawn.marks.get(name)

    def put(self, name, pose, odometry=None):
        """Place a robot by hand; return why that cannot be, '' if it is done.

        :param odometry: the odometry :class:`Pose` that belongs to the pose, None: the newest
        """
        with self._lock:
            place = self._of(name)
            if odometry is not None and place.odometry is not None:
                pose = composed(composed(pose, inverse(odometry)), place.odometry.pose)
            return place.put(pose, self._clock())

    def take_back(self, name):
        """Forget where a robot was placed by hand."""
        with self._lock:
            self._of(name).take_back()

    def draw(self, change):
        """Let a function change the :class:`Drawn`; return what it returns."""
        with self._lock:
            return change(self._drawn)


def _numbers(pose):
    return (pose.x_m, pose.y_m, pose.heading_rad)


def _place_message(name, place):
    origin = (math.nan,) * 3 if place.odometry is None else _numbers(place.odometry)
    return PlaceMessage(robot=name, by=place.by, text=place.text, age_s=place.age_s,
                        odometry=Pose2D(*origin))


def _shown(place):
    """Return what of a place is a change: not its age, nor what is less than a millimetre."""
    origin = place.odometry
    return (place.robot, place.by, place.text,
            [str(round(number, 3)) for number in (origin.x, origin.y, origin.theta)])
