# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of driving: every event in every state, and every promise to the millisecond."""
from collections import Counter
from dataclasses import replace
from functools import partial

import pytest

from mhri.base.limits import Velocity, ZERO
from mhri.devices.profile import Axis, JoyRefused, Profile
from mhri.driving.arbiter import (
    Arbiter, DRIVING, IDLE, READY, STOPPED, WAIT_NEUTRAL)
from mhri.driving.sources import MuxConfig, Source

FORWARD = (0.0, 1.0)
NEUTRAL = (0.0, 0.0)
DRIVE = Velocity(0.5, 0.0)
HELD, RELEASED = (1,), (0,)


def make_config(timeout_s=0.5, dead_man=0):
    """Two sources: a stick with a dead-man button (None: without), and another stick."""
    profile = Profile('stick', Axis(1, 1.0), Axis(0, 1.0), dead_man=dead_man)
    other = Profile('other', Axis(1, 1.0), Axis(0, 1.0))
    return MuxConfig((Source('stick', 'Stick', '/a', profile, timeout_s),
                      Source('other', 'Other', '/b', other, timeout_s)), 'stick', 0.5, 1.5)


class Rig:
    """An arbiter and the time, which is just a number; everything sent is noted."""

    def __init__(self, **options):
        self.now = 100.0
        config = make_config(**options)
        self.profiles = {source.name: source.profile for source in config.sources}
        self.arbiter = Arbiter(config, self.now)
        self.sent = []

    def note(self, velocity):
        """Note and return what a rule said."""
        if velocity is not None:
            self.sent.append((round(self.now, 6), velocity))
        return velocity

    def joy(self, axes, buttons=HELD, name='stick', device='/pad'):
        """Send one Joy message now."""
        return self.note(self.arbiter.on_message(
            name, device, self.now, partial(self.profiles[name].read, axes, buttons),
            buttons[:1] == HELD))

    def let_go(self, device='/pad'):
        """Show the dead-man button released once, the stick out, as it has to be seen."""
        self.joy(FORWARD, RELEASED, device=device)

    def run(self, seconds):
        """Let time pass as the timer of the mux does, tick by tick."""
        end = self.now + seconds
        while True:
            due = self.arbiter.next_tick(self.now)
            if due > end:
                break
            self.now = max(due, self.now + 1e-6)
            self.note(self.arbiter.tick(self.now))
        self.now = end

    def heard(self, seconds, axes):
        """Let time pass with a message every 100 ms."""
        for _ in range(round(seconds / 0.1)):
            self.run(0.1)
            self.joy(axes)

    def forget(self):
        """Forget what was sent so far."""
        self.sent = []

    def zeros(self):
        """Return the times of the zeros since :meth:`forget`; fail at anything else."""
        assert all(velocity.is_zero() for _, velocity in self.sent), self.sent
        return [time for time, _ in self.sent]


def assert_20_hz(times):
    """Demand 50 ms between each two, to a tenth of a millisecond."""
    gaps = [later - sooner for sooner, later in zip(times, times[1:])]
    assert gaps == pytest.approx([0.05] * len(gaps), abs=1e-4)


def rig_in(state, **options):
    """Return a rig in a state, its source fresh (but when IDLE) and every zero long sent."""
    rig = Rig(**options)
    rig.let_go()
    if state == WAIT_NEUTRAL:
        rig.heard(1.0, FORWARD)
    else:
        rig.heard(1.0, NEUTRAL)
    if state == STOPPED:
        rig.arbiter.engage_stop_all(rig.now)
        rig.heard(1.0, NEUTRAL)
    if state == IDLE:
        rig.run(1.0)
    if state == DRIVING:
        rig.joy(FORWARD)
    assert rig.arbiter.state == state
    rig.forget()
    return rig


def _at(rig, seconds):
    rig.now += seconds
    return rig


EVENTS = {
    'neutral': lambda rig: rig.joy(NEUTRAL),
    'deflected': lambda rig: rig.joy(FORWARD),
    'dead_man_released': lambda rig: rig.joy(FORWARD, RELEASED),
    'dead_man_pressed': lambda rig: (rig.joy(FORWARD, RELEASED), rig.joy(FORWARD, HELD))[1],
    'late_neutral': lambda rig: _at(rig, 0.5).joy(NEUTRAL),
    'late_deflected': lambda rig: _at(rig, 0.5).joy(FORWARD),
    'new_device_neutral': lambda rig: rig.joy(NEUTRAL, device='/pad2'),
    'new_device_deflected': lambda rig: rig.joy(FORWARD, device='/pad2'),
    'other_source': lambda rig: rig.joy(FORWARD, name='other'),
    'mode_same': lambda rig: rig.arbiter.on_mode('stick', rig.now),
    'mode_other': lambda rig: rig.arbiter.on_mode('other', rig.now),
    'lost': lambda rig: rig.arbiter.on_lost('stick', 'lost', rig.now),
    'suspended': lambda rig: rig.arbiter.on_lost('stick', 'suspended', rig.now),
    'other_lost': lambda rig: rig.arbiter.on_lost('other', 'lost', rig.now),
    'hold': lambda rig: rig.arbiter.on_hold('master', rig.now),
    'engage': lambda rig: rig.arbiter.engage_stop_all(rig.now),
    'release': lambda rig: rig.arbiter.release_stop_all(rig.now),
    'limits': lambda rig: rig.arbiter.set_limits(0.2, 1.0, rig.now),
    'tick_early': lambda rig: rig.arbiter.tick(rig.now + 0.04),
    'tick_due': lambda rig: rig.arbiter.tick(rig.now + 0.06),
    'tick_stale': lambda rig: rig.arbiter.tick(rig.now + 0.5),
}

SLOWER = Velocity(0.2, 0.0)
SAME = {event: None for event in ('other_source', 'mode_same', 'other_lost', 'tick_early')}
# What each event leads to, (state, sent); events left out change nothing and send nothing.
TABLE = {
    STOPPED: {
        'mode_other': (STOPPED, ZERO), 'lost': (STOPPED, ZERO), 'suspended': (STOPPED, ZERO),
        'hold': (STOPPED, ZERO), 'engage': (STOPPED, ZERO), 'release': (WAIT_NEUTRAL, None)},
    WAIT_NEUTRAL: {
        'neutral': (READY, ZERO), 'late_neutral': (READY, ZERO),
        'new_device_neutral': (READY, ZERO), 'mode_other': (WAIT_NEUTRAL, ZERO),
        'lost': (WAIT_NEUTRAL, ZERO), 'suspended': (WAIT_NEUTRAL, ZERO),
        'hold': (WAIT_NEUTRAL, ZERO), 'engage': (STOPPED, ZERO)},
    IDLE: {
        'neutral': (READY, None), 'late_neutral': (READY, None),
        'new_device_neutral': (READY, None), 'mode_other': (WAIT_NEUTRAL, ZERO),
        'lost': (WAIT_NEUTRAL, ZERO), 'suspended': (WAIT_NEUTRAL, ZERO),
        'hold': (WAIT_NEUTRAL, ZERO), 'engage': (STOPPED, ZERO)},
    READY: {
        'deflected': (DRIVING, DRIVE), 'dead_man_pressed': (WAIT_NEUTRAL, None),
        'late_neutral': (READY, ZERO),
        'late_deflected': (WAIT_NEUTRAL, ZERO), 'new_device_neutral': (READY, ZERO),
        'new_device_deflected': (WAIT_NEUTRAL, ZERO), 'mode_other': (WAIT_NEUTRAL, ZERO),
        'lost': (WAIT_NEUTRAL, ZERO), 'suspended': (WAIT_NEUTRAL, ZERO),
        'hold': (WAIT_NEUTRAL, ZERO), 'engage': (STOPPED, ZERO),
        'tick_stale': (IDLE, None)},
    DRIVING: {
        'neutral': (READY, ZERO), 'deflected': (DRIVING, DRIVE),
        'dead_man_released': (READY, ZERO), 'dead_man_pressed': (WAIT_NEUTRAL, ZERO),
        'late_neutral': (READY, ZERO),
        'late_deflected': (WAIT_NEUTRAL, ZERO), 'new_device_neutral': (READY, ZERO),
        'new_device_deflected': (WAIT_NEUTRAL, ZERO), 'mode_other': (WAIT_NEUTRAL, ZERO),
        'lost': (WAIT_NEUTRAL, ZERO), 'suspended': (WAIT_NEUTRAL, ZERO),
        'hold': (WAIT_NEUTRAL, ZERO), 'engage': (STOPPED, ZERO), 'limits': (DRIVING, SLOWER),
        'tick_due': (DRIVING, DRIVE), 'tick_stale': (WAIT_NEUTRAL, ZERO)},
}


@pytest.mark.parametrize('event', sorted(EVENTS))
@pytest.mark.parametrize('state', sorted(TABLE))
def test_every_event_in_every_state(state, event):
    """The table is the state machine."""
    rig = rig_in(state)
    sent = EVENTS[event](rig)
    assert (rig.arbiter.state, sent) == TABLE[state].get(event, (state, None))


REFUSED = {
    'no_axes': ((), HELD), 'not_finite': ((float('nan'), 1.0), HELD),
    'too_few_axes': ((1.0,), HELD), 'too_few_buttons': (FORWARD, ())}


@pytest.mark.parametrize('kind', sorted(REFUSED))
@pytest.mark.parametrize('state', sorted(TABLE))
def test_refused_message_changes_nothing_but_its_counter(state, kind):
    """Neither state, command, freshness nor wait; and the wait for silence goes on."""
    rig = rig_in(state)
    before = (rig.arbiter.waits_for(rig.now), rig.arbiter.next_tick(rig.now), rig.arbiter.mode,
              rig.arbiter.cause)
    axes, buttons = REFUSED[kind]
    with pytest.raises(JoyRefused) as refusal:
        rig.joy(axes, buttons)
    assert refusal.value.kind == kind
    assert rig.arbiter.refused == Counter({kind: 1})
    assert rig.arbiter.state == state and rig.sent == []
    assert before == (rig.arbiter.waits_for(rig.now), rig.arbiter.next_tick(rig.now),
                      rig.arbiter.mode, rig.arbiter.cause)


def test_refused_messages_do_not_keep_a_source_alive():
    """A source that sends nothing but NaN stops as if it were silent."""
    rig = rig_in(DRIVING)
    for _ in range(12):
        rig.run(0.045)
        with pytest.raises(JoyRefused):
            rig.joy((float('inf'), 0.0))
    assert rig.arbiter.state == WAIT_NEUTRAL and rig.sent[-1][1] == ZERO


@pytest.mark.parametrize('state', sorted(TABLE))
def test_unknown_mode_is_refused_and_counted(state):
    """The mode and the robots' rest stay as they were."""
    rig = rig_in(state)
    with pytest.raises(KeyError):
        rig.arbiter.on_mode('telepathy', rig.now)
    assert (rig.arbiter.mode, rig.arbiter.state) == ('stick', state)
    assert rig.arbiter.refused == Counter(unknown_mode=1)


@pytest.mark.parametrize('timeout_s', [0.05, 0.5, 2.0])
def test_fresh_to_the_millisecond(timeout_s):
    """One millisecond before its timeout a source drives; at the timeout it does not."""
    rig = rig_in(DRIVING, timeout_s=max(timeout_s, 0.2))
    timeout_s = max(timeout_s, 0.2)
    heard = rig.now
    assert rig.arbiter.tick(heard + timeout_s - 0.001) == DRIVE
    assert rig.arbiter.tick(heard + timeout_s) == ZERO
    assert rig.arbiter.state == WAIT_NEUTRAL and rig.arbiter.cause == 'stale'


def test_a_stick_held_still_is_repeated_at_20_hz_until_stale():
    """Repeated for half a second, the last time before the timeout, then the first zero at it."""
    rig = rig_in(DRIVING)
    heard = rig.now
    rig.run(0.6)
    commands = [heard] + [time for time, velocity in rig.sent if velocity == DRIVE]
    assert_20_hz(commands)
    assert commands[-1] - heard == pytest.approx(0.475, abs=0.026)
    first_zero = next(time for time, velocity in rig.sent if velocity == ZERO)
    assert first_zero - heard == pytest.approx(0.5, abs=0.001)


CAUSES = {
    'stale': lambda rig: rig.note(rig.arbiter.tick(_at(rig, 0.5).now)),
    'suspended': lambda rig: rig.note(rig.arbiter.on_lost('stick', 'suspended', rig.now)),
    'lost': lambda rig: rig.note(rig.arbiter.on_lost('stick', 'lost', rig.now)),
    'mode': lambda rig: rig.note(rig.arbiter.on_mode('other', rig.now)),
    'stop_all': lambda rig: rig.note(rig.arbiter.engage_stop_all(rig.now)),
    'master': lambda rig: rig.note(rig.arbiter.on_hold('master', rig.now)),
    'device': lambda rig: rig.joy(FORWARD, device='/pad2'),
}


# At rest, the zeros have been sent: silence alone begins no new ones.
AT_ONCE = [(state, cause) for state in (READY, DRIVING) for cause in sorted(CAUSES)
           if (state, cause) != (READY, 'stale')]


@pytest.mark.parametrize('state, cause', AT_ONCE)
def test_zero_at_once_then_20_hz_for_half_a_second_then_silence(state, cause):
    """Endless zeros would block a robot's own navigation; a single one may be lost."""
    rig = rig_in(state)
    CAUSES[cause](rig)
    begun = rig.now
    assert rig.zeros() == pytest.approx([begun]), 'not at once'
    rig.run(30.0)
    assert_20_hz(rig.zeros())
    assert rig.zeros()[-1] - begun == pytest.approx(0.475, abs=0.026)
    assert rig.arbiter.cause == cause


@pytest.mark.parametrize('released', [(NEUTRAL, HELD), (FORWARD, RELEASED)])
def test_released_stick_zeroes_at_once_and_falls_silent_although_it_goes_on_sending(released):
    """A pad at rest that sends neutral for ever keeps nobody's navigation off."""
    rig = rig_in(DRIVING)
    begun = rig.now
    for _ in range(40):
        rig.joy(*released)
        rig.run(0.1)
    zeros = rig.zeros()
    assert zeros[0] == pytest.approx(begun) and max(zeros) < begun + 0.501


@pytest.mark.parametrize('state, cause', [
    pair for pair in AT_ONCE if pair[1] not in ('stop_all', 'mode')] + [(READY, 'stale')])
def test_nothing_moves_until_neutral_after(state, cause):
    """The stick held through the cause is ignored for as long as it is held."""
    rig = rig_in(state)
    CAUSES[cause](rig)
    for _ in range(50):
        rig.joy(FORWARD, device='/pad2')
        rig.run(0.1)
    assert rig.arbiter.state == (WAIT_NEUTRAL if (state, cause) in AT_ONCE else IDLE)
    assert bool(rig.zeros()) == ((state, cause) in AT_ONCE)
    assert rig.arbiter.waits_for(rig.now) == 'neutral'
    rig.let_go('/pad2')
    rig.joy(NEUTRAL, device='/pad2')
    assert rig.joy(FORWARD, device='/pad2') == DRIVE


def test_nothing_moves_at_start_before_neutral():
    """The first message of a pad may be a held stick; the first words of a mux are zeros."""
    rig = Rig()
    rig.run(0.0)
    assert rig.zeros() == pytest.approx([100.0], abs=1e-3)
    assert rig.joy(FORWARD) is None
    assert (rig.arbiter.state, rig.arbiter.cause) == (WAIT_NEUTRAL, 'start')


def test_a_message_of_another_source_is_counted_and_changes_nothing():
    """Not even one that cannot be read, and it keeps no source alive."""
    rig = rig_in(DRIVING)
    heard = rig.now
    rig.run(0.4)
    assert rig.joy(FORWARD, name='other') is None
    assert rig.joy((), name='other') is None
    assert rig.arbiter.ignored == Counter(other=2) and not rig.arbiter.refused
    assert rig.arbiter.tick(heard + 0.5) == ZERO
    with pytest.raises(KeyError):
        rig.joy(FORWARD, name='nobody')


def aside(*axes):
    """Return the axes of a stick that goes sideways by its third."""
    return (0.0, 0.0) + axes


def sideways_rig(counts=True):
    """Return a rig, ready, whose stick has a third axis that goes sideways."""
    rig = Rig(dead_man=None)
    rig.profiles['stick'] = replace(rig.profiles['stick'], sideways=Axis(2, 1.0))
    rig.joy(aside(0.0))
    rig.note(rig.arbiter.let_sideways(counts, rig.now))
    rig.joy(aside(0.0))
    return rig


def test_what_goes_sideways_counts_only_while_a_selected_robot_can():
    rig = sideways_rig(False)
    assert rig.joy(aside(1.0)) == ZERO and rig.arbiter.state == READY
    assert rig.joy((0.0, 1.0, 1.0)) == DRIVE
    rig = sideways_rig()
    assert rig.joy(aside(1.0)) == Velocity(0.0, 0.0, 0.5) and rig.arbiter.state == DRIVING
    assert rig.arbiter.waits_for(rig.now) == ''
    assert rig.joy(NEUTRAL) == ZERO, 'a stick that lacks the axis'


@pytest.mark.parametrize('driving', [False, True])
def test_a_stick_that_is_held_sideways_moves_nothing_before_neutral(driving):
    """Selecting a robot that can go sideways gives the third axis its meaning."""
    rig = sideways_rig(False)
    rig.joy((0.0, float(driving), 1.0))
    assert rig.arbiter.state == (DRIVING if driving else READY)
    assert rig.arbiter.let_sideways(True, rig.now) == ZERO
    assert rig.arbiter.waits_for(rig.now) == 'neutral'
    assert rig.joy(aside(1.0)) is None and rig.arbiter.state == WAIT_NEUTRAL
    assert rig.arbiter.let_sideways(True, rig.now) is None
    rig.arbiter.engage_stop_all(rig.now)
    assert rig.arbiter.release_stop_all(rig.now), 'nor does a stop end'
    rig.joy(aside(0.0))
    assert rig.arbiter.release_stop_all(rig.now) is None
    rig.joy(aside(0.0))
    assert rig.joy(aside(-1.0)) == Velocity(0.0, 0.0, -0.5)


def test_without_such_a_robot_it_ends_with_the_next_word():
    rig = sideways_rig()
    rig.joy((0.0, 1.0, 1.0))
    assert rig.arbiter.let_sideways(False, rig.now) is None
    rig.now = rig.arbiter.next_tick(rig.now)
    assert rig.note(rig.arbiter.tick(rig.now)) == DRIVE
