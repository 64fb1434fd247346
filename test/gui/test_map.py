# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map: drawn pixel by pixel, zoomed, dragged, and acted on with mouse and keys."""
import math

import numpy as np
import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QColor, QPalette, QWheelEvent
from python_qt_binding.QtWidgets import QApplication, QPushButton
from support.maps import BOT1, BOT2, drag, LOOSE, map_pane, move, pixel, SCENE

from mhri.base.gui import theme
from mhri.base.mocap import Pose
from mhri.map.canvas import Canvas, place_words
from mhri.map.grid import Grid
from mhri.map.gui.map_canvas import MapCanvas
from mhri.map.gui.map_paint import hue_of
from mhri.map.gui.map_pane import MapPane
from mhri.map.gui.map_strip import NOBODY_SAYS
from mhri.map.scene import Goal, MapMark, MapRobot, Scene
from mhri.map.trail import GOOD, LOST, Trail


@pytest.fixture
def pane(operator):
    """Return a map on the screen with two robots on it, and one that is not."""
    return map_pane(operator)


def colours(view):
    """Return the picture of a map as an array (height, width, 3)."""
    image = view.grab().toImage().convertToFormat(4)
    bits = image.constBits()
    if hasattr(bits, 'setsize'):
        bits.setsize(image.bytesPerLine() * image.height())
    return np.frombuffer(bits, np.uint8).reshape(image.height(), -1, 4)[:, :image.width(), 2::-1]


def middle_of(view, ink):
    """Return the middle [px] of all that has a colour, None where nothing has."""
    rows, columns = np.nonzero((np.abs(colours(view).astype(int) - (
        ink.red(), ink.green(), ink.blue())) < 12).all(axis=2))
    return (columns.mean(), rows.mean()) if len(rows) else None


# What is drawn.

def bare(operator, scene):
    """Return a map of a scene with nothing over it."""
    view = MapCanvas()
    theme.apply(view, theme.DARK)
    view.resize(600, 500)
    operator.show(view)
    view.show_scene(scene)
    return view


def test_a_robot_is_drawn_where_it_is(operator):
    robot = MapRobot('bot3', 3, Pose(1.5, -1.0, 0.0))
    view = bare(operator, Scene(robots=(robot, BOT1)))
    view.canvas = Canvas(600, 500, px_per_m=80.0)
    view.update()
    operator.settle()
    across, down = middle_of(view, hue_of(3, view.palette()))
    # Its nose reaches a little further than its disc.
    assert abs(across - (300 + 120)) < 8 and abs(down - (250 + 80)) < 4


def test_one_that_is_not_placed_is_drawn_nowhere(operator):
    view = bare(operator, Scene(robots=(LOOSE, BOT1)))
    assert middle_of(view, hue_of(1, view.palette())) is not None
    assert middle_of(view, hue_of(3, view.palette())) is None


def test_what_a_laser_has_met_is_drawn_in_the_colour_of_its_robot(operator):
    wall = np.column_stack((np.full(50, 2.0), np.linspace(-1.0, 1.0, 50)))
    robot = MapRobot('bot3', 3, Pose(9.0, 9.0, 0.0), points=wall)
    view = bare(operator, Scene(robots=(robot,)))
    view.canvas = Canvas(600, 500, px_per_m=80.0)
    view.update()
    across, down = middle_of(view, hue_of(3, view.palette()))
    assert abs(across - 460) < 3 and abs(down - 250) < 3


def test_points_beyond_the_edge_do_no_harm(operator):
    points = np.array([[1e5, -1e5], [-1e5, 0.0], [0.0, 1e4]])
    view = bare(operator, Scene(robots=(MapRobot('bot1', 1, Pose(0, 0, 0), points=points),)))
    assert middle_of(view, hue_of(1, view.palette())) is not None


@pytest.mark.parametrize('name', [theme.DARK, theme.LIGHT, theme.CONTRAST])
def test_a_map_of_cells_is_drawn_where_it_is(operator, name):
    view = bare(operator, SCENE)
    theme.apply(view, name)
    cells = np.zeros((40, 60), np.int8)
    # A wall at its lower edge.
    cells[:4] = 100
    view.show_grid(Grid(0.1, Pose(-3.0, -2.0, 0.0), cells))
    view.canvas = Canvas(600, 500, px_per_m=50.0)
    view.update()
    picture = colours(view)
    across, down = map(round, view.canvas.pixel(-2.5, -1.8))
    wall = QColor(*map(int, picture[down, across]))
    across, down = map(round, view.canvas.pixel(-2.4, 0.6))
    free = QColor(*map(int, picture[down, across]))
    assert theme.contrast(wall, free) > 4.5
    assert abs(free.lightness() - view.palette().color(QPalette.Base).lightness()) < 40


def test_trails_goals_marks_and_fence_are_drawn(operator):
    trail = Trail()
    for step in range(40):
        trail.add(Pose(-2.0 + 0.1 * step, 0.0, 0.0), GOOD if step < 20 else LOST, 0.0)
    robot = MapRobot('bot1', 1, Pose(2.0, 0.0, 0.0), trail=trail)
    view = bare(operator, Scene(robots=(robot,)))
    plain = colours(view).copy()
    view.choose(by_link=True)
    by_link = colours(view).copy()
    assert (plain != by_link).any()
    for more in ({'goals': (Goal(('bot1',), ((1.0, 1.0),), 0.5),)},
                 {'goals': (Goal(('bot1',), ((1.0, 1.0), (0.0, 1.0), (0.0, -1.0)), None, True),)},
                 {'marks': (MapMark('dock', Pose(0.5, 0.5, 0.0)),)}, {'leaders': (('bot1', 'x'),)},
                 {'fence': ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0))}):
        view.show_scene(Scene(robots=(robot,), **more))
        assert 'leaders' in more or (colours(view) != by_link).any(), more


def test_who_is_not_on_the_map_is_listed_in_words_and_placed_by_a_click(pane, operator, heard):
    button = pane.strip.findChild(QPushButton, 'unplaced_bot3')
    assert button.text() == '3 bot3 is not placed: place it by hand'
    assert button.height() >= theme.SMALLEST_TOUCH_PX
    placed = heard(pane.robot_placed)
    operator.click(button)
    assert 'bot3' in pane.line.text()
    drag(pane, (1.0, 0.0), (1.0, 1.0))
    (name, pose), = placed
    assert name == 'bot3' and pose.heading_rad == pytest.approx(math.pi / 2.0, abs=0.02)
    assert (pose.x_m, pose.y_m) == pytest.approx((1.0, 0.0), abs=0.02)


def test_more_than_four_are_counted_and_silence_is_said(pane):
    many = tuple(MapRobot('bot{}'.format(n), n, None, text='not placed: x') for n in range(1, 9))
    pane.show_scene(Scene(robots=many))
    assert pane.strip.note.text() == 'and 4 more are not placed'
    pane.show_scene(Scene(robots=many, answers=False))
    assert pane.strip.note.text() == NOBODY_SAYS
    pane.show_scene(Scene(robots=(BOT1,)))
    assert not pane.strip.isVisible()


def test_what_a_place_rests_on_is_in_the_tip(pane):
    assert pane.view.tip(BOT2) == '2 bot2: patrol\nplaced by tf'


# How it is looked at.

def test_the_wheel_zooms_about_the_pointer(pane):
    before, at = pane.view.canvas, QPointF(200, 150)
    QApplication.sendEvent(pane.view, QWheelEvent(
        at, pane.view.mapToGlobal(at.toPoint()), QPoint(), QPoint(0, 240), Qt.NoButton,
        Qt.NoModifier, Qt.NoScrollPhase, False))
    after = pane.view.canvas
    assert after.px_per_m > 1.4 * before.px_per_m
    assert after.world(200, 150) == pytest.approx(before.world(200, 150), abs=0.02)


def test_the_place_under_the_pointer_is_said(pane, operator):
    move(pane.view, pixel(pane, 1.0, -0.5), Qt.NoButton)
    at = pixel(pane, 1.0, -0.5)
    assert pane.place_label.text() == place_words(*pane.view.canvas.world(at.x(), at.y()))
    QApplication.sendEvent(pane.view, QEvent(QEvent.Leave))
    assert pane.place_label.text() == ''


def test_buttons_zoom_and_everything_comes_back(pane, operator):
    before = pane.view.canvas
    for button, larger in ((pane.closer, True), (pane.wider, False), (pane.wider, False)):
        now = pane.view.canvas.px_per_m
        operator.click(button)
        assert (pane.view.canvas.px_per_m > now) == larger
    operator.click(pane.all_button)
    assert pane.view.canvas == before
    for button in pane.findChildren(QPushButton):
        if button.isVisible():
            assert min(button.width(), button.height()) >= theme.SMALLEST_TOUCH_PX, button.text()


def test_a_drag_pans_and_ends_following(pane, operator):
    operator.click(pane.follow_button)
    assert pane.view.follows
    before = pane.view.canvas
    drag(pane, (0.0, -1.0), (0.5, -1.0))
    assert not pane.view.follows and not pane.follow_button.isChecked()
    assert pane.view.canvas.x_m == pytest.approx(before.x_m - 0.5, abs=0.05)


def test_it_follows_and_turns_with_the_robot_looked_at(pane, operator):
    operator.click(pane.follow_button)
    operator.click(pane.turn_button)
    for x_m, heading in ((5.0, 1.0), (40.0, -2.0)):
        robot = MapRobot('bot1', 1, Pose(x_m, 3.0, heading), looked_at=True)
        pane.show_scene(Scene(robots=(robot, BOT2)))
        across, down = pane.view.canvas.pixel(x_m, 3.0)
        assert 0.3 < across / pane.view.width() < 0.7 and 0.3 < down / pane.view.height() < 0.7
        assert pane.view.canvas.heading(heading) == pytest.approx(math.pi / 2.0, abs=0.02)
    operator.click(pane.turn_button)
    assert pane.view.canvas.turn_rad == 0.0


def test_what_is_chosen_is_kept(pane, operator):
    operator.click(pane.trails_button)
    operator.click(pane.turn_button)
    assert pane.save_settings() == {'follow': False, 'turn': True, 'by_link': True}
    other = MapPane()
    other.restore_settings(pane.save_settings())
    assert other.save_settings() == pane.save_settings() and other.trails_button.text() != ''


def test_the_ground_is_painted_once_for_many_drawings(pane):
    pane.view.repaint()
    before = pane.view.grounds_painted
    for _ in range(5):
        pane.show_scene(SCENE)
        pane.view.repaint()
    # The trails are painted again once a second.
    assert pane.view.grounds_painted <= before + 4
