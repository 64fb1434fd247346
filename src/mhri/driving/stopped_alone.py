# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots that were stopped alone, and until when."""
from typing import Any, Dict, FrozenSet, Mapping, Sequence, Tuple


class StoppedAlone:
    """Keeps each robot stopped until it is selected again.

    Its stop ends with a selection that includes the robot after one without it, or with the first
    selection of another operator that includes it.
    """

    def __init__(self) -> None:
        # {robot: (operator at that time, whether a selection has left it out since)}
        self._stops: Dict[str, Tuple[str, bool]] = {}

    @property
    def names(self) -> FrozenSet[str]:
        """The stopped robots."""
        return frozenset(self._stops)

    def __contains__(self, name: object) -> bool:
        return name in self._stops

    def __len__(self) -> int:
        return len(self._stops)

    def stop(self, name: str, operator: str) -> None:
        """Stop a robot while an operator, '' for none, is in control."""
        self._stops[name] = operator, False

    def select(self, operator: str, robots: Sequence[str]) -> bool:
        """Handle the selection of the operator in control; return whether a stop has ended."""
        before = dict(self._stops)
        for name, (whose, left_out) in before.items():
            if name not in robots:
                self._stops[name] = whose, True
            elif left_out or operator != whose:
                del self._stops[name]
        return len(self._stops) < len(before)

    def kept(self) -> Dict[str, Any]:
        """Return the state for the next process, as JSON values."""
        return {name: list(whose) for name, whose in self._stops.items()}

    def restore(self, kept: Mapping[str, Any]) -> None:
        """Restore the result of :meth:`kept` of the previous process.

        :raises AttributeError, LookupError: it is malformed
        """
        self._stops = {name: (whose[0], bool(whose[1])) for name, whose in kept.items()}
