# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A replay on the real screen, played by the real player: moved by clicks and keys."""
import os

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QLabel

from mhri.base.views import ScreenView
from mhri.camera.images import DEPTH, RGB
from mhri.session.gui.time_line import NOTHING_DRIVES
from support.made_session import MARKS
from support.ros_system import System, wait_for

TIMEOUT_S = 120.0


class Replay:
    """The player, and the screen in this process."""

    def __init__(self, application):
        from support import made_session
        self.application = application
        self.system = System()
        folder = made_session.write_session(os.path.join(self.system.home, 'session'))
        self.system.start_master()
        self.system.node('mhri_replay', str(folder))
        from mhri.standalone import make_replay
        self.program = make_replay(['panel'], str(folder))
        self.presenter, self.window = self.program.presenter, self.program.window
        self.window.resize(1280, 800)
        self.window.show()
        self.presenter.start()
        self.until(lambda: len(self.presenter.windows) == 2 and self.bar.numbers, 'the robots')

    @property
    def bar(self):
        return self.presenter.bar

    def until(self, condition, what):
        """Let Qt work until a condition comes true."""
        wait_for(condition, TIMEOUT_S, what, turn=self.application.processEvents)

    def pause_at(self, position_s):
        """Pause by its key, and go somewhere by a click."""
        if self.state().playing:
            QTest.keyClick(self.presenter.screen, Qt.Key_Space)
        self.until(lambda: not self.state().playing and self.bar.play_button.text() == 'Play',
                   'the pause')
        jumps = self.state().jumps
        QTest.mouseClick(self.bar.canvas, Qt.LeftButton, Qt.NoModifier,
                         QPoint(round(self.bar.canvas.x_of(position_s)), 20))
        self.until(lambda: self.state().settled and self.state().jumps > jumps and abs(
            self.bar.position_s - position_s) < 0.2, 'the jump')

    def state(self):
        return self.presenter.operator.replay()

    def robot(self, name):
        return next(robot for robot in self.presenter.operator.view().robots if robot.name == name)

    def close(self):
        self.program.close()
        self.window.close()
        self.application.processEvents()
        self.program.delete_window()
        self.system.close()


@pytest.fixture(scope='module')
def replay():
    running = Replay(QApplication.instance() or QApplication(['panel']))
    yield running
    running.close()


def test_a_click_goes_to_a_moment_and_the_screen_shows_what_was_so(replay):
    replay.pause_at(33.0)
    replay.until(lambda: replay.presenter.operator.view().stop_all, 'the stop')
    bar = replay.presenter.screen.stop_bar
    replay.until(lambda: not bar.stop_button.isVisible(), 'the words of the stop')
    assert bar.findChild(QLabel, 'stop_note_label').text() == NOTHING_DRIVES
    assert not bar.release_button.isVisible(), 'there is nothing to release'
    replay.pause_at(14.0)
    replay.until(lambda: not replay.presenter.operator.view().stop_all
                 and replay.robot('bot2').selected, 'what was so before the stop')
    assert bar.stop_button.isVisible() and not bar.stop_button.isEnabled()


def test_the_list_has_the_events_so_far(replay):
    page = replay.presenter.parts['events'].page.model
    replay.pause_at(33.0)
    replay.until(lambda: page.rowCount() == 6, 'the events until the stop')
    texts = [page.index(row, 3).data() for row in range(page.rowCount())]
    assert texts[-1] == 'STOP ALL'
    assert [MARKS[0][2] in text for text in texts].count(True) == 1, 'a mark with its note'
    replay.pause_at(3.0)
    replay.until(lambda: page.rowCount() == 1, 'the first event alone')


def test_a_mark_is_a_flag_from_its_time_on(replay):
    def flags():
        return replay.presenter.parts['session'].amend(ScreenView()).flags
    replay.pause_at(16.0)
    replay.until(lambda: len(flags()) == 1, 'the first flag')
    (flag,) = flags()
    assert flag.label.startswith('1 a red bag') and flag[1:] == (pytest.approx(1.5), 0.0, 'map')
    replay.pause_at(14.0)
    replay.until(lambda: not flags(), 'none before its time')


def test_depth_is_shown_where_depth_was_recorded(replay):
    switches = replay.presenter.windows['bot1'].switches
    assert RGB in switches.chosen()
    replay.pause_at(25.0)
    replay.until(lambda: DEPTH in switches.chosen(), 'depth')
    assert RGB not in switches.chosen()
    assert RGB in replay.presenter.windows['bot2'].switches.chosen(), 'of nothing else'


def test_a_drill_is_told_as_it_went(replay):
    line = replay.presenter.parts['drill'].line
    for position_s, words in ((8.0, 'Find the can.'), (20.0, '0:5'), (30.0, '0:14')):
        replay.pause_at(position_s)
        replay.until(lambda: line.isVisible() and words in line.text(), words)
    replay.pause_at(3.0)
    replay.until(lambda: not line.isVisible(), 'no drill')
