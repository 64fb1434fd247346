# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line to one robot: the connections for the drive's orders and for the robot's feedback."""
import functools
import math
import operator
import time

import genpy
from geometry_msgs.msg import Twist, TwistStamped
import rospy
from std_msgs.msg import String

from mhri.base.limits import ZERO
from mhri.base.names import topic_of
from mhri.base.reasons import NEUTRAL, NO_LISTENER
from mhri.base.views import GONE, SILENT
from mhri.driving.guard_link import GuardLink, GuardState, read_state
from mhri.driving.ros.accessory_line import AccessoryLines
from mhri.driving.ros.brake_eye import BrakeEye
from mhri.driving.ros.motor_power import MotorPower
from mhri.driving.ros.other_drivers import OtherDrivers
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import (
    caller_of, listeners, md5sum_of, peer_hosts, publisher_hosts, publisher_uri, publishers,
    type_of, unsubscribe)
from mhri.msg import AccessoryState, RobotDrive
from mhri.robots.link import link_state
from mhri.robots.listeners import guard_node, obeying, other_commanders
from mhri.robots.ros.convert import from_twist, packed_guard_zero, packed_twist, to_twist
from mhri.robots.ros.link_probe import LinkProbe
from mhri.robots.ros.own_navigation import OwnNavigation
from mhri.robots.ros.streams import HARDWARE_STOP, RobotStreams
from mhri.robots.stop_proof import OdometryWitness
from mhri.robots.twins import GuardTurns, listed, twins

# A link without a confirmation for this long is lost: the robot is held, after one zero behind the
# data still in transit. Before that (from 0.1 s on) only zeros are written into it.
LOST_S = 0.33
# A robot heard within this time is present [s].
LIVE_S = 1.0
# Maximum number of velocity topics of a robot: each costs connections and a registration.
MAX_TOPICS = 8
# Period of the confirmation to a guard that would otherwise drive its robot back [s].
BEAT_S = 0.5
# How often the odometry of a robot is compared with its commands [s].
COMPARE_S = 0.1
# Period of the zeros for a stopped robot that another node commands [s]: 20 Hz, with a margin for
# ticks that come a little early.
ZEROS_S = 0.045
# The zero after another node's message may overtake it on another connection, so it is repeated
# after this time [s].
BEHIND_S = 0.005
# A guard with an unreadable echo within this time is present and must not be bypassed; one that is
# readable but accepts no commands for this long has another version, too [s].
UNREADABLE_S, UNLINKED_S = 1.5, 1.0
COMPLAIN_S = 1.0
_PACKED_ZERO = packed_twist(0.0, 0.0)


def _read_echo(message):
    """Return (echo in the bytes of an ``rospy.AnyMsg``, None if malformed; its version)."""
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


class RobotLine:
    """Sends the drive's orders to one robot, and holds the robot when nothing may be sent.

    Publishes each velocity topic of the robot's type (``geometry_msgs/Twist``) and
    ``/<robot>/mhri_guard/command`` (``geometry_msgs/TwistStamped``); a zero goes to all of them, a
    command to one: the guard's while its echo is alive, else the first one the robot subscribes.
    Subscribes ``/<robot>/mhri_guard/echo`` (``geometry_msgs/TwistStamped``); the odometry, for its
    time of arrival and whether it follows the commands; the topic of its own emergency stop, if its
    type has one; and each velocity topic: a stopped robot that another node may command
    (:class:`mhri.driving.ros.other_drivers.OtherDrivers`) gets zeros at 20 Hz, and one after each
    such message. From a guard with autonomous functions it also subscribes
    ``/<robot>/mhri_guard/state`` (``std_msgs/String``), which it answers on
    ``/<robot>/mhri_guard/heard`` (``std_msgs/String``). For the brake see
    :class:`mhri.driving.ros.brake_eye.BrakeEye`, for the robot's own navigation
    :class:`mhri.robots.ros.own_navigation.OwnNavigation`. Apart from its callbacks it is not
    thread-safe: hold the lock of ``desk``.

    :param name: the robot
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param desk: :class:`mhri.driving.ros.robot_lines.RobotLines`: ``drive``, ``lock``,
        ``carry_out(orders)``, ``on_foreign_stop(name)``, ``on_refused(who, what)``,
        ``undertaker``, ``run``, ``new_session()``, ``safely(name, act)``
    :param frames: :class:`mhri.robots.ros.tf_feed.TfFeed`, None to do without tf
    """

    def __init__(self, name, robot_type, desk, clock, frames=None):
        self.name, self.robot_type, self._desk = name, robot_type, desk
        #: its :class:`mhri.driving.robot_rule.RobotRule`, None until the line is open
        self.rule = None
        self._eye = BrakeEye(name, robot_type, clock, frames)
        #: reduces the operator's command, see :class:`RobotRule`
        self.brake = self._eye.brake.allow
        self._clock = clock
        self._guard_state, self._beat_at = GuardState(), -math.inf
        self._lock, safely = desk.lock, functools.partial(desk.safely, name)
        self._guard = GuardLink(desk.new_session())
        self._guarded, self._heard_at = False, None
        #: round-trip time to a node of the robot [s], NaN if unknown
        self.round_trip_s = math.nan
        watch = desk.undertaker.watch
        self.accessories = AccessoryLines(
            name, robot_type, watch, *map(safely, (self._on_report, self._on_finished)))
        self._publishers = [NonBlockingPublisher(
            '/{}/mhri_guard/command'.format(name), TwistStamped, watch=watch)]
        watch = functools.partial(watch, zero=_PACKED_ZERO, repeats=True)
        self._publishers += [NonBlockingPublisher(topic_of(name, topic), Twist, watch=watch)
                             for topic in robot_type.command[:MAX_TOPICS]]
        self._links = [()] * len(self._publishers)
        self._obeying = [frozenset()] * len(self._publishers)
        # The publisher of the first velocity topic the robot subscribes, and its links.
        self._listened = self._listeners = None
        # Topics behind the robot's own multiplexer: zeros may go there, commands may not.
        self._behind = {topic_of(name, topic) for topic in robot_type.behind}
        self._heard = NonBlockingPublisher('/{}/mhri_guard/heard'.format(name), String)
        self.power = MotorPower(name, robot_type)
        self._streams = RobotStreams(name, robot_type, (HARDWARE_STOP,), clock)
        self._streams.open(HARDWARE_STOP)
        self._navigation = OwnNavigation(name, safely(self._on_abandoned), clock)
        self._witness = OdometryWitness('odometry' not in robot_type.found)
        # The last velocity that the guard has passed on to the robot.
        self._given, self._compared_at = ZERO, -math.inf
        self._zero_at, self._again_at = -math.inf, math.inf
        # {(caller id, topic)} of the nodes registered at the master that can command it.
        self._registered = frozenset()
        self._others = OtherDrivers(safely(self._on_other_motion), clock)
        # Messages of the robot may arrive from here on.
        self._turns, self._claimed = GuardTurns(), set()
        self._unreadable_at, self._unlinked_since = -math.inf, None
        # The node whose last echo was unreadable; if it hangs, it must not be bypassed either.
        self._unreadable = ''
        self._held_by, self._complained_at = '', -math.inf
        self._odometry = [
            rospy.Subscriber(topic_of(name, topic), rospy.AnyMsg, safely(self._on_odometry),
                             queue_size=1, tcp_nodelay=True) for topic in robot_type.odometry]
        # As bytes: rospy would not connect to a guard with another definition of the message.
        self._echo = rospy.Subscriber('/{}/mhri_guard/echo'.format(name), rospy.AnyMsg,
                                      safely(self._on_echo), queue_size=1, tcp_nodelay=True)
        self._state = rospy.Subscriber('/{}/mhri_guard/state'.format(name), String,
                                       safely(self._on_guard_state), queue_size=1,
                                       tcp_nodelay=True)
        self._probe = LinkProbe(name, self._node_uri, self._on_round_trip)
        self._others.listen(publisher.resolved_name for publisher in self._publishers[1:])
        if len(robot_type.command) > MAX_TOPICS:
            rospy.logwarn('%s has %d velocity topics: the first %d are used', name,
                          len(robot_type.command), MAX_TOPICS)

    @property
    def publishers(self):
        """The publishers of the robot's commands, its guard's first."""
        return tuple(self._publishers)

    def _node_uri(self):
        """Return the XML-RPC URI of a node on the robot, or None."""
        return next((uri for uri in map(publisher_uri, self._odometry + [self._echo]) if uri), None)

    def _on_round_trip(self, round_trip_s):
        self.round_trip_s = math.nan if round_trip_s is None else round_trip_s
        with self._lock:
            self._desk.drive.on_round_trip(self.name, self.round_trip_s)

    def _on_report(self, key, value, choice):
        with self._lock:
            self.accessories.on_report(key, value)
            self._desk.drive.on_report(self.name, key, value, choice)
            self._desk.wake()

    def _on_finished(self, key):
        with self._lock:
            self._desk.drive.on_finished(self.name, key)

    def _on_odometry(self, message):
        first, self._heard_at = self._heard_at is None, self._clock()
        self._eye.on_odometry(message, self._heard_at)
        if self._witness.asks(self._heard_at) and self._heard_at - self._compared_at >= COMPARE_S:
            self._compared_at = self._heard_at
            motion = self._eye.motion(message)
            if motion is not None:
                with self._lock:
                    self._witness.on_motion(motion, self._heard_at, self.round_trip_s)
        if first:
            with self._lock:
                self._join(self._heard_at)

    def _join(self, now, zero=False):
        """Make the robot wait for neutral; send a zero in any case if ``zero``."""
        if self.rule is None:
            return
        orders = self._desk.drive.on_joined(self.name, now)
        self._desk.carry_out(orders or ([(self.name, ZERO)] if zero else []))

    def velocity_topics(self):
        """Return (absolute velocity topics, prefixes of other topics that drive the robot).

        A multiplexer on the robot has further inputs next to the one used here.
        """
        topics = [publisher.resolved_name for publisher in self._publishers[1:]]
        inputs = [topic.rpartition('/')[0] + '/' for topic in topics
                  if topic.rpartition('/')[0].endswith('/input')]
        return topics, tuple(inputs + ['/{}/cmd_vel_mux/input/'.format(self.name)])

    def several_readers(self):
        """Return the robot's own nodes that read one velocity topic, if they are several."""
        own = '/{}/'.format(self.name)
        return next((names for names in self._obeying[1:] if len(names) > 1
                     and all(name.startswith(own) for name in names)), frozenset())

    def on_twins(self, found):
        """Handle the nodes that publish the same measurements and read the robot's velocity."""
        self._claimed = found

    def nodes(self):
        """Return the nodes that read the robot's velocity or publish it, except its guard."""
        return frozenset(name for name, _ in self._foreign(self._others.connected())).union(
            *self._obeying[1:])

    def on_publishers(self, found):
        """Handle the registered publishers as {(caller id, topic)} (blocking: calls the master)."""
        self._registered = frozenset(found)
        self._others.listen(sorted({topic for _, topic in self._foreign(found)}))

    def _foreign(self, found):
        """Return the publishers in {(caller id, topic)} that do not just pass on our commands."""
        return found and other_commanders(
            found, {publisher.resolved_name: listeners(links) for publisher, links
                    in zip(self._publishers[1:], self._links[1:])},
            publishers(self._echo) | {rospy.get_name()})

    def _on_other_motion(self, caller, topic):
        """Send a zero right after a command of another node to a stopped robot."""
        with self._lock:
            if self.rule is not None and self.rule.stopped and self._foreign({(caller, topic)}):
                self._publish_zero()
                self._again_at = self._clock() + BEHIND_S
                self._desk.wake()

    def next_tick(self):
        """Return when to call :meth:`tick` next [s], None if it is not urgent."""
        return self._again_at if self._again_at < math.inf else None

    def also_commanded_by(self, now):
        """Return the sorted caller ids of the other nodes that command the robot."""
        names = {name for name, _ in self._foreign(self._others.heard(now))}
        own = rospy.get_name()
        return sorted(names.union(name for name in self._guard_state.also if name != own)
                      if self._guarded else names)

    def _repeat_zero(self, now):
        """Repeat the zero of a stopped robot while another node could command it."""
        if now >= self._again_at:
            self._again_at = math.inf
            if self.rule.stopped:
                self._publish_zero()
        if self.rule.stopped and now - self._zero_at >= ZEROS_S and self._foreign(
                self._others.connected() | self._others.out_of_reach(self._registered)):
            self.send(ZERO)

    def _update_witness(self, now):
        """Pass the robot's command to the witness: zero if its motors are off or unconnected."""
        given = ZERO
        if self._guarded:
            given = self._given
        elif self._listened is not None:
            given = self.rule.sent
        self._witness.on_command(ZERO if self.power.is_cut else given, now)

    def _on_guard_state(self, message):
        self._guard_state = read_state(message.data)

    def _on_abandoned(self):
        """Start sending zeros after the program of a task has died."""
        with self._lock:
            self._desk.carry_out(self._desk.drive.on_abandoned(self.name, self._clock()))

    def _guard_brakes(self):
        return self._guarded and bool(self._guard_state.brake)

    def brake_state(self):
        """Return (brake state, distance to the obstacle that slows it [m], whether on guard)."""
        if not self._guard_brakes():
            return self._eye.brake.state(self._clock()) + (False,)
        return self._guard_state.brake, self._guard_state.free_way_m, True

    def _on_echo(self, message):
        """Handle an echo; repeat a stop or a release that the guard has missed."""
        now = self._clock()
        caller, (message, version) = caller_of(message), _read_echo(message)
        with self._lock:
            if self.rule is None:
                return
            if message is None or not self._guard.on_echo(message.header.frame_id, now):
                self._unreadable_at, self._unreadable = now, caller
                self._complain(caller, 'mhri_guard/echo, {}'.format(version), now)
                self._settle_hold(now)
                return
            if caller == self._unreadable:
                self._unreadable = ''
            self._turns.on_token(self._guard.token, now)
            self._store_final_frames()
            stopped = self._guard.stop_confirmed
            ours = self._guard.speaker.startswith(self._desk.run)
            if stopped and not (self._guard.stop_is_own or self.rule.stopped):
                self._desk.on_foreign_stop(self.name)
            self._given = from_twist(message.twist)
            self._look_at_guard(now)
            if self._guard.displaced:
                self._begin_session(now)
            # Repeat a stop that another session latched, until it is ours to release.
            if self.rule.sent.is_zero() and (stopped != self.rule.stopped or stopped and not ours):
                self._send_to_guard(ZERO)

    def _store_final_frames(self):
        """Store at the undertaker what it sends to the guard if this program ends."""
        words = [packed_guard_zero(self._guard.last_id(stop)) for stop in (self.rule.stopped, True)]
        for link in self._publishers[0].links():
            link.line.store_final_frames(*words)

    def _begin_session(self, now):
        """Start a new session: another sender has taken over the guard."""
        self._guard = GuardLink(self._desk.new_session())
        self._desk.on_refused('somebody', self.name + '/mhri_guard/command')
        self._join(now, zero=True)

    def _hold_reason(self, now):
        """Return the code of why nothing may be sent to the robot, '' if commands may be sent."""
        twins_found = self._twins()
        if twins_found or self._turns.two(now):
            self._complain(listed(twins_found) or 'two guards', 'all are ' + self.name, now)
            return RobotDrive.TWO_ROBOTS
        alive = self._guard.alive(now)
        if self.robot_type.guard_behind if alive else self.robot_type.is_behind:
            return RobotDrive.UNREACHABLE
        # Once the guard's echoes are readable, unreadable ones from other nodes do not count.
        if not alive and (now - self._unreadable_at < UNREADABLE_S
                          or self._unreadable and self._unreadable in publishers(self._echo)):
            return RobotDrive.GUARD_VERSION
        if not alive or self._publishers[0].links():
            self._unlinked_since = None
        elif self._unlinked_since is None or now - self._unlinked_since < UNLINKED_S:
            self._unlinked_since = self._unlinked_since or now
            return RobotDrive.JOINING
        else:
            self._complain(self.name, 'its guard takes no commands', now)
            return RobotDrive.GUARD_VERSION
        if self._lost(now):
            return RobotDrive.NOT_HEARD
        # It would execute commands sent meanwhile as soon as its stop is released.
        if self._streams[HARDWARE_STOP].value_while_connected():
            return RobotDrive.HARDWARE_STOP
        if self.power.is_cut:
            return RobotDrive.POWER_CUT
        return '' if all(publisher.watched(names) for publisher, names
                         in zip(self._publishers, self._obeying)) else RobotDrive.UNWATCHED

    def _twins(self):
        """Return the nodes or computers that each claim to be this robot, as a set."""
        if all(ear.get_num_connections() < 2 for ear in self._odometry):
            found = self._claimed and self._claimed & self.several_readers()
            return found if len(found) > 1 else set()
        commands = set().union(*self._obeying[1:])
        hosts = peer_hosts(link for links in self._links[1:] for link in links)
        return twins(map(publisher_hosts, self._odometry),
                     {name: host for name, host in hosts.items() if name in commands})

    def _complain(self, who, what, now):
        """Report a robot or node that cannot be trusted or driven, once a second."""
        if now - self._complained_at >= COMPLAIN_S:
            self._complained_at = now
            self._desk.on_refused(who, '/{}: {}'.format(self.name, what))
            rospy.logwarn_throttle(10.0, '{}: {}: {}'.format(self.name, who, what))

    def _settle_hold(self, now):
        """Hold the robot while there is a reason, and resume after it."""
        self._held_by = self._hold_reason(now)
        if self._held_by != self.rule.held_by:
            self._desk.carry_out(self._desk.drive.on_held(self.name, self._held_by, now))

    def _look_at_guard(self, now):
        """Make the robot wait for neutral if its guard has connected or gone."""
        guarded = self._guard.alive(now) and bool(self._publishers[0].links())
        if guarded != self._guarded:
            self._guarded = guarded
            self._join(now, zero=True)

    def look_at_listeners(self, now):
        """Check the links if the receivers of commands have changed; others wait for the tick."""
        if self._listened is None or self._listened.links() is not self._listeners:
            self._look_at_links(now)

    def _look_at_links(self, now):
        """Make the robot wait for neutral if one of its subscribers is new."""
        links = [publisher.links() for publisher in self._publishers]
        if all(map(operator.is_, links, self._links)):
            return
        ids = [listeners(link) for link in links]
        guard = {guard_node(self.name)}
        obeying_now = obeying(self.name, ids[:1]) + obeying(
            self.name, [names - guard for names in ids[1:]],
            [publisher.resolved_name in self._behind for publisher in self._publishers[1:]])
        known = {id(link) for old in self._links for link in old}
        new = any(id(link) not in known and link.endpoint_id in names
                  for found, names in zip(links[1:], obeying_now[1:]) for link in found)
        self._links, self._obeying = links, obeying_now
        self._listened, self._listeners = next((found for *found, names in zip(
            self._publishers[1:], links[1:], obeying_now[1:])
            if names and found[0].resolved_name not in self._behind), (None, None))
        if new:
            # A killed drive may have sent it a command before: send a zero.
            self._join(now, zero=True)

    def tick(self, now):
        """Handle the passage of time: silent guards, lost and restored links, other commanders."""
        self._look_at_links(now)
        self._look_at_guard(now)
        self._settle_hold(now)
        self._update_witness(now)
        self._repeat_zero(now)
        self._beat(now)
        self.follow(now)

    def follow(self, now):
        """Switch the robot's brake and its own navigation by its commander."""
        self._eye.switch(self._desk.drive.settings.brake and self.rule.selected
                         and not self._guard_brakes())
        self._navigation.tick(self.rule.selected or self.rule.stopped, now)

    def on_task(self, caller, named, now):
        """Handle the commands of a program of tasks; ``named``: whether they name this robot."""
        self._navigation.on_task(caller, named, now)

    def _beat(self, now):
        """Confirm to a guard that would otherwise drive its robot back that the drive is alive."""
        if self._guarded and self._guard_state.back_after_s and now - self._beat_at >= BEAT_S:
            self._beat_at = now
            self._heard.publish(String(self._guard.token))

    def leave(self):
        """Announce the end of the drive to the guard, so that it does not drive the robot back."""
        self._heard.publish(String(), urgent=True)

    def _lost(self, now):
        """Return whether the robot is silent or its link has stalled."""
        heard_at = self._heard_at
        if heard_at is not None:
            connections = sum(ear.get_num_connections() for ear in self._odometry)
            if link_state(now - heard_at, connections, self.robot_type.silent_after_s) in (
                    SILENT, GONE):
                return True
        # Only the robot's own links: the loss of another subscriber does no harm.
        return max(publisher.stalled_s(names) for publisher, names
                   in zip(self._publishers, self._obeying)) > LOST_S

    def send(self, velocity):
        """Publish a velocity ordered by the drive."""
        if velocity.is_zero():
            self._publish_zero()
            self._send_to_guard(velocity)
        elif self._guarded:
            # A zero must first release a guard that still holds a stop.
            self._send_to_guard(ZERO if self._guard.stop_confirmed else velocity)
        elif self._listened is not None:
            self._listened.publish_packed(packed_twist(*velocity))

    def _publish_zero(self):
        self._zero_at = self._clock()
        for publisher in self._publishers[1:]:
            publisher.publish_packed(_PACKED_ZERO, urgent=True)

    def _send_to_guard(self, velocity):
        guard = self._publishers[0]
        if not guard.links():
            return
        message = TwistStamped(twist=to_twist(*velocity))
        message.header.frame_id = self._guard.next_id(self.rule is not None and self.rule.stopped)
        message.header.stamp = rospy.Time.from_sec(time.time())
        guard.publish(message, urgent=velocity.is_zero())

    def unheard(self, now):
        """Return (topic, type) of each topic without a subscriber while the robot is present."""
        # The guard subscribes velocity topics, too, but does not obey them.
        guard = {guard_node(self.name)}
        there = self._guarded or self._heard_at is not None and now - self._heard_at < LIVE_S
        return [(publisher.resolved_name, publisher.type) for publisher, deaf in (
            (self._publishers[0], set()), (self._navigation.cancel, set()),
            *((velocity, guard) for velocity in self._publishers[1:]))
                if not listeners(publisher.links()) - deaf] if there else []

    def message(self):
        """Return the current ``mhri/RobotDrive``."""
        rule, stands = self.rule, self._desk.drive.stop_reason(self.name)
        chosen = self._publishers[0] if self._guarded else self._listened
        if stands == RobotDrive.UNREACHABLE:
            chosen = None
        brake, way_m, on_robot = self.brake_state()
        return RobotDrive(
            name=self.name, selected=self.name in self._desk.drive.lease.chosen, obeys=rule.obeys,
            stands=stands,
            also_commanded_by=self.also_commanded_by(self._clock()),
            odometry_follows=self._witness.follows, topic=chosen.resolved_name if chosen else '',
            guarded=self._guarded, stop_confirmed=self._guarded and self._guard.stop_confirmed,
            holonomic=rule.limits.holonomic, sent=to_twist(*rule.sent), power=self.power.state,
            round_trip_s=self.round_trip_s, brake=brake, free_way_m=way_m, brake_on_robot=on_robot,
            back_after_s=self._guard_state.back_after_s if self._guarded else 0.0,
            accessories=[self._accessory_state(key, accessory) for key, accessory
                         in self._desk.drive.accessories.of(self.name).items()])

    def _accessory_state(self, key, accessory):
        """Return the ``mhri/AccessoryState`` of an :class:`AccessoryRule`."""
        line = self.accessories.stands(key)
        stands = line if line == NO_LISTENER else (
            self._desk.drive.accessories.stands(self.name, key)
            or (NEUTRAL if accessory.waits(self._clock()) else line))
        return AccessoryState(key, accessory.known, accessory.choice, list(accessory.value), stands)

    def facts(self):
        """Return the values whose change is a change of the drive's state."""
        return (self.rule.obeys, self.rule.stop_reason, self.rule.sent.is_zero(),
                self.brake_state()[0], self.also_commanded_by(self._clock()),
                self._witness.follows, self._guarded, self._guard.stop_confirmed, self.power.state)

    def end(self):
        """Unregister all but the robot's commands (blocking); send the last zero first."""
        self.leave()
        self._probe.close()
        self.power.close()
        self.accessories.close()
        self._streams.close()
        self._eye.close()
        self._navigation.end()
        self._others.close()
        for subscriber in self._odometry + [self._echo, self._state]:
            unsubscribe(subscriber)

    def close(self):
        """Unregister the robot's commands (blocking: calls the master), after :meth:`end`."""
        for publisher in self._publishers + [self._navigation.cancel, self._heard]:
            publisher.unregister()
