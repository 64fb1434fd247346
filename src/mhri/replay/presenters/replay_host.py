# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen of a replay: what was recorded, a time line below it, and nothing that drives."""
import os

from python_qt_binding.QtWidgets import QApplication, QVBoxLayout, QWidget

from mhri.events.events import ALARM, ATTENTION, CALM, Event
from mhri.recording.folder import ERROR, EVENTS_JSONL, INFO, NotASession, read_events, WARNING
from mhri.replay.ros.replay_backend import ReplayBackend
from mhri.replay.ros.replay_tasks import ReplayTasks
from mhri.screen.presenters.event_host import EventHost
from mhri.screen.presenters.screen_host import ScreenHost
from mhri.session.gui.replay_keys import REPLAY_ROWS, ReplayKeys
from mhri.session.gui.time_line import NOTHING_DRIVES, TimeLineBar
from mhri.session.timeline import read_time_line

_SEVERITIES = {INFO: CALM, WARNING: ATTENTION, ERROR: ALARM}


def read_lines(path):
    """Return the events of a session's folder, none of anything else (blocking).

    :raises NotASession: they cannot be read; the text says why
    """
    try:
        with open(os.path.join(os.path.expanduser(path), EVENTS_JSONL), encoding='utf-8',
                  errors='replace') as stream:
            return read_events(stream.read())
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        raise NotASession('{}: {}'.format(path, error.strerror))


class ReplayEvents(EventHost):
    """The list of events as far as the replay has come: those recorded, silent, no others."""

    def __init__(self, status_of, screen):
        super().__init__(status_of, screen)
        self._shown = 0

    def start(self):
        """Prepare no sound."""

    def show(self, view):
        """Take in which robots there are."""
        self._names = tuple(robot.name for robot in view.robots)
        self.page.show_robots(self._names)

    def note(self, kind, text, robot=''):
        """Leave out what this screen says by itself: it was not so then."""

    def show_until(self, events):
        """Show the lines of a session that had been written by now."""
        if len(events) < self._shown:
            self._shown = 0
            self.page.model.clear()
        if len(events) > self._shown:
            self.page.add([Event(number, event.wall, event.robot,
                                 _SEVERITIES.get(event.severity, CALM), event.kind, event.text)
                           for number, event in enumerate(events, 1) if number > self._shown])
            self._shown = len(events)


class ReplayHost(ScreenHost):
    """A :class:`ScreenHost` that shows a replay.

    :param operator: :class:`mhri.replay.ros.replay_backend.ReplayBackend`
    :param lines: the :class:`mhri.recording.folder.SessionEvent` values of the session
    """

    def __init__(self, operator, lines=()):
        self._lines = tuple(lines)
        self._line = None
        self.bar = TimeLineBar()
        tasks = ReplayTasks(operator.recalled, operator.clock.wall)
        operator.on_jump = tasks.forget
        super().__init__(operator, events=ReplayEvents, tasks=tasks)

    def _connect(self):
        super()._connect()
        self._keys = ReplayKeys(self.bar)
        QApplication.instance().installEventFilter(self._keys)
        self.bar.play_requested.connect(
            lambda play: self.operator.control('play' if play else 'pause'))
        self.bar.seek_requested.connect(lambda at_s: self.operator.control('seek', at_s))
        self.bar.speed_requested.connect(lambda speed: self.operator.control('speed', speed))
        screen = self.screen
        screen.stop_bar.show_idle(NOTHING_DRIVES)
        screen.key_help.show_rows(REPLAY_ROWS)
        for part in (screen.drive_side, self.tasks.page, screen.add_button, screen.name_edit,
                     screen.remove_button, screen.all_button, screen.none_button):
            part.setEnabled(False)

    def widget(self):
        """Return the screen with the time line below it, in one widget."""
        whole = QWidget()
        column = QVBoxLayout(whole)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.screen, 1)
        column.addWidget(self.bar)
        return whole

    def draw(self):
        """Draw the screen as it was, and where we are."""
        super().draw()
        screen = self.screen
        screen.joystick.show_active(False)
        for part in self.parts.values():
            part.disable()
        screen.drive_note.show_text(NOTHING_DRIVES)
        for part in (screen.record_button, screen.all_button, screen.none_button,
                     screen.look_button):
            part.setEnabled(False)
        for tile in self.windows.values():
            tile.header.show_replay()
            tile.stop_button.show_idle(NOTHING_DRIVES)
            tile.recording.setEnabled(False)
        state = self.operator.replay()
        if state is not None:
            self._show_place(state)

    def _show_place(self, state):
        """Show the player's word on where it is."""
        if self._line is None:
            self._line = read_time_line(self._lines, state.start.to_sec(), state.length_s)
        numbers = self.operator.selection.numbered()
        if numbers != self.bar.numbers:
            self.bar.show_time_line(self._line, numbers)
        if state.settled:
            self.bar.show_state(state.position_s, state.speed, state.playing)
            self.events.show_until(self._line.events_until(state.position_s))

    def asks_before_closing(self):
        """Ask nothing: what drove or recorded did so then."""
        return ''

    def close(self, forget=False):
        """Close everything."""
        QApplication.instance().removeEventFilter(self._keys)
        super().close(forget)


def make_host(argv, path):
    """Return the screen of a session's replay (blocking: it reads its events).

    :raises NotASession: its events cannot be read
    """
    lines = read_lines(path)
    return ReplayHost(ReplayBackend(argv, lines), lines)
