# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The times of a recording without its strays and without long gaps.

A clock that leaps, or is set only after the first messages (a computer without a clock of its own,
``/use_sim_time``), makes a recording of 20 s years long.
"""
from datetime import datetime
from typing import Iterable, List, Sequence, Tuple

import numpy as np

from mhri.base.text import listed
from mhri.recording.recording import duration_text, is_simulated

_NS = 10 ** 9
# A longer time without any message is a gap, of which this much is kept.
GAP_NS, KEPT_NS = 60 * _NS, _NS
# At most this many messages beyond a gap are strays, if the largest part has ten times as many.
MAX_STRAYS = 20

#: first and last time of some messages [ns], and their number
Span = Tuple[int, int, int]


def spans_of(times_ns: np.ndarray) -> List[Span]:
    """Return the spans between gaps of times in ascending order."""
    parts = np.split(times_ns, np.flatnonzero(np.diff(times_ns) > GAP_NS) + 1)
    return [(int(part[0]), int(part[-1]), len(part)) for part in parts if len(part)]


class TimeFold:
    """Moves the parts of a recording together; the largest one keeps its times.

    :param spans: of all its messages, in any order, at least one
    """

    def __init__(self, spans: Iterable[Span]) -> None:
        parts: List[Span] = []
        for begin, end, count in sorted(spans):
            if parts and begin - parts[-1][1] <= GAP_NS:
                first, last, before = parts[-1]
                parts[-1] = first, max(last, end), before + count
            else:
                parts.append((begin, end, count))
        largest = max(parts, key=lambda part: part[2])
        most = min(MAX_STRAYS, largest[2] // 10)
        self._strays = [part for part in parts if part[2] <= most]
        self._parts = [part for part in parts if part[2] > most]
        self._begins, self._ends, _ = np.array(self._parts, np.int64).T
        gaps = np.maximum(self._begins[1:] - self._ends[:-1] - KEPT_NS, 0)
        shifts = np.concatenate(([0], -np.cumsum(gaps)))
        self._shifts = shifts - shifts[self._parts.index(largest)]
        self.problems = self._named()

    def _named(self) -> List[str]:
        """Return sentences about what is left out."""
        strays = ['{} of {}'.format(count, _when(begin)) for begin, _, count in self._strays]
        gaps = ['{} after {}'.format(duration_text((begin - end) / _NS), _when(end))
                for (_, end, _), (begin, _, _) in zip(self._parts, self._parts[1:])]
        return ['messages with no others near their time are left out: '
                + listed(strays)] * bool(strays) + [
            'gaps are left out (times of day beyond one may be off by its length): '
            + listed(gaps)] * bool(gaps)

    def spans(self, spans: Sequence[Span]) -> List[Span]:
        """Return spans without the gaps, and without strays unless there is nothing else."""
        begins, ends, counts = np.array(spans, np.int64).T
        kept = ~self.is_stray(begins)
        kept |= not kept.any()
        return list(zip(*(part[kept].tolist() for part in (self(begins), self(ends), counts))))

    def is_stray(self, times_ns: np.ndarray) -> np.ndarray:
        """Return for each time whether its message is a stray."""
        places = self._places(times_ns)
        stray: np.ndarray = (times_ns < self._begins[places]) | (times_ns > self._ends[places])
        return stray

    def __call__(self, times_ns: np.ndarray) -> np.ndarray:
        """Return the times without the gaps; a time within one is that of the end before it."""
        places = self._places(times_ns)
        folded: np.ndarray = np.clip(
            times_ns, self._begins[places], self._ends[places]) + self._shifts[places]
        return folded

    def _places(self, times_ns: np.ndarray) -> np.ndarray:
        return np.maximum(np.searchsorted(self._begins, times_ns, 'right') - 1, 0)


def _when(time_ns: int) -> str:
    time_s = time_ns / _NS
    return '{:.3f} s'.format(time_s) if is_simulated(time_s) else \
        '{:%Y-%m-%d %H:%M:%S}'.format(datetime.fromtimestamp(time_s))
