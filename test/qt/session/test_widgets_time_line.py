# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The time line below a replay: real clicks and keys ask for what they say."""
import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QLineEdit, QVBoxLayout, QWidget

from mhri.recording.folder import SessionEvent
from mhri.recording.recording import moment_text
from mhri.session.gui.replay_keys import ReplayKeys
from mhri.session.gui.time_line import NOTHING_DRIVES, PAUSE, PLAY, TimeLineBar
from mhri.session.timeline import read_time_line
from support.maps import move

START = 1.7e9


def line(time_s, kind, text, severity='info', **data):
    return SessionEvent(START + time_s, START + time_s, kind, text, severity, '', data)


LINE = read_time_line((
    line(5.0, 'selection', 'two', selected=['bot1', 'bot2']), line(10.0, 'mark', 'a door', id='m1'),
    line(20.0, 'stop', 'STOP ALL', 'warning', stop_all=True),
    line(30.0, 'stop', 'over', stop_all=False),
    line(60.0, 'lost', 'silent', 'warning')), START, 100.0)


@pytest.fixture
def bar(operator):
    widget = TimeLineBar()
    widget.resize(1000, 110)
    widget.show_time_line(LINE, {'bot1': 1, 'bot2': 2})
    widget.show_state(15.0, 1.0, False)
    return operator.show(widget)


@pytest.fixture
def keys(bar):
    watching = ReplayKeys(bar)
    QApplication.instance().installEventFilter(watching)
    yield watching
    QApplication.instance().removeEventFilter(watching)


def test_a_click_on_the_line_goes_there(bar, heard):
    asked = heard(bar.seek_requested)
    QTest.mouseClick(bar.canvas, Qt.LeftButton, Qt.NoModifier,
                     QPoint(round(bar.canvas.x_of(60.0)), 20))
    assert asked == [pytest.approx(60.0, abs=0.2)]


def test_a_drag_asks_where_it_begins_and_where_it_ends(bar, heard):
    asked, y = heard(bar.seek_requested), 20
    QTest.mousePress(bar.canvas, Qt.LeftButton, Qt.NoModifier,
                     QPoint(round(bar.canvas.x_of(20.0)), y))
    bar.canvas.show_position(15.0)
    move(bar.canvas, QPoint(round(bar.canvas.x_of(50.0)), y))
    QTest.mouseRelease(bar.canvas, Qt.LeftButton, Qt.NoModifier,
                       QPoint(round(bar.canvas.x_of(80.0)), y))
    assert asked == [pytest.approx(20.0, abs=0.2), pytest.approx(80.0, abs=0.2)]


@pytest.mark.parametrize('x, at_s', [(-50, 0.0), (5000, 100.0)])
def test_beyond_its_ends_are_its_ends(bar, heard, x, at_s):
    asked = heard(bar.seek_requested)
    QTest.mouseClick(bar.canvas, Qt.LeftButton, Qt.NoModifier, QPoint(x, 20))
    assert asked == [at_s]


@pytest.mark.parametrize('button, signal, said', [
    ('play_button', 'play_requested', True), ('next_button', 'seek_requested', 20.0),
    ('faster_button', 'speed_requested', 2.0)])
def test_each_button_asks_for_what_it_says(bar, operator, heard, button, signal, said):
    asked = heard(getattr(bar, signal))
    operator.click(getattr(bar, button))
    assert asked == [said]


@pytest.mark.parametrize('key, signal, said', [
    (Qt.Key_Space, 'play_requested', True), (Qt.Key_Right, 'seek_requested', 20.0),
    (Qt.Key_PageUp, 'seek_requested', 10.0), (Qt.Key_End, 'seek_requested', 100.0),
    (Qt.Key_Down, 'speed_requested', 0.5)])
def test_each_key_asks_for_what_it_says(bar, keys, heard, key, signal, said):
    asked = heard(getattr(bar, signal))
    QTest.keyClick(bar, key)
    assert asked == [said]


def test_keys_that_would_drive_or_stop_reach_nobody_and_play_nothing(bar, keys, heard):
    class Eager(QWidget):
        """Notes every key that it gets."""

        def __init__(self):
            super().__init__()
            self.got = []

        def keyPressEvent(self, event):  # noqa: N802
            self.got.append(event.key())
    eager, asked = Eager(), heard(bar.play_requested)
    for key in (Qt.Key_W, Qt.Key_S, Qt.Key_T, Qt.Key_1, Qt.Key_0, Qt.Key_Return, Qt.Key_R):
        QTest.keyClick(eager, key)
    QTest.keyClick(eager, Qt.Key_Space, Qt.ShiftModifier)
    QTest.keyClick(bar, Qt.Key_Space, Qt.ShiftModifier)
    assert eager.got == [Qt.Key_Shift] and asked == []
    QTest.keyClick(eager, Qt.Key_M)
    assert eager.got == [Qt.Key_Shift, Qt.Key_M], 'the map is only looked at'


def test_letters_can_be_typed_all_the_same(operator, keys):
    window = QWidget()
    field = QLineEdit(window)
    QVBoxLayout(window).addWidget(field)
    operator.show(window)
    QTest.keyClicks(field, 'was 1')
    assert field.text() == 'was 1'


def test_it_says_where_it_is_and_how_it_goes_on(bar):
    assert bar.play_button.text() == PLAY
    assert bar.clock_label.text() == moment_text(START + 15.0) + '  00:15 of 01:40'
    assert bar.tick_label.text() == '00:10 mark 1: a door'
    bar.show_state(99.0, 8.0, True)
    assert bar.play_button.text() == PAUSE and bar.speed_label.text() == '8\u00d7'
    assert not bar.faster_button.isEnabled() and not bar.next_button.isEnabled()
    assert NOTHING_DRIVES in bar.replay_label.text()


def test_a_simulated_time_is_no_time_of_day(bar):
    bar.show_time_line(read_time_line((), 512.0, 100.0), {})
    bar.show_state(15.0, 1.0, False)
    assert bar.clock_label.text() == '00:15 of 01:40'
