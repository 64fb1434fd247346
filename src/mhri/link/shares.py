# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What each stream may send of what a radio bears: commands first, then states, then pictures."""
from dataclasses import dataclass
import math
from typing import Dict, List

from mhri.link.bearing import AROUND_BYTES
from mhri.link.carried import COMMAND, PICTURE, STATE, Stream

# The echoes of the guard need not come more often to be alive for the gates.
ECHO_HZ = 12.0
# To pictures that somebody looks at states leave this part of the rest, and enough for one now and
# then, unless that is more than the second part [bytes/s].
TO_PICTURES, SOME_BYTES_PER_S, MOST_TO_PICTURES = 0.4, 4500.0, 0.65
# States are never less frequent than that, times their weight [Hz].
LEAST_HZ = 1.0
# First fewer pictures, down to this, then smaller ones, down to this; then once more [Hz, bytes].
FEW_HZ, SMALL_BYTES = 5.0, 3000.0
RARE_HZ, LEAST_BYTES = 1.5, 1500.0
# (from this loss on, so many pieces of a picture have a spare one), see pieces.py.
SPARE = ((0.08, 3), (0.01, 6))
# Time constant of the means [s].
_MEAN_S = 1.0
# What packing leaves of a state, until it is known.
_PACKED = 0.3


class Flow:
    """How much a stream would send; times are [s]."""

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
        """Take in how large one is [bytes]."""
        self._bytes += 0.1 * (size - self._bytes) if self._known else size - self._bytes
        self._known = True

    def packed(self) -> None:
        """Guess the size until the next one comes: from now on they are packed."""
        if self.stream.urgency == STATE:
            self._bytes, self._known = _PACKED * self._bytes, False

    def hz(self, now: float) -> float:
        """Return how often it comes, at most as often as it may be sent [Hz]."""
        hz = self._hz * math.exp(-min(50.0, (now - self._at) / _MEAN_S))
        return min(hz, self.stream.rate_hz) if self.stream.rate_hz else hz

    @property
    def size(self) -> float:
        """Of a message on the air [bytes]."""
        return self._bytes + AROUND_BYTES

    def demand(self, now: float) -> float:
        """Return what it would send [bytes/s]."""
        return self.hz(now) * self.size


@dataclass(frozen=True)
class Share:
    """What a stream may send.

    :param hz: messages in a second
    :param size: the most bytes of a picture; infinite to leave it as it is
    :param group: so many pieces of a picture have a spare one, see :mod:`mhri.link.pieces`
    :param bytes_per_s: what its pictures may take
    :param pace: bytes a second at which their pieces go, those of one stream after another's
    """

    hz: float
    size: float = math.inf
    group: int = 0
    bytes_per_s: float = math.inf
    pace: float = math.inf


def shares(flows: List[Flow], bytes_per_s: float, loss: float, now: float,
           quiet: bool = False) -> Dict[str, Share]:
    """Return {topic: its :class:`Share`} of what a radio bears.

    :param loss: the share of packets that it loses, from 0 to 1
    :param quiet: no pictures, since the radio is full of them still
    """
    by_class: Dict[str, List[Flow]] = {COMMAND: [], STATE: [], PICTURE: []}
    for flow in flows:
        by_class[flow.stream.urgency].append(flow)
    found = {flow.stream.topic: Share(min(ECHO_HZ, flow.hz(now)) or ECHO_HZ)
             for flow in by_class[COMMAND]}
    left = bytes_per_s - sum(found[flow.stream.topic].hz * flow.size for flow in by_class[COMMAND])
    left = max(left, 0.3 * bytes_per_s)
    looked_at = [flow for flow in by_class[PICTURE] if flow.hz(now) > 0.01 and not quiet]
    kept = max(TO_PICTURES * left, min(SOME_BYTES_PER_S, MOST_TO_PICTURES * left))
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
    return max(level * flow.stream.weight, flow.stream.least_hz)


def _level(flows: List[Flow], budget: float, now: float) -> float:
    """Return the rate, times the weight of each, with which streams fill a budget [Hz]."""
    low, high = LEAST_HZ, 200.0
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
        size = min(size, max(usable / FEW_HZ, min(SMALL_BYTES, usable / RARE_HZ), LEAST_BYTES))
    return Share(min(usable / size, flow.stream.rate_hz or math.inf),
                 math.inf if size == flow.size else size, group, bytes_per_s / count, bytes_per_s)
