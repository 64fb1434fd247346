# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the tasks, and what row and tile say of a robot on a task: real clicks and keys."""
from dataclasses import replace
import math

import pytest
from python_qt_binding.QtCore import QLocale, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QPushButton, QWidget

from mhri.base.gui import theme
from mhri.base.task_views import FieldView, KindView, Progress, RunView, TasksView, TaskView
from mhri.base.views import LIVE, RobotView
from mhri.screen.gui.robot_tile import RobotTile
from mhri.tasks.gui.runs_list import RunsList
from mhri.tasks.gui.tasks_page import TasksPage

KINDS = (
    KindView('goto', 'Go to', 'to a place', (
        FieldView('x', 'm', 'ahead', '', -1000.0, 1000.0),
        FieldView('heading', 'rad', 'where it looks at the end', 'null', -7.0, 7.0),
        FieldView('speed', 'm/s', 'maximum speed', '0.2', 0.02, 2.0),
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
    return page.problem.text()


def test_numbers_have_units_limits_and_defaults(page, operator, asked):
    assert page.keys == ['goto', 'follow', 'patrol', 'return', 'formation', 'dance']
    assert page.kind is KINDS[0]
    assert [field(page, name).placeholderText() for name in ('x', 'heading')] == [
        'required', 'optional']
    assert field(page, 'speed').text() == '0.20' and field(page, 'timeout').text() == '120'
    field(page, 'speed').set_value(99.0)
    field(page, 'x').set_value(-1.25)
    field(page, 'heading').set_value(90.0)
    shown = start(page, operator)
    assert shown.startswith('speed') and '99' in shown and '2' in shown and asked == []
    field(page, 'speed').set_value(2.0)
    assert start(page, operator) == ''
    (key, values), = asked
    assert key == 'goto' and values['heading'] == pytest.approx(math.pi / 2.0, abs=1e-5)
    assert values == {'x': -1.25, 'heading': values['heading'], 'speed': 2.0, 'timeout': 120.0}


def test_what_has_to_be_given_is_asked_for_in_place_and_what_may_be_left_out_is(
        page, operator, asked):
    assert start(page, operator).startswith('x ') and asked == []
    assert page.problem.sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    field(page, 'x').set_value(0.0)
    assert start(page, operator) == ''
    assert asked == [('goto', {'x': 0.0, 'speed': 0.2, 'timeout': 120.0})]
    field(page, 'speed').set_value(None)
    assert start(page, operator).startswith('speed ') and len(asked) == 1


@pytest.fixture(params=['de_DE', 'fr_FR', 'es_ES', 'de_CH', 'en_US', 'ar_EG'])
def language(request):
    """The language of the computer: Qt's default, which a number widget of its own would obey."""
    before = QLocale()
    QLocale.setDefault(QLocale(request.param))
    yield request.param
    QLocale.setDefault(before)


@pytest.mark.parametrize('typed, value', [
    ('1.5', 1.5), ('1,5', 1.5), ('0.5', 0.5), ('-2.25', -2.25), ('-2,25', -2.25)])
def test_a_typed_number_is_the_same_in_every_language(
        language, page, operator, asked, typed, value):
    for name, text in (('x', typed), ('heading', '22,5')):
        operator.click(field(page, name))
        QTest.keyClicks(field(page, name), text)
    assert start(page, operator) == ''
    (_, values), = asked
    assert values['x'] == value and values['heading'] == pytest.approx(math.radians(22.5), abs=1e-5)
    assert field(page, 'heading').text() == '22.5', 'what was understood is shown'


@pytest.mark.parametrize('typed', ['1.500,0', '1,500.0', '1.000.000', '1 500', "1'500", '1.5 km'])
def test_signs_between_groups_are_refused_in_sight_and_nothing_starts(
        language, page, operator, asked, typed):
    x = field(page, 'x')
    plain = x.edge_colour()
    QTest.keyClicks(x, typed)
    shown = start(page, operator)
    assert shown.startswith('x') and typed in shown.replace('\u00a0', ' ') and asked == []
    assert x.text() == typed and x.edge_colour() != plain
    x.step(1)
    assert x.text() == typed, 'is not stepped over'
    x.clear()
    QTest.keyClicks(x, '2')
    assert x.edge_colour() == plain
    assert start(page, operator) == '' and asked[0][1]['x'] == 2.0


def test_what_is_typed_stays_when_the_tasks_are_said_again(page):
    def heard():
        """Return the tasks as from a message, which has NaNs of its own."""
        return replace(TASKS, kinds=tuple(replace(kind, fields=tuple(
            replace(row, least=float(str(row.least)), greatest=float(str(row.greatest)))
            for row in kind.fields)) for kind in KINDS))
    for name in ('follow', 'patrol', 'goto'):
        page.show_tasks(heard(), [BOT], [])
        page.choose(name)
        some = field(page, {'follow': 'distance', 'patrol': 'rounds', 'goto': 'x'}[name])
        some.setText('2')
        page.show_tasks(heard(), [BOT], [])
        assert some.isVisible() and some.text() == '2'


def test_numbers_are_stepped_by_buttons_and_arrow_keys_within_their_limits(page, operator):
    x, speed = field(page, 'x'), field(page, 'speed')
    less, more = (next(part for part in page.findChildren(QPushButton)
                       if part.accessibleName() == 'speed ' + sign) for sign in '\u2212+')
    operator.click(more)
    assert speed.text() == '0.25'
    for _ in range(9):
        operator.click(less)
    assert speed.text() == '0.02'
    QTest.keyClick(x, Qt.Key_Up)
    assert x.text() == '0.00'
    QTest.keyClick(x, Qt.Key_Up)
    assert x.text() == '0.10'
    QTest.keyClick(x, Qt.Key_Down)
    assert x.given() == 0.0


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


@pytest.mark.parametrize('typed, value, problem', [
    ('[[1, 0], [1, 2]]', [[1, 0], [1, 2]], ''), ('', None, 'route'), ('[[1, 0], ', None, 'route')])
def test_a_route_is_typed_as_a_list(page, operator, asked, typed, value, problem):
    page.choose('patrol')
    field(page, 'route').setText(typed)
    shown = start(page, operator)
    assert problem in shown and bool(shown) == bool(problem)
    assert asked == ([] if problem else [('patrol', {'route': value, 'rounds': 0.0})])


@pytest.mark.parametrize('tasks, whom, enabled', [
    (TASKS, [BOT], True), (TASKS, [], False), (replace(TASKS, problem='gone'), [BOT], False)])
def test_start_is_for_somebody_by_somebody(page, tasks, whom, enabled):
    page.show_tasks(tasks, whom, [])
    assert page.start_button.isEnabled() == enabled
    assert page.problem.text() == tasks.problem
    page.show_tasks(TASKS, [BOT], [])
    assert page.problem.text() == ''


def test_the_place_of_a_task_is_chosen_on_the_map_if_it_has_one(page, operator, heard):
    asked = heard(page.places_requested)
    assert not page.places_button.isVisible(), 'no map'
    page.offer_places(('goto',))
    operator.settle()
    field(page, 'speed').setText('1.000,0')
    operator.click(page.places_button)
    assert asked == [] and '1.000,0' in page.problem.text()
    field(page, 'speed').set_value(0.1)
    operator.click(page.places_button)
    assert asked == [('goto', {'speed': 0.1, 'timeout': 120.0})] and page.problem.text() == ''
    page.choose('return')
    assert not page.places_button.isVisible()
    page.choose('goto')
    page.show_tasks(TASKS, [], [])
    assert page.places_button.isVisible() and not page.places_button.isEnabled()


@pytest.fixture
def runs(operator):
    made = RunsList()
    made.resize(400, 600)
    return operator.show(made)


def test_tasks_under_way_are_shown_and_ended(runs, operator, heard):
    stopped = heard(runs.stop_requested)
    run = RunView('a', 'goto', '', (Progress('bot1', 'running', '1.3 m to go', 1.3),
                                    Progress('bot2', 'waiting', 'something is in its way')))
    assert runs.is_empty
    runs.show_tasks(replace(TASKS, runs=(run,)))
    assert not runs.is_empty
    operator.settle()
    texts = [label.text() for label in runs.findChildren(QWidget) if hasattr(label, 'text')]
    for robot in run.robots:
        assert any(robot.robot in text and robot.text in text for text in texts)
    operator.click(runs.findChild(QPushButton, 'task_stop_button'))
    single = [part for part in runs.findChildren(QPushButton, 'task_stop_one_button')]
    assert ['bot1' in part.accessibleName() for part in single] == [True, False]
    operator.click(single[1])
    assert stopped == [['bot1', 'bot2'], ['bot2']]
    ended = replace(run, robots=(run.robots[0], replace(run.robots[1], state='stopped')))
    runs.show_tasks(replace(TASKS, runs=(ended,)))
    assert not any(part.isVisible() for part in single)
    runs.show_tasks(TASKS)
    assert runs.is_empty


def test_an_interrupted_task_is_continued(runs, operator, heard):
    asked = heard(runs.carry_on_requested)
    runs.show_tasks(TASKS, [BOT, replace(BOT, name='bot2', carry_on='Patrol')])
    operator.settle()
    button, = runs.findChildren(QPushButton, 'task_continue_button')
    assert 'bot2' in button.accessibleName() and 'patrol' in button.accessibleName()
    operator.click(button)
    assert asked == ['bot2']
    runs.show_tasks(TASKS, [BOT])
    assert runs.is_empty


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
    tile = operator.show(RobotTile(ui_dir, 'bot1', 'TurtleBot2'))
    tile.show_view(robot)
    assert tile.pill.word == tile.drive_state == 'ON TASK'
    assert tile.hud.sign == sign and words in tile.hud.sentence


def test_to_continue_is_offered_in_row_and_tile(panel, four_robots, operator, ui_dir, heard):
    robot = replace(four_robots.robots[0], selected=False, driven=False, carry_on='Square')
    panel.show_view(replace(four_robots, robots=(robot,)))
    row, rows_ask = panel.robot_list.row('bot1'), heard(panel.robot_list.carry_on_requested)
    assert row.carry_on_button.height() >= theme.SMALLEST_TOUCH_PX
    assert 'square' in row.trouble.text()
    operator.click(row.carry_on_button)
    panel.show_view(four_robots)
    assert rows_ask == ['bot1'] and not row.carry_on_button.isVisible() and row.linear.isVisible()
    tile = operator.show(RobotTile(ui_dir, 'bot1', 'TurtleBot2'))
    tiles_ask = heard(tile.carry_on_requested)
    tile.show_looked_at(True)
    tile.show_view(robot)
    assert 'square' in tile.hud.sentence and 'square' in tile.header.carry_on_button.text()
    operator.click(tile.header.carry_on_button)
    tile.show_view(replace(robot, carry_on=''))
    assert tiles_ask == ['bot1'] and not tile.header.carry_on_button.isVisible()
