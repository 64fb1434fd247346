# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map: drawn pixel by pixel, zoomed, dragged, and acted on with mouse and keys."""
import math

import numpy as np
import pytest
from python_qt_binding.QtCore import QPoint, QPointF, Qt
from python_qt_binding.QtGui import QColor, QPalette, QWheelEvent
from python_qt_binding.QtWidgets import QApplication, QPushButton
from support.maps import BOT1, BOT2, drag, map_pane, SCENE
from support.sight import apart, SIGHTS

from mhri.base.gui import theme
from mhri.base.gui.robot_sign import hue_of
from mhri.base.geometry import Pose
from mhri.map.canvas import Canvas
from mhri.map.grid import Grid
from mhri.map.gui.map_canvas import MapCanvas
from mhri.map.scene import MapRobot, Scene


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


def test_who_is_not_on_the_map_is_listed_in_words_and_placed_by_a_click(pane, operator, heard):
    button = pane.strip.findChild(QPushButton, 'unplaced_bot3')
    assert 'bot3' in button.text()
    assert button.height() >= theme.SMALLEST_TOUCH_PX
    placed = heard(pane.robot_placed)
    operator.click(button)
    assert 'bot3' in pane.line.text()
    drag(pane, (1.0, 0.0), (1.0, 1.0))
    (name, pose), = placed
    assert name == 'bot3' and pose.heading_rad == pytest.approx(math.pi / 2.0, abs=0.02)
    assert (pose.x_m, pose.y_m) == pytest.approx((1.0, 0.0), abs=0.02)


@pytest.mark.parametrize('name', [theme.DARK, theme.LIGHT, theme.CONTRAST])
def test_the_colours_of_robots_are_those_of_no_state(name):
    palette = theme.palette_of(name)
    grounds = [palette.color(QPalette.Base), theme.blend(
        palette.color(QPalette.Window), palette.color(QPalette.WindowText), 0.16)]
    states = [theme.colour(state, palette).name() for state in (
        theme.LIVE, theme.ATTENTION, theme.STOP, theme.DRIVE, theme.TASK)]
    for number in range(1, 13):
        hue = hue_of(number, palette)
        assert min(theme.contrast(hue, ground) for ground in grounds) >= 3.0, number
        assert min(apart(hue.name(), state, 'usual') for state in states) > 7.5, number
        assert min(apart(hue.name(), state, sight) for state in states
                   for sight in SIGHTS) > 4.5, number


# How it is looked at.

def test_the_wheel_zooms_about_the_pointer(pane):
    before, at = pane.view.canvas, QPointF(200, 150)
    QApplication.sendEvent(pane.view, QWheelEvent(
        at, pane.view.mapToGlobal(at.toPoint()), QPoint(), QPoint(0, 240), Qt.NoButton,
        Qt.NoModifier, Qt.NoScrollPhase, False))
    after = pane.view.canvas
    assert after.px_per_m > 1.4 * before.px_per_m
    assert after.world(200, 150) == pytest.approx(before.world(200, 150), abs=0.02)


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
