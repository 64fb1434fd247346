# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stops of single robots that a screen has requested. No ROS, no clock, no thread."""
from typing import Dict, Iterable, Tuple

# A request: to be sent, sent, or answered; the drive's next state then says what is in force.
_ASKED, _SENT, _ANSWERED = 'asked', 'sent', 'answered'


class RobotStops:
    """Requests by the name of their robot; a new one for the same robot is sent as well.

    Transitions::

        ask       any      -> ASKED      never a toggle: a second press stops again
        take      ASKED    -> SENT
        failed    SENT     -> ASKED      the drive does not answer: ask again
        answered  SENT     -> ANSWERED   a press during the call stays ASKED
        on_state  ANSWERED -> dropped
    """

    def __init__(self) -> None:
        self._states: Dict[str, str] = {}

    def __contains__(self, name: object) -> bool:
        """Return whether a stop of this robot is requested, and not yet part of the state."""
        return name in self._states

    def ask(self, names: Iterable[str]) -> None:
        """Request the stop of these robots."""
        self._states.update((name, _ASKED) for name in names)

    def take(self) -> Tuple[str, ...]:
        """Return the robots to stop now."""
        names = tuple(name for name, state in self._states.items() if state == _ASKED)
        self._states.update((name, _SENT) for name in names)
        return names

    def failed(self, names: Iterable[str]) -> None:
        """Handle a call for these robots that was not answered."""
        self._change(names, _ASKED)

    def answered(self, names: Iterable[str]) -> None:
        """Handle the answer to a call for these robots."""
        self._change(names, _ANSWERED)

    def _change(self, names: Iterable[str], state: str) -> None:
        self._states.update((name, state) for name in names if self._states.get(name) == _SENT)

    def on_state(self) -> None:
        """Handle a state of the drive."""
        self._states = {name: state for name, state in self._states.items()
                        if state != _ANSWERED}
