# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The contents of a session's report, as plain values."""
from dataclasses import dataclass, field
from datetime import datetime
import re
from typing import Any, Dict, List, Mapping, Sequence, Tuple

from mhri.base.numbers import natural_key
from mhri.base.robot_colours import colour_of
from mhri.base.views import FlagView
from mhri.events.events import BEYOND, WITHIN
from mhri.recording.folder import (
    INFO, NotASession, SessionEvent, SessionInfo, SessionMark, STILLS)
from mhri.session.flags import flag_of
from mhri.session.history import proof_of
from mhri.session.sheet import Way
from mhri.session.survey import link_words, RobotSurvey, Stopped
from mhri.session.timeline import Span, TimeLine

# Limits that keep the page short; the session itself has everything.
MAX_MARKS, MAX_EVENTS, MAX_STOPS, MAX_STILLS, MAX_SENSORS = 300, 500, 100, 200, 200
_STILL = re.compile(STILLS + r'/[A-Za-z0-9_-]+\.jpg\Z')
# Screens may write the proof of a stop up to this long after the release [s].
_PROOF_AFTER_S = 1.0


@dataclass(frozen=True)
class RobotRow:
    """The figures of a robot."""

    name: str
    number: int
    kind: str
    colour: str
    survey: RobotSurvey
    driven: Tuple[Span, ...]

    def cells(self) -> Tuple[str, ...]:
        """Return the cells of its table row."""
        survey = self.survey
        driven = (_total(self.driven), '-' if survey.on_tasks is None else _total(survey.on_tasks))
        if not survey.readings:
            return (self.kind, '-', '-', *driven, 'no messages',
                    *link_words(survey.round_trips_s))
        count = len(survey.silences)
        silent = '{}, {}'.format('once' if count == 1 else '{} times'.format(count),
                                 _total(survey.silences)) if count else 'never'
        return (self.kind, '{:.1f} m'.format(survey.distance_m),
                '{:.2f} m/s'.format(survey.fastest_mps), *driven, silent,
                *link_words(survey.round_trips_s))


#: column headings of :meth:`RobotRow.cells`
ROBOT_HEADS = ('type', 'distance', 'fastest', 'driven', 'on tasks', 'silent', 'round trip',
               '95 % below')


@dataclass(frozen=True)
class StopRow:
    """One stop: its time span and a proof per robot (name, by odometry, text of the screen).

    ``released`` is false if the session ended first.
    """

    span: Span
    proofs: Tuple[Tuple[str, Stopped, str], ...]
    released: bool = True


@dataclass(frozen=True)
class SensorRow:
    """A sensor beyond its limit: its robot, the time span, and the words of the screen.

    ``over`` is false if the session ended first.
    """

    span: Span
    text: str
    over: bool = True


@dataclass(frozen=True)
class Report:
    """The contents of a page.

    ``wall`` is the time of day of the first message [s since 1970]; ``drills`` are tables
    (title, rows); ``problems`` are sentences about missing data.
    """

    name: str
    info: SessionInfo
    line: TimeLine
    wall: float
    robots: Tuple[RobotRow, ...]
    marks: Tuple[SessionMark, ...]
    stops: Tuple[StopRow, ...]
    drills: Tuple[Tuple[str, Sequence[Sequence[str]]], ...] = ()
    problems: Tuple[str, ...] = ()
    extra_stills: Tuple[Tuple[float, str], ...] = ()
    placed: Tuple[str, ...] = field(default=())
    sensors: Tuple[SensorRow, ...] = ()

    def clock(self, at_s: float) -> str:
        """Return the time of day of a moment of the session."""
        return clock_text(self.wall + at_s)


def clock_text(wall: float) -> str:
    """Return a time of day, e.g. "14:03:22"; '' if the time is invalid."""
    try:
        return '{:%H:%M:%S}'.format(datetime.fromtimestamp(wall))
    except (ValueError, OverflowError, OSError):
        return ''


def date_text(wall: float) -> str:
    """Return date and time, e.g. "1 March 2026, 14:03:22"; '' if the time is invalid."""
    try:
        when = datetime.fromtimestamp(wall)
    except (ValueError, OverflowError, OSError):
        return ''
    return '{0.day} {0:%B %Y, %H:%M:%S}'.format(when)


def seconds_text(seconds: float) -> str:
    """Return a duration in words: "8.2 s", "3 min 12 s", "1 h 04 min"."""
    if seconds < 60.0:
        return '{:.1f} s'.format(seconds)
    whole = round(seconds)
    if whole < 3600:
        return '{} min {:02d} s'.format(*divmod(whole, 60))
    return '{} h {:02d} min'.format(whole // 3600, whole % 3600 // 60)


def _total(spans: Sequence[Span]) -> str:
    """Return the total duration of spans in words."""
    return seconds_text(sum(span.lasts_s for span in spans))


def is_still(name: str) -> bool:
    """Return whether a name is a valid path of a still within the session's folder."""
    return _STILL.match(name) is not None


def stills_of(events: Sequence[SessionEvent]) -> Tuple[Tuple[float, str], ...]:
    """Return (ROS time [s], name) of the stills taken without a mark."""
    return tuple((event.ros, str(name)) for event in events
                 if event.kind == 'still' and isinstance(event.data.get('stills'), list)
                 for name in event.data['stills'])


def sound_events(events: Sequence[SessionEvent]) -> Tuple[List[SessionEvent], int]:
    """Return the events with valid times and marks, and the number of invalid ones."""
    good = [event for event in events if 0.0 <= event.ros < 1e11 and 0.0 <= event.wall < 1e11
            and isinstance(event.data.get('mark', ''), str)]
    return good, len(events) - len(good)


def wall_offset(events: Sequence[SessionEvent]) -> float:
    """Return the offset from ROS time to the time of day [s]."""
    return events[0].wall - events[0].ros if events else 0.0


def rows_of_robots(robots: Mapping[str, Mapping[str, Any]], surveys: Mapping[str, RobotSurvey],
                   line: TimeLine) -> Tuple[RobotRow, ...]:
    """Return the robots of a session in the order of their numbers."""
    rows = []
    for place, name in enumerate(sorted(robots, key=natural_key), 1):
        number = robots[name].get('number')
        number = number if isinstance(number, int) and 0 < number < 10000 else place
        words = [robots[name].get(key) for key in ('type', 'model')]
        driven = tuple(span for span in line.driven if span.robot == name)
        rows.append(RobotRow(
            name, number, ' '.join(word for word in words if isinstance(word, str) and word),
            colour_of(number, dark=False), surveys[name], driven))
    return tuple(sorted(rows, key=lambda row: (row.number, natural_key(row.name))))


def rows_of_stops(line: TimeLine, surveys: Mapping[str, RobotSurvey]) -> Tuple[StopRow, ...]:
    """Return every stop with the proofs of the robots present by then."""
    said: List[Tuple[float, str, str]] = [
        (event.ros - line.start, event.robot, proof.text) for event in line.events
        for proof in [proof_of(event)] if proof is not None]
    rows = []
    for place, span in enumerate(line.stopped[:MAX_STOPS]):
        until_s = span.end_s + _PROOF_AFTER_S
        words: Dict[str, str] = {robot: text for at_s, robot, text in said
                                 if span.begin_s <= at_s <= until_s}
        proofs = [(name, survey.stopped(place), words.get(name, '-'))
                  for name, survey in sorted(surveys.items(), key=lambda row: natural_key(row[0]))
                  if survey.first_s is not None and survey.first_s <= span.end_s or name in words]
        rows.append(StopRow(span, tuple(proofs), span.end_s < line.length_s))
    return tuple(rows)


def rows_of_sensors(line: TimeLine) -> Tuple[SensorRow, ...]:
    """Return the spans in which sensors were beyond their limits, the earliest first."""
    # {(robot, key of the sensor): (begin, text)}
    begun: Dict[Tuple[str, str], Tuple[float, str]] = {}
    rows = []
    for event in line.events:
        code, who = event.data.get('code'), (event.robot, str(event.data.get('readout')))
        at_s = event.ros - line.start
        if code == BEYOND:
            begun.setdefault(who, (at_s, event.text))
        elif code == WITHIN and who in begun:
            begin_s, text = begun.pop(who)
            rows.append(SensorRow(Span(begin_s, at_s, event.robot), text))
    rows += [SensorRow(Span(begin_s, max(begin_s, line.length_s), robot), text, False)
             for (robot, _), (begin_s, text) in begun.items()]
    return tuple(sorted(rows, key=lambda row: row.span.begin_s)[:MAX_SENSORS])


def events_shown(events: Sequence[SessionEvent]) -> List[SessionEvent]:
    """Return at most :data:`MAX_EVENTS` events; if there are more, prefer warnings and errors."""
    if len(events) <= MAX_EVENTS:
        return list(events)
    loud = [event for event in events if event.severity != INFO]
    return loud[:MAX_EVENTS] if loud else list(events[:MAX_EVENTS])


def spots_of(marks: Sequence[SessionMark], placed: Sequence[str], frame: str) -> List[FlagView]:
    """Return the flags of the marks on the map.

    :param placed: robots whose paths are in the map's frame; if empty, paths and marks are in
        the odometry frames
    """
    flags = (flag_of(mark, frame if placed else '') for mark in marks[:MAX_MARKS])
    return [flag for flag in flags if flag is not None]


def ways_of(rows: Sequence[RobotRow], within_m: float) -> List[Way]:
    """Return the robots' paths; if any robot is placed on the map, those of placed robots only."""
    placed = [row for row in rows if row.survey.placed]
    return [Way(row.name, row.number, row.colour, row.survey.way(within_m))
            for row in placed or rows if row.survey.pieces]


def report_of(name: str, info: SessionInfo, line: TimeLine, robots: Mapping[str, Mapping[str, Any]],
              surveys: Mapping[str, RobotSurvey], **more: Any) -> Report:
    """Return the report of a session.

    :param surveys: {robot: its survey of the whole session}
    :param more: ``drills``, ``problems`` of :class:`Report`
    :raises NotASession: there are neither events nor messages of a robot
    """
    if not line.events and not any(survey.readings for survey in surveys.values()):
        raise NotASession('it has neither events nor any message of a robot')
    rows = rows_of_robots(robots, surveys, line)
    return Report(
        name, info, line, line.start + wall_offset(line.events), rows, line.marks,
        rows_of_stops(line, surveys), extra_stills=stills_of(line.events),
        sensors=rows_of_sensors(line),
        placed=tuple(row.name for row in rows if row.survey.placed), **more)
