# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Windows of a lab's own packages: shown where they work, and never in the way of driving."""
import json
import sys

import pytest
from python_qt_binding.QtWidgets import QApplication, QDialog

from mhri.base import views
from mhri.base.views import RobotView
from mhri.screen.gui.window_maker import import_window, WindowMaker
from mhri.screen.gui.windows import TurtleBotWindow
from mhri.screen.presenters.screen_host import ScreenHost
from mhri.screen.ros.backend import ScreenBackend

MODULE = '''
from mhri.screen.gui.bot_window import BotWindow
from mhri.screen.gui.windows import TurtleBotWindow

NOT_A_CLASS = 3


class Good(TurtleBotWindow):
    pass


class FailsToBuild(TurtleBotWindow):
    def _build(self, ui_dir, type_label):
        super()._build(ui_dir, type_label)
        raise KeyError('wheel')


class WantsMore(BotWindow):
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
    (tmp_path / 'lab_robot' / 'quits.py').write_text('1 / 0')
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
    ('lab_robot.window.NoSuchClass', "(AttributeError: module 'lab_robot.window' has no attribute"),
    ('lab_robot.no_such_module.X', "(ModuleNotFoundError: No module named 'lab_robot.no_such_mod"),
    ('no_such_package.window.X', "cannot be imported (ModuleNotFoundError: No module named 'no_su"),
    ('lab_robot.slip.Half', '(SyntaxError: '), ('lab_robot.quits.X', '(ZeroDivisionError: '),
    ('lab_robot.window.NOT_A_CLASS', 'is no subclass of mhri.screen.gui.bot_window.BotWindow'),
    ('python_qt_binding.QtWidgets.QDialog',
     'is no subclass of mhri.screen.gui.bot_window.BotWindow'),
    ('lab_robot.window.FailsToBuild', "cannot be opened (KeyError: 'wheel')"),
    ('lab_robot.exits.X', '(SystemExit: '),
    ('lab_robot.window.ExitsAtOnce', 'cannot be opened (SystemExit: '),
    ('lab_robot.window.WantsMore', 'cannot be opened (TypeError: '),
    ('.', 'cannot be imported'), ('..X', 'cannot be imported'),
])
def test_one_that_cannot_be_had_gives_way_to_the_standard_one(operator, ui_dir, key, said):
    maker = WindowMaker()
    for name in ('bot1', 'bot2'):
        window, problem = maker.make(key, ui_dir, name, 'Lab')
        operator.show(window)
        assert type(window) is TurtleBotWindow and window.name == name
        assert problem.startswith(key) and said in problem
        assert problem.endswith('; the standard window is shown instead')
    assert not maker.trusts(key)


def test_the_windows_of_mhri_need_no_trust(operator, ui_dir):
    maker = WindowMaker()
    window, problem = maker.make('turtlebot', ui_dir, 'bot1', 'TurtleBot2')
    assert (type(window), problem) == (TurtleBotWindow, '')
    assert not maker.trusts('turtlebot') and maker.trusts('lab_robot.window.Good')
    assert sys.excepthook is sys.__excepthook__
    with pytest.raises(ImportError, match='make it one'):
        import_window('python_qt_binding.QtWidgets.QDialog')
    assert QDialog


@pytest.fixture
def host(operator, monkeypatch):
    """The panel with robots whose type is a lab's; nothing is connected to anything."""
    made = ScreenHost(ScreenBackend())
    made.keys = {}
    monkeypatch.setattr(made.operator, '_robot_view', lambda name, selected: RobotView(
        name, 'Lab', window=made.keys[name], link=views.LIVE, x_m=made.x_m))
    made.x_m = None
    made.screen.show()

    def add(name, key):
        made.keys[name] = key
        made._add(name)
        made.tiles.make(name)
        made.draw()
        return made.windows[name]
    made.add = add
    yield made
    made.close()


def drawn(host, operator, rounds=3):
    """Draw every window a few times."""
    for _ in range(rounds):
        host.draw()
        operator.wait_until(lambda: not host.tiles.draw_next())


@pytest.mark.parametrize('key, why', [('FailsToDraw', 'ZeroDivisionError'),
                                      ('Exits', 'SystemExit')])
def test_one_that_fails_while_it_draws_is_replaced_and_the_others_go_on(host, operator, key, why):
    lab = host.add('bot1', 'lab_robot.window.' + key)
    other = host.add('bot2', 'turtlebot')
    good = host.add('bot3', 'lab_robot.window.Good')
    drawn(host, operator)
    assert host.windows['bot1'] is lab
    host.x_m = 1.0
    drawn(host, operator)
    assert type(host.windows['bot1']) is TurtleBotWindow and host.windows['bot1'].isVisible()
    # Qt may have deleted it by now.
    assert not any(widget is lab and widget.isVisible()
                   for widget in operator.application.allWidgets())
    assert host.windows['bot2'] is other and host.windows['bot3'] is good
    assert why in host.screen.look_label.text()
    host.windows['bot1'].stop_requested.emit()
    assert type(host.add('bot4', 'lab_robot.window.' + key)) is TurtleBotWindow


def test_one_that_cannot_take_its_settings_back(host):
    assert type(host.add('bot1', 'lab_robot.window.FailsToRestore')) is TurtleBotWindow
    assert host.windows['bot1'].isVisible()


@pytest.mark.parametrize('key', ['FailsToSave', 'SavesNonsense'])
def test_settings_that_cannot_be_kept_do_not_keep_the_panel_from_ending(host, key):
    host.add('bot1', 'lab_robot.window.' + key)
    assert json.dumps(host.save_state())
    assert host.save_state()['robots'] == ['bot1']
    host._remove('bot1')
    assert host.windows == {}


def test_a_slip_in_an_event_handler_does_not_end_the_program(host, operator, caplog):
    """PyQt aborts at it where nobody looks at exceptions."""
    window = host.add('bot1', 'lab_robot.window.FailsToPaint')
    operator.wait_until(lambda: type(window).painted > 0)
    window.update()
    operator.wait_until(lambda: type(window).painted > 1)
    assert caplog.text.count('a slip in a window: RuntimeError: brush') == 1
    assert QApplication.instance() is not None and window.isVisible()


def test_a_slip_in_mhris_own_window_is_not_hidden(host, monkeypatch):
    """Only what a lab brought is guarded: of our own mistakes we want to know."""
    host.add('bot1', 'turtlebot')

    def fail(*_):
        raise KeyError('ours')
    monkeypatch.setattr(host.tiles.hosts['bot1'], 'draw', fail)
    with pytest.raises(KeyError):
        host.tiles._guarded('bot1', host.tiles.hosts['bot1'].draw, RobotView('bot1'), False)
