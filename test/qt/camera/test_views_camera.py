# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The camera view: right colours, right distances, and nothing old that looks live."""
from dataclasses import replace

import numpy as np
import pytest
from python_qt_binding.QtCore import QEvent, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

from mhri.base.gui import theme
from mhri.camera.depth_colour import DepthColour
from mhri.camera.gui.camera_view import CameraView, stream_text, stream_warning
from mhri.camera.gui.picture import titles
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
    rgb, depth_range = DepthColour().colour(depth, 0.0)
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


@pytest.mark.parametrize('size', [(320, 240), (160, 400), (33, 21)])
def test_colours_and_shape_on_the_screen(view, operator, size):
    view.show_frame(colour_frame(*size))
    operator.settle()
    assert pixel(view, 0.2, 0.5) == pytest.approx((200, 10, 20), abs=3)
    assert pixel(view, 0.8, 0.5) == pytest.approx((10, 20, 200), abs=3)
    target = view.picture.target()
    assert target.width() / target.height() == pytest.approx(size[0] / size[1], rel=0.04)
    assert view.picture.room().contains(target.toAlignedRect())


@pytest.mark.parametrize('across', [0.1, 0.5, 0.95])
def test_the_distance_under_the_pointer(view, operator, across):
    wide = view.camera_size()[0]
    view.show_kind(DEPTH)
    view.show_frame(depth_frame())
    operator.settle()
    assert view.picture.target().right() <= view.camera_size()[0] < wide, 'beside the scale'
    depth, inside = view.picture.distance_at(hover(view, across, 0.6))
    assert inside and depth == pytest.approx(1.0 + 2.0 * across, abs=0.02)


HELD = replace(LIVE, rate_hz=0.5, age_s=1.9, thinned='thinned to 0.5 Hz', old_after_s=5.0)


@pytest.mark.parametrize('status, age, reason', [
    (LIVE, '', ''), (StreamStatus(), '', ''), (replace(LIVE, age_s=0.9), '', ''),
    (replace(LIVE, age_s=2.3), '2.3 s', ''), (HELD, '', ''),
    (replace(HELD, age_s=5.1), '5.1 s', 'thinned to 0.5 Hz'),
    (replace(LIVE, age_s=0.2, stale=True, bad=1, problem='jpeg: truncated'), '200 ms',
     'jpeg: truncated')])
def test_when_a_picture_is_old(status, age, reason):
    first, _, second = stream_warning(status).partition('\n')
    assert bool(first) == bool(age) and first.endswith(age) and second == reason
    assert titles(first)[-1] == age, 'in little room the age is the last to go'


def test_an_old_picture_does_not_look_live(view, operator):
    view.show_frame(colour_frame())
    view.show_status(LIVE)
    operator.settle()
    assert view.picture.warning == '' and view.status_sign.sign is None
    fresh = pixel(view, 0.2, 0.8)
    view.show_status(replace(LIVE, age_s=2.3))
    operator.settle()
    assert view.picture.warning == stream_warning(replace(LIVE, age_s=2.3)), 'a state never waits'
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


@pytest.mark.parametrize('status, parts', [
    (LIVE, ('29.9 Hz', '41 ms', '0.8 MB/s', 'jpeg')),
    (replace(LIVE, bits_per_s=3.2e5), ('0.04 MB/s',)),
    (replace(LIVE, bad=1200, problem='truncated'), ('1,200', 'truncated'))])
def test_the_status_line(status, parts):
    assert all(part in stream_text(status) for part in parts)
    assert stream_text(StreamStatus()) == ''


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


@pytest.mark.parametrize('status, slowed, why', [
    (LIVE, None, '29.9 Hz'), (LIVE, (40.0, 'bot2'), '29.9 Hz'), (LIVE, (0.5, 'bot2'), 'bot2'),
    (HELD, (5.0, 'bot2'), HELD.thinned)])
def test_a_picture_that_is_shown_less_often_says_why(view, operator, status, slowed, why):
    view.show_frame(colour_frame())
    view.show_status(status, slowed)
    assert why in view.stream_label.text()
    view.stream_label.resize(170, 20)
    assert why in view.stream_label.shown_text(), 'in little room, too'
