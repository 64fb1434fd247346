# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Frames of the page: which are valid, and how many a second.

A text frame is a JSON object with one key: ``ack`` (number of a picture), ``look`` (a robot or
null), ``visible``, ``hold``, ``stop`` (true), ``stick`` ([turn, ahead, sideways], each -1 to 1,
left and ahead positive), ``head`` ([pan, tilt] [rad]).
"""
import json
import math
from typing import Any, Callable, Dict, Tuple

MAX_BYTES = 4096
# Frames a second in the long run, and at once: a network that was away delivers many at once.
RATE_HZ, BURST = 120.0, 480.0
# Close codes of RFC 6455, 7.4.1.
GOING_AWAY, VIOLATION, TOO_BIG, TRY_LATER = 1001, 1008, 1009, 1013


class BadFrame(ValueError):
    """A frame is refused; the text says why."""


def _numbers(count: int, most: float) -> Callable[[Any], bool]:
    """Return a check for a list of so many numbers up to an amount."""
    def check(value: Any) -> bool:
        return isinstance(value, list) and len(value) == count and all(
            isinstance(one, (int, float)) and not isinstance(one, bool)
            and math.isfinite(one) and abs(one) <= most for one in value)
    return check


def _is_flag(value: Any) -> bool:
    return isinstance(value, bool)


def _is_number(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2 ** 53


KINDS: Dict[str, Callable[[Any], bool]] = {
    'ack': _is_number, 'visible': _is_flag, 'hold': _is_flag, 'stop': lambda value: value is True,
    'look': lambda value: value is None or isinstance(value, str) and len(value) <= 100,
    'stick': _numbers(3, 1.0), 'head': _numbers(2, math.pi)}


def _no_constant(text: str) -> None:
    raise BadFrame(text + ' is no number of JSON')


def read_frame(text: str) -> Tuple[str, Any]:
    """Return (key, value) of a text frame.

    :raises BadFrame: it is not valid
    """
    try:
        frame = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError):
        raise BadFrame('not JSON') from None
    if not isinstance(frame, dict) or len(frame) != 1:
        raise BadFrame('not an object with one key')
    (key, value), = frame.items()
    if key not in KINDS:
        raise BadFrame('unknown key')
    try:
        valid = KINDS[key](value)
    except OverflowError:  # an integer beyond all floats
        valid = False
    if not valid:
        raise BadFrame('wrong value of ' + key)
    return key, value


class FrameRate:
    """Allows :data:`RATE_HZ` frames a second, up to :data:`BURST` at once.

    :param clock: returns monotonic seconds
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._left, self._at = BURST, clock()

    def check(self) -> None:
        """Count a frame.

        :raises BadFrame: there are too many
        """
        now = self._clock()
        self._left = min(BURST, self._left + (now - self._at) * RATE_HZ) - 1.0
        self._at = now
        if self._left < 0.0:
            raise BadFrame('too many frames')
