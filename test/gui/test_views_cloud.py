# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The point cloud on the screen: real drags turn it, old is not live, choices are kept."""
import os
import sys

import numpy as np
import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent, QWheelEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.camera.images import StreamStatus  # noqa: E402
from mhri.driving.gui.drive_keys import DriveKeys, mark_drive_area  # noqa: E402
from mhri.sensors.cloud_picture import COLOUR, DISTANCE, GROUND, HEIGHT  # noqa: E402
from mhri.sensors.gui.cloud_canvas import MOST_PIXELS, number_text  # noqa: E402
from mhri.sensors.gui.cloud_view import CloudView, points_text  # noqa: E402
from mhri.sensors.orbit import Orbit, projected  # noqa: E402
from mhri.sensors.point_cloud import Cloud  # noqa: E402
from support.clouds import room  # noqa: E402

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
    view.restore_settings({'colouring': COLOUR, 'orbit': Orbit((3, 0, 0), distance_m=4).words()})
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


@pytest.mark.parametrize('button', [Qt.RightButton, Qt.MiddleButton])
def test_a_drag_with_another_button_moves(view, act, hand, button):
    view.restore_settings({'colouring': COLOUR, 'orbit': Orbit((3, 0, 0), distance_m=4).words()})
    act(lambda: view.show_value(cloud_of([(3, 0, 0)], [RED])))
    before = red(view)
    act(lambda: hand.drag(40, -25, button))
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
    act(lambda: QTest.mouseClick(view.reset_button, Qt.LeftButton))
    assert view.canvas.orbit == fitted


def test_without_a_button_nothing_turns(view, act):
    act(lambda: view.show_value(a_room()))
    before = view.canvas.orbit
    QApplication.sendEvent(view.canvas, QMouseEvent(
        QEvent.MouseMove, QPointF(9, 9), Qt.NoButton, Qt.NoButton, Qt.NoModifier))
    assert view.canvas.orbit == before


def test_keys_turn_move_and_zoom(view, act):
    act(lambda: view.show_value(a_room()))
    fitted = view.canvas.orbit
    view.canvas.setFocus(Qt.TabFocusReason)
    for key, shift, changed in (
            (Qt.Key_Left, Qt.NoModifier, 'yaw_rad'), (Qt.Key_Up, Qt.NoModifier, 'pitch_rad'),
            (Qt.Key_Right, Qt.ShiftModifier, 'target_m'), (Qt.Key_Plus, Qt.NoModifier,
                                                           'distance_m')):
        before = getattr(view.canvas.orbit, changed)
        act(lambda key=key, shift=shift: QTest.keyClick(view.canvas, key, shift))
        assert getattr(view.canvas.orbit, changed) != before
    act(lambda: QTest.keyClick(view.canvas, Qt.Key_Home))
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
        assert moves == [(1.0, 0.0), (0.0, 0.0)] and view.canvas.orbit == before
        view.canvas.setFocus(Qt.TabFocusReason)
        operator.hit(view.canvas, Qt.Key_Up)
        assert len(moves) == 2 and view.canvas.orbit != before
    finally:
        application.removeEventFilter(keys)
        keys.close()


def test_colours_by_choice(view, act):
    act(lambda: view.show_value(a_room()))
    combo = view.colour_combo
    assert [combo.itemText(at) for at in range(combo.count())] == ['Height', 'Distance', 'Colour']
    assert view.canvas.picture.scale is not None and view.colouring == HEIGHT
    combo.setFocus()
    act(lambda: QTest.keyClick(combo, Qt.Key_Down))
    assert view.colouring == DISTANCE and view.canvas.picture.scale[1] > 5.0
    act(lambda: QTest.keyClick(combo, Qt.Key_Down))
    assert view.colouring == COLOUR and view.canvas.picture.scale is None


def test_a_choice_stays_while_the_cloud_does_not_have_it(view, act):
    view.restore_settings({'colouring': 'intensity'})
    act(lambda: view.show_value(a_room()))
    assert view.colour_combo.currentText() == 'Intensity'
    assert view.canvas.picture.colouring == HEIGHT


def test_an_old_cloud_does_not_look_live(view, act, operator):
    view.show_age(None)
    act(lambda: view.show_value(a_room()))
    view.show_age(0.3)
    assert view.canvas.warning == ''
    live = lightness(view.canvas)
    view.show_age(3.2)
    operator.settle()
    assert view.canvas.warning == 'OLD CLOUD, 3.2 s'
    assert lightness(view.canvas) < 0.8 * live
    act(lambda: view.show_value(a_room()))
    assert view.canvas.warning == ''


def test_what_the_stream_says(view, act):
    view.show_status(StreamStatus(problem='no point cloud', detail='nobody publishes <b>/points'))
    assert view.canvas.words == 'no point cloud'
    assert 'nobody publishes &lt;b&gt;/points' in view.canvas.toolTip()
    act(lambda: view.show_value(a_room()))
    assert view.status_label.text() == '20,000 points'
    QTest.qWait(300)
    view.show_status(StreamStatus('cloud', 5.0, 0.04, 8e6))
    assert view.status_label.text().startswith('20,000 points  5.0 Hz')
    assert points_text(Cloud(np.ones((5, 3)), sent=21, kept_of=4)) == '1 of 4 of 21 points'


def test_a_cloud_without_points_says_so(view, act):
    act(lambda: view.show_value(cloud_of([])))
    assert set(np.unique(view.canvas.picture.pixels)) != {GROUND}
    assert not view.canvas.grab().isNull()
    before = view.canvas.orbit
    act(lambda: view.show_value(a_room()))
    assert view.canvas.orbit != before


def test_the_first_cloud_alone_decides_where_from(view, act, hand):
    act(lambda: view.show_value(a_room()))
    before = view.canvas.orbit
    act(lambda: hand.drag(30, 0))
    turned = view.canvas.orbit
    act(lambda: view.show_value(cloud_of([(50, 0, 0), (60, 1, 1)])))
    assert view.canvas.orbit == turned != before


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


def test_a_hidden_view_draws_nothing(operator, heard):
    view = CloudView()
    drawn = heard(view.drawn)
    view.show_value(a_room())
    QTest.qWait(200)
    assert not drawn
    operator.show(view)
    operator.wait_until(lambda: drawn)


def test_it_may_go_while_it_is_being_drawn(operator):
    for _ in range(5):
        view = CloudView()
        operator.show(view)
        view.show_value(a_room())
        view.close()
        view.deleteLater()
        del view
        operator.settle()
    QTest.qWait(200)


def test_large_views_are_drawn_smaller(view):
    view.canvas.resize(3840, 2160)
    width, height = view.canvas.drawing_size()
    assert width * height <= 1.01 * MOST_PIXELS
    assert width / height == pytest.approx(16 / 9, abs=0.01)


def test_what_cannot_be_drawn_says_so(view, operator):
    view.show_value(Cloud(np.ones((5, 3), 'f4'), intensity=np.ones(5, 'f4'),
                          colours=np.ones(3, 'u4')))
    view.restore_settings({'colouring': COLOUR})
    operator.wait_until(lambda: 'cannot be drawn' in view.canvas.words)


@pytest.mark.parametrize('value, span, unit, text', [
    (1.834, 3.2, 'm', '1.8 m'), (31.8, 30.0, 'm', '32 m'), (0.123, 0.02, '', '0.123'),
    (212.4, 255.0, '', '212'), (1e9, 1e9, '', '1.0e+09'), (5.0, 0.0, 'm', '5 m')])
def test_ends_of_a_scale(value, span, unit, text):
    assert number_text(value, span, unit) == text
