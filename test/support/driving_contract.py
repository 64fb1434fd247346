# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the contract demands of a drive, in plain facts of its own, judged at every event.

Who was seen at neutral since what, whose wish counts and since when, what is stopped: noted from
what happens, by the contract's own figures. Every velocity other than zero that leaves the drive,
and every robot that moves, is judged by them.
"""
import math

from mhri.base.robot_types import Limits
from mhri.driving.settings import Settings
from support.every_state import Violation

STEP_S, LOST_S = 0.05, 0.35
# The contract's figures, not the code's [s].
LEASE_S, RETURN_S, STALE_S, TASK_STALE_S, ENABLING_S, DEAF_S = 1.5, 3.0, 0.5, 0.25, 0.25, 0.3
ANSWER_S, GUARD_LEASE_S = 1.0, 0.3
# A look of a laser, and a word of odometry, counts so long [s]; readings that show a standstill.
LOOK_S, ODOMETRY_S, READINGS = 0.3, 1.0, 3
ROBOTS, OPERATORS = ('g', 'p'), ('a', 'b')
LIMITS = Limits(0.4, 1.0), Limits(0.8, 2.0)
SETTINGS = {'a': Settings(0.5, 1.0), 'b': Settings(1.0, 2.0)}
NEUTRAL, MOVES = ('rest', 'free'), ('out',)


class Contract:
    """The facts, and what follows from them.

    :param options: see :class:`support.driving_world.World`, which is one and lets things happen
    :param premises: counts how often each demand alone kept something from moving
    """

    def __init__(self, options, premises):
        self.options, self.premises = options, premises
        self.now, self.tasking = 0.0, False
        self.stopped, self.alone, self.undertaken = False, {}, True
        self.wish, self.wish_at, self.holder, self.refused = None, -math.inf, None, set()
        self.gone_at, self.deaf_until, self.enabled_at = None, -math.inf, -math.inf
        self.calm = dict.fromkeys(ROBOTS, False)
        self.last, self.heard = {'joy': 'off', 'pad': 'off'}, {}
        self.owners, self.let_go = {'joy': None, 'pad': None}, False
        self.task_free, self.task_at = dict.fromkeys(ROBOTS, False), {}
        self.selected, self.late = (), {}
        # Of the robots that were selected last, the lowest limits since.
        self.most, self.chosen = dict.fromkeys(ROBOTS, LIMITS[0]), ()
        self.newest_run, self.settings, self.own = 0, SETTINGS['a'], {}
        # Since when it is gone; whether it holds the stop of another master's drive.
        self.guard_gone_at, self.foreign = None, False
        # What the laser of p saw last, and when; since when its brake is asked for.
        self.saw, self.saw_at, self.braking = '', -math.inf, False
        # Of the stop that is proven: when it was sent; readings of a standstill in a row that were
        # measured since, and the newest.
        self.proof_at, self.stills, self.read_at = None, 0, -math.inf

    def _claim(self, what, holds):
        self.premises[what] += 1
        if not holds:
            raise Violation(what)

    def _hear(self, source, word):
        """Note what a source says that counts."""
        if source == 'pedal':
            if not self._enabled() and word == 'out':
                self._restless(ROBOTS)
            self.enabled_at = self.now if word == 'out' else -math.inf
            return
        has_dead_man = source == 'pad' and 'twist' not in self.options
        if has_dead_man:
            self.let_go = self.let_go or word in ('free', 'loose')
            if not self.let_go:
                word = {'out': 'loose', 'rest': 'free'}[word]
        stale = self.now - self.heard.get(source, -math.inf) >= STALE_S and not self._rests(source)
        pressed = has_dead_man and word == 'out' and self.last[source] in ('free', 'loose')
        if source == self.drive.mode and (stale or pressed):
            self._ask_for_neutral()
        self.heard[source], self.last[source] = self.now, word
        if source == self.drive.mode and word in NEUTRAL and not self.stopped:
            self.calm = dict.fromkeys(ROBOTS, True)

    def _ask_for_neutral(self):
        """Nothing counts any more but a source that may be silent at rest, and is at rest."""
        mode = self.drive.mode
        rests = self._rests(mode) and self.last[mode] in NEUTRAL
        self.calm = dict.fromkeys(ROBOTS, rests)

    def _rests(self, source):
        return source == 'joy' and 'twist' in self.options

    def _forget_sources(self):
        self.last, self.heard = {'joy': 'off', 'pad': 'off'}, {}
        self.enabled_at = -math.inf
        self._ask_for_neutral()

    def _lose(self, source):
        self.last[source] = 'off'
        self.heard.pop(source, None)
        if source == self.drive.mode:
            self._ask_for_neutral()

    def _settle_owners(self):
        for source, owner in self.owners.items():
            new = self.drive.owner(source)
            if new != owner and owner is not None:
                self._lose(source)
            self.owners[source] = new

    def _enabled(self):
        return 'enabling' not in self.options or self.now - self.enabled_at < ENABLING_S

    def _restless(self, names):
        """What has changed for these robots is borne only by a stick that is at neutral now."""
        mode = self.drive.mode
        neutral = self.last[mode] in NEUTRAL and (
            self._rests(mode) or self.now - self.heard[mode] < STALE_S)
        for name in names:
            self.calm[name] = self.calm[name] and neutral

    def _end_wish(self):
        self.wish, self.task_free = None, dict.fromkeys(ROBOTS, False)
        self._restless(ROBOTS)

    def _take_in_wish(self, caller, robots, settings):
        new_holder = caller != self.holder
        if new_holder:
            self._claim('a seat that was not free', caller not in self.refused and (
                self.holder is None or caller.is_successor_of(self.holder)))
            if self.holder is not None:
                self.refused.add(self.holder)
            self.holder, self.wish = caller, None
        for name, (whose, left) in list(self.alone.items()):
            if name not in robots:
                self.alone[name] = whose, True
            elif left or whose != caller.name:
                del self.alone[name]
                self._restless((name,))
        fresh = self.wish is not None and self.now - self.wish_at < LEASE_S
        if set(robots) - set(self.wish if fresh else ()):
            self._restless(ROBOTS)
        for name in ROBOTS:
            if new_holder or name not in robots:
                self.most[name] = self.drive._type_limits[name]
        self.chosen = robots
        self.wish, self.wish_at = robots, self.now
        self.settings = self.own[caller.name] = settings

    def _take_over(self, caller):
        """Note who has taken control: nothing is less safe than that operator had it."""
        self._end_wish()
        self.holder = caller
        self.refused.discard(caller)
        own, now = self.own.get(caller.name, self.settings), self.settings
        self.settings = now._replace(
            linear_mps=min(now.linear_mps, own.linear_mps), brake=now.brake or own.brake,
            angular_rad_s=min(now.angular_rad_s, own.angular_rad_s))

    def _reselect(self):
        """Note who is selected: a task is interrupted by every change of that."""
        fresh = self.wish is not None and self.now - self.wish_at < LEASE_S
        now = self.wish if fresh else ()
        if now != self.selected:
            for name in ROBOTS:
                if (name in now) != (name in self.selected) or not fresh:
                    self.task_free[name] = False
            self.selected = now

    def _follow(self, mode_before):
        """Judge what may have changed: mode, seat, settings, stop."""
        drive = self.drive
        if drive.mode != mode_before:
            self._ask_for_neutral()
            if not self._rests(drive.mode):
                self._lose(drive.mode)
        self._settle_owners()
        if drive.lease.holder != self.holder:
            gone_s = 0.0 if self.gone_at is None else self.now - self.gone_at
            self._claim('the seat is left at once',
                        drive.lease.holder is None and gone_s >= RETURN_S)
            self.holder = None
            self._end_wish()
        if self.holder is None or any(
                caller.is_successor_of(self.holder) for caller in self._there()):
            self.gone_at = None
        elif self.gone_at is None:
            self.gone_at = self.now
        self._claim('the seat is never left', self.gone_at is None
                    or self.now - self.gone_at <= RETURN_S + STEP_S)
        self._claim('a setting of another', drive.settings == self.settings
                    and drive.arbiter.limits == self.settings.limits)
        self._claim('a stop that ends by itself', drive.stop_all == self.stopped)

    def _reasons(self, name):
        """Return all that forbids the operator to move a robot."""
        mode, now = self.drive.mode, self.now
        silent = not self._rests(mode) and now - self.heard.get(mode, -math.inf) >= STALE_S
        other = mode == 'joy' and self.holder is not None and self.drive.owner('joy') != \
            self.holder.name and self.holder.name in self._connected('joy')
        checks = (
            (self.stopped, 'stop-all'), (name in self.alone, 'stopped alone'),
            (not self.undertaken, 'no undertaker'),
            (self.wish is None or name not in self.wish, 'not selected'),
            (now - self.wish_at >= LEASE_S, 'no lease'), (silent, 'a silent source'),
            (self.last[mode] not in MOVES, 'at rest'), (not self.calm[name], 'neutral first'),
            (not self._enabled(), 'the pedal'), (self.wall, 'the brake'),
            (name == 'p' and self.braking and self.saw == 'wall', 'the brake'),
            (name == 'p' and self.braking and now - self.saw_at > LOOK_S, 'a dead sensor'),
            (self.held[name], 'not reachable'), (other, 'the stick of another operator'))
        return [words for holds, words in checks if holds]

    def _task_may(self, name):
        return (self.task_free[name] and self.now - self.task_at.get(name, -math.inf) < TASK_STALE_S
                and self.undertaken and not (self.stopped or name in self.alone or self.held[name]
                                             or name in self.selected))

    def _judge_order(self, name, velocity):
        """Judge a velocity other than zero that leaves the drive."""
        if self.tasking:
            self._claim('a task that may not', self._task_may(name) and self._enabled())
            return
        reasons = self._reasons(name)
        if reasons:
            raise Violation('{} is sent {} in spite of {}'.format(name, tuple(velocity), reasons))
        most = min(self.most[name].linear_mps, self.settings.linear_mps)
        self._claim('a limit that rises', velocity.linear_mps <= most + 1e-9)

    def _patience(self, name):
        """Return how long a robot may move that must stand [s]; None: nobody can reach it."""
        # A guard that was started anew knows nothing of what the robot was told before.
        if self.cut[name] and (name == 'p' or self.guard_run or not self.guard_there):
            return None
        if name == 'p':
            # Its brake looks at the next tick.
            return STEP_S if 'eye' in self.options else 0.0
        if not self.guard_there:
            return LOST_S + 3.0 * STEP_S
        exact = self.guarded and not (self.cut['g'] or self.guard_run or self.lossy)
        return 0.0 if exact else GUARD_LEASE_S + 2.0 * STEP_S

    def _note_guard(self):
        """Note that a robot whose guard is gone waits for neutral, once that must be known."""
        gone_at = self.guard_gone_at
        if gone_at is not None and self.now - gone_at >= LOST_S + 2.0 * STEP_S:
            self.guard_gone_at = None
            self._restless(('g',))

    def _judge_proof(self, stopped):
        """Judge whether the robot p is called stopped rightly."""
        if stopped:
            self._claim('stopped without newer odometry', self.stills >= READINGS
                        and self.now - self.read_at <= ODOMETRY_S)

    def _judge(self):
        """Judge whether a robot moves that must stand, and whether its guard holds a stop."""
        self._look_at_proof()
        self._judge_tools()
        if self.guard_there and self._patience('g') == 0.0 and (
                self.stopped or 'g' in self.alone):
            self._claim('a stop that is not latched', self.guard.stopped)
        for name in ROBOTS:
            reasons = self._reasons(name)
            if len(reasons) == 1:
                self.premises[reasons[0]] += 1
            if not any(self.given[name]) or not reasons or self._task_may(name):
                self.late.pop(name, None)
                self.premises['moves'] += any(self.given[name])
                continue
            since, patience_s = self.late.setdefault(name, self.now), self._patience(name)
            if patience_s is not None and self.now - since >= patience_s - 1e-6:
                raise Violation('{} moves on in spite of {}'.format(name, reasons))
