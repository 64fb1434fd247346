# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rule of one robot: every event in every state, zeros and stale tasks to the millisecond."""
import pytest

from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits
from mhri.driving.robot_rule import (
    CLOSED, common_limits, HELD, IDLE, JOINING, OPERATOR, RobotRule, STATES, STOPPED,
    STOPPED_ALONE, TASK, TASK_STALE_S)

LIMITS = Limits(0.5, 1.0)
GO = Velocity(0.4, 0.2)
WORK = Velocity(0.1, 0.0)
HALVED = Velocity(0.5, 0.3)
# Why nothing may be sent to a robot.
WHY = 'not_heard'


def rule_in(state, moving=False):
    """Return a rule that has come to a state by the shortest way, at 1 s."""
    rule = RobotRule(LIMITS, ZERO)
    {IDLE: lambda: None,
     JOINING: lambda: (rule.on_command(GO, 1.0), rule.select(True, 1.0)),
     OPERATOR: lambda: rule.select(True, 1.0),
     TASK: lambda: (rule.on_task(WORK, 1.0)),
     HELD: lambda: (rule.select(True, 1.0), rule.hold(WHY, 1.0)),
     STOPPED: lambda: (rule.select(True, 1.0), rule.stop(True, False, 1.0)),
     STOPPED_ALONE: lambda: (rule.select(True, 1.0), rule.stop(False, True, 1.0)),
     CLOSED: lambda: rule.close(1.0)}[state]()
    if moving:
        rule.on_command(GO, 1.0)
    return rule


EVENTS = {
    'command': lambda rule: rule.on_command(GO, 1.1),
    'zero': lambda rule: rule.on_command(ZERO, 1.1),
    'too_fast': lambda rule: rule.on_command(Velocity(1.0, 0.6), 1.1),
    'nan': lambda rule: rule.on_command(Velocity(float('nan'), 0.0), 1.1),
    'task': lambda rule: rule.on_task(WORK, 1.1),
    'task_zero': lambda rule: rule.on_task(ZERO, 1.1),
    'left_out': lambda rule: rule.on_task(None, 1.1),
    'select': lambda rule: rule.select(True, 1.1),
    'deselect': lambda rule: rule.select(False, 1.1),
    'stop': lambda rule: rule.stop(True, False, 1.1),
    'stop_alone': lambda rule: rule.stop(False, True, 1.1),
    'stop_both': lambda rule: rule.stop(True, True, 1.1),
    'release': lambda rule: rule.stop(False, False, 1.1),
    'hold': lambda rule: rule.hold(WHY, 1.1),
    'hear': lambda rule: rule.hold('', 1.1),
    'join': lambda rule: rule.join(1.1),
    'stale_tick': lambda rule: rule.tick(2.0),
    'close': lambda rule: rule.close(1.1),
}
STOPS = {'stop': (ZERO, STOPPED), 'stop_both': (ZERO, STOPPED),
         'stop_alone': (ZERO, STOPPED_ALONE), 'close': (ZERO, CLOSED)}
# (state, moving) -> {event: (what is sent, the state after it)}; what is left out changes nothing.
TABLE = {
    (IDLE, False): {
        **STOPS, 'task': (WORK, TASK), 'task_zero': (ZERO, TASK), 'select': (ZERO, OPERATOR),
        'hold': (None, HELD)},
    (JOINING, False): {
        **STOPS, 'zero': (ZERO, OPERATOR), 'deselect': (ZERO, IDLE), 'hold': (None, HELD)},
    (OPERATOR, False): {
        **STOPS, 'command': (GO, OPERATOR), 'zero': (ZERO, OPERATOR),
        'too_fast': (HALVED, OPERATOR), 'nan': (ZERO, OPERATOR), 'deselect': (ZERO, IDLE),
        'hold': (None, HELD)},
    (OPERATOR, True): {
        **STOPS, 'command': (GO, OPERATOR), 'zero': (ZERO, OPERATOR),
        'too_fast': (HALVED, OPERATOR), 'nan': (ZERO, OPERATOR), 'deselect': (ZERO, IDLE),
        'hold': (ZERO, HELD), 'join': (ZERO, JOINING)},
    (TASK, False): {
        **STOPS, 'task': (WORK, TASK), 'task_zero': (ZERO, TASK), 'select': (ZERO, OPERATOR),
        'hold': (ZERO, HELD), 'join': (ZERO, IDLE), 'stale_tick': (ZERO, IDLE)},
    (HELD, False): {**STOPS, 'hear': (None, OPERATOR)},
    (STOPPED, False): {
        'stop_alone': (ZERO, STOPPED_ALONE), 'release': (None, JOINING), 'close': (ZERO, CLOSED)},
    (STOPPED_ALONE, False): {
        'stop': (ZERO, STOPPED), 'stop_both': (ZERO, STOPPED), 'release': (None, OPERATOR),
        'close': (ZERO, CLOSED)},
    (CLOSED, False): {},
}


def test_the_table_is_whole():
    assert {state for state, _ in TABLE} == set(STATES)


@pytest.mark.parametrize('event', sorted(EVENTS))
@pytest.mark.parametrize('state, moving', sorted(TABLE))
def test_every_event_in_every_state(state, moving, event):
    """The table is the rule."""
    rule = rule_in(state, moving)
    assert rule.state == state
    sent, after = TABLE[state, moving].get(event, (None, state))
    assert (EVENTS[event](rule), rule.state) == (sent, after)


@pytest.mark.parametrize('state, moving', sorted(TABLE))
def test_nothing_but_operator_and_task_lets_a_velocity_through(state, moving):
    rule = rule_in(state, moving)
    for now in (1.1, 1.2, 1.3):
        for sent in (rule.on_command(GO, now), rule.on_task(WORK, now)):
            assert sent is None or sent.is_zero() or rule.state in (OPERATOR, TASK)


@pytest.mark.parametrize('begin, end', [
    (state, end) for state in (OPERATOR, TASK)
    for end in ('select', 'deselect', 'stop', 'stop_alone', 'close', 'zero', 'join')
    if (state, end) not in ((OPERATOR, 'select'), (TASK, 'deselect'), (TASK, 'zero'))])
def test_a_zero_at_once_zeros_at_20_hz_for_half_a_second_then_silence(begin, end):
    """Endless zeros would block a robot's own navigation."""
    rule = rule_in(begin, moving=begin == OPERATOR)
    assert EVENTS[end](rule) == ZERO
    ticks = [1.1 + 0.01 * count for count in range(1, 200)]
    zeros = [now for now in ticks if rule.tick(now) == ZERO]
    gaps = [later - sooner for sooner, later in zip([1.1] + zeros, zeros)]
    assert 8 <= len(zeros) <= 10 and max(gaps) < 0.0601 and zeros[-1] <= 1.6


def test_a_robot_that_may_not_be_sent_anything_gets_one_zero():
    rule = rule_in(OPERATOR, moving=True)
    assert rule.hold(WHY, 1.1) == ZERO
    assert [rule.tick(1.1 + 0.01 * count) for count in range(200)] == [None] * 200


def test_zeros_of_the_rule_and_of_the_stick_do_not_add_up():
    rule = rule_in(OPERATOR, moving=True)
    rule.on_command(ZERO, 1.1)
    for count in range(1, 10):
        now = 1.1 + 0.05 * count
        rule.on_command(ZERO, now)
        assert rule.tick(now) is None


def test_a_silent_task_ends_to_the_millisecond():
    rule = rule_in(TASK)
    assert rule.next_tick(1.0) == 1.0 + TASK_STALE_S == 1.25
    assert rule.tick(1.0 + TASK_STALE_S - 0.001) is None
    assert rule.tick(1.0 + TASK_STALE_S) == ZERO
    assert rule.next_tick(1.0 + TASK_STALE_S) == pytest.approx(1.05 + TASK_STALE_S)


@pytest.mark.parametrize('event, now', [
    (lambda rule: rule.stop(True, False, 1.2), 4.0),
    (lambda rule: rule.select(False, 1.2), 4.0),
    (lambda rule: (rule.hold(WHY, 1.2), rule.hold('', 4.0)), 4.0),
    (lambda rule: (rule.on_command(ZERO, 1.1), rule.on_command(GO, 1.2)), 1.3),
], ids=['stopped', 'deselected', 'held meanwhile', 'driven on'])
def test_where_no_zero_is_due_the_drive_is_not_called_again_and_again(event, now):
    """It came too late for the last of them, or the robot moves: it would do nothing else."""
    rule = rule_in(OPERATOR, moving=True)
    event(rule)
    assert rule.tick(now) is None and rule.next_tick(now) is None


@pytest.mark.parametrize('spoil', [
    lambda rule: (rule.hold(WHY, 1.2), rule.hold('', 4.0)),
    lambda rule: (rule.stop(True, False, 1.2), rule.stop(False, False, 4.0)),
    lambda rule: (rule.stop(False, True, 1.2), rule.stop(False, False, 4.0)),
    lambda rule: rule.join(4.0),
    lambda rule: (rule.select(False, 1.2), rule.select(True, 4.0)),
], ids=['lost link', 'stop', 'stopped alone', 'new connection', 'deselected'])
def test_a_held_stick_moves_nothing_after(spoil):
    """Whatever interrupts a drive: the stick has to be centred before the robot moves again."""
    rule = rule_in(OPERATOR, moving=True)
    spoil(rule)
    assert [rule.on_command(GO, 4.0 + 0.05 * count) for count in range(40)] == [None] * 40
    assert rule.stop_reason == JOINING
    assert rule.on_command(ZERO, 6.1) == ZERO and rule.stop_reason == ''
    assert rule.on_command(GO, 6.2) == GO


@pytest.mark.parametrize('spoil', [
    lambda rule: (rule.hold(WHY, 1.2), rule.hold('', 4.0)),
    lambda rule: rule.join(4.0),
    lambda rule: (rule.select(False, 1.2), rule.select(True, 4.0)),
], ids=['lost link', 'new connection', 'deselected'])
def test_with_the_stick_centred_nothing_is_waited_for(spoil):
    rule = rule_in(OPERATOR, moving=True)
    rule.on_command(ZERO, 1.1)
    spoil(rule)
    assert rule.on_command(GO, 4.1) == GO


def test_zeros_of_the_stop_itself_are_no_centred_stick():
    rule = rule_in(OPERATOR, moving=True)
    rule.stop(True, False, 1.1)
    assert rule.on_command(ZERO, 1.15) is None
    rule.stop(False, False, 1.2)
    assert rule.on_command(GO, 1.3) is None and rule.stop_reason == JOINING


@pytest.mark.parametrize('command', [None, GO])
def test_a_robot_that_comes_up_in_the_middle_of_a_drive_waits(command):
    """Or after a restart: whether the stick is held is not known."""
    rule = RobotRule(LIMITS, command)
    rule.select(True, 0.0)
    assert rule.on_command(GO, 0.1) is None and rule.stop_reason == JOINING
    assert rule.on_command(ZERO, 0.2) == ZERO and rule.on_command(GO, 0.3) == GO


@pytest.mark.parametrize('take_away', [
    lambda rule: (rule.select(True, 2.0), rule.select(False, 2.1)),
    lambda rule: (rule.stop(True, False, 2.0), rule.stop(False, False, 2.1)),
    lambda rule: (rule.stop(False, True, 2.0), rule.stop(False, False, 2.1)),
    lambda rule: (rule.hold(WHY, 2.0), rule.hold('', 2.1)),
    lambda rule: rule.join(2.1),
], ids=['taken over', 'stop', 'stopped alone', 'lost link', 'new operator'])
@pytest.mark.parametrize('end', ['left out', 'silent'])
def test_a_task_goes_on_by_itself_after_nothing(take_away, end):
    """It has to leave the robot out first, or say nothing for a while: a zero of it is none."""
    rule = RobotRule(LIMITS, ZERO)
    assert rule.on_task(WORK, 1.9) == WORK
    take_away(rule)
    for count in range(20):
        assert rule.on_task(ZERO if count % 2 else WORK, 2.1 + 0.1 * count) is None
    again = 4.0 + TASK_STALE_S
    if end == 'left out':
        again = 4.1
        assert rule.on_task(None, again) is None
    assert rule.on_task(WORK, again) == WORK


def test_whom_a_robot_obeys_and_why_it_stands():
    rule = RobotRule(LIMITS, ZERO)
    assert rule.obeys == ''
    rule.on_task(WORK, 1.0)
    assert rule.obeys == TASK
    rule.select(True, 1.1)
    assert rule.obeys == OPERATOR and rule.on_task(WORK, 1.2) is None
    rule.hold(WHY, 1.25)
    assert rule.stop_reason == WHY
    rule.stop(False, True, 1.3)
    assert (rule.obeys, rule.stop_reason, rule.held_by) == (OPERATOR, STOPPED_ALONE, WHY)
    rule.stop(True, True, 1.4)
    assert rule.stop_reason == STOPPED and rule.stopped
    rule.close(1.5)
    assert (rule.obeys, rule.stop_reason, rule.stopped) == ('', '', True), 'its guard keeps it'


def test_a_group_keeps_to_its_slowest_along_the_same_curve():
    quick, slow = Limits(0.65, 3.14), Limits(0.22, 2.84)
    group = common_limits([quick, slow])
    assert group == Limits(0.22, 2.84)
    said = []
    for limits in (quick, slow):
        rule = RobotRule(limits, ZERO)
        rule.select(True, 0.0)
        rule.hold_to(group, 1.0)
        said.append(rule.on_command(Velocity(0.5, 1.0), 1.0))
    for velocity in said:
        assert (velocity.linear_mps, velocity.angular_rad_s) == pytest.approx((0.22, 0.44))
    rule.hold_to(limits, 0.5)
    assert rule.on_command(Velocity(0.2, 0.4), 1.1) == Velocity(0.1, 0.2)
    rule.hold_to(Limits(9.0, 9.0), 1.0)
    velocity = rule.on_command(Velocity(0.5, 1.0), 1.2)
    assert velocity.linear_mps == pytest.approx(0.22), 'its own limits hold'


WITH_Y, WITHOUT_Y = Velocity(0.2, 0.3, 0.1), Velocity(0.2, 0.3)


@pytest.mark.parametrize('holonomic', [True, False])
def test_who_cannot_go_sideways_gets_none_of_it(holonomic):
    limits, expected = Limits(0.5, 1.0, holonomic), WITH_Y if holonomic else WITHOUT_Y
    for drive in ('operator', 'task'):
        rule = RobotRule(limits, ZERO)
        rule.select(drive == 'operator', 0.0)
        said = [command(WITH_Y, 0.1) for command in (rule.on_command, rule.on_task)]
        assert said[drive == 'task'] == expected == rule.sent and said[drive != 'task'] is None
    rule = RobotRule(limits, WITH_Y)
    rule.select(True, 0.0)
    assert rule.on_command(Velocity(0.0, 0.0, 0.1), 0.1) is None, 'that is not neutral'
    assert rule.state == JOINING


def test_a_group_that_stays_together_goes_sideways_only_if_all_can():
    can, cannot = Limits(0.5, 1.0, True), Limits(0.4, 2.0)
    assert common_limits([can, cannot]) == Limits(0.4, 1.0)
    assert common_limits([can, can]) == can
    rule = RobotRule(can, ZERO)
    rule.select(True, 0.0)
    rule.hold_to(common_limits([can, cannot]), 1.0)
    assert rule.on_command(WITH_Y, 0.1) == WITHOUT_Y
    rule.hold_to(can, 0.5)
    assert rule.on_command(WITH_Y, 0.2) == pytest.approx((0.1, 0.15, 0.05))


def test_the_brake_looks_again_at_what_goes_sideways():
    left = iter((Velocity(0.0, 0.0, 0.3), Velocity(0.0, 0.0, 0.3), ZERO))
    rule = RobotRule(Limits(0.5, 1.0, True), ZERO, lambda velocity, now: next(left))
    rule.select(True, 0.0)
    assert rule.on_command(Velocity(0.0, 0.0, 0.3), 0.1).lateral_mps == 0.3
    assert rule.tick(0.15) is None and rule.tick(0.2) == ZERO
