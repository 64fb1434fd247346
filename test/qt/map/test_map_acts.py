# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is drawn on the map with mouse and keys, and what comes of it."""
from dataclasses import replace
import math

import pytest
from python_qt_binding.QtCore import QEvent, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QMenu, QPushButton
from support.maps import (
    BOT1, BOT2, choose, click, drag, map_pane, move, open_menu, pixel)

from mhri.base.gui import theme
from mhri.base.geometry import Pose
from mhri.map import gesture
from mhri.map.scene import MapRobot, Scene


@pytest.fixture
def pane(operator):
    """Return a map on the screen with two robots on it, and one that is not."""
    return map_pane(operator)


def test_a_goal_is_placed_aimed_and_let_go(pane, operator, heard):
    emitted, done = heard(pane.goal_drawn), heard(pane.done)
    operator.click(pane.tools[gesture.GOTO])
    assert 'bot1' in pane.line.text() and pane.tools[gesture.GOTO].isChecked()
    drag(pane, (1.0, -0.5), (0.0, -0.5))
    (names, pose, aimed), = emitted
    assert names == ['bot1'] and aimed
    assert (pose.x_m, pose.y_m) == pytest.approx((1.0, -0.5), abs=0.02)
    assert abs(pose.heading_rad) == pytest.approx(math.pi, abs=0.02)
    assert done and not pane.tools[gesture.GOTO].isChecked()
    # The tool is put away: a second click sends nobody anywhere.
    click(pane, 1.0, 0.5)
    assert len(emitted) == 1


def test_those_who_are_selected_are_meant_before_the_one_looked_at(pane, operator, heard):
    emitted = heard(pane.goal_drawn)
    chosen = MapRobot('bot2', 2, Pose(2.0, 1.0, 1.0), selected=True)
    pane.show_scene(Scene(robots=(BOT1, chosen)))
    operator.click(pane.tools[gesture.GOTO])
    click(pane, 1.0, -0.5)
    assert emitted[0][0] == ['bot2'] and not emitted[0][2]


@pytest.mark.parametrize('selected', [('bot1',), ('bot1', 'bot2')])
def test_the_robot_that_was_clicked_is_meant_before_all_others(pane, operator, heard, selected):
    emitted = heard(pane.goal_drawn)

    def show(looked_at, selected=selected):
        pane.show_scene(Scene(robots=tuple(
            replace(robot, selected=robot.name in selected, looked_at=robot.name == looked_at)
            for robot in (BOT1, BOT2))))
    show('bot1')
    click(pane, 2.0, 1.0)
    show('bot2')
    QTest.mousePress(pane.view, Qt.RightButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
    actions = open_menu(operator)
    assert list(actions)[1] == 'Send {} (driven) here'.format(' and '.join(selected))
    choose(operator, actions['Send bot2 (clicked) here'])
    operator.click(pane.tools[gesture.GOTO])
    assert 'bot2' in pane.line.text() and 'bot1' not in pane.line.text()
    click(pane, 1.0, -0.5)
    assert [names for names, _, _ in emitted] == [['bot2'], ['bot2']]
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
    emitted = heard(pane.route_drawn)
    operator.click(pane.tools[gesture.ROUTE])
    assert not pane.done_button.isEnabled()
    click(pane, 0.5, -0.5)
    click(pane, 1.5, -0.5)
    assert emitted == []
    if end == 'enter':
        operator.hit(pane.view, Qt.Key_Return)
    elif end == 'button':
        operator.click(pane.done_button)
    else:
        where = pixel(pane, 1.5, 0.2)
        QTest.mouseClick(pane.view, Qt.LeftButton, Qt.NoModifier, where)
        QTest.mouseDClick(pane.view, Qt.LeftButton, Qt.NoModifier, where)
    (names, corners), = emitted
    assert names == ['bot1'] and len(corners) == (3 if end == 'double' else 2)
    assert corners[0] == pytest.approx((0.5, -0.5), abs=0.02)


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
    emitted = heard(pane.mark_set)
    operator.click(pane.tools[gesture.MARK])
    click(pane, 1.0, -0.5)
    edit = pane.name_field.edit
    assert pane.name_field.isVisible() and edit.hasFocus()
    edit.clear()
    QTest.keyClicks(edit, 'dock')
    operator.hit(edit, Qt.Key_Return)
    (name, pose), = emitted
    assert name == 'dock' and (pose.x_m, pose.y_m) == pytest.approx((1.0, -0.5), abs=0.02)
    operator.click(pane.tools[gesture.MARK])
    click(pane, 1.0, -0.5)
    operator.hit(edit, Qt.Key_Escape)
    assert len(emitted) == 1 and not pane.name_field.isVisible()


def test_a_long_press_opens_the_menu(pane, operator, heard):
    looked, asked = heard(pane.look_requested), heard(pane.robot_menu_requested)
    QTest.mousePress(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 2.0, 1.0))
    operator.wait_until(lambda: asked)
    assert asked == [('bot2', pane.view.mapToGlobal(pixel(pane, 2.0, 1.0)))]
    QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 2.0, 1.0))
    QTest.mousePress(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
    assert 'Send bot1 here' in open_menu(operator)
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu) and menu.actionGeometry(
        menu.actions()[0]).height() >= theme.SMALLEST_TOUCH_PX
    menu.close()
    QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
    assert looked == []


# A robot is dragged.

def begin_drag(pane, start, end):
    """Press a place, and move the pointer to another."""
    QTest.mousePress(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, *start))
    move(pane.view, pixel(pane, *end))


def test_a_robot_goes_where_its_mark_is_dragged_whoever_is_driven(pane, heard):
    emitted, looked = heard(pane.goal_drawn), heard(pane.look_requested)
    pane.show_scene(Scene(robots=(replace(BOT1, selected=True), BOT2)))
    before = pane.view.canvas
    begin_drag(pane, (2.0, 1.0), (1.0, -0.5))
    assert 'bot2' in pane.line.text() and 'bot1' not in pane.line.text()
    QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
    (names, pose, aimed), = emitted
    assert names == ['bot2'] and not aimed and looked == []
    assert (pose.x_m, pose.y_m) == pytest.approx((1.0, -0.5), abs=0.02)
    assert pane.view.canvas == before and pane.view.gesture.tool == gesture.LOOK


def back(pane, operator):
    move(pane.view, pixel(pane, 2.0, 1.0))


def escape(pane, operator):
    operator.hit(pane.view, Qt.Key_Escape)


def lost_release(pane, operator):
    move(pane.view, pixel(pane, 1.0, -0.5), Qt.NoButton)


@pytest.mark.parametrize('end, place', [
    (back, (2.0, 1.0)), (escape, (1.0, -0.5)), (lost_release, (1.0, -0.5)),
    (lambda *_: None, (0.0, 0.0)), (lambda *_: None, (-50.0, 0.0))])
def test_a_drag_that_is_not_meant_sends_nobody(pane, operator, heard, end, place):
    emitted = heard(pane.goal_drawn)
    begin_drag(pane, (2.0, 1.0), (1.0, -0.5))
    end(pane, operator)
    QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, *place))
    assert emitted == [] and pane.view.gesture.tool == gesture.LOOK


def test_a_double_click_that_began_before_the_tool_sends_nobody(pane, heard):
    emitted = heard(pane.goal_drawn)
    pane.choose_tool(gesture.GOTO, ('bot1',))
    where = pixel(pane, 1.0, -0.5)
    QApplication.sendEvent(pane.view, QMouseEvent(
        QEvent.MouseButtonDblClick, QPointF(where), Qt.LeftButton, Qt.LeftButton, Qt.NoModifier))
    QTest.mouseRelease(pane.view, Qt.LeftButton, Qt.NoModifier, where)
    assert emitted == [] and pane.view.gesture.tool == gesture.GOTO
    # Nor does a press before the map could be seen.
    pane.view.wait_for_paint()
    QTest.mouseClick(pane.view, Qt.LeftButton, Qt.NoModifier, where)
    assert emitted == [] and pane.view.gesture.tool == gesture.GOTO


def test_a_small_map_has_no_tools_and_a_click_makes_it_large(pane, operator, heard):
    swapped = heard(pane.swap_requested)
    pane.show_large(False)
    pane.resize(300, 240)
    operator.settle()
    assert not any(button.isVisible() for button in pane.findChildren(QPushButton))
    assert '1' in pane.strip.note.text()
    click(pane, 1.0, 0.0)
    assert len(swapped) == 1
