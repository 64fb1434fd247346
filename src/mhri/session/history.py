# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""State of a screen at a moment of a session, reconstructed from the session's lines.

No message of that moment contains it, because it results from earlier messages: the proof of a
stop, a task that can be continued.
"""
from bisect import bisect_right
from typing import Dict, Iterable, List, Optional, Sequence, Tuple, TypeVar

from mhri.base.views import FlagView, PROOF_NOT_CONFIRMED, PROOF_STOPPED, ProofView
from mhri.recording.folder import marks_of, SessionEvent
from mhri.session.flags import flag_of, MAX_FLAGS
from mhri.session.lines import link_notes
from mhri.session.timeline import selected_from, stops

# States by the event codes of a screen.
_PROVED = {'proof.stopped': PROOF_STOPPED, 'proof.doubtful': PROOF_NOT_CONFIRMED}
_Value = TypeVar('_Value')
_Rows = List[Tuple[float, _Value]]


def newest(rows: Sequence[Tuple[float, _Value]], now: float) -> Optional[_Value]:
    """Return the value of the newest row at or before a time, None if there is none.

    :param rows: (time, value), the oldest first
    """
    place = bisect_right([at_s for at_s, _ in rows], now)
    return rows[place - 1][1] if place else None


def proof_of(event: SessionEvent) -> Optional[ProofView]:
    """Return the proof of a stop in a line, None for other lines."""
    state = _PROVED.get(str(event.data.get('code')))
    return ProofView(state, event.text) if state and event.robot else None


class SessionHistory:
    """State at any moment of a session; times are ROS times [s].

    :param events: the lines, in any order
    """

    def __init__(self, events: Iterable[SessionEvent]) -> None:
        events = sorted(events, key=lambda event: event.ros)
        self._links = link_notes(events)
        self._stops: _Rows[bool] = [
            (event.ros, stopped) for event in events
            for stopped in [stops(event)] if stopped is not None]
        self._flags = [(mark.ros, flag) for mark in marks_of(events)
                       for flag in [flag_of(mark)] if flag is not None]
        self._proofs: Dict[str, _Rows[ProofView]] = {}
        self._tasks: Dict[str, _Rows[str]] = {}
        self._selected: _Rows[Tuple[str, ...]] = [
            (event.ros, names) for event in events
            for names in [selected_from(event)] if names is not None]
        for event in events:
            proof, key = proof_of(event), event.data.get('carry_on')
            if proof is not None:
                self._proofs.setdefault(event.robot, []).append((event.ros, proof))
            if isinstance(key, str):
                self._tasks.setdefault(event.robot, []).append((event.ros, key))

    def selected(self, now: float) -> Optional[Tuple[str, ...]]:
        """Return the robots that were selected, None if unknown."""
        return newest(self._selected, now)

    def flags(self, now: float) -> Tuple[FlagView, ...]:
        """Return the flags of the marks so far, each with its note."""
        return tuple(flag for at_s, flag in self._flags if at_s <= now)[-MAX_FLAGS:]

    def link_note(self, robot: str, now: float) -> str:
        """Return the warning of a robot's bad link, '' while it was good."""
        return newest(self._links.get(robot, ()), now) or ''

    def proof(self, robot: str, now: float) -> Optional[ProofView]:
        """Return a robot's proof of the stop in force, None if not proved by then."""
        begun = [at_s for at_s, stopped in self._stops if at_s <= now and stopped]
        if not begun or not newest(self._stops, now):
            return None
        return newest([row for row in self._proofs.get(robot, ()) if row[0] >= begun[-1]], now)

    def interrupted(self, robot: str, now: float) -> str:
        """Return the key of the task that a robot can continue, '' if none."""
        return newest(self._tasks.get(robot, ()), now) or ''
