# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event log: the newest events, and those that the operator has not seen yet.

An event is plain data, easy to store (:meth:`Event.as_dict`). Events that repeat within a short
time become one line with a count, in the place of the newest.
"""
from dataclasses import asdict, dataclass, field
from datetime import datetime
import re
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple

from mhri.base.text import tidy_text
from mhri.base.views import Change, ScreenView
from mhri.events.changes import ScreenChanges
from mhri.recording.recording import RecordingStatus

# Severities, in ascending order.
CALM, ATTENTION, ALARM = 'calm', 'attention', 'alarm'
SEVERITIES = (CALM, ATTENTION, ALARM)
# The tones; the one for a robot lost while driven cannot be switched off.
LOST_TONE, ATTENTION_TONE, CALM_TONE = 'lost', 'attention', 'calm'

# The kind of a mark of the session; its data name it (``mark``), and its note (``note``).
MARKED = 'session.mark'
# A sensor is beyond its limit, or back; their data name it (``readout``).
BEYOND, WITHIN = 'readout.beyond', 'readout.within'
MOST = 2000
REPEAT_S = 20.0
_MAX_REMEMBERED = 500
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
    BEYOND: (ATTENTION, ATTENTION_TONE), WITHIN: (CALM, ''),
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
    'session.begun': (CALM, ''), 'session.ended': (CALM, ''), MARKED: (CALM, ''),
    'session.trouble': (ATTENTION, ATTENTION_TONE),
    'drill.waits': (CALM, ''), 'drill.begun': (CALM, ''), 'drill.found': (CALM, CALM_TONE),
    'drill.ended': (CALM, CALM_TONE),
    'mode.changed': (CALM, ''), 'limits.changed': (CALM, ''),
    'source.trouble': (ATTENTION, ATTENTION_TONE), 'source.fine': (CALM, ''),
    'control.taken': (CALM, ''), 'control.lost': (ATTENTION, ATTENTION_TONE),
    'linked.said': (ATTENTION, ATTENTION_TONE),
    'request.refused': (ATTENTION, ATTENTION_TONE),
    'accessory.used': (CALM, ''), 'accessory.refused': (ATTENTION, ''),
    'accessory.reported': (CALM, ''),
    'task.begun': (CALM, ''), 'task.said': (CALM, ''), 'task.done': (CALM, CALM_TONE),
    'task.stopped': (CALM, ''), 'task.taken_over': (CALM, ''),
    'task.timeout': (ATTENTION, ATTENTION_TONE), 'task.blocked': (ATTENTION, ATTENTION_TONE),
    'task.lost': (ATTENTION, ATTENTION_TONE), 'task.failed': (ATTENTION, ATTENTION_TONE),
    'task.refused': (ATTENTION, ATTENTION_TONE),
    'tasks.silent': (ATTENTION, ATTENTION_TONE), 'tasks.back': (CALM, ''),
    'tasks.stranger': (ATTENTION, ''),
    'mux.silent': (ATTENTION, ATTENTION_TONE), 'mux.back': (CALM, CALM_TONE),
    'master.lost': (ATTENTION, ATTENTION_TONE), 'master.back': (CALM, CALM_TONE),
    'screen.cut_off': (ALARM, ATTENTION_TONE), 'screen.note': (CALM, ''),
    'screen.remote': (CALM, ''), 'stick.let_go': (ATTENTION, ATTENTION_TONE),
    'screen.trouble': (ATTENTION, ''), 'camera.budget': (ATTENTION, ''),
}


@dataclass(frozen=True)
class Event:
    """One line of the event list.

    ``number`` counts up from 1 and is unique. ``time_s`` is the wall time [s since 1970] of the
    newest of ``count`` equal events, ``since_s`` that of the first; ``replaces`` is the number of
    the line of the earlier ones, 0 if none. ``robot`` is '' for events of the whole screen.
    ``kind`` is a key of :data:`KINDS`, ``sound`` the tone to play now or '', ``data`` that of its
    :class:`mhri.base.views.Change`.
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
    data: Mapping[str, Any] = field(default_factory=dict)

    def as_dict(self) -> Dict[str, Any]:
        """Return the event as a dict of plain JSON values."""
        return asdict(self)

    @property
    def subject(self) -> str:
        """The subject; an event supersedes earlier ones with the same subject.

        Each readout is a subject of its own.
        """
        return self.kind.partition('.')[0] + str(self.data.get('readout', ''))

    @property
    def words(self) -> str:
        """The text with its count: "silent: nothing for 1.2 s (3 times since 14:02:06)"."""
        if self.count == 1:
            return self.text
        return '{} ({} times since {})'.format(self.text, self.count, clock_text(self.since_s))


class Headline(NamedTuple):
    """The bottom line's text on unseen events ('' if none), its severity, and its robot, if any."""

    text: str
    severity: str
    robot: str = ''


def clock_text(time_s: float) -> str:
    """Return a wall time [s since 1970] as local time, e.g. "14:02:06"."""
    return datetime.fromtimestamp(time_s).strftime('%H:%M:%S')


def _no_recording(name: str) -> RecordingStatus:
    return RecordingStatus()


class EventLog:
    """The newest events, and the unseen ones among them.

    :param status_of: function that returns the :class:`RecordingStatus` of a robot by its name
    :param most: maximum number of events; the oldest are dropped
    """

    def __init__(self, status_of: Callable[[str], RecordingStatus] = _no_recording,
                 most: int = MOST) -> None:
        self._changes = ScreenChanges(status_of)
        self._most = most
        self._number = 0
        self._events: Dict[int, Event] = {}
        # To detect repetitions: time of the last report [s, monotonic] and its event.
        self._newest: Dict[Tuple[str, str, str], Tuple[float, Event]] = {}
        self._unseen: Dict[Tuple[str, str], Event] = {}
        self._unseen_count = 0

    @property
    def events(self) -> Tuple[Event, ...]:
        """All events in the log, the oldest first."""
        return tuple(self._events.values())

    @property
    def unseen(self) -> int:
        """The number of unseen events."""
        return self._unseen_count

    def feed(self, view: ScreenView, now_s: float, wall_s: float) -> List[Event]:
        """Handle the screen's newest view; return the new events, the oldest first.

        :param now_s: time [s, monotonic]
        :param wall_s: time [s since 1970]
        """
        return [self._append(change, now_s, wall_s) for change in self._changes.update(view, now_s)]

    def note(self, kind: str, text: str, now_s: float, wall_s: float, robot: str = '',
             data: Optional[Mapping[str, Any]] = None) -> Event:
        """Add and return an event that cannot be derived from views.

        :param kind: a key of :data:`KINDS`
        :param data: as in :class:`mhri.base.views.Change`
        :raises KeyError: the kind is unknown
        """
        return self._append(Change(robot, kind, text, data=data or {}), now_s, wall_s)

    def _append(self, change: Change, now_s: float, wall_s: float) -> Event:
        """Create the event of a change, and add it."""
        severity, sound = KINDS[change.kind]
        text = tidy_text(change.text)
        mark = str(change.data.get('mark', ''))
        key = (change.robot, change.kind,
               mark or str(change.data.get('readout') or _NUMBER.sub('#', text)))
        before = self._before(key, change, now_s)
        if change.again or before is not None and sound != LOST_TONE:
            sound = ''
        self._number += 1
        event = Event(
            self._number, before.time_s if before and mark else wall_s, change.robot, severity,
            change.kind, text, sound, before.count + 1 if before and not mark else 1,
            before.since_s if before else wall_s, before.number if before else 0, change.data)
        self._keep(event, before)
        self._newest[key] = now_s, event
        if len(self._newest) > _MAX_REMEMBERED:
            self._newest = {key: (at, event) for key, (at, event) in self._newest.items()
                            if now_s - at <= REPEAT_S}
        return event

    def _before(self, key: Tuple[str, str, str], change: Change, now_s: float) -> Optional[Event]:
        """Return the event that a change repeats or, as the note of a mark, completes; or None."""
        last = self._newest.get(key)
        if last is None or 'mark' in change.data and 'note' not in change.data:
            return None
        return last[1] if 'mark' in change.data or now_s - last[0] <= REPEAT_S else None

    def _keep(self, event: Event, before: Optional[Event]) -> None:
        """Append an event, and remove the one that it repeats."""
        if before is not None:
            self._events.pop(before.number, None)
        self._events[event.number] = event
        while len(self._events) > self._most:
            del self._events[next(iter(self._events))]
        self._unseen[(event.robot, event.subject)] = event
        self._unseen_count += 1

    def mark_seen(self) -> None:
        """Mark all events as seen."""
        self._unseen.clear()
        self._unseen_count = 0

    def headline(self) -> Headline:
        """Return the headline of unseen events: the newest of the worst ones.

        An event that is over (the robot is back) is ignored. E.g. "bot3 lost while driven 14:02:06
        (2 more)"; "3 events" if all are calm; '' if there are none.
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
            worst.severity, worst.robot)
