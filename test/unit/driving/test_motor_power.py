# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The power of the motors: what a robot is told, when, and what is said of it."""
import pytest

from mhri.driving.motor_power import (
    CUT, CUT_ASKED, CUT_SENT, FAILED, MotorPowerRule, ON, RESTORE_ASKED, RESTORE_FOR_S, RETRY_S,
    UNTOUCHED)

CUT_OFF, GIVE = True, False


def ask(cut):
    """Return an event: somebody asks for it."""
    return lambda rule, now: rule.ask(cut, now)


def told(cut, confirmed=True):
    """Return an event: the robot was told."""
    return lambda rule, now: rule.on_delivered(cut, confirmed, now)


def failed(cut):
    """Return an event: the robot could not be told."""
    return lambda rule, now: rule.on_failed(cut, now)


def again(rule, now):
    """Be an event: somebody new listens."""
    rule.resend(now)


# (events, state, what is due at once, what is due after the time of one retry)
CASES = {
    'nothing': ([], UNTOUCHED, None, None),
    'new_listener_of_a_powered_robot': ([again], UNTOUCHED, None, None),
    'asked': ([ask(CUT_OFF)], CUT_ASKED, CUT_OFF, CUT_OFF),
    'cut': ([ask(CUT_OFF), told(CUT_OFF)], CUT, None, None),
    'sent': ([ask(CUT_OFF), told(CUT_OFF, False)], CUT_SENT, None, None),
    'asked_twice': ([ask(CUT_OFF), told(CUT_OFF), ask(CUT_OFF)], CUT, None, None),
    'new_listener': ([ask(CUT_OFF), told(CUT_OFF), again], CUT, CUT_OFF, CUT_OFF),
    'failed': ([ask(CUT_OFF), failed(CUT_OFF)], FAILED, None, CUT_OFF),
    'failed_and_asked_again': ([ask(CUT_OFF), failed(CUT_OFF), ask(CUT_OFF)], CUT_ASKED, CUT_OFF,
                               CUT_OFF),
    'give_back': ([ask(CUT_OFF), told(CUT_OFF), ask(GIVE)], RESTORE_ASKED, GIVE, GIVE),
    'given_back': ([ask(CUT_OFF), told(CUT_OFF), ask(GIVE), told(GIVE)], ON, None, None),
    'new_listener_after_that': ([ask(CUT_OFF), told(CUT_OFF), ask(GIVE), told(GIVE), again],
                                ON, None, None),
    'not_given_back': ([ask(CUT_OFF), ask(GIVE), failed(GIVE)], FAILED, None, GIVE),
    'late_word_of_power': ([ask(CUT_OFF), ask(GIVE), ask(CUT_OFF), told(CUT_OFF), told(GIVE)], CUT,
                           CUT_OFF, CUT_OFF),
    'late_failure_to_power': ([ask(GIVE), ask(CUT_OFF), told(CUT_OFF), failed(GIVE)], CUT, CUT_OFF,
                              CUT_OFF),
    'late_word_of_no_power': ([ask(CUT_OFF), ask(GIVE), told(GIVE), told(CUT_OFF)], ON, GIVE, GIVE),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_every_state_and_event(case):
    """State, and what is to be told now and later."""
    events, state, due, later = CASES[case]
    rule = MotorPowerRule()
    for event in events:
        event(rule, 5.0)
    assert (rule.state, rule.due(5.0), rule.due(5.0 + RETRY_S)) == (state, due, later)


def test_a_cut_is_tried_for_ever_and_power_for_a_while():
    """Nobody expects motors to come on after a minute."""
    for cut, expected in ((CUT_OFF, True), (GIVE, False)):
        rule = MotorPowerRule()
        rule.ask(cut, 0.0)
        for second in range(1, int(RESTORE_FOR_S) + 60):
            if rule.due(float(second)) is not None:
                rule.on_failed(cut, float(second))
        assert (rule.due(1000.0) is not None) == expected
        assert rule.state == FAILED


def test_it_says_for_how_long_nothing_is_due():
    """A thread waits for so long, or until it is asked."""
    rule = MotorPowerRule()
    assert (rule.wait_s(0.0), rule.is_cut) == (None, False)
    rule.ask(CUT_OFF, 1.0)
    assert (rule.wait_s(1.0), rule.is_cut) == (0.0, True)
    rule.on_failed(CUT_OFF, 1.0)
    assert rule.wait_s(1.25) == RETRY_S - 0.25 and (RETRY_S, RESTORE_FOR_S) == (1.0, 10.0)
    rule.on_delivered(CUT_OFF, True, 2.0)
    assert (rule.wait_s(2.0), rule.is_cut) == (None, True)
    rule.ask(GIVE, 3.0)
    rule.on_failed(GIVE, 3.0 + RESTORE_FOR_S)
    assert rule.wait_s(3.0 + RESTORE_FOR_S) is None
