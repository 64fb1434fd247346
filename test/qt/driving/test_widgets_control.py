# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who drives, and taking control in two steps, in place; what is not in force looks so."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import Qt

from mhri.base.views import ControlView

WHO = ControlView(False, 'panel on lab-pc2', '14:02')


@pytest.fixture
def watching(panel, four_robots):
    """Return the panel while somebody else drives."""
    panel.show_view(replace(four_robots, control=WHO))
    return panel


def test_a_screen_that_drives_says_nothing_of_it(panel, four_robots):
    panel.show_view(four_robots)
    assert not panel.control_bar.isVisible()


def test_it_says_who_drives_and_takes_over_in_two_steps(watching, operator, heard):
    bar = watching.control_bar
    taken = heard(bar.take_requested)
    line = bar.findChild(type(watching.linear_label), 'control_label')
    assert bar.isVisible() and not line.isVisible()
    assert not bar.confirm_button.isVisible()
    place = bar.take_button.mapTo(watching, bar.take_button.rect().center())
    operator.click(bar.take_button)
    assert WHO.words in line.text() and bar.confirm_button.isVisible() and taken == []
    assert watching.childAt(place) is bar.take_button and bar.take_button.text() == 'Cancel'
    operator.click(bar.take_button)
    assert not bar.confirm_button.isVisible() and taken == []
    operator.click(bar.take_button)
    operator.click(bar.confirm_button)
    assert taken == [()] and not bar.confirm_button.isVisible()


@pytest.mark.parametrize('width', [794, 1024])
def test_taking_control_says_whole_at_every_width_that_robots_stop(watching, operator, width):
    bar = watching.control_bar
    watching.resize(width, 700)
    operator.click(bar.take_button)
    operator.settle()
    line = bar.findChild(type(watching.linear_label), 'control_label')
    assert 'obots stop' in line.shown_text() and line.shown_text() in line.texts
    assert line.height() >= 2 * line.fontMetrics().height()
    assert width < 1024 or 'centre the stick' in line.shown_text()


def test_boxes_digits_and_stick_are_not_in_force(watching, operator, heard, four_robots):
    asked = heard(watching.robot_list.selection_requested)
    assert not watching.robot_list.row('bot2').box.isEnabled()
    operator.click(watching.robot_list.row('bot2').box)
    operator.hit(watching, Qt.Key_2, scan=11)
    operator.hit(watching, Qt.Key_0, scan=19)
    operator.click(watching.all_button)
    assert asked == []
    assert watching.drive_note.text() == 'no effect: panel on lab-pc2 drives'
    watching.show_view(four_robots)
    operator.click(watching.robot_list.row('bot2').box)
    assert asked == [['bot1', 'bot2']], 'they are again, with control'
