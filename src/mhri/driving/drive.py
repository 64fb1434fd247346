# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All decisions on motion: one object, without ROS, a clock or a thread.

Its inputs are events and time, its outputs velocities for robots and one state. It combines
independent rules: which source drives (:mod:`mhri.driving.arbiter`), who is in control
(:mod:`mhri.driving.operator_lease`), whose messages count (:mod:`mhri.driving.topic_owner`), what
tasks may do (:mod:`mhri.driving.task_relay`), and what each robot obeys
(:mod:`mhri.driving.robot_rule`).

Every event returns the resulting orders: (robot, :class:`Velocity`) to send at once, in this order.
An event that can be refused also returns a sentence with the reason, '' for none. Times are seconds
of a monotonic clock that also counts while the computer is suspended.
"""
from functools import partial
import math
from typing import (
    AbstractSet, Any, Callable, Dict, FrozenSet, Iterable, List, Mapping, Optional, Sequence, Tuple,
    Union)

from mhri.base.accessories import Accessory, Act
from mhri.base.limits import Velocity, ZERO
from mhri.base.reasons import LIMIT_RAISED, NO_LEASE, UNDERTAKER
from mhri.base.robot_types import common_limits, Limits
from mhri.base.sleep_detector import SleepDetector
from mhri.devices.profile import JoyRefused, STOP_ALL
from mhri.driving.accessories import Accessories, Authority
from mhri.driving.arbiter import Arbiter, DRIVING, Read, READY
from mhri.driving.buttons import ButtonEdges
from mhri.driving.driven_limits import DrivenLimits
from mhri.driving.operator_lease import Caller, LAPSED, LEASED, MAX_ROBOTS, OperatorLease
from mhri.driving.robot_rule import Brake, OPERATOR, RobotRule, TASK
from mhri.driving.settings import Settings, settings_problem, SettingsInForce
from mhri.driving.sources import MuxConfig, Source
from mhri.driving.stopped_alone import StoppedAlone
from mhri.driving.task_relay import NOTHING, PASS_ZEROS, TaskRelay
from mhri.driving.topic_owner import TopicOwner
from mhri.robots.link_quality import link_share

#: (robot, velocity or act of an accessory to send to it now)
Order = Tuple[str, Union[Velocity, Act]]
Orders = List[Order]
# Maximum time between two ticks [s], short enough to detect a suspension of the process.
LOOK_S = 0.05
LOST: Dict[str, Any] = {'stop': True, 'forgotten': True}  #: the state if the previous one is lost
# A refused wish is counted under one of these.
SELECT, SETTINGS, ACCESSORY = 'robot_select', 'settings', 'accessory'


class Drive:
    """Decides which velocity every robot is sent.

    :param config: :class:`mhri.driving.sources.MuxConfig`
    :param now: the time of creation [s]
    :param kept: the result of :meth:`kept` of the previous drive, None without one
    :param on_refused: called with (caller id, input) for every refused caller
    :param connected: maps the name of a source to the nodes connected as its publishers
    """

    def __init__(self, config: MuxConfig, now: float, kept: Optional[Mapping[str, Any]] = None,
                 on_refused: Callable[[str, str], None] = lambda caller, what: None,
                 connected: Callable[[str], AbstractSet[str]] = lambda source: frozenset()
                 ) -> None:
        self.arbiter = Arbiter(config, now)
        self._sources = {source.name: source for source in config.sources}
        self._owners = {source.name: TopicOwner() for source in config.sources}
        self._pulse = SleepDetector(now)
        #: the :class:`OperatorLease`; read only
        self.lease = OperatorLease()
        self._driven = DrivenLimits()
        self.relay = TaskRelay()
        self._buttons = ButtonEdges()
        self._on_refused = on_refused
        self._connected = connected
        self._settings = SettingsInForce(Settings(config.linear_mps, config.angular_rad_s))
        self._rules: Dict[str, RobotRule] = {}
        #: the :class:`Accessories` of all robots; read only
        self.accessories = Accessories(self._rules, self._authority)
        self._type_limits: Dict[str, Limits] = {}
        self._round_trips: Dict[str, float] = {}
        self._alone = StoppedAlone()
        self._command: Optional[Velocity] = None
        self._wished_mode: Tuple[Optional[Caller], str] = None, ''
        self._closed, self._undertaken = False, True
        self._orders: Orders = []
        #: the command just passed on, for the mirror; its reader clears it
        self.said: Optional[Velocity] = None
        #: panel actions of the pressed buttons; their reader clears them
        self.asked: List[str] = []
        #: fraction of each command that is passed on, in (0, 1]
        self.share = 1.0
        #: wishes accepted since the start
        self.wishes = 0
        #: counts the changes of what robots obey, who is in control, or which settings are in force
        self.changes = 0
        if kept:
            self._restore(kept, now)

    # Current state.

    @property
    def stop_all(self) -> bool:
        """Whether stop-all is in force."""
        return self.arbiter.stop_all

    @property
    def mode(self) -> str:
        """Name of the active source."""
        return self.arbiter.mode

    @property
    def source(self) -> Source:
        """The active :class:`mhri.driving.sources.Source`."""
        return self.arbiter.source

    @property
    def settings(self) -> Settings:
        """The :class:`Settings` in force."""
        return self._settings.in_force

    @property
    def command(self) -> Velocity:
        """The operator's current command."""
        return self._command or ZERO

    @property
    def alone(self) -> FrozenSet[str]:
        """The robots that were stopped alone."""
        return self._alone.names

    @property
    def robots(self) -> Mapping[str, RobotRule]:
        """{name: :class:`RobotRule`} of every known robot; read only."""
        return self._rules

    def stop_reason(self, name: str) -> str:
        """Return why a robot is stopped or limited: a code of the reasons, '' for none."""
        rule = self._rules[name]
        if rule.stop_reason:
            return rule.stop_reason
        if self.lease.state == LAPSED and name in self.lease.chosen:
            return NO_LEASE
        return LIMIT_RAISED if rule.limits != self._type_limits[name] else ''

    def owner(self, source: str) -> Optional[str]:
        """Return the accepted publisher of a source, None before the first message."""
        return self._owners[source].owner

    # The operator's input.

    def on_source(self, name: str, caller: str, device: object, read: Read,
                  now: float, pressed: AbstractSet[str] = frozenset(), enables: bool = False,
                  lost: bool = False) -> Tuple[Orders, str]:
        """Handle one message of a source.

        A stop counts from every source, even an inactive one; any other button only from the
        active source.

        :param caller: the node that published it
        :param device: identifies the device and its connection
        :param read: returns the command in the message, with sideways motion or without; called
            only if needed
        :param pressed: actions whose buttons are down
        :param enables: whether its first button is pressed, for the enabling pedal
        :param lost: whether the message reports that its device is gone
        """
        counts = self._awake(now) and self._admits(name, caller)
        newly = self._buttons.newly(name, device, pressed)
        if STOP_ALL in newly:
            self._stop(now)
        if counts:
            if name == self.mode:
                self.asked.extend(sorted(newly - {STOP_ALL}))
            before = self.mode
            try:
                self._pass_on(self.arbiter.on_message(name, device, now, read, enables), now)
            except JoyRefused as refusal:
                return self._done(), str(refusal)
            if lost and name == self.mode:
                self._pass_on(self.arbiter.on_hold('lost', now), now)
            self.changes += self.mode != before
        return self._done(), ''

    def _admits(self, name: str, caller: str) -> bool:
        """Return whether a publisher's messages count; those of a second publisher do not."""
        if self._owners[name].admits(caller, partial(self._connected, name)):
            return True
        self._on_refused(caller, self._sources[name].topic)
        return False

    def on_lost(self, name: str, cause: str, now: float) -> Orders:
        """Handle the suspension of a source, or the loss of its publisher."""
        # A source that may be silent at rest must not count as resting once it is gone.
        if self._sources[name].rests or self.arbiter.state in (READY, DRIVING):
            self._pass_on(self.arbiter.on_lost(name, cause, now), now)
        return self._done()

    def on_hold(self, cause: str, now: float) -> Orders:
        """Stop the driven robots and require neutral, e.g. when the master is lost."""
        self._pass_on(self.arbiter.on_hold(cause, now), now)
        return self._done()

    def on_mode(self, caller: str, name: str, now: float,
                trusted: bool = False) -> Tuple[Orders, str]:
        """Handle a request for another source; if an operator is in control, only from it.

        :param trusted: whether it comes from one of mhri's own input nodes, e.g. "use pedal"
        """
        if not (trusted or self.lease.operator in ('', caller)):
            self._on_refused(caller, '/mux_in/mode_select')
            return self._done(), '{} is in control'.format(self.lease.operator)
        problem = self._choose(name, now)
        return self._done(), problem

    def _choose(self, name: str, now: float) -> str:
        """Change the mode; return the problem, '' for none."""
        before = self.mode
        try:
            self._pass_on(self.arbiter.on_mode(name, now), now)
        except KeyError:
            return 'no source {!r}: the mode stays {!r}. Sources are rows of mux.yaml'.format(
                name, before)
        self.changes += self.mode != before
        return ''

    # Who is in control.

    def on_wish(self, caller: Caller, robots: Sequence[str], settings: Sequence[Settings],
                mode: str, now: float) -> Tuple[Orders, str]:
        """Handle the operator's whole wish, which also renews the lease.

        :param robots: names of the selected robots, each once
        :param settings: none keeps those in force, one replaces them; more, or any out of range,
            is refused
        :param mode: '' keeps the mode; it has an effect only when it changes
        """
        problem = settings_problem(settings)
        if problem:
            self._on_refused(caller.name, SETTINGS)
            return self._done(), problem
        before = self.lease.holder, self.lease.selected, self.settings
        if not self.lease.on_selection(caller, robots, now):
            self._on_refused(caller.name, SELECT)
            return self._done(), ''
        self.wishes += 1
        new_holder = self.lease.holder != before[0]
        self._settings.on_wish(self.lease.operator, settings)
        self._driven.select(() if new_holder else robots)
        # A message queued in a socket while this program was suspended may predate the stop.
        freed = self._awake(now) and self._alone.select(caller.name, robots)
        if freed or (self.lease.holder, self.lease.selected, self.settings) != before:
            if new_holder:
                self._take_sources(now)
            self._apply(now)
        if self._wished_mode != (caller, mode):
            self._wished_mode = caller, mode
            problem = self._choose(mode, now) if mode else None
        return self._done(), problem or ''

    def _take_sources(self, now: float) -> None:
        """Make the operator in control, if any, the owner of the sources it publishes."""
        for name, owner in self._owners.items():
            if owner.take(self.lease.operator, self._connected(name)):
                self._pass_on(self.arbiter.on_lost(name, 'operator', now), now)

    def on_take(self, caller: Caller, now: float) -> Orders:
        """Put a caller in control: all robots get a zero, and neutral is required."""
        self.lease.take(caller, now)
        self._settings.on_control(caller.name)
        self._take_sources(now)
        self._apply(now)
        self._everybody_joins(now)
        return self._done()

    def on_gone(self, caller: Caller, now: float) -> Orders:
        """Handle the loss of a publisher of the wish."""
        lost = self.lease.on_gone(caller, now)
        if lost:
            self._apply(now)
            self._everybody_joins(now)
        return self._done()

    # Stops.

    def on_stop(self, now: float) -> Orders:
        """Stop everything until :meth:`on_release`; repeating it is safe."""
        self._awake(now)
        self._stop(now)
        return self._done()

    def _stop(self, now: float) -> None:
        again = self.stop_all
        self._pass_on(self.arbiter.engage_stop_all(now), now)
        self._settle_stops(now)
        if again:  # an operator who presses it again may see a robot move
            for name, rule in self._rules.items():
                self._send(name, rule.begin_zeros(now))

    def on_release(self, now: float) -> Tuple[Orders, str]:
        """Release stop-all; nothing moves until the stick has been at neutral once more."""
        self._awake(now)
        problem = self.arbiter.release_stop_all(now)
        self._settle_stops(now)
        return self._done(), problem or ''

    def on_stop_robots(self, names: Iterable[str], now: float) -> Orders:
        """Stop only these robots, each until it is selected again.

        :param names: names of robots, known or not; a stop of an unknown one is kept only while
            there are fewer than :data:`MAX_ROBOTS`
        """
        self._awake(now)
        for name in names:
            if name in self._rules or len(self._alone) < MAX_ROBOTS:
                self._alone.stop(name, self.lease.operator)
        self._settle_stops(now)
        return self._done()

    def on_undertaker(self, alive: bool, now: float) -> Orders:
        """Handle the state of the standby process; unless it is alive, nothing moves."""
        if alive != self._undertaken:
            self._undertaken = alive
            self._pass_on(self.arbiter.on_hold('undertaker', now), now)
            self._everybody_joins(now)
        return self._done()

    def _settle_stops(self, now: float) -> None:
        self.changes += 1
        for name, rule in self._rules.items():
            self._send(name, rule.stop(self.stop_all, name in self._alone, now))

    # Robots.

    def open(self, name: str, limits: Limits, now: float,
             brake: Brake = lambda velocity, _: velocity,
             accessories: Sequence[Accessory] = (), presumed: bool = False) -> Orders:
        """Add a robot; it replaces a closed one of the same name.

        :param limits: :class:`Limits` of its type and parameters
        :param brake: see :class:`RobotRule`
        :param accessories: of its type
        :param presumed: whether its type is only presumed: its limits may rise until it moves
        """
        self._rules[name] = RobotRule(limits, self._command, brake)
        self.accessories.open(name, accessories, now)
        self._type_limits[name] = limits
        self._driven.open(name, limits, presumed)
        self._apply(now)
        return self._done()

    def close_robot(self, name: str, now: float) -> Orders:
        """Remove a robot, after a zero."""
        rule = self._rules.pop(name, None)
        if rule is not None:
            self._round_trips.pop(name, None)
            self._send(name, rule.close(now))
            self._orders += self.accessories.close(name)
            self._apply(now)
        return self._done()

    def on_joined(self, name: str, now: float) -> Orders:
        """Make a new or newly connected robot wait for neutral if anything is driven."""
        self._send(name, self._rules[name].join(now))
        return self._done()

    def on_held(self, name: str, reason: str, now: float) -> Orders:
        """Suspend commands to a robot for a reason of :mod:`mhri.base.reasons`; '' resumes them."""
        rule = self._rules[name]
        before = rule.stop_reason
        self._send(name, rule.hold(reason, now))
        self.changes += rule.stop_reason != before
        return self._done()

    def on_abandoned(self, name: str, now: float) -> Orders:
        """Send zeros after the program of a task has died; it bypassed this drive."""
        if name in self._rules and not self._rules[name].selected:
            self._orders.append((name, self._rules[name].begin_zeros(now)))
        return self._done()

    def on_round_trip(self, name: str, round_trip_s: float) -> None:
        """Handle the round trip to a robot [s], NaN if unknown."""
        self._round_trips[name] = round_trip_s

    # Accessories.

    def on_accessory(self, caller: str, robots: Sequence[str], key: str, choice: str,
                     value: Sequence[float], now: float,
                     task: bool = False) -> Tuple[Orders, str]:
        """Handle an action from the operator in control or a task; see :meth:`Accessories.act`.

        :param task: whether it comes from the node of the tasks, for robots that obey a task
        """
        if not task and caller != self.lease.operator:
            self._on_refused(caller, ACCESSORY)
            self.accessories.refuse(caller, now)
            return self._done(), '{} is not in control'.format(caller)
        orders, problem = self.accessories.act(
            robots, key, choice, value, now, caller,
            TASK if task else OPERATOR) if self._awake(now) else ([], '')
        self._orders += orders
        return self._done(), problem

    def on_report(self, name: str, key: str, value: Sequence[float], choice: str) -> None:
        """Handle what a robot reports of an accessory."""
        rule = self.accessories.of(name).get(key)
        if rule is not None:
            self.changes += rule.on_report(value, choice)

    def on_finished(self, name: str, key: str) -> None:
        """Handle the end of the goal of an accessory's action."""
        self.accessories.on_finished(name, key)

    # Tasks and time.

    def on_task(self, robots: Sequence[str], twists: Sequence[Sequence[float]],
                now: float) -> Tuple[Orders, str]:
        """Handle the commands of the robots on a task.

        :param twists: for each robot, the six numbers of its Twist [m/s, rad/s]
        """
        self._awake(now)
        is_new = self._pulse.is_new(now)
        verdict, problem = self.relay.judge(robots, twists, self._closed or self.stop_all,
                                            self.arbiter.enabled(now) and self._undertaken, is_new)
        if problem:
            return self._done(), problem
        velocities = dict(zip(robots, twists))
        for name, rule in self._rules.items():
            twist = velocities.get(name)
            if twist is None:
                if is_new:
                    rule.on_task(None, now)
            elif self.stop_all or not is_new:
                rule.skip_task(now)
            elif verdict != NOTHING:
                self._send(name, rule.on_task(
                    ZERO if verdict == PASS_ZEROS else Velocity(twist[0], twist[5], twist[1]),
                    now))
        return self._done(), ''

    def tick(self, now: float, there: Iterable[Caller] = ()) -> Orders:
        """Handle the passage of time.

        :param there: every :class:`Caller` connected as a publisher of the wish
        """
        self._awake(now)
        self._pulse.beat(now)
        before = self.lease.state
        self.lease.tick(now, there)
        for name, rule in self._rules.items():
            if rule.selected and not rule.sent.is_zero():
                self._driven.note(name, self._type_limits[name])
        if self.lease.state != before:
            self._apply(now)
            # A robot on a task is not selected, and no operator is present to stop it.
            self._everybody_joins(now)
        elif self.settings.slow_with_link:
            self._keep_together()
        # After the lease: when it ends, no command is repeated again.
        self._pass_on(self.arbiter.tick(now), now)
        self._orders += self.accessories.settle() + self.accessories.tick(now)
        for name, rule in self._rules.items():
            try:
                self._send(name, rule.tick(now))
            except Exception as error:  # from its brake: the others continue
                self._send(name, self._failed(name, error, now))
        return self._done()

    def next_tick(self, now: float) -> float:
        """Return when to call :meth:`tick` next [s]."""
        times = [self.lease.next_tick(), self.accessories.next_tick()] + [
            rule.next_tick(now) for rule in self._rules.values()]
        return min([time_s for time_s in times if time_s is not None]
                   + [now + LOOK_S, self.arbiter.next_tick(now)])

    def waits_for(self, now: float) -> str:
        """Return why the operator cannot move robots; see :meth:`Arbiter.waits_for`."""
        waits_for = self.arbiter.waits_for(now)
        return waits_for if self._undertaken or self.stop_all else UNDERTAKER

    def close(self, now: float) -> Orders:
        """End: send every robot a zero (:meth:`tick` repeats it); nothing moves again."""
        self._closed, self._command = True, ZERO
        for name, rule in self._rules.items():
            self._send(name, rule.close(now))
        return self._done()

    # State for the next drive.

    def kept(self) -> Dict[str, Any]:
        """Return the state for the next drive, as JSON values."""
        return {'seat': self.lease.kept(), 'settings': self._settings.kept(), 'mode': self.mode,
                'driven': self._driven.kept(), 'stop': self.stop_all,
                'sources': {name: owner.kept() for name, owner in self._owners.items()},
                'alone': self._alone.kept()}

    def _restore(self, kept: Mapping[str, Any], now: float) -> None:
        """Restore the state of the previous drive: nothing is selected, neutral is required.

        :raises AttributeError, LookupError, TypeError, ValueError: it is malformed
        """
        if kept.get('forgotten'):
            self.lease.forget(now)
        if 'seat' in kept:
            self.lease.restore(kept['seat'], now)
            for name in self._owners.keys() & kept['sources'].keys():
                self._owners[name].restore(kept['sources'][name])
            self._settings.restore(kept['settings'])
            self._driven.restore(kept['driven'])
            self._alone.restore(kept['alone'])
            if kept['mode'] in self._sources:
                self.arbiter.on_mode(kept['mode'], now)
            self.arbiter.set_limits(*self.settings.limits, now)
        if kept.get('stop'):
            self.arbiter.engage_stop_all(now)

    # Internals.

    def _authority(self) -> Authority:
        return Authority(self.lease.state == LEASED, self._undertaken and not self._closed,
                         self.arbiter.holds)

    def _awake(self, now: float) -> bool:
        """Return whether a message received now is new.

        After a suspension it may have been queued in a socket meanwhile.
        """
        if self._pulse.slept(now):
            self._pass_on(self.arbiter.on_hung(now), now)
            self._everybody_joins(now)
        return not self._pulse.discards_backlog(now)

    def _pass_on(self, velocity: Optional[Velocity], now: float) -> None:
        """Pass on the operator's command; the only path where every microsecond counts."""
        if velocity is None or self._closed:
            return
        if not self._undertaken:
            velocity = ZERO
        self._command = self.said = velocity
        for name, rule in self._rules.items():
            try:
                said = rule.on_command(velocity, now)
            except Exception as error:  # from its brake: send a zero, and the others continue
                said = self._failed(name, error, now)
            if said is not None:
                self._orders.append((name, said))

    def _failed(self, name: str, error: Exception, now: float) -> Velocity:
        """Return a zero for a robot whose rule has failed: in doubt, it stops."""
        self._on_refused(name, repr(error)[:200])
        return self._rules[name].begin_zeros(now)

    def _send(self, name: str, velocity: Optional[Velocity]) -> None:
        if velocity is not None:
            self._orders.append((name, velocity))

    def _done(self) -> Orders:
        # Whatever the event was: what has lost its authority ends with it.
        self._orders += self.accessories.settle()
        orders, self._orders = self._orders, []
        return orders

    def _everybody_joins(self, now: float) -> None:
        self.changes += 1
        self._orders += self.accessories.end_all()
        for name, rule in self._rules.items():
            self._send(name, rule.join(now))

    def _apply(self, now: float) -> None:
        """Apply the lease and the settings in force to limits, selection and pace."""
        self.changes += 1
        selected = self.lease.selected
        if self.settings.limits != self.arbiter.limits:
            self._pass_on(self.arbiter.set_limits(*self.settings.limits, now), now)
        self._pass_on(self.arbiter.on_selection(selected, now), now)
        for name, rule in self._rules.items():
            if name in selected:
                self._driven.on_selected(name, self._type_limits[name])
            rule.limits = self._driven.of(name, self._type_limits[name])
            self._send(name, rule.stop(self.stop_all, name in self._alone, now))
            self._send(name, rule.select(name in selected, now))
        self._pass_on(self.arbiter.let_sideways(any(
            rule.selected and rule.limits.holonomic for rule in self._rules.values()), now), now)
        self._keep_together()

    def _keep_together(self) -> None:
        """Set the limits and the share of every robot."""
        group = [rule for rule in self._rules.values() if rule.selected]
        most = Limits(*self.settings.limits, holonomic=True)
        if self.settings.together:
            most = common_limits([most] + [rule.limits for rule in group])
        trips = [self._round_trips.get(name, math.nan) for name, rule in self._rules.items()
                 if rule.selected]
        known = [trip_s for trip_s in trips if trip_s == trip_s]
        self.share = link_share(max(known, default=None)) if self.settings.slow_with_link else 1.0
        for rule in self._rules.values():
            rule.hold_to(most, self.share)
