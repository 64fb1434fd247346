# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The time line of a session: what happened when, who was driven, when everything was stopped."""
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

from mhri.recording.folder import INFO, marks_of, SessionEvent

# Kinds of a tick: what a jump goes to. Others (mode, selection, ...) are in the list alone.
MARK, STOP, EVENT = 'mark', 'stop', 'event'
_SELECTED = 'selected: '
# A jump back within so long [s] after a tick goes to the one before it.
LEAST_JUMP_S = 0.5


def duration_text(seconds: float) -> str:
    """Return a time from the start, e.g. "2:11" or "1:02:11"."""
    minutes, rest = divmod(int(max(0.0, seconds) + 1e-6), 60)
    hours, minutes = divmod(minutes, 60)
    return '{}:{:02d}:{:02d}'.format(hours, minutes, rest) if hours else \
        '{}:{:02d}'.format(minutes, rest)


@dataclass(frozen=True)
class Tick:
    """One moment worth a jump, ``at_s`` from the start of the session.

    ``kind`` is MARK, STOP or EVENT, ``severity`` one of those of the session's lines, ``robot`` ''
    for all.
    """

    at_s: float
    kind: str
    text: str
    severity: str = INFO
    robot: str = ''


@dataclass(frozen=True)
class Span:
    """From when to when [s from the start] something was so; ``robot`` is '' for all."""

    begin_s: float
    end_s: float
    robot: str = ''


@dataclass(frozen=True)
class TimeLine:
    """What a session's time line shows; times are seconds from ``start`` [s since 1970].

    ``events`` are all lines, ``ticks`` those worth a jump, in order of time; ``driven`` says when
    which robot was selected, ``stopped`` when STOP ALL was in force.
    """

    start: float
    length_s: float
    events: Tuple[SessionEvent, ...] = ()
    ticks: Tuple[Tick, ...] = ()
    driven: Tuple[Span, ...] = ()
    stopped: Tuple[Span, ...] = ()

    def events_until(self, position_s: float) -> Tuple[SessionEvent, ...]:
        """Return what had happened by then, the oldest first."""
        return self.events[:bisect_right(
            [event.ros for event in self.events], self.start + position_s)]

    def next_tick(self, position_s: float) -> Optional[Tick]:
        """Return the first tick after a position, None at the last."""
        place = bisect_right([tick.at_s for tick in self.ticks], position_s + 1e-6)
        return self.ticks[place] if place < len(self.ticks) else None

    def previous_tick(self, position_s: float) -> Optional[Tick]:
        """Return the last tick that a jump back goes to, None before the first."""
        place = bisect_left([tick.at_s for tick in self.ticks], position_s - LEAST_JUMP_S)
        return self.ticks[place - 1] if place else None

    def driven_at(self, position_s: float) -> Tuple[str, ...]:
        """Return the robots that were selected then."""
        return tuple(span.robot for span in self.driven
                     if span.begin_s <= position_s < span.end_s)


def read_time_line(events: Iterable[SessionEvent], start: float, length_s: float) -> TimeLine:
    """Return the time line of a session.

    :param events: its lines; what lies outside of the recording is put to its ends
    :param start: when its first bag begins, by ROS [s since 1970]
    :param length_s: how long its bags last
    """
    events = sorted(events, key=lambda event: event.ros)

    def place(event: SessionEvent) -> float:
        return min(max(event.ros - start, 0.0), length_s)

    notes = {mark.ros: mark.text for mark in marks_of(events)}
    ticks = []
    for event in events:
        kind = _tick_kind(event)
        if kind:
            text = notes.get(event.ros, event.text) if kind == MARK else event.text
            ticks.append(Tick(place(event), kind, text, event.severity, event.robot))
    return TimeLine(start, length_s, tuple(events), tuple(ticks),
                    _driven([(place(event), selected_from(event)) for event in events], length_s),
                    _stopped([(place(event), _stops(event)) for event in events], length_s))


def _tick_kind(event: SessionEvent) -> str:
    """Return the kind of a line's tick, '' for a line that is not worth a jump."""
    if event.kind == 'mark':
        return MARK
    if _stops(event) is not None:
        return STOP if _stops(event) and event.kind != 'start' else ''
    return EVENT if event.severity != INFO else ''


def selected_from(event: SessionEvent) -> Optional[Tuple[str, ...]]:
    """Return the robots selected from a line on, None for a line that does not say it."""
    if event.kind == 'start' and isinstance(event.data.get('selected'), list):
        return tuple(map(str, event.data['selected']))
    if event.kind != 'selection':
        return None
    if isinstance(event.data.get('robots'), list):
        return tuple(map(str, event.data['robots']))
    names = event.text[len(_SELECTED):] if event.text.startswith(_SELECTED) else ''
    return tuple(name for name in names.split(', ') if name not in ('', 'none'))


def _stops(event: SessionEvent) -> Optional[bool]:
    """Return whether everything is stopped from a line on, None for one that does not say it."""
    if event.kind == 'start' and isinstance(event.data.get('stop_all'), bool):
        return bool(event.data['stop_all'])
    if event.kind != 'stop' or not event.text.startswith('STOP ALL'):
        return None
    return 'released' not in event.text


def _driven(said: Sequence[Tuple[float, Optional[Tuple[str, ...]]]],
            length_s: float) -> Tuple[Span, ...]:
    """Return when each robot was selected."""
    since: Dict[str, float] = {}
    spans: List[Span] = []
    for at_s, names in said:
        if names is None:
            continue
        for name in [name for name in since if name not in names]:
            spans.append(Span(since.pop(name), at_s, name))
        for name in names:
            since.setdefault(name, at_s)
    spans += [Span(begin_s, length_s, name) for name, begin_s in since.items()]
    return tuple(sorted((span for span in spans if span.end_s > span.begin_s),
                        key=lambda span: (span.begin_s, span.robot)))


def _stopped(said: Sequence[Tuple[float, Optional[bool]]], length_s: float) -> Tuple[Span, ...]:
    """Return when everything was stopped."""
    spans: List[Span] = []
    since: Optional[float] = None
    for at_s, stopped in said:
        if stopped and since is None:
            since = at_s
        elif stopped is False and since is not None:
            spans.append(Span(since, at_s))
            since = None
    if since is not None:
        spans.append(Span(since, length_s))
    return tuple(spans)
