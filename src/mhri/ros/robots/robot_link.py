# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot as this program hears it: its odometry, its link and the proof of its stops."""
import importlib
import math
import threading
import time

from geometry_msgs.msg import TwistStamped
import rospy
from sensor_msgs.msg import BatteryState

from mhri.core.robots.link import link_note, link_state
from mhri.core.robots.link_quality import LinkQuality, link_warning
from mhri.core.robots.names import topic_of
from mhri.core.robots.stop_proof import StopProof
from mhri.core.screen.views import LIVE, RobotView
from mhri.core.sensors.plausible import BATTERY, can_be
from mhri.ros.convert import header_of, motion_from_odometry, motion_from_turtle_pose
from mhri.ros.robots.link_probe import LinkProbe
from mhri.ros.sensors.refusals import Refusals

_READERS = {'nav_msgs/Odometry': ('nav_msgs.msg', 'Odometry', motion_from_odometry),
            'turtlesim/Pose': ('turtlesim.msg', 'Pose', motion_from_turtle_pose)}

# Below a robot's namespace: the late commands that its guard kept from it.
DROPPED = 'mhri_guard/dropped'
DROPPED_SHOWN_S = 1.0


def battery_fraction(message):
    """Return the charge in a ``sensor_msgs/BatteryState`` as a fraction in [0, 1], or None.

    The message asks for a fraction; drivers that write percent are understood, and those that
    divide by a nominal voltage may say a little over 1 (turtlebot3_core does).
    """
    value = message.percentage
    if not can_be(BATTERY, value):
        return None
    return min(1.0, value / 100.0 if value > 1.5 else value)


class Feed:
    """The messages of one topic, each handed on with the time it came.

    rospy has one connection for all subscribers of a topic in a program, and the class of whoever
    came first decides what all of them get. So this asks for the real class, that an rqt plugin
    beside the panel may rely on, and takes bytes (``rospy.AnyMsg``) where another asked for those.

    :param read: function from the message to a value
    :param on_message: called with (feed, message, received at [s]) on the ROS thread
    """

    def __init__(self, topic, message_class, read, on_message):
        self.topic = topic
        self._class = message_class
        self._read = read
        self._on_message = on_message
        self._refusals = Refusals(topic, time.monotonic)
        # Not a queue of one: what is left out here must not look like a loss of the link.
        self._subscriber = rospy.Subscriber(topic, message_class, self._hear, queue_size=20,
                                            tcp_nodelay=True)

    def _hear(self, message):
        self._on_message(self, message, time.monotonic())

    def value(self, message):
        """Return the value in a message, None where its bytes are none."""
        message = self._refusals.read(message, self._class)
        return None if message is None else self._read(message)

    def header(self, message):
        """Return (number, stamp [s]) of a message, or None where it has no header."""
        return header_of(message, self._class)

    def publisher_uri(self):
        """Return the XML-RPC address of a node that publishes this topic, or None."""
        subscriber = self._subscriber
        links = subscriber.impl.connections if subscriber else ()
        return next((link.endpoint_id for link in links if link.endpoint_id), None)

    def connections(self):
        """Return the number of publishers connected; 0 once it has stopped listening."""
        subscriber = self._subscriber
        return subscriber.get_num_connections() if subscriber else 0

    def unregister(self):
        """Stop listening (blocking: it asks the master); others may look at it all the while."""
        subscriber, self._subscriber = self._subscriber, None
        subscriber.unregister()


class RobotLink:
    """A robot's newest motion, kept under a lock for the GUI thread to take.

    :param name: the robot's namespace
    :param robot_type: :class:`mhri.core.robots.robot_types.RobotType`
    :param gate: :class:`mhri.ros.driving.gate.Gate` of the robot
    :param feeds: :class:`mhri.ros.robots.bot_feeds.BotFeeds` of its window
    """

    def __init__(self, name, robot_type, gate, feeds, clock=time.monotonic):
        self.name = name
        self.robot_type = robot_type
        self.gate = gate
        self.feeds = feeds
        self._clock = clock
        self._lock = threading.Lock()
        self.added_at = clock()
        self._heard_at = None
        self._heard_wall = ''
        self._pending = None
        self._motion = None
        self._quality = LinkQuality()
        self._proof = None
        self._battery = None
        self._guard_feed = None
        self._dropped_at = -math.inf
        self._feeds = self._open_feeds()
        self._battery_feeds = [
            Feed(topic_of(name, topic), BatteryState, battery_fraction, self._on_battery)
            for topic in robot_type.battery]
        self._probe = LinkProbe(name, self._node_uri, self._on_round_trip)

    def _node_uri(self):
        """Return the address of the node that tells the odometry, or None."""
        return next((uri for uri in (feed.publisher_uri() for feed in self._feeds) if uri), None)

    def _on_round_trip(self, round_trip_s):
        with self._lock:
            self._quality.on_round_trip(round_trip_s)

    def _open_feeds(self):
        """Subscribe the odometry topics of the template."""
        module, class_name, read = _READERS[self.robot_type.odometry_type]
        try:
            message_class = getattr(importlib.import_module(module), class_name)
        except ImportError:
            rospy.logwarn('%s: cannot read its odometry, %s is not installed here', self.name,
                          self.robot_type.odometry_type)
            return []
        return [Feed(topic_of(self.name, topic), message_class, read, self._on_message)
                for topic in self.robot_type.odometry]

    def _on_message(self, feed, message, now):
        came_at, header = time.time(), feed.header(message)
        with self._lock:
            if header is not None:
                number, stamp_s = header
                self._quality.on_message(number, came_at - stamp_s if stamp_s else None, now)
            self._heard_at = now
            self._pending = (feed, message)
            if self._proof is not None:
                self._take()
                self._proof.on_motion(self._motion, now)

    def listen_to_guard(self):
        """Hear what the robot's guard drops, once it has one (blocking: it asks the master)."""
        if self._guard_feed is None and self.gate.guarded():
            self._guard_feed = Feed('/{}/{}'.format(self.name, DROPPED), TwistStamped,
                                    lambda message: message, self._on_dropped)

    def _on_dropped(self, feed, message, now):
        self._dropped_at = now

    def _on_battery(self, feed, message, now):
        self._battery = feed.value(message)

    def _take(self):
        """Read the newest message, where it has not been read yet."""
        if self._pending is not None:
            feed, message = self._pending
            self._pending = None
            self._motion = feed.value(message) or self._motion

    def on_stop(self, stopped, now):
        """Begin (or end) the proof of a stop."""
        with self._lock:
            self._proof = StopProof(now) if stopped else None

    def heard_since(self, when):
        """Tell whether the robot has been heard since a time; a robot that never is, always.

        :param when: None: it does not matter
        """
        with self._lock:
            return None in (when, self._heard_at) or self._heard_at > when

    @property
    def stopped_ms(self):
        """Time that the robot took to stand still at the stop in force [ms], None before that."""
        with self._lock:
            return self._proof.stopped_ms if self._proof else None

    def view(self):
        """Return the :class:`RobotView` of this moment."""
        now = self._clock()
        connections = sum(feed.connections() for feed in self._feeds)
        with self._lock:
            self._take()
            age = None if self._heard_at is None else now - self._heard_at
            motion, limits = self._motion, self.robot_type.limits
            state = link_state(age, connections)
            if age is not None and (age < 1.0 or not self._heard_wall):
                self._heard_wall = time.strftime('%H:%M:%S')
            proof = self._proof.view(now) if self._proof else None
            figures = self._quality.read(now)
        dropped = now - self._dropped_at < DROPPED_SHOWN_S
        warning = link_warning(figures, dropped) if state == LIVE else ''
        waits = self.gate.rule.waits and state == LIVE
        if waits:
            warning = 'centre the stick: it was out of reach'
        return RobotView(
            name=self.name, type_label=self.robot_type.label, window=self.robot_type.window,
            link=state, age_s=age,
            note=link_note(state, age, self._heard_wall, now - self.added_at) or warning,
            figures=figures, slow=bool(warning), waits=waits,
            linear_mps=motion and motion.linear_mps, angular_rad_s=motion and motion.angular_rad_s,
            heading_rad=motion and motion.heading_rad, x_m=motion and motion.x_m,
            y_m=motion and motion.y_m, battery=self._battery, selected=self.gate.rule.selected,
            driven=self.gate.rule.driving and self.gate.reachable(), guarded=self.gate.guarded(),
            moving=motion is not None and age < 1.0 and not motion.is_standstill(), proof=proof,
            max_linear_mps=limits.linear_mps, max_angular_rad_s=limits.angular_rad_s)

    def close(self):
        """Stop listening and give the velocity topics back (blocking: it asks the master)."""
        self._probe.close()
        self.feeds.close()
        guard_feeds = [self._guard_feed] if self._guard_feed else []
        for feed in self._feeds + self._battery_feeds + guard_feeds:
            feed.unregister()
        self.gate.unregister()
