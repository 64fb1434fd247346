# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The session as a screen shows it."""
from dataclasses import dataclass
from typing import Tuple

from mhri.recording.recording import size_text

# Said once a second while it records: not heard for so long, the recorder has gone [s].
SILENT_S = 3.5
NOT_RUNNING = 'nothing records: the recorder is not running'


@dataclass(frozen=True)
class SessionView:
    """What the recorder said last; ``there``: it is on the graph and answers."""

    there: bool = False
    recording: bool = False
    folder: str = ''
    lasts_s: float = 0.0
    bytes: int = 0
    marks: int = 0
    problem: str = ''

    @property
    def on(self) -> bool:
        """Tell whether a session is recorded now, as far as anybody knows."""
        return self.there and self.recording

    @property
    def trouble(self) -> str:
        """What an operator has to know, '' while all is well."""
        if self.recording and not self.there:
            return NOT_RUNNING
        return self.problem


def duration_text(seconds: float) -> str:
    """Return a duration as "00:12", from an hour on as "1:00:12"."""
    minutes, rest = divmod(max(0, int(seconds)), 60)
    hours, minutes = divmod(minutes, 60)
    return '{}:{:02d}:{:02d}'.format(hours, minutes, rest) if hours else \
        '{:02d}:{:02d}'.format(minutes, rest)


def button_texts(view: SessionView) -> Tuple[str, ...]:
    """Return the words of the button, the longest first."""
    if view.on:
        time = 'REC ' + duration_text(view.lasts_s)
        return (time + ' !',) if view.trouble else (time,)
    return ('not recorded !',) if view.trouble else ('Record',)


def tip_text(view: SessionView) -> str:
    """Return what the button says where the pointer rests on it."""
    parts = [view.trouble] if view.trouble else []
    if view.on:
        parts.append('{}, {}; {} marks'.format(view.folder, size_text(view.bytes), view.marks))
        parts.append('R ends the recording, N marks this moment')
    else:
        parts.append('R records the whole session: all robots, all inputs, what happens')
    return '\n'.join(parts)
