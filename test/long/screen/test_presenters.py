# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The two presenters of the panel: what they keep between runs, and how they end."""
from dataclasses import replace
import json
from types import SimpleNamespace

import pytest
from python_qt_binding.QtCore import QPoint, QRect
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui import geometry
from mhri.base.views import ROS_CONNECTED, ROS_CUT_OFF
from mhri.screen.presenters.screen_presenter import ScreenPresenter
from mhri.screen.presenters.settings_file import SettingsFile
from mhri.screen.ros.backend import ScreenBackend
from mhri.standalone import Standalone
from support import rqt_stand_in
from support.rqt_stand_in import Context, Settings


@pytest.fixture(scope='module', autouse=True)
def app():
    yield QApplication.instance() or QApplication(['panel'])


def tear_off(presenter):
    """Put a tile into a window of its own."""
    presenter.tiles.make('bot1')
    presenter.tiles.toggle_torn('bot1')
    presenter.windows['bot1'].window().move(QPoint(321, 123))


def add(presenter, *names):
    """Add robots as the operator does."""
    for name in names:
        presenter.screen.add_requested.emit(name)


def use(presenter):
    """Give a presenter something to remember."""
    add(presenter, 'bot2', 'bot1', 'rover_7')
    presenter.screen.robot_list.selection_requested.emit(['bot1'])
    presenter.screen.mode_combo.mode_requested.emit('ps3joy')
    tear_off(presenter)


def check_restored(presenter):
    assert presenter.operator.selection.robots == ('bot1', 'bot2', 'rover_7')
    assert presenter.operator.selection.selected == (), 'nothing was chosen today'
    assert presenter.save_state()['mode'] == 'ps3joy'
    presenter.tiles.make('bot1')
    assert presenter.windows['bot1'].torn_off
    assert presenter.windows['bot1'].window().pos() == QPoint(321, 123)


def test_a_tile_whose_monitor_is_gone_is_on_the_screen_again(operator):
    """Not in a window that nobody sees, nor in one over the pictures."""
    first = ScreenPresenter(ScreenBackend())
    use(first)
    window, tile = first.windows['bot1'].window(), first.windows['bot1']
    window.setGeometry(QRect(9000, 100, 400, 300))
    state = json.loads(json.dumps(first.save_state()))
    QApplication.instance().screenRemoved.emit(None)
    operator.wait_until(lambda: not tile.torn_off)
    assert tile.parentWidget() is first.screen.stage
    first.close()
    second = ScreenPresenter(ScreenBackend())
    second.restore_state(state)
    second.tiles.make('bot1')
    assert not second.windows['bot1'].torn_off
    second.close()


def test_a_tile_is_torn_off_to_the_other_monitor(monkeypatch):
    areas = [QRect(0, 0, 1280, 720), QRect(1280, 0, 1000, 500)]
    monitors = [SimpleNamespace(geometry=lambda area=area: area,
                                availableGeometry=lambda area=area: area) for area in areas]
    monkeypatch.setattr(geometry, 'QGuiApplication', SimpleNamespace(screens=lambda: monitors))
    main, window = QWidget(), QWidget()
    main.setGeometry(QRect(100, 100, 800, 500))
    window.resize(800, 640)
    geometry.place_on_another_screen(window, main)
    assert areas[1].contains(window.geometry()) and window.height() == 500
    assert geometry.in_sight([1300, 0, 800, 400, False])
    assert not geometry.in_sight([2200, 0, 800, 400, False])


def test_a_torn_off_tile_of_a_screen_that_is_cut_off_offers_no_stop(monkeypatch):
    presenter = ScreenPresenter(ScreenBackend())
    add(presenter, 'bot1')
    tear_off(presenter)
    stop, view = presenter.windows['bot1'].stop_button, presenter.operator.view
    for ros in (ROS_CUT_OFF, ROS_CONNECTED):
        monkeypatch.setattr(presenter.operator, 'view', lambda ros=ros: replace(view(), ros=ros))
        presenter.draw()
        assert stop.isEnabled() == (ros == ROS_CONNECTED)
    presenter.close()


def test_standalone_keeps_its_settings_in_a_file(tmp_path):
    path = str(tmp_path / 'panel.json')
    first = Standalone(['panel'], path)
    first.restore()
    use(first.presenter)
    numbers = first.presenter.operator.selection.numbered()
    first.window.close()
    second = Standalone(['panel'], path)
    second.restore()
    check_restored(second.presenter)
    assert second.presenter.operator.selection.numbered() == numbers, 'a key means the same robot'
    second.window.close()


def test_a_program_that_is_killed_has_kept_the_numbers(operator, tmp_path):
    path = tmp_path / 'panel.json'
    path.write_text(json.dumps({'state': {'mode': 'pedal'}}))
    program = Standalone(['panel'], str(path))
    program.restore()
    jobs = []
    program.presenter.operator.do = lambda job, *arguments: jobs.append((job, arguments))
    add(program.presenter, 'bot1', 'bot2')
    operator.wait_until(lambda: (program.presenter.draw(), jobs)[-1])
    for job, arguments in jobs:
        job(*arguments)
    assert SettingsFile(str(path)).read()['state'] == {
        'mode': 'pedal', 'numbers': {'bot1': 1, 'bot2': 2}}
    program.window.close()
    before = path.read_bytes()
    jobs[0][0](*jobs[0][1])
    assert path.read_bytes() == before, 'nothing comes after the last word'


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


@pytest.fixture
def saved(tmp_path):
    """The path of settings with one robot in them."""
    path = str(tmp_path / 'panel.json')
    program = Standalone(['panel'], path)
    add(program.presenter, 'kept')
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
    add(program.presenter, 'bot1')
    program.presenter.screen.speed_limits.limits_requested.emit(0.3, 0.8)
    program.window.close()
    with open(saved, 'rb') as stream:
        assert stream.read() == before


@pytest.mark.parametrize('change, robots', [
    (lambda presenter: None, ['kept']),
    (lambda presenter: tear_off(presenter), ['kept']),
    (lambda presenter: add(presenter, 'bot2'), ['bot1', 'bot2']),
    (lambda presenter: presenter.screen.remove_steps.remove_requested.emit('bot1'), []),
    (lambda presenter: presenter.screen.mode_combo.mode_requested.emit('ps3joy'), ['bot1']),
    (lambda presenter: presenter.screen.speed_limits.limits_requested.emit(0.3, 0.8), ['kept']),
], ids=['none', 'a window', 'one more', 'one less', 'mode', 'limits'])
def test_a_fresh_panel_keeps_the_settings_until_something_is_changed(saved, change, robots):
    program = Standalone(['panel'], saved)
    program.window.show()
    add(program.presenter, 'bot1')
    program.begin_afresh()
    program.presenter.draw()
    change(program.presenter)
    program.window.close()
    assert robots_in(saved) == robots


def test_simulated_runs_have_settings_of_their_own_without_robots(saved, tmp_path):
    def run(**options):
        program = Standalone(['panel'], **options)
        program.restore()
        return program
    own = str(tmp_path / 'simulation.json')
    first = run(settings_path=own, simulated=True)
    use(first.presenter)
    first.presenter.screen.arrangement.theme_chosen.emit('light')
    first.presenter.parts['events'].restore_settings({'sounds': False})
    first.window.close()
    with open(own) as stream:
        assert set(json.load(stream)['state']) <= {'panel', 'events'}
    second = run(settings_path=own, simulated=True)
    assert second.presenter.operator.selection.robots == ()
    assert second.presenter.save_state()['mode'] is None
    assert second.presenter.parts['events'].save_settings() == {'sounds': False}, 'as it was left'
    second.window.close()
    # Not even those of robots by mistake.
    third = run(settings_path=saved, simulated=True)
    assert third.presenter.operator.selection.robots == ()
    third.presenter.close()
    assert robots_in(saved) == ['kept']


@pytest.fixture
def open_plugin(monkeypatch):
    """A function that opens rqt's plugin, without ROS, and returns it and its presenter."""
    monkeypatch.setattr(ScreenBackend, 'start', lambda self: None)
    made, presenters = rqt_stand_in.plugin_class(monkeypatch)
    return lambda *words: (made(Context(*words)), presenters[-1])


def test_the_rqt_plugin_keeps_its_settings_and_leaves_out_what_it_cannot_read(open_plugin):
    settings = Settings()
    plugin, presenter = open_plugin()
    use(presenter)
    plugin.save_settings(Settings(), settings)
    plugin.shutdown_plugin()
    assert presenter.windows == {}
    again, presenter = open_plugin()
    again.restore_settings(Settings(), Settings(state='{"robots": 5}'))
    assert presenter.operator.selection.robots == ()
    again.restore_settings(Settings(), settings)
    check_restored(presenter)
    again.shutdown_plugin()


@pytest.mark.parametrize('flag, change, robots', [
    ('--fresh', None, ['kept']), ('--fresh', 'bot1', ['bot1']), ('--simulated', 'bot1', ['kept'])])
def test_the_rqt_plugin_begins_afresh_or_with_settings_of_its_own(open_plugin, flag, change,
                                                                  robots):
    settings = Settings(state=json.dumps({'robots': ['kept'], 'numbers': {'kept': 7}}))
    plugin, presenter = open_plugin(flag)
    plugin.restore_settings(Settings(), settings)
    assert presenter.operator.selection.robots == ()
    if change:
        add(presenter, change)
    plugin.save_settings(Settings(), settings)
    plugin.shutdown_plugin()
    assert json.loads(settings['state'])['robots'] == robots
    assert 'robots' not in json.loads(settings.get('simulated_state', '{}'))
