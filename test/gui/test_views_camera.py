# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The camera view: right colours, right distances, and nothing old that looks live."""
from dataclasses import replace
from datetime import datetime
import math

import numpy as np
import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

from mhri.base.gui import theme
from mhri.camera.depth_colour import DepthColour
from mhri.camera.gui.camera_view import (
    bandwidth_text, CameraView, still_name, stream_text, stream_warning)
from mhri.camera.gui.picture import distance_text, titles
from mhri.camera.images import DEPTH, Frame, RGB, StreamStatus

LIVE = StreamStatus('jpeg', 29.9, 0.041, 6.4e6, 100)


def colour_frame(width=320, height=240):
    """Return a picture whose left half is red and right half blue."""
    rgb = np.zeros((height, width, 3), np.uint8)
    rgb[:, :width // 2] = (200, 10, 20)
    rgb[:, width // 2:] = (10, 20, 200)
    return Frame(RGB, rgb, full_size=(width, height))


def depth_frame(width=320, height=240):
    """Return depth that is 1 m at the left edge and 3 m at the right one; above: nothing."""
    depth = np.repeat(np.linspace(1.0, 3.0, width, dtype=np.float32)[None], height, axis=0)
    depth[:height // 4] = np.nan
    rgb, depth_range = DepthColour((1.0, 3.0)).colour(depth, 0.0)
    return Frame(DEPTH, np.ascontiguousarray(rgb), depth, (width, height), depth_range)


@pytest.fixture
def view(operator):
    widget = CameraView()
    widget.resize(520, 420)
    widget.show_kind(RGB)
    operator.show(widget)
    return widget


def pixel(view, across, along):
    """Return the (r, g, b) on the screen at a place of the picture in parts of its size."""
    target = view.picture.target()
    point = QPointF(target.left() + across * target.width(),
                    target.top() + along * target.height()).toPoint()
    return view.picture.grab().toImage().pixelColor(point).getRgb()[:3]


def hover(view, across, along):
    """Move the pointer to a place of the picture in parts of its size."""
    target = view.picture.target()
    point = QPointF(target.left() + across * target.width(),
                    target.top() + along * target.height())
    QApplication.sendEvent(view.picture, QMouseEvent(
        QEvent.MouseMove, point, Qt.NoButton, Qt.NoButton, Qt.NoModifier))
    return point


@pytest.mark.parametrize('size', [(320, 240), (640, 480), (160, 400), (33, 21)])
def test_colours_and_shape_on_the_screen(view, operator, size):
    view.show_frame(colour_frame(*size))
    operator.settle()
    assert pixel(view, 0.2, 0.5) == pytest.approx((200, 10, 20), abs=3)
    assert pixel(view, 0.8, 0.5) == pytest.approx((10, 20, 200), abs=3)
    target = view.picture.target()
    assert target.width() / target.height() == pytest.approx(size[0] / size[1], rel=0.04)
    assert view.picture.room().contains(target.toAlignedRect())


def test_a_picture_of_the_right_size_is_not_scaled(view, operator):
    width, height = view.camera_size()
    noise = np.random.RandomState(2).randint(0, 255, (height, width, 3)).astype(np.uint8)
    view.show_frame(Frame(RGB, noise, full_size=(2 * width, 2 * height)))
    operator.settle()
    image = view.picture.grab().toImage()
    for x, y in ((0, 0), (7, 5), (width - 1, height - 1)):
        assert image.pixelColor(x, y).getRgb()[:3] == tuple(noise[y, x])


@pytest.mark.parametrize('across', [0.1, 0.3, 0.5, 0.77, 0.95])
def test_the_distance_under_the_pointer(view, operator, across):
    view.show_kind(DEPTH)
    view.show_frame(depth_frame())
    operator.settle()
    depth, inside = view.picture.distance_at(hover(view, across, 0.6))
    assert inside and depth == pytest.approx(1.0 + 2.0 * across, abs=0.02)


def test_where_nothing_was_measured(view, operator):
    view.show_kind(DEPTH)
    view.show_frame(depth_frame())
    depth, inside = view.picture.distance_at(hover(view, 0.5, 0.1))
    assert inside and math.isnan(depth) and distance_text(depth) == 'no measurement'
    assert view.picture.distance_at(QPointF(1e4, 10)) == (pytest.approx(math.nan, nan_ok=True),
                                                          False)


def test_depth_has_a_scale_and_a_picture_in_colour_has_none(view, operator):
    wide = view.camera_size()[0]
    view.show_kind(DEPTH)
    view.show_frame(depth_frame())
    operator.settle()
    narrow = view.camera_size()[0]
    assert narrow < wide - 40 and view.picture.target().right() <= narrow
    image = view.picture.grab().toImage()
    x = narrow + view.fontMetrics().height()
    top, bottom = (image.pixelColor(x, y).lightness() for y in (30, view.picture.height() - 80))
    assert bottom > top + 60, 'near is light, at the bottom'


@pytest.mark.parametrize('status, warning', [
    (LIVE, ''),
    (StreamStatus(), ''),
    (replace(LIVE, age_s=0.9), ''),
    (replace(LIVE, age_s=2.3), 'OLD PICTURE, 2.3 s'),
    (replace(LIVE, age_s=0.2, stale=True, bad=1, problem='jpeg: truncated'),
     'OLD PICTURE, 200 ms\njpeg: truncated'),
])
def test_when_a_picture_is_old(status, warning):
    assert stream_warning(status) == warning


def test_an_old_picture_does_not_look_live(view, operator):
    view.show_frame(colour_frame())
    view.show_status(LIVE)
    operator.settle()
    assert view.picture.warning == '' and view.status_sign.sign is None
    fresh = pixel(view, 0.2, 0.8)
    view.show_status(replace(LIVE, age_s=2.3))
    operator.settle()
    assert view.picture.warning == 'OLD PICTURE, 2.3 s', 'a state never waits'
    assert view.status_sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    assert sum(pixel(view, 0.2, 0.8)) < 0.7 * sum(fresh)
    edge = pixel(view, 0.004, 0.5)
    ink = theme.colour(theme.ATTENTION, view.picture.palette())
    assert edge == pytest.approx(ink.getRgb()[:3], abs=40)
    view.show_status(LIVE)
    assert view.picture.warning == ''


def test_without_a_picture_it_says_why_and_the_tool_tip_what_ros_calls_it(view, operator):
    view.show_kind('rgb')
    view.show_status(StreamStatus(problem='it sends no picture', detail='nobody publishes /a/b'))
    assert (view.picture.toolTip(), view.picture.frame) == ('nobody publishes /a/b', None)


@pytest.mark.parametrize('status, text', [
    (StreamStatus(), ''),
    (LIVE, '29.9 Hz  41 ms old  0.8 MB/s  jpeg'),
    (replace(LIVE, bad=3, problem='jpeg: truncated'),
     '29.9 Hz  41 ms old  0.8 MB/s  jpeg  3 bad: jpeg: truncated'),
    (replace(LIVE, bad=1200), '29.9 Hz  41 ms old  0.8 MB/s  jpeg  1,200 bad'),
])
def test_the_status_line(status, text):
    assert stream_text(status) == text


@pytest.mark.parametrize('bits_per_s, text', [
    (0.0, '0.00 MB/s'), (3.2e5, '0.04 MB/s'), (8e5, '0.1 MB/s'), (2.2e8, '27.5 MB/s')])
def test_bandwidth(bits_per_s, text):
    assert bandwidth_text(bits_per_s) == text


def test_numbers_change_four_times_a_second_at_most(view):
    view._status_pace._next = None
    view.show_status(LIVE)
    view.show_status(replace(LIVE, rate_hz=12.0))
    assert view.stream_label.text().startswith('29.9 Hz')


def test_another_kind_takes_the_picture_away_and_late_frames_stay_out(view):
    view.show_frame(colour_frame())
    view.show_kind(DEPTH)
    assert view.picture.frame is None and view.picture.words
    view.show_frame(colour_frame())
    assert view.picture.frame is None
    view.show_placeholder('bot1 has no depth camera')
    assert view.picture.words == 'bot1 has no depth camera'
    view.show_frame(depth_frame())
    view.show_placeholder('too late')
    assert view.picture.frame is not None


def test_a_still_is_asked_for_by_click_and_only_where_there_is_a_picture(view, operator, heard):
    asked = heard(view.still_requested)
    operator.click(view.still_button)
    assert asked == [] and not view.still_button.isEnabled()
    frame = colour_frame()
    view.show_frame(frame)
    operator.click(view.still_button)
    assert asked == [frame]
    view.show_note('saved bot1_rgb.png')
    view.show_status(replace(LIVE, age_s=3.0))
    assert view.stream_label.text() == 'saved bot1_rgb.png'
    view._note_timer.stop()
    view._status_pace._next = None
    view.show_status(LIVE)
    assert view.stream_label.text() == '29.9 Hz  41 ms old  0.8 MB/s  jpeg'


def test_the_name_of_a_still():
    when = datetime(2026, 11, 21, 14, 2, 11, 50999)
    assert still_name('bot1', 'rgb', when) == 'bot1_rgb_2026-11-21-14-02-11-050.png'


def test_transports_are_offered_and_chosen_by_click(view, operator, heard):
    chosen = heard(view.transport_chosen)
    view.show_transports(['jpeg', 'raw'])
    view.show_transports(['jpeg', 'raw'])
    combo = view.transport_combo
    assert [combo.itemText(i) for i in range(combo.count())] == ['auto', 'jpeg', 'raw']
    assert chosen == []
    combo.showPopup()
    operator.wait_until(lambda: combo.view().isVisible())
    QTest.mouseClick(combo.view().viewport(), Qt.LeftButton, Qt.NoModifier,
                     combo.view().visualRect(combo.model().index(2, 0)).center())
    operator.wait_until(lambda: chosen == ['raw'])
    view.show_transports(['jpeg'])
    assert combo.currentText() == 'raw', 'what is chosen stays, there or not'
    view.show_kind(DEPTH)
    assert combo.currentText() == 'auto', 'each kind of picture has its own'
    view.show_kind(RGB)
    assert combo.currentText() == 'raw'


@pytest.mark.parametrize('point', [QPoint(0, 0), QPoint(259, 5), QPoint(500, 300)])
def test_the_pointer_may_be_anywhere(view, operator, point):
    view.show_kind(DEPTH)
    for frame in (depth_frame(), depth_frame(1, 1), replace(depth_frame(), depth_range_m=None)):
        view.show_frame(frame)
        QTest.mouseMove(view.picture, point)
        operator.settle()
        assert not view.picture.grab().isNull()


@pytest.mark.parametrize('slowed, text', [
    (None, '29.9 Hz'), ((5.0, 'bot2'), '5 Hz: bot2 is in front'), ((40.0, 'bot2'), '29.9 Hz'),
    ((0.5, 'bot2'), '0.5 Hz: bot2 is in front')])
def test_a_picture_that_is_shown_less_often_says_why(view, operator, slowed, text):
    view.show_frame(colour_frame())
    view._status_pace._next = None
    view.show_status(LIVE, slowed)
    assert view.stream_label.text() == text + '  41 ms old  0.8 MB/s  jpeg'
    view.stream_label.resize(170, 20)
    assert view.stream_label.shown_text() in (text, text + '  41 ms old')


def test_a_picture_that_the_budget_holds_back_says_so_and_is_not_old_before_its_time(view):
    held = replace(LIVE, rate_hz=0.5, age_s=1.9, thinned='thinned to 0.5 Hz: camera budget',
                   old_after_s=5.0)
    view.show_frame(colour_frame())
    view._status_pace._next = None
    view.show_status(held, (5.0, 'bot2'))
    assert view.stream_label.text().startswith('thinned to 0.5 Hz: camera budget')
    assert stream_warning(held) == ''
    assert stream_warning(replace(held, age_s=5.1)) == \
        'OLD PICTURE, 5.1 s\nthinned to 0.5 Hz: camera budget'


def test_of_an_old_picture_the_age_is_the_last_to_go():
    assert titles('OLD PICTURE, 2.4 s') == ('OLD PICTURE, 2.4 s', 'OLD 2.4 s', '2.4 s')
