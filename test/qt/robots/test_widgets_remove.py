# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Remove: at once what nobody uses, in two steps in place what somebody does, and back again."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import QTimer
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.robots.gui import remove_steps
from mhri.robots.gui.remove_steps import KEEP, REMOVE


@pytest.fixture
def steps(panel, four_robots):
    """The buttons below a list in which bot1 is driven, and nobody uses the others."""
    panel.show_view(four_robots)
    return panel.remove_steps


def highlight(panel, operator, name):
    operator.click(panel.robot_list.row(name))
    assert panel.robot_list.current == name


def question(panel):
    """The question on show, '' for none."""
    line = panel.findChild(QWidget, 'remove_label')
    return line.text() if line.isVisible() else ''


def expire(steps):
    """Let the time run out that is being waited for."""
    for timer in steps.findChildren(QTimer):
        if timer.isActive():
            timer.start(1)


def test_one_that_nobody_uses_goes_at_once(panel, operator, heard, steps):
    removed = heard(panel.remove_steps.remove_requested)
    highlight(panel, operator, 'bot2')
    operator.click(panel.remove_button)
    assert removed == ['bot2'] and not question(panel)


def test_one_that_is_driven_is_asked_for_in_place(panel, operator, heard, steps):
    removed = heard(panel.remove_steps.remove_requested)
    highlight(panel, operator, 'bot1')
    operator.click(panel.remove_button)
    assert 'bot1' in question(panel) and removed == []
    assert panel.remove_button.text() == KEEP and not panel.all_button.isVisible()
    assert QApplication.activeModalWidget() is None
    operator.click(steps.confirm_button)
    assert removed == ['bot1']
    assert not question(panel) and panel.remove_button.text() == REMOVE
    assert panel.all_button.isVisible()


def test_a_double_click_removes_nothing(panel, operator, heard, steps):
    removed = heard(panel.remove_steps.remove_requested)
    highlight(panel, operator, 'bot1')
    for _ in range(2):
        operator.click(panel.remove_button)
        operator.settle()
    assert removed == [] and not question(panel)


@pytest.mark.parametrize('change', [
    lambda panel, operator: highlight(panel, operator, 'bot2'),
    lambda panel, operator: expire(panel.remove_steps)], ids=['another highlighted', 'no answer'])
def test_the_question_goes_where_it_makes_no_sense_any_more(panel, operator, heard, steps, change,
                                                            four_robots):
    removed = heard(panel.remove_steps.remove_requested)
    highlight(panel, operator, 'bot1')
    operator.click(panel.remove_button)
    assert question(panel)
    change(panel, operator)
    panel.show_view(four_robots)
    operator.wait_until(lambda: not question(panel))
    assert removed == []


def test_undo_is_offered_where_remove_was_and_a_double_click_is_not_one(
        panel, operator, heard, steps, four_robots, monkeypatch):
    undone = heard(steps.undo_requested)
    highlight(panel, operator, 'bot2')
    first, _, *rest = four_robots.robots
    monkeypatch.setattr(remove_steps, 'SETTLED_S', 1e6)
    steps.offer_undo('bot2')
    panel.show_view(replace(four_robots, robots=(first, *rest)))
    assert steps.undo_button.isVisible() and not panel.remove_button.isVisible()
    assert 'bot2' in steps.undo_button.toolTip()
    operator.click(steps.undo_button)
    assert undone == []
    monkeypatch.setattr(remove_steps, 'SETTLED_S', 0.0)
    operator.click(steps.undo_button)
    assert undone == ['bot2'] and not steps.undo_button.isVisible()


def test_undo_gives_way_to_another_robot_and_ends(panel, operator, steps, four_robots):
    steps.offer_undo('bot9')
    highlight(panel, operator, 'bot3')
    assert panel.remove_button.isVisible() and not steps.undo_button.isVisible()
    panel.robot_list.clear()
    assert steps.undo_button.isVisible()
    expire(steps)
    operator.wait_until(panel.remove_button.isVisible)
    assert not steps.undo_button.isVisible()
