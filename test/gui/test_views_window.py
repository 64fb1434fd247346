# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The views of a tile: chosen by click and key, asked for only while they are seen."""
import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton

from mhri.driving.gui.drive_keys import DriveKeys
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


@pytest.mark.parametrize('offered, wanted, seen', [
    (ALL, {'rgb'}, set()),
    ({'imu', 'record'}, set(), {'motion_page'}),
    ({'depth'}, set(), {'motion_page'}),
    ((), set(), {'motion_page'}),
])
def test_at_first(operator, ui_dir, offered, wanted, seen):
    window = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    window.offer(offered)
    operator.show(window)
    assert window.wanted() == wanted
    assert {name for name in ('recording', 'switches', 'motion_page')
            if getattr(window, name).isVisible()} == seen
    assert window.view('rgb').isVisible() == ('rgb' in wanted)


@pytest.mark.parametrize('clicks, wanted', [
    (['view_imu'], {'rgb'}),
    (['camera_depth'], {'imu', 'depth'}),
    (['camera_depth', 'camera_rgb'], {'imu', 'rgb'}),
    (['camera_off', 'view_scan'], {'imu', 'scan'}),
    (['camera_off', 'view_imu'], set()),
    (['camera_rgb'], {'imu', 'rgb'}),
])
def test_clicks(window, operator, heard, clicks, wanted):
    changed = heard(window.views_changed)
    for name in clicks:
        operator.click(window.findChild(QAbstractButton, name))
    assert window.wanted() == wanted
    assert len(changed) == (0 if clicks == ['camera_rgb'] else len(clicks))
    assert window.motion_page.isVisible() == (not wanted)
    if wanted & {'rgb', 'depth'}:
        assert wanted & {'rgb', 'depth'} == {window.view('rgb').kind}
    for key, part in (('imu', window.view('imu')), ('scan', window.view('scan'))):
        assert part.isVisible() == (key in wanted)


def test_every_switch_is_reached_and_set_with_the_keyboard(window, operator):
    window.switches.cameras['rgb'].setFocus()
    operator.hit(window.switches.cameras['rgb'], Qt.Key_Right)
    assert window.wanted() == {'depth', 'imu'}
    for key in ('cloud', 'scan', 'imu'):
        QTest.keyClick(window, Qt.Key_Tab)
        operator.wait_until(window.switches.checks[key].hasFocus)
        operator.hit(window.switches.checks[key], Qt.Key_Space)
    assert window.wanted() == {'depth', 'cloud', 'scan'}


def test_a_click_leaves_the_keyboard_to_the_drive_keys(window, operator, application, panel):
    keys = panel.drive_keys
    assert isinstance(keys, DriveKeys)
    operator.show(window)
    for name in ('imu', 'scan'):
        operator.click(window.switches.checks[name])
    operator.click(window.switches.cameras['depth'])
    operator.press(window, Qt.Key_Up)
    assert keys.deflection() == (1.0, 0.0)
    operator.release(window, Qt.Key_Up)


def test_a_hidden_or_minimised_window_wants_nothing(window, operator, heard):
    changed = heard(window.views_changed)
    window.hide()
    assert window.wanted() == set() and len(changed) == 1
    window.show()
    assert window.wanted() == {'imu', 'rgb'} and len(changed) == 2
    window.setWindowState(Qt.WindowMinimized)
    operator.wait_until(lambda: window.wanted() == set())
    window.setWindowState(Qt.WindowNoState)
    operator.wait_until(lambda: window.wanted() == {'imu', 'rgb'})


def test_what_is_not_on_offer_for_a_while_comes_back(window, heard):
    changed = heard(window.views_changed)
    window.offer({'imu'})
    assert window.wanted() == {'imu'}
    window.offer({'imu'})
    assert len(changed) == 1
    window.offer(ALL)
    assert window.wanted() == {'imu', 'rgb'} and window.view('rgb').kind == 'rgb'


def test_settings_come_back(window, operator, ui_dir):
    operator.click(window.switches.cameras['depth'])
    operator.click(window.switches.checks['scan'])
    window.view('imu').window_combo.setCurrentIndex(0)
    sizes = [300, 200, window.views_splitter.width() - 524]
    window.views_splitter.setSizes(sizes)
    kept = window.save_settings()
    other = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    other.restore_settings(kept)
    other.offer(ALL)
    other.resize(window.size())
    operator.show(other)
    assert other.wanted() == {'imu', 'depth', 'scan'} and other.view('imu').window_s == 5
    assert other.views_splitter.sizes() == window.views_splitter.sizes()


@pytest.mark.parametrize('settings', [
    {}, {'views': []},
    {'views': ['gone', 'rgb', 'depth'], 'splitter': [1, 2], 'of_views': {'arm': {}}}])
def test_settings_of_another_version_do_no_harm(window, settings):
    window.restore_settings(settings)
    assert window.wanted() <= {'imu', 'rgb'}


@pytest.mark.parametrize('size', [(760, 520), (1024, 600), (1600, 1100)])
@pytest.mark.parametrize('chosen', [
    {'imu', 'rgb'}, {'imu', 'depth', 'scan'}, {'rgb'}, {'scan'}, {'imu'}, set()])
def test_everything_fits(window, operator, size, chosen):
    window.switches.choose(chosen)
    window.resize(*size)
    operator.settle()
    assert (window.width(), window.height()) == size
    width, height = window.camera_size()
    if chosen & {'rgb', 'depth'}:
        assert width >= 120 and height >= 120
    assert window.hud.geometry().bottom() <= window.height()


def test_no_control_is_too_small_for_a_finger(window, operator):
    operator.settle()
    for button in (*window.switches.checks.values(), *window.switches.cameras.values(),
                   window.view('imu').quantity_combo, window.view('imu').window_combo,
                   window.view('imu').pause_button, window.view('rgb').transport_combo,
                   window.view('rgb').still_button, window.recording.record_check,
                   window.recording.path_edit, window.recording.browse_button,
                   window.recording.extras_button):
        assert button.height() >= 36 and button.width() >= 36, button.objectName()
