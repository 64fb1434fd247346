# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A replay on the real screen, played by the real player: moved by clicks and keys."""
import os
import sys

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.session.gui.time_line import NOTHING_DRIVES  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

PATIENCE_S = 120.0


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
        self.host, self.window = self.program.host, self.program.window
        self.window.resize(1280, 800)
        self.window.show()
        self.host.start()
        self.until(lambda: len(self.host.windows) == 2 and self.bar.numbers, 'the robots')

    @property
    def bar(self):
        return self.host.bar

    def until(self, condition, what):
        """Let Qt work until a condition comes true."""
        wait_for(lambda: (self.application.processEvents(), condition())[1], PATIENCE_S, what)

    def pause_at(self, position_s):
        """Pause by its key, and go somewhere by a click."""
        if self.state().playing:
            QTest.keyClick(self.host.screen, Qt.Key_Space)
        self.until(lambda: not self.state().playing and self.bar.play_button.text() == 'Play',
                   'the pause')
        jumps = self.state().jumps
        QTest.mouseClick(self.bar.canvas, Qt.LeftButton, Qt.NoModifier,
                         QPoint(round(self.bar.canvas.x_of(position_s)), 20))
        self.until(lambda: self.state().settled and self.state().jumps > jumps and abs(
            self.bar.position_s - position_s) < 0.2, 'the jump')

    def state(self):
        return self.host.operator.replay()

    def robot(self, name):
        return next(robot for robot in self.host.operator.view().robots if robot.name == name)

    def close(self):
        self.program.close()
        self.window.close()
        self.application.processEvents()
        self.system.close()


@pytest.fixture(scope='module')
def replay():
    running = Replay(QApplication.instance() or QApplication(['panel']))
    yield running
    running.close()


def test_every_tile_says_that_this_is_a_replay(replay):
    labels = [tile.header.rec_label for tile in replay.host.windows.values()]
    replay.until(lambda: all(label.isVisible() and label.text() == 'REPLAY' for label in labels),
                 'the word on each tile')


def test_a_click_goes_to_a_moment_and_the_screen_shows_what_was_so(replay):
    replay.pause_at(33.0)
    replay.until(lambda: replay.host.operator.view().stop_all, 'the stop')
    bar = replay.host.screen.stop_bar
    replay.until(lambda: not bar.stop_button.isVisible() and 'STOP' in bar._headline.text(),
                 'the words of the stop')
    assert bar._note_line.text() == NOTHING_DRIVES
    assert not bar.release_button.isVisible(), 'there is nothing to release'
    replay.pause_at(14.0)
    replay.until(lambda: not replay.host.operator.view().stop_all
                 and replay.robot('bot2').selected, 'what was so before the stop')
    assert bar.stop_button.isVisible() and not bar.stop_button.isEnabled()


def test_the_list_has_the_events_so_far(replay):
    page = replay.host.events.page.model
    replay.pause_at(33.0)
    replay.until(lambda: page.rowCount() == 7, 'the events until the stop')
    texts = [page.index(row, 3).data() for row in range(page.rowCount())]
    assert texts[-1] == 'STOP ALL' and 'mark' in texts
    replay.pause_at(3.0)
    replay.until(lambda: page.rowCount() == 1, 'the first event alone')


def test_a_drill_is_told_as_it_went(replay):
    line = replay.host.parts['drill'].line
    for position_s, words in ((8.0, 'Drill Short: Find the can.'),
                              (20.0, 'Drill Short: 0 of 1 found, 0:5'),
                              (30.0, 'Drill Short: found after 0:14')):
        replay.pause_at(position_s)
        replay.until(lambda: line.isVisible() and line.text().startswith(words), words)
    replay.pause_at(3.0)
    replay.until(lambda: not line.isVisible(), 'no drill')


def test_keys_that_drive_do_nothing(replay):
    replay.pause_at(14.0)
    replay.until(lambda: replay.robot('bot1').selected, 'the selection')
    for key in (Qt.Key_W, Qt.Key_A, Qt.Key_1, Qt.Key_0, Qt.Key_Return, Qt.Key_R):
        QTest.keyClick(replay.host.screen, key)
    QTest.keyClick(replay.host.screen, Qt.Key_Space, Qt.ShiftModifier)
    QTest.mouseClick(replay.host.screen.stop_bar.stop_button, Qt.LeftButton)
    replay.application.processEvents()
    assert not replay.state().playing
    assert replay.host.screen.stick() == (0.0, 0.0)
    assert replay.robot('bot1').selected and not replay.host.operator.view().stop_all
    assert replay.host.screen.drive_note.text() == NOTHING_DRIVES


def test_keys_go_to_the_next_mark_and_change_the_speed(replay):
    replay.pause_at(14.0)
    QTest.keyClick(replay.host.screen, Qt.Key_PageDown)
    replay.until(lambda: replay.state().settled and abs(
        replay.state().position_s - 15.0) < 0.01, 'the mark')
    QTest.keyClick(replay.host.screen, Qt.Key_Up)
    replay.until(lambda: replay.bar.speed_label.text() == '2\u00d7', 'twice the speed')
    QTest.keyClick(replay.host.screen, Qt.Key_Down)
    replay.until(lambda: replay.state().speed == 1.0, 'the speed it had')
    QTest.mouseClick(replay.bar.play_button, Qt.LeftButton)
    replay.until(lambda: replay.state().playing, 'it to play')


def test_no_velocity_topic_exists(replay):
    import rosgraph
    from mhri.session.foreign import VELOCITY_TYPES
    master = rosgraph.Master('/test')
    types = dict(master.getTopicTypes())
    published = [name for name, _ in master.getSystemState()[0]]
    assert '/bot1/odom' in published
    assert [name for name in published if types.get(name) in VELOCITY_TYPES] == []
