# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins changes on the screen with the event list, the bottom line and the tones.

Everything here runs on the GUI thread; a child process plays the tones.
"""
import queue
import time

from python_qt_binding.QtCore import QObject, QTimer, Signal

from mhri.events.events import EventLog, LOST_TONE
from mhri.events.gui.event_list import EventList
from mhri.events.io.speaker import Speaker

# Starting takes half a second of a core, which the screen itself needs at first; a tone that must
# be heard before does not wait for it.
START_MS = 5000


class EventHost(QObject):
    """The log of one screen, its page, its line at the bottom and its tones.

    :param status_of: function that returns the
        :class:`mhri.recording.recording.RecordingStatus` of a robot
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param make_speaker: function of ``on_absent`` that makes a
        :class:`mhri.events.io.speaker.Speaker`
    :param clock: function that returns seconds that never go back
    :param wall: function that returns seconds since 1970
    """

    #: the :class:`mhri.events.events.Event` values that are new, the oldest first
    told = Signal(list)

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
        self._begin = QTimer(self)
        self._begin.setSingleShot(True)
        self._begin.setInterval(START_MS)
        self._connect()

    def _connect(self):
        self._screen.arrangement.add_page('Events', self.page)
        self._screen.events_button.clicked.connect(
            lambda: self._screen.arrangement.show_page(self.page))
        self.page.robot_requested.connect(self._look_at)
        self.page.seen.connect(self._on_seen)
        self.page.sounds_switched.connect(self._switch)
        self._begin.timeout.connect(self._speaker.start)

    def start(self):
        """Prepare the sound, a little later."""
        self._begin.start()

    def show(self, view):
        """Take in a :class:`mhri.base.views.PanelView`; call it with each drawing."""
        self._names = tuple(robot.name for robot in view.robots)
        self.page.show_robots(self._names)
        events = self.log.feed(view, self._clock(), self._wall())
        while not self._problems.empty():
            events.append(self._note('screen.note', 'no sound: ' + self._problems.get()))
        self._tell(events)

    def note(self, kind, text, robot=''):
        """Take in what no view says, e.g. ``('request.refused', 'not done: ...')``.

        :param kind: a key of :data:`mhri.events.events.KINDS`
        """
        self._tell([self._note(kind, text, robot)])

    def _note(self, kind, text, robot=''):
        return self.log.note(kind, text, self._clock(), self._wall(), robot)

    def _tell(self, events):
        """Show events and play their tones."""
        if not events:
            return
        self.page.add(events)
        for event in events:
            if event.sound == LOST_TONE or event.sound and self._sounds:
                self._speaker.play(event.sound)
        self._show_headline()
        self.told.emit(events)

    def _show_headline(self):
        self._screen.events_button.show_headline(self.log.headline(), self.log.unseen)

    def _on_seen(self):
        """Take in that the operator has turned to the list."""
        self.log.see()
        self._show_headline()

    def _look_at(self, name):
        """Look at the robot of a line, if it is still in the list."""
        if name in self._names:
            self._screen.look_at(name)

    def _switch(self, on):
        """Take in whether tones are wanted; the one for a robot lost while driven always is."""
        self._sounds = on

    def save_settings(self):
        """Return what is kept between runs: JSON values."""
        return {'sounds': self._sounds}

    def restore_settings(self, settings):
        """Take back a dict of :meth:`save_settings`, even if parts are missing."""
        self._sounds = settings.get('sounds', True)
        self.page.show_sounds(self._sounds)

    def close(self):
        """End the tones."""
        self._begin.stop()
        self._speaker.close()
