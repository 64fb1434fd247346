# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A pad is calibrated on the screen: a virtual one of SDL, in a process of its own, real clicks."""
from dataclasses import replace
import os
import sys

import pytest
from python_qt_binding.QtCore import QProcess, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.views import DeviceView, PanelView  # noqa: E402
from mhri.devices.calibration_page import CalibrationView  # noqa: E402
from mhri.devices.gui.pad_calibration import NO_PAD, PadCalibration  # noqa: E402
from mhri.devices.presenters import pad_host  # noqa: E402
from mhri.devices.profile import parse_profile  # noqa: E402
from mhri.screen.gui.screen import ScreenWidget  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.virtual_pad import missing, pad_command, PadClient  # noqa: E402

NO_PADS = missing()
PATIENCE_S = 40.0


class Robots:
    """Stands in for the ROS side: what the page asks of it, and its workers."""

    def __init__(self):
        self.asked = []
        self.stopped = False

    def stop_all(self):
        self.asked.append('stop')

    def request_mode(self, name):
        self.asked.append(name)

    @staticmethod
    def do(job, *arguments):
        job(*arguments)

    def view(self):
        return PanelView(stop_all=self.stopped, stop_taken=self.stopped, mode='ps3joy',
                         devices=(DeviceView('ps3joy', 'Lab rat pad', '', 'pad'),))


class Desk:
    """An operator, a screen, and a pad that is plugged into the process that reads it."""

    def __init__(self, folder, ui_dir, operator):
        self.robots, self.hands = Robots(), operator
        self.screen = ScreenWidget(ui_dir)
        self.screen.resize(1280, 720)
        path = str(folder / 'socket')
        self.host = pad_host.PadHost(self.robots, self.screen,
                                     pad_command(path, 'mhri.devices.io.pad_stream'))
        self.page = self.host.page
        operator.show(self.screen)
        self.pads = None
        self._path = path

    def until(self, condition, what):
        def turn():
            self.host.show_view(self.robots.view())
            QApplication.processEvents()
            return condition()
        wait_for(turn, PATIENCE_S, what)

    def turn(self):
        """Turn to the page."""
        titles = [self.screen.tabs.tabText(index) for index in range(self.screen.tabs.count())]
        self.hands.click(self.screen.tabs, self.screen.tabs.tabRect(
            titles.index(pad_host.TITLE)).center())
        self.until(self.page.isVisible, 'the page')

    def open(self):
        """Turn to the page, and have the process there."""
        self.turn()
        self.until(lambda: os.path.exists(self._path), 'the process')
        self.pads = PadClient(self._path)

    def plug(self, name='Lab rat pad'):
        self.number = self.pads.do('attach', name=name, vendor=0x1209)
        self.until(lambda: self.page.title.text() == name, 'the pad')

    def move(self, **state):
        self.pads.do('set', number=self.number, **state)

    def press(self, words):
        """Click the large button, which has to say so."""
        self.until(lambda: self.page.action_button.text() == words, words)
        self.hands.click(self.page.action_button)

    def asks(self, words):
        self.until(lambda: words in self.page.prompt.text(), words)

    def sees(self, words):
        self.until(lambda: self.page.picture.seen() == words, words or 'nothing pressed')

    def push(self, axis, value):
        """Push an axis until the picture shows it, and let go."""
        self.move(axes={axis: value})
        self.sees('axis {}'.format(axis))
        self.move(axes={axis: 0.0})

    def click_button(self, number):
        self.move(buttons={number: 1})
        self.sees('button {}'.format(number))
        self.move(buttons={number: 0})

    def close(self):
        if self.pads:
            self.pads.close()
        self.host.close()
        self.screen.close()


@pytest.fixture
def desk(tmp_path, ui_dir, operator, monkeypatch):
    monkeypatch.setattr(pad_host, 'own_folder', lambda: str(tmp_path / 'pads'))
    made = Desk(tmp_path, ui_dir, operator)
    yield made
    made.close()


needs_pads = pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))


def begin(desk):
    """Go to the first question."""
    desk.open()
    desk.plug()
    desk.press('Stop all and calibrate')
    assert desk.robots.asked == ['joy', 'stop'], 'nothing drives by the pad, and nothing drives'
    assert desk.page.prompt.text().startswith('Stopping')
    desk.robots.stopped = True
    desk.asks('let go of everything')


@needs_pads
def test_from_a_pad_to_its_profile(desk, tmp_path):
    begin(desk)
    desk.move(axes={0: 0.0, 1: 0.0, 2: 0.0, 3: 0.0})
    desk.press('Next')
    desk.asks('FORWARD')
    desk.push(3, 1.0)
    desk.asks('LEFT')
    desk.push(2, -1.0)
    desk.asks('dead-man')
    desk.click_button(6)
    desk.asks('full speed')
    desk.press('None')
    desk.asks('stops all')
    desk.click_button(1)
    for words in ('next robot', 'previous robot', 'selects all'):
        desk.asks(words)
        desk.press('None')
    assert dict(desk.page.picture.words()) == {
        'axis 2': 'turn', 'axis 3': 'forward', 'button 6': 'dead-man', 'button 1': 'stop all'}
    path = tmp_path / 'pads' / 'lab_rat_pad.yaml'
    assert not path.exists()
    desk.press('Save')
    desk.asks('Saved: {}'.format(path))
    profile = parse_profile(path.read_text(), str(path))
    assert (profile.name, profile.forward.index, profile.turn.index) == ('lab_rat_pad', 3, 2)
    assert (profile.dead_man, profile.actions) == (6, ((1, 'stop_all'),))
    assert len(profile.match.guids) == 1


@needs_pads
def test_a_pad_that_is_pulled_and_robots_that_are_released_end_it(desk, tmp_path):
    begin(desk)
    desk.robots.stopped = False
    desk.until(lambda: 'released' in desk.page.problem.text(), 'the end')
    desk.robots.stopped = True
    desk.press('Calibrate')
    desk.asks('let go of everything')
    desk.pads.do('detach', number=desk.number)
    desk.until(lambda: desk.page.title.text() == NO_PAD and desk.page.problem.text(), 'the loss')
    desk.plug('Another pad')
    desk.press('Calibrate')
    desk.asks('let go of everything')
    assert not (tmp_path / 'pads').exists()


@needs_pads
def test_the_pad_is_read_only_while_the_page_is_in_sight(desk):
    assert desk.host._reader.state() == QProcess.NotRunning
    desk.open()
    desk.plug()
    desk.screen.tabs.setCurrentIndex(0)
    desk.until(lambda: desk.host._reader.state() == QProcess.NotRunning, 'the end of the reading')
    assert desk.page.title.text() == NO_PAD


@needs_pads
def test_a_process_that_cannot_start_is_tried_again(desk, heard):
    failed = heard(desk.host._reader.errorOccurred)
    desk.host._restart_timer.setInterval(10)
    program, desk.host._program = desk.host._program, ['/nonexistent/python3']
    desk.turn()
    desk.until(lambda: len(failed) > 1, 'a second try')
    desk.host._program = program
    desk.open()
    desk.plug()


FULL = CalibrationView('Logitech Gamepad F710', (0.4, None, -1.0, 1.0), (0, 1, 0),
                       ((0, 'turn'), (3, 'forward')), ((1, 'dead-man'),),
                       'Press the button.', 'Only one, please.', 'None', 4, 9, True)


def test_what_is_on_show(operator):
    page = PadCalibration()
    page.resize(420, 640)
    operator.show(page)
    page.show_calibration(replace(FULL, axes=(0.0, None, -1.0, 0.0)))
    page.show_calibration(FULL)
    operator.settle()
    assert page.title.text() == 'Logitech Gamepad F710' and page.progress.text() == '4 of 9'
    assert page.problem_sign.sign is not None and page.problem.text() == 'Only one, please.'
    assert page.picture.seen() == 'axis 3, button 1', 'a trigger rests at its end'
    assert page.picture.accessibleDescription() == page.picture.seen()
    whole = page.picture.grab().toImage()
    page.show_calibration(CalibrationView('x', (0.4, None, -1.0, 0.0), (0, 0, 0)))
    operator.settle()
    assert page.picture.grab().toImage() != whole and page.progress.text() == ''


def test_enter_is_the_large_button_and_never_drives(operator, heard, ui_dir, application):
    screen = ScreenWidget(ui_dir)
    application.installEventFilter(screen.drive_keys)
    page = PadCalibration()
    screen.arrangement.add_page('Pad', page)
    operator.show(screen)
    screen.arrangement.show_page(page)
    operator.settle()
    pressed, driven = heard(page.confirmed), heard(screen.drive_keys.drive_pressed)
    for view, presses in ((FULL, 1), (replace(FULL, action=''), 1), (FULL, 2)):
        page.show_calibration(view)
        operator.settle()
        QTest.keyClick(QApplication.focusWidget(), Qt.Key_Return)
        assert len(pressed) == presses
    assert driven == []
    application.removeEventFilter(screen.drive_keys)
