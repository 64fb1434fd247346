# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is drawn on the map with mouse and keys, and what comes of it."""
from dataclasses import replace
import math

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QMenu, QPushButton
from support.maps import BOT1, BOT2, click, drag, map_pane, pixel

from mhri.base.gui import theme
from mhri.base.mocap import Pose
from mhri.map import gesture
from mhri.map.gui.map_pane import NOBODY, TOOLS
from mhri.map.scene import MapMark, MapRobot, Scene


@pytest.fixture
def pane(operator):
    """Return a map on the screen with two robots on it, and one that is not."""
    return map_pane(operator)


def test_a_goal_is_placed_aimed_and_let_go(pane, operator, heard):
    told, done = heard(pane.goal_drawn), heard(pane.done)
    operator.click(pane.tools[gesture.GOTO])
    assert 'bot1' in pane.line.text() and pane.tools[gesture.GOTO].isChecked()
    drag(pane, (1.0, -0.5), (0.0, -0.5))
    (names, pose, aimed), = told
    assert names == ['bot1'] and aimed
    assert (pose.x_m, pose.y_m) == pytest.approx((1.0, -0.5), abs=0.02)
    assert abs(pose.heading_rad) == pytest.approx(math.pi, abs=0.02)
    assert done and not pane.tools[gesture.GOTO].isChecked()
    # The tool is put away: a second click sends nobody anywhere.
    click(pane, 1.0, 0.5)
    assert len(told) == 1


def test_those_who_are_selected_are_meant_before_the_one_looked_at(pane, operator, heard):
    told = heard(pane.goal_drawn)
    chosen = MapRobot('bot2', 2, Pose(2.0, 1.0, 1.0), selected=True)
    pane.show_scene(Scene(robots=(BOT1, chosen)))
    operator.click(pane.tools[gesture.GOTO])
    click(pane, 1.0, -0.5)
    assert told[0][0] == ['bot2'] and not told[0][2]


@pytest.mark.parametrize('selected', [('bot1',), ('bot1', 'bot2')])
def test_the_robot_that_was_clicked_is_meant_before_all_others(pane, operator, heard, selected):
    told = heard(pane.goal_drawn)

    def show(looked_at, selected=selected):
        pane.show_scene(Scene(robots=tuple(
            replace(robot, selected=robot.name in selected, looked_at=robot.name == looked_at)
            for robot in (BOT1, BOT2))))
    show('bot1')
    click(pane, 2.0, 1.0)
    show('bot2')
    QTest.mousePress(pane.view, Qt.RightButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
    choose(operator, menu_of(pane, operator), 'Send bot2 here')
    operator.click(pane.tools[gesture.GOTO])
    assert 'bot2' in pane.line.text() and 'bot1' not in pane.line.text()
    click(pane, 1.0, -0.5)
    assert [names for names, _, _ in told] == [['bot2'], ['bot2']]
    # A click beside all of them, other robots selected, or another one looked at: as before.
    for end in (lambda: click(pane, 1.0, -0.5), lambda: show('bot2', ('bot1', 'bot2')[:1 + (
            len(selected) == 1)]), lambda: show('bot1')):
        show('bot1')
        click(pane, 2.0, 1.0)
        show('bot2')
        end()
        assert pane.targets() != ('bot2',)


@pytest.mark.parametrize('end', ['enter', 'double', 'button'])
def test_a_route_is_clicked_and_ended(pane, operator, heard, end):
    told = heard(pane.route_drawn)
    operator.click(pane.tools[gesture.ROUTE])
    assert not pane.done_button.isEnabled()
    click(pane, 0.5, -0.5)
    click(pane, 1.5, -0.5)
    assert told == []
    if end == 'enter':
        operator.hit(pane.view, Qt.Key_Return)
    elif end == 'button':
        operator.click(pane.done_button)
    else:
        where = pixel(pane, 1.5, 0.2)
        QTest.mouseClick(pane.view, Qt.LeftButton, Qt.NoModifier, where)
        QTest.mouseDClick(pane.view, Qt.LeftButton, Qt.NoModifier, where)
    (names, corners), = told
    assert names == ['bot1'] and len(corners) == (3 if end == 'double' else 2)
    assert corners[0] == pytest.approx((0.5, -0.5), abs=0.02)


def test_a_fence_needs_three_corners(pane, operator, heard):
    told = heard(pane.fence_drawn)
    operator.click(pane.tools[gesture.FENCE])
    for corner in ((-0.5, -0.5), (2.5, -0.5), (2.4, 0.0)):
        operator.hit(pane.view, Qt.Key_Return)
        assert told == [] and not pane.done_button.isEnabled()
        click(pane, *corner)
    operator.hit(pane.view, Qt.Key_Backspace)
    assert not pane.done_button.isEnabled()
    click(pane, 2.5, 1.5)
    operator.hit(pane.view, Qt.Key_Return)
    assert len(told) == 1 and len(told[0]) == 3


def test_escape_cancels_every_tool(pane, operator, heard):
    signals = [heard(signal) for signal in (
        pane.goal_drawn, pane.route_drawn, pane.fence_drawn, pane.robot_placed, pane.mark_set,
        pane.leader_chosen)]
    for tool, button in pane.tools.items():
        operator.click(button)
        assert pane.view.gesture.tool == tool and pane.cancel_button.isVisible()
        QTest.mousePress(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
        operator.hit(pane.view, Qt.Key_Escape)
        QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
        assert pane.view.gesture.tool == gesture.LOOK and not pane.cancel_button.isVisible()
    assert all(signal == [] for signal in signals)


def test_a_mark_gets_its_name_in_place(pane, operator, heard):
    told = heard(pane.mark_set)
    operator.click(pane.tools[gesture.MARK])
    click(pane, 1.0, -0.5)
    edit = pane.name_field.edit
    assert pane.name_field.isVisible() and edit.hasFocus()
    edit.clear()
    QTest.keyClicks(edit, 'dock')
    operator.hit(edit, Qt.Key_Return)
    (name, pose), = told
    assert name == 'dock' and (pose.x_m, pose.y_m) == pytest.approx((1.0, -0.5), abs=0.02)
    operator.click(pane.tools[gesture.MARK])
    click(pane, 1.0, -0.5)
    operator.hit(edit, Qt.Key_Escape)
    assert len(told) == 1 and not pane.name_field.isVisible()


def test_a_leader_is_clicked(pane, operator, heard):
    told = heard(pane.leader_chosen)
    for place, words in (((1.0, -0.5), 'no robot'), ((0.0, 0.0), 'cannot follow itself')):
        operator.click(pane.tools[gesture.LEADER])
        click(pane, *place)
        assert words in pane.line.text() and told == []
    operator.click(pane.tools[gesture.LEADER])
    click(pane, 2.0, 1.0)
    assert told == [(['bot1'], 'bot2')]


def test_a_robot_that_is_placed_anew_by_a_click_keeps_its_heading(pane, operator, heard):
    told = heard(pane.robot_placed)
    pane.take(gesture.PLACE, 'bot2')
    click(pane, 1.0, 0.0)
    (name, pose), = told
    assert name == 'bot2' and pose.heading_rad == 1.0


def test_nobody_is_meant_where_nobody_is_looked_at(pane, operator):
    pane.show_scene(Scene(robots=(BOT2,)))
    operator.click(pane.tools[gesture.GOTO])
    assert pane.line.text() == NOBODY and pane.view.gesture.tool == gesture.LOOK
    operator.click(pane.fit_button)
    assert pane.line.text() == NOBODY


def menu_of(pane, operator):
    """Return {words: action} of the menu that is open."""
    operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
    return {action.text(): action for action in QApplication.activePopupWidget().actions()}


def choose(operator, actions, words):
    """Click a row of an open menu."""
    menu = QApplication.activePopupWidget()
    QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier, menu.actionGeometry(
        actions[words]).center())
    operator.wait_until(lambda: QApplication.activePopupWidget() is None)


@pytest.mark.parametrize('place, words, signal, said', [
    ((1.0, -0.5), 'Send bot1 here', 'goal_drawn', ['bot1']),
    ((2.0, 1.0), 'bot1 after bot2', 'leader_chosen', ['bot1']),
    ((2.0, 1.0), 'End the task of bot2', 'end_requested', 'bot2'),
    ((2.0, 1.0), 'Look at bot2', 'look_requested', 'bot2'),
    ((2.0, 1.0), 'Take bot2 off the map', 'robot_placed', 'bot2'),
    ((2.0, 1.0), 'Fit bot2 to the map', 'fit_requested', 'bot2'),
    ((2.0, 1.0), 'Fit bot2 to what bot1 sees', 'fit_requested', 'bot2'),
    ((0.5, 1.0), 'Take dock away', 'mark_set', 'dock'),
    ((0.5, 1.0), 'Send bot1 to dock', 'goal_drawn', ['bot1']),
    ((1.0, -0.5), 'Take the fence away', 'fence_drawn', [])])
def test_the_menu_does_the_same(pane, operator, heard, place, words, signal, said):
    pane.show_scene(Scene(robots=(BOT1, BOT2), marks=(MapMark('dock', Pose(0.5, 1.0, 0.0)),),
                          fence=((-1.0, -1.0), (3.0, -1.0), (3.0, 2.0))))
    told = heard(getattr(pane, signal))
    QTest.mousePress(pane.view, Qt.RightButton, Qt.NoModifier, pixel(pane, *place))
    actions = menu_of(pane, operator)
    choose(operator, actions, words)
    assert len(told) == 1
    assert said in (told[0], next(iter(told[0]), None))


def test_a_long_press_opens_the_menu(pane, operator, heard):
    looked = heard(pane.look_requested)
    QTest.mousePress(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 2.0, 1.0))
    assert 'Look at bot2' in menu_of(pane, operator)
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu) and menu.actionGeometry(
        menu.actions()[0]).height() >= theme.SMALLEST_TOUCH_PX
    menu.close()
    QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 2.0, 1.0))
    assert looked == []


def test_a_click_on_a_robot_looks_at_it(pane, heard):
    looked = heard(pane.look_requested)
    click(pane, 2.0, 1.0)
    click(pane, 1.0, -0.5)
    assert looked == ['bot2']


def test_a_small_map_has_no_tools_and_a_click_makes_it_large(pane, operator, heard):
    swapped = heard(pane.swap_requested)
    pane.show_large(False)
    pane.resize(300, 240)
    operator.settle()
    assert not any(button.isVisible() for button in pane.findChildren(QPushButton))
    assert pane.strip.note.text() == '1 is not placed'
    click(pane, 1.0, 0.0)
    assert len(swapped) == 1


def test_what_came_of_an_act_stays_until_the_next(pane, operator):
    pane.show_answer('bot1: refused: there is no map', False)
    assert pane.line.tone == theme.ATTENTION and 'refused' in pane.line.text()
    for button in (pane.tools[gesture.GOTO], pane.cancel_button):
        operator.click(button)
    assert pane.line.text() == ''


def test_each_tool_is_named_and_explained(pane):
    assert set(pane.tools) == set(gesture.TOOLS) == set(TOOLS)
    assert all(button.toolTip() for button in pane.tools.values())
