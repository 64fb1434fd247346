# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: its rule, and the connections that carry its commands."""
import math
import operator
import time

import genpy
from geometry_msgs.msg import Twist, TwistStamped
import rospy
from std_msgs.msg import String

from mhri.base.limits import ZERO
from mhri.base.names import topic_of
from mhri.base.views import GONE, SILENT
from mhri.driving import arbiter
from mhri.driving.gate import GateRule, HELD, STOPPED
from mhri.driving.guard_link import GuardLink, GuardState, read_state
from mhri.driving.ros.brake_eye import BrakeEye
from mhri.driving.ros.motor_power import MotorPower
from mhri.driving.ros.other_drivers import OtherDrivers
from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.rospy_inside import (
    caller_of, listeners, md5sum_of, peer_hosts, publisher_hosts, publisher_uri, publishers,
    type_of, unsubscribe)
from mhri.msg import RobotGate as RobotGateMessage
from mhri.robots.link import link_state
from mhri.robots.listeners import guard_node, obeying
from mhri.robots.ros.convert import packed_twist, to_twist
from mhri.robots.ros.link_probe import LinkProbe
from mhri.robots.ros.own_navigation import OwnNavigation
from mhri.robots.stop_proof import OdometryWitness
from mhri.robots.twins import GuardTurns, listed, twins

# A link that has confirmed nothing for this long is lost: the robot is held, with one zero behind
# the little still on its way. Before that (from 0.1 s on) only zeros are written into it.
LOST_S = 0.33
# Heard within this time, a robot is there [s].
LIVE_S = 1.0
# Most velocity topics of a robot: each costs connections and a registration.
MOST_TOPICS = 8
# How often a guard that would go back alone is told that it is heard [s].
BEAT_S = 0.5
# How often the odometry of a robot that is told to move is compared with that [s].
COMPARE_S = 0.1
# A stopped robot that somebody else commands gets a zero so often [s]: 20 Hz, on ticks that may
# come a little early.
ZEROS_S = 0.045
# The zero behind somebody else's message may overtake it, on another connection: it is said again
# after so long [s].
BEHIND_S = 0.005
# A guard whose echo could not be read within this time is there, and must not be driven past; one
# that is read and takes no commands for so long is of another version, too [s].
UNREADABLE_S, UNLINKED_S = 1.5, 1.0
COMPLAIN_S = 1.0
_PACKED_ZERO = packed_twist(0.0, 0.0)


def _read_echo(message):
    """Return the echo in some bytes (``rospy.AnyMsg``), None if it is none; and its version."""
    kind, version = type_of(message), md5sum_of(message)
    echo = None
    if kind == TwistStamped._type and version in (TwistStamped._md5sum, '*'):
        try:
            echo = TwistStamped().deserialize(message._buff)
        except genpy.DeserializationError:
            pass
    said = '{} {}'.format(kind, version)[:100]
    return echo, said if echo is None else '{}, {} fields in its frame_id'.format(
        said, min(99, 1 + echo.header.frame_id.count(':')))


class RobotGate:
    """A :class:`GateRule` with the publishers and subscribers of its robot.

    Publishes each velocity topic of the robot's type (``geometry_msgs/Twist``) and
    ``/<robot>/mhri_guard/command`` (``geometry_msgs/TwistStamped``); a zero goes to all of them, a
    command to one: the guard's while its echo is alive, else the first that the robot listens to.
    Subscribes ``/<robot>/mhri_guard/echo`` (``geometry_msgs/TwistStamped``) and the odometry, of
    which the time counts, and whether it follows what the robot is told; and each velocity topic: a
    stopped robot that somebody else may command
    (:class:`mhri.driving.ros.other_drivers.OtherDrivers`) gets zeros at 20 Hz, and one behind each
    message that is heard. Of a guard that does something by itself also
    ``/<robot>/mhri_guard/state`` (``std_msgs/String``), which it answers by
    ``/<robot>/mhri_guard/heard`` (``std_msgs/String``). While the brake is asked for, see
    :class:`mhri.driving.ros.brake_eye.BrakeEye`; for the robot's own navigation, see
    :class:`mhri.robots.ros.own_navigation.OwnNavigation`. Apart from its callbacks it is not
    thread-safe: hold ``lock``.

    :param name: the robot
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param session: names this run of the gates, see :class:`GuardLink`
    :param command: the operator's last command, None before the first
    :param lock: held by the callbacks
    :param on_foreign_stop: called with the robot if another run of the gates has stopped it
    :param on_refused: called with (who, what) if somebody else has spoken to its guard, or cannot
        be believed or driven
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, None: without tf
    :param wake: called, under the lock, when :meth:`next_tick` has become earlier
    """

    def __init__(self, name, robot_type, session, command, lock, on_foreign_stop, on_refused,
                 clock=time.monotonic, frames=None, wake=lambda: None):
        self.name = name
        self.robot_type = robot_type
        self._eye = BrakeEye(name, robot_type, clock, frames)
        self.rule = GateRule(robot_type.limits, command, self._eye.brake.allow)
        self._clock = clock
        self._brake_asked = False
        self._guard_state = GuardState()
        self._beat_at = -math.inf
        self._lock = lock
        self._session = session
        self._on_foreign_stop = on_foreign_stop
        self._on_refused = on_refused
        self._sessions = 0
        self._guard = GuardLink(session)
        self._guarded = False
        self._heard_at = None
        #: round-trip time to a node of the robot [s], NaN if unknown
        self.round_trip_s = math.nan
        self._publishers = [PromptPublisher('/{}/mhri_guard/command'.format(name), TwistStamped)]
        self._publishers += [PromptPublisher(topic_of(name, topic), Twist)
                             for topic in robot_type.command[:MOST_TOPICS]]
        self._links = [()] * len(self._publishers)
        self._obeying = [frozenset()] * len(self._publishers)
        # The first velocity topic that the robot listens to, and its links.
        self._listened = self._listeners = None
        # Behind the robot's own multiplexer: a zero may go there, no command.
        self._behind = {topic_of(name, topic) for topic in robot_type.behind}
        self._heard = PromptPublisher('/{}/mhri_guard/heard'.format(name), String)
        self.power = MotorPower(name, robot_type)
        self._abandoned_at = -math.inf
        self._navigation = OwnNavigation(name, self._on_abandoned)
        self._witness, self._compared_at = OdometryWitness(), -math.inf
        # What its guard says that the robot was given.
        self._given = 0.0, 0.0
        self._wake = wake
        self._zero_at, self._again_at = -math.inf, math.inf
        # {(caller id, topic)} of those who can command it, as the master knows them.
        self._registered = frozenset()
        self._others = OtherDrivers(self._on_other_motion, clock)
        # A robot may be heard from here on.
        self._turns = GuardTurns()
        self._unreadable_at, self._unlinked_since = -math.inf, None
        self._held_by, self._complained_at = '', -math.inf
        self._odometry = [
            rospy.Subscriber(topic_of(name, topic), rospy.AnyMsg, self._on_odometry, queue_size=1,
                             tcp_nodelay=True) for topic in robot_type.odometry]
        # As bytes: rospy would not connect to a guard whose messages are defined otherwise.
        self._echo = rospy.Subscriber('/{}/mhri_guard/echo'.format(name), rospy.AnyMsg,
                                      self._on_echo, queue_size=1, tcp_nodelay=True)
        self._state = rospy.Subscriber('/{}/mhri_guard/state'.format(name), String,
                                       self._on_guard_state, queue_size=1, tcp_nodelay=True)
        self._probe = LinkProbe(name, self._node_uri, self._on_round_trip)
        self._others.listen(publisher.resolved_name for publisher in self._publishers[1:])
        if len(robot_type.command) > MOST_TOPICS:
            rospy.logwarn('%s has %d velocity topics: the first %d are used', name,
                          len(robot_type.command), MOST_TOPICS)

    def _node_uri(self):
        """Return the address of a node on the robot, or None."""
        return next((uri for uri in map(publisher_uri, self._odometry + [self._echo]) if uri), None)

    def _on_round_trip(self, round_trip_s):
        self.round_trip_s = math.nan if round_trip_s is None else round_trip_s

    def _on_odometry(self, message):
        first, self._heard_at = self._heard_at is None, self._clock()
        self._eye.on_odometry(message, self._heard_at)
        if self._witness.asks and self._heard_at - self._compared_at >= COMPARE_S:
            self._compared_at = self._heard_at
            motion = self._eye.motion(message)
            if motion is not None:
                with self._lock:
                    self._witness.on_motion(motion, self._heard_at, self.round_trip_s)
        if first:
            with self._lock:
                self.send(self.rule.join(self._heard_at))

    def velocity_topics(self):
        """Return (absolute velocity topics, prefixes of topics that drive the robot, too).

        A multiplexer on the robot has its inputs beside the one that is used here.
        """
        topics = [publisher.resolved_name for publisher in self._publishers[1:]]
        inputs = [topic.rpartition('/')[0] + '/' for topic in topics
                  if topic.rpartition('/')[0].endswith('/input')]
        return topics, tuple(inputs + ['/{}/cmd_vel_mux/input/'.format(self.name)])

    def insiders(self):
        """Return the nodes of the robot itself that publish its velocity, but for its guard."""
        return frozenset(name for name, _ in self._foreign(self._others.connected())
                         if name.startswith('/{}/'.format(self.name)))

    def on_publishers(self, found):
        """Take in who publishes there, as {(caller id, topic)} (blocking: asks the master)."""
        self._registered = frozenset(found)
        self._others.listen(sorted({topic for _, topic in self._foreign(found)}))

    def _foreign(self, found):
        """Return those of {(caller id, topic)} that say anything but what the robot is sent here.

        Its guard passes that on, and so does what reads one of its velocity topics and writes
        another, such as a velocity smoother.
        """
        if not found:
            return set()
        passes_on = {}
        for publisher, links in zip(self._publishers[1:], self._links[1:]):
            for name in listeners(links):
                passes_on.setdefault(name, set()).add(publisher.resolved_name)
        own = {publisher.resolved_name for publisher in self._publishers[1:]}
        apart = publishers(self._echo) | {rospy.get_name()}
        return {(name, topic) for name, topic in found if name not in apart
                and not (topic in own and passes_on.get(name, set()) - {topic})}

    def _on_other_motion(self, caller, topic):
        """Say zero directly behind what somebody else has just told a stopped robot."""
        with self._lock:
            if self.rule.state == STOPPED and self._foreign({(caller, topic)}):
                self._publish_zero()
                self._again_at = self._clock() + BEHIND_S
                self._wake()

    def next_tick(self):
        """Return when to call :meth:`tick` next [s], or None for at leisure."""
        times = [at for at in (self.rule.next_tick(), self._again_at)
                 if at is not None and at < math.inf]
        return min(times, default=None)

    @property
    def limit_raised(self):
        """Whether its parameters allow more than it is held to."""
        return self.rule.limits != self.robot_type.limits

    def hold_to(self, limits):
        """Hold it to limits that are no higher than those of its type; say where they are lower.

        :param limits: :class:`mhri.base.robot_types.Limits`
        """
        if limits == self.rule.limits:
            return
        self.rule.limits = limits
        if self.limit_raised:
            rospy.logwarn('%s: its limit was raised to %.2f m/s, %.2f rad/s while it was driven; '
                          'that counts once the robot is selected anew', self.name,
                          self.robot_type.limits.linear_mps, self.robot_type.limits.angular_rad_s)

    def also_commanded_by(self, now):
        """Return the sorted caller ids of the other nodes that command the robot now."""
        names = {name for name, _ in self._foreign(self._others.heard(now))}
        own = rospy.get_name()
        return sorted(names.union(name for name in self._guard_state.also if name != own)
                      if self._guarded else names)

    def _repeat_zero(self, now):
        """Repeat the zero of a stopped robot while anybody else could command it."""
        if now >= self._again_at:
            self._again_at = math.inf
            if self.rule.state == STOPPED:
                self._publish_zero()
        if self.rule.state == STOPPED and now - self._zero_at >= ZEROS_S and self._foreign(
                self._others.connected() | self._others.out_of_reach(self._registered)):
            self._publish(ZERO)

    @property
    def odometry_follows(self):
        """Whether the robot's odometry moved when the robot was told to."""
        return self._witness.follows

    def _tell_witness(self, now):
        """Say what the robot was given: nothing where its motors are off, or nobody listens."""
        given = 0.0, 0.0
        if self._guarded:
            given = self._given
        elif self._listened is not None:
            given = self.rule.sent.linear_mps, self.rule.sent.angular_rad_s
        self._witness.on_told(*((0.0, 0.0) if self.power.is_cut else given), now)

    def _on_guard_state(self, message):
        self._guard_state = read_state(message.data)

    def _on_abandoned(self):
        """Begin with the zeros behind a task whose program has died."""
        with self._lock:
            self._abandoned_at = self._clock()
            self.send(self.rule.on_task(ZERO, self._abandoned_at))

    def ask_brake(self, asked):
        """Switch the brake for the stick on or off; that of a guard on the robot replaces it."""
        self._brake_asked = asked
        self._eye.want(asked and self.rule.checked and not self._guard_brakes())

    def _guard_brakes(self):
        return self._guarded and bool(self._guard_state.brake)

    def brake(self):
        """Return (what the brake does, way to what slows it down [m], whether the guard has it)."""
        if not self._guard_brakes():
            return self._eye.brake.state(self._clock()) + (False,)
        return self._guard_state.brake, self._guard_state.free_way_m, True

    def _on_echo(self, message):
        """Take in an echo; repeat a stop or a release that the guard has missed."""
        now = self._clock()
        caller, (message, version) = caller_of(message), _read_echo(message)
        with self._lock:
            if message is None or not self._guard.on_echo(message.header.frame_id, now):
                self._unreadable_at = now
                self._complain(caller, 'mhri_guard/echo, {}'.format(version), now)
                self._settle_hold(now)
                return
            self._turns.on_token(self._guard.token, now)
            stopped = self._guard.stop_confirmed
            ours = self._guard.speaker.startswith(self._session)
            if stopped and not ours and self.rule.state != STOPPED:
                self._on_foreign_stop(self.name)
            self._given = message.twist.linear.x, message.twist.angular.z
            self._look_at_guard(now)
            if self._guard.displaced:
                self._begin_session(now)
            # Repeat a stop that another session latched, until it is ours to release.
            if self.rule.sent.is_zero() and (stopped != (self.rule.state == STOPPED)
                                             or stopped and not ours):
                self._send_to_guard(ZERO)

    def _begin_session(self, now):
        """Start a new session: another sender has taken over the guard."""
        self._sessions += 1
        self._guard = GuardLink('{}-{}'.format(self._session, self._sessions))
        self._on_refused('somebody', self.name + '/mhri_guard/command')
        self.send(self.rule.join(now) or ZERO)

    def _hold_reason(self, now):
        """Return why nothing may be sent to the robot: a code, '' for no reason."""
        twins_found = self._twins()
        if twins_found or self._turns.two(now):
            self._complain(listed(twins_found) or 'two guards', 'all are ' + self.name, now)
            return RobotGateMessage.TWO_ROBOTS
        alive = self._guard.alive(now)
        if self.robot_type.guard_behind if alive else self.robot_type.is_behind:
            return RobotGateMessage.UNREACHABLE
        # Behind a guard that is read, whatever else is said there counts for nothing.
        if not alive and now - self._unreadable_at < UNREADABLE_S:
            return RobotGateMessage.GUARD_VERSION
        if not alive or self._publishers[0].links():
            self._unlinked_since = None
        elif self._unlinked_since is None or now - self._unlinked_since < UNLINKED_S:
            self._unlinked_since = self._unlinked_since or now
            return RobotGateMessage.JOINING
        else:
            self._complain(self.name, 'its guard takes no commands', now)
            return RobotGateMessage.GUARD_VERSION
        return RobotGateMessage.NOT_HEARD if self._lost(now) else ''

    def _twins(self):
        """Return the nodes or computers that are this robot each, as a set."""
        if all(ear.get_num_connections() < 2 for ear in self._odometry):
            return set()
        commands = set().union(*self._obeying[1:])
        hosts = peer_hosts(link for links in self._links[1:] for link in links)
        return twins(map(publisher_hosts, self._odometry),
                     {name: host for name, host in hosts.items() if name in commands})

    def _complain(self, who, what, now):
        """Name who cannot be believed or driven, once a second."""
        if now - self._complained_at >= COMPLAIN_S:
            self._complained_at = now
            self._on_refused(who, '/{}: {}'.format(self.name, what))
            rospy.logwarn_throttle(10.0, '{}: {}: {}'.format(self.name, who, what))

    def _settle_hold(self, now):
        """Hold the robot if there is a reason, and let it go on when there is none."""
        reason = self._hold_reason(now)
        if reason:
            self._held_by = reason
        self.send(self.rule.hold(bool(reason), now))

    def _look_at_guard(self, now):
        """Let the robot wait for neutral if its guard has come or gone."""
        guarded = self._guard.alive(now) and bool(self._publishers[0].links())
        if guarded != self._guarded:
            self._guarded = guarded
            self.send(self.rule.join(now) or ZERO)

    def _look_at_listeners(self, now):
        """Do so if those have changed that a command goes to; the others have until the tick."""
        if self._listened is None or self._listened.links() is not self._listeners:
            self._look_at_links(now)

    def _look_at_links(self, now):
        """Let the robot wait for neutral if one of its listeners is new."""
        links = [publisher.links() for publisher in self._publishers]
        if all(map(operator.is_, links, self._links)):
            return
        ids = [listeners(link) for link in links]
        guard = {guard_node(self.name)}
        obeying_now = obeying(self.name, ids[:1]) + obeying(
            self.name, [names - guard for names in ids[1:]])
        known = {id(link) for old in self._links for link in old}
        new = any(id(link) not in known and link.endpoint_id in names
                  for found, names in zip(links[1:], obeying_now[1:]) for link in found)
        self._links, self._obeying = links, obeying_now
        self._listened, self._listeners = next((found for *found, names in zip(
            self._publishers[1:], links[1:], obeying_now[1:])
            if names and found[0].resolved_name not in self._behind), (None, None))
        if new:
            # Killed gates may have told it something before: send a zero.
            self.send(self.rule.join(now) or ZERO)

    def command(self, velocity, now):
        """Pass on what the rule allows of the operator's command."""
        self._look_at_listeners(now)
        self.send(self.rule.on_command(velocity, now))

    def task(self, velocity, now):
        """Pass on what the rule allows of the command of the robot's task."""
        self._look_at_listeners(now)
        self.send(self.rule.on_task(velocity, now))

    def tick(self, now):
        """Let time pass: stale commands, a silent guard, a link lost or back."""
        self.send(self.rule.tick(now))
        if now - self._abandoned_at < arbiter.ZEROS_S:
            self.send(self.rule.on_task(ZERO, now))
        self._look_at_links(now)
        self._look_at_guard(now)
        self.ask_brake(self._brake_asked)
        self._settle_hold(now)
        self._tell_witness(now)
        self._repeat_zero(now)
        self._beat(now)

    def _beat(self, now):
        """Let a guard that would go back alone know that it is heard."""
        if self._guarded and self._guard_state.back_after_s and now - self._beat_at >= BEAT_S:
            self._beat_at = now
            self._heard.publish(String(self._guard.token))

    def leave(self):
        """Tell the guard that this is the end: who is left on purpose does not go back alone."""
        self._heard.publish(String(), urgent=True)

    def _lost(self, now):
        """Tell whether the robot is not heard or its link confirms nothing."""
        heard_at = self._heard_at
        if heard_at is not None:
            connections = sum(ear.get_num_connections() for ear in self._odometry)
            if link_state(now - heard_at, connections, self.robot_type.silent_after_s) in (
                    SILENT, GONE):
                return True
        # Only the robot's own links: losing a mere listener's laptop does no harm.
        return max(publisher.stalled_s(names) for publisher, names
                   in zip(self._publishers, self._obeying)) > LOST_S

    def send(self, velocity):
        """Publish what the rule returned (None: nothing)."""
        if velocity is not None:
            self._publish(velocity)
        self._navigation.end_while(self.rule.checked or self.rule.state == STOPPED, self._clock())

    def _publish(self, velocity):
        if velocity.is_zero():
            self._publish_zero()
            self._send_to_guard(velocity)
        elif self._guarded:
            # A zero must first release a guard that still holds a stop.
            self._send_to_guard(ZERO if self._guard.stop_confirmed else velocity)
        elif self._listened is not None:
            self._listened.publish_packed(
                packed_twist(velocity.linear_mps, velocity.angular_rad_s))

    def _publish_zero(self):
        self._zero_at = self._clock()
        for publisher in self._publishers[1:]:
            publisher.publish_packed(_PACKED_ZERO, urgent=True)

    def _send_to_guard(self, velocity):
        guard = self._publishers[0]
        if not guard.links():
            return
        message = TwistStamped(twist=to_twist(velocity.linear_mps, velocity.angular_rad_s))
        message.header.frame_id = self._guard.next_id(self.rule.state == STOPPED)
        message.header.stamp = rospy.Time.from_sec(time.time())
        guard.publish(message, urgent=velocity.is_zero())

    def unheard(self, now):
        """Return the (topic, type) to which nobody listens though the robot is there, as a list."""
        # The guard reads velocity topics, too, and does not obey them.
        deaf = {guard_node(self.name)}
        there = self._guarded or self._heard_at is not None and now - self._heard_at < LIVE_S
        return [(publisher.resolved_name, publisher.type) for publisher in self._publishers
                if not listeners(publisher.links()) - deaf] if there else []

    def message(self):
        """Return the ``mhri/RobotGate`` of this moment."""
        rule, sent = self.rule, self.rule.sent
        chosen = self._publishers[0] if self._guarded else self._listened
        if self._held_by == RobotGateMessage.UNREACHABLE and rule.stands == HELD:
            chosen = None
        brake, way_m, on_robot = self.brake()
        return RobotGateMessage(
            name=self.name, obeys=rule.obeys,
            stands=self._held_by if rule.stands == HELD else rule.stands,
            also_commanded_by=self.also_commanded_by(self._clock()), limit_raised=self.limit_raised,
            odometry_follows=self.odometry_follows,
            topic=chosen.resolved_name if chosen else '', guarded=self._guarded,
            stop_confirmed=self._guarded and self._guard.stop_confirmed,
            sent=to_twist(sent.linear_mps, sent.angular_rad_s), power=self.power.state,
            round_trip_s=self.round_trip_s, brake=brake, free_way_m=way_m,
            brake_on_robot=on_robot,
            back_after_s=self._guard_state.back_after_s if self._guarded else 0.0)

    def close(self):
        """Unregister everything (blocking: it asks the master); send the last zero before."""
        self.leave()
        self._probe.close()
        self.power.close()
        self._eye.close()
        self._navigation.close()
        self._others.close()
        for publisher in self._publishers + [self._heard]:
            publisher.unregister()
        for subscriber in self._odometry + [self._echo, self._state]:
            unsubscribe(subscriber)
