# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who drives, and what makes everything stop: the rules of the mux, without ROS or a clock.

One :class:`Arbiter` owns the control mode. Time is passed in as seconds of a clock that never goes
back. Every method that may change what the robots should do returns the :class:`Velocity` to send
at once, or None to send nothing; :meth:`Arbiter.tick` does the same as time passes, and
:meth:`Arbiter.next_tick` says when to call it.

States and what leads out of them::

    STOPPED        stop-all is in force                 release -> WAIT_NEUTRAL
    WAIT_NEUTRAL   nothing moves until the active       neutral seen -> READY
                   source has been seen at neutral
    READY          fresh source at neutral              deflected -> DRIVING
    DRIVING        a command other than zero            neutral or dead-man released -> READY

These lead from READY and DRIVING to WAIT_NEUTRAL: a silent, suspended, lost or exchanged source, a
change of mode, a robot that joins the selection, the release of the enabling pedal, a dead-man
button pressed while the stick is deflected, and the loss of the master or of the gates. A dead-man
button counts as released until its device was seen to release it once: one that is taped down is
none. Stop-all leads from anywhere to STOPPED. Each of these starts the zeros (except silence at
rest, after which they have already been sent): one at once, more at :data:`REPEAT_HZ` for
:data:`ZEROS_S`, then silence, since endless zeros would block a robot's own navigation behind its
``cmd_vel_mux`` (rqt_common_plugins#180).
"""
import collections
import math
from typing import Callable, Counter, Dict, FrozenSet, Iterable, Optional, Tuple

from mhri.base.limits import speed_limit_problem, Velocity, ZERO
from mhri.devices.profile import JoyRefused, Stick, Wanted
from mhri.driving.sources import MuxConfig, Source

STOPPED = 'stopped'
WAIT_NEUTRAL = 'wait_neutral'
READY = 'ready'
DRIVING = 'driving'

REPEAT_HZ, ZEROS_S = 20.0, 0.5
# An enabling pedal not heard for this long counts as released.
ENABLING_TIMEOUT_S = 0.25
_PERIOD_S = 1.0 / REPEAT_HZ
# For a source that has said nothing yet: it asks for nothing, but may not be at rest.
_UNHEARD = Stick(0.0, 0.0, neutral=False, held=False)


class Arbiter:
    """Decides which source drives and which velocity the robots are sent.

    :param config: :class:`mhri.driving.sources.MuxConfig`
    :param now: the time of creation [s]; the first zeros start here, to stop whatever an earlier
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
        # Of each source, the device whose dead-man button was seen released.
        self._let_go: Dict[str, object] = {}
        self._selected: FrozenSet[str] = frozenset()
        self._enabling, self._enabled_at = config.enabling, -math.inf
        self._automatic = config.automatic_switching
        # The last word of every source that was listened to, and of which device.
        self._last: Dict[str, Tuple[Wanted, object]] = {}
        self._zeros_until = now + ZEROS_S
        self._next_repeat = now
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
        """One of STOPPED, WAIT_NEUTRAL, READY, DRIVING."""
        return self._state

    @property
    def stop_all(self) -> bool:
        """Whether stop-all is in force."""
        return self._state == STOPPED

    def waits_for(self, now: float) -> str:
        """Return what keeps the operator from moving robots.

        :returns: '' (nothing: ready or driving), 'release' (stop-all), 'source' (nothing fresh is
            heard from the active source), 'neutral' (the stick is not centred), 'enabling' (the
            enabling pedal is not pressed) or 'dead_man' (that button is not held, or was never seen
            released)
        """
        if self._state == STOPPED:
            return 'release'
        if not self._fresh(now):
            return 'source'
        if self._state == WAIT_NEUTRAL:
            return 'neutral'
        if not self.enabled(now):
            return 'enabling'
        return '' if self._stick.held else 'dead_man'

    def pushed(self, now: float) -> bool:
        """Tell whether the stick of the active source is held, whatever becomes of it."""
        return self._fresh(now) and not self._stick.neutral

    @property
    def cause(self) -> str:
        """The event that last led to WAIT_NEUTRAL or STOPPED, e.g. 'stale', 'mode', 'start'."""
        return self._cause

    def on_message(self, name: str, device: object, now: float, read: Callable[[], Wanted],
                   pressed: bool = False) -> Optional[Velocity]:
        """Take in one message of a source.

        :param name: the source that sent it
        :param device: identifies the publisher (its ROS name); another publisher counts as a newly
            connected device
        :param read: returns what the message asks for; not called if that does not matter
        :param pressed: whether its first button is, for the enabling pedal
        :returns: the velocity to send now, or None
        :raises JoyRefused: ``read`` did; only the counters change
        :raises KeyError: no such source
        """
        if name == self._enabling:
            return self._on_enabling(pressed, now)
        active = name == self._mode
        if not (active or self._sources[name].rests or self._automatic):
            self.ignored[name] += 1
            return None
        try:
            stick = read()
        except JoyRefused as refusal:
            self.refused[refusal.kind] += 1
            raise
        if not stick.held:
            self._let_go[name] = device
        elif stick.has_dead_man and self._let_go.get(name) != device:
            stick = Stick(0.0, 0.0, stick.neutral, held=False, has_dead_man=True)
        before, self._last[name] = self._last.get(name, (_UNHEARD, None)), (stick, device)
        if active:
            return self._on_active(stick, device, now)
        still = self._state in (READY, WAIT_NEUTRAL) and now >= self._zeros_until
        touched = before[0].neutral and before[1] == device and not stick.neutral
        if self._automatic and still and touched:
            # It must be seen at neutral once more before it moves anything.
            return self.on_mode(name, now)
        self.ignored[name] += 1
        return None

    def _on_active(self, stick: Wanted, device: object, now: float) -> Optional[Velocity]:
        """Take in what the active source asks for."""
        exchanged = self._device not in (None, device) and self._state in (READY, DRIVING)
        was_fresh, before = self._fresh(now), self._stick
        self._stick, self._stick_at, self._device = stick, now, device
        if self._state == STOPPED:
            return None
        if self._state != WAIT_NEUTRAL and (exchanged or not was_fresh):
            zero = self.on_hold('device' if exchanged else 'stale', now)
            return self._follow(stick, now) or zero
        if self._state == READY and stick.held and not before.held and not stick.neutral:
            # Pressing the button must not set robots in motion.
            self._enter(WAIT_NEUTRAL, 'dead_man')
            return self._later_zero(now)
        return self._follow(stick, now)

    def _follow(self, stick: Wanted, now: float) -> Optional[Velocity]:
        """Apply an accepted stick in WAIT_NEUTRAL, READY or DRIVING."""
        if self._state == WAIT_NEUTRAL:
            if not stick.neutral:
                return None
            idle = self._cause == 'idle'
            self._enter(READY)
            return self._later_zero(now) if idle else self._zeros(now)
        if stick.is_zero() or not self.enabled(now):
            if self._state == DRIVING:
                self._enter(READY)
                return self._zeros(now)
            return self._later_zero(now)
        self._enter(DRIVING)
        return self._drive(now)

    def _on_enabling(self, pressed: bool, now: float) -> Optional[Velocity]:
        """Take in the enabling pedal.

        Releasing it stops everything. If it is pressed while the stick is deflected, nothing moves
        until the stick has been centred: a returning foot must not set robots in motion.
        """
        was, self._enabled_at = self.enabled(now), now if pressed else -math.inf
        if not pressed and self._state == DRIVING:
            return self.on_hold('enabling', now)
        if pressed and not was and self._state == READY and not self._stick.neutral:
            self._enter(WAIT_NEUTRAL, 'enabling')
        return None

    def enabled(self, now: float) -> bool:
        """Tell whether the enabling pedal allows motion; without one, it is always allowed."""
        return self._enabling is None or now - self._enabled_at < ENABLING_TIMEOUT_S

    def on_selection(self, names: Iterable[str], now: float) -> Optional[Velocity]:
        """Take note of the selected robots.

        A robot that joins while others are driving must not leap: all wait until the stick is
        centred.

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
        self._stick, self._device = self._last[name] if rests else (_UNHEARD, None)
        self._stick_at = now if rests else -math.inf
        return self.on_hold('mode', now)

    def on_lost(self, name: str, cause: str, now: float) -> Optional[Velocity]:
        """Take note that a source was suspended or its device lost (cause 'suspended' or 'lost').

        :returns: the velocity to send now, or None if the source is not the active one
        """
        self._last.pop(name, None)
        if name != self._mode:
            return None
        self._stick, self._stick_at, self._device = _UNHEARD, -math.inf, None
        return self.on_hold(cause, now)

    def on_hung(self, now: float) -> Optional[Velocity]:
        """Forget what every source has said: this mux was asleep, so all of it is old.

        :returns: the zero to send now
        """
        self._last.clear()
        self._enabled_at = -math.inf
        return self.on_lost(self._mode, 'hung', now)

    def on_hold(self, cause: str, now: float) -> Velocity:
        """Stop what moves, and demand neutral before anything moves.

        :returns: the zero to send now
        """
        if self._state != STOPPED:
            self._enter(WAIT_NEUTRAL, cause)
        return self._zeros(now)

    def engage_stop_all(self, now: float) -> Velocity:
        """Stop everything until :meth:`release_stop_all`; repeating it is safe.

        :returns: the zero to send now
        """
        self._enter(STOPPED, 'stop_all')
        return self._zeros(now)

    def release_stop_all(self, now: float) -> Optional[str]:
        """Release stop-all; nothing moves until the stick has been seen at neutral once more.

        :returns: None on success, else a sentence that says why not
        """
        if self._state != STOPPED:
            return None
        if self._stick is _UNHEARD:
            return 'nothing has been heard from {}: centre it once, or drive with another ' \
                   'source'.format(self.source.label)
        if not self._stick.neutral:
            return 'centre the stick first ({})'.format(self.source.label)
        self._enter(WAIT_NEUTRAL, 'released')
        return None

    def set_limits(self, linear_mps: float, angular_rad_s: float, now: float) -> Optional[Velocity]:
        """Change the operator's speed limits; moving robots follow at once.

        :returns: the velocity to send now, or None
        :raises ValueError: not finite, negative or absurdly large; the old limits stay in force
        """
        problem = speed_limit_problem(linear_mps, angular_rad_s)
        if problem:
            self.refused['speed_limit'] += 1
            raise ValueError(problem)
        self._limits = (linear_mps, angular_rad_s)
        if self._state == DRIVING and self._fresh(now) and self.enabled(now):
            return self._drive(now)
        return None

    def tick(self, now: float) -> Optional[Velocity]:
        """Let time pass.

        :returns: the velocity to send now, or None
        """
        if self._state == DRIVING and not self._fresh(now):
            return self.on_hold('stale', now)
        if self._state == DRIVING and not self.enabled(now):
            return self.on_hold('enabling', now)
        if self._state == WAIT_NEUTRAL and self._rests():
            return self._follow(self._stick, now)
        if self._state == READY and not self._fresh(now):
            # Already at rest, with the zeros sent: a device that speaks now and then must not cause
            # zeros without end.
            self._enter(WAIT_NEUTRAL, 'idle')
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
        """Tell whether the active source was heard recently enough to drive."""
        return now - self._stick_at < self.source.timeout_s or self._rests()

    def _rests(self) -> bool:
        """Tell whether the active source is silent at rest, and may be."""
        return self.source.rests and self._stick.neutral and self._stick.is_zero()

    def _enter(self, state: str, cause: Optional[str] = None) -> None:
        """Change the state; the only place that does."""
        self._state = state
        if cause:
            self._cause = cause

    def _zeros(self, now: float) -> Velocity:
        """Begin the zeros."""
        self._zeros_until, self._next_repeat = now + ZEROS_S, now + _PERIOD_S
        return ZERO

    def _later_zero(self, now: float) -> Optional[Velocity]:
        """Return a zero while the zeros last, then None."""
        return ZERO if now < self._zeros_until else None

    def _drive(self, now: float) -> Velocity:
        """Return the command of the present stick, and plan its repetition."""
        self._next_repeat = now + _PERIOD_S
        return self._stick.velocity(self._limits)
