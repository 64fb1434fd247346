# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Windows of a lab's own packages: shown where they work, and never in the way of driving."""
import json
import sys

import pytest
from python_qt_binding.QtWidgets import QApplication

from mhri.base import views
from mhri.base.views import RobotView, ScreenView
from mhri.screen.gui.window_maker import WindowMaker
from mhri.screen.gui.windows import TurtleBotWindow
from mhri.screen.presenters.screen_presenter import ScreenPresenter
from mhri.screen.ros.backend import ScreenBackend

MODULE = '''
from mhri.screen.gui.robot_tile import RobotTile
from mhri.screen.gui.windows import TurtleBotWindow

NOT_A_CLASS = 3


class Good(TurtleBotWindow):
    pass


class FailsToBuild(TurtleBotWindow):
    def _build(self, ui_dir, type_label):
        super()._build(ui_dir, type_label)
        raise KeyError('wheel')


class WantsMore(RobotTile):
    def __init__(self, ui_dir, name, type_label, colour):
        super().__init__(ui_dir, name, type_label)


class FailsToDraw(TurtleBotWindow):
    def show_view(self, view, stop_all=False):
        super().show_view(view, stop_all)
        if view.x_m is not None:
            raise ZeroDivisionError('x')


class Exits(TurtleBotWindow):
    def show_view(self, view, stop_all=False):
        super().show_view(view, stop_all)
        if view.x_m is not None:
            raise SystemExit(3)


class ExitsAtOnce(TurtleBotWindow):
    def _build(self, ui_dir, type_label):
        raise SystemExit(3)


class FailsToRestore(TurtleBotWindow):
    def restore_settings(self, settings):
        raise ValueError('old')


class FailsToPaint(TurtleBotWindow):
    painted = 0

    def paintEvent(self, event):
        type(self).painted += 1
        raise RuntimeError('brush')


class FailsToSave(TurtleBotWindow):
    def save_settings(self):
        raise OSError('full')


class SavesNonsense(TurtleBotWindow):
    def save_settings(self):
        return {'window': self}
'''


@pytest.fixture(autouse=True)
def lab(tmp_path, monkeypatch):
    """A package of a lab, on the path as a sourced workspace puts it there."""
    (tmp_path / 'lab_robot').mkdir()
    (tmp_path / 'lab_robot' / '__init__.py').write_text('')
    (tmp_path / 'lab_robot' / 'window.py').write_text(MODULE)
    (tmp_path / 'lab_robot' / 'slip.py').write_text('class Half(')
    (tmp_path / 'lab_robot' / 'exits.py').write_text('raise SystemExit(3)')
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, 'excepthook', sys.__excepthook__)
    yield
    for name in [name for name in sys.modules if name.startswith('lab_robot')]:
        del sys.modules[name]


def test_a_window_of_a_lab(operator, ui_dir):
    window, problem = WindowMaker().make('lab_robot.window.Good', ui_dir, 'bot1', 'Lab')
    operator.show(window)
    assert (type(window).__name__, problem) == ('Good', '') and window.name_label.text() == 'bot1'


@pytest.mark.parametrize('key, said', [
    ('lab_robot.window.NoSuchClass', '(AttributeError: '),
    ('lab_robot.no_such_module.X', '(ModuleNotFoundError: '),
    ('lab_robot.slip.Half', '(SyntaxError: '), ('lab_robot.exits.X', '(SystemExit: '),
    ('python_qt_binding.QtWidgets.QDialog', 'mhri.screen.gui.robot_tile.RobotTile'),
    ('lab_robot.window.NOT_A_CLASS', 'mhri.screen.gui.robot_tile.RobotTile'),
    ('lab_robot.window.FailsToBuild', '(KeyError: '),
    ('lab_robot.window.ExitsAtOnce', '(SystemExit: '),
    ('lab_robot.window.WantsMore', '(TypeError: '), ('..X', '')])
def test_one_that_cannot_be_had_gives_way_to_the_standard_one(operator, ui_dir, key, said):
    maker = WindowMaker()
    for name in ('bot1', 'bot2'):
        window, problem = maker.make(key, ui_dir, name, 'Lab')
        operator.show(window)
        assert type(window) is TurtleBotWindow and window.name == name
        assert problem.startswith(key) and said in problem
    assert not maker.trusts(key)


@pytest.fixture
def presenter(operator, monkeypatch):
    """The panel with robots whose type is a lab's; nothing is connected to anything."""
    made = ScreenPresenter(ScreenBackend())
    made.keys = {}
    monkeypatch.setattr(made.operator, 'robot_view', lambda name: RobotView(
        name, 'Lab', window=made.keys[name], link=views.LIVE, x_m=made.x_m))
    monkeypatch.setattr(made.operator, 'view', lambda: ScreenView(
        robots=tuple(map(made.operator.robot_view, made.operator.selection.robots))))
    made.x_m = None
    made.screen.show()

    def add(name, key):
        made.keys[name] = key
        made.operator.add(name)
        made.tiles.make(name)
        made.draw()
        return made.windows[name]
    made.add = add
    yield made
    made.close()


def drawn(presenter, operator, rounds=3):
    """Draw every window a few times."""
    for _ in range(rounds):
        presenter.draw()
        operator.wait_until(lambda: not presenter.tiles.draw_next())


@pytest.mark.parametrize('key, why', [('FailsToDraw', 'ZeroDivisionError'),
                                      ('Exits', 'SystemExit')])
def test_one_that_fails_while_it_draws_is_replaced_and_the_others_go_on(
        presenter, operator, key, why):
    lab = presenter.add('bot1', 'lab_robot.window.' + key)
    other = presenter.add('bot2', 'turtlebot')
    good = presenter.add('bot3', 'lab_robot.window.Good')
    drawn(presenter, operator)
    assert presenter.windows['bot1'] is lab
    presenter.x_m = 1.0
    drawn(presenter, operator)
    assert type(presenter.windows['bot1']) is TurtleBotWindow
    assert presenter.windows['bot1'].isVisible()
    # Qt may have deleted it by now.
    assert not any(widget is lab and widget.isVisible()
                   for widget in operator.application.allWidgets())
    assert presenter.windows['bot2'] is other and presenter.windows['bot3'] is good
    assert why in presenter.screen.look_label.text()
    presenter.windows['bot1'].stop_requested.emit()
    assert type(presenter.add('bot4', 'lab_robot.window.' + key)) is TurtleBotWindow


def test_one_that_cannot_take_its_settings_back(presenter):
    assert type(presenter.add('bot1', 'lab_robot.window.FailsToRestore')) is TurtleBotWindow
    assert presenter.windows['bot1'].isVisible()


@pytest.mark.parametrize('key', ['FailsToSave', 'SavesNonsense'])
def test_settings_that_cannot_be_kept_do_not_keep_the_panel_from_ending(presenter, key):
    presenter.add('bot1', 'lab_robot.window.' + key)
    assert json.dumps(presenter.save_state())
    assert presenter.save_state()['robots'] == ['bot1']
    presenter.screen.remove_steps.remove_requested.emit('bot1')
    assert presenter.windows == {}


def test_a_slip_in_an_event_handler_does_not_end_the_program(presenter, operator, caplog):
    """PyQt aborts at it where nobody looks at exceptions."""
    window = presenter.add('bot1', 'lab_robot.window.FailsToPaint')
    operator.wait_until(lambda: type(window).painted > 0)
    window.update()
    operator.wait_until(lambda: type(window).painted > 1)
    assert ['brush' in record.getMessage() for record in caplog.records].count(True) == 1
    assert QApplication.instance() is not None and window.isVisible()
