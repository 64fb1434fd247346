# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The digit drives the robot that bears it, whatever came, went or was started again meanwhile."""
import json
import subprocess
import types

import pytest
from python_qt_binding.QtWidgets import QApplication

from mhri.screen.presenters.settings_file import SettingsFile
from mhri.standalone import Standalone
from support.ros_system import wait_for


def xdotool(*words):
    subprocess.run(('xdotool',) + words, check=True, timeout=30)


def until(condition, what):
    """Let Qt work until a condition comes true."""
    wait_for(lambda: (QApplication.processEvents(), condition())[-1], 30, what)


def found(*names):
    """What a look around brings home, in no good order."""
    return types.SimpleNamespace(live=[types.SimpleNamespace(name=name) for name in names],
                                 facts=dict.fromkeys(names), leftovers=(), refused=())


class Screen:
    """A person at the keyboard of the program; no master is there."""

    def __init__(self, path, operator, afresh=False):
        self.program = Standalone(['panel'], path)
        self.program.restore(afresh=afresh)
        self.host, self.hands = self.program.host, operator
        self.panel = self.host.screen
        QApplication.instance().installEventFilter(self.panel.drive_keys)
        self.program.window.show()
        self.window = str(int(self.program.window.winId()))
        self.host.draw()

    def look(self, *names):
        self.host._show_found(found(*names))
        self.until_listed(*names)

    def until_listed(self, *names):
        until(lambda: (self.host.draw(), set(names) <= set(self.robots))[-1], 'the robots')

    @property
    def robots(self):
        """The rows, in order: {name: number on show}."""
        rows = sorted((self.panel.robot_list.row(robot.name)
                       for robot in self.host.operator.view().robots), key=lambda row: row.y())
        return {row.name: row.number.text() for row in rows}

    def remove(self, name):
        self.hands.click(self.panel.robot_list.row(name))
        self.hands.click(self.panel.remove_button)
        assert name not in self.robots

    def press(self, digit):
        """Press a key of the X server's own keyboard; return who is checked then."""
        until(lambda: (xdotool('windowfocus', self.window), self.program.window.isActiveWindow())
              [-1], 'the keyboard')
        pressed = []
        self.panel.drive_keys.robot_pressed.connect(pressed.append)
        xdotool('key', digit)
        until(lambda: pressed == [int(digit)], 'the key ' + digit)
        self.panel.drive_keys.robot_pressed.disconnect(pressed.append)
        return self.host.operator.selection.selected

    def close(self):
        self.program.window.close()
        QApplication.instance().removeEventFilter(self.panel.drive_keys)


@pytest.fixture
def start(tmp_path, operator):
    """Start the program, as often as is wanted, with one file of settings."""
    running = []

    def _start(**options):
        for screen in running:
            screen.close()
        running[:] = [Screen(str(tmp_path / 'panel.json'), operator, **options)]
        return running[0]
    yield _start
    for screen in running:
        screen.close()


def test_the_second_key_is_that_of_bot2(start):
    """It was bot10's, since that comes second by its letters."""
    screen = start()
    screen.look('bot1', 'bot10', 'bot2')
    assert screen.robots == {'bot1': '1', 'bot2': '2', 'bot10': '3'}
    assert screen.press('2') == ('bot2',)
    assert screen.press('3') == ('bot2', 'bot10')
    assert screen.press('2') == ('bot10',)


def test_after_remove_and_look_a_key_means_the_same_robot(start):
    screen = start()
    screen.look('bot1', 'bot2', 'bot3')
    screen.remove('bot2')
    assert screen.robots == {'bot1': '1', 'bot3': '3'}
    assert screen.press('2') == (), 'nobody bears it now'
    assert screen.press('3') == ('bot3',)
    screen.look('bot0')
    screen.look('bot2')
    assert screen.robots == {'bot1': '1', 'bot2': '2', 'bot3': '3', 'bot0': '4'}
    assert screen.press('2') == ('bot2', 'bot3')


def test_after_a_restart_a_key_means_the_same_robot(start):
    screen = start()
    screen.look('bot10', 'bot7')
    screen.look('bot1')
    screen.remove('bot7')
    screen = start()
    assert screen.robots == {'bot10': '2', 'bot1': '3'}
    screen.look('alpha', 'bot7')
    assert screen.robots == {'bot7': '1', 'bot10': '2', 'bot1': '3', 'alpha': '4'}
    assert screen.press('1') == ('bot7',)
    screen = start(afresh=True)
    assert screen.robots == {}
    screen.look('bot1', 'bot10')
    assert screen.press('2') == ('bot10',)


def test_a_program_that_is_killed_has_kept_the_numbers(start, tmp_path):
    path = tmp_path / 'panel.json'
    path.write_text(json.dumps({'state': {'mode': 'pedal'}}))
    screen = start()
    jobs = []
    screen.host.operator.do = lambda job, *arguments: jobs.append((job, arguments))
    screen.look('bot2', 'bot1')
    until(lambda: jobs, 'the settings to be written')
    for job, arguments in jobs:
        job(*arguments)
    kept = SettingsFile(str(path)).read()['state']
    assert kept == {'mode': 'pedal', 'numbers': {'bot1': 1, 'bot2': 2}}
    screen.close()
    before = path.read_bytes()
    jobs[0][0](*jobs[0][1])
    assert path.read_bytes() == before, 'nothing comes after the last word'


def test_the_tenth_robot_has_a_number_and_no_key(start):
    screen = start()
    screen.look(*('bot{}'.format(number) for number in range(1, 13)))
    assert list(screen.robots.values()) == [str(number) for number in range(1, 13)]
    assert screen.press('9') == ('bot9',)
    assert screen.press('1') == ('bot1', 'bot9')
