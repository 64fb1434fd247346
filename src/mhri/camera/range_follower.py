# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The range of a scale that follows the measured values without flicker."""
import math
from typing import Optional

import numpy as np

from mhri.camera.images import Range

SMOOTH_S = 1.0
_PERCENT = (2, 98)
_SAMPLES = 20_000


class RangeFollower:
    """From the 2nd to the 98th percentile, smoothed over :data:`SMOOTH_S` seconds.

    :param min_span: minimum width of the range
    :param minimum: minimum of the lower end
    """

    def __init__(self, min_span: float, minimum: float = -math.inf) -> None:
        self._min_span = min_span
        self._minimum = minimum
        self._range: Optional[Range] = None
        self._at = 0.0

    def follow(self, values: np.ndarray, now: float) -> Optional[Range]:
        """Return the range after some more values; None before the first.

        :param values: any number of them, of which those of a picture are sampled; NaN or infinite
            if invalid
        :param now: time of receipt [s], for the smoothing
        """
        if values.ndim > 1:
            step = max(1, math.isqrt(values.size // _SAMPLES))
            values = values[::step, ::step]
        values = values[np.isfinite(values)]
        if len(values) == 0:
            return self._range
        low, high = (float(value) for value in np.percentile(values, _PERCENT))
        # Large values have too little precision for a narrow range.
        span = max(self._min_span, 1e-6 * max(abs(low), abs(high)))
        if high - low < span:
            half = span / 2
            middle = max((low + high) / 2, self._minimum + half)
            low, high = middle - half, middle + half
        if self._range is not None:
            weight = 1.0 - math.exp(-max(0.0, now - self._at) / SMOOTH_S)
            low = self._range[0] + weight * (low - self._range[0])
            high = self._range[1] + weight * (high - self._range[1])
        self._range, self._at = (low, high), now
        return self._range
