# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots in the list, and the ones selected for control."""
from typing import Dict, Iterable, Tuple

from mhri.base.numbers import RobotNumbers


class Selection:
    """A list of robots in the order of their numbers, each selected or not."""

    def __init__(self) -> None:
        self._checked: Dict[str, bool] = {}
        self.numbers = RobotNumbers()

    @property
    def robots(self) -> Tuple[str, ...]:
        """All robots, in order."""
        return tuple(self._checked)

    @property
    def selected(self) -> Tuple[str, ...]:
        """Names of the selected robots, in order."""
        return tuple(name for name, checked in self._checked.items() if checked)

    def numbered(self) -> Dict[str, int]:
        """Return {name: number} of all robots, in order."""
        return {name: self.numbers.of(name) for name in self.robots}

    def add(self, name: str) -> bool:
        """Insert a robot by its number, not selected; return False if it is already present."""
        if name in self._checked:
            return False
        self.numbers.assign((name,))
        self._checked = dict(sorted({**self._checked, name: False}.items(),
                                    key=lambda item: self.numbers.of(item[0])))
        return True

    def remove(self, name: str) -> None:
        """Remove a robot; it keeps its number. Removing an unknown robot is allowed."""
        self._checked.pop(name, None)

    def check(self, names: Iterable[str]) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
        """Select exactly these robots; return the pair (newly selected, newly deselected)."""
        before, wanted = set(self.selected), set(names)
        for name in self._checked:
            self._checked[name] = name in wanted
        after = set(self.selected)
        return (tuple(name for name in self._checked if name in after - before),
                tuple(name for name in self._checked if name in before - after))
