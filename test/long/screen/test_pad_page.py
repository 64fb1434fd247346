# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A pad is calibrated on the screen: a virtual one of SDL, in a process of its own, real clicks."""
from dataclasses import replace
import os

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.part import SETUP
from mhri.base.views import DeviceView, ScreenView
from mhri.devices.calibration_page import CalibrationView
from mhri.devices.gui.pad_calibration import NO_PAD, PadCalibration
from mhri.devices.io import child
from mhri.devices.presenters import pad_presenter
from mhri.devices.profile import parse_profile
from mhri.screen.gui.screen import ScreenWidget
from support.ros_system import child_processes, wait_for
from support.virtual_pad import missing, pad_command, PadClient

NO_PADS = missing()
TIMEOUT_S = 40.0


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
        return ScreenView(stop_all=self.stopped, stop_taken=self.stopped, mode='ps3joy',
                          devices=(DeviceView('ps3joy', 'Lab rat pad', '', 'pad'),))


class Desk:
    """An operator, a screen, and a pad that is plugged into the process that reads it."""

    def __init__(self, folder, ui_dir, operator):
        self.robots, self.hands = Robots(), operator
        self.screen = ScreenWidget(ui_dir)
        self.screen.resize(1280, 720)
        self.socket = str(folder / 'socket')
        self.presenter = pad_presenter.PadPresenter(self.robots, self.screen)
        self.page = self.presenter.page
        operator.show(self.screen)
        self.pads = None

    def until(self, condition, what):
        def turn():
            self.presenter.show_view(self.robots.view())
            QApplication.processEvents()
            return condition()
        wait_for(turn, TIMEOUT_S, what)

    def turn(self):
        """Turn to the page."""
        tabs = self.screen.tabs
        self.hands.click(tabs, tabs.tabRect(tabs.count() - 1).center())
        if not self.page.isVisible():
            self.hands.click(self.screen.findChild(QWidget, 'fold_pad_page'))
        self.until(self.page.isVisible, 'the page')

    def open(self):
        """Turn to the page, and have the process there."""
        self.turn()
        self.until(lambda: os.path.exists(self.socket), 'the process')
        self.pads = PadClient(self.socket)

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
        self.presenter.close()
        self.screen.close()


@pytest.fixture
def desk(tmp_path, ui_dir, operator, monkeypatch):
    monkeypatch.setattr(pad_presenter, 'own_folder', lambda: str(tmp_path / 'pads'))
    monkeypatch.setattr(pad_presenter, 'RESTART_MS', 10)
    monkeypatch.setattr(child, 'command',
                        lambda *words: pad_command(str(tmp_path / 'socket'), *words))
    made = Desk(tmp_path, ui_dir, operator)
    yield made
    made.close()


def reading():
    """Return the processes that read the pad."""
    return child_processes('pad_stream')


needs_pads = pytest.mark.skipif(bool(NO_PADS), reason=str(NO_PADS))


def begin(desk):
    """Go to the first question."""
    desk.open()
    desk.plug()
    desk.press('Stop all and calibrate')
    assert desk.robots.asked == ['joy', 'stop']
    desk.robots.stopped = True
    desk.asks('let go of everything')


@needs_pads
def test_from_a_pad_to_its_profile(desk, tmp_path):
    """The pad is read only while the page is in sight."""
    assert reading() == []
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
    desk.screen.tabs.setCurrentIndex(0)
    assert reading() == []
    assert desk.page.title.text() == NO_PAD


@needs_pads
def test_a_process_that_cannot_start_or_ends_is_started_again(desk, monkeypatch):
    failed = []
    with monkeypatch.context() as short:
        short.setattr(child, 'command', lambda *words: failed.append(0) or ['/nonexistent/python3'])
        desk.turn()
        desk.until(lambda: len(failed) > 1, 'a second try')
    desk.open()
    desk.plug()
    reader, = reading()
    os.remove(desk.socket)
    reader.kill()
    desk.until(lambda: os.path.exists(desk.socket), 'another process')


FULL = CalibrationView('Pad', (0.0,), (0,), action='None', step=4)


def test_enter_is_the_large_button_and_never_drives(operator, heard, ui_dir, application):
    screen = ScreenWidget(ui_dir)
    application.installEventFilter(screen.drive_keys)
    page = PadCalibration()
    screen.arrangement.add_section(SETUP, 'Pad', page)
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
