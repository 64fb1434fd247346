# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's window: which class, what it shows, and that one never wonders which robot moves."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest

from mhri.core.screen import views
from mhri.core.screen.views import ProofView, RobotView
from mhri.gui.screen.geometry import geometry_of, restore_geometry
from mhri.gui.screen import theme
from mhri.gui.screen.bot_window import BotWindow
from mhri.gui.screen.windows import TurtleBotWindow, window_class

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
def test_title_edge_and_pill_say_whether_it_is_driven(window, changes, stop_all, state):
    window.show_view(replace(VIEW, **changes), stop_all)
    assert window.windowTitle() == 'bot1 - {}'.format(state)
    assert window.drive_state == state and window.pill.word == state


def test_the_edge_is_painted(window, operator):
    for driven, name in ((True, theme.DRIVE), (False, None)):
        window.show_view(replace(VIEW, driven=driven))
        operator.settle()
        pixel = window.grab().toImage().pixelColor(4, window.height() // 2)
        assert (pixel == theme.colour(theme.DRIVE, window.palette())) == (name is not None)


def test_the_header_line(window):
    window._numbers._next = None
    window.show_view(VIEW)
    assert window.name_label.text() == 'bot1' and window.type_label.text() == 'TurtleBot2'
    assert window.link_sign.sign == (theme.DISC, theme.LIVE)
    assert [label.text() for label in (window.link_label, window.speed_label,
                                       window.heading_label, window.battery_label)] == [
        'live 12 ms', '0.31 m/s', 'heading 47 deg', '82 %']
    assert [label.text() for label in (window.x_value, window.y_value, window.turn_value,
                                       window.max_linear_value, window.max_angular_value)] == [
        'x 1.25 m', 'y -0.40 m', 'left 0.20 rad/s', '0.65 m/s', '3.14 rad/s']


@pytest.mark.parametrize('changes, shape, text', [
    ({}, None, ''),
    ({'link': views.SILENT, 'note': 'nothing for 3.2 s'}, theme.TRIANGLE, 'nothing for 3.2 s'),
    ({'link': views.GONE, 'note': 'master lost it'}, theme.CROSSED_SQUARE, 'master lost it'),
    ({'slow': True, 'note': 'centre the stick: it was out of reach'}, theme.TRIANGLE,
     'centre the stick: it was out of reach'),
    ({'proof': CONFIRMED}, theme.TICK, 'stopped in 180 ms'),
    ({'link': views.GONE, 'proof': ProofView(views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED')},
     theme.OCTAGON, 'NOT CONFIRMED'),
])
def test_the_sentence(window, changes, shape, text):
    window.show_view(replace(VIEW, **changes))
    sign = window.sentence_sign.sign
    assert (sign and sign[0], window.sentence_label.text()) == (shape, text)


def test_a_sentence_has_the_room_of_the_place_and_then_fewer_words(window, operator):
    for width, text in ((930, 'centre the stick: it was out of reach'), (640, 'centre the stick')):
        window.resize(width, 540)
        window.show_view(VIEW)
        operator.settle()
        assert window.pose_label.isVisible() == (width == 930)
        window.show_view(replace(VIEW, slow=True, note='centre the stick: it was out of reach'))
        operator.settle()
        assert window.sentence_label.shown_text() == text and not window.pose_label.isVisible()
        window.show_view(replace(VIEW, proof=ProofView(
            views.PROOF_NOT_CONFIRMED, 'NOT CONFIRMED: it cannot be heard')))
        operator.settle()
        assert window.sentence_label.shown_text().startswith('NOT CONFIRMED')


def test_stop_acts_on_press_and_again_while_stopped(window, heard):
    asked = heard(window.stop_requested)
    QTest.mousePress(window.stop_button, Qt.LeftButton)
    window.show_view(VIEW, stop_all=True)
    QTest.mouseRelease(window.stop_button, Qt.LeftButton)
    assert asked == [()] and window.stop_button.text().startswith('STOP ALL in force')
    QTest.mousePress(window.stop_button, Qt.LeftButton)
    assert len(asked) == 2


def test_numbers_change_four_times_a_second_at_most(window):
    window._numbers._next = None
    window.show_view(VIEW)
    window.show_view(replace(VIEW, linear_mps=0.5))
    assert window.speed_label.text() == '0.31 m/s'
    window.show_view(replace(VIEW, linear_mps=0.5, link=views.SILENT, age_s=1.2))
    assert window.link_label.text() == 'silent 1.2 s', 'a state never waits'


def test_no_dead_controls(window):
    assert not any(part.isVisible() for part in (
        window.view('imu'), window.view('rgb'), window.view('scan'), window.recording, window.switches))
    assert window.wanted() == set() and window.motion_page.isVisible()


def test_escape_keeps_it_and_closing_is_told(window, operator, heard):
    closed = heard(window.closed)
    operator.hit(window, Qt.Key_Escape)
    assert window.isVisible() and closed == []
    window.close()
    assert closed == ['bot1'] and not window.isVisible()


def test_its_place_is_remembered(operator, ui_dir):
    first = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    first.setGeometry(120, 90, 800, 560)
    operator.show(first)
    second = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    assert restore_geometry(second, geometry_of(first))
    operator.show(second)
    assert second.geometry() == first.geometry()


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
