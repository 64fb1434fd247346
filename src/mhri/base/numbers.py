# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's number: its own for good, so that a key drives the same robot tomorrow."""
import re
from typing import Dict, Iterable, List, Tuple

# The robots with a key: the digits 1 to 9. Later ones have a number but no key.
LAST_KEY = 9
# Higher ones are not kept between runs: a screen shows 200.
MOST_NUMBERS = 1000
_DIGITS = re.compile('([0-9]+)')


def natural_key(name: str) -> Tuple[List[Tuple[int, str]], str]:
    """Return the key by which to sort names: bot2 before bot10, Bot3 after bot2."""
    parts = _DIGITS.split(name.lower())
    return [(int(part), '') if place % 2 else (0, part) for place, part in enumerate(parts)], name


class RobotNumbers:
    """Who has which number, from 1; a robot gets it when first seen, and no other ever does."""

    def __init__(self) -> None:
        self._numbers: Dict[str, int] = {}

    def restore(self, kept: Dict[str, int]) -> None:
        """Take back what :meth:`kept` returned, except what contradicts given numbers."""
        for name, number in kept.items():
            if name not in self._numbers and number not in self._numbers.values():
                self._numbers[name] = number

    def kept(self) -> Dict[str, int]:
        """Return {name: number} of the numbers up to :data:`MOST_NUMBERS`, the lowest first."""
        by_number = sorted(self._numbers.items(), key=lambda item: item[1])
        return {name: number for name, number in by_number if number <= MOST_NUMBERS}

    def meet(self, names: Iterable[str]) -> None:
        """Give each robot without a number the lowest free one, in natural order."""
        for name in sorted(set(names).difference(self._numbers), key=natural_key):
            taken = set(self._numbers.values())
            self._numbers[name] = next(
                number for number in range(1, len(taken) + 2) if number not in taken)

    def of(self, name: str) -> int:
        """Return the number of a robot, 0 if it has none."""
        return self._numbers.get(name, 0)
