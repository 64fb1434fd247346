# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The plain model of the contract that judges random events: each ending and each way back."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.reference_model import (  # noqa: E402
    DRIVE, EITHER, JOY, PAD, ReferenceModel, STAND)

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


def test_never_centred_nothing_has_to_drive():
    model = driven()
    model.tell(20.1, 'mode', PAD)
    model.tell(20.1, 'stick', PAD, True)
    model.tell(20.2, 'mode', JOY)
    assert says(model, 30.0) == STAND


@pytest.mark.parametrize('event, due_s, guarded_due_s', [
    (('stick', 'a', False), 0.05, 0.05),
    (('stop',), 0.05, 0.05),
    (('mode', PAD), 0.5, 0.5),
    (('check', 'a', []), 0.05, 0.05),
    (('take', 'b'), 0.05, 0.05),
    (('fail', ('operator', 'a'), 'killed'), 0.05, 0.05),
    (('fail', ('operator', 'a'), 'hung'), 0.55, 0.55),
    (('fail', 'mux', 'killed'), 0.55, 0.55),
    (('fail', 'mux', 'ended'), 0.05, 0.05),
    (('fail', 'gates', 'killed'), 1.5, 0.3),
    (('fail', 'gates', 'hung'), 3.0, 0.3),
    (('fail', 'master', 'killed'), 1.5, 1.5),
])
def test_what_ends_a_drive_and_when(event, due_s, guarded_due_s):
    for robot, limit_s in ((PLAIN, due_s), (GUARDED, guarded_due_s)):
        model = driven()
        model.tell(30.0, *event)
        assert says(model, 30.0 + limit_s - 0.02, robot) == EITHER
        says(model, 30.0 + limit_s, robot)
        assert says(model, 30.0 + limit_s + SLACK_S + 0.1, robot) == STAND


def test_hung_gates_that_are_replaced_bring_the_zero_by_then():
    model = driven()
    model.tell(30.0, 'fail', 'gates', 'hung')
    model.tell(32.0, 'fail', 'gates', 'killed')
    model.tell(32.0, 'mend', 'gates')
    assert [says(model, when) for when in (31.9, 33.05, 33.2)] == [EITHER, EITHER, STAND]


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
    (('fail', 'gates', 'killed'), ('mend', 'gates')),
    (('check', 'a', []), ('check', 'a', [PLAIN])),
    (('take', 'b'), ('check', 'b', [PLAIN])),
])
def test_what_was_ended_waits_for_neutral(event, back):
    model = driven()
    model.tell(30.0, *event)
    model.tell(33.0, *back)
    if event[0] == 'take':
        model.tell(33.0, 'fail', ('operator', 'a'), 'killed')
        return
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


def test_a_second_operators_stick_does_not_shorten_what_a_silent_one_may_take():
    """Beside gates that are new, both may be in control; the one that drives is hung."""
    model = driven()
    model.tell(28.0, 'mend', ('operator', 'b'))
    model.tell(29.0, 'fail', 'gates', 'killed')
    model.tell(29.5, 'mend', 'gates')
    model.tell(30.0, 'fail', ('operator', 'a'), 'hung')
    assert [says(model, when) for when in (30.6, 30.7)] == [EITHER, STAND]


def test_nobody_knows_whether_a_stop_is_in_force():
    model = driven()
    model.tell(30.0, 'unknown')
    assert says(model, 40.0) == EITHER
    model.tell(40.0, 'stop')
    assert says(model, 41.0) == STAND
