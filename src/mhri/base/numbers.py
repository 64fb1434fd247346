# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's permanent number, so that a key always drives the same robot."""
import re
from typing import Dict, Iterable, List, Tuple

# Robots 1 to 9 have a digit key; the others have a number but no key.
LAST_KEY = 9
# Higher numbers are not kept between runs: a screen shows 200 robots.
MAX_NUMBERS = 1000
# A name gives a robot its number up to this one: turtlebot_103 shall not lose the keys for that.
LAST_NAMED = 12
_DIGITS = re.compile('([0-9]+)')


def natural_key(name: str) -> Tuple[List[Tuple[int, str]], str]:
    """Return the sort key of a name: bot2 before bot10, Bot3 after bot2."""
    parts = _DIGITS.split(name.lower())
    return [(int(part), '') if place % 2 else (0, part) for place, part in enumerate(parts)], name


def named_number(name: str) -> int:
    """Return the number at the end of a name, such as 9 of bot9; 0 for none up to LAST_NAMED."""
    digits = _DIGITS.split(name)[-2:]
    number = int(digits[0]) if len(digits) == 2 and not digits[1] and len(digits[0]) < 5 else 0
    return number if number <= LAST_NAMED else 0


class RobotNumbers:
    """The number of each robot, from 1: assigned at its first appearance, and never reused."""

    def __init__(self) -> None:
        self._numbers: Dict[str, int] = {}

    def restore(self, kept: Dict[str, int]) -> None:
        """Restore the result of :meth:`kept`, except where it contradicts assigned numbers."""
        for name, number in kept.items():
            if name not in self._numbers and number not in self._numbers.values():
                self._numbers[name] = number

    def kept(self) -> Dict[str, int]:
        """Return {name: number} of the numbers up to :data:`MAX_NUMBERS`, the lowest first."""
        by_number = sorted(self._numbers.items(), key=lambda item: item[1])
        return {name: number for name, number in by_number if number <= MAX_NUMBERS}

    def assign(self, names: Iterable[str]) -> None:
        """Assign a number to each robot without one, in natural order.

        A robot gets the number of its name (bot9: 9), up to :data:`LAST_NAMED`, if that is free;
        then the others get the lowest free ones.
        """
        new = sorted(set(names).difference(self._numbers), key=natural_key)
        for name in new:
            number = named_number(name)
            if number and number not in self._numbers.values():
                self._numbers[name] = number
        for name in new:
            if name not in self._numbers:
                taken = set(self._numbers.values())
                self._numbers[name] = next(
                    number for number in range(1, len(taken) + 2) if number not in taken)

    def of(self, name: str) -> int:
        """Return the number of a robot, 0 if it has none."""
        return self._numbers.get(name, 0)
