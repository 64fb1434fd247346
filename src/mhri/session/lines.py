# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sources of a session's lines, chosen so that no line is recorded twice.

The recorder itself observes mode, selection, control and stop on the graph, with or without a
screen. All other lines come from the events of a screen; of several screens, from the one in
control. Without a screen, the recorder also detects silent robots.
"""
import json
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple

from mhri.base.text import tidy_text
from mhri.events.events import ALARM, ATTENTION, CALM, MARKED
from mhri.recording.folder import ERROR, INFO, SessionEvent, WARNING

# (kind, severity, robot, text, data)
Line = Tuple[str, str, str, str, Dict[str, Any]]

_SEVERITIES = {CALM: INFO, ATTENTION: WARNING, ALARM: ERROR}
# Subjects of a screen's events that the recorder observes itself.
_SEEN_HERE = frozenset(('mode', 'drive', 'control', 'session'))
_KINDS = {'link': 'link', 'quality': 'link', 'battery': 'battery', 'proof': 'stop', 'stop': 'stop',
          'power': 'stop', 'hardware': 'stop', 'task': 'task', 'tasks': 'task',
          'guard': 'fault', 'mux': 'fault', 'master': 'fault', 'source': 'fault',
          'recording': 'record'}
_STOP_SEEN_HERE = ('stop.engaged', 'stop.released')
# Bounds on the number of faults of a robot, and on the length of each text.
_MAX_FAULTS, _LONGEST_FAULT = 20, 80
_LOST = ('link.silent', 'link.gone', 'link.lost')


def line_of_screen(kind: str, severity: str, robot: str, text: str,
                   data: str = '') -> Optional[Line]:
    """Return the line of a screen's event, None if the recorder observes it itself.

    The data of the line are the plain values of the event's data, plus its kind as ``code``.

    :param kind: a key of :data:`mhri.events.events.KINDS`, or a new one
    :param severity: severity in the event list
    :param data: JSON, '' for no data; not trusted, any node may have sent it
    """
    subject, plain = kind.partition('.')[0], _plain(data)
    # A screen reports of a mark which robot it showed.
    names_robot = kind == MARKED and robot and isinstance(plain.get('mark'), str)
    if subject in _SEEN_HERE and not names_robot or kind in _STOP_SEEN_HERE:
        return None
    name = 'lost' if kind in _LOST else _KINDS.get(subject, 'event')
    return name, _SEVERITIES.get(severity, INFO), robot, text, {**plain, 'code': kind}


def _plain(text: str) -> Dict[str, Any]:
    """Return the numbers, texts and flags of a JSON object; {} if it is not an object."""
    try:
        found = json.loads(text or '{}')
    except (ValueError, RecursionError):
        return {}
    return {key: value for key, value in found.items()
            if isinstance(value, (str, int, float))} if isinstance(found, dict) else {}


def link_notes(events: Iterable[SessionEvent]) -> Dict[str, List[Tuple[float, str]]]:
    """Return the warnings of bad links in the lines: {robot: [(ROS time [s], text)]}.

    The text is '' once the link is good again or the robot is lost.
    """
    found: Dict[str, List[Tuple[float, str]]] = {}
    for event in events:
        if event.robot and event.kind in ('link', 'lost'):
            bad = event.kind == 'link' and event.severity == WARNING
            found.setdefault(event.robot, []).append((event.ros, event.text if bad else ''))
    return found


class GraphWatch:
    """Makes lines from the graph: mode, stop, selection, control, faults and silence.

    A first value is not a change. The data of a line are the changed part of :meth:`state`.
    """

    def __init__(self) -> None:
        self._mode: Optional[str] = None
        self._stopped: Optional[bool] = None
        self._selected: Optional[Tuple[str, ...]] = None
        self._operator: Optional[str] = None
        self._lost: Dict[str, float] = {}
        self._faults: Dict[str, Tuple[str, ...]] = {}

    @property
    def operator(self) -> str:
        """The node in control, '' if none."""
        return self._operator or ''

    def state(self) -> Dict[str, object]:
        """Return the current state as JSON values, for the line of a session's start."""
        return {'mode': self._mode, 'stop_all': self._stopped, 'operator': self._operator,
                'selected': None if self._selected is None else list(self._selected)}

    def mode(self, source: str) -> List[Line]:
        """Handle the current mode."""
        before, self._mode = self._mode, source
        return [] if before in (None, source) else [
            ('mode', INFO, '', 'driving with {}'.format(source), {'mode': source})]

    def stop(self, stopped: bool) -> List[Line]:
        """Handle whether STOP ALL is in force."""
        before, self._stopped = self._stopped, stopped
        if before == stopped or (before is None and not stopped):
            return []
        data = {'stop_all': stopped}
        return [('stop', WARNING, '', 'STOP ALL', data)] if stopped else [
            ('stop', INFO, '', 'STOP ALL released', data)]

    def selection(self, robots: Iterable[str]) -> List[Line]:
        """Handle the selected robots."""
        before, self._selected = self._selected, tuple(robots)
        if before is None and not self._selected or before == self._selected:
            return []
        return [('selection', INFO, '', 'selected: ' + (', '.join(self._selected) or 'none'),
                 {'selected': list(self._selected)})]

    def control(self, operator: str, computer: str) -> List[Line]:
        """Handle the operator in control and its computer."""
        before, self._operator = self._operator, operator
        if before == operator or (before is None and not operator):
            return []
        return [('control', INFO, '', '{} on {} is in control'.format(
            operator.lstrip('/'), computer or 'an unknown computer') if operator
            else 'no operator is in control', {'operator': operator})]

    def faults(self, robot: str, said: str) -> List[Line]:
        """Handle the injected faults of a simulated robot, one per line."""
        before = self._faults.get(robot, ())
        now = self._faults[robot] = tuple(
            tidy_text(phrase, _LONGEST_FAULT) for phrase in said.splitlines()[:_MAX_FAULTS])
        return [('fault', WARNING, robot, 'simulated fault: ' + phrase, {'fault': phrase})
                for phrase in now if phrase not in before] + [
                    ('fault', INFO, robot, 'simulated fault over: ' + phrase, {'over': phrase})
                    for phrase in before if phrase not in now]

    def silence(self, ages_s: Mapping[str, Tuple[float, float]], now_s: float) -> List[Line]:
        """Handle the silence of each robot; return lines for lost and returned robots.

        :param ages_s: {robot: (silence [s], allowed silence [s], 0: no limit)}
        """
        lines: List[Line] = []
        for robot, (age_s, most_s) in ages_s.items():
            silent = 0.0 < most_s < age_s
            if silent and robot not in self._lost:
                self._lost[robot] = now_s - age_s
                driven = robot in (self._selected or ())
                lines.append(('lost', ERROR if driven else WARNING, robot,
                              'lost while driven' if driven else 'silent',
                              {'code': 'link.lost' if driven else 'link.silent'}))
            elif not silent and robot in self._lost:
                lines.append(('link', INFO, robot, 'back after {:.0f} s'.format(
                    max(1.0, now_s - self._lost.pop(robot))), {'code': 'link.back'}))
        return lines
