# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: every event in every state, staleness to the millisecond."""
import random

import pytest

from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits
from mhri.driving.gate import (
    CLOSED, common_limits, GateRule, HELD, IDLE, JOINING, OPERATOR, STALE_S, STATES, STOPPED, TASK)

LIMITS = Limits(0.5, 1.0)
GO = Velocity(0.4, 0.2)
WORK = Velocity(0.1, 0.0)
HALVED = Velocity(0.5, 0.3)


def gate_in(state, moving=False):
    """Return a gate that has come to a state by the shortest way, at 1 s."""
    gate = GateRule(LIMITS, ZERO)
    {IDLE: lambda: None,
     JOINING: lambda: (gate.on_command(GO, 1.0), gate.check(True, 1.0)),
     OPERATOR: lambda: gate.check(True, 1.0),
     TASK: lambda: (gate.on_task(WORK, 1.0)),
     HELD: lambda: (gate.check(True, 1.0), gate.hold(True, 1.0)),
     STOPPED: lambda: (gate.check(True, 1.0), gate.stop(True, 1.0)),
     CLOSED: lambda: gate.close(1.0)}[state]()
    if moving:
        gate.on_command(GO, 1.0)
    return gate


EVENTS = {
    'command': lambda gate: gate.on_command(GO, 1.1),
    'zero': lambda gate: gate.on_command(ZERO, 1.1),
    'too_fast': lambda gate: gate.on_command(Velocity(1.0, 0.6), 1.1),
    'nan': lambda gate: gate.on_command(Velocity(float('nan'), 0.0), 1.1),
    'task': lambda gate: gate.on_task(WORK, 1.1),
    'task_zero': lambda gate: gate.on_task(ZERO, 1.1),
    'check': lambda gate: gate.check(True, 1.1),
    'uncheck': lambda gate: gate.check(False, 1.1),
    'stop': lambda gate: gate.stop(True, 1.1),
    'release': lambda gate: gate.stop(False, 1.1),
    'hold': lambda gate: gate.hold(True, 1.1),
    'hear': lambda gate: gate.hold(False, 1.1),
    'join': lambda gate: gate.join(1.1),
    'early_tick': lambda gate: gate.tick(1.0 + STALE_S - 0.001),
    'stale_tick': lambda gate: gate.tick(1.0 + STALE_S),
    'close': lambda gate: gate.close(1.1),
}
# (state, moving) -> {event: (what is sent, the state after it)}; what is left out changes nothing.
TABLE = {
    (IDLE, False): {
        'task': (WORK, TASK), 'task_zero': (ZERO, TASK), 'check': (ZERO, OPERATOR),
        'stop': (ZERO, STOPPED), 'hold': (None, HELD), 'close': (ZERO, CLOSED)},
    (JOINING, False): {
        'zero': (ZERO, OPERATOR), 'uncheck': (ZERO, IDLE), 'stop': (ZERO, STOPPED),
        'hold': (None, HELD), 'close': (ZERO, CLOSED)},
    (OPERATOR, False): {
        'command': (GO, OPERATOR), 'zero': (ZERO, OPERATOR), 'too_fast': (HALVED, OPERATOR),
        'nan': (ZERO, OPERATOR), 'uncheck': (ZERO, IDLE), 'stop': (ZERO, STOPPED),
        'hold': (None, HELD), 'close': (ZERO, CLOSED)},
    (OPERATOR, True): {
        'command': (GO, OPERATOR), 'zero': (ZERO, OPERATOR), 'too_fast': (HALVED, OPERATOR),
        'nan': (ZERO, OPERATOR), 'uncheck': (ZERO, IDLE), 'stop': (ZERO, STOPPED),
        'hold': (ZERO, HELD), 'join': (ZERO, JOINING), 'stale_tick': (ZERO, JOINING),
        'close': (ZERO, CLOSED)},
    (TASK, False): {
        'task': (WORK, TASK), 'task_zero': (ZERO, TASK), 'check': (ZERO, OPERATOR),
        'stop': (ZERO, STOPPED), 'hold': (ZERO, HELD), 'join': (ZERO, IDLE),
        'stale_tick': (ZERO, IDLE), 'close': (ZERO, CLOSED)},
    (HELD, False): {
        'uncheck': (None, HELD), 'stop': (ZERO, STOPPED), 'hear': (None, OPERATOR),
        'close': (ZERO, CLOSED)},
    (STOPPED, False): {
        'uncheck': (None, STOPPED), 'release': (None, JOINING), 'close': (ZERO, CLOSED)},
    (CLOSED, False): {},
}


def test_the_table_is_whole():
    assert {state for state, _ in TABLE} == set(STATES)


@pytest.mark.parametrize('event', sorted(EVENTS))
@pytest.mark.parametrize('state, moving', sorted(TABLE))
def test_every_event_in_every_state(state, moving, event):
    """The table is the gate."""
    gate = gate_in(state, moving)
    assert gate.state == state
    sent, after = TABLE[state, moving].get(event, (None, state))
    assert (EVENTS[event](gate), gate.state) == (sent, after)


@pytest.mark.parametrize('state, moving', sorted(TABLE))
def test_nothing_but_operator_and_task_lets_a_velocity_through(state, moving):
    gate = gate_in(state, moving)
    for now in (1.1, 1.2, 1.3):
        for sent in (gate.on_command(GO, now), gate.on_task(WORK, now)):
            assert sent is None or sent.is_zero() or gate.state in (OPERATOR, TASK)


@pytest.mark.parametrize('end', ['uncheck', 'stop', 'stale_tick', 'close', 'zero', 'hold', 'join'])
def test_one_zero_then_silence(end):
    """Endless zeros would block a robot's own navigation."""
    gate = gate_in(OPERATOR, moving=True)
    assert EVENTS[end](gate) == ZERO
    assert gate.next_tick() is None
    assert [gate.tick(2.0 + count) for count in range(10)] == [None] * 10


def test_stale_to_the_millisecond():
    """Each command renews the lease; next_tick says when it ends."""
    gate = gate_in(OPERATOR)
    gate.on_command(GO, 10.0)
    gate.on_command(GO, 10.25)
    assert gate.next_tick() == 10.75
    assert gate.tick(10.749) is None and gate.tick(10.75) == ZERO


@pytest.mark.parametrize('spoil', [
    lambda gate: (gate.hold(True, 1.2), gate.hold(False, 4.0)),
    lambda gate: (gate.stop(True, 1.2), gate.stop(False, 4.0)),
    lambda gate: gate.join(4.0),
    lambda gate: gate.tick(1.0 + STALE_S),
    lambda gate: (gate.check(False, 1.2), gate.check(True, 4.0)),
], ids=['lost link', 'stop', 'new connection', 'silent mux', 'unchecked'])
def test_a_held_stick_moves_nothing_after(spoil):
    """Whatever interrupts a drive: the stick has to be centred before the robot moves again."""
    gate = gate_in(OPERATOR, moving=True)
    spoil(gate)
    assert [gate.on_command(GO, 4.0 + 0.05 * count) for count in range(40)] == [None] * 40
    assert gate.stands == JOINING
    assert gate.on_command(ZERO, 6.1) == ZERO and gate.stands == ''
    assert gate.on_command(GO, 6.2) == GO


@pytest.mark.parametrize('spoil', [
    lambda gate: (gate.hold(True, 1.2), gate.hold(False, 4.0)),
    lambda gate: gate.join(4.0),
    lambda gate: (gate.check(False, 1.2), gate.check(True, 4.0)),
], ids=['lost link', 'new connection', 'unchecked'])
def test_with_the_stick_centred_nothing_is_waited_for(spoil):
    gate = gate_in(OPERATOR, moving=True)
    gate.on_command(ZERO, 1.1)
    spoil(gate)
    assert gate.on_command(GO, 4.1) == GO


def test_zeros_of_the_stop_itself_are_no_centred_stick():
    gate = gate_in(OPERATOR, moving=True)
    gate.stop(True, 1.1)
    assert gate.on_command(ZERO, 1.15) is None
    gate.stop(False, 1.2)
    assert gate.on_command(GO, 1.3) is None and gate.stands == JOINING


def test_a_gate_that_knows_nothing_assumes_that_everybody_waits():
    """After a restart: whether the stick is held is not known."""
    gate = GateRule(LIMITS)
    gate.check(True, 0.0)
    assert gate.on_command(GO, 0.1) is None
    assert gate.on_command(ZERO, 0.2) == ZERO and gate.on_command(GO, 0.3) == GO


def test_a_robot_that_comes_up_in_the_middle_of_a_drive_waits():
    gate = GateRule(LIMITS, GO)
    gate.check(True, 0.0)
    assert gate.on_command(GO, 0.1) is None and gate.stands == JOINING


@pytest.mark.parametrize('take_away', [
    lambda gate: (gate.check(True, 2.0), gate.check(False, 2.1)),
    lambda gate: (gate.stop(True, 2.0), gate.stop(False, 2.1)),
    lambda gate: (gate.hold(True, 2.0), gate.hold(False, 2.1)),
])
def test_a_task_goes_on_by_itself_after_nothing(take_away):
    gate = GateRule(LIMITS, ZERO)
    assert gate.on_task(WORK, 1.9) == WORK
    take_away(gate)
    assert gate.on_task(WORK, 2.15) is None, 'it just went on talking'
    assert gate.on_task(ZERO, 2.2) == ZERO, 'begun anew'
    assert gate.on_task(WORK, 2.25) == WORK


def test_whom_a_robot_obeys():
    gate = GateRule(LIMITS, ZERO)
    assert gate.obeys == ''
    gate.on_task(WORK, 1.0)
    assert gate.obeys == TASK
    gate.check(True, 1.1)
    assert gate.obeys == OPERATOR and gate.on_task(WORK, 1.2) is None
    gate.stop(True, 1.3)
    assert (gate.obeys, gate.stands) == (OPERATOR, STOPPED)


@pytest.mark.parametrize('seed', range(20))
def test_motion_never_ends_without_a_zero_and_never_begins_uncentred(seed):
    """Random events beside a plain model of when a robot may move."""
    dice = random.Random(seed)
    gate, now = GateRule(LIMITS, ZERO), 0.0
    checked = stopped = held = moving = False
    centred, heard = True, ZERO
    for _ in range(2000):
        now += dice.choice((0.01, 0.05, 0.3))
        kind = dice.choice(('command', 'command', 'command', 'zero', 'check', 'stop', 'hold',
                            'join', 'tick'))
        if kind in ('command', 'zero'):
            heard = ZERO if kind == 'zero' else Velocity(dice.uniform(-3, 3), dice.uniform(-3, 3))
            centred = centred or kind == 'zero' and not stopped
            sent = gate.on_command(heard, now)
        elif kind == 'check':
            was, checked = checked, dice.random() < 0.7
            centred = centred and (not checked or was == checked or heard.is_zero())
            sent = gate.check(checked, now)
        elif kind == 'stop':
            was, stopped = stopped, dice.random() < 0.3
            centred = centred and (was or not stopped)
            sent = gate.stop(stopped, now)
        elif kind == 'hold':
            was, held = held, dice.random() < 0.3
            centred = centred and (was == held or heard.is_zero())
            sent = gate.hold(held, now)
        elif kind == 'join':
            centred = centred and heard.is_zero()
            sent = gate.join(now)
        else:
            sent = gate.tick(now)
        if sent is not None:
            moving = not sent.is_zero()
            assert abs(sent.linear_mps) <= 0.5 + 1e-9 and abs(sent.angular_rad_s) <= 1.0 + 1e-9
        assert not moving or (checked and not stopped and not held and centred), kind
        assert moving == (not gate.sent.is_zero())


def test_a_group_keeps_to_its_slowest_along_the_same_curve():
    quick, slow = Limits(0.65, 3.14), Limits(0.22, 2.84)
    group = common_limits([quick, slow])
    assert group == Limits(0.22, 2.84)
    said = []
    for limits in (quick, slow):
        gate = GateRule(limits, ZERO)
        gate.check(True, 0.0)
        gate.hold_to(group, 1.0)
        said.append(gate.on_command(Velocity(0.5, 1.0), 1.0))
    for velocity in said:
        assert (velocity.linear_mps, velocity.angular_rad_s) == pytest.approx((0.22, 0.44))
    gate.hold_to(limits, 0.5)
    assert gate.on_command(Velocity(0.2, 0.4), 1.1) == Velocity(0.1, 0.2)
    gate.hold_to(Limits(9.0, 9.0), 1.0)
    velocity = gate.on_command(Velocity(0.5, 1.0), 1.2)
    assert velocity.linear_mps == pytest.approx(0.22), 'its own limits hold'
