# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gates node: the only one that speaks to robots. ROS around the rules of driving/.

Interfaces (global names; SI units):

- subscribes ``/robot_controller/twist`` (``geometry_msgs/Twist``), ``/robot_controller/task_twist``
  (``mhri/TeamTwist``) and ``/robot_controller/stop_all`` (``std_msgs/Bool``), all only from the
  mux in force; ``/robot_controller/robot_select`` (``mhri/RobotSelect``) only from the operator in
  control
- publishes ``/gates/state`` (``mhri/GatesState``, latched, on change and at 2 Hz), and for each
  robot the topics of :class:`mhri.driving.ros.robot_gate.RobotGate`
- subscribes ``/tf`` and ``/tf_static`` while the obstacle brake is asked for
- serves ``/gates/take_control`` (``std_srvs/Trigger``) and ``/gates/set_motor_power``
  (``std_srvs/SetBool``: false cuts the motor power of every robot that offers it)

Everything runs on ROS threads and one thread of its own; a single lock guards all of it.
"""
import threading
import time

import rospy
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.base.names import name_problem
from mhri.base.pulse import Neighbour
from mhri.base.robot_types import Limits
from mhri.driving.driven_limits import DrivenLimits
from mhri.driving.gate import common_limits
from mhri.driving.ros.robot_gate import RobotGate
from mhri.driving.ros.roster import Roster
from mhri.driving.ros.wish_topic import wished_settings, WishTopic
from mhri.driving.seat import Caller, ControlSeat, MOST_ROBOTS
from mhri.driving.settings import Settings
from mhri.graph.ros.in_force import InForce, STOP_SERVICE, Strangers, TAKE_SERVICE
from mhri.graph.ros.prompt import hear_promptly
from mhri.graph.ros.rospy_inside import caller_of, link_of, on_publisher_gone
from mhri.msg import DriveSettings, TeamTwist
from mhri.robots.link_quality import link_share
from mhri.robots.ros.convert import from_twist, PlanarTwist
from mhri.robots.ros.tf_feed import TfFeed

TICK_S = 0.05
# How long somebody who was refused is named [s].
REFUSED_S = 30.0
# Who takes control has a moment to be connected as a publisher of the selection [s].
CONNECT_S = 1.0
# Under this name the memory has seat and settings.
KEPT = 'operator'


class Gates:
    """The gates of all robots, fed by the mux and the operator in control.

    :param types: {name: RobotType}
    :param memory: :class:`mhri.graph.ros.stand_by.Memory` of the gates before
    :param settings: :class:`Settings` until an operator sets others; not needed if the memory has
        some
    ``on_change`` is called when ``/gates/state`` may have changed; it must be quick.

    """

    def __init__(self, types, memory, settings, clock=time.monotonic):
        self._clock = clock
        self._memory = memory
        self.on_change = lambda: None
        self._lock = threading.RLock()
        self._wake = threading.Condition(self._lock)
        self._gates = {}
        self._seat = ControlSeat()
        self._wish = WishTopic(self._on_wish, self._on_operator_gone)
        self._settings = settings
        self._driven = DrivenLimits()
        self._kept = None
        self._recall()
        # None: the mux in force has not said it yet.
        self._stop = None
        self._stop_links = []
        self._command = None
        self._share = 1.0
        self._closed = False
        self._session = '{:x}'.format(time.time_ns())
        self._strangers = Strangers(clock)
        self._states = []
        # What moves says nothing of where a laser sits on its robot.
        self._frames = TfFeed(clock)
        self._neighbour = Neighbour('the mux')
        self._mux = InForce(STOP_SERVICE, self._refuse, self._on_new_mux)
        self._roster = Roster(types, self._open, self._close_gate, self._unheard, memory,
                              self._watched, self._on_publishers, self._insiders)

    def start(self):
        """Subscribe, serve, and begin to watch the time; returns at once."""
        nodelay = dict(queue_size=1, tcp_nodelay=True)
        self._mux.start()
        self._roster.start()
        self._wish.start()
        twist = hear_promptly(rospy.Subscriber(
            '/robot_controller/twist', PlanarTwist, self._on_twist, **nodelay))
        on_publisher_gone(twist, self._on_mux_gone)
        rospy.Subscriber('/robot_controller/task_twist', TeamTwist, self._on_task, **nodelay)
        rospy.Subscriber('/robot_controller/stop_all', Bool, self._on_stop, queue_size=10,
                         tcp_nodelay=True)
        rospy.Service(TAKE_SERVICE, Trigger, self._on_take)
        rospy.Service('/gates/set_motor_power', SetBool, self._on_motor_power)
        threading.Thread(target=self._run, name='gates', daemon=True).start()

    def read(self):
        """Return the content of ``/gates/state``, as keyword arguments of the message.

        ``since`` is [s] of this object's clock, None for nobody.
        """
        with self._lock:
            holder, settings = self._seat.holder or Caller(''), self._settings
            return dict(operator=holder.name, since=self._seat.since, computer=holder.computer,
                        leased=self._seat.state == 'leased', mux=self._mux.caller,
                        stop_all=bool(self._stop), together=settings.together, share=self._share,
                        brake=settings.brake, settings=DriveSettings(*settings),
                        refused=self._strangers.words(REFUSED_S),
                        robots=[gate.message() for gate in self._gates.values()])

    def mux_heard(self):
        """Tell whether the mux in force was heard within the last second."""
        return bool(self._mux.caller) and not self._neighbour.silent

    def _refuse(self, caller, topic):
        """Count somebody who is not believed."""
        self._strangers.refuse(caller, topic)
        self.on_change()

    def _each(self, act):
        """Do something with every gate; a failure of one must not keep a zero from the others."""
        for gate in self._gates.values():
            try:
                act(gate)
            except Exception as error:  # the guard of each robot
                rospy.logerr_throttle(1.0, '{}: its gate failed: {!r}'.format(gate.name, error))

    def _on_twist(self, message):
        """Forward; the one path on which every microsecond counts."""
        if not self._mux.believes(message, 'twist'):
            return
        velocity = message.velocity
        with self._lock:
            now = self._clock()
            before, self._command = self._command, velocity
            self._each(lambda gate: gate.command(velocity, now))
            if before is None or before.is_zero() != velocity.is_zero():
                self.on_change()

    def _on_task(self, message):
        """Pass on the commands of tasks; the mux has checked the message."""
        if not self._mux.believes(message, 'task_twist'):
            return
        with self._lock:
            now = self._clock()
            for name, twist in zip(message.robots, message.twists):
                gate = self._gates.get(name)
                if gate is not None:
                    gate.task(from_twist(twist), now)

    def _on_stop(self, message):
        """Engage a stop of the mux; release only a stop that this same mux held and then released.

        A mux restarted together with the master knows nothing about a stop and does not release
        it: it learns of the stop from ``/gates/state`` and engages it as well.
        """
        if not self._mux.believes(message, 'stop_all'):
            return
        with self._lock:
            link = link_of(message)
            self._neighbour.beat(caller_of(message), self._clock())
            if message.data:
                self._stop_links = [link]
                self._set_stop(True)
            elif not self._stop or any(known is link for known in self._stop_links):
                self._set_stop(False)

    def _set_stop(self, stopped):
        if stopped == self._stop:
            return
        now, self._stop = self._clock(), stopped
        self._each(lambda gate: gate.send(gate.rule.stop(stopped, now)))
        for gate in self._gates.values():
            if not stopped and gate.power.is_cut:
                gate.power.restore()
        self._roster.look_now()
        self.on_change()

    def _on_foreign_stop(self, name):
        """Keep a stop of earlier gates that nobody has released since."""
        if not self._stop:
            rospy.logwarn('%s says that stop-all is in force since before this start: it stays so '
                          'until it is released', name)
            self._set_stop(True)

    def _on_new_mux(self, caller):
        """Let every robot wait for neutral: this mux knows nothing of the last one's stick."""
        rospy.loginfo('the mux in force is %s', caller)
        self._everybody_joins()

    def _on_mux_gone(self, caller, _uri):
        """Send every moving robot a zero: the mux in force has ended."""
        if caller == self._mux.caller:
            self._everybody_joins()

    def _everybody_joins(self):
        with self._lock:
            now = self._clock()
            self._each(lambda gate: gate.send(gate.rule.join(now)))
            self.on_change()

    def _recall(self):
        """Take back what the gates before have kept: seat, who was refused, settings, limits."""
        kept = self._memory.recall(KEPT)
        if kept:
            self._seat.restore(kept['seat'], self._clock())
            self._settings = Settings(*kept['settings'])
            self._driven.restore(kept['driven'])

    def _remember(self):
        """Keep it for the next gates, if it has changed."""
        state = self._seat.changes, self._settings, self._driven.kept()
        if state != self._kept:
            self._kept = state
            self._memory.keep(KEPT, {'seat': self._seat.kept(), 'settings': self._settings,
                                     'driven': state[2]})

    def _on_wish(self, caller, message):
        """Take in the operator's wish, which also renews the lease."""
        settings, problem = wished_settings(message)
        names = [name for name in message.robots[:1000] if name_problem(name) is None]
        with self._lock:
            before = self._seat.holder, self._seat.checked, self._settings
            if problem:
                self._refuse(caller.name, 'settings')
            elif not self._seat.on_selection(caller, dict.fromkeys(names), self._clock()):
                self._refuse(caller.name, 'robot_select')
            else:
                self._settings = settings or self._settings
                self._driven.select(names if self._seat.holder == before[0] else ())
            if (self._seat.holder, self._seat.checked, self._settings) != before:
                self._strangers.forget(caller.name)
                self._check()
            self._remember()
        if problem:
            rospy.logwarn_throttle(1.0, 'refused from {}: {}'.format(caller.name, problem))
        if len(message.robots) > MOST_ROBOTS:
            rospy.logwarn_throttle(10.0, '{} selects {} names: no more than {} robots count'.format(
                caller.name, len(message.robots), MOST_ROBOTS))

    def _on_operator_gone(self, caller):
        with self._lock:
            lost = self._seat.on_gone(caller, self._clock())
            self._strangers.forget(caller.name)
            self._check()
            if lost:
                self._everybody_joins()

    def _on_take(self, request):
        """Put the caller in control; every robot gets a zero and waits for neutral."""
        name = caller_of(request)
        caller = self._connected(name)
        if caller is None:
            return TriggerResponse(False, '{} publishes no selection of robots: publish '
                                   '/robot_controller/robot_select, then ask again'.format(name))
        with self._lock:
            self._seat.take(caller, self._clock())
            self._strangers.clear()
            self._check()
            self._everybody_joins()
            self._remember()
        rospy.loginfo('%s has taken control', name)
        return TriggerResponse(True, name + ' is in control now: centre the stick to drive')

    def _connected(self, name):
        """Return the :class:`Caller` of that name once it publishes the selection, else None."""
        until = time.monotonic() + CONNECT_S
        while True:
            found = [caller for caller in self._wish.there() if caller.name == name]
            if found or time.monotonic() >= until:
                return found[-1] if found else None
            time.sleep(TICK_S)

    def _on_motor_power(self, request):
        """Cut the power of all motors at any time; restore it unless a stop is in force."""
        with self._lock:
            if request.data and self._stop:
                return SetBoolResponse(False, 'release the stop first: that restores the power')
            without = [gate.name for gate in self._gates.values() if not gate.power.available]
            for gate in self._gates.values():
                (gate.power.restore if request.data else gate.power.cut)()
            self.on_change()
        words = 'motor power is being ' + ('restored' if request.data else 'cut')
        return SetBoolResponse(True, words + (
            '; not for {}: it cannot be cut there'.format(', '.join(without)) if without else ''))

    def _check(self):
        """Let the gates know which robots are checked now."""
        now, checked = self._clock(), self._seat.checked
        for gate in self._gates.values():
            gate.hold_to(self._driven.of(gate.name, gate.robot_type.limits))
        self._each(lambda gate: gate.send(gate.rule.check(gate.name in checked, now)))
        self._keep_together()
        self._roster.check(checked)
        self.on_change()
        self._wake.notify()

    def _keep_together(self):
        """Give every gate the limits, the share and the brake it must keep to."""
        settings, group = self._settings, [gate for gate in self._gates.values()
                                           if gate.rule.checked]
        # Also here, and not at the mux alone: one that was just started may not know them yet.
        most = Limits(*settings.limits)
        if settings.together and group:
            most = common_limits([most] + [gate.rule.limits for gate in group])
        trips = [gate.round_trip_s for gate in group if gate.round_trip_s == gate.round_trip_s]
        self._share = link_share(max(trips, default=None)) if settings.slow_with_link else 1.0
        for gate in self._gates.values():
            gate.rule.hold_to(most, self._share)
            gate.ask_brake(settings.brake)

    def _open(self, name, robot_type):
        """Open the gate of a robot, replacing the one it had (on the roster's thread)."""
        self._close_gate(name)
        gate = RobotGate(name, robot_type, self._session, self._command, self._lock,
                         self._on_foreign_stop,
                         self._refuse, self._clock, self._frames, self._wake.notify)
        with self._lock:
            now = self._clock()
            if self._closed:
                return
            self._gates[name] = gate
            gate.hold_to(self._driven.of(name, robot_type.limits))
            gate.send(gate.rule.stop(bool(self._stop), now))
            gate.send(gate.rule.check(name in self._seat.checked, now))
            self._keep_together()
            self.on_change()

    def _unheard(self):
        """Return the (topic, type) to which robots that are heard do not listen, as a list."""
        with self._lock:
            return [topic for gate in self._gates.values() for topic in gate.unheard(self._clock())]

    def _watched(self):
        """Return the velocity topics of stopped robots: somebody else may command them."""
        with self._lock:
            return {name: gate.velocity_topics() for name, gate in self._gates.items()} \
                if self._stop else {}

    def _insiders(self):
        """Return {name: the nodes of a generic robot that publish its velocity}."""
        with self._lock:
            return {name: gate.insiders() for name, gate in self._gates.items()
                    if gate.robot_type.name == 'generic'}

    def _on_publishers(self, name, found):
        """Take in who publishes the velocity topics of a robot (on the roster's thread)."""
        gate = self._gates.get(name)
        if gate is not None:
            gate.on_publishers(found)

    def _close_gate(self, name):
        """Close the gate of a robot with a zero (blocking: it asks the master)."""
        with self._lock:
            gate = self._gates.pop(name, None)
            if gate is None:
                return
            gate.send(gate.rule.close(self._clock()))
            self._keep_together()
            self.on_change()
        gate.close()

    def _run(self):
        """Let time pass: 20 times a second, and at the moment when something goes stale."""
        with self._lock:
            while not self._closed:
                now = self._clock()
                try:
                    self._tick(now)
                except Exception as error:  # without this thread no lease would ever end
                    rospy.logerr_throttle(1.0, 'the gates could not look: {!r}'.format(error))
                times = [self._seat.next_tick()] + [gate.next_tick()
                                                    for gate in self._gates.values()]
                due = min([time_s for time_s in times if time_s is not None] + [now + TICK_S])
                self._wake.wait(max(0.0, due - self._clock()))

    def _tick(self, now):
        before = self._seat.state
        self._seat.tick(now, self._wish.there())
        for gate in self._gates.values():
            if gate.rule.checked and not gate.rule.sent.is_zero():
                self._driven.note(gate.name, gate.robot_type.limits)
        self._remember()
        if self._seat.state != before:
            self._check()
            # A robot on a task is not checked, and nobody is there who could stop it.
            self._everybody_joins()
        self._each(lambda gate: gate.tick(now))
        if self._settings.slow_with_link:
            self._keep_together()
        news = self._neighbour.look(now)
        if news:
            self.on_change()
            rospy.logwarn('%s', news)
        states = [(gate.rule.obeys, gate.rule.stands, gate.brake()[0], gate.also_commanded_by(now),
                   gate.odometry_follows)
                  for gate in self._gates.values()]
        if states != self._states:
            self._states = states
            self.on_change()

    def close(self):
        """Close every gate with a zero and forward nothing more. May be called twice."""
        with self._lock:
            self._closed = True
            self._each(lambda gate: gate.send(gate.rule.close(self._clock())))
            self._each(lambda gate: gate.leave())
            self._wake.notify()
