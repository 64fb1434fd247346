# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gates of all robots in this program: from the one velocity command to each robot.

Everything here runs on ROS threads; the GUI thread only selects, stops and closes.
"""
import threading
import time

from geometry_msgs.msg import Twist, TwistStamped
import rospy
from std_msgs.msg import Bool

from mhri.core.gate import GateRule, common_limits
from mhri.core.limits import ZERO
from mhri.core.names import topic_of
from mhri.msg import RobotSelect
from mhri.ros.convert import from_twist, to_twist
from mhri.ros.master_api import MasterApi, MasterError
from mhri.ros.prompt import PromptPublisher

# Below a robot's namespace: where its guard (utils/remote/mhri_guard) listens.
GUARD = 'mhri_guard/command'
# A gate that takes over says a zero again that is not older than this.
REPEAT_ZERO_S = 1.0


def _nobody(*_words):
    """There is no other process to tell."""


class Gate:
    """A :class:`GateRule` with the publishers of its robot.

    One publisher for each velocity topic of the template (``geometry_msgs/Twist``, queue of 1:
    newest wins, and nothing is waited for: a dead robot delays nobody); what is sent goes to the
    first one that has a subscriber. Before them all comes the guard that may run on the robot
    (``/<robot>/mhri_guard/command``, ``geometry_msgs/TwistStamped``, stamped by the clock here).

    There may be two of a robot, in two processes (:mod:`mhri.ros.keeper`). One of them leads; the
    other one ``follows``: it decides the same and keeps its words to itself.

    :param name: the robot
    :param topics: absolute names of its velocity topics, in order of preference
    :param limits: :class:`mhri.core.robot_types.Limits`
    :param on_sent: called with (robot, topic, message) after each message; quick
    """

    def __init__(self, name, topics, limits, on_sent=lambda robot, topic, message: None):
        self._on_sent = on_sent
        self.name = name
        self.topics = list(topics)
        self.rule = GateRule(limits)
        self._guard = PromptPublisher('/{}/{}'.format(name, GUARD), TwistStamped)
        self._publishers = [self._guard] + [
            PromptPublisher(topic, Twist) for topic in self.topics]
        self._used = None
        self.follows = False
        self._zero_at = None

    @classmethod
    def of_type(cls, name, robot_type, on_sent=lambda robot, topic, message: None):
        """Return the gate of a robot of a type (:class:`mhri.core.robot_types.RobotType`)."""
        topics = [topic_of(name, topic) for topic in robot_type.command]
        return cls(name, topics, robot_type.limits, on_sent)

    def send(self, velocity, now):
        """Publish what the rule returned (None: nothing)."""
        if velocity is None:
            return
        chosen = next((publisher for publisher in self._publishers
                       if publisher.get_num_connections()), None)
        if self._used not in (None, chosen):
            self._publish(self._used, ZERO)
        self._used = chosen
        self._zero_at = now if velocity.is_zero() else None
        if chosen is not None:
            self._on_sent(self.name, chosen.name, self._publish(chosen, velocity))

    def _publish(self, publisher, velocity):
        """Publish, unless the other gate speaks; return the message."""
        message = to_twist(velocity.linear_mps, velocity.angular_rad_s)
        if publisher is self._guard:
            message = TwistStamped(twist=message)
            message.header.stamp = rospy.Time.from_sec(time.time())
        if not self.follows:
            publish = publisher.publish_urgent if velocity.is_zero() else publisher.publish
            publish(message)
        return message

    def follow(self):
        """From now on the other gate of this robot speaks."""
        self.follows = True

    def lead(self):
        """Speak from now on."""
        self.follows = False

    def drop_backlog(self):
        """Take back what a stalled link has not delivered; tell whether there was such a link.

        This gate does not reach the robot any more then, and leaves it to the other one. A guard
        is left what it has: it knows what is late.
        """
        dropped = sum(publisher.drop_stalled() for publisher in self._publishers
                      if publisher is not self._guard)
        if dropped:
            self.follow()
        return dropped > 0

    def take_over(self, now):
        """Speak again: the other gate has ended, and may have taken its last zero with it."""
        if self.follows:
            self.lead()
            if self._zero_at is not None and now - self._zero_at < REPEAT_ZERO_S:
                self.send(ZERO, self._zero_at)

    def reachable(self):
        """Tell whether any velocity topic has a subscriber."""
        return any(publisher.get_num_connections() for publisher in self._publishers)

    def guarded(self):
        """Tell whether the commands go through a guard on the robot."""
        return self._guard.get_num_connections() > 0

    def announce(self):
        """Tell the master of the velocity topics once more, where nobody listens (blocking).

        It tells a robot of a new publisher once. One that was out of reach then would never know.
        """
        if self.reachable():
            return
        own = rospy.get_node_uri()
        try:
            MasterApi(rospy.get_name()).call_many(
                [('registerPublisher', publisher.resolved_name, publisher.type, own)
                 for publisher in self._publishers])
        except MasterError as error:
            rospy.logdebug('%s: its topics cannot be announced now: %s', self.name, error)

    def unregister(self):
        """Give the topics back (blocking: it asks the master); others may look all the while."""
        publishers, self._publishers = self._publishers, []
        self._used = None
        for publisher in publishers:
            publisher.unregister()


class GateBank:
    """Feeds the gates; one subscriber of each kind for all of them.

    Subscribes ``/robot_controller/twist`` (``geometry_msgs/Twist``),
    ``/robot_controller/robot_select`` (``mhri/RobotSelect``) and ``/robot_controller/stop_all``
    (``std_msgs/Bool``).

    :param on_stop: called with (stopped, when [s]) on each change of stop-all, on a ROS thread
    """

    def __init__(self, clock=time.monotonic, on_stop=lambda stopped, when: None):
        self._clock = clock
        self._on_stop = on_stop
        self._gates = {}
        self._selected = frozenset()
        self._stopped = False
        self._pressed = False
        self._together = False
        self._share = 1.0
        self._closed = False
        self._subscribers = []
        self._tell = _nobody
        self._changed = threading.Condition(threading.RLock())

    def start(self, hear_selection=True):
        """Subscribe and begin to watch for stale commands.

        :param hear_selection: False where somebody else tells by :meth:`select`: in two ways at
            once an old word could overtake a new one
        """
        if hear_selection:
            self._subscribers.append(rospy.Subscriber(
                '/robot_controller/robot_select', RobotSelect,
                lambda message: self.select(message.robots), queue_size=1, tcp_nodelay=True))
        self._subscribers += [
            rospy.Subscriber('/robot_controller/twist', Twist, self._on_twist, queue_size=1,
                             tcp_nodelay=True),
            rospy.Subscriber('/robot_controller/stop_all', Bool,
                             lambda message: self.hear_stop(message.data), queue_size=10,
                             tcp_nodelay=True)]
        threading.Thread(target=self._run, name='gates', daemon=True).start()

    @property
    def stopped(self):
        """Whether everything is stopped: by the mux, or by a press not yet confirmed by it."""
        return self._stopped or self._pressed

    @property
    def stop_confirmed(self):
        """Whether the mux has stop-all in force."""
        return self._stopped

    def add(self, gate):
        """Take a robot in; it obeys the present selection and stop."""
        with self._changed:
            now = self._clock()
            self._gates[gate.name] = gate
            gate.rule.select(gate.name in self._selected, now)
            if self._stopped:
                gate.send(gate.rule.stop('mux', True, now), now)
            if self._pressed:
                gate.send(gate.rule.stop('panel', True, now), now)
            self._tell_of(gate)
            self._keep_together()

    def remove(self, name):
        """Close the gate of a robot with a zero; return it, or None where there is none."""
        with self._changed:
            gate = self._gates.pop(name, None)
            self._tell('close', name)
            if gate is not None:
                now = self._clock()
                gate.send(gate.rule.close(now), now)
            self._keep_together()
            return gate

    def gates(self):
        """Return the gates of all robots."""
        with self._changed:
            return tuple(self._gates.values())

    def meet(self, tell):
        """Tell another process all that its gates have to know, now and from now on.

        :param tell: called with the words of :mod:`mhri.ros.keeper`, under the lock; quick
        """
        with self._changed:
            self._tell = tell
            tell('select', sorted(self._selected))
            tell('press' if self._pressed else 'withdraw')
            tell('pace', self._together, self._share)
            for gate in self._gates.values():
                self._tell_of(gate)

    def _tell_of(self, gate):
        limits = gate.rule.limits
        self._tell('open', gate.name, gate.topics, limits.linear_mps, limits.angular_rad_s)
        self._tell('held', gate.name, gate.rule.held)

    def follow(self, name):
        """Let the gate of a robot, where there is one, follow that of another process."""
        with self._changed:
            if name in self._gates:
                self._gates[name].follow()

    def announce(self, name):
        """See :meth:`Gate.announce`: here, and in the other process where that does not lead."""
        with self._changed:
            gate = self._gates.get(name)
            if gate is not None and not gate.follows:
                self._tell('announce', name)
        if gate is not None:
            gate.announce()

    def speak_for(self, name):
        """Let the gate of one robot speak, and say zero first: the other one cannot reach it."""
        with self._changed:
            gate = self._gates.get(name)
            if gate is not None:
                gate.lead()
                gate.send(ZERO, self._clock())

    def take_over(self):
        """Let all gates speak for themselves: the other process has ended."""
        with self._changed:
            self._tell = _nobody
            now = self._clock()
            for gate in self._gates.values():
                gate.take_over(now)

    def select(self, names):
        """Let exactly these robots through; the others get a zero where they were selected."""
        with self._changed:
            self._selected = frozenset(names)
            self._tell('select', sorted(self._selected))
            now = self._clock()
            for name, gate in self._gates.items():
                gate.send(gate.rule.select(name in self._selected, now), now)
            self._keep_together()
            self._changed.notify()

    def set_pace(self, together, share):
        """Set how the robots of the selection keep to each other, from the next command on.

        :param together: all are held to what the slowest of them can do, each along the same curve;
            otherwise each does its best
        :param share: how much of every command is passed on, in (0, 1]
        """
        with self._changed:
            if (together, share) != (self._together, self._share):
                self._together, self._share = together, share
                self._tell('pace', together, share)
                self._keep_together()

    def _keep_together(self):
        """Give every gate the limits it has to keep to."""
        group = [gate.rule.limits for name, gate in self._gates.items() if name in self._selected]
        common = common_limits(group) if self._together and group else None
        for gate in self._gates.values():
            gate.rule.hold_to(common or gate.rule.limits, self._share)

    def hold(self, name, held):
        """Send nothing to a robot while it is not heard; the others go on."""
        with self._changed:
            gate = self._gates.get(name)
            if gate is not None:
                self._tell('held', name, held)
                now = self._clock()
                gate.send(gate.rule.hold(held, now), now)
                self._changed.notify()

    def drop_backlog(self, name):
        """See :meth:`Gate.drop_backlog`; False where there is no such robot."""
        with self._changed:
            gate = self._gates.get(name)
            return gate is not None and gate.drop_backlog()

    def deselect_others(self, names):
        """Close the gates of all but these robots; opening is the word of robot_select alone."""
        with self._changed:
            self.select(self._selected & frozenset(names))

    def press_stop(self):
        """Stop every robot now, without waiting for the mux to say so."""
        with self._changed:
            now = self._clock()
            newly = not self.stopped
            self._pressed = True
            self._tell('press')
            self._stop_gates('panel', True, now)
        if newly:
            self._on_stop(True, now)

    def withdraw_press(self):
        """The mux has taken the stop over, or released it: its word alone counts from now on."""
        with self._changed:
            self._pressed = False
            self._tell('withdraw')
            self._stop_gates('panel', False, self._clock())

    def _stop_gates(self, reason, stopped, now):
        for gate in self._gates.values():
            gate.send(gate.rule.stop(reason, stopped, now), now)

    def _on_twist(self, message):
        """Forward; the one path on which every millisecond counts."""
        velocity = from_twist(message)
        with self._changed:
            now = self._clock()
            for gate in self._gates.values():
                gate.send(gate.rule.on_command(velocity, now), now)
            self._changed.notify()

    def hear_stop(self, stopped):
        """Take in the word of the mux on stop-all."""
        with self._changed:
            now = self._clock()
            was = self.stopped
            self._stopped = stopped
            self._stop_gates('mux', stopped, now)
            if stopped:
                self.withdraw_press()
            newly = self.stopped != was
        if newly:
            self._on_stop(self.stopped, now)

    def _run(self):
        """Send the zeros of stale commands."""
        with self._changed:
            while not self._closed:
                now = self._clock()
                for gate in self._gates.values():
                    gate.send(gate.rule.tick(now), now)
                times = [time_s for time_s in (gate.rule.next_tick()
                                               for gate in self._gates.values())
                         if time_s is not None]
                self._changed.wait(max(0.0, min(times) - self._clock()) if times else None)

    def close(self):
        """Close every gate with a zero; nothing is forwarded any more."""
        with self._changed:
            self._closed = True
            now = self._clock()
            for gate in self._gates.values():
                gate.send(gate.rule.close(now), now)
            self._changed.notify()

    def unregister(self):
        """Stop listening (blocking: it asks the master)."""
        for subscriber in self._subscribers:
            subscriber.unregister()
