# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the session with the screen: R, N and P, the button, the note, and events both ways.

Everything here runs on the GUI thread; nothing waits.
"""
from mhri.core.screen.views import ROS_CONNECTED
from mhri.core.screen.why import VIRTUAL_JOYSTICK
from mhri.gui.session.note_bar import NoteBar
from mhri.gui.session.record_button import RecordButton
from mhri.ros.session.session_client import SessionClient


class SessionHost:
    """The session of one screen.

    :param screen: :class:`mhri.gui.screen.screen.ScreenWidget`
    :param events: :class:`mhri.presenters.event_host.EventHost`
    :param save_stills: saves every picture on show where no session is recorded
    :param client: :class:`mhri.ros.session.session_client.SessionClient`
    """

    def __init__(self, screen, events, save_stills, client=None):
        self._screen = screen
        self._events = events
        self._save_stills = save_stills
        self._client = client or SessionClient()
        self._started = False
        self._keys_drive = False
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

    def _connect(self):
        """Wire keys, button and note."""
        self._screen.drive_keys.command_pressed.connect(self._on_command)
        self.button.clicked.connect(self.toggle)
        self.note_bar.noted.connect(self._client.note)
        self.note_bar.left.connect(self._screen.stage.setFocus)
        self._events.told.connect(self._client.tell)

    def _on_command(self, command):
        if command == 'record':
            self.toggle()
        elif command == 'mark':
            self.mark()
        elif command == 'stills':
            self._still()

    @property
    def recorded(self):
        """Whether the session is recorded now."""
        return self._client.view().on

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
        self._client.mark()

    def _still(self):
        """Keep a still of every picture: with the session, where one is recorded."""
        if self._client.view().on:
            self._client.still()
        else:
            self._save_stills()

    def show_view(self, view):
        """Take in a :class:`mhri.core.screen.views.PanelView`; call it with each drawing."""
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

    def _show_answer(self, asked, done, text, mark):
        """Say what has become of a request."""
        if not done and asked == 'still':
            self._save_stills()
        elif not done:
            self._events.note('session.trouble', text)
        elif asked == 'mark':
            self._events.note('session.mark', text)
            self.note_bar.ask(mark, not self._keys_drive)
        self._screen.show_look_result(text)

    def close(self):
        """End it."""
        self._client.close()
