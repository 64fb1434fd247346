# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A journal is all that a drive needs to say the same again; what was said otherwise is found."""
import collections
import contextlib
import functools
import importlib
import json
import random
import struct

import pytest
from test_every_state import DRIVING, PADDING, SCENES

from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits
from mhri.devices.profile import JoyRefused, Stick
from mhri.driving import drive
from mhri.driving.journal import BEGIN, EVENTS, JournalDrive, LEFT, line_of, replay
from mhri.driving.operator_lease import Caller
from mhri.driving.sources import MuxConfig, Source
from support import driving_world
from support.every_state import Violation
from support.mutated import changed_module, mutated

CONFIG = MuxConfig((Source('joy', 'joy', '/joy', None),), 'joy', 0.5, 1.0)
PANEL = Caller('/panel', 'uri', 'host')
RESTS, OUT = Stick(0.0, 0.0, True), Stick(1.0, 0.0, False)
WRONG = [
    ('arbiter', '(DRIVING, RESTS): (READY, ZEROS)', '(DRIVING, RESTS): (READY, NOTHING)', 'stops'),
    ('arbiter', 'ENABLING_TIMEOUT_S = 0.25', 'ENABLING_TIMEOUT_S = 0.45', 'sources'),
    ('robot_rule', 'HELD: IF_MOVING', 'HELD: NEVER', 'robots'),
    ('robot_rule', 'if allowed.speed_mps >= self._last.speed_mps:', 'if True:', 'robots'),
    ('operator_lease', 'LEASE_S = 1.5', 'LEASE_S = 1.7', 'operators'),
    ('topic_owner', 'if self._claimed in there:', 'if False:',
     'operators'),
    ('drive', '        if not self._undertaken:\n            velocity = ZERO', '        pass',
     'robots'),
    ('drive', "if kept.get('stop'):", 'if False:', 'stops')]


class Noted:
    """The lines that drives have noted, each of them a run of its own."""

    def __init__(self):
        self.lines, self.runs = [], 0

    def drive(self, *facts, **named):
        self.runs += 1
        return JournalDrive(functools.partial(self.note, 'run{}'.format(self.runs)), *facts,
                            **named)

    def note(self, run, *entry):
        self.lines.append(line_of(run, *entry))

    def leave(self, robot, velocity, topic='cmd_vel'):
        linear_mps, angular_rad_s, lateral_mps = velocity
        # As it goes over the line: its length, or what a stamped one has before it.
        self.note('run1', LEFT, robot, topic, bytes(4) + struct.pack(
            '<6d', linear_mps, lateral_mps, 0.0, 0.0, 0.0, angular_rad_s))


@pytest.fixture
def noted(monkeypatch):
    found = Noted()
    monkeypatch.setattr(driving_world, 'Drive', found.drive)
    return found


def walk(noted, scene, seed, steps, way=()):
    """Let things happen at random; return the lines of that."""
    noted.lines, noted.runs, dice = [], 0, random.Random(seed)
    world = driving_world.World(frozenset(SCENES[scene].options), collections.Counter())
    # Where a rule is wrong, the world says so, too.
    with contextlib.suppress(Violation):
        for event in way or dice.choice(SCENES[scene].ways):
            world.do(event)
        for _ in range(steps):
            world.do(dice.choice(SCENES[scene].events))
    return noted.lines


def driven(noted, brake=lambda velocity, _: velocity):
    """Return a drive by which two robots move."""
    made = noted.drive(CONFIG, 0.0)
    for name in ('bot1', 'bot2'):
        made.open(name, Limits(0.4, 1.0), 0.1, brake)
    made.on_wish(PANEL, ('bot1', 'bot2'), (), '', 0.2)
    for stick in (RESTS, OUT):
        orders, _ = made.on_source('joy', '/panel', ('/panel', 1, ''), lambda _: stick, 0.3)
    assert orders == [('bot1', Velocity(0.4)), ('bot2', Velocity(0.4))]
    return made


@pytest.mark.parametrize('scene', SCENES)
@pytest.mark.parametrize('seed', range(2))
def test_whatever_has_happened_leads_to_the_same_again(noted, scene, seed):
    lines = walk(noted, scene, seed, 200)
    report = replay(lines)
    assert report[3:] == ('', ())
    assert (report.runs, report.events) == (noted.runs, len(lines) - noted.runs)


def test_walks_make_use_of_all_that_can_happen(noted):
    entries = [json.loads(line) for scene in SCENES for seed in range(3)
               for line in walk(noted, scene, seed, 200)]
    # The rest is not in that world.
    assert set(EVENTS).difference(entry[1] for entry in entries) == {
        'on_abandoned', 'on_round_trip', 'on_report', 'on_finished', 'close'}
    assert sum(order[1] > 0.0 for entry in entries if entry[1] != BEGIN
               for order in entry[5] if len(order) == 4) > 100, 'nothing has moved'
    assert any('"brake"' in line for seed in range(20) for line in walk(
        noted, 'robots', seed, 50, DRIVING)), 'nothing was braked'


@pytest.mark.parametrize('module, old, new, scene', WRONG)
def test_what_a_wrong_rule_has_said_is_found_with_a_short_list(noted, module, old, new, scene):
    real = importlib.import_module('{}.{}'.format(drive.__package__, module))
    for seed in range(100):
        with mutated(vars(real), changed_module(real, old, new)):
            walk(noted, scene, seed, 60, PADDING if scene == 'sources' else DRIVING)
        report = replay(noted.lines)
        if report.difference:
            break
    print(seed, len(noted.lines), report.difference, *report.shortest, sep='\n')
    rest = iter(noted.lines)
    assert all(line in rest for line in report.shortest), 'no part of the journal'
    again = replay(report.shortest)
    assert again.difference and again.events == len(report.shortest) - 1 < 40


def test_what_was_asked_and_failed_is_told_again(noted):
    """A brake that fails, a message that cannot be read, an event that fails."""
    fails = []

    def brake(velocity, _):
        if fails:
            raise ValueError('no place')
        return velocity

    def read(_):
        raise JoyRefused('no_axes', 'a Joy message without axes')
    made = driven(noted, brake)
    assert made.on_source('joy', '/panel', ('/panel', 1, ''), read, 0.35)[1]
    fails.append(1)
    assert made.tick(0.36, [PANEL]) == [('bot1', ZERO), ('bot2', ZERO)]
    with pytest.raises(KeyError):
        made.on_joined('bot3', 0.37)
    made.on_round_trip('bot1', float('nan'))
    made.on_abandoned('bot1', 0.38)
    made.close(0.4)
    assert replay(noted.lines)[1:4] == (len(noted.lines) - 1, 0, '')


def test_the_next_drive_knows_what_was_kept(noted):
    made = driven(noted)
    made.on_stop(0.4)
    noted.drive(CONFIG, 1.0, made.kept(), connected=lambda source: {'/panel'})
    assert '"stop":true' in noted.lines[-1]
    assert replay(noted.lines)[:2] == (2, len(noted.lines) - 2)


def test_half_a_line_is_the_end_of_a_drive(noted):
    driven(noted)
    for cut in (1, len(noted.lines[-1]) // 2, len(noted.lines[-1]) - 1):
        half = noted.lines[:-1] + [noted.lines[-1][:cut]]
        again = [line.replace('run1', 'run2') for line in noted.lines]
        assert replay(half)[:2] == (1, len(noted.lines) - 2)
        assert replay(half + [''] + again)[:2] == (2, 2 * len(noted.lines) - 3)
        with pytest.raises(ValueError):
            replay(half + again[1:])


@pytest.mark.parametrize('line', [
    '["run1","begin",{"version":1},[]]', '["run1","begin",7]',
    '["run1","tick",[0.1],{},[],[],false]',
    '{"a": 1}\n["run1","tick",[0.1],{},[],[],false]'])
def test_what_is_no_journal_of_this_version_is_refused(line):
    with pytest.raises(ValueError, match='line 1'):
        replay(line.splitlines())


def test_what_left_is_what_was_ordered_and_zeros(noted):
    driven(noted)
    for name in ('bot1', 'bot2', 'bot1'):
        noted.leave(name, Velocity(0.4) if len(noted.lines) < 8 else ZERO)
    assert replay(noted.lines)[2:4] == (3, '')


@pytest.mark.parametrize('left', [
    [('bot1', Velocity(0.5))], [('bot3', Velocity(0.4))], [('bot1', Velocity(0.4, 0.0, 0.1))],
    [('bot1', Velocity(0.4)), ('bot1', Velocity(0.4), 'other')]], ids=str)
def test_what_nobody_has_ordered_is_found(noted, left):
    driven(noted)
    for one in left:
        noted.leave(*one)
    report = replay(noted.lines)
    assert report.difference and len(report.shortest) == 2 + len(left)


@pytest.mark.parametrize('leaves', [True, False])
def test_a_zero_that_has_not_left_is_found(noted, leaves):
    made = driven(noted)
    noted.leave('bot1', Velocity(0.4))
    made.on_stop(0.4)
    if leaves:
        noted.leave('bot1', ZERO)
    made.tick(0.41)
    report = replay(noted.lines)
    assert bool(report.difference) != leaves, report
