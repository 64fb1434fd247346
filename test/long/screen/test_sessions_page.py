# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of recorded sessions: read from a disk that is not kind, replayed, reported on."""
import os
import stat
import subprocess
import xmlrpc.client

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui import theme
from mhri.graph.ros.resources import resource_path
from mhri.screen.gui.screen import ScreenWidget
from mhri.screen.gui.tile_header import REPLAY
from mhri.session.presenters.session_presenter import LibraryPresenter
from mhri.session.ros.session_library import SessionLibrary
from support import made_session
from support.ros_system import System, wait_for
from support.windows import close, times_written, windows_called

TIMEOUT_S = 600.0
GOOD, KILLED = '2026-03-01-14-03-22', '2026-02-28-10-00-00'


class Desk:
    """A screen without a master, with a page of sessions."""

    def __init__(self, home, **library):
        self.app = QApplication.instance() or QApplication(['panel'])
        self.home = home / 'mhri' / 'sessions'
        self.home.mkdir(parents=True)
        self.screen = ScreenWidget(resource_path())
        self.screen.resize(1280, 800)
        self.library = SessionLibrary(**{'env': dict(os.environ, ROS_HOME=str(home)), **library})
        self.presenter = LibraryPresenter(self.screen, self.library)
        self.page = self.presenter.page
        self.screen.show()

    def open(self):
        """Open the page as an operator does, and wait until it is read."""
        tabs = self.screen.tabs
        self.screen.drawer_button.setChecked(True)
        QTest.mouseClick(tabs, Qt.LeftButton, Qt.NoModifier, tabs.tabRect(1).center())
        QTest.mouseClick(self.screen.findChild(QWidget, 'fold_sessions_page'), Qt.LeftButton)
        self.until(lambda: self.page.isVisible() and self.page.note.text() != 'reading ...',
                   'the list')
        return self

    def until(self, condition, what):
        """Let Qt work until a condition comes true."""
        def turn():
            self.app.processEvents()
            self.presenter.show_view(None)
            return condition()
        wait_for(turn, TIMEOUT_S, what)

    def choose(self, name):
        """Click on a row."""
        self.until(lambda: name in self.names(), 'the row')
        rect = self.page.list.visualItemRect(self.page.list.item(self.names().index(name)))
        QTest.mouseClick(self.page.list.viewport(), Qt.LeftButton, Qt.NoModifier, rect.center())
        assert self.page.chosen == name

    def press(self, button):
        """Click on a button."""
        QTest.mouseClick(button, Qt.LeftButton)

    def names(self):
        """Return the name of the session of each row."""
        return [item.data(Qt.UserRole).name for item in self.items()]

    def items(self):
        """Return the rows."""
        return [self.page.list.item(place) for place in range(self.page.list.count())]

    def close(self):
        """End it."""
        self.presenter.close()
        self.screen.close()
        self.screen.deleteLater()
        self.app.processEvents()


@pytest.fixture
def desk(tmp_path):
    arguments = tmp_path / 'arguments'
    script = tmp_path / 'replay.sh'
    script.write_text('#!/bin/sh\necho "$@" > {}\necho could not start >&2\nexit 1\n'.format(
        arguments))
    script.chmod(stat.S_IRWXU)
    desk = Desk(tmp_path, command=lambda path: [str(script), path])
    desk.arguments = arguments
    yield desk
    desk.close()


def hostile(home):
    """Write folders of every way of being wrong."""
    for name, text in (('2026-01-01-00-00-00', None), ('2026-01-01-00-00-01', 'format: 99'),
                       ('2026-01-01-00-00-02', '[' * 500), ('2026-01-01-00-00-03', '\x00\xff'),
                       ('2026-01-01-00-00-04', 'format: 1\nstarted: {seconds: 1.0e+300}'),
                       ('2026-01-01-00-00-05', 'format: 1\nstarted: {seconds: .nan}'),
                       ('2026-01-01-00-00-06', 'format: 1\nstarted: {seconds: 1}\n'
                                               'robots: {"a\u202eb\\n": {}, 3: {}}')):
        folder = home / name
        folder.mkdir()
        if text is not None:
            (folder / 'session.yaml').write_text(text, encoding='utf-8')
    os.mkfifo(str(home / '2026-01-01-00-00-00' / 'events.jsonl'))
    (home / '2026-01-01-00-00-01' / 'events.jsonl').write_text('[' * 100000)
    (home / '2026-01-01-00-00-02' / 'loop').symlink_to(home)
    (home / '2026-01-01-00-00-07').write_text('a file')
    (home / '2026-01-01-00-00-08').symlink_to(home / 'nowhere')
    (home / 'not a session').mkdir()


def test_each_session_is_a_row_the_newest_first(desk):
    made_session.write_session(desk.home / GOOD)
    folder = made_session.write_session(desk.home / KILLED)
    (folder / 'events.jsonl').write_text('{"wall": 17')
    hostile(desk.home)
    desk.open()
    desk.until(lambda: desk.page.list.count() == 9, 'all rows')
    rows = [item.data(Qt.UserRole) for item in desk.items()]
    assert [(row.name, row.marks) for row in rows[:2]] == [(GOOD, 2), (KILLED, 0)]
    assert [row.robots for row in rows[:2]] == [('bot1', 'bot2')] * 2
    assert not any(row.problem for row in rows[:2]) and all(row.problem for row in rows[2:])
    assert desk.page.chosen == GOOD, 'the newest is chosen'
    desk.choose('2026-01-01-00-00-01')
    assert not desk.page.replay_button.isEnabled() and not desk.page.report_button.isEnabled()


def test_a_session_is_replayed_by_a_program_of_its_own_and_reported_on(desk, tmp_path):
    made_session.write_session(desk.home / GOOD)
    desk.open()
    desk.choose(GOOD)
    desk.press(desk.page.replay_button)
    desk.until(lambda: 'could not start' in desk.page.note.text(), 'the reason')
    assert desk.arguments.read_text().strip() == str(desk.home / GOOD)
    # A report is cancelled at once, then made.
    desk.press(desk.page.report_button)
    assert desk.page.progress.isVisible() and desk.page.cancel_button.isVisible()
    desk.press(desk.page.cancel_button)
    desk.until(lambda: not desk.page.progress.isVisible(), 'its end')
    assert not list(tmp_path.glob('mhri/reports/*/*'))
    desk.press(desk.page.report_button)
    desk.until(lambda: not desk.page.progress.isVisible(), 'the report')
    page = tmp_path / 'mhri' / 'reports' / GOOD / 'report.html'
    assert str(page) in desk.page.note.text()
    assert page.stat().st_size > 1000


@pytest.fixture
def live(tmp_path):
    """A master with something on it, and a screen that belongs to it."""
    with System(adopt=False) as system:
        system.start_master()
        subprocess.run(['rosparam', 'set', '/bot1/robot_type', 'turtlebot2'], env=system.env,
                       check=True, timeout=TIMEOUT_S)
        system.env['ROS_HOME'] = str(tmp_path)
        desk = Desk(tmp_path, env=system.env)
        desk.master = xmlrpc.client.ServerProxy(system.env['ROS_MASTER_URI'])
        desk.children = lambda: subprocess.run(
            ['pgrep', '-f', str(tmp_path)], stdout=subprocess.PIPE).stdout.split()
        yield desk
        desk.close()


def test_a_replay_is_a_screen_of_its_own_that_leaves_the_live_one_alone(live):
    """Started from the page by the real script, read off the X server, closed by its cross."""
    def known():
        return live.master.getSystemState('/test')[2], live.master.getParam('/test', '/')[2]
    made_session.write_session(live.home / GOOD)
    before, title = known(), 'mhri: replay of ' + GOOD
    live.open()
    live.choose(GOOD)
    live.press(live.page.replay_button)
    live.until(live.page.note.text, 'the word of it')
    opens = live.page.note.text()
    live.until(lambda: windows_called(title), 'its window')
    window, = windows_called(title)
    font = theme.number_font(theme.base_font(live.screen.font()))
    live.until(lambda: times_written(window, REPLAY, font) == 2, 'the word on both tiles')
    assert known() == before
    close(window)
    live.until(lambda: not live.children(), 'the end of all that it had started')
    live.until(lambda: True, 'what it said last')
    assert live.page.note.text() == opens
    assert known() == before
