# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a screen knew at a moment of a session and no message of that moment says.

It came of what had been heard before: how a stop was proved, a task that could be continued. The
session's lines tell it.
"""
from bisect import bisect_right
from typing import Dict, Iterable, List, Optional, Sequence, Tuple, TypeVar

from mhri.base.task_words import ended_as, STARTED
from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, ProofView
from mhri.recording.folder import SessionEvent
from mhri.session.lines import link_notes
from mhri.session.timeline import selected_from
from mhri.tasks.base import RESUMES

_PROVED = (('stopped in ', PROOF_STOPPED), ('standstill seen ', PROOF_STOPPED),
           ('NOT CONFIRMED', PROOF_NOT_CONFIRMED))
# Ended by whoever might continue it.
_MEANT = ('it was cancelled', 'it was ended')
_Value = TypeVar('_Value')
_Rows = List[Tuple[float, _Value]]


def newest(rows: Sequence[Tuple[float, _Value]], now: float) -> Optional[_Value]:
    """Return the value of the newest row that is not after a time, None for none.

    :param rows: (time, value), the oldest first
    """
    place = bisect_right([at_s for at_s, _ in rows], now)
    return rows[place - 1][1] if place else None


class Recalled:
    """What the lines of a session say about any moment of it; times are ROS times [s].

    :param events: the lines, in any order
    """

    def __init__(self, events: Iterable[SessionEvent]) -> None:
        events = sorted(events, key=lambda event: event.ros)
        self._links = link_notes(events)
        self._stops: _Rows[bool] = []
        self._proofs: Dict[str, _Rows[ProofView]] = {}
        self._tasks: Dict[str, _Rows[str]] = {}
        self._selected: _Rows[Tuple[str, ...]] = [
            (event.ros, names) for event in events
            for names in [selected_from(event)] if names is not None]
        for event in events:
            if event.kind == 'stop':
                self._see_stop(event)
            elif event.kind == 'task' and event.robot:
                self._see_task(event)

    def _see_stop(self, event: SessionEvent) -> None:
        if not event.robot:
            self._stops.append((event.ros, 'released' not in event.text))
        for words, state in _PROVED:
            if event.robot and event.text.startswith(words):
                self._proofs.setdefault(event.robot, []).append(
                    (event.ros, ProofView(state, event.text)))

    def _see_task(self, event: SessionEvent) -> None:
        ended = ended_as(event.text)
        rows = self._tasks.setdefault(event.robot, [])
        if ended is not None:
            label, state, why = ended
            goes_on = state in RESUMES and why not in _MEANT
            rows.append((event.ros, label if goes_on else ''))
        elif event.text.endswith(STARTED):
            rows.append((event.ros, ''))

    def selected(self, now: float) -> Optional[Tuple[str, ...]]:
        """Return the robots that were selected, None if no line says it."""
        return newest(self._selected, now)

    def link_note(self, robot: str, now: float) -> str:
        """Return the words on a bad link of a robot, '' while it was good."""
        return newest(self._links.get(robot, ()), now) or ''

    def proof(self, robot: str, now: float) -> Optional[ProofView]:
        """Return how the stop in force was proved for a robot, None if it was not by then."""
        begun = [at_s for at_s, stopped in self._stops if at_s <= now and stopped]
        if not begun or not newest(self._stops, now):
            return None
        return newest([row for row in self._proofs.get(robot, ()) if row[0] >= begun[-1]], now)

    def interrupted(self, robot: str, now: float) -> str:
        """Return the label, in small letters, of the task that a robot could continue; '': none."""
        return newest(self._tasks.get(robot, ()), now) or ''
