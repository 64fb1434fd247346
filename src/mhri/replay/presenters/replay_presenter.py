# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen of a replay: the recorded session with a timeline; it cannot drive."""
from contextlib import closing
import os

from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui.layouts import in_column, TIGHT
from mhri.base.io.files import text_in
from mhri.base.view_rows import CAMERAS
from mhri.events.events import ALARM, ATTENTION, CALM, Event
from mhri.events.presenters.event_presenter import EventPresenter
from mhri.recording.folder import ERROR, EVENTS_JSONL, INFO, NotASession, read_events, WARNING
from mhri.recording.ros.bag_set import bags_in
from mhri.replay.ros.replay_backend import ReplayBackend
from mhri.replay.ros.replay_session import ReplaySession
from mhri.replay.ros.replay_tasks import ReplayTasks
from mhri.screen.parts import PARTS
from mhri.screen.presenters.screen_presenter import ScreenPresenter
from mhri.session.gui.replay_keys import REPLAY_ROWS, ReplayKeys
from mhri.session.gui.time_line import NOTHING_DRIVES, TimeLineBar
from mhri.session.presenters.session_presenter import SessionPresenter
from mhri.session.timeline import read_time_line
from mhri.tasks.presenters.task_presenter import TaskPresenter

_SEVERITIES = {INFO: CALM, WARNING: ATTENTION, ERROR: ALARM}


def read_lines(path):
    """Return the events of a session's folder; none if the path is not a session (blocking).

    Their times are those of the player (:meth:`BagSet.folded`).

    :raises NotASession: the events or the bags cannot be read; the text has the reason
    """
    path = os.path.expanduser(path)
    try:
        lines = read_events(text_in(os.path.join(path, EVENTS_JSONL)))
        if lines:
            with closing(bags_in(path)) as bags:
                lines = list(map(bags.folded, lines))
        return lines
    except (OSError, NotASession) as error:
        raise NotASession('{}: {}'.format(path, getattr(error, 'strerror', error)))


class ReplayEvents(EventPresenter):
    """The list of the recorded events up to the current time of the replay, without sounds."""

    def __init__(self, status_of, screen):
        super().__init__(status_of, screen)
        self._shown = 0

    def start(self):
        """Do nothing: a replay plays no sounds."""

    def show_view(self, view):
        """Update the list of robots."""
        self._names = tuple(robot.name for robot in view.robots)
        self.page.show_robots(self._names)

    def note(self, kind, text, robot='', data=None):
        """Ignore events of this screen: they were not recorded."""

    def show_until(self, events):
        """Show the session's lines up to the current time of the replay."""
        if len(events) < self._shown:
            self._shown = 0
            self.page.model.clear()
        if len(events) > self._shown:
            self.page.add([Event(number, event.wall, event.robot,
                                 _SEVERITIES.get(event.severity, CALM), event.kind, event.text)
                           for number, event in enumerate(events, 1) if number > self._shown])
            self._shown = len(events)


class ReplayedSession(SessionPresenter):
    """The session whose replay it is: its marks up to the current time."""

    @classmethod
    def of(cls, context, client=None):
        """Create it for a screen whose backend is a replay."""
        return super().of(context, ReplaySession(context.backend.history,
                                                 context.backend.clock.wall))


class ReplayedTasks(TaskPresenter):
    """The tasks of robots at the current time of the replay."""

    @classmethod
    def of(cls, context, client=None):
        """Create it for a screen whose backend is a replay."""
        client = ReplayTasks(context.backend.history, context.backend.clock.wall)
        context.backend.on_jump = client.forget
        return super().of(context, client)


class ReplayPresenter(ScreenPresenter):
    """A :class:`ScreenPresenter` that shows a replay.

    :param operator: :class:`mhri.replay.ros.replay_backend.ReplayBackend`
    :param lines: the :class:`mhri.recording.folder.SessionEvent` values of the session
    """

    rows = tuple({**dict(PARTS), 'events': __name__ + '.ReplayEvents',
                  'session': __name__ + '.ReplayedSession',
                  'tasks': __name__ + '.ReplayedTasks'}.items())

    def __init__(self, operator, lines=()):
        self._lines = tuple(lines)
        self._line = None
        # {robot: the kind of picture that was recorded of it last}
        self._pictures = {}
        self.bar = TimeLineBar()
        super().__init__(operator)

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
        screen.robot_menu.disable()
        screen.key_help.show_rows(REPLAY_ROWS)
        for part in (screen.drive_side, screen.add_button, screen.name_edit,
                     screen.remove_button, screen.all_button, screen.none_button):
            part.setEnabled(False)

    def widget(self):
        """Return one widget with the screen and the timeline below it."""
        whole = QWidget()
        in_column((self.screen, 1), self.bar, of=whole, margins=TIGHT, gap=0)
        return whole

    def draw(self):
        """Draw the recorded screen and the position in time."""
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
            tile.show_idle(NOTHING_DRIVES)
            tile.recording.setEnabled(False)
        self._choose_pictures()
        state = self.operator.replay()
        if state is not None:
            self._show_place(state)

    def _choose_pictures(self):
        """Switch each tile to the kind of picture that was recorded, whenever that changes."""
        recorded = self.operator.pictures
        for name, tile in self.windows.items():
            kind, chosen = recorded.get(name), set(tile.switches.chosen())
            if kind and kind != self._pictures.get(name):
                self._pictures[name] = kind
                if chosen & CAMERAS:
                    tile.switches.choose(chosen - CAMERAS | {kind})

    def _show_place(self, state):
        """Show the player's state."""
        if self._line is None:
            self._line = read_time_line(self._lines, state.start.to_sec(), state.length_s)
        numbers = self.operator.selection.numbered()
        if numbers != self.bar.numbers:
            self.bar.show_time_line(self._line, numbers)
        if state.settled:
            self.bar.show_state(state.position_s, state.speed, state.playing)
            self.parts['events'].show_until(self._line.events_until(state.position_s))

    def asks_before_closing(self):
        """Return no question: a replay neither drives nor records."""
        return ''

    def close(self, forget=False):
        """Close everything."""
        QApplication.instance().removeEventFilter(self._keys)
        super().close(forget)


def make_presenter(argv, path):
    """Create the screen of a session's replay (blocking: reads the events).

    :raises NotASession: the events cannot be read
    """
    lines = read_lines(path)
    return ReplayPresenter(ReplayBackend(argv, lines), lines)
