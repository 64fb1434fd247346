# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot as this program hears it: odometry, link and the proof of its stops."""
import math
import threading
import time
from dataclasses import replace

from geometry_msgs.msg import TwistStamped
import rospy
from sensor_msgs.msg import BatteryState
from std_msgs.msg import String

from mhri.base.brake_view import back_words, brake_words, BrakeView
from mhri.base.names import topic_of
from mhri.base.plausible import BATTERY, can_be
from mhri.base.tf_tree import OdometryFrames
from mhri.base.views import LIVE, RobotView, UNANSWERED
from mhri.graph.ros.messages import MessageMissing
from mhri.graph.ros.refusals import Refusals
from mhri.msg import RobotGate
from mhri.robots.figures import (
    FETCHING, FETCHING_WORD, FIGURES, FIGURES_S, read_figures, thinned_words)
from mhri.robots.gate_words import also_words, LIMIT_RAISED, NOT_ALONE, ODOMETRY_STUCK, stands_words
from mhri.robots.link import link_note, link_state
from mhri.robots.link_quality import link_warning, LinkQuality
from mhri.robots.ros.convert import header_of, is_driven, round_trip_s
from mhri.robots.ros.hardware_stop import HardwareStop
from mhri.robots.ros.odometry import odometry_of
from mhri.robots.stamp_age import delay_of, StampAge
from mhri.robots.stop_proof import StopProof

# Topic in a robot's namespace: the late commands that its guard dropped.
DROPPED = 'mhri_guard/dropped'
DROPPED_SHOWN_S = 1.0
# A robot that has taken commands for this long without odometry has none.
MUTE_AFTER_S = 3.0


def battery_fraction(message):
    """Return the charge in a ``sensor_msgs/BatteryState`` as a fraction in [0, 1], or None.

    The message specifies a fraction; percent is understood as well, and drivers that divide by a
    nominal voltage may report a little over 1 (turtlebot3_core does).
    """
    value = message.percentage
    if not can_be(BATTERY, value):
        return None
    return min(1.0, value / 100.0 if value > 1.5 else value)


class Feed:
    """The messages of one topic, each passed on with its time of arrival.

    rospy has one connection for all subscribers of a topic in a program, and the class of the first
    one decides what they all get. So this asks for the real class, on which an rqt plugin beside
    the panel may rely, and accepts bytes (``rospy.AnyMsg``) if another one asked for those.

    :param read: function from the message to a value
    :param on_message: called with (feed, message, received at [s]) on the ROS thread
    :param clock: function that returns seconds that never go back
    """

    def __init__(self, topic, message_class, read, on_message, clock=time.monotonic):
        self.topic = topic
        self._class = message_class
        self._read = read
        self._on_message = on_message
        self._clock = clock
        self._refusals = Refusals(topic, time.monotonic)
        # Not a queue of one: a message dropped here must not look like a loss of the link.
        self._subscriber = rospy.Subscriber(topic, message_class, self._hear, queue_size=20,
                                            tcp_nodelay=True)

    def _hear(self, message):
        self._on_message(self, message, self._clock())

    def value(self, message):
        """Return the value in a message, None if its bytes are not valid."""
        message = self._refusals.read(message, self._class)
        return None if message is None else self._read(message)

    def note(self, problem):
        """Count a message that says what cannot be; log it unless one was logged just now."""
        self._refusals.note(problem)

    @property
    def refused(self):
        """Number of messages that cannot be, among those that were read."""
        return self._refusals.count

    def header(self, message):
        """Return (number, stamp [s]) of a message, or None if it has no header."""
        return header_of(message, self._class)

    def connections(self):
        """Return the number of connected publishers; 0 after it has stopped listening."""
        subscriber = self._subscriber
        return subscriber.get_num_connections() if subscriber else 0

    def unregister(self):
        """Stop listening (blocking: it asks the master); others may read it meanwhile."""
        subscriber, self._subscriber = self._subscriber, None
        subscriber.unregister()


class RobotLink:
    """A robot's newest motion, kept under a lock for the GUI thread to take.

    :param name: the robot's namespace
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param gates: :class:`mhri.driving.ros.gates_client.GatesClient`
    :param feeds: :class:`mhri.robots.ros.bot_feeds.BotFeeds` of its tile
    :param clock: function that returns seconds that never go back
    :param wall: function that returns the time of day [s since 1970]
    :param quality: makes what measures its link
    """

    def __init__(self, name, robot_type, gates, feeds, clock=time.monotonic, wall=time.time,
                 quality=LinkQuality):
        self.name = name
        self.robot_type = robot_type
        self._gates = gates
        self.feeds = feeds
        self._clock = clock
        self._wall = wall
        self._lock = threading.Lock()
        self.added_at = clock()
        self._heard_at = None
        self._reached_at = None
        self._heard_wall = ''
        self._pending = None
        self._motion = None
        self._quality = quality()
        self._ages = {}
        self._proof, self._follows = None, True
        self._battery = None
        self._guard_feeds = []
        self._dropped_at = -math.inf
        self._radio = None
        self._fetching = ''
        self._feeds = self._open_feeds()
        feeds.others['odometry'] = self
        self._battery_feeds = [
            Feed(topic_of(name, topic), BatteryState, battery_fraction, self._on_battery,
                 clock)
            for topic in robot_type.battery]
        self._hardware_stop = HardwareStop(name, robot_type)

    def on_gate(self, gate):
        """Take in what the gates say of this robot (``mhri/RobotGate``), on a ROS thread."""
        with self._lock:
            self._quality.on_round_trip(round_trip_s(gate))
            self._follows = gate.odometry_follows
            if self._proof is not None:
                self._proof.follows = self._follows

    def _open_feeds(self):
        """Subscribe to the odometry topics of the template."""
        try:
            message_class, read = odometry_of(self.robot_type)
        except MessageMissing as error:
            rospy.logwarn('%s: cannot read its odometry: %s', self.name, error)
            return []

        def read_motion(message):
            """Read what moves, and take note of what the robot calls its frames."""
            self.feeds.frames = OdometryFrames.of(message)
            return read(message)
        return [Feed(topic_of(self.name, topic), message_class, read_motion, self._on_message,
                     self._clock) for topic in self.robot_type.odometry]

    def _on_message(self, feed, message, now):
        came_at, header = self._wall(), feed.header(message)
        with self._lock:
            late_s = 0.0
            if header is not None:
                number, stamp_s = header
                late_s = self._ages.setdefault(feed, StampAge()).late_s(stamp_s, now)
                self._quality.on_message(number, delay_of(came_at, stamp_s), now)
            self._heard_at = now
            self._pending = (feed, message)
            # Bytes that are not a message prove nothing, nor does anything before them.
            if self._proof is not None and self._take():
                self._proof.on_motion(self._motion, now, late_s)

    def listen_to_guard(self):
        """Listen to what the robot's guard drops, once it has one (blocking: asks the master)."""
        gate = self._gates.robot(self.name)
        if not self._guard_feeds and gate is not None and gate.guarded:
            self._guard_feeds = [
                Feed('/{}/{}'.format(self.name, DROPPED), TwistStamped, lambda message: message,
                     self._on_dropped, self._clock),
                Feed('/{}/{}'.format(self.name, FIGURES), String,
                     lambda message: read_figures(message.data), self._on_radio, self._clock),
                Feed('/{}/{}'.format(self.name, FETCHING), String,
                     lambda message: message.data[:80], self._on_fetching, self._clock)]

    def _on_dropped(self, feed, message, now):
        self._dropped_at = now

    def _on_radio(self, feed, message, now):
        self._radio = (now, feed.value(message))

    def _on_fetching(self, feed, message, now):
        text = feed.value(message)
        self._fetching = text if text.startswith(FETCHING_WORD) else ''

    def _on_battery(self, feed, message, now):
        self._battery = feed.value(message)

    def _take(self):
        """Read the newest message if it is unread; return whether it holds a motion."""
        if self._pending is None:
            return False
        feed, message = self._pending
        self._pending = None
        # Nothing from before may pass for what was heard now.
        self._motion = feed.value(message)
        if self._motion is not None and self._motion.problem:
            feed.note(self._motion.problem)
        return self._motion is not None

    def refused(self):
        """Return the number of messages of its odometry that cannot be, among those read."""
        return sum(feed.refused for feed in self._feeds)

    def on_stop(self, stopped, now):
        """Begin (or end) the proof of a stop."""
        with self._lock:
            self._proof = StopProof(
                now, self._quality.read(now).round_trip_s,
                self.robot_type.silent_after_s) if stopped else None
            if self._proof is not None:
                self._proof.follows = self._follows

    @property
    def stopped_ms(self):
        """Time the robot took to stand still at the stop in force [ms], None before that."""
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
            state = link_state(age, connections, self.robot_type.silent_after_s,
                               self._takes_commands(now))
            if age is not None and (age < 1.0 or not self._heard_wall):
                self._heard_wall = time.strftime('%H:%M:%S', time.localtime(self._wall()))
            proof = self._proof.view(now) if self._proof else None
            figures = self._with_radio(self._quality.read(now), now)
        dropped = now - self._dropped_at < DROPPED_SHOWN_S
        warning = link_warning(figures, dropped) if state == LIVE else ''
        view = RobotView(
            name=self.name, type_label=self.robot_type.label, window=self.robot_type.window,
            link=state, age_s=age,
            note=link_note(state, age, self._heard_wall, now - self.added_at) or warning
            or self._fetching,
            figures=figures, slow=bool(warning),
            **_numbers(motion), battery=self._battery, proof=proof,
            # Whoever is heard and says nothing that can be may well move.
            moving=age is not None and age < 1.0 and not (motion and motion.is_standstill()),
            hardware_stop=self._hardware_stop.stopped, max_linear_mps=limits.linear_mps,
            max_angular_rad_s=limits.angular_rad_s,
            offers_power=self.robot_type.motor_power is not None)
        return seen_by_gates(view, self._gates.robot(self.name), self._gates.answers())

    def _with_radio(self, figures, now):
        """Return figures with those of a link to the robot's own master, where there is one."""
        told_at, radio = self._radio or (-math.inf, None)
        if radio is None or now - told_at > FIGURES_S:
            return figures
        known = {key: value for key, value in (
            ('round_trip_s', radio.round_trip), ('loss', radio.loss)) if math.isfinite(value)}
        return replace(figures, thinned='; '.join(thinned_words(radio)), **known)

    def _takes_commands(self, now):
        """Tell whether the robot has listened to commands long enough to be heard as well."""
        gate = self._gates.robot(self.name)
        if gate is None or not gate.topic or not self._gates.answers():
            self._reached_at = None
        elif self._reached_at is None:
            self._reached_at = now
        return self._reached_at is not None and now - self._reached_at > MUTE_AFTER_S

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        self._hardware_stop.close()
        self.feeds.close()
        for feed in self._feeds + self._battery_feeds + self._guard_feeds:
            feed.unregister()


def _numbers(motion):
    """Return the numbers of a view that a :class:`Motion` gives, as {key: value}."""
    keys = ('linear_mps', 'angular_rad_s', 'heading_rad', 'x_m', 'y_m')
    told = {key: getattr(motion, key) for key in keys if motion is not None}
    return {key: value for key, value in told.items() if math.isfinite(value)}


def seen_by_gates(view, gate, answers):
    """Return a view with what the gates say: only they know what the robot is sent.

    :param view: :class:`mhri.base.views.RobotView`
    :param gate: their ``mhri/RobotGate``; None if they do not know the robot
    :param answers: whether they were heard lately; otherwise their state is ignored
    """
    if not answers:
        return replace(view, note=UNANSWERED, slow=True)
    if gate is None:
        return view
    stands = stands_words(gate.stands) if gate.obeys or gate.stands in (
        RobotGate.GUARD_VERSION, RobotGate.TWO_ROBOTS, RobotGate.UNREACHABLE) else ''
    also = tuple(gate.also_commanded_by)
    warning = stands or (NOT_ALONE.format(also_words(also)) if also else '') or (
        '' if gate.odometry_follows else ODOMETRY_STUCK) or (
            LIMIT_RAISED if gate.limit_raised else '')
    brake = BrakeView(gate.brake, gate.free_way_m, gate.brake_on_robot, gate.back_after_s)
    return with_stop_words(replace(
        view, driven=is_driven(gate) and bool(gate.topic), guarded=gate.guarded,
        obeys=gate.obeys, stands=gate.stands, brake=brake, power=gate.power,
        waits=gate.stands == RobotGate.JOINING, stop_latched=gate.stop_confirmed,
        sent_mps=gate.sent.linear.x, sent_rad_s=gate.sent.angular.z, reached=bool(gate.topic),
        also_commanded_by=also, odometry_follows=gate.odometry_follows,
        note=warning if warning and view.link == LIVE else view.note or _calm_note(
            view, gate, brake),
        slow=view.slow or bool(warning) or brake.holds))


def _calm_note(view, gate, brake):
    """Return what a robot does, where no warning about its link is worth more."""
    if view.link != LIVE:
        return ''
    if gate.obeys == RobotGate.TASK:
        return 'on a task'
    return brake_words(brake) or ('' if is_driven(gate) else back_words(brake))


def with_stop_words(view):
    """Return a view that adds to the proof of a stop what else keeps the robot from moving."""
    words = ['its own emergency stop is pressed'] if view.hardware_stop else []
    words += ['motor power ' + view.power] if view.power else []
    if view.proof is not None:
        also = also_words(view.also_commanded_by)
        words = [view.proof.text] + ([also] if also else []) + (
            ['held by its guard'] if view.stop_latched else []) + words
        return replace(view, proof=replace(view.proof, text=', '.join(words)))
    if not words:
        return view
    return replace(view, slow=True, note='; '.join(words + ([view.note] if view.note else [])))
