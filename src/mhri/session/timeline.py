# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The time line of a session: events, selections and stops."""
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

from mhri.recording.folder import INFO, marks_of, SessionEvent, SessionMark, with_notes

# Kinds of ticks, the targets of jumps. Other lines (mode, selection, ...) are only listed.
MARK, STOP, EVENT = 'mark', 'stop', 'event'
# A jump back less than this [s] after a tick goes to the tick before it.
MIN_JUMP_S = 0.5


@dataclass(frozen=True)
class Tick:
    """A target of jumps, ``at_s`` from the start of the session.

    ``kind`` is MARK, STOP or EVENT, ``severity`` that of the session's line, ``robot`` '' for all.
    """

    at_s: float
    kind: str
    text: str
    severity: str = INFO
    robot: str = ''


@dataclass(frozen=True)
class Span:
    """A time span [s from the start] of one robot; ``robot`` is '' for all."""

    begin_s: float
    end_s: float
    robot: str = ''

    @property
    def lasts_s(self) -> float:
        """Its duration [s]."""
        return self.end_s - self.begin_s


@dataclass(frozen=True)
class TimeLine:
    """The time line; times are seconds from ``start`` [s since 1970].

    ``events`` are all lines, each mark with its note as one, ``ticks`` the targets of jumps, both
    in chronological order; ``driven`` are the spans in which robots were selected, ``stopped``
    those in which STOP ALL was in force, ``marks`` the marks.
    """

    start: float
    length_s: float
    events: Tuple[SessionEvent, ...] = ()
    ticks: Tuple[Tick, ...] = ()
    driven: Tuple[Span, ...] = ()
    stopped: Tuple[Span, ...] = ()
    marks: Tuple[SessionMark, ...] = ()

    def events_until(self, position_s: float) -> Tuple[SessionEvent, ...]:
        """Return the events up to a position, the oldest first."""
        return self.events[:bisect_right(
            [event.ros for event in self.events], self.start + position_s)]

    def next_tick(self, position_s: float) -> Optional[Tick]:
        """Return the first tick after a position, None after the last."""
        place = bisect_right([tick.at_s for tick in self.ticks], position_s + 1e-6)
        return self.ticks[place] if place < len(self.ticks) else None

    def previous_tick(self, position_s: float) -> Optional[Tick]:
        """Return the target of a jump back, None before the first tick."""
        place = bisect_left([tick.at_s for tick in self.ticks], position_s - MIN_JUMP_S)
        return self.ticks[place - 1] if place else None

    def driven_at(self, position_s: float) -> Tuple[str, ...]:
        """Return the robots selected at a position."""
        return tuple(span.robot for span in self.driven
                     if span.begin_s <= position_s < span.end_s)


def read_time_line(events: Iterable[SessionEvent], start: float, length_s: float) -> TimeLine:
    """Return the time line of a session.

    :param events: its lines; lines outside the recording are moved to its ends
    :param start: ROS time of the beginning of its first bag [s since 1970]
    :param length_s: duration of its bags [s]
    """
    lines = sorted(events, key=lambda event: event.ros)
    shown = with_notes(lines)

    def place(event: SessionEvent) -> float:
        return min(max(event.ros - start, 0.0), length_s)

    ticks = [Tick(place(event), _tick_kind(event), event.text, event.severity, event.robot)
             for event in shown if _tick_kind(event)]
    return TimeLine(start, length_s, tuple(shown), tuple(ticks),
                    _driven([(place(event), selected_from(event)) for event in shown], length_s),
                    _stopped([(place(event), stops(event)) for event in shown], length_s),
                    marks_of(lines))


def _tick_kind(event: SessionEvent) -> str:
    """Return the kind of a line's tick, '' for a line without a tick."""
    if event.kind == 'mark':
        return MARK
    if stops(event) is not None:
        return STOP if stops(event) and event.kind != 'start' else ''
    return EVENT if event.severity != INFO else ''


def selected_from(event: SessionEvent) -> Optional[Tuple[str, ...]]:
    """Return the robots selected from a line on, None for other lines."""
    names = event.data.get('selected')
    return tuple(map(str, names)) if isinstance(names, list) else None


def stops(event: SessionEvent) -> Optional[bool]:
    """Return whether STOP ALL is in force from a line on, None for other lines."""
    stopped = event.data.get('stop_all')
    return stopped if isinstance(stopped, bool) else None


def _driven(said: Sequence[Tuple[float, Optional[Tuple[str, ...]]]],
            length_s: float) -> Tuple[Span, ...]:
    """Return the spans in which each robot was selected."""
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
    """Return the spans in which STOP ALL was in force."""
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
