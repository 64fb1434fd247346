# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""No parameter raises the limit of a robot that is driven."""
from mhri.base.robot_types import Limits
from mhri.driving.driven_limits import DrivenLimits

SLOW, FAST = Limits(0.1, 1.0), Limits(0.5, 0.5)


def test_a_robot_that_was_not_driven_follows_its_parameters():
    driven = DrivenLimits()
    assert driven.of('bot1', SLOW) == SLOW and driven.of('bot1', FAST) == FAST


def test_one_that_was_driven_keeps_the_lowest_of_each_until_it_is_selected_anew():
    driven = DrivenLimits()
    driven.note('bot1', SLOW)
    driven.select(['bot1', 'bot2'])
    assert driven.of('bot1', FAST) == Limits(0.1, 0.5) and driven.of('bot2', FAST) == FAST
    driven.note('bot1', FAST)
    assert driven.of('bot1', SLOW) == Limits(0.1, 0.5)
    driven.select(['bot2'])
    assert driven.of('bot1', FAST) == FAST


def test_the_next_process_keeps_it():
    driven, after = DrivenLimits(), DrivenLimits()
    driven.note('bot1', SLOW)
    after.restore(driven.kept())
    assert after.of('bot1', FAST) == Limits(0.1, 0.5)
