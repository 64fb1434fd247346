# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The state of the session, as the screen shows it."""
from dataclasses import dataclass
from typing import Tuple

from mhri.recording.recording import duration_text, size_text

# The state comes once a second while recording; the recorder is gone after this long without [s].
SILENT_S = 3.5
NOT_RUNNING = 'nothing records: the recorder is not running'


@dataclass(frozen=True)
class SessionView:
    """The recorder's newest state; ``there``: the recorder is on the graph and alive."""

    there: bool = False
    recording: bool = False
    folder: str = ''
    lasts_s: float = 0.0
    bytes: int = 0
    marks: int = 0
    problem: str = ''

    @property
    def on(self) -> bool:
        """Whether a session is being recorded, as far as known."""
        return self.there and self.recording

    @property
    def trouble(self) -> str:
        """A problem to show the operator, '' if none."""
        if self.recording and not self.there:
            return NOT_RUNNING
        return self.problem


def button_texts(view: SessionView) -> Tuple[str, ...]:
    """Return the texts of the button, the longest first."""
    if view.on:
        time = 'REC ' + duration_text(view.lasts_s)
        return (time + ' !',) if view.trouble else (time,)
    return ('not recorded !',) if view.trouble else ('Record',)


def tip_text(view: SessionView) -> str:
    """Return the tool tip of the button."""
    parts = [view.trouble] if view.trouble else []
    if view.on:
        parts.append('{}, {}; {} marks'.format(view.folder, size_text(view.bytes), view.marks))
        parts.append('R ends the recording, N marks this moment')
    else:
        parts.append('R records the whole session: all robots, all inputs, what happens')
    return '\n'.join(parts)
