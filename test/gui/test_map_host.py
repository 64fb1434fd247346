# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map on the screen: M, the switch, what is kept; and what its gestures ask of whom."""
import json
import math
from types import SimpleNamespace

import pytest
from python_qt_binding.QtCore import Qt
from support.maps import click, drag, pixel

from mhri.base import views
from mhri.base.gui import theme
from mhri.base.mocap import Pose
from mhri.base.tf_tree import OdometryFrames
from mhri.map import gesture
from mhri.map.scene import PlacesView, Placing, UnderWay
from mhri.screen.gui.stage import MAP_BESIDE, MAP_CLOSED, MAP_LARGE
from mhri.screen.gui.windows import TurtleBotWindow
from mhri.screen.presenters.map_host import MapHost
from mhri.screen.saved_state import usable_state

KIND = SimpleNamespace(radius_m=0.2, scan=())


class Operator:
    """Stands in for the ROS side: remembers what it is to do."""

    def __init__(self):
        self.jobs = []

    def do(self, job, *args):
        """Take note of a job."""
        self.jobs.append(job.__name__)

    @staticmethod
    def feeds(name):
        """Return what knows the type of a robot."""
        return SimpleNamespace(robot_type=KIND, frames=OdometryFrames())


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

    def start(self, key, robots, parameters):
        """Take note of a task."""
        self.append((key, list(robots), parameters))

    def stop(self, robots):
        """Take note of its end."""
        self.append(('stop', list(robots)))


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
        self.map = MapHost(self.backend, panel, self.tasks, self.places)
        self.select('bot1')

    def select(self, *names):
        """Show the robots with these selected."""
        robots = tuple(views.RobotView(**{**vars(robot), 'selected': robot.name in names})
                       for robot in self.robots)
        view = views.PanelView(ros=views.ROS_CONNECTED, robots=robots, status='ready')
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

    def take(self, tool):
        """Take a tool by its button."""
        self.operator.click(self.pane.tools[tool])


@pytest.fixture
def font(application, request):
    """Have letters so many times as large."""
    before = application.font()
    application.setFont(theme.larger(before, getattr(request, 'param', 1.0)))
    yield
    application.setFont(before)


@pytest.fixture
def session(operator, font, panel, ui_dir):
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
    assert stage.map_state == MAP_CLOSED and not pane.isVisible()
    press_m(session)
    picture = session.tiles['bot1']
    assert stage.map_state == MAP_LARGE and pane.large and picture.isVisible()
    assert pane.width() * pane.height() > 2 * picture.width() * picture.height()
    # It is driven by, however small.
    assert picture.full_rate and not session.tiles['bot2'].full_rate
    press_m(session)
    assert stage.map_state == MAP_BESIDE and pane.isVisible() and not pane.large
    assert picture.width() * picture.height() > 2 * pane.width() * pane.height()
    press_m(session)
    assert pane.large


@pytest.mark.parametrize('size', [(1024, 600), (1280, 720)])
def test_on_a_small_screen_it_is_behind_m(session, size):
    session.panel.resize(*size)
    session.panel.drawer_button.setChecked(True)
    session.operator.settle()
    press_m(session)
    assert session.pane.isVisible() and session.pane.large
    press_m(session)
    assert not session.pane.isVisible()
    area = session.tiles['bot1']
    assert area.isVisible() and area.header.large


def test_the_switch_opens_and_closes_it(session):
    box, stage = session.panel.arrangement.looks.map_box, session.panel.stage
    assert not box.isChecked()
    box.click()
    assert stage.map_state == MAP_BESIDE and session.pane.isVisible() and box.isChecked()
    press_m(session)
    assert box.isChecked()
    box.click()
    assert stage.map_state == MAP_CLOSED and not session.pane.isVisible() and not box.isChecked()


def test_nothing_lies_over_anything(session):
    for size in ((1024, 600), (1500, 1000), (1920, 1080)):
        session.panel.resize(*size)
        for _ in range(3):
            press_m(session)
            parts = [part for part in (session.pane, *session.tiles.values()) if part.isVisible()]
            for index, part in enumerate(parts):
                assert session.panel.stage.rect().contains(part.geometry())
                for other in parts[:index]:
                    assert not part.geometry().intersects(other.geometry())


@pytest.mark.parametrize('size, font', [
    ((1024, 600), 1.0), ((1280, 720), 1.0), ((1920, 1080), 1.0), ((1024, 600), 2.0),
    ((1280, 720), 2.0)], indirect=['font'])
def test_its_buttons_fit(session, size):
    session.panel.resize(*size)
    press_m(session)
    pane = session.pane
    canvas = pane.view.geometry()
    session.take(gesture.ROUTE)
    session.draw()
    assert (session.panel.width(), session.panel.height()) == size
    assert pane.view.geometry() == canvas, 'the map has moved beneath the pointer'
    areas = {}
    for button in (*pane.tools.values(), pane.fit_button, pane.done_button, pane.cancel_button,
                   pane.closer, pane.wider, pane.all_button, pane.follow_button, pane.turn_button,
                   pane.trails_button, pane.strip):
        area = button.rect().translated(button.mapTo(pane, button.rect().topLeft()))
        assert button.isVisible() and pane.rect().contains(area), button.objectName()
        assert button.visibleRegion().boundingRect() == button.rect(), button.objectName()
        assert min(button.width(), button.height()) >= theme.SMALLEST_TOUCH_PX
        for name, other in areas.items():
            assert not area.intersects(other), (button.objectName(), name)
        areas[button.objectName()] = area


def test_keys_zoom_the_map_and_drive_as_before(session, heard):
    press_m(session)
    before = session.pane.view.canvas.px_per_m
    session.operator.hit(session.panel.stage, Qt.Key_Plus)
    session.operator.hit(session.panel.stage, Qt.Key_Equal)
    assert session.pane.view.canvas.px_per_m > before
    session.operator.hit(session.panel.stage, Qt.Key_Minus)
    moved = heard(session.panel.stick_moved)
    session.take(gesture.ROUTE)
    session.operator.press(session.pane.view, Qt.Key_Up)
    session.operator.release(session.pane.view, Qt.Key_Up)
    assert moved == [(1.0, 0.0), (0.0, 0.0)]
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
    painted = session.pane.view.grounds_painted
    session.draw()
    assert session.backend.jobs == ['_open', 'close']
    assert session.pane.view.grounds_painted == painted


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
    session.map.restore_settings({})
    assert session.panel.stage.map_state == MAP_CLOSED


@pytest.mark.parametrize('wrong', [5, {'shown': 7}, {'follow': 'x'}, {'turn': None}, []])
def test_settings_that_cannot_be_are_left_out(session, wrong):
    state, problems = usable_state({'map': wrong})
    assert problems or wrong == {}
    session.map.restore_settings(state.get('map', {}))


def test_robots_are_where_they_are_placed(session):
    press_m(session)
    robots = {robot.name: robot for robot in session.pane.view.scene.robots}
    assert robots['bot1'].pose == Pose(1.0, 0.0, 0.0)
    assert robots['bot2'].pose == Pose(1.0, 2.0, 0.0)
    assert robots['bot3'].pose is None and session.pane.strip.isVisible()


def test_a_goal_starts_a_task(session):
    press_m(session)
    session.take(gesture.GOTO)
    drag(session.pane, (2.0, 1.0), (2.0, 2.0))
    (key, robots, parameters), = session.tasks
    assert (key, robots) == ('goto', ['bot1'])
    assert parameters['x'] == pytest.approx(2.0, abs=0.02)
    assert parameters['heading'] == pytest.approx(math.pi / 2.0, abs=0.03)
    assert 'bot1: asked to go to' in session.pane.line.text()


def test_several_are_spread_out(session):
    press_m(session)
    session.select('bot1', 'bot2')
    session.take(gesture.GOTO)
    click(session.pane, 4.0, 1.0)
    first, second = session.tasks
    assert [first[1], second[1]] == [['bot1'], ['bot2']] and 'heading' not in first[2]
    apart = math.hypot(first[2]['x'] - second[2]['x'], first[2]['y'] - second[2]['y'])
    assert apart == pytest.approx(0.5, abs=0.01)
    assert 'bot1: ' in session.pane.line.text() and 'bot2: ' in session.pane.line.text()


def test_the_robot_clicked_goes_and_not_the_one_that_is_driven(session):
    press_m(session)
    session.select('bot1')
    click(session.pane, 1.0, 2.0)
    session.draw()
    session.take(gesture.GOTO)
    click(session.pane, 4.0, 1.0)
    assert [(key, robots) for key, robots, _ in session.tasks] == [('goto', ['bot2'])]


def test_news_of_tasks_are_told(session):
    session.map.hear('task.begun', 'go to started', 'bot1')
    assert session.pane.line.text() == 'bot1: go to started'
    session.map.hear('task.said', 'corner 1 reached', 'bot1')
    assert session.pane.line.text() == 'bot1: go to started'
    session.map.hear('task.refused', 'go to not started: it is lost', '')
    assert session.pane.line.tone == theme.ATTENTION


def test_route_leader_and_end(session):
    press_m(session)
    session.take(gesture.ROUTE)
    for x_m in (2.0, 3.0):
        click(session.pane, x_m, 1.0)
    session.operator.hit(session.pane.view, Qt.Key_Return)
    session.take(gesture.LEADER)
    click(session.pane, 1.0, 2.0)
    session.pane.end_requested.emit(['bot1'])
    (patrol, _, route), follow, end = session.tasks
    assert patrol == 'patrol' and len(route['route']) == 2
    assert follow == ('follow', ['bot1'], {'leader': 'bot2'})
    assert end == ('stop', ['bot1'])


@pytest.mark.parametrize('answer, said', [
    ((True, 'it is so'), 'it is so'), ((False, 'a reason'), 'refused: a reason')])
def test_each_act_is_answered(session, answer, said):
    press_m(session)
    session.places.answer = answer
    for signal, words, asked in (
            (session.pane.robot_placed, ('bot3', Pose(1.0, 1.0, 0.5)), 'set_place'),
            (session.pane.robot_placed, ('bot3', None), 'set_place'),
            (session.pane.fit_requested, ('bot1', 'bot2'), 'fit_place'),
            (session.pane.mark_set, ('dock', Pose(0.0, 0.0, 0.0)), 'set_mark'),
            (session.pane.fence_drawn, ([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)],), 'set_fence')):
        signal.emit(*words)
        assert session.places.asked[-1] == (asked, *words)
        assert session.pane.line.text().endswith('asked')
        session.draw()
        assert session.pane.line.text().endswith(said)


def test_goals_of_tasks_are_shown(session):
    session.places.tasks = (UnderWay('goto', '{x: 3.0, y: 0.5}', ('bot1',)),)
    press_m(session)
    assert session.pane.view.scene.goals[0].route == ((3.0, 0.5),)


def test_without_anybody_who_starts_tasks_it_says_so(operator, panel, ui_dir):
    panel.resize(1500, 1000)
    session = Session(operator, panel, ui_dir)
    lonely = MapHost(session.backend, panel, None, session.places)
    lonely.pane.route_drawn.emit(['bot1'], [(0.0, 0.0)])
    assert 'not started' in lonely.pane.line.text()
    lonely.close()
    session.map.close()


def test_a_click_on_a_robot_looks_at_it(session, heard):
    press_m(session)
    looked = heard(session.panel.looked_at)
    session.panel.robot_list.show_robots(session.robots, True)
    session.operator.wait_until(lambda: pixel(session.pane, 1.0, 2.0).x() > 0)
    click(session.pane, 1.0, 2.0)
    assert looked == ['bot2']
