# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The views of a tile: chosen by click and key, asked for only while they are seen."""

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton

from mhri.screen.gui.windows import TurtleBotWindow

ALL = frozenset(('imu', 'rgb', 'depth', 'cloud', 'scan', 'record'))


@pytest.fixture
def window(operator, ui_dir):
    made = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    made.offer(ALL)
    made.switches.choose({'rgb', 'imu'})
    made.resize(900, 640)
    operator.show(made)
    operator.click(made.views_button)
    operator.settle()
    return made


@pytest.mark.parametrize('clicks, wanted', [
    (['camera_depth'], {'imu', 'depth'}),
    (['camera_off', 'view_scan'], {'imu', 'scan'}),
    (['camera_cloud', 'view_scan'], {'imu', 'cloud', 'scan'}),
    (['camera_off', 'view_imu'], set()),
    (['camera_rgb'], {'imu', 'rgb'}),
])
def test_clicks(window, operator, heard, clicks, wanted):
    changed = heard(window.views_changed)
    for name in clicks:
        operator.click(window.findChild(QAbstractButton, name))
    assert window.active_views() == wanted
    assert len(changed) == (0 if clicks == ['camera_rgb'] else len(clicks))
    assert window.motion_page.isVisible() == (not wanted)
    if wanted & {'rgb', 'depth'}:
        assert wanted & {'rgb', 'depth'} == {window.view('rgb').kind}
    for key, part in (('imu', window.view('imu')), ('scan', window.view('scan'))):
        assert part.isVisible() == (key in wanted)


def test_every_switch_is_reached_and_set_with_the_keyboard(window, operator):
    window.switches.cameras['rgb'].setFocus()
    operator.hit(window.switches.cameras['rgb'], Qt.Key_Right)
    assert window.active_views() == {'depth', 'imu'}
    operator.hit(window.switches.cameras['depth'], Qt.Key_Right)
    assert window.active_views() == {'cloud', 'imu'}
    for key in ('scan', 'imu'):
        QTest.keyClick(window, Qt.Key_Tab)
        operator.wait_until(window.switches.checks[key].hasFocus)
        operator.hit(window.switches.checks[key], Qt.Key_Space)
    assert window.active_views() == {'cloud', 'scan'}


def test_a_hidden_or_minimised_window_wants_nothing(window, operator, heard):
    changed = heard(window.views_changed)
    window.hide()
    assert window.active_views() == set() and len(changed) == 1
    window.show()
    assert window.active_views() == {'imu', 'rgb'} and len(changed) == 2
    window.setWindowState(Qt.WindowMinimized)
    operator.wait_until(lambda: window.active_views() == set())
    window.setWindowState(Qt.WindowNoState)
    operator.wait_until(lambda: window.active_views() == {'imu', 'rgb'})


def test_what_is_not_on_offer_for_a_while_comes_back(window, heard):
    changed = heard(window.views_changed)
    window.offer({'imu'})
    assert window.active_views() == {'imu'}
    window.offer({'imu'})
    assert len(changed) == 1
    window.offer(ALL)
    assert window.active_views() == {'imu', 'rgb'} and window.view('rgb').kind == 'rgb'


def test_settings_come_back(window, operator, ui_dir):
    operator.click(window.switches.cameras['depth'])
    operator.click(window.switches.checks['scan'])
    window.view('imu').window_combo.setCurrentIndex(0)
    kept = window.save_settings()
    other = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    # The key of earlier versions is ignored.
    other.restore_settings({**kept, 'splitter': [300, 200, 100]})
    other.offer(ALL)
    other.resize(window.size())
    operator.show(other)
    assert other.active_views() == {'imu', 'depth', 'scan'} and other.view('imu').window_s == 5
