# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard on the robot: late commands, leases and clocks that do not agree."""
import ast
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
import random

import pytest

PATH = Path(__file__).resolve().parents[2] / 'utils' / 'remote' / 'mhri_guard'
GO, SLOW, ZERO = (0.3, 0.1), (0.1, 0.0), (0.0, 0.0)


@pytest.fixture(scope='module')
def guard_class():
    loader = SourceFileLoader('mhri_guard', str(PATH))
    module = module_from_spec(spec_from_loader('mhri_guard', loader))
    loader.exec_module(module)
    return module.Guard


@pytest.fixture
def guard(guard_class):
    made = guard_class()
    made.on_command(ZERO, 0.01, 0.0)
    return made


def test_it_needs_nothing_but_rospy_and_geometry_msgs():
    names = set()
    for node in ast.walk(ast.parse(PATH.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module)
    assert names - {'collections', 'math', 'sys', 'threading', 'time'} == {
        'rospy', 'geometry_msgs.msg'}


def test_a_fresh_command_passes_as_it_is(guard):
    assert guard.on_command(GO, 0.02, 1.0) == GO
    assert guard.tick(1.29) is None and guard.next_tick() == 1.3


def test_the_lease_ends_in_one_zero_and_silence(guard):
    guard.on_command(GO, 0.02, 1.0)
    assert guard.tick(1.3) == ZERO
    assert guard.tick(1.4) is None and guard.next_tick() is None
    assert guard.on_command(SLOW, 0.02, 2.0) == SLOW


@pytest.mark.parametrize('skew_s', [0.0, 3600.0, -3600.0, 0.4])
def test_a_backlog_is_not_replayed_whatever_the_clocks_say(guard_class, skew_s):
    guard, now = guard_class(), 0.0
    for number in range(40):
        now = 0.05 * number
        assert guard.on_command(GO, skew_s + 0.01, now) == GO
    # The link stalls for 3 s: one zero after the lease; then everything comes at once.
    assert guard.tick(now + 0.31) == ZERO
    back = now + 3.0
    said = [guard.on_command(SLOW, skew_s + 0.01 + 3.0 - 0.05 * number, back)
            for number in range(1, 61)]
    passed = [index for index, value in enumerate(said) if value == SLOW]
    assert said[:55] == [None] * 55 and guard.dropped >= 55
    assert passed == list(range(passed[0], 60)), 'the newest pass: they are not late'


def test_a_late_stop_is_still_a_stop(guard):
    guard.on_command(GO, 0.01, 1.0)
    assert guard.on_command(ZERO, 5.0, 1.1) == ZERO


def test_a_late_command_does_not_lengthen_the_lease(guard):
    guard.on_command(GO, 0.01, 1.0)
    assert guard.on_command(GO, 2.0, 1.2) is None
    assert guard.on_command(GO, 2.0, 1.3) == ZERO


@pytest.mark.parametrize('value', [(float('nan'), 0.0), (0.1, float('inf'))])
def test_what_is_not_finite_is_a_stop(guard, value):
    guard.on_command(GO, 0.01, 1.0)
    assert guard.on_command(value, 0.01, 1.1) == ZERO


def test_clocks_that_are_set_are_followed_after_the_memory(guard_class):
    guard = guard_class(memory_s=30.0)
    guard.on_command(GO, 0.01, 0.0)
    heard = [step for step in range(1, 800)
             if guard.on_command(GO, 5.01, 0.05 * step) == GO]
    assert heard and 29.0 <= 0.05 * heard[0] <= 31.5
    guard = guard_class()
    guard.on_command(GO, 5.01, 0.0)
    assert guard.on_command(GO, 0.01, 0.1) == GO, 'a smaller delay is the best at once'


def drive(guard, seconds, delay_s=0.01, begin=0.0):
    """Drive 20 times a second; return the time of the last command."""
    times = [begin + 0.05 * step for step in range(int(20 * seconds))]
    for now in times:
        guard.on_command(GO, delay_s, now)
    return times[-1]


@pytest.mark.parametrize('stall_s', [20.0, 29.5, 33.0, 600.0])
@pytest.mark.parametrize('flush_s', [0.01, 1.5, 5.0])
def test_a_backlog_is_not_replayed_however_long_it_waited(guard_class, stall_s, flush_s):
    guard = guard_class()
    last = drive(guard, 40.0)
    stamps = [last + 0.05 * step for step in range(1, int(20 * stall_s))]
    for index, stamp in enumerate(stamps):
        # The backlog comes as fast as the link gives it, oldest first; nothing newer joins it.
        now = last + stall_s + flush_s * index / len(stamps)
        said = guard.on_command(GO, now - stamp + 0.01, now)
        assert said != GO or now - stamp <= 0.2, 'a command from {:.1f} s ago'.format(now - stamp)
    assert drive(guard, 1.0, begin=now + 0.05) and guard.tick(now + 1.0) is None, 'it drives on'


def test_a_late_command_after_a_long_rest_is_late(guard_class):
    guard = guard_class()
    last = drive(guard, 5.0)
    assert guard.on_command(GO, 2.01, last + 31.0) != GO
    assert guard.on_command(GO, 0.02, last + 31.1) == GO


def test_clocks_that_drifted_overnight_are_believed_when_the_delay_stays(guard_class):
    guard = guard_class()
    now = drive(guard, 5.0) + 8 * 3600.0
    heard = [step for step in range(200)
             if guard.on_command(GO, 1.41 + 0.01 * (step % 5), now + 0.05 * step) == GO]
    assert 1.9 <= 0.05 * heard[0] <= 2.2 and heard == list(range(heard[0], 200))


def test_a_thousand_drives_never_outlast_the_lease(guard_class):
    rng = random.Random(5)
    guard, now, last = guard_class(), 0.0, None
    guard.on_command(ZERO, 0.01, now)
    for _ in range(20000):
        now += rng.choice([0.001, 0.05, 0.4])
        velocity = rng.choice([GO, SLOW, ZERO])
        delay = 0.01 + rng.choice([0.0, 0.1, 0.25, 3.0])
        before = guard.next_tick()
        if before is not None and before <= now:
            assert guard.tick(before) == ZERO
        said = guard.on_command(velocity, delay, now)
        if said is not None and said != ZERO:
            last = now
            assert delay < 0.22
        if guard.next_tick() is not None:
            assert guard.next_tick() == pytest.approx(last + 0.3)


def test_closing_stops_what_moves(guard):
    assert guard.close() is None
    guard.on_command(GO, 0.01, 1.0)
    assert guard.close() == ZERO and guard.close() is None
