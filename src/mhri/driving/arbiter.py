# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The active source and its command: one state machine, without ROS or a clock.

One :class:`Arbiter` owns the control mode. Time is passed in as seconds of a monotonic clock. Every
method that may change the operator's command returns the :class:`Velocity` to pass on at once, or
None for nothing; :meth:`Arbiter.tick` does the same as time passes, and :meth:`Arbiter.next_tick`
returns when to call it.

The states::

    STOPPED        stop-all is in force
    WAIT_NEUTRAL   nothing moves until the active source has been at neutral
    IDLE           the same, after silence at rest; the zeros have been sent
    READY          a fresh source at rest
    DRIVING        a nonzero command

:data:`TRANSITIONS` lists the transitions. HOLD stands for every event that requires neutral: a
suspended, lost or exchanged source, a change of mode, a robot that joins the selection, the release
of the enabling pedal, the loss of the master, another operator. A dead-man button counts as
released until its device has released it once, so one that is taped down has no effect. One zero is
sent at once and more at :data:`REPEAT_HZ` for :data:`ZEROS_S`, then nothing: endless zeros would
block a robot's own navigation behind its ``cmd_vel_mux`` (rqt_common_plugins#180).
"""
import collections
import math
from typing import Callable, Counter, Dict, FrozenSet, Iterable, Optional, Tuple

from mhri.base import reasons
from mhri.base.limits import Velocity, ZERO
from mhri.devices.profile import JoyRefused, Stick, Wanted
from mhri.driving.sources import MuxConfig, Source

STOPPED, WAIT_NEUTRAL, IDLE = 'stopped', 'wait_neutral', 'idle'
READY, DRIVING = 'ready', 'driving'
STATES = (STOPPED, WAIT_NEUTRAL, IDLE, READY, DRIVING)
# Events of the active source: at neutral while that is required; at rest (centred, or not
# enabled); deflected; silent; its dead-man button pressed while deflected. Then other events.
CENTRED, RESTS, PUSHED, SILENT, PRESSED = 'centred', 'rests', 'pushed', 'silent', 'pressed'
HOLD, STOP, RELEASE = 'hold', 'stop', 'release'
# Actions: send zeros from now on, the command, a zero if zeros are still being sent, or nothing.
ZEROS, COMMAND, LATER_ZERO, NOTHING = 'zeros', 'command', 'later_zero', 'nothing'
#: {(state, event): (next state, action)}; any other pair changes nothing
TRANSITIONS = {
    (WAIT_NEUTRAL, CENTRED): (READY, ZEROS),
    (IDLE, CENTRED): (READY, LATER_ZERO),
    (READY, RESTS): (READY, LATER_ZERO),
    (READY, PUSHED): (DRIVING, COMMAND),
    (READY, PRESSED): (WAIT_NEUTRAL, LATER_ZERO),
    (READY, SILENT): (IDLE, NOTHING),
    (DRIVING, RESTS): (READY, ZEROS),
    (DRIVING, PUSHED): (DRIVING, COMMAND),
    (DRIVING, SILENT): (WAIT_NEUTRAL, ZEROS),
    (STOPPED, RELEASE): (WAIT_NEUTRAL, NOTHING),
    (STOPPED, HOLD): (STOPPED, ZEROS),
    **{(state, HOLD): (WAIT_NEUTRAL, ZEROS) for state in (WAIT_NEUTRAL, IDLE, READY, DRIVING)},
    **{(state, STOP): (STOPPED, ZEROS) for state in STATES}}
_WAITING = (WAIT_NEUTRAL, IDLE)

REPEAT_HZ, ZEROS_S = 20.0, 0.5
# An enabling pedal silent for this long counts as released.
ENABLING_TIMEOUT_S = 0.25
_PERIOD_S = 1.0 / REPEAT_HZ
#: The command in a message, with sideways motion (True) or without.
Read = Callable[[bool], Wanted]
# For a source without a message so far: no command, but it may not be at rest.
_UNHEARD = Stick(0.0, 0.0, neutral=False, held=False)


class Arbiter:
    """Decides which source drives and which velocity is sent to the robots.

    :param config: :class:`mhri.driving.sources.MuxConfig`
    :param now: the time of creation [s]; the first zeros start here, to stop robots that an earlier
        mux left moving
    """

    def __init__(self, config: MuxConfig, now: float) -> None:
        self._sources = {source.name: source for source in config.sources}
        self._mode = config.default
        self._limits = (config.linear_mps, config.angular_rad_s)
        self._state = WAIT_NEUTRAL
        self._cause = 'start'
        self._stick: Wanted = _UNHEARD
        self._stick_at = -math.inf
        self._device: object = None
        # For each source, the device whose dead-man button has been released.
        self._let_go: Dict[str, object] = {}
        self._selected: FrozenSet[str] = frozenset()
        self._enabling, self._enabled_at = config.enabling, -math.inf
        self._automatic = config.automatic_switching
        # Whether sideways motion counts: only if a selected robot is holonomic.
        self._sideways = False
        # {source: (last command, its device, function that reads the message again)}
        self._last: Dict[str, Tuple[Wanted, object, Read]] = {}
        self._zeros_until = now + ZEROS_S
        self._next_repeat = now
        #: how often neutral was required since the start
        self.holds = 0
        self.refused: Counter[str] = collections.Counter()
        self.ignored: Counter[str] = collections.Counter()

    @property
    def mode(self) -> str:
        """Name of the active source."""
        return self._mode

    @property
    def source(self) -> Source:
        """Active :class:`mhri.driving.sources.Source`."""
        return self._sources[self._mode]

    @property
    def limits(self) -> Tuple[float, float]:
        """The operator's speed limits in force [m/s, rad/s]."""
        return self._limits

    @property
    def state(self) -> str:
        """One of :data:`STATES`."""
        return self._state

    @property
    def stop_all(self) -> bool:
        """Whether stop-all is in force."""
        return self._state == STOPPED

    def waits_for(self, now: float) -> str:
        """Return why the operator cannot move robots.

        :returns: '' (ready or driving), or one of :mod:`mhri.base.reasons`: RELEASE (stop-all),
            SOURCE (no recent message from the active source), NEUTRAL (the stick is not centred),
            ENABLING (the enabling pedal is not pressed) or DEAD_MAN (that button is not held, or
            has never been released)
        """
        if self._state == STOPPED:
            return reasons.RELEASE
        if not self._fresh(now):
            return reasons.SOURCE
        if self._state in _WAITING:
            return reasons.NEUTRAL
        if not self.enabled(now):
            return reasons.ENABLING
        return '' if self._stick.held else reasons.DEAD_MAN

    def pushed(self, now: float) -> bool:
        """Return whether the stick of the active source is deflected, even if it has no effect."""
        return self._fresh(now) and not self._stick.neutral

    @property
    def cause(self) -> str:
        """The last event that required neutral or stopped, e.g. 'stale', 'mode', 'start'."""
        return self._cause

    def on_message(self, name: str, device: object, now: float, read: Read,
                   pressed: bool = False) -> Optional[Velocity]:
        """Handle one message of a source.

        :param name: the source that sent it
        :param device: identifies the publisher (its ROS name); another publisher counts as a newly
            connected device
        :param read: returns the command in the message, with sideways motion or without; called
            only if needed
        :param pressed: whether its first button is pressed, for the enabling pedal
        :returns: the velocity to send now, or None
        :raises JoyRefused: raised by ``read``; only the counters change
        :raises KeyError: no such source
        """
        if name == self._enabling:
            return self._on_enabling(pressed, now)
        active = name == self._mode
        if not (active or self._sources[name].rests or self._automatic):
            self.ignored[name] += 1
            return None
        try:
            stick = self._read(name, device, read)
        except JoyRefused as refusal:
            self.refused[refusal.kind] += 1
            raise
        before = self._last.get(name, (_UNHEARD, None))
        self._last[name] = stick, device, read
        if active:
            return self._on_active(stick, device, now)
        still = self._state in (READY,) + _WAITING and now >= self._zeros_until
        touched = before[0].neutral and before[1] == device and not stick.neutral
        if self._automatic and still and touched:
            # It must return to neutral once before it moves anything.
            return self.on_mode(name, now)
        self.ignored[name] += 1
        return None

    def _read(self, name: str, device: object, read: Read) -> Wanted:
        """Return a source's command; its dead-man button counts once it has been released."""
        stick = read(self._sideways)
        if not stick.held:
            self._let_go[name] = device
        elif stick.has_dead_man and self._let_go.get(name) != device:
            return Stick(0.0, 0.0, stick.neutral, held=False, has_dead_man=True)
        return stick

    def let_sideways(self, counts: bool, now: float) -> Optional[Velocity]:
        """Set whether sideways motion counts: only while a selected robot is holonomic.

        A stick at neutral without the sideways axis may be off neutral with it, so neutral is
        required again.

        :returns: the velocity to send now, or None
        """
        if counts == self._sideways:
            return None
        self._sideways = counts
        for name, (_, device, read) in self._last.items():
            self._last[name] = self._read(name, device, read), device, read
        if self._stick is not _UNHEARD:
            self._stick = self._last[self._mode][0]
        return self.on_hold('selection', now) if counts else None

    def _on_active(self, stick: Wanted, device: object, now: float) -> Optional[Velocity]:
        """Handle a command of the active source."""
        exchanged = self._device not in (None, device) and self._state in (READY, DRIVING)
        was_fresh, before = self._fresh(now), self._stick
        self._stick, self._stick_at, self._device = stick, now, device
        if self._state in (READY, DRIVING) and (exchanged or not was_fresh):
            zero = self.on_hold('device' if exchanged else 'stale', now)
            return self._follow(stick, now) or zero
        if stick.held and not before.held and not stick.neutral and self._state == READY:
            # Pressing the button must not set robots in motion.
            return self._on(PRESSED, now, 'dead_man')
        return self._follow(stick, now)

    def _follow(self, stick: Wanted, now: float) -> Optional[Velocity]:
        """Apply a command of the active source."""
        if self._state in _WAITING:
            return self._on(CENTRED, now) if stick.neutral else None
        return self._on(RESTS if stick.is_zero() or not self.enabled(now) else PUSHED, now)

    def _on_enabling(self, pressed: bool, now: float) -> Optional[Velocity]:
        """Handle the enabling pedal.

        Releasing it stops everything. If it is pressed while the stick is deflected, nothing moves
        until the stick has been centred: putting the foot back must not set robots in motion.
        """
        was, self._enabled_at = self.enabled(now), now if pressed else -math.inf
        if not pressed and self._state == DRIVING:
            return self.on_hold('enabling', now)
        if pressed and not was and not self._stick.neutral:
            return self._on(PRESSED, now, 'enabling')
        return None

    def enabled(self, now: float) -> bool:
        """Return whether the enabling pedal allows motion; without one, it is always allowed."""
        return self._enabling is None or now - self._enabled_at < ENABLING_TIMEOUT_S

    def on_selection(self, names: Iterable[str], now: float) -> Optional[Velocity]:
        """Set the selected robots.

        A robot that joins while others are driving must not start with a jerk: all wait until the
        stick is centred.

        :returns: the velocity to send now, or None
        """
        before, self._selected = self._selected, frozenset(names)
        if self._selected - before and self._state == DRIVING:
            return self.on_hold('selection', now)
        return None

    def on_mode(self, name: str, now: float) -> Optional[Velocity]:
        """Change the active source; choosing the active one again changes nothing.

        :returns: the velocity to send now, or None
        :raises KeyError: no such source; the mode does not change
        """
        if name not in self._sources:
            self.refused['unknown_mode'] += 1
            raise KeyError(name)
        if name == self._mode:
            return None
        self._mode = name
        rests = self.source.rests and name in self._last
        self._stick, self._device = self._last[name][:2] if rests else (_UNHEARD, None)
        self._stick_at = now if rests else -math.inf
        return self.on_hold('mode', now)

    def on_lost(self, name: str, cause: str, now: float) -> Optional[Velocity]:
        """Handle the suspension of a source or the loss of its device.

        :param cause: 'suspended', 'lost', or another event that makes its last message invalid

        :returns: the velocity to send now, or None if the source is not the active one
        """
        self._last.pop(name, None)
        if name != self._mode:
            return None
        self._stick, self._stick_at, self._device = _UNHEARD, -math.inf, None
        return self.on_hold(cause, now)

    def on_hung(self, now: float) -> Optional[Velocity]:
        """Discard the last message of every source: this mux was suspended, so all are old.

        :returns: the zero to send now
        """
        self._last.clear()
        self._enabled_at = -math.inf
        return self.on_lost(self._mode, 'hung', now)

    def on_hold(self, cause: str, now: float) -> Velocity:
        """Stop all motion, and require neutral before anything moves again.

        :returns: the zero to send now
        """
        self.holds += 1
        self._on(HOLD, now, cause)
        return ZERO

    def engage_stop_all(self, now: float) -> Velocity:
        """Stop everything until :meth:`release_stop_all`; repeating it is safe.

        :returns: the zero to send now
        """
        self._on(STOP, now, 'stop_all')
        return ZERO

    def release_stop_all(self, now: float) -> Optional[str]:
        """Release stop-all; nothing moves until the stick has been at neutral once more.

        :returns: None on success, else a sentence with the reason
        """
        if self._state != STOPPED:
            return None
        if self._stick is _UNHEARD:
            return 'nothing has been heard from {}: centre it once, or drive with another ' \
                   'source'.format(self.source.label)
        if not self._stick.neutral:
            return 'centre the stick first ({})'.format(self.source.label)
        self._on(RELEASE, now, 'released')
        return None

    def set_limits(self, linear_mps: float, angular_rad_s: float, now: float) -> Optional[Velocity]:
        """Change the operator's speed limits, finite and >= 0; moving robots follow at once.

        :returns: the velocity to send now, or None
        """
        self._limits = (linear_mps, angular_rad_s)
        if self._state == DRIVING and self._fresh(now) and self.enabled(now):
            return self._drive(now)
        return None

    def tick(self, now: float) -> Optional[Velocity]:
        """Handle the passage of time.

        :returns: the velocity to send now, or None
        """
        if self._state == DRIVING and not self.enabled(now):
            return self.on_hold('enabling', now)
        if self._state == WAIT_NEUTRAL and self._rests():
            return self._follow(self._stick, now)
        if (self._state, SILENT) in TRANSITIONS and not self._fresh(now):
            # At rest the zeros have been sent: a device that publishes only now and then must not
            # cause endless zeros.
            return self._on(SILENT, now, 'stale')
        if now < self._next_repeat:
            return None
        if self._state == DRIVING:
            return self._drive(now)
        if now < self._zeros_until:
            self._next_repeat = now + _PERIOD_S
            return ZERO
        return None

    def next_tick(self, now: float) -> float:
        """Return the time [s] at which to call :meth:`tick` next."""
        times = [now + 1.0]
        if self._state in (READY, DRIVING) and not self._rests():
            times.append(self._stick_at + self.source.timeout_s)
        if self._state == DRIVING and self._enabling is not None:
            times.append(self._enabled_at + ENABLING_TIMEOUT_S)
        if self._state == DRIVING or now < self._zeros_until:
            times.append(self._next_repeat)
        return min(times)

    def _fresh(self, now: float) -> bool:
        """Return whether the last message of the active source is recent enough to drive."""
        return now - self._stick_at < self.source.timeout_s or self._rests()

    def _rests(self) -> bool:
        """Return whether the active source is at rest and is allowed to be silent then."""
        return self.source.rests and self._stick.neutral and self._stick.is_zero()

    def _on(self, event: str, now: float, cause: str = '') -> Optional[Velocity]:
        """Handle an event; the only place that changes the state."""
        after = TRANSITIONS.get((self._state, event))
        if after is None:
            return None
        self._state, action = after
        if cause and self._state != STOPPED or event == STOP:
            self._cause = cause
        if action == COMMAND:
            return self._drive(now)
        if action == ZEROS:
            self._zeros_until, self._next_repeat = now + ZEROS_S, now + _PERIOD_S
            return ZERO
        return ZERO if action == LATER_ZERO and now < self._zeros_until else None

    def _drive(self, now: float) -> Velocity:
        """Return the command of the current stick, and schedule its repetition."""
        self._next_repeat = now + _PERIOD_S
        return self._stick.velocity(self._limits)
