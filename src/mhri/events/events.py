# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list: what an operator wants to know afterwards, and which of it is still unseen.

An event is plain data that anybody can keep (:meth:`Event.as_dict`). Events that repeat within a
short time become one line with a count, in the place of the newest.
"""
from dataclasses import asdict, dataclass
from datetime import datetime
import re
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from mhri.base.text import tidy_text
from mhri.base.views import PanelView
from mhri.events.changes import Change, ScreenChanges
from mhri.recording.recording import RecordingStatus

# Severities, least first.
CALM, ATTENTION, ALARM = 'calm', 'attention', 'alarm'
SEVERITIES = (CALM, ATTENTION, ALARM)
# The tones; the one for a robot lost while driven cannot be silenced.
LOST_TONE, ATTENTION_TONE, CALM_TONE = 'lost', 'attention', 'calm'

MOST = 2000
REPEAT_S = 20.0
_MOST_REMEMBERED = 500
_NUMBER = re.compile(r'\d+(\.\d+)?')

#: {kind: (severity, tone or '')}; the kinds of :mod:`mhri.events.changes` and of notes
KINDS: Dict[str, Tuple[str, str]] = {
    'robot.added': (CALM, ''), 'robot.removed': (CALM, ''),
    'link.found': (CALM, ''), 'link.back': (CALM, CALM_TONE),
    'link.silent': (ATTENTION, ATTENTION_TONE), 'link.gone': (ATTENTION, ATTENTION_TONE),
    'link.lost': (ALARM, LOST_TONE),
    'quality.bad': (ATTENTION, ATTENTION_TONE), 'quality.good': (CALM, ''),
    'battery.low': (ATTENTION, ATTENTION_TONE), 'battery.flat': (ALARM, ATTENTION_TONE),
    'battery.fine': (CALM, ''),
    'drive.checked': (CALM, ''), 'drive.unchecked': (CALM, ''),
    'stop.engaged': (ATTENTION, ATTENTION_TONE), 'stop.released': (CALM, ''),
    'proof.stopped': (CALM, ''), 'proof.doubtful': (ALARM, ATTENTION_TONE),
    'guard.lost': (ATTENTION, ATTENTION_TONE), 'guard.back': (CALM, ''),
    'hardware.pressed': (ATTENTION, ATTENTION_TONE), 'hardware.released': (CALM, ''),
    'power.cut': (ATTENTION, ''), 'power.failed': (ATTENTION, ATTENTION_TONE),
    'power.back': (CALM, ''),
    'recording.begun': (CALM, ''), 'recording.ended': (CALM, ''),
    'recording.warning': (ATTENTION, ATTENTION_TONE),
    'recording.failed': (ATTENTION, ATTENTION_TONE),
    'session.begun': (CALM, ''), 'session.ended': (CALM, ''), 'session.mark': (CALM, ''),
    'session.trouble': (ATTENTION, ATTENTION_TONE),
    'drill.waits': (CALM, ''), 'drill.begun': (CALM, ''), 'drill.found': (CALM, CALM_TONE),
    'drill.ended': (CALM, CALM_TONE),
    'mode.changed': (CALM, ''), 'limits.changed': (CALM, ''),
    'source.trouble': (ATTENTION, ATTENTION_TONE), 'source.fine': (CALM, ''),
    'control.taken': (CALM, ''), 'control.lost': (ATTENTION, ATTENTION_TONE),
    'linked.said': (ATTENTION, ATTENTION_TONE),
    'request.refused': (ATTENTION, ATTENTION_TONE),
    'task.begun': (CALM, ''), 'task.said': (CALM, ''), 'task.done': (CALM, CALM_TONE),
    'task.stopped': (CALM, ''), 'task.taken_over': (CALM, ''),
    'task.timeout': (ATTENTION, ATTENTION_TONE), 'task.blocked': (ATTENTION, ATTENTION_TONE),
    'task.lost': (ATTENTION, ATTENTION_TONE), 'task.failed': (ATTENTION, ATTENTION_TONE),
    'task.refused': (ATTENTION, ATTENTION_TONE),
    'tasks.silent': (ATTENTION, ATTENTION_TONE), 'tasks.back': (CALM, ''),
    'tasks.stranger': (ATTENTION, ''),
    'mux.silent': (ATTENTION, ATTENTION_TONE), 'mux.back': (CALM, CALM_TONE),
    'gates.silent': (ATTENTION, ATTENTION_TONE), 'gates.back': (CALM, CALM_TONE),
    'master.lost': (ATTENTION, ATTENTION_TONE), 'master.back': (CALM, CALM_TONE),
    'screen.cut_off': (ALARM, ATTENTION_TONE), 'screen.note': (CALM, ''),
    'screen.remote': (CALM, ''), 'stick.let_go': (ATTENTION, ATTENTION_TONE),
    'screen.trouble': (ATTENTION, ''), 'camera.budget': (ATTENTION, ''),
}


@dataclass(frozen=True)
class Event:
    """One line of the event list.

    ``number`` counts up from 1 and is never used twice. ``time_s`` is the wall time [s since 1970]
    of the newest of ``count`` equal ones, the first of which was at ``since_s``; ``replaces`` is
    the number of the line that stood for those before, 0 if there is none. ``robot`` is '' where
    it is about everything. ``kind`` is a key of :data:`KINDS`, ``sound`` the tone to play now ('').
    """

    number: int
    time_s: float
    robot: str
    severity: str
    kind: str
    text: str
    sound: str = ''
    count: int = 1
    since_s: float = 0.0
    replaces: int = 0

    def as_dict(self) -> Dict[str, Any]:
        """Return the event as a dict of plain JSON values."""
        return asdict(self)

    @property
    def subject(self) -> str:
        """What it is about: the newest of several events with one subject holds."""
        return self.kind.partition('.')[0]

    @property
    def words(self) -> str:
        """Text, and how often it was so: "silent: nothing for 1.2 s (3 times since 14:02:06)"."""
        if self.count == 1:
            return self.text
        return '{} ({} times since {})'.format(self.text, self.count, clock_text(self.since_s))


class Headline(NamedTuple):
    """What the bottom line says about unseen events: words ('' for none) and a severity."""

    text: str
    severity: str


def clock_text(time_s: float) -> str:
    """Return a wall time [s since 1970] as local time, e.g. "14:02:06"."""
    return datetime.fromtimestamp(time_s).strftime('%H:%M:%S')


def _no_recording(name: str) -> RecordingStatus:
    return RecordingStatus()


class EventLog:
    """The newest events, and which of them nobody has looked at yet.

    :param status_of: function that returns the :class:`RecordingStatus` of a robot by its name
    :param most: how many events to keep; the oldest go first
    """

    def __init__(self, status_of: Callable[[str], RecordingStatus] = _no_recording,
                 most: int = MOST) -> None:
        self._changes = ScreenChanges(status_of)
        self._most = most
        self._number = 0
        self._events: Dict[int, Event] = {}
        # For what may repeat: when it was last reported (monotonic), and how.
        self._told: Dict[Tuple[str, str, str], Tuple[float, Event]] = {}
        self._unseen: Dict[Tuple[str, str], Event] = {}
        self._unseen_count = 0

    @property
    def events(self) -> Tuple[Event, ...]:
        """All events kept, the oldest first."""
        return tuple(self._events.values())

    @property
    def unseen(self) -> int:
        """How many events nobody has looked at yet."""
        return self._unseen_count

    def feed(self, view: PanelView, now_s: float, wall_s: float) -> List[Event]:
        """Take in what the screen shows now; return the new events, the oldest first.

        :param now_s: seconds of a clock that never goes back
        :param wall_s: seconds since 1970
        """
        return [self._tell(change, now_s, wall_s) for change in self._changes.see(view, now_s)]

    def note(self, kind: str, text: str, now_s: float, wall_s: float, robot: str = '') -> Event:
        """Take in what no view says, and return it as an event.

        :param kind: a key of :data:`KINDS`
        :raises KeyError: it is not one
        """
        return self._tell(Change(robot, kind, text), now_s, wall_s)

    def _tell(self, change: Change, now_s: float, wall_s: float) -> Event:
        """Make the event of a change, and keep it."""
        severity, sound = KINDS[change.kind]
        text = tidy_text(change.text)
        key = (change.robot, change.kind, _NUMBER.sub('#', text))
        told = self._told.get(key)
        before = told[1] if told and now_s - told[0] <= REPEAT_S else None
        if change.again or before is not None and sound != LOST_TONE:
            sound = ''
        self._number += 1
        event = Event(
            self._number, wall_s, change.robot, severity, change.kind, text, sound,
            before.count + 1 if before else 1, before.since_s if before else wall_s,
            before.number if before else 0)
        self._keep(event, before)
        self._told[key] = now_s, event
        if len(self._told) > _MOST_REMEMBERED:
            self._told = {key: (at, event) for key, (at, event) in self._told.items()
                          if now_s - at <= REPEAT_S}
        return event

    def _keep(self, event: Event, before: Optional[Event]) -> None:
        """Put an event at the end, replacing the one that it repeats."""
        if before is not None:
            self._events.pop(before.number, None)
        self._events[event.number] = event
        while len(self._events) > self._most:
            del self._events[next(iter(self._events))]
        self._unseen[(event.robot, event.subject)] = event
        self._unseen_count += 1

    def see(self) -> None:
        """Take in that the operator has looked at all of them."""
        self._unseen.clear()
        self._unseen_count = 0

    def headline(self) -> Headline:
        """Return what to say about unseen events: the newest of the worst ones, by name.

        An event that is over (the robot is back) does not count as the worst. E.g. "bot3 lost while
        driven 14:02:06 (2 more)"; "3 events" if none of them matters; '' for none.
        """
        open_ = [event for event in self._unseen.values() if event.severity != CALM]
        if not open_:
            count = self._unseen_count
            return Headline('{} event{}'.format(count, '' if count == 1 else 's') if count else '',
                            CALM)
        worst = max(open_, key=lambda event: (SEVERITIES.index(event.severity), event.number))
        more = ' ({} more)'.format(len(open_) - 1) if len(open_) > 1 else ''
        return Headline('{} {} {}{}'.format(
            worst.robot, worst.text.partition(':')[0], clock_text(worst.time_s), more).strip(),
            worst.severity)
