# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The last minute for a graph: rings of a fixed size that keep every peak.

Samples of any rate go into bins of 1/30 s; each bin keeps the minimum and the maximum, and the
times of its first and last sample. A curve has at most 300 points made from these, at any sample
rate: even in a window of a minute a spike of one sample is visible.
"""
from dataclasses import dataclass
import math
from typing import Dict, Iterable, Optional, Sequence, Tuple, Union

import numpy as np

from mhri.base.geometry import is_rotation

BIN_S = 1.0 / 30.0
LONGEST_S = 60.0
POINTS = 300
# Values beyond this count as missing: sums of larger ones overflow, and painting the dashes of such
# a long line would never end.
BIGGEST = 1e9
# A line breaks at a longer silence.
GAP_S = 0.5
# Rows of numbers, as an array or sequences.
_Rows = Union[np.ndarray, Sequence[float], Sequence[Sequence[float]]]

LINEAR = 'linear'
YAW_RATE = 'yaw_rate'
ACCEL = ('accel_x', 'accel_y', 'accel_z')
GYRO = ('gyro_x', 'gyro_y', 'gyro_z')
ORIENTATION = ('roll', 'pitch', 'yaw')
#: columns of the two rings: m/s and rad/s; rad in (-pi, pi], rad/s and m/s^2
ODOMETRY_KEYS = (LINEAR, YAW_RATE)
IMU_KEYS = ORIENTATION + GYRO + ACCEL


class BinRing:
    """The last minute of some values that arrive together, in bins.

    :param keys: names of the values; those of ORIENTATION are angles, which wrap around
    """

    def __init__(self, keys: Iterable[str]) -> None:
        self.keys = tuple(keys)
        # One more than the longest window needs: each end of the window may cut a bin.
        self._size = math.ceil(LONGEST_S / BIN_S) + 2
        shape = (self._size, len(self.keys))
        self._low, self._high = np.full(shape, np.nan), np.full(shape, np.nan)
        self._first, self._last = np.full(self._size, np.nan), np.full(self._size, np.nan)
        self._bins = np.full(self._size, -1, dtype=np.int64)
        self._newest = -1
        self.latest: Optional[np.ndarray] = None

    def add(self, times_s: _Rows, rows: _Rows) -> None:
        """Add samples.

        :param times_s: array (n,), ascending, of one monotonic clock; a sample older than the
            newest bin goes into that bin
        :param rows: array (n, keys); NaN and values beyond :data:`BIGGEST` are ignored
        """
        times_s, rows = np.asarray(times_s, float), np.array(rows, float)
        if not len(times_s):
            return
        with np.errstate(invalid='ignore'):
            rows[~(np.abs(rows) <= BIGGEST)] = np.nan
        bins = np.maximum.accumulate(np.maximum(
            np.floor(times_s / BIN_S).astype(np.int64), self._newest))
        starts = np.flatnonzero(np.concatenate(([True], np.diff(bins) > 0)))
        low = np.fmin.reduceat(rows, starts, axis=0)
        high = np.fmax.reduceat(rows, starts, axis=0)
        first = times_s[starts]
        last = times_s[np.append(starts[1:], len(times_s)) - 1]
        if bins[0] == self._newest:
            slot = bins[0] % self._size
            low[0] = np.fmin(low[0], self._low[slot])
            high[0] = np.fmax(high[0], self._high[slot])
            first[0] = self._first[slot]
        # Of a batch longer than the ring, keep the newest part.
        found = bins[starts][-self._size:]
        slots = found % self._size
        for kept, new in ((self._low, low), (self._high, high), (self._first, first),
                          (self._last, last), (self._bins, found)):
            kept[slots] = new[-self._size:]
        self._newest = int(bins[-1])
        self.latest = rows[-1]

    def copy(self) -> 'BinRing':
        """Return a copy with the current contents."""
        other = BinRing.__new__(BinRing)
        other.__dict__.update(self.__dict__)
        for name in ('_low', '_high', '_first', '_last', '_bins'):
            setattr(other, name, getattr(self, name).copy())
        return other

    def curve(self, key: str, now_s: float, window_s: float) -> Tuple[np.ndarray, np.ndarray]:
        """Return (x, y) of one value: x seconds before ``now_s`` (<= 0), NaN if the line breaks.

        Bins are merged by their number and not by their age, so that a peak keeps its shape while
        it moves.
        """
        column = self.keys.index(key)
        group = max(1, math.ceil(window_s / BIN_S / (POINTS // 2)))
        oldest = math.floor((now_s - window_s) / BIN_S) // group * group
        wanted = np.arange(max(0, oldest, self._newest - self._size + 1), self._newest + 1)
        wanted = wanted[self._bins[wanted % self._size] == wanted]
        wanted = wanted[np.isfinite(self._low[wanted % self._size, column])]
        if not len(wanted):
            return np.empty(0), np.empty(0)
        starts = np.flatnonzero(np.concatenate(([True], np.diff(wanted // group) > 0)))
        slots = wanted % self._size
        low = np.minimum.reduceat(self._low[slots, column], starts)
        high = np.maximum.reduceat(self._high[slots, column], starts)
        first = self._first[slots[starts]]
        last = self._last[slots[np.append(starts[1:], len(slots)) - 1]]
        x, y = _points(first - now_s, last - now_s, low, high)
        return _broken(x, y, key in ORIENTATION, group * BIN_S)


def _points(first: np.ndarray, last: np.ndarray, low: np.ndarray,
            high: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Return the line through the minima and maxima, in the order of its slope."""
    middle = low + high
    climbs = np.concatenate(([True], np.diff(middle) >= 0.0))
    x = np.column_stack((first, last)).ravel()
    y = np.column_stack((np.where(climbs, low, high), np.where(climbs, high, low))).ravel()
    keep = np.ones(len(x), bool)
    keep[1::2] = (low != high) | (first != last)
    return x[keep], y[keep]


def _broken(x: np.ndarray, y: np.ndarray, wraps: bool,
            step_s: float) -> Tuple[np.ndarray, np.ndarray]:
    """Insert a NaN at long gaps, and where an angle wraps around."""
    breaks = np.diff(x) > max(GAP_S, 2.0 * step_s)
    if wraps:
        breaks |= np.abs(np.diff(y)) > math.pi
    places = np.flatnonzero(breaks) + 1
    return np.insert(x, places, x[places]), np.insert(y, places, np.nan)


@dataclass(frozen=True)
class Series:
    """A robot's motion in the last minute before one instant; immutable.

    :param now_s: the instant on the clock of the rings
    :param rings: {key: :class:`BinRing`} for every key of ODOMETRY_KEYS and IMU_KEYS
    """

    now_s: float
    rings: Dict[str, BinRing]

    def curve(self, key: str, window_s: float) -> Tuple[np.ndarray, np.ndarray]:
        """Return (x, y) of a key as :meth:`BinRing.curve` does; both empty without samples."""
        return self.rings[key].curve(key, self.now_s, window_s)

    def latest(self, key: str) -> Optional[float]:
        """Return the newest value of a key, None before the first sample; NaN if it was missing."""
        ring = self.rings[key]
        return None if ring.latest is None else float(ring.latest[ring.keys.index(key)])


def roll_pitch_yaw(quaternions: np.ndarray) -> np.ndarray:
    """Return roll, pitch and yaw [rad] as an array (n, 3); rotations about z, y, x in this order.

    :param quaternions: array (n, 4) of x, y, z, w; scaled to unit length; NaN for what is not a
        rotation (:func:`mhri.base.geometry.is_rotation`)
    """
    with np.errstate(invalid='ignore', over='ignore'):
        turns = np.where(is_rotation(*quaternions.T)[:, None], quaternions, np.nan)
    x, y, z, w = (turns / np.linalg.norm(turns, axis=1, keepdims=True)).T
    return np.column_stack((
        np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)),
        np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))))


def round_step(least: float) -> float:
    """Return the first of ... 0.1, 0.2, 0.5, 1, 2, 5 ... not less than a number > 0."""
    decade = 10.0 ** math.floor(math.log10(least))
    return next(part * decade for part in (1.0, 2.0, 5.0, 10.0) if least <= part * decade * 1.0001)


class AxisRange:
    """The range of an axis, without jitter: grows at once, shrinks late, ends on round numbers.

    :param least: minimum half-width of the range, in the unit of the values
    :param shrink_after_s: how long a smaller range must suffice before the range shrinks [s]
    """

    def __init__(self, least: float, shrink_after_s: float = 4.0) -> None:
        self._least = least
        self._shrink_after_s = shrink_after_s
        self._range = (-least, least)
        self._ample_since: Optional[float] = None

    def follow(self, low: float, high: float, now_s: float) -> Tuple[float, float]:
        """Return the limits for the minimum and maximum shown (NaN for none); they include 0."""
        low, high = (0.0 if math.isnan(value) else value for value in (low, high))
        wanted = self._around(min(low, 0.0), max(high, 0.0))
        if wanted[0] < self._range[0] or wanted[1] > self._range[1]:
            self._range = (min(wanted[0], self._range[0]), max(wanted[1], self._range[1]))
            self._ample_since = None
        elif wanted == self._range:
            self._ample_since = None
        elif self._ample_since is None:
            self._ample_since = now_s
        elif now_s - self._ample_since >= self._shrink_after_s:
            self._range, self._ample_since = wanted, None
        return self._range

    def _around(self, low: float, high: float) -> Tuple[float, float]:
        """Return round limits with a margin around the values; an empty side stays small."""
        reach = max(-low, high, self._least)
        step = round_step(reach / 5.0)
        margin = 0.05 * reach
        floor = step * math.floor((low - margin) / step) if low < 0.0 else 0.0
        ceiling = step * math.ceil((high + margin) / step) if high > 0.0 else 0.0
        if reach == self._least:
            return -self._least, self._least
        # The empty side gets half a step, so that zero is not on the edge.
        return min(floor, -step / 2.0), max(ceiling, step / 2.0)
