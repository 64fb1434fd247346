# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the contract demands of each robot while things go wrong, apart from mhri's own code.

It is told what happens in the world (:meth:`ReferenceModel.tell`), in the order in which it does,
and says of each robot whether it must stand, must drive, or may do either. It knows nothing of
messages: who is there, what each stick says, who has checked what, and how long the contract gives
for each end of motion. Time is in seconds of a clock that never goes back. Where the contract is
silent, and while an end of motion may take its time, the answer is EITHER.
"""
from collections import namedtuple
import math

STAND, DRIVE, EITHER = 'must stand', 'must drive', 'either'
JOY, PAD = 'joy', 'ps3joy'

# Within what time a robot stands [s]: the contract's timings, and issue 10 A for what hangs.
AT_ONCE_S, SILENT_S, LEASE_S, MASTER_S = 0.05, 0.55, 1.6, 1.5
# After the drive was killed, hangs, or lost the undertaker; after that has hung, which is said too.
KILLED_S, HUNG_S, ORPHANED_S, UNDERTAKER_S = 0.05, 0.6, 0.2, 2.0
GUARD_S, GUARD_LOST_S = 0.3, 0.55
# A robot is not heard for so long before it is held, and a guard drops what is older [s].
NOT_HEARD_S, ANSWER_S = 1.0, 1.0
# How long it may take until all is well again [s]: a program starts, a hung one goes on, all else.
START_S, GO_ON_S, SAY_S, MASTER_BACK_S = 5.0, 3.0, 2.0, 6.0
DRIVES_WITHIN_S, CENTRED_S = 2.0, 0.3
MUX_S = {'killed': KILLED_S, 'hung': HUNG_S, 'both killed': math.inf, 'orphaned': ORPHANED_S,
         'ended': AT_ONCE_S}
# How the mux may end so that the undertaker ends, too.
WITH_UNDERTAKER = ('ended', 'both killed', 'orphaned')
# After the mux is back: until it knows again who is in control and what drives [s].
UNSURE_S = 4.0
# Until a new mux has reached its robots, and until one that goes on has [s].
AGAIN_S, AWAKE_S = 1.5, 0.3
# A mux that lived longer than this leaves to the next who is in control [s].
KEEPS_S = 3.0

Verdict = namedtuple('Verdict', 'what why since')


class Part:
    """A program or a link: well, or since when it is not and how: 'killed', 'ended', 'hung', or, of
    the mux, 'both killed' (with the undertaker) or 'orphaned' (that was killed alone)."""

    def __init__(self, well=True):
        self.well, self.how, self.since, self.lasted = well, '', -1e9, 0.0
        self.back_at, self.lived, self.another = -1e9, 0.0, not well

    def fail(self, how, now):
        """Note an end; one that hung first and was ended then has hung all the time."""
        if self.well:
            self.since, self.how, self.well, self.another = now, how, False, False
            self.lived = now - self.back_at
        self.another = self.another or how != 'hung'

    def mend(self, now):
        """Note that it is back."""
        if not self.well:
            self.well, self.back_at, self.lasted = True, now, now - self.since


class Stick:
    """What one source says: since when it is out, and when it was centred last.

    ``let_go``: the mux has seen its dead-man button released.
    """

    def __init__(self):
        self.out, self.held, self.let_go, self.released_at = False, True, False, 0.0
        self.changed_at, self.centred_at, self.centred_since = 0.0, 0.0, 0.0

    def say(self, out, now):
        """Note what it says from now on."""
        if self.out and not out:
            self.centred_since = now
        if not self.out:
            self.centred_at = now
        if out != self.out:
            self.changed_at = now
        self.out = out

    def last_centred(self, now):
        """Return when it was centred last."""
        return self.centred_at if self.out else now


class ReferenceModel:
    """The contract for some robots.

    :param robots: {name: has it a guard}
    :param operators: names; each has a virtual joystick
    """

    def __init__(self, robots, operators):
        self.guarded = dict(robots)
        self.parts = {key: Part() for key in ('mux', 'undertaker', 'master', 'pad')}
        self.parts.update({('robot', name): Part() for name in robots})
        self.parts.update({('link', name): Part() for name in robots})
        self.parts.update({('guard', name): Part() for name in robots if robots[name]})
        self.parts.update({('operator', name): Part(False) for name in operators})
        self.sticks = {PAD: Stick(), **{name: Stick() for name in operators}}
        self.chosen = {name: frozenset() for name in operators}
        self.holders = set()
        self.mode, self.mode_at, self.mode_before = JOY, 0.0, JOY
        self.stopped, self.stop_at = False, 0.0
        self.well_since = 0.0
        # Whether it is not known if a stop is in force: its service has not answered.
        self.unknown = False
        # After these a robot waits for a centred stick: {robot: [(time, limit, words)]}, newest.
        self.causes = {name: (-1e9, 0.0, '') for name in robots}
        # Since when what has to be so is not: {(robot, words): (time, limit)}.
        self.missing = {}

    # What happens.

    def tell(self, now, what, *args):
        """Handle an event; see the methods whose names begin with ``on_``."""
        for stick in self.sticks.values():
            stick.say(stick.out, now)
        getattr(self, 'on_' + what)(now, *args)
        self._look(now)

    def on_fail(self, now, key, how):
        """A program (or 'link') has failed: see :class:`Part`, or 'cut'."""
        part = self.parts[key]
        part.fail(how, now)
        if key == 'mux' and how in WITH_UNDERTAKER:
            self.parts['undertaker'] = Part()
        if key[0] == 'operator' and how != 'hung':
            self._gone(key[1], now)
        if key[0] == 'guard' and how != 'hung':
            self._wait(now, GUARD_LOST_S, 'its guard was lost', key[1])

    def on_mend(self, now, key):
        """It is there again."""
        part = self.parts[key]
        if part.well:
            return
        part.mend(now)
        starting = part.another
        kind = key if isinstance(key, str) else key[0]
        settle = START_S if starting else GO_ON_S
        if kind == 'master':
            settle = MASTER_BACK_S
        if kind == 'link':
            settle += 2.0 * part.lasted
        getattr(self, '_back_' + kind)(now, key, part, starting)
        if kind != 'operator' or key[1] in self.holders:
            self._unwell_until(now + settle)

    def on_stick(self, now, name, out):
        """The stick of a source (PAD, or of an operator) is out or centred from now on."""
        self.sticks[name].say(out, now)

    def on_dead_man(self, now, held):
        """The dead-man button of the pad."""
        stick = self.sticks[PAD]
        if held and not stick.held and stick.out:
            self._all_wait(now, AT_ONCE_S, 'the dead-man button was pressed', PAD)
        if stick.held and not held:
            stick.released_at = now
        elif held and not stick.held and now - max(
                stick.released_at, self.mode_at, self.parts['mux'].back_at + UNSURE_S) > CENTRED_S:
            stick.let_go = stick.let_go or self._modes(now) == {PAD}
        stick.held = held
        if held:
            self._unwell_until(now + SAY_S)

    def on_mode(self, now, mode):
        """The mode was asked for."""
        if mode != self.mode:
            self.mode_before, self.mode, self.mode_at = self.mode, mode, now
            self._unwell_until(now + SAY_S)
            self._all_wait(now, AT_ONCE_S, 'another mode')

    def on_check(self, now, operator, names):
        """An operator has checked exactly these robots."""
        names = frozenset(names)
        new = names - self.chosen[operator]
        self.chosen[operator] = names
        if new and self.holders == {operator}:
            self._unwell_until(now + SAY_S)
            self._all_wait(now, AT_ONCE_S, 'a robot was checked')

    def on_take(self, now, operator):
        """An operator has taken control."""
        self.holders = {operator}
        self._unwell_until(now + SAY_S)
        self._all_wait(now, AT_ONCE_S, 'control was taken')

    def on_unknown(self, now):
        """Stop-all or its release was asked for, and nobody answered."""
        self.stopped, self.unknown = False, True

    def on_stop(self, now):
        """Stop-all is in force: its service has said so."""
        self.unknown = False
        if not self.stopped:
            self.stopped, self.stop_at = True, now

    def on_release(self, now):
        """Stop-all has been released: its service has said so."""
        self.unknown = False
        self._unwell_until(now + SAY_S)
        if self.stopped:
            self.stopped = False
            self._all_wait(now, AT_ONCE_S, 'a stop was released')

    # What comes back.

    def _back_mux(self, now, _key, part, starting):
        if not starting:
            if part.lasted > SILENT_S + 0.5:
                self._all_wait(now, AT_ONCE_S, 'the mux was away')
        else:
            self.sticks[PAD].let_go = False
            for name in self.guarded:
                self._wait(part.since, min(self._mux_limit_s(name), part.lasted),
                           'the mux is another one', name)
            if part.how in WITH_UNDERTAKER or part.lived < KEEPS_S:
                self.holders = {name for name in self.chosen
                                if self.parts['operator', name].well}

    def _back_undertaker(self, now, _key, part, _starting):
        if part.lasted > UNDERTAKER_S and self.parts['mux'].well:
            self._all_wait(now, AT_ONCE_S, 'the undertaker was away')

    def _back_master(self, now, _key, part, _starting):
        if part.lasted > MASTER_S + 0.5:
            self._all_wait(part.since, MASTER_S, 'the master was lost')

    def _back_pad(self, now, _key, part, starting):
        if starting:
            self.sticks[PAD].let_go = False
        if starting or part.lasted > SILENT_S + 0.5:
            self._all_wait(part.since if starting else now, SILENT_S, 'the pad was away', PAD)

    def _back_operator(self, now, key, part, starting):
        name = key[1]
        if starting:
            self.chosen[name] = frozenset()
            # Who has just come may not have spoken yet; the seat of one that has gone gets empty.
            if not any(self.parts['operator', other].well
                       and now - self.parts['operator', other].back_at > UNSURE_S
                       for other in self.holders):
                self.holders.add(name)
        elif part.lasted > LEASE_S + 0.5 and self.holders == {name}:
            self._all_wait(now, AT_ONCE_S, 'its operator was away')

    def _back_robot(self, now, key, part, starting):
        if starting or part.lasted > NOT_HEARD_S + 1.0:
            self._wait(now, 0.5, 'it was away', key[1])

    def _back_link(self, now, key, part, _starting):
        if part.lasted > 1.5:
            # What was on its way is too old for a guard.
            late_s = AT_ONCE_S if self._is_guarded(key[1]) else 1.0 + 1.2 * part.lasted
            self._wait(now, late_s, 'its link was cut', key[1])

    def _back_guard(self, now, key, part, starting):
        if starting or part.lasted > GUARD_LOST_S + 0.5:
            # Until one that has just been started is there, its robot is driven without.
            self._wait(now, SAY_S if starting else GUARD_LOST_S, 'its guard is back', key[1])

    def _gone(self, name, now):
        """Note an operator's end: nobody gets its seat who was refused before."""
        if self.holders == {name}:
            self._all_wait(now, AT_ONCE_S, 'its operator has gone')

    def _unwell_until(self, when):
        self.well_since = max(self.well_since, when)

    def _all_wait(self, now, limit_s, why, source=None):
        for name in self.guarded:
            self._wait(now, limit_s, why, name, source)

    def _wait(self, now, limit_s, why, name, source=None):
        """Let a robot wait for neutral from now on; ``source``: only where that one drives."""
        if source is not None and self._modes(now) != {source}:
            return
        self.causes[name] = (now, limit_s, why)

    # What follows from it.

    def _unsure(self, key, now):
        part = self.parts[key]
        return not part.well or now - part.back_at < UNSURE_S

    def _modes(self, now):
        """Return the sources that may be the active one."""
        modes = {self.mode}
        if self._unsure('mux', now):
            modes.add(JOY)
        if now - self.mode_at < 0.5:
            modes.add(self.mode_before)
        return modes

    def _speakers(self, now):
        """Return the sticks that may drive, by name."""
        names = set()
        for mode in self._modes(now):
            if mode == PAD:
                names.add(PAD)
            else:
                names |= self.holders
                if self._unsure('mux', now):
                    names |= {name for name in self.chosen if self.parts['operator', name].well}
        return names

    def _asked(self, name, now):
        """Yield (words, limit) of everything that keeps a robot from moving."""
        if self.stopped:
            yield 'stop-all', AT_ONCE_S
        mux = self.parts['mux']
        if not mux.well:
            yield 'mux ' + mux.how, self._mux_limit_s(name)
        elif not self.parts['undertaker'].well:
            yield 'undertaker hung', UNDERTAKER_S
        holders = {holder: self.parts['operator', holder] for holder in self.holders}
        if not any(part.well for part in holders.values()):
            hung = any(part.how == 'hung' for part in holders.values())
            yield 'nobody is in control', LEASE_S if hung else AT_ONCE_S
        elif not any(name in self.chosen[holder] for holder in holders):
            yield 'not checked', AT_ONCE_S
        yield from self._sticks_ask(now)
        link = self.parts['link', name]
        if not link.well and self._had_guard(name, link.since):
            yield 'link cut', GUARD_S

    def _is_guarded(self, name):
        return self.guarded[name] and self.parts['guard', name].well

    def _had_guard(self, name, when):
        """Return whether a robot is guarded, and was at a time: one that starts knows nothing."""
        if not self._is_guarded(name):
            return False
        guard = self.parts['guard', name]
        return not guard.another or when - guard.back_at >= START_S

    def _mux_limit_s(self, name):
        """Return within what time a robot stands once the mux has failed as it did last [s]."""
        mux, undertaker = self.parts['mux'], self.parts['undertaker']
        limit_s = MUX_S.get(mux.how, 0.0)
        if mux.how in ('killed', 'hung'):
            # One that hangs writes when it goes on.
            limit_s += max(0.0, undertaker.back_at - mux.since) if undertaker.well else math.inf
        return min(limit_s, GUARD_S) if self._had_guard(name, mux.since) else limit_s

    def _sticks_ask(self, now):
        speakers = {stick: self.parts['pad' if stick == PAD else ('operator', stick)].well
                    for stick in self._speakers(now)}
        out = [well for stick, well in speakers.items()
               if self.sticks[stick].out and (stick != PAD or self.sticks[PAD].held)]
        # Another's centred stick does not end the drive of one that falls silent.
        if not any(out or speakers.values()):
            yield 'no stick that is out is there', SILENT_S
        elif not out:
            yield 'the stick is centred', AT_ONCE_S

    def _look(self, now):
        """Note since when what has to be so is not."""
        for name in self.guarded:
            asked = dict(self._asked(name, now))
            for key in [key for key in self.missing if key[0] == name and key[1] not in asked]:
                del self.missing[key]
            for words, limit_s in asked.items():
                since, _ = self.missing.get((name, words), (now, None))
                self.missing[name, words] = since, limit_s

    def verdict(self, name, now, slack_s):
        """Return what the contract demands of a robot now.

        :param slack_s: what this computer may be late by
        """
        self._look(now)
        if not self._reachable(name, now, slack_s):
            return Verdict(EITHER, 'out of reach', now)
        blocked = self._blocked_until(name)
        stands = [(max(since + limit_s, blocked) + slack_s, since, words)
                  for (robot, words), (since, limit_s) in self.missing.items() if robot == name]
        stands += [(max(since + limit_s, blocked) + slack_s, since, why)
                   for since, limit_s, why in self._waits(name, now, slack_s)]
        due = min(stands, default=None)
        if due is not None and now >= due[0]:
            return Verdict(STAND, due[2], due[1])
        if due is None and self._must_drive(name, now, slack_s):
            return Verdict(DRIVE, 'centred and deflected', now)
        return Verdict(EITHER, '', now)

    def must_say(self, now, slack_s):
        """Return whether the mux must say by now that it waits for the undertaker."""
        mux, master = self.parts['mux'], self.parts['master']
        since = max(self.parts['undertaker'].since, mux.back_at + UNSURE_S,
                    master.back_at + MASTER_BACK_S)
        return not self.parts['undertaker'].well and mux.well and master.well \
            and now - since > UNDERTAKER_S + slack_s

    def _waits(self, name, now, slack_s):
        """Yield the causes after which no stick that may drive has been centred since."""
        causes = [self.causes[name]]
        master = self.parts['master']
        if not master.well and now - master.since > MASTER_S + slack_s:
            causes.append((master.since, MASTER_S, 'the master is lost'))
        guard = self.parts.get(('guard', name))
        if guard is not None and not guard.well:
            causes.append((guard.since, GUARD_LOST_S, 'its guard is silent'))
        centred = max((self.sticks[stick].last_centred(now) for stick in self._speakers(now)),
                      default=now)
        return [cause for cause in causes if cause[2] and centred < cause[0] - slack_s]

    def _reachable(self, name, now, slack_s):
        robot, link = self.parts['robot', name], self.parts['link', name]
        guard = self.parts.get(('guard', name))
        # One that was started while the link was cut finds its master when that is over.
        orphan = guard is not None and link.since < guard.back_at < link.back_at
        guarded = self._is_guarded(name) and not orphan
        if not robot.well or now - robot.back_at < 0.5 + slack_s or not (guarded or link.well):
            return False
        late = now - link.back_at < 1.0 + 1.2 * link.lasted + slack_s
        if late and not (guarded and link.lasted > ANSWER_S + 0.3 + slack_s):
            return False
        # The word that makes the robot stand comes from the mux, which notices the loss first.
        return guard is None or (
            now - (guard.back_at if guard.well else guard.since) > GUARD_LOST_S + slack_s)

    def _blocked_until(self, name):
        """Return until when nobody may be there to bring a robot its zero."""
        part = self.parts['mux']
        until = part.since + self._mux_limit_s(name)
        if part.well:
            # It has its zero by the undertaker or, if that could not, by the next mux.
            until = min(until, part.back_at + (AGAIN_S if part.another else AWAKE_S))
        link = self.parts['link', name]
        # Where no word reaches it, the lease of its guard ends.
        return until if link.well else max(until, link.since + GUARD_S)

    def _must_drive(self, name, now, slack_s):
        if self.unknown or not all(part.well for key, part in self.parts.items()
                                   if key[0] != 'operator'):
            return False
        speakers = self._speakers(now)
        if len(speakers) != 1 or len(self.holders) != 1:
            return False
        stick = self.sticks[next(iter(speakers))]
        if PAD in speakers and not (stick.held and stick.let_go):
            return False
        ready = max(stick.centred_since, self.well_since, self.causes[name][0])
        return stick.out and stick.changed_at - ready >= CENTRED_S and (
            now - stick.changed_at >= DRIVES_WITHIN_S + slack_s)
