# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's tile: which class, what it shows, and that one never wonders which robot moves."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QWidget

from mhri.base import views
from mhri.base.gui import theme
from mhri.base.gui.pending import Pace
from mhri.base.views import ProofView, RobotView
from mhri.driving.gui.stop_bar import CUT_OFF, CUT_OFF_SHORTEST
from mhri.recording.recording import RECORDING, RecordingStatus
from mhri.screen.gui.robot_tile import RobotTile
from mhri.screen.gui.tile_header import LOOKS, TileHeader
from mhri.screen.gui.tile_layers import EDGE_PX
from mhri.screen.gui.torn_off import TornOff
from mhri.screen.gui.windows import TurtleBotWindow, window_class
from support.clock import Clock

VIEW = RobotView('bot1', 'TurtleBot2', link=views.LIVE, age_s=0.012, linear_mps=0.31,
                 angular_rad_s=0.2, heading_rad=0.82, x_m=1.25, y_m=-0.4, battery=0.82,
                 max_linear_mps=0.65, max_angular_rad_s=3.14)
CONFIRMED = ProofView(views.PROOF_STOPPED, 'stopped in 180 ms')


@pytest.fixture
def window(operator, ui_dir):
    return operator.show(TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2'))


@pytest.mark.parametrize('key, expected', [
    ('turtlebot', TurtleBotWindow), ('', RobotTile), ('hexapod', RobotTile)])
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


@pytest.mark.parametrize('changes, calm', [
    ({'proof': CONFIRMED}, True), ({}, False),
    ({'proof': ProofView(views.PROOF_WAITING, 'stopping')}, False),
    ({'proof': ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED')}, False),
    ({'proof': CONFIRMED, 'link': views.GONE}, False),
])
def test_after_a_stop_only_a_robot_that_may_move_has_an_edge_of_that_colour(window, operator,
                                                                            changes, calm):
    window.show_view(replace(VIEW, **changes), True)
    operator.settle()
    colour = window.grab().toImage().pixelColor(1, window.height() // 2)
    assert (colour != theme.colour(theme.STOP, window.header.palette())) == calm


@pytest.fixture
def fonts(application):
    """Return a function that sets how large text is."""
    usual = application.font()
    yield lambda factor: application.setFont(theme.larger(usual, factor))
    application.setFont(usual)


@pytest.mark.parametrize('font', [1.0, 2.0])
@pytest.mark.parametrize('large, widths', [
    (True, range(480, 900, 20)), (False, range(130, 480, 12))])
@pytest.mark.parametrize('name', ['bot12', 'longname_abc', 'inspection_crawler_12'])
def test_no_state_is_cut_no_usual_name_shortened_and_nothing_covers_it(
        application, operator, fonts, name, large, widths, font):
    fonts(font)
    # In a tile, which does not ask for its least size.
    host = operator.show(QWidget())
    header = TileHeader(name, 'TurtleBot2', host)
    header.show()
    header.show_large(large)
    header.show_view(replace(VIEW, name=name, number=12))
    header.show_session(100.0)
    for state in LOOKS:
        header.show_drive(state)
        for width in widths:
            header.resize(round(width * font), header.sizeHint().height())
            application.processEvents()
            name_label, pill = header.name_label, header.pill
            assert not pill.isVisible() or pill.is_whole(), (state, header.width())
            natural = theme.text_width(name_label.font(), name)
            beside = 0 if not large else header.views_button.width()
            if len(name) <= 12 and header.width() >= natural + header.number_label.width() + \
                    3 * header.fontMetrics().height() + beside:
                assert name_label.shown_text() == name, (state, header.width())
            for part in (header.number_label, pill, header.link_sign, header.link_label):
                assert not part.isVisible() or not part.geometry().intersects(
                    name_label.geometry()), (state, width)


@pytest.mark.parametrize('changes, shape, text', [
    ({}, None, ''),
    ({'link': views.SILENT, 'note': 'nothing for 3.2 s'}, theme.TRIANGLE, 'nothing for 3.2 s'),
    ({'link': views.GONE, 'note': 'switched off', 'battery': 0.12}, theme.CROSSED_SQUARE,
     'switched off'),
    ({'battery': 0.28}, theme.TRIANGLE, 'battery 28 %'),
    ({'battery': 0.12, 'slow': True, 'note': 'link 310 ms'}, theme.TRIANGLE,
     'link 310 ms; battery 12 %'),
    ({'proof': CONFIRMED}, theme.TICK, 'stopped in 180 ms'),
    ({'link': views.GONE, 'proof': ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED')},
     theme.OCTAGON, 'NOT CONFIRMED'),
])
def test_the_sentence(window, changes, shape, text):
    window.show_view(replace(VIEW, **changes))
    sign = window.hud.sign
    assert (sign and sign[0], window.hud.sentence) == (shape, text)


@pytest.mark.parametrize('large, size', [(True, (800, 640)), (True, (300, 240)),
                                         (False, (168, 126)), (False, (420, 320))])
def test_every_tile_stops_its_own_robot_on_press_and_again(window, operator, heard, large, size):
    window.show_large(large)
    window.resize(*size)
    operator.settle()
    button = window.robot_stop
    assert button.isVisible() and window.rect().contains(button.geometry())
    assert min(button.width(), button.height()) >= theme.touch_size(button)
    others = [heard(signal) for signal in (window.clicked, window.drive_requested,
                                           window.stop_requested)]
    asked = heard(window.stop_robot_requested)
    QTest.mousePress(button, Qt.LeftButton)
    assert asked == ['bot1'], 'not only on the release'
    QTest.mouseRelease(button, Qt.LeftButton)
    window.show_view(replace(VIEW, proof=CONFIRMED))
    operator.click(button)
    QTest.mouseDClick(button, Qt.LeftButton)
    assert set(asked) == {'bot1'} and len(asked) >= 3 and others == [[], [], []]
    operator.click(window, window.rect().center())
    assert others[0] == ['bot1'], 'the middle of the tile is for looking at it'


@pytest.mark.parametrize('large, size', [(True, (800, 640)), (False, (420, 320))])
def test_a_robot_of_a_recording_has_no_stop_of_its_own(window, operator, large, size):
    window.show_large(large)
    window.resize(*size)
    window.show_idle('a replay: nothing drives')
    window.show_cut_off(True)
    window.show_cut_off(False)
    operator.settle()
    assert not window.robot_stop.isVisible() and not window.robot_stop.isEnabled()
    assert not window.stop_button.isEnabled()
    assert not large or window.header.width() == window.width() - 2 * EDGE_PX


def test_stop_of_a_torn_off_tile_acts_on_press_and_again_while_stopped(window, operator, heard):
    frame = operator.show(TornOff(window))
    assert window.window() is frame
    assert window.stop_button.isVisible() and window.stop_button.height() >= 44
    asked = heard(window.stop_requested)
    QTest.mousePress(window.stop_button, Qt.LeftButton)
    window.show_view(VIEW, stop_all=True)
    QTest.mouseRelease(window.stop_button, Qt.LeftButton)
    assert asked == [()] and window.stop_button.isEnabled()
    QTest.mousePress(window.stop_button, Qt.LeftButton)
    assert len(asked) == 2


def test_a_torn_off_tile_of_a_screen_that_is_cut_off_offers_no_stop(window, operator, heard):
    """It says so as the stop bar does, and looks as that does; whatever the robot's state."""
    was_stopped = True
    frame, button = operator.show(TornOff(window)), window.stop_button
    window.show_view(VIEW, stop_all=was_stopped)
    words = button.shown_words()
    asked, clicked = heard(window.stop_requested), heard(window.clicked)
    window.show_cut_off(True)
    assert button.shown_words() == CUT_OFF and button.toolTip()
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
    assert button.shown_words() == CUT_OFF_SHORTEST
    window.show_cut_off(False)
    window.show_view(VIEW, stop_all=was_stopped)
    frame.resize(800, 640)
    operator.settle()
    assert button.shown_words() == words and button.isEnabled() and not button.toolTip()


def test_numbers_change_four_times_a_second_at_most(operator, ui_dir, monkeypatch):
    clock = Clock()
    monkeypatch.setattr('mhri.screen.gui.robot_tile.Pace', lambda: Pace(clock=clock))
    window = operator.show(TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2'))
    clock.now += 1.0
    window.show_view(VIEW)
    window.show_view(replace(VIEW, linear_mps=0.5))
    assert window.hud.lines[0].startswith('0.31 m/s')
    window.show_view(replace(VIEW, linear_mps=0.5, link=views.SILENT, age_s=1.2))
    assert window.link_label.text() == 'silent 1.2 s', 'a state never waits'
    window.show_view(replace(VIEW, linear_mps=0.4))
    window.show_view(replace(VIEW, linear_mps=0.0, angular_rad_s=0.0, proof=CONFIRMED))
    assert window.hud.lines[0].startswith('0.00 m/s'), 'beside "stopped" stands no older speed'


def test_a_torn_off_window_closes_by_its_frame_and_not_by_escape(window, operator, heard):
    frame = operator.show(TornOff(window))
    closed, asked = heard(frame.closed), heard(window.tear_requested)
    operator.click(window.tear_button)
    assert asked == ['bot1'] and 'bot1' in frame.windowTitle()
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
    assert window.active_views() == {'rgb', 'scan', 'imu'}
    window.show_large(False)
    assert window.active_views() == {'rgb'} and not window.views_button.isVisible()
    stage = operator.show(QWidget())
    window.setParent(stage)
    window.setGeometry(0, 0, 200, window.header.height() + 10)
    window.show()
    operator.settle()
    assert window.active_views() == set() and window.name_label.isVisible()
    window.show_large(True)
    assert window.active_views() == {'rgb'}, 'no room for more'
    window.setGeometry(0, 0, 760, 560)
    assert window.active_views() == {'rgb', 'scan', 'imu'}
    window.offer({'rgb', 'cloud'})
    window.switches.choose({'cloud'})
    assert window.active_views() == {'cloud'}
    window.show_large(False)
    assert window.active_views() == {'rgb'}, 'a small tile is looked at in glances'


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
