# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random events on a running system of four robots without watchdogs, judged by the contract.

Master and mux are the real ones; two robots have the real guard; each has a computer of its
own, whose link can be cut. ``MHRI_SEED`` repeats a run, ``MHRI_EVENTS`` is the number of events
(default 20, for 50 s at most; ``MHRI_SECONDS`` for more), ``MHRI_KEEP`` a folder that stays
with all logs::

    MHRI_EVENTS=1000 MHRI_SEED=7 python3 -m pytest -s test/long/driving/test_random_events.py
"""
import bisect
from collections import Counter, defaultdict
import os
from pathlib import Path
import random
import signal
import statistics
import time

import pytest

from mhri.base.reasons import RELEASE, UNDERTAKER
from support import machines
from support.lag import LagMeter
from support.random_world import JOY, OPERATORS, PAD, ROBOTS, World
from support.reference_model import DRIVE, ReferenceModel, STAND

EVENTS = int(os.environ.get('MHRI_EVENTS') or 20)
# The short form is the same every time; a long one is new, unless it repeats one.
SEED = int(os.environ.get('MHRI_SEED') or (
    random.SystemRandom().randrange(10 ** 6) if 'MHRI_EVENTS' in os.environ else 30))
# No event is begun after so long [s].
LIMIT_S = float(os.environ.get('MHRI_SECONDS') or (50 if EVENTS == 20 else 'inf'))
# The model is asked so often [s]; what a computer may be late by beside what is measured [s], more
# where it runs other tests.
GRID_S, SLACK_S = 0.02, 0.25 if EVENTS == 20 else 0.1
# What is told was done at most so long before [s]: take-over is told when its answer has come.
TOLD_S = 0.1
CALM_EVERY = 30
NODES = ['pad', ('operator', OPERATORS[0])] + [
    ('robot', name) for name in ROBOTS] + [('guard', name) for name in ROBOTS if ROBOTS[name]]
WEIGHTS = {'drive': 22, 'key': 8, 'pad': 8, 'dead-man': 4, 'mode': 5, 'check': 8, 'stop-all': 6,
           'release': 8, 'kill -9': 8, 'kill drive': 7, 'kill undertaker': 6, 'kill both': 4,
           'stop': 5, 'SIGSTOP': 8, 'SIGSTOP drive': 6, 'SIGSTOP undertaker': 5, 'cut': 7,
           'second operator': 6, 'restart of master': 2}

# What befalls the processes of the mux is done to robots that move, if possible.
OF_MUX = {'kill drive', 'kill undertaker', 'kill both', 'SIGSTOP drive', 'SIGSTOP undertaker'}


class Events:
    """Draws events; each is a method that returns whether it could be done."""

    def __init__(self, world, dice):
        self.world, self.dice = world, dice
        self.done = []

    def one(self):
        """Do one event; return its kind."""
        while True:
            kind = self.dice.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]
            if self.dice.random() < (0.8 if kind in OF_MUX else 0.4):
                self.get_going()
            at = time.monotonic()
            if getattr(self, kind.replace(' ', '_').replace('-', '_'))():
                self.done.append((at, kind))
                return kind

    def get_going(self):
        """Let what is broken come back for a while, release a stop, and drive."""
        until = time.monotonic() + 4.0
        parts = self.world.model.parts
        while time.monotonic() < until and not all(
                part.well and time.monotonic() - part.back_at > 1.2 for key, part in parts.items()
                if key != ('operator', OPERATORS[1])):
            self.world.wait(0.1)
        if self.world.model.stopped and self.release():
            self.done.append((time.monotonic(), 'release'))
        at = time.monotonic()
        if self.drive():
            self.done.append((at, 'drive'))
        self.world.wait(0.2)

    def drive(self):
        """Centre the stick that drives for a moment, and deflect it."""
        stick = self.world.active()
        if stick == PAD:
            self.world.press_once()
        if not self.world.stick(stick, False):
            return False
        self.world.wait(self.dice.uniform(0.1, 0.5))
        return self.world.stick(stick, True)

    def key(self):
        alive = [name for name in OPERATORS if self.world.well(('operator', name))]
        return bool(alive) and self._toggle(self.dice.choice(alive))

    def pad(self):
        return self._toggle(PAD)

    def _toggle(self, name):
        return self.world.stick(name, not self.world.model.sticks[name].out)

    def dead_man(self):
        return self.world.dead_man(not self.world.model.sticks[PAD].held)

    def mode(self):
        return self.world.mode(JOY if self.world.model.mode == PAD else PAD)

    def check(self):
        name = self.dice.choice(OPERATORS)
        chosen = set(self.world.model.chosen[name])
        chosen ^= {self.dice.choice(list(ROBOTS))}
        return self.world.check(name, chosen)

    def _works(self, key):
        """Return whether the mux has begun to work."""
        parts = self.world.model.parts
        return all(parts[one].well and time.monotonic() - parts[one].back_at > 3.0
                   for one in (key, 'master'))

    def stop_all(self):
        return self._works('mux') and not self.world.model.stopped and self.world.stop(True)

    def release(self):
        if not self._works('mux') or not self.world.model.stopped:
            return False
        self.world.stick(self.world.active(), False)
        self.world.wait(0.15)
        return self.world.stop(False)

    def kill__9(self):
        return self._end(self.dice.choice(NODES), signal.SIGKILL)

    def kill_drive(self):
        return self._end('mux', signal.SIGKILL)

    def kill_undertaker(self, both=False):
        if not self._works('mux') or not self.world.end_undertaker(both):
            return False
        # As roslaunch does.
        self.world.later(self.dice.uniform(0.1, 3.0), lambda: self._start('mux'))
        return True

    def kill_both(self):
        return self.kill_undertaker(both=True)

    def stop(self):
        return self._end(self.dice.choice(NODES + ['mux']), signal.SIGTERM)

    def _end(self, key, number):
        # Of a robot and whatever has no zero for its end, SIGTERM is no more than SIGKILL.
        orderly = number == signal.SIGTERM and key == 'mux'
        if key not in self.world.processes or not self.world.end(
                key, number, 'ended' if orderly else 'killed'):
            return False
        if orderly or key != 'mux':
            self.world.later(self.dice.uniform(0.1, 3.0), lambda: self._start(key))
        return True

    def _start(self, key):
        self.world.start(key)
        if key == ('operator', OPERATORS[0]) and self.dice.random() < 0.8:
            self.world.check(OPERATORS[0], ROBOTS)
        self.done.append((time.monotonic(), 'start'))

    def SIGSTOP(self):
        return self.world.hang(self.dice.choice(NODES), self._for())

    def SIGSTOP_drive(self):
        # The undertaker replaces it after 0.5 s, but waits longer for a first sign of life.
        briefly = self.dice.uniform(0.05, 0.7)
        return self.world.hang('mux', self.dice.choice((briefly, self.dice.uniform(0.7, 4.0)))
                               if self._works('mux') else briefly)

    def SIGSTOP_undertaker(self):
        return self.world.hang('undertaker', self.dice.choice(
            (self.dice.uniform(0.05, 1.0), self.dice.uniform(2.0, 5.0))))

    def while_driven(self):
        """Let happen to both processes of the mux, while every robot drives, what is rare else."""
        for kind, event, lasts_s in (
                ('SIGSTOP drive', lambda: self.world.hang('mux', 2.5), 3.0),
                ('SIGSTOP undertaker', lambda: self.world.hang('undertaker', 3.0), 3.5),
                ('kill undertaker', self.kill_undertaker, 1.0)):
            self.calm()
            self.done.append((time.monotonic(), kind))
            assert event()
            self.world.wait(lasts_s)

    def cut(self):
        return self.world.cut(self.dice.choice(list(ROBOTS)), self._for())

    def _for(self):
        return self.dice.choice((self.dice.uniform(0.05, 1.0), self.dice.uniform(1.0, 4.0)))

    def second_operator(self):
        """Come; speak; take control; go."""
        key = ('operator', OPERATORS[1])
        if not self.world.well(key):
            if not self.world.well('master'):
                return False
            self.world.start(key)
            chosen = [name for name in ROBOTS if self.dice.random() < 0.5]
            self.world.later(0.8, lambda: self.world.check(OPERATORS[1], chosen))
            self.world.later(1.0, lambda: self.world.stick(OPERATORS[1], True))
            self.world.later(self.dice.uniform(3.0, 12.0), lambda: self.world.end(
                key, signal.SIGKILL, 'killed'))
            return True
        return self.world.take(self.dice.choice(OPERATORS))

    def restart_of_master(self):
        return self.world.end_master(self.dice.choice((0.0, self.dice.uniform(0.5, 4.0))))

    def calm(self):
        """Make all well, centre, deflect: every robot has to drive."""
        self.world.recover(rival=self.dice.random() < 0.4)
        if self.world.active() == PAD:
            self.world.press_once()
            self.world.wait(max(0.0, self.world.model.well_since - time.monotonic()) + 0.5)
        self.world.stick(self.world.active(), True)
        self.world.wait(3.5)
        self.done.append((time.monotonic(), 'all well'))


def motion(path, facts, robot):
    """Return (times, speeds) of a robot: what it did from each time on."""
    rows = [tuple(map(float, line.split())) for line in Path(path).read_text().splitlines()]
    rows = [(at, max(abs(linear), abs(angular))) for at, linear, angular in rows]
    rows += [(at, 0.0) for at, what, args in facts
             if what == 'fail' and args[0] == ('robot', robot) and args[1] != 'hung']
    # Of the same instant the last one counts.
    rows.sort(key=lambda row: row[0])
    return [row[0] for row in rows], [row[1] for row in rows]


class Judge:
    """Replays what was told and compares what each robot did."""

    def __init__(self, world, lag, end):
        self.facts = sorted(world.facts, key=lambda fact: fact[0])
        self.motion = {name: motion(world.log_of(name), self.facts, name) for name in ROBOTS}
        self.lag, self.end, self.said = lag, end, world.said
        self.violations, self.stands, self.drives = [], {}, {}
        self.counts = Counter()

    def moved(self, name, begin, end):
        """Return (whether it moved at all, whether it did all the time) between two times."""
        times, speeds = self.motion[name]
        low = bisect.bisect_right(times, begin) - 1
        inside = speeds[max(low, 0):bisect.bisect_left(times, end)] if times else []
        return any(inside), bool(inside) and all(inside)

    def until(self, name, begin, moving):
        """Return how long after a time a robot moves, or stands, first."""
        times, speeds = self.motion[name]
        low = max(bisect.bisect_right(times, begin) - 1, 0)
        return next((max(0.0, at - begin) for at, speed in zip(times[low:], speeds[low:])
                     if bool(speed) == moving), None)

    def judge(self):
        """Ask the model all along."""
        model, facts = ReferenceModel(ROBOTS, OPERATORS), list(self.facts)
        now = facts[0][0]
        while now < self.end:
            while facts and facts[0][0] <= now:
                at, what, args = facts.pop(0)
                model.tell(at, what, *args)
            slack_s = self.lag.slack_s(now)
            later = min([now + GRID_S] + [fact[0] for fact in facts[:1]])
            news = facts and facts[0][0] - now < TOLD_S
            for name in ROBOTS:
                verdict = model.verdict(name, now, slack_s)
                if not (news and verdict.what == DRIVE):
                    self._compare(name, verdict, now, later)
            if model.must_say(now, slack_s):
                self._hear(model.parts['undertaker'].since, now)
            now = later if later > now else now + 1e-6
        return self

    def _hear(self, since, now):
        """Look whether the mux has said by now that it waits for the undertaker."""
        said = self.said[:bisect.bisect_right(self.said, (now, chr(0x10ffff)))]
        if not said or said[-1][1] not in (UNDERTAKER, RELEASE) or said[-1][0] < since:
            self._note({'robot': 'mux', 'what': 'must say', 'why': 'undertaker hung',
                        'since': since, 'begin': now, 'end': now})

    def _compare(self, name, verdict, now, later):
        self.counts[verdict.what] += later - now
        moved, all_along = self.moved(name, now, later)
        wrong = verdict.what == STAND and moved or verdict.what == DRIVE and not all_along
        if verdict.what == STAND:
            self.stands.setdefault((name, verdict.why, round(verdict.since, 3)), verdict.since)
        elif verdict.what == DRIVE:
            self.drives.setdefault((name, round(verdict.since, 3)), verdict.since)
        if wrong:
            self._note({'robot': name, 'what': verdict.what, 'why': verdict.why,
                        'since': verdict.since, 'begin': now, 'end': later})

    def _note(self, new):
        """Note a violation, or that it goes on."""
        for entry in self.violations[-8:]:
            if all(entry[key] == new[key] for key in ('robot', 'what')) \
                    and new['begin'] - entry['end'] < 0.1:
                entry['end'] = new['end']
                return
        self.violations.append(new)


def kind_at(done, when):
    """Return the kind of the event that was being done at a time."""
    index = bisect.bisect_right([at for at, _ in done], when + 0.005) - 1
    return done[index][1] if index >= 0 else 'start'


def table(events, judge):
    """Return the table: how often each kind was done, and how long robots took to stand."""
    done = sorted(events.done)
    counts = Counter(kind for _, kind in done)
    taken, wrong = defaultdict(list), Counter()
    for (name, _, _), since in judge.stands.items():
        if judge.moved(name, since - 0.005, since)[1]:
            stands = judge.until(name, since, False)
            if stands is not None:
                taken[kind_at(done, since)].append(stands)
    for entry in judge.violations:
        wrong[kind_at(done, entry['since'])] += 1
    lines = ['{:18} {:>6} {:>10} {:>7} {:>8} {:>8}'.format(
        'event', 'times', 'violations', 'stops', 'p50 [s]', 'max [s]')]
    for kind in sorted(set(counts) | set(taken) | set(wrong)):
        times = taken[kind]
        lines.append('{:18} {:6} {:10} {:7} {:>8} {:>8}'.format(
            kind, counts[kind], wrong[kind], len(times),
            '{:.3f}'.format(statistics.median(times)) if times else '',
            '{:.3f}'.format(max(times)) if times else ''))
    lines.append('robot seconds: ' + ', '.join(
        '{} {:.0f}'.format(what, seconds) for what, seconds in sorted(judge.counts.items())))
    return '\n'.join(lines)


def tell_violation(number, entry, judge, begin):
    """Print what came before a violation and what the robot did."""
    print('\nVIOLATION {}: {} {} ({}, since {:.3f}) from {:.3f} to {:.3f}'.format(
        number, entry['robot'], entry['what'], entry['why'], entry['since'] - begin,
        entry['begin'] - begin, entry['end'] - begin))
    rows = [(at, 'told {} {}'.format(what, args)) for at, what, args in judge.facts]
    changes = list(zip(*judge.motion.get(entry['robot'], ((), ()))))
    rows += [(at, '  {} now {}'.format(entry['robot'], 'moves' if speed else 'stands'))
             for (_, before), (at, speed) in zip(changes, changes[1:])
             if bool(before) != bool(speed)]
    for at, words in sorted(rows, key=lambda row: row[0]):
        if entry['begin'] - 9.0 <= at <= entry['end'] + 1.0:
            print('  {:9.3f} {}'.format(at - begin, words))


@pytest.fixture
def world(tmp_path):
    reason = machines.why_not()
    if reason:
        pytest.skip(reason)
    folder = Path(os.environ.get('MHRI_KEEP') or tmp_path)
    folder.mkdir(parents=True, exist_ok=True)
    with machines.Lan(folder) as lan, World(lan) as built:
        yield built


def test_no_robot_moves_that_must_stand_nor_stands_that_must_drive(world):
    print('\nseed {}: repeat with MHRI_SEED={} MHRI_EVENTS={}'.format(SEED, SEED, EVENTS),
          flush=True)
    events, lag = Events(world, random.Random(SEED)), LagMeter(SLACK_S)
    begin, calm_at = time.monotonic(), CALM_EVERY
    # Too rare at random for the short form.
    events.while_driven()
    events.calm()
    while len(events.done) < EVENTS and time.monotonic() - begin < LIMIT_S:
        events.one()
        world.wait(events.dice.choice((0.0, events.dice.uniform(0.0, 1.2))))
        if len(events.done) >= calm_at:
            calm_at += CALM_EVERY
            events.calm()
            print('{} events, {:.0f} s'.format(len(events.done), time.monotonic() - begin),
                  flush=True)
    lag.stop()
    (world.folder / 'facts.txt').write_text(''.join(
        '{:.6f} {} {!r}\n'.format(at - begin, what, args) for at, what, args in world.facts))
    judge = Judge(world, lag, time.monotonic()).judge()
    for number, entry in enumerate(judge.violations, 1):
        tell_violation(number, entry, judge, begin)
    print('\nseed {}, {} events in {:.0f} s\n{}'.format(
        SEED, len(events.done), time.monotonic() - begin, table(events, judge)), flush=True)
    assert judge.counts[STAND] > 10.0 and judge.counts[DRIVE] > 1.0, 'nothing was judged'
    assert not judge.violations and not world.left
    world.journal.conforms()
