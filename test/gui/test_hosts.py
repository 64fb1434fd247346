# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The two hosts of the panel: what they keep between runs, and how they end."""
import json

import pytest
from python_qt_binding.QtCore import QPoint, QRect
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui import geometry
from mhri.base.views import ROS_CONNECTED, ROS_CUT_OFF
from mhri.screen.presenters.screen_host import ScreenHost
from mhri.screen.ros.backend import ScreenBackend
from mhri.standalone import Standalone
from support import rqt_stand_in
from support.rqt_stand_in import Context, Settings


@pytest.fixture(scope='module', autouse=True)
def app():
    yield QApplication.instance() or QApplication(['panel'])


class Monitor:
    """One of several."""

    def __init__(self, area):
        self.area = area

    def geometry(self):
        return self.area

    availableGeometry = geometry  # noqa: N815


class Monitors:
    """Stands in for ``QGuiApplication``: what is plugged in."""

    def __init__(self, plugged):
        self._plugged = plugged

    def screens(self):
        return self._plugged


def tear_off(host):
    """Put a tile into a window of its own."""
    host.tiles.make('bot1')
    host.tiles.toggle_torn('bot1')
    host.windows['bot1'].window().move(QPoint(321, 123))


def used_host():
    """A host with something to remember."""
    host = ScreenHost(ScreenBackend())
    for name in ('bot2', 'bot1', 'rover_7'):
        host._add(name)
    host._select(['bot1'])
    host._request_mode('ps3joy')
    tear_off(host)
    return host


def check_restored(host):
    assert host.operator.selection.robots == ('bot2', 'bot1', 'rover_7')
    assert host.operator.selection.selected == (), 'nothing is driven that was not chosen today'
    assert host.operator._first_mode == 'ps3joy'
    host.tiles.make('bot1')
    assert host.windows['bot1'].torn_off
    assert host.windows['bot1'].window().pos() == QPoint(321, 123)


def test_a_tile_whose_monitor_is_gone_is_on_the_screen_again():
    """Not in a window that nobody sees, nor in one over the pictures."""
    first = used_host()
    window, tile = first.windows['bot1'].window(), first.windows['bot1']
    window.setGeometry(QRect(9000, 100, 400, 300))
    state = json.loads(json.dumps(first.save_state()))
    QApplication.instance().screenRemoved.emit(None)
    for _ in range(600):
        if not tile.torn_off:
            break
        QTest.qWait(50)
    assert not tile.torn_off and tile.parentWidget() is first.screen.stage
    first.close()
    second = ScreenHost(ScreenBackend())
    second.restore_state(state)
    second.tiles.make('bot1')
    assert not second.windows['bot1'].torn_off
    second.close()


def test_a_tile_is_torn_off_to_the_other_monitor(monkeypatch):
    screens = [Monitor(QRect(0, 0, 1280, 720)), Monitor(QRect(1280, 0, 1000, 500))]
    monkeypatch.setattr(geometry, 'QGuiApplication', Monitors(screens))
    main, window = QWidget(), QWidget()
    main.setGeometry(QRect(100, 100, 800, 500))
    window.resize(800, 640)
    geometry.place_on_another_screen(window, main)
    assert screens[1].area.contains(window.geometry()) and window.height() == 500
    assert geometry.in_sight([1300, 0, 800, 400, False])
    assert not geometry.in_sight([2200, 0, 800, 400, False])
    del screens[1]
    geometry.place_on_another_screen(window, main)
    assert window.x() > 1200, 'left where it is'


def test_a_torn_off_tile_says_with_the_bar_that_the_screen_is_cut_off(monkeypatch):
    host, state = ScreenHost(ScreenBackend()), [ROS_CUT_OFF]
    monkeypatch.setattr(ScreenBackend, '_state_of_ros', lambda _: state[-1])
    host._add('bot1')
    tear_off(host)
    tile, bar = host.windows['bot1'], host.screen.stop_bar
    host.draw()
    assert tile.stop_button.text() == bar._headline.text() and 'cut off' in bar._headline.text()
    assert not tile.stop_button.isEnabled()
    state.append(ROS_CONNECTED)
    host.draw()
    assert tile.stop_button.text() == 'STOP ALL' and tile.stop_button.isEnabled()
    host.close()


def test_state_survives_as_json():
    first = used_host()
    state = json.loads(json.dumps(first.save_state()))
    first.close()
    second = ScreenHost(ScreenBackend())
    second.restore_state(state)
    check_restored(second)
    second.close()


def test_standalone_keeps_its_settings_in_a_file(tmp_path):
    path = str(tmp_path / 'panel.json')
    first = Standalone(['panel'], path)
    first.restore()
    for name in ('bot2', 'bot1', 'rover_7'):
        first.host._add(name)
    first.host._select(['bot2'])
    first.host._request_mode('ps3joy')
    tear_off(first.host)
    first.window.close()
    second = Standalone(['panel'], path)
    second.restore()
    check_restored(second.host)
    second.window.close()


def test_the_first_time_it_fills_the_screen(tmp_path):
    path = str(tmp_path / 'panel.json')
    first = Standalone(['panel'], path)
    first.restore()
    assert first.window.isMaximized()
    first.window.showNormal()
    first.window.setGeometry(101, 102, 960, 610)
    first.window.close()
    second = Standalone(['panel'], path)
    second.restore()
    assert second.window.geometry() == QRect(101, 102, 960, 610), 'later it is where it was left'
    second.window.close()


@pytest.mark.parametrize('rubbish', ['{', '[]', '"x"', '{"robots": 5}', '{"limits": "fast"}', ''])
def test_settings_that_cannot_be_used_are_left_out(tmp_path, rubbish):
    path = str(tmp_path / 'panel.json')
    with open(path, 'w') as stream:
        stream.write('{{"state": {}}}'.format(rubbish))
    program = Standalone(['panel'], path)
    program.restore()
    assert program.host.operator.selection.robots == ()
    program.window.close()


@pytest.fixture
def saved(tmp_path):
    """The path of settings with one robot in them."""
    path = str(tmp_path / 'panel.json')
    program = Standalone(['panel'], path)
    program.host._add('kept')
    program.window.close()
    assert robots_in(path) == ['kept']
    return path


def robots_in(path):
    with open(path) as stream:
        return json.load(stream)['state']['robots']


def test_a_demo_leaves_the_settings_alone(saved):
    with open(saved, 'rb') as stream:
        before = stream.read()
    program = Standalone(['panel'], saved, remember=False)
    program.host._add('bot1')
    program.host.screen.limits_requested.emit(0.3, 0.8)
    program.window.close()
    with open(saved, 'rb') as stream:
        assert stream.read() == before


@pytest.mark.parametrize('change, robots', [
    (lambda host: None, ['kept']),
    (lambda host: tear_off(host), ['kept']),
    (lambda host: host._add('bot2'), ['bot1', 'bot2']),
    (lambda host: host._remove('bot1'), []),
    (lambda host: host.screen.mode_requested.emit('ps3joy'), ['bot1']),
    (lambda host: host.screen.limits_requested.emit(0.3, 0.8), ['kept']),
    (lambda host: host.screen.together_requested.emit(True), ['kept']),
], ids=['none', 'a window', 'one more', 'one less', 'mode', 'limits', 'together'])
def test_a_fresh_panel_keeps_the_settings_until_something_is_changed(saved, change, robots):
    program = Standalone(['panel'], saved)
    program.window.show()
    program.host._add('bot1')
    program.begin_afresh()
    program.host.draw()
    change(program.host)
    program.window.close()
    assert robots_in(saved) == robots


@pytest.fixture
def plugin_class(monkeypatch):
    """The adapter, without ROS."""
    monkeypatch.setattr(ScreenBackend, 'start', lambda self: None)
    return rqt_stand_in.plugin_class(monkeypatch)


def test_the_rqt_plugin_shows_the_panel_and_keeps_its_settings(plugin_class):
    context, settings = Context(), Settings()
    plugin = plugin_class(context)
    assert isinstance(context.widgets[0], QWidget)
    host = plugin._host
    for name in ('bot2', 'bot1', 'rover_7'):
        host._add(name)
    host._request_mode('ps3joy')
    tear_off(host)
    plugin.save_settings(Settings(), settings)
    plugin.shutdown_plugin()
    assert host.windows == {}
    again = plugin_class(Context())
    again.restore_settings(Settings(), settings)
    check_restored(again._host)
    again.shutdown_plugin()


def test_the_rqt_plugin_adds_the_robots_it_is_told(plugin_class):
    plugin = plugin_class(Context('--robots', 'bot1 bot2'))
    assert plugin._host.operator.selection.robots == ('bot1', 'bot2')
    plugin.shutdown_plugin()


def test_the_rqt_plugin_leaves_out_a_perspective_it_cannot_read(plugin_class):
    plugin = plugin_class(Context())
    plugin.restore_settings(Settings(), Settings(state='{"robots": 5}'))
    assert plugin._host.operator.selection.robots == ()
    plugin.shutdown_plugin()


def test_a_name_of_the_screen_is_no_name_of_a_tile():
    """Hands and tests find a widget by its name: it must be the one that is meant."""
    host = ScreenHost(ScreenBackend())
    host._add('bot1')
    host.tiles.make('bot1')
    tile = host.windows['bot1']
    tile.view('rgb')
    host.screen.stage.show_tiles(host.windows)
    parts = [part for part in host.screen.findChildren(QWidget) if part.objectName()
             and not part.objectName().startswith('qt_')]
    inside = {part.objectName() for part in parts if tile.isAncestorOf(part)}
    outside = {part.objectName() for part in parts if not tile.isAncestorOf(part)}
    assert {'stream_label', 'tile_stop_button'} <= inside and 'status_label' in outside
    assert inside & outside <= {'stale_cover'}
    host.close()
