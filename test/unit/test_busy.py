# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is asked before a robot is removed or the screen is closed, and when nothing is asked."""
import pytest

from mhri.base.views import RobotView
from mhri.robots.busy import close_question, remove_question


def bot(number, **values):
    return RobotView('bot{}'.format(number), **values)


@pytest.mark.parametrize('values, question', [
    ({}, ''), ({'moving': True}, ''),
    ({'selected': True}, 'bot1 is selected: remove it?'),
    ({'selected': True, 'driven': True}, 'bot1 is driven: remove it?'),
    ({'driven': True, 'obeys': 'task'}, 'bot1 is on a task: remove it?'),
    ({'recording': True}, 'bot1 is being recorded: remove it?'),
    ({'selected': True, 'recording': True}, 'bot1 is selected and being recorded: remove it?')])
def test_remove(values, question):
    assert remove_question(bot(1, **values)) == question


@pytest.mark.parametrize('robots, question', [
    ([], ''), ([bot(1), bot(2, selected=True)], ''),
    ([bot(1, driven=True)], 'bot1 is driven: close anyway?'),
    ([bot(1, driven=True), bot(2, driven=True)], 'bot1 and bot2 are driven: close anyway?'),
    ([bot(n, driven=True) for n in (1, 2, 3)], 'bot1, bot2 and bot3 are driven: close anyway?'),
    ([bot(n, driven=True) for n in (1, 2, 3, 4)], '4 robots are driven: close anyway?'),
    ([bot(1, driven=True), bot(2, recording=True)],
     'bot1 is driven, bot2 is being recorded: close anyway?'),
    ([bot(1, driven=True), bot(2, driven=True, obeys='task')],
     'bot1 is driven, bot2 is on a task: close anyway?')])
def test_close(robots, question):
    assert close_question(robots) == question
