# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the panel as a whole: recordings of several robots, and external requests.

Connects widgets and the backend; everything here runs on the GUI thread.
"""
from mhri.accessories.controls import meant, refusal
from mhri.recording.recording import ENDED, OFF, RECORDING
from mhri.screen.requests import (
    ACCESSORY, check_request, MARK, RECORD, RequestRefused, selection_after, STOP_RECORDING)


def short_ends(ends):
    """Return summaries of the ends of recordings, longest first, each with failures first.

    :param ends: pairs (robot, its :class:`mhri.recording.recording.RecordingStatus`)
    """
    kinds = (('not saved', [name for name, status in ends if status.state != ENDED]),
             ('saved elsewhere', [name for name, status in ends if status.state == ENDED
                                  and status.elsewhere]),
             ('saved', [name for name, status in ends if status.state == ENDED
                        and not status.elsewhere]))
    kinds = [(words, names) for words, names in kinds if names]
    return (', '.join('{} {}'.format(words, ', '.join(names)) for words, names in kinds),
            ', '.join('{} {}'.format(len(names), words) for words, names in kinds))


class RequestsPresenter:
    """Carries out requests.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param show: function that shows the operator a sentence
    :param select: function that selects exactly the robots of a list
    :param recording_wish: function of a robot's name that returns (path, choices) of its tile
    :param mark: function that marks this moment of the session
    :param looked_at: function that returns the name of the robot in the large tile, '' for none
    """

    def __init__(self, operator, show, select, recording_wish, mark=lambda: None,
                 looked_at=lambda: ''):
        self._operator = operator
        self._show = show
        self._select = select
        self._recording_wish = recording_wish
        self._mark = mark
        self._looked_at = looked_at
        self._asked = set()
        self._ends = []

    def carry_out(self, action, names, key='', choice=''):
        """Carry out a ``mhri/PanelRequest``; if that fails, show and return the reason, else ''.

        :param key: of an accessory, and ``choice`` what it should do
        """
        selection = self._operator.selection
        try:
            check_request(action, names, selection.robots)
            if action == RECORD:
                self.record(names or selection.selected)
            elif action == ACCESSORY:
                self._use(names, key, choice)
            elif action == MARK:
                self._mark()
            elif action == STOP_RECORDING:
                self.stop_recording(names or self._operator.recordings.running())
            else:
                self._select(list(selection_after(
                    action, names, selection.robots, selection.selected)))
        except RequestRefused as error:
            text = 'not done: {}'.format(error)
            self._show(text)
            return text
        return ''

    def _use(self, names, key, choice):
        """Use an accessory.

        :raises RequestRefused: it does not act
        """
        view = self._operator.view()
        names = names or meant(view, key, self._looked_at())
        problem = refusal([robot for robot in view.robots if robot.name in names], key, choice,
                          view)
        if problem:
            raise RequestRefused(problem)
        self._operator.use_accessory(names, key, choice)

    def record(self, names):
        """Start to record robots, each with the settings of its tile."""
        if not names:
            self._show('nothing to record: select a robot first')
        self._ends = []
        for name in names:
            self._operator.record(name, *self._recording_wish(name))
            self._asked.add(name)

    def stop_recording(self, names):
        """End the recordings of robots."""
        for name in names:
            self._operator.recordings.stop(name)

    def end_recording(self, name):
        """End and report the recording of a robot that is removed from the list.

        :returns: whether the robot was being recorded
        """
        running = name in self._operator.recordings.running()
        if running:
            self._ends = []
            self._asked.add(name)
            self._operator.recordings.stop(name)
        return running

    def report_ends(self):
        """Report the recordings started here that have ended."""
        ended = []
        for name in sorted(self._asked):
            status = self._operator.recordings.status(name)
            if status.state != RECORDING:
                self._asked.discard(name)
                ended.append((name, status))
        if ended:
            self._ends += ended
            self._show('; '.join('{}: {}'.format(
                name, status.words if status.state != OFF
                else 'not recorded, its type is not known yet') for name, status in self._ends),
                shorter=short_ends(self._ends))
