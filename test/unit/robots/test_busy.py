# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is asked before a robot is removed or the screen is closed, and when nothing is asked."""
import pytest

from mhri.base.views import RobotView
from mhri.robots.busy import close_question, remove_question


def bot(number, **values):
    return RobotView('bot{}'.format(number), **values)


@pytest.mark.parametrize('values, question', [
    ({}, False), ({'moving': True}, False), ({'selected': True}, True),
    ({'selected': True, 'driven': True}, True), ({'driven': True, 'obeys': 'task'}, True),
    ({'recording': True}, True)])
def test_remove(values, question):
    asked = remove_question(bot(1, **values))
    assert bool(asked) is question and asked.startswith('bot1' * question)


@pytest.mark.parametrize('robots, question', [
    ([], []), ([bot(1), bot(2, selected=True)], []), ([bot(1, driven=True)], ['bot1']),
    ([bot(n, driven=True) for n in (1, 2, 3, 4)], ['4']),
    ([bot(1, driven=True), bot(2, recording=True)], ['bot1', 'bot2'])])
def test_close(robots, question):
    asked = close_question(robots)
    assert bool(asked) == bool(question) and all(part in asked for part in question)
