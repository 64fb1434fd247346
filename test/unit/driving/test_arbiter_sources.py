# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of driving: velocities, sources that are silent at rest, and a mux that slept."""
from dataclasses import replace
from functools import partial

import pytest
from test_arbiter import DRIVE, FORWARD, HELD, make_config, NEUTRAL, Rig, rig_in

from mhri.base.limits import Velocity, ZERO
from mhri.devices.profile import JoyRefused, read_twist
from mhri.driving.arbiter import Arbiter, READY, STATES, STOPPED, WAIT_NEUTRAL
from mhri.driving.sources import MuxConfig, Source, TWIST

REST = (0.0, 0.0)


class Velocities(Rig):
    """A rig whose active source is of type twist; ``stick`` is there as well."""

    def __init__(self, timeout_s=0.5, **options):
        super().__init__()
        stick = make_config(dead_man=None).sources[0]
        source = Source('cmd', 'Velocities', '/cmd', None, timeout_s, kind=TWIST, **options)
        self.arbiter = Arbiter(MuxConfig((source, stick), 'cmd', 0.5, 1.5), self.now)

    def twist(self, linear, angular, device='/steering', name='cmd'):
        """Send one Twist now."""
        return self.vectors((linear, 0.0, 0.0), (0.0, 0.0, angular), device, name)

    def vectors(self, linear, angular, device='/steering', name='cmd'):
        """Send one Twist of two vectors now."""
        return self.note(self.arbiter.on_message(
            name, device, self.now, partial(read_twist, linear, angular)))


def ready(**options):
    """Return a rig of velocities at rest, its zeros long sent."""
    rig = Velocities(**options)
    rig.twist(*REST)
    rig.run(1.0)
    rig.forget()
    return rig


def test_velocities_are_kept_within_the_operators_limit_and_on_their_path():
    assert ready().twist(0.25, -3.0) == pytest.approx(Velocity(0.125, -1.5))


@pytest.mark.parametrize('vector, place, value', [
    (0, 0, float('nan')), (0, 1, float('inf')), (0, 2, float('nan')), (1, 2, float('inf'))])
def test_a_velocity_that_is_no_number_is_refused(vector, place, value):
    rig = ready()
    vectors = [[0.0] * 3, [0.0] * 3]
    vectors[vector][place] = value
    with pytest.raises(JoyRefused):
        rig.vectors(*vectors)
    assert rig.arbiter.refused == {'not_finite': 1}


def test_a_zero_that_is_said_once_stays_neutral_for_as_long_as_its_publisher_is_there():
    """rqt_robot_steering says zero once and falls silent."""
    rig = ready()
    rig.run(60.0)
    assert rig.arbiter.waits_for(rig.now) == '' and rig.sent == []
    assert rig.twist(0.3, 0.0) == Velocity(0.3, 0.0)


@pytest.mark.parametrize('cause', ['released', 'master', 'mode'])
def test_it_is_neutral_after_every_interlock_that_does_not_doubt_it(cause):
    rig = ready()
    if cause == 'released':
        rig.arbiter.engage_stop_all(rig.now)
        rig.run(30.0)
        assert rig.arbiter.release_stop_all(rig.now) is None
    elif cause == 'master':
        rig.arbiter.on_hold('master', rig.now)
    else:
        rig.arbiter.on_mode('stick', rig.now)
        rig.run(30.0)
        rig.arbiter.on_mode('cmd', rig.now)
    rig.run(1.0)
    assert rig.arbiter.state == READY
    assert rig.twist(0.3, 0.0) == Velocity(0.3, 0.0)


def test_a_velocity_said_while_another_source_drove_is_no_neutral():
    rig = ready()
    rig.arbiter.on_mode('stick', rig.now)
    assert rig.twist(0.3, 0.0) is None
    rig.arbiter.on_mode('cmd', rig.now)
    rig.run(1.0)
    assert rig.arbiter.state == WAIT_NEUTRAL
    rig.forget()
    assert rig.twist(0.3, 0.0) is None
    rig.twist(*REST)
    assert rig.twist(0.3, 0.0) == Velocity(0.3, 0.0)


def test_its_publisher_gone_takes_its_rest_with_it():
    rig = ready()
    assert rig.note(rig.arbiter.on_lost('cmd', 'lost', rig.now)) == ZERO
    rig.run(1.0)
    assert rig.arbiter.waits_for(rig.now) == 'source'
    rig.forget()
    assert rig.twist(0.3, 0.0) is None, 'back, and held out'


def test_a_velocity_that_is_not_repeated_ends_like_a_silent_stick():
    rig = ready()
    rig.twist(0.3, 0.0)
    begun = rig.now
    rig.run(1.0)
    first = next(time for time, velocity in rig.sent if velocity == ZERO)
    assert first - begun == pytest.approx(0.5, abs=0.001)
    assert rig.arbiter.waits_for(rig.now) == 'source'
    assert rig.twist(0.3, 0.0) is None


def holding_rig(timeout_s=5.0):
    """A rig whose pad sends changes only."""
    rig = Rig()
    config = make_config(timeout_s=timeout_s)
    rig.arbiter = Arbiter(replace(config, sources=(
        replace(config.sources[0], holds=True),) + config.sources[1:]), rig.now)
    rig.let_go()
    return rig


def test_a_pad_that_sends_changes_only_rests_for_ever_and_drives_for_its_time():
    rig = holding_rig()
    rig.joy(NEUTRAL)
    rig.run(600.0)
    assert rig.joy(FORWARD) == DRIVE
    begun = rig.now
    rig.forget()
    rig.run(4.9)
    assert {velocity for _, velocity in rig.sent} == {DRIVE}
    rig.run(1.0)
    first = next(time for time, velocity in rig.sent if velocity == ZERO)
    assert first - begun == pytest.approx(5.0, abs=0.001)
    assert rig.joy(FORWARD) is None


@pytest.mark.parametrize('axes', [NEUTRAL, FORWARD])
def test_a_pad_that_sends_changes_only_is_still_known_when_it_is_chosen_again(axes):
    rig = holding_rig()
    rig.joy(axes)
    assert rig.arbiter.on_mode('other', rig.now) == ZERO
    assert rig.arbiter.waits_for(rig.now) == 'source', 'the other one has said nothing'
    assert rig.arbiter.on_mode('stick', rig.now) == ZERO
    assert rig.arbiter.waits_for(rig.now) == 'neutral'


def test_a_stick_inside_its_neutral_zone_moves_nothing():
    rig = holding_rig()
    rig.joy((0.0, 0.0))
    rig.forget()
    rig.joy((0.0, 0.01))
    rig.run(1.0)
    assert rig.arbiter.state == READY
    rig.zeros()


@pytest.mark.parametrize('state', STATES)
def test_a_mux_that_slept_has_heard_nothing(state):
    """Neither for neutral nor for a release."""
    rig = rig_in(state)
    assert rig.arbiter.on_hung(rig.now) == ZERO
    assert rig.arbiter.state == (STOPPED if state == STOPPED else WAIT_NEUTRAL)
    if state == STOPPED:
        assert 'nothing has been heard' in rig.arbiter.release_stop_all(rig.now)
    else:
        assert rig.arbiter.cause == 'hung'
        assert rig.joy(FORWARD) is None


def test_a_mux_that_slept_does_not_know_who_rests():
    rig = ready()
    rig.arbiter.on_hung(rig.now)
    rig.run(5.0)
    assert rig.arbiter.waits_for(rig.now) == 'source'


def test_a_mux_that_slept_asks_for_the_enabling_pedal_anew():
    rig = Rig()
    rig.arbiter = Arbiter(replace(make_config(), enabling='other'), rig.now)
    rig.joy(NEUTRAL)
    rig.joy(NEUTRAL, HELD, name='other', device='/pedal')
    rig.joy(FORWARD)
    rig.arbiter.on_hung(rig.now)
    rig.joy(NEUTRAL)
    assert rig.arbiter.waits_for(rig.now) == 'enabling'


def test_a_velocity_held_sideways_is_no_rest_once_it_counts():
    """Its last word was at rest without it: that must not count for the rest that is asked for."""
    rig = ready()
    rig.vectors((0.0, 0.3, 0.0), (0.0, 0.0, 0.0))
    assert rig.arbiter.state == READY
    rig.note(rig.arbiter.let_sideways(True, rig.now))
    rig.run(1.0)
    assert rig.arbiter.state == WAIT_NEUTRAL
    rig.twist(*REST)
    assert rig.vectors((0.3, 0.4, 0.0), (0.0, 0.0, 0.0)) == Velocity(0.3, 0.0, 0.4)
