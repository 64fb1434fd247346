# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the session with the screen: R, N and P, the button, the note, and events both ways.

And those that were recorded before, with the page that lists them.

Everything here runs on the GUI thread; nothing waits.
"""
import collections

from mhri.base.part import Part
from mhri.base.views import ROS_CONNECTED, VIRTUAL_JOYSTICK
from mhri.session.gui.note_bar import NoteBar
from mhri.session.gui.record_button import RecordButton
from mhri.session.gui.sessions_page import SessionsPage, TITLE
from mhri.session.ros.session_client import SessionClient
from mhri.session.ros.session_shelf import SessionShelf


class SessionHost(Part):
    """The session of one screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param events: :class:`mhri.screen.presenters.event_host.EventHost`
    :param save_stills: saves every picture on show where no session is recorded
    :param client: :class:`mhri.session.ros.session_client.SessionClient`
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen, context.events, context.save_stills)

    def __init__(self, screen, events, save_stills, client=None):
        self._screen = screen
        self._events = events
        self._save_stills = save_stills
        self._client = client or SessionClient()
        self._started = False
        self._keys_drive = False
        # Of each mark that is on its way what the note bar knows, None for one without a note yet.
        self._marks = collections.deque()
        self._trouble = ''
        self._on = False
        self._build()
        self._connect()

    def _build(self):
        """Put button and note where the foot has room."""
        self.button = RecordButton(self._screen.foot)
        self._screen.small_row.insertWidget(1, self.button)
        self.note_bar = NoteBar(self._screen.foot)
        self._screen.foot_column.insertWidget(1, self.note_bar)
        self._screen.arrangement.foot.add_passing(self.note_bar)

    def _connect(self):
        """Wire keys, button and note."""
        self._screen.drive_keys.command_pressed.connect(self._on_command)
        self.button.clicked.connect(self.toggle)
        self.note_bar.noted.connect(self._client.note)
        self.note_bar.unmarked.connect(lambda text: self._events.note(
            'session.trouble', 'note without a mark: ' + text))
        self.note_bar.left.connect(self._screen.stage.setFocus)
        self._events.told.connect(self._client.tell)

    def _on_command(self, command):
        if command == 'record':
            self.toggle()
        elif command == 'mark':
            self._mark_by_key()
        elif command == 'stills':
            self._still()

    @property
    def recorded_s(self):
        """For how long it has been recorded [s], None while it is not."""
        view = self._client.view()
        return view.lasts_s if view.on else None

    def toggle(self):
        """Record the session, or end it."""
        self._client.record(not self._client.view().on)

    def mark(self):
        """Mark this moment."""
        self._marks.append(None)
        self._client.mark()

    def _mark_by_key(self):
        """Mark this moment, and ask at once: words typed after N must not be commands.

        While keys drive they go on; N once more, and the stick is centred and the note asked.
        """
        if self.note_bar.isVisible() and not self.note_bar.has_keyboard:
            self._screen.centre_stick()
            self.note_bar.take_keyboard()
            return
        self._marks.append(self.note_bar.ask_first(not self._screen.drive_keys.holding))
        self._client.mark()

    def _still(self):
        """Keep a still of every picture: with the session, where one is recorded."""
        if self._client.view().on:
            self._client.still()
        else:
            self._save_stills()

    def show_view(self, view):
        """Take in a :class:`mhri.base.views.PanelView`; call it with each drawing."""
        if not self._started and view.ros == ROS_CONNECTED:
            self._started = True
            self._client.start()
        self._keys_drive = view.mode == VIRTUAL_JOYSTICK and any(
            robot.selected for robot in view.robots)
        session = self._client.view()
        self.button.show_session(session)
        self._tell(session)
        while not self._client.answers.empty():
            self._show_answer(*self._client.answers.get())

    def _tell(self, session):
        """Make events of what changes."""
        if session.on != self._on:
            self._on = session.on
            self._events.note('session.begun' if session.on else 'session.ended',
                              'session recorded to ' + session.folder if session.on
                              else 'session no longer recorded: ' + session.folder)
        if session.trouble != self._trouble:
            self._trouble = session.trouble
            if session.trouble:
                self._events.note('session.trouble', 'session: ' + session.trouble)

    def _show_answer(self, asked, done, text, name):
        """Say what has become of a request."""
        mark = self._marks.popleft() if asked == 'mark' and self._marks else None
        if not done and asked == 'still':
            self._save_stills()
        elif not done:
            self._events.note('session.trouble', text)
        elif asked == 'mark':
            self._events.note('session.mark', text)
        if mark is not None:
            self.note_bar.settle(mark, name if done else '', '' if done else text)
        elif asked == 'mark' and done:
            self.note_bar.ask(name, not self._keys_drive)
        self._screen.show_look_result(text)

    def disable(self):
        """Record nothing."""
        self.button.hide()

    def close(self):
        """End it."""
        self._client.close()


class ShelfHost(Part):
    """The page of recorded sessions of one screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param shelf: :class:`mhri.session.ros.session_shelf.SessionShelf`
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen)

    def __init__(self, screen, shelf=None):
        self._shelf = shelf or SessionShelf()
        self.page = SessionsPage()
        self.button = screen.arrangement.looks.add_part(TITLE, self.page)
        self._connect()

    def _connect(self):
        """Wire what is asked for."""
        self.page.shown.connect(self._shelf.look)
        self.page.replay_requested.connect(self._shelf.replay)
        self.page.report_requested.connect(self._shelf.report)
        self.page.cancel_requested.connect(self._shelf.cancel)

    def show_view(self, view):
        """Show what has come meanwhile."""
        while not self._shelf.news.empty():
            kind, value = self._shelf.news.get()
            if kind == 'rows':
                self.page.show_rows(value)
            elif kind == 'progress':
                self.page.show_progress(value)
            elif kind == 'told':
                self.page.show_note(value)
            else:
                self.page.show_progress(None)
                if value:
                    self.page.show_note('the report is {}'.format(value))

    def close(self):
        """End the report under way."""
        self._shelf.close()
