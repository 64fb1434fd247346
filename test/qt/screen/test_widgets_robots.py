# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of robots: what rows say, what clicks ask for, and that nothing jumps."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest

from mhri.base import views
from mhri.base.gui import theme
from mhri.base.gui.labels import BatteryLine
from mhri.base.views import ProofView, RobotView
from mhri.robots.gui.robot_list import RobotList
from mhri.robots.gui.robot_row import DRIVING, MOVING, RobotRow
from mhri.robots.owners import ASK_FOR, TAKE_IT

LIVE = RobotView('bot1', 'TurtleBot2', link=views.LIVE, age_s=0.012, linear_mps=0.31,
                 angular_rad_s=-0.2, battery=0.82)


@pytest.fixture
def robots(operator, four_robots):
    """Return a list on the screen with four robots."""
    widget = RobotList()
    widget.resize(560, 330)
    widget.show_robots(four_robots.robots)
    return operator.show(widget)


@pytest.mark.parametrize('view, sign, word, age, second', [
    (LIVE, theme.DISC, 'live', '12 ms', '0.31 m/s'),
    (replace(LIVE, link=views.WAITING), theme.RING, 'waiting', '', 'waiting'),
    (replace(LIVE, link=views.SILENT, age_s=3.2, note='nothing for 3.2 s'), theme.TRIANGLE,
     'silent', '', 'nothing for 3.2 s'),
    (replace(LIVE, link=views.GONE, note='master lost it'), theme.CROSSED_SQUARE, 'gone', '',
     'master lost it'),
    (replace(LIVE, proof=ProofView(views.PROOF_STOPPED, 'stopped in 180 ms')), theme.DISC, 'live',
     '12 ms', 'stopped in 180 ms'),
    (replace(LIVE, link=views.GONE, proof=ProofView(
        views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED: gone')), theme.CROSSED_SQUARE, 'gone', '',
     'NOT CONFIRMED: gone'),
])
def test_a_row_says_state_by_shape_and_word(operator, view, sign, word, age, second):
    robots = RobotList()
    robots.show_robots([view])
    operator.show(robots)
    row = robots.row('bot1')
    assert row.sign.sign[0] == sign
    assert (row.link.text(), row.age.text()) == (word, age)
    visible = row.trouble if row.trouble.isVisible() else row.linear
    assert visible.text() == second
    assert row.trouble.isVisible() != row.turn.isVisible()


@pytest.mark.parametrize('changes', [
    {'slow': True, 'note': 'x' * 90}, {'link': views.SILENT, 'note': 'x' * 90},
    {'proof': ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED: ' + 'x' * 90)}])
def test_a_warning_never_replaces_the_speed_and_what_is_old_is_dimmed(robots, operator, changes):
    robots.resize(430, 300)
    robots.show_robots([replace(LIVE, **changes)])
    operator.settle()
    row = robots.row('bot1')
    for line, text in ((row.linear, '0.31 m/s'), (row.battery, '82 %')):
        assert line.isVisible() and line.shown_text() == text
        assert not line.visibleRegion().isEmpty()
        assert line.tone == (theme.TEXT if row.link.text() == 'live' else theme.MUTED)
    assert row.trouble.isVisible() and row.trouble.width() > 60


def test_a_row_says_whether_it_is_driven(robots):
    for changes, word in (({}, ''), ({'driven': True}, DRIVING), ({'moving': True}, MOVING),
                          ({'driven': True, 'moving': True}, DRIVING)):
        robots.show_robots([replace(LIVE, **changes)])
        assert robots.row('bot1').pill.word == word


def test_numbers_wait_for_their_turn_but_states_do_not(robots):
    faster = replace(LIVE, linear_mps=0.5, age_s=0.099, driven=True)
    robots.show_robots([faster], numbers=False)
    row = robots.row('bot1')
    assert (row.linear.text(), row.age.text()) == ('0.31 m/s', '12 ms')
    robots.show_robots([faster], numbers=True)
    assert (row.linear.text(), row.age.text()) == ('0.50 m/s', '99 ms')
    robots.show_robots([replace(faster, link=views.SILENT, age_s=1.1)], numbers=False)
    assert (row.link.text(), row.age.text()) == ('silent', '1.1 s')
    proof = ProofView(views.PROOF_STOPPED, 'stopped in 180 ms')
    robots.show_robots([LIVE], numbers=False)
    robots.show_robots([replace(LIVE, linear_mps=0.0, proof=proof)], numbers=False)
    assert row.linear.text() == '0.00 m/s'


def test_a_click_asks_for_the_whole_list_in_order(robots, operator, heard, four_robots):
    asked = heard(robots.selection_requested)
    operator.click(robots.row('bot4').box)
    operator.click(robots.row('bot2').box)
    robots.show_robots(four_robots.robots)
    assert robots.checked() == ['bot1', 'bot2', 'bot4'], 'no flicker while the answer is coming'
    operator.click(robots.row('bot1').box)
    assert asked == [['bot1', 'bot4'], ['bot1', 'bot2', 'bot4'], ['bot2', 'bot4']]


def test_a_selection_that_is_not_granted_goes_back(robots, operator):
    operator.click(robots.row('bot4').box)
    assert robots.checked() == ['bot1', 'bot4']
    operator.wait_until(lambda: robots.checked() == ['bot1'])


@pytest.mark.parametrize('action, asked', [
    (lambda robots: robots.select_all(), [['bot1', 'bot2', 'bot3', 'bot4']]),
    (lambda robots: robots.select_none(), [[]]),
    (lambda robots: robots.toggle(1), [[]]),
    (lambda robots: robots.toggle(3), [['bot1', 'bot3']]),
    (lambda robots: robots.toggle(5), []),
    (lambda robots: (robots.toggle_all(), robots.toggle_all()),
     [['bot1', 'bot2', 'bot3', 'bot4'], []]),
])
def test_selecting(robots, heard, action, asked):
    said = heard(robots.selection_requested)
    action(robots)
    assert said == asked


def test_a_low_battery_has_a_colour_and_a_name(operator):
    line = BatteryLine()
    operator.show(line)
    for charge, level, name in ((0.31, 'fine', 'battery 31 %'), (0.29, 'low', 'battery 29 %, low'),
                                (0.31, 'low', 'battery 31 %, low'), (0.5, 'fine', 'battery 50 %'),
                                (0.14, 'flat', 'battery 14 %, flat'), (None, 'flat', '')):
        line.show_charge(charge)
        assert (line.level, line.accessibleName()) == (level, name)
        assert line.font().bold() == (level == 'flat')


def test_a_second_click_or_escape_takes_the_highlight_away(robots, operator, heard):
    activated, cleared = heard(robots.activated), heard(robots.cleared)
    for away in (lambda: operator.click(robots.row('bot3').title),
                 lambda: operator.hit(robots, Qt.Key_Escape)):
        operator.click(robots.row('bot3').title)
        assert robots.current == 'bot3'
        away()
        assert robots.current is None
    assert activated == ['bot3', 'bot3'] and cleared == [(), ()]
    operator.hit(robots, Qt.Key_Escape)
    assert len(cleared) == 2


def test_a_double_click_is_for_the_row_of_its_first_press_though_a_row_above_has_gone(
        robots, operator, heard, four_robots):
    opened = heard(robots.open_requested)
    place = robots.row('bot2').mapToGlobal(QPoint(10, 10))
    QTest.mousePress(robots.row('bot2'), Qt.LeftButton, Qt.NoModifier, QPoint(10, 10))
    robots.show_robots(four_robots.robots[1:])
    operator.settle()
    under = robots.row('bot3')
    assert under.rect().contains(under.mapFromGlobal(place))
    QTest.mouseDClick(under, Qt.LeftButton, Qt.NoModifier, under.mapFromGlobal(place))
    assert opened == ['bot2']


@pytest.mark.parametrize('keys, current', [
    ([Qt.Key_Down] * 9, 'bot4'), ([Qt.Key_Down, Qt.Key_Down, Qt.Key_Up], 'bot1')])
def test_the_list_by_keyboard(robots, operator, heard, keys, current):
    opened = heard(robots.open_requested)
    for key in keys:
        operator.hit(robots, key)
    operator.hit(robots, Qt.Key_Return)
    assert robots.current == current and opened == [current]


@pytest.fixture
def hundred(operator):
    """Return a list on the screen with a hundred robots, and those."""
    many = tuple(replace(LIVE, name='bot{}'.format(number), number=number)
                 for number in range(1, 101))
    widget = RobotList()
    widget.resize(560, 330)
    widget.show_robots(many)
    return operator.show(widget), many


def made(robots):
    """Return how many rows there are."""
    return len(robots.findChildren(RobotRow))


def in_sight(robots, name):
    """Return whether the whole row of a robot can be seen."""
    row = robots.row(name)
    top = row.mapTo(robots.viewport(), row.rect().topLeft()).y()
    return 0 <= top and top + row.height() <= robots.viewport().height()


def test_a_hundred_robots_cost_the_rows_that_are_seen(hundred, operator):
    robots, many = hundred
    operator.settle()
    assert made(robots) < 24
    robots.show_robots([replace(robot, linear_mps=0.62) for robot in many])
    robots.verticalScrollBar().setValue(robots.verticalScrollBar().maximum())
    operator.settle()
    assert in_sight(robots, 'bot100') and robots.row('bot100').number.text() == '100'
    assert robots.row('bot100').linear.text() == '0.62 m/s' and made(robots) < 48
    robots.show_robots([replace(robot, linear_mps=0.4) for robot in many])
    robots.verticalScrollBar().setValue(0)
    assert robots.row('bot2').linear.text() == '0.40 m/s', 'a row that comes back is up to date'
    robots.show_robots(many[:3])
    operator.settle()
    assert made_now(robots) == 3 and robots.verticalScrollBar().maximum() == 0


def made_now(robots):
    """Return how many rows can be reached; one that was dropped waits for its end hidden."""
    return sum(not row.isHidden() for row in robots.findChildren(RobotRow))


def test_control_of_a_robot_is_asked_for_in_its_row(operator):
    robots = RobotList()
    robots.show_robots([LIVE])
    operator.show(robots)
    row = robots.row('bot1')
    assert not row.ask_button.isVisible()
    asked = []
    robots.ask_requested.connect(asked.append)
    robots.show_robots([replace(LIVE, note='lab', ask=ASK_FOR)])
    assert row.trouble.text() == 'lab' and row.ask_button.text() == ASK_FOR
    operator.click(row.ask_button)
    robots.show_robots([replace(LIVE, note='lab', ask=TAKE_IT)])
    assert row.ask_button.text() == TAKE_IT and 'bot1' in row.ask_button.accessibleName()
    operator.click(row.ask_button)
    assert asked == ['bot1', 'bot1']
    robots.show_robots([LIVE])
    assert not row.ask_button.isVisible()
