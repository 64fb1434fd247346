# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's tile: which class, what it shows, and that one never wonders which robot moves."""
from dataclasses import replace

import numpy as np
import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QWidget

from mhri.base import views
from mhri.base.gui import theme
from mhri.base.views import ProofView, RobotView
from mhri.camera.depth_colour import DepthColour
from mhri.camera.images import DEPTH, Frame
from mhri.driving.gui.stop_bar import CUT_OFF
from mhri.recording.recording import RECORDING, RecordingStatus
from mhri.screen.gui.bot_window import BotWindow
from mhri.screen.gui.hud import hud_lines
from mhri.screen.gui.torn_off import TornOff
from mhri.screen.gui.windows import TurtleBotWindow, window_class

VIEW = RobotView('bot1', 'TurtleBot2', link=views.LIVE, age_s=0.012, linear_mps=0.31,
                 angular_rad_s=0.2, heading_rad=0.82, x_m=1.25, y_m=-0.4, battery=0.82,
                 max_linear_mps=0.65, max_angular_rad_s=3.14)
CONFIRMED = ProofView(views.PROOF_STOPPED, 'stopped in 180 ms')


@pytest.fixture(params=['turtlebot', 'unknown'])
def window(request, operator, ui_dir):
    return operator.show(window_class(request.param)(ui_dir, 'bot1', 'TurtleBot2'))


@pytest.mark.parametrize('key, expected', [
    ('turtlebot', TurtleBotWindow), ('', BotWindow), ('hexapod', BotWindow)])
def test_the_class_follows_the_type(key, expected):
    assert window_class(key) is expected


@pytest.mark.parametrize('changes, stop_all, state', [
    ({}, False, 'not selected'),
    ({'selected': True}, False, 'selected'),
    ({'selected': True, 'driven': True}, False, 'DRIVING'),
    ({'selected': True}, True, 'STOPPING'),
    ({'proof': ProofView(views.PROOF_WAITING, 'stopping')}, True, 'STOPPING'),
    ({'proof': ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED')}, True, 'NOT CONFIRMED'),
    ({'selected': True, 'proof': CONFIRMED}, False, 'STOPPED'),
])
def test_edge_and_pill_say_whether_it_is_driven(window, changes, stop_all, state):
    window.show_view(replace(VIEW, **changes), stop_all)
    assert window.drive_state == state and window.pill.word == state


def test_the_edge_is_painted(window, operator):
    for driven, name in ((True, theme.DRIVE), (False, None)):
        window.show_view(replace(VIEW, driven=driven))
        operator.settle()
        pixel = window.grab().toImage().pixelColor(2, window.height() // 2)
        ink = theme.colour(theme.DRIVE, theme.over_picture(window.palette()))
        assert (pixel == ink) == (name is not None)


@pytest.mark.parametrize('width', [480, 720, 744, 800])
def test_another_state_squeezes_no_name(window, operator, width):
    window.resize(width, 600)
    window.show_view(replace(VIEW, selected=True, driven=True))
    operator.settle()
    before = window.name_label.geometry()
    window.show_view(replace(VIEW, selected=True, proof=CONFIRMED))
    assert window.name_label.geometry() == before and window.name_label.shown_text() == 'bot1'


def test_the_header_line(window):
    window._numbers._next = None
    window.show_view(VIEW)
    assert window.name_label.text() == 'bot1' and window.type_label.text() == 'TurtleBot2'
    assert window.link_sign.sign == (theme.DISC, theme.LIVE)
    assert [label.text() for label in (window.link_label, window.battery_label)] == [
        'live 12 ms', '82 %']
    assert window.hud.lines[:2] == ('0.31 m/s   left 0.20 rad/s', 'heading 047')
    assert [label.text() for label in (window.x_value, window.y_value, window.turn_value,
                                       window.max_linear_value, window.max_angular_value)] == [
        'x 1.25 m', 'y -0.40 m', 'left 0.20 rad/s', '0.65 m/s', '3.14 rad/s']


@pytest.mark.parametrize('changes, shape, text', [
    ({}, None, ''),
    ({'link': views.SILENT, 'note': 'nothing for 3.2 s'}, theme.TRIANGLE, 'nothing for 3.2 s'),
    ({'link': views.GONE, 'note': 'master lost it'}, theme.CROSSED_SQUARE, 'master lost it'),
    ({'slow': True, 'note': 'centre the stick: it was out of reach'}, theme.TRIANGLE,
     'centre the stick: it was out of reach'),
    ({'battery': 0.28}, theme.TRIANGLE, 'battery 28 %'),
    ({'battery': 0.12, 'slow': True, 'note': 'link 310 ms'}, theme.TRIANGLE,
     'link 310 ms; battery 12 %'),
    ({'battery': 0.12, 'link': views.GONE, 'note': 'master lost it'}, theme.CROSSED_SQUARE,
     'master lost it'),
    ({'proof': CONFIRMED}, theme.TICK, 'stopped in 180 ms'),
    ({'link': views.GONE, 'proof': ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED')},
     theme.OCTAGON, 'NOT CONFIRMED'),
])
def test_the_sentence(window, changes, shape, text):
    window.show_view(replace(VIEW, **changes))
    sign = window.hud.sign
    assert (sign and sign[0], window.hud.sentence) == (shape, text)


def test_stop_of_a_torn_off_tile_acts_on_press_and_again_while_stopped(window, operator, heard):
    frame = operator.show(TornOff(window))
    assert window.window() is frame
    assert window.stop_button.isVisible() and window.stop_button.height() >= 44
    asked = heard(window.stop_requested)
    QTest.mousePress(window.stop_button, Qt.LeftButton)
    window.show_view(VIEW, stop_all=True)
    QTest.mouseRelease(window.stop_button, Qt.LeftButton)
    assert asked == [()] and window.stop_button.text().startswith('STOP ALL in force')
    QTest.mousePress(window.stop_button, Qt.LeftButton)
    assert len(asked) == 2


@pytest.mark.parametrize('was_stopped', [False, True])
def test_a_torn_off_tile_of_a_screen_that_is_cut_off_offers_no_stop(
        window, operator, heard, was_stopped):
    """It says so as the stop bar does, and looks as that does; whatever the robot's state."""
    frame, button = operator.show(TornOff(window)), window.stop_button
    window.show_view(VIEW, stop_all=was_stopped)
    words = button.shown_words()
    asked, clicked = heard(window.stop_requested), heard(window.clicked)
    window.show_cut_off(True)
    assert button.shown_words() == CUT_OFF and 'restart' in button.toolTip()
    looks = []
    for stop_all in (was_stopped, not was_stopped):
        window.show_view(VIEW, stop_all=stop_all)
        assert button.shown_words() == CUT_OFF and not button.isEnabled()
        looks.append(button.grab().toImage())
        QTest.mouseClick(frame.windowHandle(), Qt.LeftButton, Qt.NoModifier,
                         button.mapTo(frame, button.rect().center()))
    assert looks[0] == looks[1] and asked == clicked == []
    assert looks[0].pixelColor(8, button.height() // 2) != theme.STOP_GROUND
    frame.resize(200, 400)
    operator.settle()
    assert button.shown_words() == 'CUT OFF'
    window.show_cut_off(False)
    window.show_view(VIEW, stop_all=was_stopped)
    frame.resize(800, 640)
    operator.settle()
    assert button.shown_words() == words and button.isEnabled() and not button.toolTip()


def test_numbers_change_four_times_a_second_at_most(window):
    window._numbers._next = None
    window.show_view(VIEW)
    window.show_view(replace(VIEW, linear_mps=0.5))
    assert window.hud.lines[0].startswith('0.31 m/s')
    window.show_view(replace(VIEW, linear_mps=0.5, link=views.SILENT, age_s=1.2))
    assert window.link_label.text() == 'silent 1.2 s', 'a state never waits'
    window.show_view(replace(VIEW, linear_mps=0.4))
    window.show_view(replace(VIEW, linear_mps=0.0, angular_rad_s=0.0, proof=CONFIRMED))
    assert window.hud.lines[0].startswith('0.00 m/s'), 'beside "stopped" stands no older speed'


def test_no_dead_controls(window):
    assert not any(part.isVisible() for part in (
        window.view('imu'), window.view('rgb'), window.view('scan'), window.recording,
        window.switches, window.stop_button))
    assert window.wanted() == set() and window.motion_page.isVisible()


def test_a_torn_off_window_closes_by_its_frame_and_not_by_escape(window, operator, heard):
    frame = operator.show(TornOff(window))
    closed = heard(frame.closed)
    operator.hit(frame, Qt.Key_Escape)
    assert frame.isVisible() and closed == []
    frame.close()
    assert closed == ['bot1'] and not frame.isVisible()
    frame.give_back()
    assert window.parentWidget() is None and not window.torn_off


def test_a_click_looks_and_a_double_click_drives(window, operator, heard):
    window.offer({'rgb'})
    clicked, driven = heard(window.clicked), heard(window.drive_requested)
    operator.settle()
    picture = window.view('rgb').picture
    operator.click(picture)
    assert (clicked, driven) == (['bot1'], [])
    QTest.mousePress(picture, Qt.LeftButton)
    QTest.mouseDClick(picture, Qt.LeftButton)
    assert driven == ['bot1']


def test_a_double_click_that_began_beside_the_tile_drives_nobody(window, operator, heard):
    driven = heard(window.drive_requested)
    operator.click(operator.show(QWidget()))
    QTest.mouseDClick(window, Qt.LeftButton)
    assert driven == []


def test_a_small_tile_shows_its_picture_alone_and_a_tiny_one_its_name(window, operator):
    window.offer({'rgb', 'scan', 'imu', 'record'})
    window.switches.choose({'rgb', 'scan', 'imu'})
    operator.settle()
    assert window.wanted() == {'rgb', 'scan', 'imu'}
    window.show_large(False)
    assert window.wanted() == {'rgb'} and not window.views_button.isVisible()
    stage = operator.show(QWidget())
    window.setParent(stage)
    window.setGeometry(0, 0, 200, window.header.height() + 10)
    window.show()
    operator.settle()
    assert window.wanted() == set() and window.name_label.isVisible()
    window.show_large(True)
    assert window.wanted() == {'rgb', 'scan', 'imu'}


def test_the_header_lies_on_the_picture_where_that_is_all(window, operator):
    window.offer({'rgb', 'scan', 'imu'})
    operator.settle()
    for views_over_it in ({'rgb'}, {'rgb', 'scan'}):
        window.switches.choose(views_over_it)
        operator.settle()
        assert window.view('rgb').mapTo(window, window.rect().topLeft()).y() <= 4
    window.switches.choose({'rgb', 'imu'})
    operator.settle()
    assert window.view('rgb').mapTo(window, window.rect().topLeft()).y() >= window.header.height()


@pytest.mark.parametrize('views_over_it', [{'depth'}, {'depth', 'imu'}])
def test_what_is_written_on_the_picture_begins_below_the_header(window, operator, views_over_it):
    window.offer({'depth', 'imu'})
    window.resize(900, 640)
    window.switches.choose(views_over_it)
    operator.settle()
    depth = np.full((48, 64), 2.0, np.float32)
    rgb, depth_range_m = DepthColour((1.0, 3.0)).colour(depth, 0.0)
    picture = window.view('depth').picture
    window.view('depth').show_frame(
        Frame(DEPTH, np.ascontiguousarray(rgb), depth, (64, 48), depth_range_m))
    operator.settle()
    image, target = picture.grab().toImage(), picture.target().toRect()
    below = window.header.geometry().bottom() - picture.mapTo(window, QPoint(0, 0)).y()
    beside, middle = range(picture.room().right() + 1, picture.width()), target.center().x()
    ground = image.pixelColor(picture.width() - 1, 0)
    scale = next(y for y in range(picture.height())
                 if any(image.pixelColor(x, y) != ground for x in beside))
    assert below < scale <= max(below, 0) + 2 * picture.fontMetrics().height()
    picture.show_warning('OLD PICTURE, 2.3 s')
    operator.settle()
    image, ink = picture.grab().toImage(), theme.colour(theme.ATTENTION, picture.palette())
    first = next(y for y in range(picture.height()) if image.pixelColor(middle, y) == ink)
    assert first == max(target.top(), below + 1)


def test_the_header_says_what_is_recorded(window, operator):
    header, rec = window.header, window.header.rec_label

    def shown():
        operator.settle()
        assert not rec.isVisible() or rec.shown_text() == rec.text(), 'cut off'
        return rec.text() if rec.isVisible() else ''
    window.resize(1200, 700)
    own = RecordingStatus(RECORDING, duration_s=31.0)
    header.show_recording(None)
    assert shown() == ''
    header.show_session(252.0)
    assert shown() == 'REC 04:12'
    header.show_recording(own)
    assert shown() == 'REC 04:12 + 00:31'
    window.show_large(False)
    assert shown() == 'REC'
    window.show_large(True)
    header.show_session(3600.0)
    assert shown() == 'REC 1:00:00 + 00:31'
    header.show_session(None)
    assert shown() == 'REC 00:31'
    header.show_recording(None)
    assert shown() == ''
    header.show_replay()
    header.show_session(252.0)
    assert shown() == 'REPLAY'


def test_the_numbers_of_a_robot_that_says_nothing():
    assert hud_lines(RobotView('bot1')) == []


@pytest.mark.parametrize('changes', [
    {}, {'linear_mps': -0.2}, {'linear_mps': 0.0, 'angular_rad_s': 1.0},
    {'heading_rad': None}, {'x_m': None, 'heading_rad': None, 'linear_mps': None},
    {'linear_mps': float('nan'), 'heading_rad': float('inf'), 'x_m': float('nan')},
    {'max_linear_mps': None, 'angular_rad_s': 50.0},
])
def test_the_dial_draws_whatever_it_is_given(operator, ui_dir, changes):
    window = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    for place in range(30):
        window.dial.show_view(replace(VIEW, x_m=0.1 * place))
    window.dial.show_view(replace(VIEW, **changes))
    operator.show(window)
    assert not window.dial.grab().isNull()
