# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sessions that were recorded, as a list shows them: when, how long, who, marks, size."""
from dataclasses import dataclass
from datetime import datetime
import re
from typing import Iterable, Mapping, Optional, Sequence, Tuple

from mhri.base.numbers import natural_key
from mhri.base.text import tidy_text
from mhri.recording.folder import (
    marks_of, NotASession, read_events, read_info, robots_of, SessionEvent)
from mhri.recording.recording import size_text
from mhri.session.view import duration_text

# The list shows so many, the newest; a row names so many robots.
MOST_SESSIONS, MOST_NAMED = 200, 4
_PROGRESS = re.compile(r'^(report|film): (\d{1,3}) %')


@dataclass(frozen=True)
class SessionRow:
    """One session: its folder's ``name``, when it ``started`` [s since 1970, None: not known].

    ``length_s`` is None where no event tells it, ``size`` is in bytes, ``problem`` says why it
    cannot be replayed, '' if it can.
    """

    name: str
    started: Optional[float] = None
    length_s: Optional[float] = None
    robots: Tuple[str, ...] = ()
    marks: int = 0
    size: int = 0
    problem: str = ''

    @property
    def title(self) -> str:
        """The first line: when it began, by the clock of this computer, or what it is called."""
        return self.name if self.started is None else '{:%Y-%m-%d  %H:%M}'.format(
            datetime.fromtimestamp(self.started))

    @property
    def figures(self) -> str:
        """How long and how large it is."""
        length = '' if self.length_s is None else duration_text(self.length_s)
        return '   '.join(filter(None, (length, size_text(self.size))))

    @property
    def words(self) -> str:
        """The second line: its robots and marks, or what is wrong with it."""
        if self.problem:
            return self.problem
        named = ', '.join(self.robots[:MOST_NAMED]) or 'no robots'
        more = len(self.robots) - MOST_NAMED
        robots = '{} and {} more'.format(named, more) if more > 0 else named
        marks = {0: '', 1: '1 mark'}.get(self.marks, '{} marks'.format(self.marks))
        return '   '.join(filter(None, (robots, marks)))


def row_of(name: str, info: str, events: str, sizes: Mapping[str, int]) -> SessionRow:
    """Return the row of a folder.

    :param info: text of its ``session.yaml``
    :param events: text of its ``events.jsonl``, '' for none
    :param sizes: {name of a file in it: bytes}
    """
    size = sum(sizes.values())
    try:
        told = read_info(info)
    except NotASession as error:
        return SessionRow(name, size=size, problem=tidy_text(str(error)))
    lines = read_events(events)
    robots = sorted(map(tidy_text, robots_of(told, lines)), key=natural_key)
    bags = any('.bag' in file for file in sizes)
    return SessionRow(name, _day(told.started), _length_s(lines), tuple(robots),
                      len(marks_of(lines)), size, '' if bags else 'nothing was recorded in it')


def _day(started: float) -> Optional[float]:
    """Return a time that a calendar has, else None."""
    return started if 0.0 <= started < 4e9 else None


def _length_s(lines: Sequence[SessionEvent]) -> Optional[float]:
    """Return how long it lasted by its own lines [s]."""
    times = [line.ros for line in lines]
    return max(times) - min(times) if times else None


def newest(names: Iterable[str]) -> Tuple[str, ...]:
    """Return the names of the sessions to list, the newest first."""
    return tuple(sorted(names, reverse=True)[:MOST_SESSIONS])


def progress_of(line: str) -> Optional[int]:
    """Return the percent that a line of ``mhri_report`` tells, None of any other line."""
    found = _PROGRESS.match(line)
    return min(100, int(found.group(2))) if found else None
