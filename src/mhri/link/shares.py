# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Distributes the rate of a radio to streams: commands first, then states, then pictures."""
from dataclasses import dataclass
import math
from typing import Dict, List

from mhri.link.carried import COMMAND, PICTURE, STATE, Stream
from mhri.link.rate_estimator import AROUND_BYTES

# Sufficient rate of the guard's echoes for the mux [Hz].
ECHO_HZ = 12.0
# Fraction of the rest that is reserved for pictures with subscribers; at least this rate, for an
# occasional picture [bytes/s], but at most the second fraction.
TO_PICTURES, SOME_BYTES_PER_S, MAX_TO_PICTURES = 0.4, 4500.0, 0.65
# Minimum rate of states, times their weight [Hz].
MIN_HZ = 1.0
# The rate of pictures is reduced first, down to this, then their size, down to this; then both
# again [Hz, bytes].
FEW_HZ, SMALL_BYTES = 5.0, 3000.0
RARE_HZ, MIN_BYTES = 1.5, 1500.0
# (loss, pieces of a picture per spare from this loss on), see pieces.py.
SPARE = ((0.08, 3), (0.01, 6))
# Time constant of the means [s].
_MEAN_S = 1.0
# Assumed compression of a state, until it is measured.
_PACKED = 0.3


class Flow:
    """Measures the demand of a stream; times are [s]."""

    def __init__(self, stream: Stream) -> None:
        self.stream = stream
        self._bytes, self._known = 0.0, False
        self._hz = 0.0
        self._at = -math.inf

    def came(self, now: float) -> None:
        """Count a message."""
        kept = math.exp(-min(50.0, (now - self._at) / _MEAN_S))
        self._hz = self._hz * kept + 1.0 / _MEAN_S
        self._at = now

    def sized(self, size: int) -> None:
        """Record the size of a message [bytes]."""
        self._bytes += 0.1 * (size - self._bytes) if self._known else size - self._bytes
        self._known = True

    def packed(self) -> None:
        """Assume a smaller size until the next message, since messages are now compressed."""
        if self.stream.urgency == STATE:
            self._bytes, self._known = _PACKED * self._bytes, False

    def hz(self, now: float) -> float:
        """Return the rate of the stream, up to its maximum [Hz]."""
        hz = self._hz * math.exp(-min(50.0, (now - self._at) / _MEAN_S))
        return min(hz, self.stream.rate_hz) if self.stream.rate_hz else hz

    @property
    def size(self) -> float:
        """Size of a message on the air [bytes]."""
        return self._bytes + AROUND_BYTES

    def demand(self, now: float) -> float:
        """Return the rate without a limit [bytes/s]."""
        return self.hz(now) * self.size


@dataclass(frozen=True)
class Share:
    """The share of a stream.

    :param hz: rate of its messages [Hz]
    :param size: maximum size of a picture [bytes]; infinite: unchanged
    :param group: pieces of a picture per spare, see :mod:`mhri.link.pieces`
    :param bytes_per_s: average rate of its pictures
    :param pace: rate at which the pieces of a picture are sent, one stream at a time [bytes/s]
    """

    hz: float
    size: float = math.inf
    group: int = 0
    bytes_per_s: float = math.inf
    pace: float = math.inf


def shares(flows: List[Flow], bytes_per_s: float, loss: float, now: float,
           quiet: bool = False) -> Dict[str, Share]:
    """Return {topic: its :class:`Share`} of the rate of a radio.

    :param loss: fraction of packets that the radio loses, from 0 to 1
    :param quiet: whether to send no pictures, since the radio is still full of them
    """
    by_class: Dict[str, List[Flow]] = {COMMAND: [], STATE: [], PICTURE: []}
    for flow in flows:
        by_class[flow.stream.urgency].append(flow)
    found = {flow.stream.topic: Share(min(ECHO_HZ, flow.hz(now)) or ECHO_HZ)
             for flow in by_class[COMMAND]}
    left = bytes_per_s - sum(found[flow.stream.topic].hz * flow.size for flow in by_class[COMMAND])
    left = max(left, 0.3 * bytes_per_s)
    looked_at = [flow for flow in by_class[PICTURE] if flow.hz(now) > 0.01 and not quiet]
    kept = max(TO_PICTURES * left, min(SOME_BYTES_PER_S, MAX_TO_PICTURES * left))
    level = _level(by_class[STATE], left - (kept if looked_at else 0.0), now)
    for flow in by_class[STATE]:
        hz = _hz(flow, level)
        found[flow.stream.topic] = Share(hz)
        left -= min(hz, flow.hz(now)) * flow.size
    left = max(left, 0.1 * bytes_per_s)
    for flow in by_class[PICTURE]:
        found[flow.stream.topic] = Share(0.0) if quiet else _of_picture(
            flow, left, max(1, len(looked_at)), loss)
    return found


def _hz(flow: Flow, level: float) -> float:
    return max(level * flow.stream.weight, flow.stream.min_hz)


def _level(flows: List[Flow], budget: float, now: float) -> float:
    """Return the rate per weight with which streams fill a budget [Hz]."""
    low, high = MIN_HZ, 200.0
    for _ in range(12):
        level = 0.5 * (low + high)
        used = sum(min(_hz(flow, level), flow.hz(now)) * flow.size for flow in flows)
        low, high = (level, high) if used <= budget else (low, level)
    return low


def _of_picture(flow: Flow, bytes_per_s: float, count: int, loss: float) -> Share:
    group = next((group for least, group in SPARE if loss >= least), 0)
    usable = bytes_per_s / count / (1.0 + (1.0 / group if group else 0.0))
    size = flow.size
    if usable < FEW_HZ * size:
        size = min(size, max(usable / FEW_HZ, min(SMALL_BYTES, usable / RARE_HZ), MIN_BYTES))
    return Share(min(usable / size, flow.stream.rate_hz or math.inf),
                 math.inf if size == flow.size else size, group, bytes_per_s / count, bytes_per_s)
