# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map on the screen: M, the switch, what is kept; and what its gestures ask of whom."""
from dataclasses import replace
import json
import math
from types import SimpleNamespace

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtGui import QContextMenuEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication
from support.maps import choose, click, drag, open_menu, pixel

from mhri.base import views
from mhri.base.geometry import Pose
from mhri.base.gui import theme
from mhri.map import gesture
from mhri.map.presenters.map_presenter import MapPresenter
from mhri.map.scene import PlacesView, Placing
from mhri.screen.gui.stage import MAP_AUTO, MAP_BESIDE, MAP_CLOSED, MAP_LARGE
from mhri.screen.gui.windows import TurtleBotWindow
from mhri.screen.presenters.draw_guard import DrawGuard
from mhri.screen.saved_state import usable_state

FEEDS = SimpleNamespace(robot_type=SimpleNamespace(radius_m=0.2), request=lambda keys, user: None,
                        get=lambda key: None)


class Operator:
    """Stands in for the ROS side: remembers what it is to do."""

    def __init__(self):
        self.jobs = []

    def do(self, job, *args):
        """Note a job."""
        self.jobs.append(job.__name__)

    @staticmethod
    def feeds(name):
        """Return what knows the type of a robot."""
        return FEEDS


class Places:
    """Stands in for the client of the task service: two robots are placed, answers are at once."""

    def __init__(self):
        self.now = PlacesView('map', {
            'bot1': Placing(Pose(0.0, 0.0, 0.0), 'placed by hand'),
            'bot2': Placing(Pose(0.0, 2.0, 0.0), 'placed by tf', 0.1),
            'bot3': Placing(None, 'not placed: place it by hand')}, answers=True)
        self.asked = []
        self.answer = (True, 'it is so')
        self.tasks = ()

    def view(self):
        """Return where robots are."""
        return self.now

    def runs(self):
        """Return the tasks that are under way."""
        return self.tasks

    def __getattr__(self, name):
        if name not in ('set_place', 'fit_place', 'set_fence', 'set_mark'):
            raise AttributeError(name)

        def ask(*words):
            self.asked.append((name, *words[:-1]))
            words[-1](*self.answer)
        return ask

    def close(self, forget=False):
        """End."""


class Tasks(list):
    """Stands in for what starts tasks."""

    def offer_places(self, keys, pick):
        """Keep what lets the operator draw the places of a task."""
        self.keys, self.pick = keys, pick

    def start_task(self, key, robots, parameters):
        """Note a task."""
        self.append((key, list(robots), parameters))


class Session:
    """A screen of three robots with a map."""

    def __init__(self, operator, panel, ui_dir):
        self.operator, self.panel = operator, panel
        self.backend, self.places, self.tasks = Operator(), Places(), Tasks()
        panel.drawer_button.setChecked(False)
        self.robots = [views.RobotView(
            'bot{}'.format(number), 'TurtleBot2', link=views.LIVE, age_s=0.01, x_m=1.0, y_m=0.0,
            heading_rad=0.0, number=number) for number in (1, 2, 3)]
        tiles = {robot.name: TurtleBotWindow(ui_dir, robot.name, '') for robot in self.robots}
        for tile in tiles.values():
            tile.setParent(panel.stage)
        panel.stage.show_tiles(tiles)
        self.tiles = tiles
        self.map = MapPresenter(self.backend, panel, self.tasks, DrawGuard, self.places)
        self.select('bot1')

    def select(self, *names):
        """Show the robots with these selected."""
        robots = tuple(views.RobotView(**{**vars(robot), 'selected': robot.name in names})
                       for robot in self.robots)
        view = views.ScreenView(ros=views.ROS_CONNECTED, robots=robots, status='ready')
        self.panel.show_view(view)
        self.map.show_view(view)
        self.draw()

    def draw(self):
        """Draw the map."""
        self.operator.settle()
        self.map.draw()

    @property
    def pane(self):
        """Return the map."""
        return self.map.pane

    def choose_tool(self, tool):
        """Take a tool by its button."""
        self.operator.click(self.pane.tools[tool])


@pytest.fixture
def session(operator, panel, ui_dir):
    """Return a screen with a map; it is closed afterwards."""
    panel.resize(1500, 1000)
    made = Session(operator, panel, ui_dir)
    yield made
    made.map.close()


def press_m(session):
    session.operator.hit(session.panel.stage, Qt.Key_M)
    session.draw()


def test_m_swaps_map_and_pictures(session):
    stage, pane = session.panel.stage, session.pane
    stage.show_map(MAP_BESIDE)
    picture, other = session.tiles['bot1'], session.tiles['bot2']
    place, small = other.geometry(), pane.geometry()
    press_m(session)
    assert stage.map_state == MAP_LARGE and pane.large and picture.isVisible()
    assert pane.width() * pane.height() > 2 * picture.width() * picture.height()
    # It is where the map was, else inset into the map, and driven by, however small.
    assert picture.geometry() == small or pane.geometry().contains(picture.geometry())
    assert other.geometry() == place
    assert picture.full_rate and not other.full_rate
    press_m(session)
    assert stage.map_state == MAP_BESIDE and pane.isVisible() and not pane.large
    assert other.geometry() == place
    assert picture.width() * picture.height() > 2 * pane.width() * pane.height()
    press_m(session)
    assert pane.large


def test_on_a_wide_screen_it_is_there_from_the_start(session):
    session.panel.resize(1600, 900)
    session.operator.settle()
    assert session.pane.isVisible() and not session.pane.large
    assert session.panel.arrangement.looks.map_box.isChecked()
    session.map.restore_settings({'shown': MAP_CLOSED})
    assert not session.pane.isVisible()


def test_the_switch_opens_and_closes_it(session):
    box, stage = session.panel.arrangement.looks.map_box, session.panel.stage
    stage.show_map(MAP_CLOSED)
    assert not box.isChecked()
    box.click()
    assert stage.map_state == MAP_BESIDE and session.pane.isVisible() and box.isChecked()
    press_m(session)
    assert box.isChecked()
    box.click()
    assert stage.map_state == MAP_CLOSED and not session.pane.isVisible() and not box.isChecked()


def test_keys_zoom_the_map_and_drive_as_before(session, heard):
    press_m(session)
    before = session.pane.view.canvas.px_per_m
    session.operator.hit(session.panel.stage, Qt.Key_Plus)
    session.operator.hit(session.panel.stage, Qt.Key_Equal)
    assert session.pane.view.canvas.px_per_m > before
    session.operator.hit(session.panel.stage, Qt.Key_Minus)
    moved = heard(session.panel.stick_moved)
    session.choose_tool(gesture.ROUTE)
    session.operator.press(session.pane.view, Qt.Key_Up)
    session.operator.release(session.pane.view, Qt.Key_Up)
    assert moved == [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    # The keyboard goes back to the pictures.
    session.operator.hit(session.pane.view, Qt.Key_Escape)
    session.operator.wait_until(session.panel.stage.hasFocus)


def test_what_nobody_sees_costs_nothing(session):
    assert session.backend.jobs == []
    press_m(session)
    assert session.backend.jobs == ['_open']
    session.panel.arrangement.looks.map_box.click()
    session.draw()
    assert session.backend.jobs == ['_open', 'close']
    painted = session.pane.view.ground.painted
    session.draw()
    assert session.backend.jobs == ['_open', 'close']
    assert session.pane.view.ground.painted == painted


def test_it_is_kept(session):
    press_m(session)
    session.operator.click(session.pane.trails_button)
    kept = json.loads(json.dumps(session.map.save_settings()))
    state, problems = usable_state({'map': kept})
    assert state == {'map': kept} and problems == ()
    session.panel.stage.show_map(MAP_CLOSED)
    session.operator.click(session.pane.trails_button)
    session.map.restore_settings(kept)
    assert session.panel.stage.map_state == MAP_LARGE and session.pane.view.by_link
    # What was "closed" before the map was there by default is no choice.
    for kept in ({}, {'shown': 'closed'}):
        session.map.restore_settings(kept)
        assert session.panel.stage.map_state == MAP_AUTO


def test_robots_are_where_they_are_placed(session):
    press_m(session)
    robots = {robot.name: robot for robot in session.pane.view.scene.robots}
    assert robots['bot1'].pose == Pose(1.0, 0.0, 0.0)
    assert robots['bot2'].pose == Pose(1.0, 2.0, 0.0)
    assert robots['bot3'].pose is None and session.pane.strip.isVisible()


def test_a_goal_starts_a_task(session):
    press_m(session)
    session.choose_tool(gesture.GOTO)
    drag(session.pane, (2.0, 1.0), (2.0, 2.0))
    (key, robots, parameters), = session.tasks
    assert (key, robots) == ('goto', ['bot1'])
    assert parameters['x'] == pytest.approx(2.0, abs=0.02)
    assert parameters['heading'] == pytest.approx(math.pi / 2.0, abs=0.03)
    assert session.pane.line.text().startswith('bot1: ')


def test_the_robot_clicked_goes_and_not_the_one_that_is_driven(session):
    press_m(session)
    session.select('bot1')
    click(session.pane, 1.0, 2.0)
    session.draw()
    session.choose_tool(gesture.GOTO)
    click(session.pane, 4.0, 1.0)
    assert [(key, robots) for key, robots, _ in session.tasks] == [('goto', ['bot2'])]


def test_route_leader_and_end(session):
    press_m(session)
    session.choose_tool(gesture.ROUTE)
    for x_m in (2.0, 3.0):
        click(session.pane, x_m, 1.0)
    session.operator.hit(session.pane.view, Qt.Key_Return)
    session.choose_tool(gesture.LEADER)
    click(session.pane, 1.0, 2.0)
    (patrol, _, route), follow = session.tasks
    assert patrol == 'patrol' and len(route['route']) == 2
    assert follow == ('follow', ['bot1'], {'leader': 'bot2'})


@pytest.mark.parametrize('done, tone', [(True, theme.TEXT), (False, theme.ATTENTION)])
def test_each_act_is_answered(session, done, tone):
    press_m(session)
    session.places.answer = done, 'an answer'
    for signal, words, asked in (
            (session.pane.robot_placed, ('bot3', Pose(1.0, 1.0, 0.5)), 'set_place'),
            (session.pane.robot_placed, ('bot3', None), 'set_place'),
            (session.pane.fit_requested, ('bot1', 'bot2'), 'fit_place'),
            (session.pane.mark_set, ('dock', Pose(0.0, 0.0, 0.0)), 'set_mark'),
            (session.pane.fence_drawn, ([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)],), 'set_fence')):
        signal.emit(*words)
        assert session.places.asked[-1] == (asked, *words)
        session.draw()
        assert session.pane.line.text().endswith('an answer')
        assert (session.pane.line.tone == theme.ATTENTION) == (tone == theme.ATTENTION)


# The menu of a robot, and a lost robot.

def texts(session, name):
    """Return the texts of a robot's menu."""
    return [row[0] for row in session.panel.robot_menu.rows(name) if row]


def menu_of(session, widget):
    """Click with the right button; return {text: action} of the menu that opens."""
    place = QPoint(2, 2)
    QApplication.sendEvent(widget, QContextMenuEvent(
        QContextMenuEvent.Mouse, place, widget.mapToGlobal(place)))
    return open_menu(session.operator)


def test_row_tile_and_mark_have_the_same_menu(session):
    press_m(session)
    tile, row = session.tiles['bot2'], session.panel.robot_list.row('bot2')
    tile.menu_requested.connect(session.panel.robot_menu.open)
    wanted = texts(session, 'bot2')
    for widget in (tile, row):
        assert list(menu_of(session, widget)) == wanted
        QApplication.activePopupWidget().close()
    QTest.mousePress(session.pane.view, Qt.RightButton, Qt.NoModifier,
                     pixel(session.pane, 1.0, 2.0))
    assert list(open_menu(session.operator)) == wanted
    QApplication.activePopupWidget().close()
    assert [text.split()[0] for text in wanted[:4]] == ['Send', 'Drive', 'Stop', 'bot2']
    # The robot that was clicked comes first; every row names a robot.
    assert wanted[0] == 'Send bot2 (clicked)' and 'Send bot1 (driven)' in wanted[4:]
    assert all('bot' in text for text in wanted)


@pytest.mark.parametrize('before', [MAP_AUTO, MAP_CLOSED, MAP_BESIDE])
def test_a_robot_sent_by_its_menu_goes_and_the_driven_one_is_in_view_again(session, before):
    stage = session.panel.stage
    stage.show_map(before)
    session.draw()
    rows = session.panel.robot_list
    actions = menu_of(session, rows.row('bot2'))
    choose(session.operator, actions['Send bot2 (clicked)'])
    session.draw()
    assert stage.map_state == MAP_LARGE and session.pane.view.gesture.tool == gesture.GOTO
    assert 'bot2' in session.pane.line.text() and 'bot1' not in session.pane.line.text()
    click(session.pane, 2.0, 1.0)
    assert [(key, robots) for key, robots, _ in session.tasks] == [('goto', ['bot2'])]
    assert stage.map_state == before
    # Escape ends it as well, and sends nobody.
    choose(session.operator, menu_of(session, rows.row('bot2'))['Send bot1 (driven)'])
    session.draw()
    assert 'bot1' in session.pane.line.text()
    session.operator.hit(session.pane.view, Qt.Key_Escape)
    assert stage.map_state == before and len(session.tasks) == 1


def test_a_task_is_picked_then_its_place_and_keeps_what_was_filled_in(session):
    assert 'goto' in session.tasks.keys
    session.tasks.pick('goto', ['bot2'], {'speed': 0.1, 'x': 9.0})
    session.draw()
    click(session.pane, 2.0, 1.0)
    (key, robots, parameters), = session.tasks
    assert (key, robots, parameters['speed']) == ('goto', ['bot2'], 0.1)
    assert (parameters['x'], parameters['y']) == pytest.approx((2.0, 1.0), abs=0.1)
    # What was filled in is for that task alone.
    session.tasks.pick('goto', ['bot2'], {'speed': 0.1})
    session.draw()
    session.operator.hit(session.pane.view, Qt.Key_Escape)
    choose(session.operator, menu_of(session, session.panel.robot_list.row('bot2'))[
        'Send bot2 (clicked)'])
    session.draw()
    click(session.pane, 2.0, 1.0)
    assert len(session.tasks) == 2 and 'speed' not in session.tasks[1][2]


def test_each_row_acts_on_the_robot_that_was_clicked(session, heard):
    driven, stopped = heard(session.panel.drive_requested), heard(
        session.panel.stop_robot_requested)
    rows = dict(filter(None, session.panel.robot_menu.rows('bot2')))
    rows['Drive bot2']()
    rows['Stop bot2']()
    rows['bot2 follows bot1 (driven)']()
    rows['bot1 (driven) after bot2']()
    fits = heard(session.pane.fit_requested)
    press_m(session)
    dict(filter(None, session.panel.robot_menu.rows('bot2')))['Fit bot2 ...']()
    choose(session.operator, QApplication.activePopupWidget().actions()[1])
    assert fits == [('bot2', 'bot1')]
    press_m(session)
    assert driven == stopped == ['bot2']
    assert session.tasks == [('follow', ['bot2'], {'leader': 'bot1'}),
                             ('follow', ['bot1'], {'leader': 'bot2'})]
    session.select()
    rows = dict(filter(None, session.panel.robot_menu.rows('bot2')))
    rows['bot2 follows ...']()
    session.draw()
    click(session.pane, 1.0, 0.0)
    assert session.tasks[2] == ('follow', ['bot2'], {'leader': 'bot1'})
    session.select('bot2')
    assert dict(filter(None, session.panel.robot_menu.rows('bot2')))['Drive bot2 (driven)'] is None
    session.panel.robot_menu.disable()
    assert not any(dict(filter(None, session.panel.robot_menu.rows('bot2'))).values())


def lose(session, name, link=views.GONE, age_s=9.0):
    """Let a robot be lost, with the source of its place."""
    session.robots = [replace(robot, link=link, age_s=age_s) if robot.name == name else robot
                      for robot in session.robots]
    places = session.places.now
    session.places.now = replace(places, robots={**places.robots, name: Placing(None, 'no place')})
    session.select('bot1')


def test_a_lost_robot_stays_on_the_map_also_if_it_was_hidden(session):
    session.draw()
    lose(session, 'bot2')
    press_m(session)
    robot = session.pane.view.scene.robot('bot2')
    assert robot.pose == Pose(1.0, 2.0, 0.0) and robot.lost and robot.old and robot.trail
    rows = dict(filter(None, session.panel.robot_menu.rows('bot2')))
    assert [text.split()[0] for text in rows if 'bot1' not in text] == [
        'Drive', 'Stop', 'Take', 'Remove']
    session.pane.goal_drawn.emit(['bot2'], Pose(2.0, 2.0, 0.0), False)
    assert session.tasks == [] and session.pane.line.tone == theme.ATTENTION
    # The others go all the same.
    session.pane.goal_drawn.emit(['bot1', 'bot2'], Pose(2.0, 2.0, 0.0), False)
    assert [robots for _, robots, _ in session.tasks] == [['bot1']]
    assert 'bot2' in session.pane.line.text() and session.pane.line.tone == theme.ATTENTION
    rows['Take bot2 off the map']()
    session.draw()
    assert session.pane.view.scene.robot('bot2').pose is None


def test_a_lost_robot_removed_from_the_list_leaves_the_map_for_good(session):
    session.draw()
    lose(session, 'bot2')
    everybody, session.robots = session.robots, [
        robot for robot in session.robots if robot.name != 'bot2']
    press_m(session)
    session.select()
    assert session.pane.view.scene.robot('bot2') is None
    session.robots = everybody
    session.select()
    assert session.pane.view.scene.robot('bot2').pose is None


def test_a_lost_robot_is_removed_by_its_menu(session, heard):
    removed = heard(session.panel.remove_steps.remove_requested)
    lose(session, 'bot2')
    dict(filter(None, session.panel.robot_menu.rows('bot2')))['Remove bot2 from the list']()
    assert removed == ['bot2']
    lose(session, 'bot1')
    assert dict(filter(None, session.panel.robot_menu.rows('bot1')))[
        'Remove bot1 from the list'] is None


def press(_, widget):
    """Press a widget, and hold on."""
    QTest.mousePress(widget, Qt.LeftButton, Qt.NoModifier, QPoint(3, 3))


def press_menu_key(session, _):
    """Press the menu key while bot2 is looked at."""
    session.panel.look_at('bot2')
    stage = session.panel.stage
    QApplication.sendEvent(stage, QContextMenuEvent(
        QContextMenuEvent.Keyboard, QPoint(9, 9), stage.mapToGlobal(QPoint(9, 9))))


# A window is inactive for a moment as its menu closes, which ends the next press: one menu each.
@pytest.mark.parametrize('place, act', [('row', press), ('tile', press), ('', press_menu_key)])
def test_a_long_press_and_the_menu_key_open_it_too(session, place, act):
    tile = session.tiles['bot2']
    tile.menu_requested.connect(session.panel.robot_menu.open)
    act(session, session.panel.robot_list.row('bot2') if place == 'row' else tile)
    session.operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
    assert QApplication.activePopupWidget().actions()[0].text().startswith('Send bot2')
    QApplication.activePopupWidget().close()
