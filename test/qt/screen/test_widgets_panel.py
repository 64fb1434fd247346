# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel as a whole: what it shows of a view, what it asks for, and how large things are."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QLabel

from mhri.base import views
from mhri.driving.stop_words import stop_words


def test_buttons_and_fields_ask(panel, operator, heard, four_robots):
    panel.show_view(four_robots)
    looked, added = heard(panel.look_requested), heard(panel.add_requested)
    removed = heard(panel.remove_steps.remove_requested)
    selected = heard(panel.robot_list.selection_requested)
    operator.click(panel.look_button)
    QTest.keyClicks(panel.name_edit, 'bot5')
    operator.click(panel.add_button)
    QTest.keyClick(panel.name_edit, Qt.Key_Return)
    assert (looked, added) == ([()], ['bot5', 'bot5'])
    assert not panel.remove_button.isEnabled(), 'nothing is highlighted'
    operator.click(panel.robot_list.row('bot3'))
    operator.click(panel.remove_button)
    operator.click(panel.all_button)
    operator.click(panel.none_button)
    assert removed == ['bot3']
    assert selected == [['bot1', 'bot2', 'bot3', 'bot4'], []]


def test_after_adding_a_robot_the_keys_drive_again(panel, operator):
    operator.click(panel.name_edit)
    QTest.keyClicks(panel.name_edit, 'bot5')
    assert panel.name_edit.hasFocus()
    panel.show_name_problem('no')
    assert panel.name_edit.hasFocus(), 'a name that was refused is typed again'
    panel.clear_name()
    operator.press(panel.focusWidget(), Qt.Key_W, scan=25)
    assert not panel.name_edit.hasFocus() and panel.stick() == (1.0, 0.0, 0.0)
    operator.release(panel.focusWidget(), Qt.Key_W, scan=25)


@pytest.mark.parametrize('state', [
    views.PROOF_STOPPED, views.PROOF_WAITING, views.PROOF_NOT_CONFIRMED])
def test_the_stop_bar_claims_what_the_rows_prove(panel, four_robots, state):
    robot = replace(four_robots.robots[0], proof=views.ProofView(state, state))
    panel.show_view(replace(four_robots, stop_all=True, robots=(robot,)))
    headline = panel.findChild(QLabel, 'stopped_label').text()
    assert headline == stop_words((robot,), True, True).headlines[0]
    assert headline.startswith('STOPPED') == (state == views.PROOF_STOPPED)


def test_showing_views_takes_no_focus_and_asks_for_nothing(panel, operator, heard, four_robots):
    panel.name_edit.setFocus()
    operator.wait_until(panel.name_edit.hasFocus)
    said = [heard(signal) for signal in (
        panel.robot_list.selection_requested, panel.mode_combo.mode_requested,
        panel.speed_limits.limits_requested, panel.stick_moved, panel.looked_at,
        panel.stop_requested, panel.stop_bar.release_requested)]
    stopped = replace(four_robots, stop_all=True, mode='voice', limits=(0.3, 1.0))
    for view in (four_robots, stopped, views.ScreenView(), four_robots):
        panel.show_view(view)
        operator.settle()
        assert panel.name_edit.hasFocus()
    assert all(signal == [] for signal in said)


def test_a_hidden_panel_drives_nothing(panel, operator):
    operator.press(panel, Qt.Key_W, 25)
    panel.hide()
    assert panel.stick() == (0.0, 0.0, 0.0)


def test_record_selected_asks_for_those_that_are_and_then_for_the_end(
        panel, operator, heard, four_robots):
    recorded, ended = heard(panel.record_requested), heard(panel.stop_record_requested)
    unselected = tuple(replace(robot, selected=False) for robot in four_robots.robots)
    panel.show_view(replace(four_robots, robots=unselected))
    assert not panel.record_button.isEnabled()
    robots = [replace(robot, selected=robot.name in ('bot1', 'bot3'))
              for robot in four_robots.robots]
    panel.show_view(replace(four_robots, robots=tuple(robots)))
    operator.click(panel.record_button)
    assert (recorded, ended) == ([['bot1', 'bot3']], [])
    going = tuple(replace(robot, recording=robot.name in ('bot1', 'bot2')) for robot in robots)
    panel.show_view(replace(four_robots, robots=going))
    assert '(2)' in panel.record_button.text()
    pill = panel.robot_list.row('bot2').recording
    assert pill.word == 'rec'
    assert panel.robot_list.row('bot3').recording.word == ''
    operator.click(panel.record_button)
    assert (recorded, ended) == ([['bot1', 'bot3']], [['bot1', 'bot2']])


def test_push_to_talk_by_button_and_key_and_only_with_the_voice(panel, heard, four_robots):
    talked = heard(panel.talk_requested)
    panel.show_view(four_robots)
    assert panel.talk_button.isHidden()
    QTest.keyPress(panel, Qt.Key_T)
    QTest.keyRelease(panel, Qt.Key_T)
    assert True not in talked, 'another source drives'
    panel.show_view(replace(four_robots, mode='voice'))
    assert not panel.talk_button.isHidden()
    panel.arrangement.show_page(panel.drive_side)
    talked.clear()
    QTest.mousePress(panel.talk_button, Qt.LeftButton)
    QTest.mouseRelease(panel.talk_button, Qt.LeftButton)
    assert talked == [True, False]
    talked.clear()
    QTest.keyPress(panel, Qt.Key_T)
    assert talked[-1] is True and panel.talk_button.isDown()
    panel.drive_keys.release()
    assert talked[-1] is False and not panel.talk_button.isDown(), 'focus lost, ear closed'


@pytest.mark.parametrize('key', ['together', 'brake'])
def test_staying_together_and_the_brake_are_asked_for_and_shown(
        panel, operator, heard, four_robots, key):
    limits = panel.speed_limits
    asked = heard(getattr(limits, key + '_requested'))
    box = getattr(limits, key + '_box')
    panel.show_view(four_robots)
    assert not box.isChecked()
    operator.click(box)
    panel.show_view(replace(four_robots, **{key: True}))
    assert asked == [True] and box.isChecked()
    operator.click(box)
    assert asked == [True, False]
