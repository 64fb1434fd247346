# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the session to the screen: keys R, N and P, button, notes, flags, events both ways.

Also the page of recorded sessions. Everything here runs on the GUI thread and never blocks.
"""
import collections
from dataclasses import replace

from mhri.base.part import MISSION, Part
from mhri.base.views import ROS_CONNECTED
from mhri.events.events import MARKED
from mhri.recording.folder import SessionMark
from mhri.session.gui.note_bar import note_button, NoteBar
from mhri.session.gui.record_button import RecordButton
from mhri.session.gui.sessions_page import SessionsPage, TITLE
from mhri.session.ros.session_client import SessionClient
from mhri.session.ros.session_library import SessionLibrary


class SessionPresenter(Part):
    """The session of one screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param events: :class:`mhri.events.presenters.event_presenter.EventPresenter`
    :param save_stills: function that saves every displayed picture, used without a session
    :param client: :class:`mhri.session.ros.session_client.SessionClient`
    """

    @classmethod
    def of(cls, context, client=None):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen, context.parts['events'], context.tiles.save_stills, client)

    def __init__(self, screen, events, save_stills, client=None):
        self._screen = screen
        self._events = events
        self._save_stills = save_stills
        self._client = client or SessionClient()
        self._started = self._pushed = False
        # Of each mark asked for: the handle of the note bar, the robot in view; of each note asked
        # for: the mark, the text.
        self._marks, self._notes = collections.deque(), collections.deque()
        # {mark: the robot that was in view}
        self._robots = {}
        self._trouble = ''
        self._on = False
        self._build()
        self._connect()

    def _build(self):
        """Place the buttons in the foot, and the note bar above it."""
        self.button = RecordButton(self._screen.foot)
        self.note_button = note_button(self._screen.foot)
        for place, button in enumerate((self.button, self.note_button), 1):
            self._screen.small_row.insertWidget(place, button)
        self.note_bar = NoteBar(self._screen.foot)
        self._screen.arrangement.passing.add(self.note_bar)

    def _connect(self):
        """Connect keys, button and note bar."""
        self._screen.drive_keys.command_pressed.connect(self._on_command)
        self.button.clicked.connect(self.toggle)
        self.note_button.clicked.connect(self._mark_or_note)
        self.note_bar.noted.connect(self._note)
        self.note_bar.unmarked.connect(lambda text: self._events.note(
            'session.trouble', 'note without a mark: ' + text))
        self.note_bar.left.connect(self._screen.stage.setFocus)
        self._events.changed.connect(self._client.publish_events)

    def _on_command(self, command):
        if command == 'record':
            self.toggle()
        elif command == 'mark':
            self._mark_or_note()
        elif command == 'stills':
            self._still()

    @property
    def recorded_s(self):
        """The duration of the recording so far [s], None if not recording."""
        view = self._client.view()
        return view.lasts_s if view.on else None

    def toggle(self):
        """Start or stop recording the session."""
        self._client.record(not self._client.view().on)

    def mark(self, take_keyboard=False):
        """Mark this moment, at the robot in view, and ask for a note.

        :param take_keyboard: whether the note has the keyboard at once; not by pad or voice
        """
        stage = self._screen.stage
        self._marks.append((self.note_bar.ask(take_keyboard),
                            stage.looked_at or next(iter(stage.large), '')))
        self._client.mark()

    def _mark_or_note(self):
        """Mark this moment; the note has the keyboard, so that keys typed after N do nothing else.

        While a stick is held, the keyboard stays with the robots; a second N centres the stick and
        focuses the note.
        """
        if self.note_bar.isVisible() and not self.note_bar.has_keyboard:
            self._screen.centre_stick()
            self.note_bar.take_keyboard()
            return
        self.mark(not (self._pushed or self._screen.drive_keys.holding
                       or any(self._screen.stick())))

    def _note(self, name, text):
        """Save the note of a mark."""
        self._notes.append((name, text))
        self._client.note(name, text)

    def amend(self, view):
        """Add the flags of the session's marks."""
        return replace(view, flags=self._client.flags())

    def _still(self):
        """Save a still of every picture, into the session if one is being recorded."""
        if self._client.view().on:
            self._client.still()
        else:
            self._save_stills()

    def show_view(self, view):
        """Handle a :class:`mhri.base.views.ScreenView`; call it on each redraw."""
        if not self._started and view.ros == ROS_CONNECTED:
            self._started = True
            self._client.start()
        self._pushed = view.pushed
        session = self._client.view()
        self.button.show_session(session)
        self._report_changes(session)
        while not self._client.answers.empty():
            self._show_answer(*self._client.answers.get())

    def _report_changes(self, session):
        """Report changes as events."""
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
        """Show the outcome of a request."""
        if asked == 'mark':
            self._show_mark(done, text, name)
        elif asked == 'note':
            self._show_note(done, text)
        elif not done and asked == 'still':
            self._save_stills()
        elif not done:
            self._events.note('session.trouble', text)
        self._screen.show_look_result(text)

    def _show_mark(self, done, text, name):
        """Show a mark as an event, and let its note have its name."""
        handle, robot = self._marks.popleft()
        if done:
            self._robots[name] = robot
            self._events.note(MARKED, text, robot, {'mark': name})
        else:
            self._events.note('session.trouble', text)
        self.note_bar.settle(handle, name if done else '', '' if done else text)

    def _show_note(self, done, text):
        """Show a note in the place of its mark, or what was not noted."""
        name, note = self._notes.popleft()
        if done:
            words = SessionMark(name, 0.0, 0.0, note, {}, ()).words
            self._events.note(MARKED, words, self._robots.get(name, ''),
                              {'mark': name, 'note': note})
        else:
            self._events.note('session.trouble', '{}: {}'.format(text, note))

    def disable(self):
        """Hide the buttons."""
        self.button.hide()
        self.note_button.hide()

    def close(self, forget=False):
        """Disconnect."""
        self._client.close()


class LibraryPresenter(Part):
    """The page of recorded sessions of one screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param library: :class:`mhri.session.ros.session_library.SessionLibrary`
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.screen)

    def __init__(self, screen, library=None):
        self._library = library or SessionLibrary()
        self.page = SessionsPage()
        screen.arrangement.add_section(MISSION, TITLE, self.page, 20, 'history')
        self._connect()

    def _connect(self):
        """Connect the requests."""
        self.page.shown.connect(lambda seen: seen and self._library.refresh())
        self.page.replay_requested.connect(self._library.replay)
        self.page.report_requested.connect(self._library.report)
        self.page.cancel_requested.connect(self._library.cancel)

    def show_view(self, view):
        """Show the news of the library."""
        while not self._library.news.empty():
            kind, value = self._library.news.get()
            if kind == 'rows':
                self.page.show_rows(value)
            elif kind == 'progress':
                self.page.show_progress(value)
            elif kind == 'message':
                self.page.show_note(value)
            else:
                self.page.show_progress(None)
                if value:
                    self.page.show_note('the report is {}'.format(value))

    def close(self, forget=False):
        """End the report under way."""
        self._library.close()
