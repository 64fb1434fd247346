# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of driving: stop-all, dead-man, limits, and whatever may come in any order."""
from dataclasses import replace

import pytest
from test_arbiter import DRIVE, FORWARD, HELD, make_config, NEUTRAL, RELEASED, Rig, rig_in

from mhri.base.limits import Velocity, ZERO
from mhri.driving.arbiter import Arbiter, DRIVING, ENABLING_TIMEOUT_S, READY, STOPPED, WAIT_NEUTRAL


def test_stop_all_is_released_only_with_the_active_source_at_neutral():
    """The reason is a sentence; the stop stays until it is met."""
    rig = rig_in(DRIVING)
    rig.arbiter.engage_stop_all(rig.now)
    assert 'centre' in rig.arbiter.release_stop_all(rig.now)
    assert rig.arbiter.stop_all and rig.arbiter.waits_for(rig.now) == 'release'
    rig.joy(NEUTRAL)
    assert rig.arbiter.release_stop_all(rig.now) is None
    assert rig.arbiter.state == WAIT_NEUTRAL and rig.arbiter.cause == 'released'
    assert rig.joy(FORWARD) is None, 'neutral before the release is not neutral after it'
    rig.joy(NEUTRAL)
    assert rig.joy(FORWARD) == DRIVE


@pytest.mark.parametrize('forget', [
    lambda rig: rig.arbiter.on_mode('other', rig.now),
    lambda rig: rig.arbiter.on_lost('stick', 'lost', rig.now),
])
def test_stop_all_is_not_released_where_nothing_is_known_of_the_source(forget):
    """A source never heard since it became active may be held over."""
    rig = rig_in(STOPPED)
    forget(rig)
    assert 'nothing has been heard' in rig.arbiter.release_stop_all(rig.now)
    assert rig.arbiter.state == STOPPED


def test_release_does_not_cut_the_zeros_of_the_stop_short():
    """A stop that is released at once still gets its half second of zeros."""
    rig = rig_in(DRIVING)
    rig.note(rig.arbiter.engage_stop_all(rig.now))
    begun = rig.now
    rig.run(0.02)
    rig.joy(NEUTRAL)
    rig.arbiter.release_stop_all(rig.now)
    rig.run(5.0)
    assert max(rig.zeros()) - begun == pytest.approx(0.475, abs=0.026)


def test_stop_all_is_released_on_the_last_word_of_a_silent_source_but_nothing_moves():
    """A pad switched off at rest must not keep the stop for ever; the interlock guards the rest."""
    rig = rig_in(STOPPED)
    rig.run(60.0)
    assert rig.arbiter.release_stop_all(rig.now) is None
    rig.forget()
    for _ in range(20):
        rig.joy(FORWARD)
        rig.run(0.05)
    assert rig.sent == []


def test_dead_man_released_means_zero():
    """At once; pressed again with the stick still out nothing moves before that was centred."""
    rig = rig_in(DRIVING)
    assert rig.joy(FORWARD, RELEASED) == ZERO
    assert rig.arbiter.waits_for(rig.now) == 'dead_man'
    assert rig.joy(FORWARD, HELD) in (None, ZERO)
    assert (rig.arbiter.state, rig.arbiter.cause) == (WAIT_NEUTRAL, 'dead_man')
    assert rig.arbiter.waits_for(rig.now) == 'neutral'
    rig.joy(NEUTRAL, HELD)
    assert rig.joy(FORWARD, HELD) == DRIVE
    assert rig.arbiter.waits_for(rig.now) == ''


def test_whether_the_stick_is_held_whatever_becomes_of_it():
    rig = rig_in(DRIVING)
    assert rig.arbiter.pushed(rig.now)
    rig.joy(FORWARD, RELEASED)
    assert rig.arbiter.pushed(rig.now)
    rig.joy(NEUTRAL, RELEASED)
    assert not rig.arbiter.pushed(rig.now)
    rig.note(rig.arbiter.engage_stop_all(rig.now))
    rig.joy(FORWARD)
    assert rig.arbiter.pushed(rig.now)
    rig.run(60.0)
    assert not rig.arbiter.pushed(rig.now), 'it has been silent since'


@pytest.mark.parametrize('centred_with', [HELD, RELEASED])
def test_dead_man_pressed_on_a_deflected_stick_moves_nothing(centred_with):
    """A thumb that finds the button, whether or not it was held while the stick was centred."""
    rig = rig_in(READY)
    rig.joy(NEUTRAL, centred_with)
    rig.joy(FORWARD, RELEASED)
    for _ in range(20):
        assert rig.joy(FORWARD, HELD) in (None, ZERO)
        rig.run(0.05)
    assert rig.zeros() == []
    rig.joy(NEUTRAL, HELD)
    assert rig.joy(FORWARD, HELD) == DRIVE


def test_a_profile_without_dead_man_needs_no_buttons():
    """Nothing to hold."""
    rig = rig_in(READY, dead_man=None)
    assert rig.joy(FORWARD, ()) == DRIVE


def test_limits_are_live():
    """Repetitions follow, too."""
    rig = rig_in(DRIVING)
    rig.arbiter.set_limits(0.1, 1.0, rig.now)
    assert rig.arbiter.tick(rig.now + 0.06) == Velocity(0.1, 0.0)
    assert rig.arbiter.limits == (0.1, 1.0)


def test_a_limit_does_not_revive_a_stale_source():
    """Between the timeout and the tick that notices it, a limit must not drive."""
    rig = rig_in(DRIVING)
    assert rig.arbiter.set_limits(0.1, 1.0, rig.now + 0.5) is None


def test_a_source_that_says_neutral_once_a_second_does_not_cause_endless_zeros():
    """It goes stale after each message; it must not block navigation for ever."""
    rig = rig_in(READY)
    for _ in range(20):
        rig.run(1.0)
        rig.joy(NEUTRAL)
    rig.forget()
    for _ in range(10):
        rig.run(1.0)
        rig.joy(NEUTRAL)
    assert rig.zeros() == []


# Hand-over: whoever takes over finds robots that stand still, and starts from neutral.

def enabled_rig(**changes):
    """A rig whose second source is an enabling pedal."""
    rig = Rig()
    rig.arbiter = Arbiter(replace(make_config(), enabling='other', **changes), rig.now)
    rig.let_go()
    return rig


def pedal(rig, pressed):
    return rig.joy(NEUTRAL, (int(pressed),), name='other', device='/pedal')


def test_nothing_moves_without_the_enabling_pedal():
    rig = enabled_rig()
    rig.joy(NEUTRAL)
    assert rig.arbiter.waits_for(rig.now) == 'enabling'
    assert rig.joy(FORWARD) in (None, ZERO) and rig.arbiter.state != DRIVING
    rig.joy(NEUTRAL)
    pedal(rig, True)
    assert rig.arbiter.waits_for(rig.now) == ''
    assert rig.joy(FORWARD) == DRIVE


@pytest.mark.parametrize('end', ['released', 'silent', 'without buttons'])
def test_the_enabling_pedal_released_or_silent_means_zero(end):
    rig = enabled_rig()
    rig.joy(NEUTRAL)
    pedal(rig, True)
    assert rig.joy(FORWARD) == DRIVE
    rig.forget()
    begun = rig.now
    if end == 'released':
        assert pedal(rig, False) == ZERO
    elif end == 'without buttons':
        assert rig.joy(NEUTRAL, (), name='other', device='/pedal') == ZERO
    else:
        for _ in range(6):
            rig.run(0.1)
            rig.joy(FORWARD)
        first = next(time for time, velocity in rig.sent if velocity == ZERO)
        assert first - begun == pytest.approx(0.25, abs=0.001)
    assert rig.arbiter.state == WAIT_NEUTRAL and rig.arbiter.cause == 'enabling'
    pedal(rig, True)
    assert rig.joy(FORWARD) is None, 'a foot that comes back sets nothing in motion'
    rig.joy(NEUTRAL)
    pedal(rig, True)
    assert rig.joy(FORWARD) == DRIVE


def test_the_enabling_pedal_released_just_after_its_time_was_up_means_zero_at_once():
    """Its message comes in before the timer does."""
    rig = enabled_rig()
    rig.joy(NEUTRAL)
    pedal(rig, True)
    assert rig.joy(FORWARD) == DRIVE
    rig.now += ENABLING_TIMEOUT_S + 0.01
    assert pedal(rig, False) == ZERO
    assert rig.arbiter.state == WAIT_NEUTRAL and rig.arbiter.cause == 'enabling'
    assert rig.arbiter.next_tick(rig.now) > rig.now


def test_a_stick_held_out_before_the_pedal_has_to_be_centred():
    rig = enabled_rig()
    rig.joy(NEUTRAL)
    rig.joy(FORWARD)
    pedal(rig, True)
    assert rig.joy(FORWARD) is None and rig.arbiter.waits_for(rig.now) == 'neutral'


def test_a_new_limit_does_not_move_a_robot_that_is_not_enabled():
    rig = enabled_rig()
    rig.joy(NEUTRAL)
    pedal(rig, True)
    rig.joy(FORWARD)
    rig.now += ENABLING_TIMEOUT_S
    assert rig.arbiter.set_limits(1.0, 1.0, rig.now) is None


def test_a_robot_that_joins_while_others_are_driven_makes_all_wait_for_neutral():
    rig = rig_in(READY)
    assert rig.arbiter.on_selection(('a',), rig.now) is None
    assert rig.joy(FORWARD) == DRIVE
    assert rig.arbiter.on_selection((), rig.now) is None, 'one that leaves is stopped by its gate'
    assert rig.arbiter.on_selection(('a', 'b'), rig.now) == ZERO
    assert rig.arbiter.waits_for(rig.now) == 'neutral' and rig.arbiter.cause == 'selection'
    assert rig.joy(FORWARD) is None
    rig.joy(NEUTRAL)
    assert rig.joy(FORWARD) == DRIVE
    assert rig.arbiter.on_selection(('b', 'a'), rig.now) is None, 'the same robots'


def automatic_rig():
    rig = Rig()
    rig.arbiter = Arbiter(replace(make_config(), automatic_switching=True), rig.now)
    rig.let_go()
    rig.heard(1.0, NEUTRAL)
    return rig


def test_a_device_that_is_touched_takes_over_and_has_to_be_centred_first():
    rig = automatic_rig()
    rig.joy(NEUTRAL, name='other')
    assert rig.arbiter.mode == 'stick', 'lying there is not touching'
    assert rig.joy(FORWARD, name='other') == ZERO
    assert rig.arbiter.mode == 'other' and rig.arbiter.state == WAIT_NEUTRAL
    assert rig.joy(FORWARD, name='other') is None
    rig.joy(NEUTRAL, name='other')
    assert rig.joy(FORWARD, name='other') == DRIVE


@pytest.mark.parametrize('block', ['moving', 'just stopped', 'stop-all', 'never at neutral',
                                   'another device', 'switched off'])
def test_a_device_that_is_touched_does_not_take_over(block):
    rig = automatic_rig() if block != 'switched off' else rig_in(READY)
    if block != 'never at neutral':
        rig.joy(NEUTRAL, name='other', device='/x' if block == 'another device' else '/pad')
    if block in ('moving', 'just stopped'):
        rig.joy(FORWARD)
    if block == 'just stopped':
        rig.joy(NEUTRAL)
    if block == 'stop-all':
        rig.arbiter.engage_stop_all(rig.now)
        rig.heard(1.0, NEUTRAL)
    rig.forget()
    assert rig.joy(FORWARD, name='other') is None and rig.arbiter.mode == 'stick'
    if block == 'moving':
        rig.joy(NEUTRAL)
        rig.heard(1.0, NEUTRAL)
        assert rig.joy(FORWARD, name='other') is None, 'held out all the while: not touched'


def test_a_source_left_while_it_is_held_out_does_not_take_over_again():
    rig = automatic_rig()
    rig.joy(FORWARD)
    rig.arbiter.on_mode('other', rig.now)
    rig.run(1.0)
    assert rig.joy(FORWARD) is None and rig.arbiter.mode == 'other'
    rig.joy(NEUTRAL)
    assert rig.joy(FORWARD) == ZERO and rig.arbiter.mode == 'stick'


@pytest.mark.parametrize('event', ['start', 'another device'])
def test_a_dead_man_button_that_never_changes_counts_for_nothing(event):
    """One that is taped down: it is asked for once."""
    rig, device = Rig(), '/pad'
    if event != 'start':
        rig = rig_in(DRIVING)
    if event == 'another device':
        device = '/pad2'
    for axes in (NEUTRAL, FORWARD, NEUTRAL, FORWARD):
        rig.joy(axes, device=device)
        rig.forget()
        rig.joy(axes, device=device)
        rig.zeros()
    assert rig.arbiter.waits_for(rig.now) == 'dead_man'
    rig.joy(NEUTRAL, RELEASED, device=device)
    rig.joy(NEUTRAL, device=device)
    assert rig.joy(FORWARD, device=device) == DRIVE
    rig.arbiter.on_lost('stick', 'lost', rig.now)
    rig.arbiter.on_mode('other', rig.now)
    rig.arbiter.on_mode('stick', rig.now)
    rig.joy(NEUTRAL, device=device)
    assert rig.joy(FORWARD, device=device) == DRIVE, 'not again'
