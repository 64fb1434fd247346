# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the tasks, and what row and tile say of a robot on a task: real clicks and keys."""
from dataclasses import replace
import math

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QPushButton, QWidget

from mhri.base.gui import theme
from mhri.base.task_views import FieldView, KindView, Progress, RunView, TasksView, TaskView
from mhri.base.views import LIVE, RobotView
from mhri.screen.gui.bot_window import BotWindow
from mhri.tasks.gui.tasks_page import NONE_UNDER_WAY, TasksPage

KINDS = (
    KindView('goto', 'Go to', 'to a place', (
        FieldView('x', 'm', 'ahead', '', -1000.0, 1000.0),
        FieldView('heading', 'rad', 'where it looks at the end', 'null', -7.0, 7.0),
        FieldView('speed', 'm/s', 'the most it drives', '0.2', 0.02, 2.0),
        FieldView('timeout', 's', 'give up after so long', '120.0', 0.0, 86400.0))),
    KindView('follow', 'Follow', 'keeps a distance', (
        FieldView('leader', '', 'whom it follows', ''),
        FieldView('distance', 'm', 'kept', '0.8', 0.3, 10.0))),
    KindView('patrol', 'Patrol', 'along a route', (
        FieldView('route', 'm', 'its corners: [[x, y], ...]', ''),
        FieldView('frame', '', 'of its places', "''", choices=('', 'odom')),
        FieldView('rounds', '', 'how often', '0.0', 0.0, 10000.0))),
    KindView('return', 'Return', 'to a mark', (FieldView('mark', '', 'its name', "''"),)),
    KindView('formation', 'Formation', 'in shape', (
        FieldView('shape', '', 'line or wedge', 'wedge', choices=('line', 'wedge')),)),
    KindView('dance', 'Dance', 'of a lab', (FieldView('broken', '', 'unreadable', '{', 0.0, 1.0),)))
BOT = RobotView('bot1', link=LIVE, number=1)
TASKS = TasksView(kinds=KINDS)
ON_SQUARE = TaskView('Square', 'corner 2 of 4: 1.3 m to go', False, 4.3)
WAITS = TaskView('Square', 'something is in its way', True, 4.3)


@pytest.fixture
def page(operator):
    made = TasksPage()
    made.resize(400, 600)
    made.show_tasks(TASKS, [BOT], ['bot1', 'bot2'])
    return operator.show(made)


@pytest.fixture
def asked(page, heard):
    return heard(page.start_requested)


def field(page, name):
    return next(part for part in page.findChildren(QWidget, 'task_field_' + name)
                if part.isVisible())


def start(page, operator):
    operator.click(page.start_button)
    return page.problem_label.text()


def test_numbers_have_units_limits_and_defaults(page, operator, asked):
    assert page.keys == ['goto', 'follow', 'patrol', 'return', 'formation', 'dance']
    assert page.kind is KINDS[0]
    assert field(page, 'x').text() == 'to be given' and field(page, 'heading').text() == 'left out'
    assert field(page, 'speed').text() == '0.20 m/s' and field(page, 'timeout').text() == '120 s'
    field(page, 'speed').setValue(99.0)
    field(page, 'x').setValue(-1.25)
    field(page, 'heading').setValue(90.0)
    assert start(page, operator) == ''
    (key, values), = asked
    assert key == 'goto' and values['heading'] == pytest.approx(math.pi / 2.0, abs=1e-5)
    assert values == {'x': -1.25, 'heading': values['heading'], 'speed': 2.0, 'timeout': 120.0}


def test_what_has_to_be_given_is_asked_for_in_place_and_what_may_be_left_out_is(
        page, operator, asked):
    assert start(page, operator) == 'x is missing: ahead' and asked == []
    assert page.problem_sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    field(page, 'x').setValue(0.0)
    assert start(page, operator) == ''
    assert asked == [('goto', {'x': 0.0, 'speed': 0.2, 'timeout': 120.0})]


def test_numbers_can_be_typed_and_pressed(page, operator, asked, application):
    x = field(page, 'x')
    x.setFocus()
    x.selectAll()
    for sign in '2.5':
        operator.hit(x, ord(sign))
        x.lineEdit().insert(sign)
    more, = (button for button in page.findChildren(QPushButton)
             if button.accessibleName() == 'speed +')
    assert min(more.width(), more.height()) >= theme.SMALLEST_TOUCH_PX
    operator.click(more)
    start(page, operator)
    assert asked[0][1]['x'] == 2.5 and asked[0][1]['speed'] == 0.25
    assert not x.hasFocus(), 'the keys drive again'


def test_the_first_step_of_a_number_that_is_not_given_is_zero(page, operator):
    for name in ('x', 'heading'):
        field(page, name).stepUp()
        assert field(page, name).value() == 0.0


def test_a_leader_is_chosen_among_the_robots(page, operator, asked):
    page.choose('follow')
    leader = field(page, 'leader')
    assert [leader.itemText(place) for place in range(leader.count())] == ['bot1', 'bot2']
    leader.setEditText('bot2')
    page.show_tasks(TASKS, [BOT], ['bot1', 'bot2', 'bot3'])
    assert leader.currentText() == 'bot2' and leader.count() == 3
    start(page, operator)
    assert asked == [('follow', {'leader': 'bot2', 'distance': 0.8})]


def test_a_mark_is_chosen_among_those_there_are_or_left_out(page, operator, asked):
    page.choose('return')
    page.show_tasks(replace(TASKS, marks=('dock', 'door')), [BOT], [])
    mark = field(page, 'mark')
    assert [mark.itemText(place) for place in range(mark.count())] == ['dock', 'door']
    assert mark.currentText() == ''
    start(page, operator)
    mark.setCurrentIndex(1)
    page.show_tasks(replace(TASKS, marks=('dock', 'door', 'gate')), [BOT], [])
    start(page, operator)
    assert asked == [('return', {}), ('return', {'mark': 'door'})]


def test_few_words_are_chosen_not_typed(page, operator, asked):
    page.choose('formation')
    shape = field(page, 'shape')
    assert not shape.isEditable() and shape.currentText() == 'wedge'
    start(page, operator)
    operator.hit(shape, Qt.Key_Up)
    start(page, operator)
    page.choose('patrol')
    assert field(page, 'frame').currentText() == 'left out'
    field(page, 'route').setText('[[1, 0]]')
    start(page, operator)
    field(page, 'frame').setCurrentIndex(1)
    start(page, operator)
    assert [values.get('shape', values.get('frame')) for _, values in asked] == [
        'wedge', 'line', None, 'odom']


@pytest.mark.parametrize('typed, value, problem', [
    ('[[1, 0], [1, 2]]', [[1, 0], [1, 2]], ''), ('', None, 'route is missing: its corners'),
    ('[[1, 0], ', None, 'route: its brackets do not fit')])
def test_a_route_is_typed_as_a_list(page, operator, asked, typed, value, problem):
    page.choose('patrol')
    field(page, 'route').setText(typed)
    assert start(page, operator).startswith(problem)
    assert asked == ([] if problem else [('patrol', {'route': value, 'rounds': 0.0})])


def test_what_was_entered_is_there_again(page):
    field(page, 'x').setValue(3.0)
    page.choose('patrol')
    page.choose('goto')
    assert field(page, 'x').value() == 3.0
    page.show_tasks(replace(TASKS, kinds=KINDS[1:]), [BOT], [])
    page.show_tasks(replace(TASKS, kinds=()), [BOT], [])
    assert page.kind is None and not page.start_button.isEnabled()


@pytest.mark.parametrize('tasks, whom, enabled', [
    (TASKS, [BOT], True), (TASKS, [], False), (replace(TASKS, problem='gone'), [BOT], False)])
def test_start_is_for_somebody_by_somebody(page, tasks, whom, enabled):
    page.show_tasks(tasks, whom, [])
    assert page.start_button.isEnabled() == enabled
    assert page.problem_label.text() == tasks.problem
    page.show_tasks(TASKS, [BOT], [])
    assert page.problem_label.text() == ''


def test_a_refusal_stays_until_the_next_start(page, operator):
    page.show_problem('refused')
    page.show_tasks(TASKS, [BOT], [])
    assert page.problem_label.isVisible() and page.problem_label.text() == 'refused'
    page.choose('dance')
    assert start(page, operator) == '' and not page.problem_label.isVisible()


def test_tasks_under_way_are_shown_and_ended(page, operator, heard):
    stopped = heard(page.stop_requested)
    run = RunView('a', 'goto', '', (Progress('bot1', 'running', '1.3 m to go', 1.3),
                                    Progress('bot2', 'waiting', 'something is in its way')))
    assert page.under_way_label.text() == NONE_UNDER_WAY and page.under_way_label.isVisible()
    page.show_tasks(replace(TASKS, runs=(run,)), [BOT], [])
    operator.settle()
    texts = [label.text() for label in page.findChildren(QWidget) if hasattr(label, 'text')]
    assert 'bot1  go to: 1.3 m to go' in texts
    assert 'bot2  go to waits: something is in its way' in texts
    operator.click(page.findChild(QPushButton, 'task_stop_button'))
    assert page.findChild(QPushButton, 'task_stop_button').text() == 'Stop all of them'
    single = [part for part in page.findChildren(QPushButton, 'task_stop_one_button')]
    assert [part.accessibleName() for part in single] == [
        'stop Go to of bot1', 'stop Go to of bot2']
    operator.click(single[1])
    assert stopped == [['bot1', 'bot2'], ['bot2']]
    ended = replace(run, robots=(run.robots[0], replace(run.robots[1], state='stopped')))
    page.show_tasks(replace(TASKS, runs=(ended,)), [BOT], [])
    assert not any(part.isVisible() for part in single)
    page.show_tasks(TASKS, [BOT], [])
    assert page.under_way_label.isVisible()


@pytest.mark.parametrize('task, sign, words', [
    (ON_SQUARE, theme.ON_TASK, '1.3 m to go'), (WAITS, theme.TASK_WAITS, 'in its way')])
def test_row_and_tile_say_what_it_does_and_why_it_waits(
        panel, four_robots, operator, ui_dir, task, sign, words):
    robot = replace(four_robots.robots[0], selected=False, obeys='task', task=task)
    panel.show_view(replace(four_robots, robots=(robot,)))
    row = panel.robot_list.row('bot1')
    assert row.task_pill.isVisible() and row.task_pill.word == 'ON TASK' and row.pill.word == ''
    assert row.trouble_sign.sign == sign and words in row.trouble.text()
    assert words in row.trouble.shown_text()
    tile = operator.show(BotWindow(ui_dir, 'bot1', 'TurtleBot2'))
    tile.show_view(robot)
    assert tile.pill.word == tile.drive_state == 'ON TASK'
    assert tile.hud.sign == sign and words in tile.hud.sentence


def test_a_bad_link_hides_neither_the_task_nor_is_hidden_by_it(
        panel, four_robots, operator, ui_dir):
    robot = replace(four_robots.robots[0], selected=False, obeys='task', task=ON_SQUARE, slow=True,
                    note='18 % of its messages lost')
    panel.show_view(replace(four_robots, robots=(robot,)))
    row = panel.robot_list.row('bot1')
    assert row.trouble.text().startswith('square: corner 2')
    assert row.trouble_sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    tile = operator.show(BotWindow(ui_dir, 'bot1', 'TurtleBot2'))
    tile.show_view(robot)
    assert tile.hud.sentence == '18 % of its messages lost; square: corner 2 of 4, 1.3 m to go'


def test_a_robot_that_is_taken_over_is_driven_whatever_its_task_says(panel, four_robots):
    robot = replace(four_robots.robots[0], obeys='operator', task=ON_SQUARE)
    panel.show_view(replace(four_robots, robots=(robot,)))
    row = panel.robot_list.row('bot1')
    assert row.pill.word == 'DRIVING' and not row.task_pill.isVisible()


def test_to_continue_is_offered_in_row_and_tile(panel, four_robots, operator, ui_dir, heard):
    robot = replace(four_robots.robots[0], selected=False, driven=False, carry_on='Square')
    panel.show_view(replace(four_robots, robots=(robot,)))
    row, rows_ask = panel.robot_list.row('bot1'), heard(panel.robot_list.carry_on_requested)
    assert row.carry_on_button.height() >= theme.SMALLEST_TOUCH_PX
    assert row.trouble.text() == 'square interrupted'
    operator.click(row.carry_on_button)
    panel.show_view(four_robots)
    assert rows_ask == ['bot1'] and not row.carry_on_button.isVisible() and row.linear.isVisible()
    tile = operator.show(BotWindow(ui_dir, 'bot1', 'TurtleBot2'))
    tiles_ask = heard(tile.carry_on_requested)
    tile.show_looked_at(True)
    tile.show_view(robot)
    assert tile.hud.sentence == 'square interrupted: press C to continue it'
    assert tile.header.carry_on_button.text() == 'Continue square'
    operator.click(tile.header.carry_on_button)
    tile.show_view(replace(robot, carry_on=''))
    assert tiles_ask == ['bot1'] and not tile.header.carry_on_button.isVisible()


def test_the_key_says_so(panel, four_robots, operator, heard):
    commands = heard(panel.drive_keys.command_pressed)
    panel.show_view(four_robots)
    operator.hit(panel.stage, Qt.Key_C, scan=54)
    assert commands == ['carry_on']
