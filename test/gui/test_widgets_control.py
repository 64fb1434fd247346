# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who drives, and taking control in two steps, in place; what is not in force looks so."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import Qt

from mhri.base.views import ControlView

WHO = 'panel on lab-pc2 since 14:02'


@pytest.fixture
def watching(panel, four_robots):
    """Return the panel while somebody else drives."""
    panel.show_view(replace(four_robots, control=ControlView(False, WHO)))
    return panel


def test_a_screen_that_drives_says_nothing_of_it(panel, four_robots):
    panel.show_view(four_robots)
    assert not panel.control_bar.isVisible()


def test_it_says_who_drives_and_takes_over_in_two_steps(watching, operator, heard):
    bar = watching.control_bar
    taken = heard(watching.control_requested)
    line = bar.findChild(type(watching.linear_label), 'control_label')
    assert bar.isVisible() and line.text() == 'Drives: ' + WHO
    assert not bar.confirm_button.isVisible()
    place = bar.take_button.mapTo(bar, bar.take_button.rect().center())
    operator.click(bar.take_button)
    assert WHO in line.text() and bar.confirm_button.isVisible() and taken == []
    assert bar.childAt(place) is bar.take_button and bar.take_button.text() == 'Cancel'
    operator.click(bar.take_button)
    assert not bar.confirm_button.isVisible() and taken == []
    operator.click(bar.take_button)
    operator.click(bar.confirm_button)
    assert taken == [()] and not bar.confirm_button.isVisible()


def test_boxes_digits_and_stick_are_not_in_force(watching, operator, heard):
    asked = heard(watching.selection_requested)
    assert not watching.robot_list.row('bot2').box.isEnabled()
    operator.click(watching.robot_list.row('bot2').box)
    operator.hit(watching, Qt.Key_2, scan=11)
    operator.hit(watching, Qt.Key_0, scan=19)
    operator.click(watching.all_button)
    assert asked == []
    assert watching.drive_note.text() == 'no effect: panel on lab-pc2 drives'


def test_they_are_again_with_control(watching, operator, heard, four_robots):
    asked = heard(watching.selection_requested)
    watching.show_view(four_robots)
    assert not watching.control_bar.isVisible()
    operator.click(watching.robot_list.row('bot2').box)
    assert asked == [['bot1', 'bot2']]
