# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The plain model of the contract that judges random events: each ending and each way back."""
import pytest

from support.reference_model import (
    DRIVE, EITHER, PAD, ReferenceModel, STAND)

PLAIN, GUARDED = 'bot1', 'bot2'
SLACK_S = 0.1


def driven():
    """Return a model in which two robots are driven with the virtual joystick since 20 s."""
    model = ReferenceModel({PLAIN: False, GUARDED: True}, ('a', 'b'))
    model.tell(0.0, 'mend', ('operator', 'a'))
    model.tell(0.1, 'check', 'a', [PLAIN, GUARDED])
    model.tell(20.0, 'stick', 'a', True)
    return model


def says(model, when, robot=PLAIN):
    return model.verdict(robot, when, SLACK_S).what


def test_centred_at_first_a_robot_drives_within_2_s():
    model = driven()
    assert [says(model, when) for when in (20.0, 21.9, 22.2)] == [EITHER, EITHER, DRIVE]


@pytest.mark.parametrize('event, due_s, guarded_due_s', [
    (('stick', 'a', False), 0.05, 0.05),
    (('stop',), 0.05, 0.05),
    (('mode', PAD), 0.5, 0.5),
    (('check', 'a', []), 0.05, 0.05),
    (('take', 'b'), 0.05, 0.05),
    (('fail', ('operator', 'a'), 'killed'), 0.05, 0.05),
    (('fail', ('operator', 'a'), 'hung'), 0.55, 0.55),
    (('fail', 'mux', 'killed'), 0.05, 0.05),
    (('fail', 'mux', 'hung'), 0.6, 0.3),
    (('fail', 'mux', 'orphaned'), 0.2, 0.2),
    (('fail', 'undertaker', 'hung'), 2.0, 2.0),
    (('fail', 'mux', 'ended'), 0.05, 0.05),
    (('fail', 'master', 'killed'), 1.5, 1.5),
])
def test_what_ends_a_drive_and_when(event, due_s, guarded_due_s):
    for robot, limit_s in ((PLAIN, due_s), (GUARDED, guarded_due_s)):
        model = driven()
        model.tell(30.0, *event)
        assert says(model, 30.0 + limit_s - 0.02, robot) == EITHER
        says(model, 30.0 + limit_s, robot)
        assert says(model, 30.0 + limit_s + SLACK_S + 0.1, robot) == STAND


def test_an_undertaker_that_hangs_is_said():
    model = driven()
    model.tell(30.0, 'fail', 'undertaker', 'hung')
    assert [model.must_say(when, SLACK_S) for when in (32.05, 32.2)] == [False, True]
    model.tell(33.0, 'mend', 'undertaker')
    assert not model.must_say(33.0, SLACK_S)
    assert says(model, 40.0) == STAND, 'neutral first'


def test_where_both_are_killed_a_robot_without_a_guard_stands_when_the_next_mux_is_there():
    model = driven()
    model.tell(30.0, 'fail', 'mux', 'both killed')
    assert [says(model, 30.5, robot) for robot in (GUARDED, PLAIN)] == [STAND, EITHER]
    assert says(model, 40.0) == EITHER
    model.tell(40.0, 'mend', 'mux')
    assert [says(model, when) for when in (41.55, 41.7)] == [EITHER, STAND]


def test_a_cut_link_stops_who_has_a_guard():
    model = driven()
    for robot in (PLAIN, GUARDED):
        model.tell(30.0, 'fail', ('link', robot), 'cut')
    assert (says(model, 31.0, GUARDED), says(model, 31.0)) == (STAND, EITHER)
    for robot in (PLAIN, GUARDED):
        model.tell(33.0, 'mend', ('link', robot))
    assert (says(model, 33.3, GUARDED), says(model, 33.3)) == (STAND, EITHER)
    assert says(model, 39.0) == STAND, 'a robot that is back waits for neutral'


@pytest.mark.parametrize('event, back', [
    (('stop',), ('release',)),
    (('fail', ('robot', PLAIN), 'killed'), ('mend', ('robot', PLAIN))),
    (('fail', 'mux', 'killed'), ('mend', 'mux')),
    (('check', 'a', []), ('check', 'a', [PLAIN])),
])
def test_what_was_ended_waits_for_neutral(event, back):
    model = driven()
    model.tell(30.0, *event)
    model.tell(33.0, *back)
    assert says(model, 40.0) == STAND
    model.tell(40.0, 'stick', 'a', False)
    model.tell(41.0, 'stick', 'a', True)
    assert [says(model, when) for when in (41.1, 43.2)] == [EITHER, DRIVE]


def test_the_dead_man_button_on_a_stick_that_is_out():
    model = driven()
    model.tell(30.0, 'mode', PAD)
    model.tell(31.0, 'stick', PAD, True)
    assert says(model, 34.0) == EITHER, 'taped down: asked for once'
    model.tell(34.0, 'stick', PAD, False)
    model.tell(34.0, 'dead_man', False)
    model.tell(34.5, 'dead_man', True)
    model.tell(37.0, 'stick', PAD, True)
    assert says(model, 39.45) == DRIVE
    model.tell(39.5, 'dead_man', False)
    assert says(model, 39.7) == STAND
    model.tell(40.5, 'dead_man', True)
    assert says(model, 45.0) == STAND


def test_a_second_operator_changes_nothing_until_it_takes_control():
    model = driven()
    model.tell(30.0, 'mend', ('operator', 'b'))
    model.tell(31.0, 'check', 'b', [])
    assert says(model, 40.0) == DRIVE
    model.tell(40.0, 'stick', 'b', True)
    model.tell(41.0, 'stick', 'a', False)
    assert says(model, 42.0) == STAND
