# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Presses of STOP as the X server tells them to another process: real clicks, real keys."""
import subprocess
import sys

import pytest
from python_qt_binding.QtCore import QEvent
from python_qt_binding.QtWidgets import QLineEdit, QScrollArea, QVBoxLayout, QWidget

from mhri.driving.gui.stop_button import (
    RobotStopButton, stop_buttons, stop_places, StopButton)
from mhri.driving.gui.x_presses import XError, XPresses
from support.keyboard import xdotool
from support.ros_system import wait_for

SCALED = '''
from python_qt_binding.QtWidgets import QApplication
from mhri.driving.gui.stop_button import stop_places, StopButton
app = QApplication(['scaled'])
button = StopButton()
button.resize(200, 100)
button.show()
print(stop_places()[int(button.winId())], flush=True)
'''


@pytest.fixture(name='presses')
def _presses():
    presses = XPresses()
    yield presses
    presses.close()


@pytest.fixture(name='window')
def _window(operator):
    """A window with a stop button that has 200 x 60 px at (40, 30), and room beside it."""
    window = QWidget()
    window.setGeometry(300, 200, 400, 300)
    window.button = StopButton(window)
    window.button.setGeometry(40, 30, 200, 60)
    operator.show(window)
    operator.settle()
    return window


def check(presses, stops):
    """Check whether what was just done by hand stops everything, once."""
    if stops:
        wait_for(lambda: presses.stops(stop_places()), 10.0, 'the press')
    # An answer of the server to somebody else: what was done before has been told by then.
    xdotool('getmouselocation')
    assert not presses.stops(stop_places())


def places_of(window):
    return stop_places()[int(window.winId())]


@pytest.mark.parametrize('x, y, stops', [
    (40, 30, True), (239, 89, True), (39, 60, False), (140, 90, False)])
def test_a_click(presses, window, x, y, stops):
    assert places_of(window) == [(40, 30, 200, 60)]
    xdotool('mousemove', 300 + x, 200 + y, 'mousedown', 1, 'mouseup', 1)
    check(presses, stops)


def test_a_press_on_the_stop_of_one_robot_counts_too_but_menus_may_cover_it(
        presses, window, operator):
    single = RobotStopButton('bot1', window)
    single.setGeometry(300, 200, 40, 40)
    single.show()
    operator.settle()
    assert stop_buttons() == [window.button]
    xdotool('mousemove', 620, 420, 'mousedown', 1, 'mouseup', 1)
    check(presses, True)


@pytest.mark.parametrize('button', [3, 4])
def test_other_buttons_do_not_count(presses, window, button):
    xdotool('mousemove', 440, 260, 'click', button)
    check(presses, False)


def test_a_window_in_front_takes_the_click(presses, window, operator):
    front = QLineEdit()
    front.setGeometry(420, 240, 100, 100)
    operator.show(front)
    front.raise_()
    operator.settle()
    xdotool('mousemove', 440, 260, 'click', 1)
    check(presses, False)
    xdotool('mousemove', 360, 260, 'click', 1)
    check(presses, True)


def test_what_cannot_be_seen_cannot_be_pressed(window, application):
    window.button.hide()
    assert places_of(window) == []
    window.button.show()
    window.hide()
    assert int(window.winId()) not in stop_places()
    window.show()
    window.button.deleteLater()
    application.sendPostedEvents(None, QEvent.DeferredDelete)
    assert places_of(window) == []


def test_scrolled_half_away(operator):
    area, content = QScrollArea(), QWidget()
    column = QVBoxLayout(content)
    column.setContentsMargins(0, 0, 0, 0)
    button = StopButton()
    button.setFixedSize(200, 100)
    column.addWidget(button)
    content.setFixedSize(200, 1000)
    column.addStretch()
    area.setWidget(content)
    area.setFrameStyle(0)
    area.resize(220, 300)
    operator.show(area)
    operator.settle()
    assert places_of(area) == [(0, 0, 200, 100)]
    area.verticalScrollBar().setValue(70)
    operator.settle()
    assert places_of(area) == [(0, 0, 200, 30)]
    area.verticalScrollBar().setValue(400)
    operator.settle()
    assert [place[3] for place in places_of(area)] == [0]


@pytest.mark.parametrize('keys, stops', [
    (('key', 'shift+space'), True),
    (('keydown', 'Shift_R', 'key', 'space', 'keyup', 'Shift_R'), True),
    (('key', 'space'), False),
    (('key', 'shift+a'), False),
    (('keydown', 'shift', 'keyup', 'shift', 'key', 'space'), False),
], ids=str)
def test_keys(presses, window, keys, stops):
    xdotool('windowfocus', '--sync', int(window.winId()))
    xdotool(*keys)
    check(presses, stops)


def test_keys_that_another_program_gets(presses, window):
    """Also where the pointer is on the button."""
    other = subprocess.Popen([sys.executable, '-c', 'from python_qt_binding.QtWidgets import *\n'
                              'app = QApplication(["other"])\nline = QLineEdit()\n'
                              'line.setWindowTitle("other")\nline.show()\napp.exec_()'])
    try:
        xdotool('search', '--sync', '--onlyvisible', '--name', '^other$', 'windowfocus', '--sync',
                'mousemove', 440, 260, 'key', 'shift+space')
        check(presses, False)
    finally:
        other.kill()
        other.wait()


def test_a_screen_of_finer_dots(presses):
    """What Qt counts in points of its own the X server counts in its dots."""
    for scale, wanted in (('2', '(0, 0, 400, 200)'), ('1.5', '(0, 0, 300, 150)')):
        said = subprocess.run(['env', 'QT_SCALE_FACTOR=' + scale, sys.executable, '-c', SCALED],
                              stdout=subprocess.PIPE, check=True, universal_newlines=True).stdout
        assert said.strip() == '[{}]'.format(wanted)


def test_no_x_server(monkeypatch):
    monkeypatch.setenv('DISPLAY', ':99999')
    with pytest.raises(XError, match='no X server answers'):
        XPresses()
