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

from mhri.core.driving.gate import common_limits
from mhri.core.driving.limits import ZERO
from mhri.msg import RobotSelect
from mhri.ros.convert import from_twist


def _nobody(*_words):
    """There is no other process to tell."""


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

        :param tell: called with the words of :mod:`mhri.ros.driving.keeper`, under the lock; quick
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
        """Announce a robot's gate, and that of the other process where that does not lead."""
        with self._changed:
            gate = self._gates.get(name)
            if gate is not None and not gate.follows:
                self._tell('announce', name)
        if gate is not None:
            gate.announce()

    def speak_for(self, name):
        """Let the gate of one robot speak, which the other one cannot reach.

        It says zero, and nothing more while the robot is not heard (:meth:`hold`).
        """
        with self._changed:
            gate = self._gates.get(name)
            if gate is not None:
                gate.lead()
                self._lose(gate)

    def drop_cut(self):
        """Drop the connections of links that are cut, and hold their robots; return the names."""
        with self._changed:
            lost = [gate for gate in self._gates.values() if gate.drop_cut()]
            for gate in lost:
                self._lose(gate)
            return [gate.name for gate in lost]

    def _lose(self, gate):
        """Hold a robot of which the connection was dropped."""
        now = gate.lost_at = self._clock()
        self._tell('held', gate.name, True)
        gate.send(gate.rule.hold(True, now) or ZERO, now)

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
