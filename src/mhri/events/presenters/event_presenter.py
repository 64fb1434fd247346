# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects changes of the screen to the event list, the bottom line and the tones.

Everything here runs on the GUI thread; a child process plays the tones.
"""
import queue
import time

from python_qt_binding.QtCore import QObject, QTimer, Signal

from mhri.base.part import MISSION, Part
from mhri.events.events import EventLog, LOST_TONE
from mhri.events.gui.event_list import EventList
from mhri.events.io.speaker import Speaker

# Delay of starting the speaker, which takes half a second of a core that the screen needs at first;
# an earlier tone starts it at once.
START_MS = 5000


class EventPresenter(QObject, Part):
    """The log of one screen, its page, its line at the bottom and its tones.

    :param status_of: function that returns the
        :class:`mhri.recording.recording.RecordingStatus` of a robot
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param make_speaker: function of ``on_absent`` that returns a
        :class:`mhri.events.io.speaker.Speaker`
    :param clock: function that returns time [s, monotonic]
    :param wall: function that returns time [s since 1970]
    """

    #: new :class:`mhri.events.events.Event` values, the oldest first
    changed = Signal(list)

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.backend.recordings.status, context.screen)

    def __init__(self, status_of, screen, make_speaker=Speaker, clock=time.monotonic,
                 wall=time.time):
        super().__init__(screen)
        self._clock, self._wall = clock, wall
        self.log = EventLog(status_of)
        self.page = EventList()
        self._screen = screen
        self._names = ()
        self._problems = queue.Queue()
        self._speaker = make_speaker(self._problems.put)
        self._sounds = True
        self._begin = QTimer(self, singleShot=True, interval=START_MS)
        self._connect()

    def _connect(self):
        self._screen.arrangement.add_section(MISSION, 'Events', self.page, 10, 'bell', True)
        self._screen.events_button.clicked.connect(
            lambda: self._screen.arrangement.show_page(self.page))
        for part in (self.page.robot_requested, self._screen.events_button.look_requested):
            part.connect(self._look_at)
        self.page.seen.connect(self._on_seen)
        self.page.sounds_switched.connect(self._switch)
        self._begin.timeout.connect(self._speaker.start)

    def start(self):
        """Schedule the start of the speaker."""
        self._begin.start()

    def show_view(self, view):
        """Handle a :class:`mhri.base.views.ScreenView`; call it on each redraw."""
        self._names = tuple(robot.name for robot in view.robots)
        self.page.show_robots(self._names)
        events = self.log.feed(view, self._clock(), self._wall())
        while not self._problems.empty():
            events.append(self._note('screen.note', 'no sound: ' + self._problems.get()))
        self._show(events)

    def note(self, kind, text, robot='', data=None):
        """Add an event that cannot be derived from views."""
        self._show([self._note(kind, text, robot, data)])

    def _note(self, kind, text, robot='', data=None):
        return self.log.note(kind, text, self._clock(), self._wall(), robot, data)

    def _show(self, events):
        """Show events and play their tones."""
        if not events:
            return
        self.page.add(events)
        for event in events:
            if event.sound == LOST_TONE or event.sound and self._sounds:
                self._speaker.play(event.sound)
        self._show_headline()
        self.changed.emit(events)

    def _show_headline(self):
        self._screen.events_button.show_headline(self.log.headline(), self.log.unseen)

    def _on_seen(self):
        """Mark all events as seen, because the operator turned to the list."""
        self.log.mark_seen()
        self._show_headline()

    def _look_at(self, name):
        """Show the robot of a line large, if it is still in the list."""
        if name in self._names:
            self._screen.look_at(name)

    def _switch(self, on):
        """Switch tones on or off, except the one for a robot lost while driven."""
        self._sounds = on

    def save_settings(self):
        """Return the saved state: JSON values."""
        return {'sounds': self._sounds}

    def restore_settings(self, settings):
        """Apply a dict of :meth:`save_settings`, possibly incomplete."""
        self._sounds = settings.get('sounds', True)
        self.page.show_sounds(self._sounds)

    def close(self, forget=False):
        """Close the speaker."""
        self._begin.stop()
        self._speaker.close()
