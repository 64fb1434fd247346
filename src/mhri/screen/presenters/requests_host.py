# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the panel as a whole: recordings of several robots, and requests from elsewhere.

Joins widgets and the ROS side; everything here runs on the GUI thread.
"""
from mhri.recording.recording import ENDED, OFF, read_fallback, RECORDING
from mhri.screen.requests import (
    check_request, MARK, RECORD, RequestRefused, selection_after, STOP_RECORDING)


def short_ends(ends):
    """Return how recordings ended, in fewer and fewer words, failures first.

    :param ends: pairs (robot's name, its :class:`mhri.recording.recording.RecordingStatus`)
    """
    kinds = (('not saved', [name for name, status in ends if status.state != ENDED]),
             ('saved elsewhere', [name for name, status in ends if status.state == ENDED
                                  and read_fallback(status.note)[0]]),
             ('saved', [name for name, status in ends if status.state == ENDED
                        and not read_fallback(status.note)[0]]))
    kinds = [(words, names) for words, names in kinds if names]
    return (', '.join('{} {}'.format(words, ', '.join(names)) for words, names in kinds),
            ', '.join('{} {}'.format(len(names), words) for words, names in kinds))


class RequestsHost:
    """Carries out requests.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param tell: function that shows the operator a sentence
    :param select: function that selects exactly the robots of a list
    :param recording_wish: function from a robot's name to (path, choices) as its tile has them
    :param mark: function that marks this moment of the session
    """

    def __init__(self, operator, tell, select, recording_wish, mark=lambda: None):
        self._operator = operator
        self._tell = tell
        self._select = select
        self._recording_wish = recording_wish
        self._mark = mark
        self._asked = set()
        self._ends = []

    def carry_out(self, action, names):
        """Carry out a ``mhri/PanelRequest``; if that fails, show and return the reason, else ''."""
        selection = self._operator.selection
        try:
            check_request(action, names, selection.robots)
            if action == RECORD:
                self.record(names or selection.selected)
            elif action == MARK:
                self._mark()
            elif action == STOP_RECORDING:
                self.stop_recording(names or self._operator.recordings.running())
            else:
                self._select(list(selection_after(
                    action, names, selection.robots, selection.selected)))
        except RequestRefused as error:
            text = 'not done: {}'.format(error)
            self._tell(text)
            return text
        return ''

    def record(self, names):
        """Start recording robots, each with the settings of its tile."""
        if not names:
            self._tell('nothing to record: select a robot first')
        self._ends = []
        for name in names:
            self._operator.record(name, *self._recording_wish(name))
            self._asked.add(name)

    def stop_recording(self, names):
        """End the recordings of robots."""
        for name in names:
            self._operator.recordings.stop(name)

    def end_recording(self, name):
        """End the recording of a robot that leaves the list, and say what has become of it.

        :returns: whether there was one
        """
        running = name in self._operator.recordings.running()
        if running:
            self._ends = []
            self._asked.add(name)
            self._operator.recordings.stop(name)
        return running

    def tell_ends(self):
        """Report on the recordings that were started here and have ended."""
        ended = []
        for name in sorted(self._asked):
            status = self._operator.recordings.status(name)
            if status.state != RECORDING:
                self._asked.discard(name)
                ended.append((name, status))
        if ended:
            self._ends += ended
            self._tell('; '.join('{}: {}'.format(
                name, status.note if status.state != OFF
                else 'not recorded, its type is not known yet') for name, status in self._ends),
                shorter=short_ends(self._ends))
