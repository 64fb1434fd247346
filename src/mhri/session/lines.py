# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the lines of a session come from, so that none comes twice.

Mode, selection, control and stop are seen on the graph by whoever keeps the session, with or
without a screen. Everything else a screen works out of what it shows; of several screens the one in
control. Without a screen a robot's silence is seen here, too.
"""
from typing import Dict, Iterable, List, Mapping, Optional, Tuple

from mhri.base.text import tidy_text
from mhri.events.events import ALARM, ATTENTION, CALM
from mhri.recording.folder import ERROR, INFO, SessionEvent, WARNING

# (kind, severity, robot, text)
Line = Tuple[str, str, str, str]

_SEVERITIES = {CALM: INFO, ATTENTION: WARNING, ALARM: ERROR}
# Subjects of a screen's events that are seen here.
_SEEN_HERE = frozenset(('mode', 'drive', 'control', 'session'))
_KINDS = {'link': 'link', 'quality': 'link', 'battery': 'battery', 'proof': 'stop', 'stop': 'stop',
          'power': 'stop', 'hardware': 'stop', 'task': 'task', 'tasks': 'task',
          'guard': 'fault', 'mux': 'fault', 'gates': 'fault', 'master': 'fault',
          'source': 'fault', 'recording': 'record'}
_STOP_SEEN_HERE = ('stop.engaged', 'stop.released')
# No simulated robot has more faults at once, nor longer words for one.
_MOST_FAULTS, _LONGEST_FAULT = 20, 80
_LOST = ('link.silent', 'link.gone', 'link.lost')


def line_of_screen(kind: str, severity: str, robot: str, text: str) -> Optional[Line]:
    """Return the line of a screen's event, None where it is seen here.

    :param kind: a key of :data:`mhri.events.events.KINDS`, or a new one
    :param severity: of the event list
    """
    subject = kind.partition('.')[0]
    if subject in _SEEN_HERE or kind in _STOP_SEEN_HERE:
        return None
    name = 'lost' if kind in _LOST else _KINDS.get(subject, 'event')
    return name, _SEVERITIES.get(severity, INFO), robot, text


def link_notes(events: Iterable[SessionEvent]) -> Dict[str, List[Tuple[float, str]]]:
    """Return what the lines of a session say of bad links: {robot: [(ROS time [s], words)]}.

    The words are '' from when the link was good again, or the robot lost.
    """
    found: Dict[str, List[Tuple[float, str]]] = {}
    for event in events:
        if event.robot and event.kind in ('link', 'lost'):
            bad = event.kind == 'link' and event.severity == WARNING
            found.setdefault(event.robot, []).append((event.ros, event.text if bad else ''))
    return found


class GraphWatch:
    """What the graph says about who drives what, as lines; the first word of each is no change."""

    def __init__(self) -> None:
        self._mode: Optional[str] = None
        self._stopped: Optional[bool] = None
        self._selected: Optional[Tuple[str, ...]] = None
        self._operator: Optional[str] = None
        self._lost: Dict[str, float] = {}
        self._faults: Dict[str, Tuple[str, ...]] = {}

    @property
    def operator(self) -> str:
        """The node in control, '' for none."""
        return self._operator or ''

    def state(self) -> Dict[str, object]:
        """Return how it is now: JSON values, as the line of a session's start has them."""
        return {'mode': self._mode, 'stop_all': self._stopped, 'operator': self._operator,
                'selected': None if self._selected is None else list(self._selected)}

    def mode(self, source: str) -> List[Line]:
        """Take in the mode in force."""
        before, self._mode = self._mode, source
        return [] if before in (None, source) else [
            ('mode', INFO, '', 'driving with {}'.format(source))]

    def stop(self, stopped: bool) -> List[Line]:
        """Take in whether everything is stopped."""
        before, self._stopped = self._stopped, stopped
        if before == stopped or (before is None and not stopped):
            return []
        return [('stop', WARNING, '', 'STOP ALL')] if stopped else [
            ('stop', INFO, '', 'STOP ALL released')]

    def selection(self, robots: Iterable[str]) -> List[Line]:
        """Take in which robots are checked."""
        before, self._selected = self._selected, tuple(robots)
        if before is None and not self._selected or before == self._selected:
            return []
        return [('selection', INFO, '', 'selected: ' + (', '.join(self._selected) or 'none'))]

    def control(self, operator: str, computer: str) -> List[Line]:
        """Take in who is in control."""
        before, self._operator = self._operator, operator
        if before == operator or (before is None and not operator):
            return []
        return [('control', INFO, '', '{} on {} is in control'.format(
            operator.lstrip('/'), computer or 'an unknown computer') if operator
            else 'nobody is in control')]

    def faults(self, robot: str, said: str) -> List[Line]:
        """Take in what fails of a simulated robot by request, a phrase a line."""
        before = self._faults.get(robot, ())
        now = self._faults[robot] = tuple(
            tidy_text(phrase, _LONGEST_FAULT) for phrase in said.splitlines()[:_MOST_FAULTS])
        return [('fault', WARNING, robot, 'simulated fault: ' + phrase)
                for phrase in now if phrase not in before] + [
                    ('fault', INFO, robot, 'simulated fault over: ' + phrase)
                    for phrase in before if phrase not in now]

    def silence(self, ages_s: Mapping[str, Tuple[float, float]], now_s: float) -> List[Line]:
        """Take in how long each robot has been silent; return those that are lost or back.

        :param ages_s: {robot: (silence [s], how long it may be silent [s], 0: for ever)}
        """
        told: List[Line] = []
        for robot, (age_s, most_s) in ages_s.items():
            silent = 0.0 < most_s < age_s
            if silent and robot not in self._lost:
                self._lost[robot] = now_s - age_s
                driven = robot in (self._selected or ())
                told.append(('lost', ERROR if driven else WARNING, robot,
                             'lost while driven' if driven else 'silent'))
            elif not silent and robot in self._lost:
                told.append(('link', INFO, robot, 'back after {:.0f} s'.format(
                    max(1.0, now_s - self._lost.pop(robot)))))
        return told
