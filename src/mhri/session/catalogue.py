# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recorded sessions as rows of a list: time, length, robots, marks, size."""
from dataclasses import dataclass
from datetime import datetime
import re
from typing import Iterable, Mapping, Optional, Sequence, Tuple

from mhri.base.numbers import natural_key
from mhri.base.text import listed, tidy_text
from mhri.recording.folder import (
    marks_of, NotASession, read_events, read_info, robots_of, SessionEvent)
from mhri.recording.recording import duration_text, size_text

# Maximum number of sessions in the list, and of robots named in a row.
MAX_SESSIONS, MAX_NAMED = 200, 4
# A line follows the one before it within these times [s], or the clock leapt.
_BACK_S, _ON_S = -60.0, 86400.0
_PROGRESS = re.compile(r'^(report|film): (\d{1,3}) %')


@dataclass(frozen=True)
class SessionRow:
    """One session: the ``name`` of its folder, and ``started`` [s since 1970, None: unknown].

    ``length_s`` is None if unknown, ``size`` is in bytes, ``problem`` is the reason why it cannot
    be replayed, '' if it can.
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
        """The first line: local time of the start, or the name if unknown."""
        return self.name if self.started is None else '{:%Y-%m-%d  %H:%M}'.format(
            datetime.fromtimestamp(self.started))

    @property
    def figures(self) -> str:
        """Length and size."""
        length = '' if self.length_s is None else duration_text(self.length_s)
        return '   '.join(filter(None, (length, size_text(self.size))))

    @property
    def words(self) -> str:
        """The second line: robots and marks, or the problem."""
        if self.problem:
            return self.problem
        robots = listed(self.robots, MAX_NAMED) or 'no robots'
        marks = {0: '', 1: '1 mark'}.get(self.marks, '{} marks'.format(self.marks))
        return '   '.join(filter(None, (robots, marks)))


def row_of(name: str, info: str, events: str, sizes: Mapping[str, int]) -> SessionRow:
    """Return the row of a folder.

    :param info: text of its ``session.yaml``
    :param events: text of its ``events.jsonl``, '' if missing
    :param sizes: {name of a file in it: bytes}
    """
    size = sum(sizes.values())
    try:
        session = read_info(info)
    except NotASession as error:
        return SessionRow(name, size=size, problem=tidy_text(str(error)))
    lines = read_events(events)
    robots = sorted(map(tidy_text, robots_of(session, lines)), key=natural_key)
    bags = any('.bag' in file for file in sizes)
    return SessionRow(name, _day(session.started), _length_s(lines), tuple(robots),
                      len(marks_of(lines)), size, '' if bags else 'nothing was recorded in it')


def _day(started: float) -> Optional[float]:
    """Return a valid start time, None for an impossible one."""
    return started if 0.0 <= started < 4e9 else None


def _length_s(lines: Sequence[SessionEvent]) -> Optional[float]:
    """Return the length by the lines [s] without leaps of the clock, None without lines."""
    times = [line.ros for line in lines]
    steps = [after - before for before, after in zip(times, times[1:])]
    return sum(step for step in steps if _BACK_S < step < _ON_S) if times else None


def newest(names: Iterable[str]) -> Tuple[str, ...]:
    """Return the names of the sessions to list, the newest first."""
    return tuple(sorted(names, reverse=True)[:MAX_SESSIONS])


def progress_of(line: str) -> Optional[int]:
    """Return the percentage in a progress line of ``mhri_report``, None for any other line."""
    found = _PROGRESS.match(line)
    return min(100, int(found.group(2))) if found else None
