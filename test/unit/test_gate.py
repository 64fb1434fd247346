# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: every event in every state, staleness to the millisecond."""
import random

import pytest

from mhri.core.driving.gate import common_limits, GateRule, JOIN_S, STALE_S
from mhri.core.driving.limits import Velocity, ZERO
from mhri.core.robots.robot_types import Limits

LIMITS = Limits(0.5, 1.0)
GO = Velocity(0.4, 0.2)

STATES = {
    'deselected': lambda gate: None,
    'selected': lambda gate: gate.select(True, 0.0),
    'driving': lambda gate: (gate.select(True, 0.0), gate.on_command(GO, 1.0)),
    'stopped': lambda gate: (gate.select(True, 0.0), gate.stop('mux', True, 0.5)),
    'stopped_deselected': lambda gate: gate.stop('mux', True, 0.5),
    'closed': lambda gate: (gate.select(True, 0.0), gate.close(0.5)),
}
EVENTS = {
    'command': lambda gate: gate.on_command(GO, 1.0),
    'zero': lambda gate: gate.on_command(ZERO, 1.0),
    'nan': lambda gate: gate.on_command(Velocity(float('nan'), 0.0), 1.0),
    'too_fast': lambda gate: gate.on_command(Velocity(1.0, 0.6), 1.0),
    'select': lambda gate: gate.select(True, 1.0),
    'deselect': lambda gate: gate.select(False, 1.0),
    'stop': lambda gate: gate.stop('panel', True, 1.0),
    'stop_withdrawn': lambda gate: gate.stop('mux', False, 1.0),
    'fresh_tick': lambda gate: gate.tick(1.0 + STALE_S - 0.001),
    'stale_tick': lambda gate: gate.tick(1.0 + STALE_S),
    'close': lambda gate: gate.close(1.0),
}
HALVED = Velocity(0.5, 0.3)
# What each event sends; events left out send nothing.
TABLE = {
    'deselected': {'stop': ZERO, 'close': ZERO},
    'selected': {'command': GO, 'zero': ZERO, 'nan': ZERO, 'too_fast': HALVED, 'deselect': ZERO,
                 'stop': ZERO, 'close': ZERO},
    'driving': {'command': GO, 'zero': ZERO, 'nan': ZERO, 'too_fast': HALVED, 'deselect': ZERO,
                'stop': ZERO, 'stale_tick': ZERO, 'close': ZERO},
    'stopped': {'close': ZERO},
    'stopped_deselected': {'close': ZERO},
    'closed': {},
}


@pytest.mark.parametrize('event', sorted(EVENTS))
@pytest.mark.parametrize('state', sorted(TABLE))
def test_every_event_in_every_state(state, event):
    """The table is the gate."""
    gate = GateRule(LIMITS)
    STATES[state](gate)
    sent = EVENTS[event](gate)
    assert sent == TABLE[state].get(event)
    assert gate.driving == (sent is not None and not sent.is_zero()
                            or sent is None and state == 'driving')


@pytest.mark.parametrize('end', ['deselect', 'stop', 'stale_tick', 'close', 'zero'])
def test_one_zero_then_silence(end):
    """Endless zeros would block a robot's own navigation."""
    gate = GateRule(LIMITS)
    STATES['driving'](gate)
    assert EVENTS[end](gate) == ZERO
    assert gate.next_tick() is None
    assert [gate.tick(2.0 + count) for count in range(10)] == [None] * 10


def test_stale_to_the_millisecond():
    """Each command renews the lease; next_tick says when it ends."""
    gate = GateRule(LIMITS)
    gate.select(True, 0.0)
    gate.on_command(GO, 10.0)
    gate.on_command(GO, 10.25)
    assert gate.next_tick() == 10.75
    assert gate.tick(10.749) is None and gate.tick(10.75) == ZERO


def test_the_stop_ends_only_when_every_reason_is_withdrawn():
    """The panel's own press outlives the mux's word, and the other way round."""
    gate = GateRule(LIMITS)
    STATES['driving'](gate)
    assert gate.stop('panel', True, 2.0) == ZERO
    assert gate.stop('mux', True, 2.1) is None
    gate.stop('panel', False, 2.2)
    assert gate.stopped and gate.on_command(GO, 2.3) is None
    gate.stop('mux', False, 2.4)
    assert not gate.stopped and gate.on_command(GO, 2.5) == GO


def test_selection_made_while_stopped_counts_after_it():
    """And needs no second zero."""
    gate = GateRule(LIMITS)
    gate.stop('mux', True, 0.0)
    gate.select(True, 0.1)
    gate.stop('mux', False, 0.2)
    assert gate.on_command(GO, 0.3) == GO
    gate.stop('mux', True, 0.4)
    assert gate.select(False, 0.5) is None
    gate.stop('mux', False, 0.6)
    assert gate.on_command(GO, 0.7) is None


@pytest.mark.parametrize('seed', range(20))
def test_motion_never_ends_without_a_zero_and_never_begins_unselected(seed):
    """Random sequences; whoever ends motion says so at once, silence within a tick."""
    dice = random.Random(seed)
    gate, now, selected, stops, moving = GateRule(LIMITS), 0.0, False, set(), False
    for _ in range(1000):
        now += dice.choice((0.01, 0.05, 0.3))
        kind = dice.choice(('command', 'command', 'command', 'select', 'stop', 'tick'))
        if kind == 'command':
            sent = gate.on_command(Velocity(dice.uniform(-3, 3), dice.uniform(-3, 3)), now)
        elif kind == 'select':
            selected = dice.random() < 0.7
            sent = gate.select(selected, now)
        elif kind == 'stop':
            reason, stopped = dice.choice(('mux', 'panel')), dice.random() < 0.3
            (stops.add if stopped else stops.discard)(reason)
            sent = gate.stop(reason, stopped, now)
        else:
            sent = gate.tick(now)
        if sent is not None:
            moving = not sent.is_zero()
            assert abs(sent.linear_mps) <= 0.5 + 1e-9 and abs(sent.angular_rad_s) <= 1.0 + 1e-9
        assert not moving or (selected and not stops), 'moves though {}'.format(kind)
        assert moving == gate.driving


def joining():
    """A gate whose robot is selected while others are driven."""
    gate = GateRule(LIMITS)
    assert gate.on_command(GO, 1.0) is None
    assert gate.select(True, 1.02) is None
    return gate


def test_who_joins_a_drive_waits_for_the_zero_of_the_mux():
    gate = joining()
    assert gate.on_command(GO, 1.05) is None, 'nobody leaps'
    assert gate.on_command(ZERO, 1.06) == ZERO
    assert gate.on_command(GO, 1.5) == GO, 'after neutral, the mux lets all drive'


def test_who_joins_a_drive_of_something_that_is_no_mux_joins_a_little_later():
    """The newest command comes through then, even if it was the last one."""
    gate = joining()
    assert gate.on_command(GO, 1.1) is None
    assert gate.next_tick() == pytest.approx(1.02 + JOIN_S)
    assert gate.tick(1.02 + JOIN_S - 0.001) is None
    assert gate.tick(1.02 + JOIN_S) == GO
    late = joining()
    assert late.on_command(GO, 1.02 + JOIN_S) == GO


def test_a_wait_that_ends_in_silence_starts_nothing():
    gate = joining()
    assert gate.tick(1.0 + STALE_S) is None and not gate.driving
    assert gate.next_tick() is None


@pytest.mark.parametrize('end', [lambda gate: gate.select(False, 1.1),
                                 lambda gate: gate.stop('mux', True, 1.1),
                                 lambda gate: gate.close(1.1)])
def test_who_waits_can_still_be_deselected_stopped_and_closed(end):
    gate = joining()
    end(gate)
    assert gate.tick(1.02 + JOIN_S) is None and not gate.driving
    assert gate.on_command(GO, 1.4) is None


def test_who_is_selected_while_nothing_moves_is_driven_at_once():
    gate = GateRule(LIMITS)
    gate.on_command(GO, 1.0)
    gate.on_command(ZERO, 1.1)
    gate.select(True, 1.2)
    assert gate.on_command(GO, 1.21) == GO
    late = GateRule(LIMITS)
    late.on_command(GO, 1.0)
    late.select(True, 1.0 + STALE_S)
    assert late.on_command(GO, 1.6) == GO, 'that drive was over'


def test_a_group_keeps_to_its_slowest_along_the_same_curve():
    quick, slow = Limits(0.65, 3.14), Limits(0.22, 2.84)
    group = common_limits([quick, slow])
    assert group == Limits(0.22, 2.84)
    said = []
    for limits in (quick, slow):
        gate = GateRule(limits)
        gate.select(True, 0.0)
        gate.hold_to(group, 1.0)
        said.append(gate.on_command(Velocity(0.5, 1.0), 1.0))
    for velocity in said:
        assert (velocity.linear_mps, velocity.angular_rad_s) == pytest.approx((0.22, 0.44))
    gate.hold_to(limits, 0.5)
    assert gate.on_command(Velocity(0.2, 0.4), 1.1) == Velocity(0.1, 0.2)
    gate.hold_to(Limits(9.0, 9.0), 1.0)
    velocity = gate.on_command(Velocity(0.5, 1.0), 1.2)
    assert velocity.linear_mps == pytest.approx(0.22), 'its own limits hold'


def test_a_robot_that_is_not_heard_gets_one_zero_and_then_nothing():
    gate = GateRule(LIMITS)
    gate.select(True, 0.0)
    gate.on_command(GO, 1.0)
    assert gate.hold(True, 1.1) == ZERO and not gate.driving
    assert gate.hold(True, 1.2) is None, 'once'
    assert gate.on_command(GO, 1.3) is None
    assert gate.hold(False, 1.35) is None and gate.waits
    assert gate.on_command(GO, 1.4) is None and gate.next_tick() is None, 'not in the middle of it'
    assert gate.tick(9.0) is None
    assert gate.on_command(ZERO, 9.1) == ZERO and not gate.waits
    assert gate.on_command(GO, 9.2) == GO


def test_a_robot_heard_again_while_nothing_drives_is_driven_at_once():
    gate = GateRule(LIMITS)
    gate.select(True, 0.0)
    assert gate.hold(True, 0.5) is None, 'it was not driven: no zero'
    assert gate.hold(False, 2.0) is None and not gate.waits
    assert gate.on_command(GO, 2.1) == GO
    gate.hold(True, 2.2)
    assert gate.on_command(GO, 2.3) is None
    assert gate.hold(False, 2.3 + STALE_S) is None and not gate.waits, 'the commands went stale'


def test_held_changes_nothing_about_stops():
    gate = GateRule(LIMITS)
    gate.select(True, 0.0)
    gate.hold(True, 0.1)
    assert gate.stop('mux', True, 0.2) == ZERO and gate.select(False, 0.3) is None
    assert gate.close(0.4) == ZERO
