# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins what changes on the screen with the event list, the bottom line and the tones.

Everything here runs on the GUI thread; the tones are a child process's.
"""
import queue
import time

from python_qt_binding.QtCore import QObject, Signal

from mhri.core.screen.events import EventLog, LOST_TONE
from mhri.gui.screen.event_list import EventList
from mhri.inputs.speaker import Speaker


class EventHost(QObject):
    """The log of one screen, its list and its tones.

    :param status_of: function that returns the
        :class:`mhri.core.recording.recording.RecordingStatus` of a robot
    :param make_speaker: function of ``on_absent`` that makes a
        :class:`mhri.inputs.speaker.Speaker`
    :param clock: function that returns seconds that never go back
    :param wall: function that returns seconds since 1970
    """

    #: the :class:`mhri.core.screen.events.Event` values that are new, the oldest first
    told = Signal(list)

    def __init__(self, status_of, make_speaker=Speaker, clock=time.monotonic, wall=time.time,
                 parent=None):
        super().__init__(parent)
        self._clock, self._wall = clock, wall
        self.log = EventLog(status_of)
        #: the widget, without a parent: whoever owns the screen places it
        self.list = EventList()
        self._problems = queue.Queue()
        self._speaker = make_speaker(self._problems.put)
        self._sounds = True
        self.list.seen.connect(self.log.see)
        self.list.sounds_switched.connect(self._switch)

    def start(self):
        """Start the tones; returns at once."""
        self._speaker.start()

    def show(self, view):
        """Take in a :class:`mhri.core.screen.views.PanelView`; call it with each drawing."""
        self.list.show_robots(robot.name for robot in view.robots)
        events = self.log.feed(view, self._clock(), self._wall())
        while not self._problems.empty():
            events.append(self._note('screen.trouble', 'no sound: ' + self._problems.get()))
        self._tell(events)

    def note(self, kind, text, robot=''):
        """Take in what no view tells, e.g. ``('request.refused', 'not done: ...')``.

        :param kind: a key of :data:`mhri.core.screen.events.KINDS`
        """
        self._tell([self._note(kind, text, robot)])

    def headline(self):
        """Return the :class:`mhri.core.screen.events.Headline` for the bottom line."""
        return self.log.headline()

    def _note(self, kind, text, robot=''):
        return self.log.note(kind, text, self._clock(), self._wall(), robot)

    def _tell(self, events):
        """Show events, and let them be heard."""
        if not events:
            return
        self.list.add(events)
        for event in events:
            if event.sound == LOST_TONE or event.sound and self._sounds:
                self._speaker.play(event.sound)
        self.told.emit(events)

    def _switch(self, on):
        """Take in whether tones are wanted; that of a robot lost while driven always is."""
        self._sounds = on

    def save_settings(self):
        """Return what is kept between runs: JSON values."""
        return {'sounds': self._sounds}

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`, or one that lacks some of it."""
        self._sounds = settings.get('sounds', True)
        self.list.show_sounds(self._sounds)

    def close(self):
        """End the tones."""
        self._speaker.close()
