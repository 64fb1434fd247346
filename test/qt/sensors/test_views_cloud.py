# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The point cloud on the screen: real drags turn it, old is not live, choices are kept."""
import numpy as np
import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent, QWheelEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

from mhri.driving.gui.drive_keys import DriveKeys, mark_drive_area
from mhri.sensors.cloud_picture import COLOUR, HEIGHT
from mhri.sensors.gui.cloud_view import CloudView
from mhri.sensors.orbit import Orbit, projected
from mhri.sensors.point_cloud import Cloud
from support.clouds import room

RED = 0xffff0000


def cloud_of(places, colours=None, **more):
    points = np.array(places, 'f4').reshape(-1, 3)
    return Cloud(points, None if colours is None else np.array(colours, 'u4'), sent=len(points),
                 **more)


def a_room():
    columns = room(20_000)
    return cloud_of(np.column_stack([columns[axis] for axis in 'xyz']),
                    columns['rgb'] | 0xff000000)


class Hand:
    """A mouse with its buttons; QTest moves the pointer, whose button nobody holds then."""

    def __init__(self, widget):
        self._widget = widget

    def drag(self, right, down, button=Qt.LeftButton, steps=5):
        middle = self._widget.rect().center()
        QTest.mousePress(self._widget, button, Qt.NoModifier, middle)
        for step in range(1, steps + 1):
            place = QPointF(middle) + QPointF(right, down) * step / steps
            QApplication.sendEvent(self._widget, QMouseEvent(
                QEvent.MouseMove, place, Qt.NoButton, button, Qt.NoModifier))
        QTest.mouseRelease(self._widget, button, Qt.NoModifier, middle + QPoint(right, down))

    def wheel(self, notches):
        place = QPointF(self._widget.rect().center())
        QApplication.sendEvent(self._widget, QWheelEvent(
            place, QPointF(self._widget.mapToGlobal(place.toPoint())), QPoint(),
            QPoint(0, 120 * notches), Qt.NoButton, Qt.NoModifier, Qt.NoScrollPhase, False))


@pytest.fixture
def view(operator):
    widget = CloudView()
    widget.resize(500, 420)
    operator.show(widget)
    return widget


@pytest.fixture
def hand(view):
    return Hand(view.canvas)


def settled(view, operator, heard, act):
    """Do something, and wait for the picture that comes of it."""
    drawn = heard(view.drawn)
    act()
    # A picture of before may come first.
    operator.wait_until(lambda: drawn and view.idle)
    operator.settle()


@pytest.fixture
def act(view, operator, heard):
    return lambda job: settled(view, operator, heard, job)


def red(view):
    """Return the middle of what is red in the picture on show, None for nothing."""
    rows, columns = np.nonzero(view.canvas.picture.pixels == RED)
    return None if not len(rows) else (columns.mean() + 0.5, rows.mean() + 0.5)


def lightness(widget):
    """Return how light the lower half of a widget is, 0 to 255."""
    image = widget.grab().toImage()
    return np.mean([image.pixelColor(x, y).lightness() for x in range(0, image.width(), 7)
                    for y in range(image.height() // 2, image.height(), 7)])


def test_a_point_is_where_it_is_seen_from(view, act):
    view.restore_settings({'colouring': COLOUR, 'orbit': Orbit((3, 0, 0), distance_m=4).to_list()})
    act(lambda: view.show_value(cloud_of([(3, 1, 0.5)], [RED])))
    size = view.canvas.drawing_size()
    place = projected([(3, 1, 0.5)], view.canvas.orbit, size)[0][:2]
    assert red(view) == pytest.approx(tuple(place), abs=1.5)
    image = view.canvas.grab().toImage()
    around = [(int(place[0]) + right, int(place[1]) + down)
              for right in (-1, 0, 1) for down in (-1, 0, 1)]
    assert any(image.pixelColor(*near).getRgb()[:3] == (255, 0, 0) for near in around)


def test_a_drag_turns(view, act, hand):
    act(lambda: view.show_value(a_room()))
    before = view.canvas.orbit
    picture = view.canvas.picture.pixels.copy()
    act(lambda: hand.drag(60, 30))
    assert view.canvas.orbit.yaw_rad < before.yaw_rad
    assert view.canvas.orbit.pitch_rad > before.pitch_rad
    assert view.canvas.orbit.target_m == before.target_m
    assert not np.array_equal(picture, view.canvas.picture.pixels)


def test_a_drag_with_another_button_moves(view, act, hand):
    view.restore_settings({'colouring': COLOUR, 'orbit': Orbit((3, 0, 0), distance_m=4).to_list()})
    act(lambda: view.show_value(cloud_of([(3, 0, 0)], [RED])))
    before = red(view)
    act(lambda: hand.drag(40, -25, Qt.RightButton))
    assert np.subtract(red(view), before) == pytest.approx((40, -25), abs=2.0)
    assert view.canvas.orbit.yaw_rad == 0.0


def test_the_wheel_zooms_and_a_double_click_shows_all(view, act, hand):
    act(lambda: view.show_value(a_room()))
    fitted = view.canvas.orbit
    act(lambda: hand.wheel(3))
    assert view.canvas.orbit.distance_m < fitted.distance_m
    act(lambda: hand.wheel(-9))
    assert view.canvas.orbit.distance_m > fitted.distance_m
    act(lambda: QTest.mouseDClick(view.canvas, Qt.LeftButton))
    assert view.canvas.orbit == fitted
    act(lambda: hand.drag(50, 0))
    turned = view.canvas.orbit
    act(lambda: view.show_value(cloud_of([(50, 0, 0), (60, 1, 1)])))
    assert view.canvas.orbit == turned != fitted, 'the first cloud alone decides where from'
    act(lambda: view.show_value(a_room()))
    act(lambda: QTest.mouseClick(view.reset_button, Qt.LeftButton))
    assert view.canvas.orbit == fitted


def test_a_click_leaves_the_arrows_to_driving(view, act, application, operator):
    """But with the keyboard on it by Tab it has them, as a slider has."""
    act(lambda: view.show_value(a_room()))
    mark_drive_area(view)
    keys = DriveKeys(view)
    application.installEventFilter(keys)
    moves = []
    keys.moved.connect(lambda *way: moves.append(way))
    try:
        view.setFocusPolicy(Qt.StrongFocus)
        view.setFocus()
        QTest.mouseClick(view.canvas, Qt.LeftButton)
        before = view.canvas.orbit
        operator.hit(application.focusWidget(), Qt.Key_Up)
        assert moves == [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0)] and view.canvas.orbit == before
        view.canvas.setFocus(Qt.TabFocusReason)
        operator.hit(view.canvas, Qt.Key_Up)
        assert len(moves) == 2 and view.canvas.orbit != before
    finally:
        application.removeEventFilter(keys)
        keys.close()


def test_an_old_cloud_does_not_look_live(view, act, operator):
    view.show_age(None)
    act(lambda: view.show_value(a_room()))
    view.show_age(0.3)
    assert view.canvas.warning == ''
    live = lightness(view.canvas)
    view.show_age(3.2)
    operator.settle()
    assert '3.2 s' in view.canvas.warning
    assert lightness(view.canvas) < 0.8 * live
    act(lambda: view.show_value(a_room()))
    assert view.canvas.warning == ''


def test_choices_are_kept(operator, view, act, hand):
    assert view.save_settings() == {'colouring': HEIGHT}
    act(lambda: view.show_value(a_room()))
    act(lambda: hand.drag(33, 12))
    kept = view.save_settings()
    other = CloudView()
    other.restore_settings(kept)
    assert other.save_settings() == kept
    other.show_value(a_room())
    assert other.save_settings() == kept


@pytest.mark.parametrize('settings', [
    {}, {'colouring': 5, 'orbit': 5}, {'colouring': 'taste', 'orbit': [float('nan')] * 6},
    {'orbit': ['x']}])
def test_what_cannot_be_kept_is_left_out(operator, settings):
    view = CloudView()
    view.restore_settings(settings)
    assert view.save_settings() == {'colouring': HEIGHT}
