# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gates of all robots in this program: from the one velocity command to each robot.

Everything here runs on ROS threads; the GUI thread only selects, stops and closes.
"""
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool

from mhri.core.gate import GateRule
from mhri.msg import RobotSelect
from mhri.ros.convert import from_twist, to_twist


class Gate:
    """A :class:`GateRule` with the publishers of its robot.

    One publisher for each velocity topic of the template (``geometry_msgs/Twist``, queue of 1:
    newest wins, and a thread of its own, so that a dead robot delays nobody); what is sent goes to
    the first one that has a subscriber.

    :param name: the robot
    :param robot_type: :class:`mhri.core.robot_types.RobotType`
    :param on_sent: called with (robot, topic, message) after each message that left; quick
    """

    def __init__(self, name, robot_type, on_sent=lambda robot, topic, message: None):
        self._on_sent = on_sent
        self.name = name
        self.rule = GateRule(robot_type.limits)
        self.topics = ['/{}/{}'.format(name, topic) for topic in robot_type.command]
        self._publishers = [rospy.Publisher(topic, Twist, queue_size=1, tcp_nodelay=True)
                            for topic in self.topics]
        self._used = None

    def send(self, velocity):
        """Publish what the rule returned (None: nothing)."""
        if velocity is None:
            return
        chosen = next((publisher for publisher in self._publishers
                       if publisher.get_num_connections()), None)
        message = to_twist(velocity.linear_mps, velocity.angular_rad_s)
        if self._used not in (None, chosen):
            self._used.publish(Twist())
        self._used = chosen
        if chosen is not None:
            chosen.publish(message)
            self._on_sent(self.name, chosen.name, message)

    def driven_topic(self):
        """Return the topic that carries something other than zero now, or None."""
        return self._used.name if self.rule.driving and self._used is not None else None

    def reachable(self):
        """Tell whether any velocity topic has a subscriber."""
        return any(publisher.get_num_connections() for publisher in self._publishers)

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

    :param keeper: :class:`mhri.ros.keeper.KeeperLink`
    :param on_stop: called with (stopped, when [s]) on each change of stop-all, on a ROS thread
    """

    def __init__(self, keeper, clock=time.monotonic, on_stop=lambda stopped, when: None):
        self._keeper = keeper
        self._clock = clock
        self._on_stop = on_stop
        self._gates = {}
        self._selected = frozenset()
        self._stopped = False
        self._pressed = False
        self._closed = False
        self._subscribers = []
        self._changed = threading.Condition(threading.RLock())

    def start(self):
        """Subscribe and begin to watch for stale commands."""
        self._subscribers = [
            rospy.Subscriber('/robot_controller/twist', Twist, self._on_twist, queue_size=1,
                             tcp_nodelay=True),
            rospy.Subscriber('/robot_controller/robot_select', RobotSelect,
                             lambda message: self.select(message.robots), queue_size=1,
                             tcp_nodelay=True),
            rospy.Subscriber('/robot_controller/stop_all', Bool, self._on_stop_all, queue_size=10,
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
            self._keeper.open(gate.topics)
            gate.rule.select(gate.name in self._selected, now)
            if self._stopped:
                gate.send(gate.rule.stop('mux', True, now))
            if self._pressed:
                gate.send(gate.rule.stop('panel', True, now))

    def remove(self, name):
        """Close the gate of a robot with a zero; return it, or None where there is none."""
        with self._changed:
            gate = self._gates.pop(name, None)
            if gate is not None:
                gate.send(gate.rule.close(self._clock()))
                self._keeper.close(gate.topics)
            return gate

    def select(self, names):
        """Let exactly these robots through; the others get a zero where they were selected."""
        with self._changed:
            self._selected = frozenset(names)
            now = self._clock()
            for name, gate in self._gates.items():
                gate.send(gate.rule.select(name in self._selected, now))
            self._changed.notify()

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
            self._stop_gates('panel', True, now)
        if newly:
            self._on_stop(True, now)

    def withdraw_press(self):
        """The mux has taken the stop over, or released it: its word alone counts from now on."""
        with self._changed:
            self._pressed = False
            self._stop_gates('panel', False, self._clock())

    def _stop_gates(self, reason, stopped, now):
        for gate in self._gates.values():
            gate.send(gate.rule.stop(reason, stopped, now))

    def _on_twist(self, message):
        """Forward; the one path on which every millisecond counts."""
        velocity = from_twist(message)
        with self._changed:
            now = self._clock()
            for gate in self._gates.values():
                gate.send(gate.rule.on_command(velocity, now))
            self._tell_keeper()
            self._changed.notify()

    def _tell_keeper(self):
        topics = tuple(gate.driven_topic() for gate in self._gates.values())
        self._keeper.drive(tuple(topic for topic in topics if topic))

    def _on_stop_all(self, message):
        with self._changed:
            now = self._clock()
            was = self.stopped
            self._stopped = message.data
            self._stop_gates('mux', message.data, now)
            if message.data:
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
                    gate.send(gate.rule.tick(now))
                self._tell_keeper()
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
                gate.send(gate.rule.close(now))
            self._changed.notify()
        self._keeper.end()

    def unregister(self):
        """Stop listening (blocking: it asks the master)."""
        for subscriber in self._subscribers:
            subscriber.unregister()
