# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a report of a session says, as plain values."""
from dataclasses import dataclass, field
from datetime import datetime
import math
import re
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from mhri.base.numbers import natural_key
from mhri.recording.folder import (
    INFO, marks_of, NotASession, SessionEvent, SessionInfo, SessionMark, STILLS)
from mhri.session.sheet import Spot, Way
from mhri.session.survey import link_words, RobotSurvey
from mhri.session.timeline import Span, TimeLine

# As those of the map on the screen, dark on white, by the number of a robot.
COLOURS = ('#0072b2', '#a14f80', '#6f6400', '#5b4bc4', '#00766e', '#7a5a2e')
# A page with more would be opened by nobody; the session has them all.
MOST_MARKS, MOST_EVENTS, MOST_STOPS, MOST_STILLS = 300, 500, 100, 200
_STILL = re.compile(STILLS + r'/[A-Za-z0-9_-]+\.jpg\Z')
# Screens write the proof of a stop a while after the release, too [s].
_PROOF_AFTER_S = 1.0


@dataclass(frozen=True)
class RobotRow:
    """What is said of a robot; ``silences`` are shown on the time line."""

    name: str
    number: int
    kind: str
    colour: str
    survey: RobotSurvey
    driven_s: float

    def cells(self) -> Tuple[str, ...]:
        """Return its row of the table."""
        survey = self.survey
        if not survey.readings:
            return (self.kind, '-', '-', seconds_text(self.driven_s), 'never heard',
                    *link_words(survey.round_trips_s))
        count = len(survey.silences)
        silent = '{}, {}'.format('once' if count == 1 else '{} times'.format(count),
                                 seconds_text(survey.silent_s)) if count else 'never'
        return (self.kind, '{:.1f} m'.format(survey.distance_m),
                '{:.2f} m/s'.format(survey.fastest_mps), seconds_text(self.driven_s), silent,
                *link_words(survey.round_trips_s))


#: the heads of :meth:`RobotRow.cells`
ROBOT_HEADS = ('type', 'distance', 'fastest', 'driven', 'silent', 'round trip', '95 % below')


@dataclass(frozen=True)
class StopRow:
    """One stop: when, and for each robot (name, what its odometry says, what the screen said)."""

    span: Span
    proofs: Tuple[Tuple[str, str, str], ...]


@dataclass(frozen=True)
class Report:
    """Everything that a page says.

    ``wall`` is the time of day of the first message [s since 1970]; ``drills`` are tables
    (title, rows); ``problems`` sentences about what is missing.
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

    def clock(self, at_s: float) -> str:
        """Return the time of day of a moment of the session."""
        return clock_text(self.wall + at_s)


def clock_text(wall: float) -> str:
    """Return a time of day, e.g. "14:03:22"; '' for one that cannot be."""
    try:
        return '{:%H:%M:%S}'.format(datetime.fromtimestamp(wall))
    except (ValueError, OverflowError, OSError):
        return ''


def date_text(wall: float) -> str:
    """Return a day and time, e.g. "1 March 2026, 14:03:22"; '' for one that cannot be."""
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


def is_still(name: str) -> bool:
    """Tell whether a name is that of a still in the session's folder, and of nothing else."""
    return _STILL.match(name) is not None


def stills_of(events: Sequence[SessionEvent]) -> Tuple[Tuple[float, str], ...]:
    """Return (ROS time [s], name) of the stills that belong to no mark."""
    return tuple((event.ros, str(name)) for event in events
                 if event.kind == 'still' and isinstance(event.data.get('stills'), list)
                 for name in event.data['stills'])


def sound_events(events: Sequence[SessionEvent]) -> Tuple[List[SessionEvent], int]:
    """Return the events whose times and marks can be, and how many others there are."""
    good = [event for event in events if 0.0 <= event.ros < 1e11 and 0.0 <= event.wall < 1e11
            and isinstance(event.data.get('mark', ''), str)]
    return good, len(events) - len(good)


def wall_offset(events: Sequence[SessionEvent]) -> float:
    """Return what is to be added to ROS time for the time of day [s]."""
    return events[0].wall - events[0].ros if events else 0.0


def rows_of_robots(robots: Mapping[str, Mapping[str, Any]], surveys: Mapping[str, RobotSurvey],
                   line: TimeLine) -> Tuple[RobotRow, ...]:
    """Return the robots of a session in the order of their numbers."""
    rows = []
    for place, name in enumerate(sorted(robots, key=natural_key), 1):
        number = robots[name].get('number')
        number = number if isinstance(number, int) and 0 < number < 10000 else place
        words = [robots[name].get(key) for key in ('type', 'model')]
        driven = sum(span.end_s - span.begin_s for span in line.driven if span.robot == name)
        rows.append(RobotRow(
            name, number, ' '.join(word for word in words if isinstance(word, str) and word),
            COLOURS[(number - 1) % len(COLOURS)], surveys[name], driven))
    return tuple(sorted(rows, key=lambda row: (row.number, natural_key(row.name))))


def rows_of_stops(line: TimeLine, surveys: Mapping[str, RobotSurvey]) -> Tuple[StopRow, ...]:
    """Return every stop with its proofs, for each robot that there was by then."""
    said: List[Tuple[float, SessionEvent]] = [
        (event.ros - line.start, event) for event in line.events
        if event.kind == 'stop' and event.robot]
    rows = []
    for place, span in enumerate(line.stopped[:MOST_STOPS]):
        until_s = span.end_s + _PROOF_AFTER_S
        words: Dict[str, str] = {event.robot: event.text for at_s, event in said
                                 if span.begin_s <= at_s <= until_s}
        proofs = [(name, survey.stopped(place).words(), words.get(name, '-'))
                  for name, survey in sorted(surveys.items(), key=lambda row: natural_key(row[0]))
                  if survey.first_s is not None and survey.first_s <= span.end_s or name in words]
        rows.append(StopRow(span, tuple(proofs)))
    return tuple(rows)


def events_shown(events: Sequence[SessionEvent]) -> List[SessionEvent]:
    """Return at most :data:`MOST_EVENTS` events; warnings and errors go before the others."""
    if len(events) <= MOST_EVENTS:
        return list(events)
    loud = [event for event in events if event.severity != INFO]
    return loud[:MOST_EVENTS] if loud else list(events[:MOST_EVENTS])


def spots_of(marks: Sequence[SessionMark], placed: Sequence[str], frame: str) -> List[Spot]:
    """Return where marks are on the map: at the first robot of each that has a place there.

    :param placed: robots whose ways are in the frame of the map; without any all ways are in
        those of their odometry, and so are the marks
    """
    spots = []
    for mark in marks[:MOST_MARKS]:
        for robot, pose in mark.poses.items():
            place = place_of(pose)
            if place is not None and (not placed or place[2] == frame):
                spots.append(Spot(mark.id, place[0], place[1]))
                break
    return spots


def place_of(pose: Any) -> Optional[Tuple[float, float, str]]:
    """Return (x [m], y [m], frame) of a pose of a mark, None where it is none."""
    if not isinstance(pose, list) or len(pose) < 2:
        return None
    x_m, y_m = pose[0], pose[1]
    if not all(type(value) in (int, float) and math.isfinite(value) and abs(value) < 1e7
               for value in (x_m, y_m)):
        return None
    return float(x_m), float(y_m), str(pose[3]) if len(pose) > 3 else ''


def ways_of(rows: Sequence[RobotRow], within_m: float) -> List[Way]:
    """Return the ways of robots for a map; if any is placed on it, those of the placed alone."""
    placed = [row for row in rows if row.survey.placed]
    return [Way(row.name, row.number, row.colour, row.survey.way(within_m))
            for row in placed or rows if row.survey.pieces]


def report_of(name: str, info: SessionInfo, line: TimeLine, robots: Mapping[str, Mapping[str, Any]],
              surveys: Mapping[str, RobotSurvey], **more: Any) -> Report:
    """Return the report of a session.

    :param surveys: of each robot, to the end of the session
    :param more: ``drills``, ``problems`` of :class:`Report`
    """
    if not line.events and not any(survey.readings for survey in surveys.values()):
        raise NotASession('it has neither events nor any message of a robot')
    rows = rows_of_robots(robots, surveys, line)
    return Report(
        name, info, line, line.start + wall_offset(line.events), rows, marks_of(line.events),
        rows_of_stops(line, surveys), extra_stills=stills_of(line.events),
        placed=tuple(row.name for row in rows if row.survey.placed), **more)
