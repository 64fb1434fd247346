# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A key of the X server's own keyboard, held for seconds: it is one press and one release."""
import subprocess
import time

import pytest
from python_qt_binding.QtWidgets import QApplication

from mhri.driving.gui.key_state import KeyState
from mhri.driving.gui.x_server import XServer
from support.keyboard import xdotool
from support.ros_system import wait_for

# An X server repeats a key from 0.66 s on; the power is cut after 2 s.
HELD_S = 2.6


@pytest.fixture
def down(panel):
    """Return a function that holds a key in the panel; afterwards every key is up."""
    panel.show()
    window = str(int(panel.winId()))
    pressed = []

    def press(key):
        wait_for(lambda: (xdotool('windowfocus', window), QApplication.processEvents(),
                          panel.isActiveWindow())[-1], 20, 'the keyboard', poll_s=0.05)
        pressed.append(key)
        xdotool('keydown', key)
    yield press
    for key in pressed:
        xdotool('keyup', key)


def run_for(seconds):
    """Let the program run, as busy as one that draws: what Qt reads late it misjudges."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        QApplication.processEvents()
        time.sleep(0.001)


def test_a_drive_key_that_is_held_is_never_let_go_and_a_switch_switches_once(panel, heard, down):
    moved, switched = heard(panel.stick_moved), heard(panel.drive_keys.robot_pressed)
    down('w')
    run_for(HELD_S)
    assert moved == [(1.0, 0.0, 0.0)]
    xdotool('keyup', 'w')
    wait_for(lambda: (QApplication.processEvents(), not any(moved[-1]))[-1], what='the release')
    down('1')
    run_for(HELD_S)
    assert switched == [1]


def test_the_keys_that_are_down_are_known(down):
    keys = KeyState()
    assert keys.down() == frozenset()
    down('w')
    wait_for(lambda: keys.down() == frozenset({25}), what='W')
    keys.close()
    assert keys.down() is None


def test_the_extensions_of_the_server_are_known_and_this_one_is_no_vnc():
    server = XServer()
    said = subprocess.run(('xdpyinfo',), stdout=subprocess.PIPE, check=True).stdout.decode()
    said = said.partition('extensions:')[2].partition('default screen')[0]
    assert server.extensions() == {line.strip() for line in said.splitlines()[1:]}
    server.close()
    assert KeyState().remote == ''


def test_without_an_x_server_nothing_is_known(monkeypatch):
    monkeypatch.setattr('mhri.driving.gui.key_state.QGuiApplication.platformName',
                        lambda: 'wayland')
    assert KeyState().down() is None


def test_shift_and_space_held_for_two_seconds_cut_the_power(panel, heard, down):
    stopped, cut = heard(panel.stop_requested), heard(panel.stop_bar.power_cut_requested)
    down('shift')
    down('space')
    begun = time.monotonic()
    wait_for(lambda: (run_for(0.02), cut)[-1], what='the cut')
    assert stopped
    print('MEASURED Shift+Space held: power cut within {:.1f} s'.format(time.monotonic() - begun))


def test_a_release_that_waits_behind_a_slow_view_counts(panel, heard, down):
    stopped, cut = heard(panel.stop_requested), heard(panel.stop_bar.power_cut_requested)
    down('shift')
    down('space')
    wait_for(lambda: (run_for(0.02), stopped)[-1], what='the stop')
    xdotool('keyup', 'space')
    # The thread that draws is busy: when it looks again, release and timer are both due.
    time.sleep(2.2)
    run_for(0.5)
    assert cut == []
