# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Colours depth: near is yellow, far is dark purple, invalid is a grey hatch.

The map is viridis (matplotlib, S. van der Walt and N. Smith 2015): its lightness grows evenly,
people with any of the usual colour deficiencies can read it, and unlike cividis it contains no
grey. Invalid pixels are hatched because for some people any plain grey resembles a colour of the
map.
"""
from typing import Optional, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.camera.images import Range
from mhri.camera.range_follower import RangeFollower

MIN_SPAN_M = 0.5
_HATCH = ((96, 96, 96), (160, 160, 160))
_HATCH_PERIOD = 8


def _colours() -> np.ndarray:
    """Return viridis from far (0) to near (255) as a table of cv2: 256 x 1 x 3, in RGB order."""
    ramp = np.arange(256, dtype=np.uint8).reshape(256, 1)
    return np.ascontiguousarray(cv2.applyColorMap(ramp, cv2.COLORMAP_VIRIDIS)[..., ::-1])


_TABLE = _colours()


def colour_at(depth_m: float, depth_range_m: Range) -> Tuple[int, ...]:
    """Return the colour (r, g, b) of a depth [m], for a scale beside the picture."""
    near, far = depth_range_m
    index = round(255 * (far - depth_m) / (far - near))
    return tuple(int(value) for value in _TABLE[min(255, max(0, index)), 0])


class DepthColour:
    """Colours the pictures of one stream; the range follows the scene without flicker.

    The range is from the 2nd to the 98th percentile of the valid pixels, smoothed over a second,
    and at least :data:`MIN_SPAN_M` wide.
    """

    def __init__(self) -> None:
        self._follower = RangeFollower(MIN_SPAN_M, 0.0)
        self._hatch: Optional[np.ndarray] = None

    def colour(self, depth_m: np.ndarray, now: float) -> Tuple[np.ndarray, Optional[Range]]:
        """Return (rgb uint8 (h, w, 3), (near, far) [m] or None before the first valid pixel).

        :param depth_m: float32 (h, w), NaN invalid
        :param now: time of receipt [s], for the smoothing
        """
        depth_range = self._follower.follow(depth_m, now)
        if depth_range is None:
            return self._hatched(depth_m.shape).copy(), None
        near, far = depth_range
        scale = 255.0 / (far - near)
        valid = cv2.compare(depth_m, depth_m, cv2.CMP_EQ)
        # cv2 itself rounds and clips to 0..255; NaN becomes 0, and the hatch covers it.
        shade = cv2.addWeighted(depth_m, -scale, depth_m, 0.0, far * scale, dtype=cv2.CV_8U)
        rgb = cv2.applyColorMap(shade, _TABLE)
        cv2.copyTo(self._hatched(depth_m.shape), cv2.bitwise_not(valid), rgb)
        return rgb, depth_range

    def _hatched(self, shape: Tuple[int, ...]) -> np.ndarray:
        """Return a picture filled with the hatch."""
        if self._hatch is None or self._hatch.shape[:2] != shape:
            y, x = np.indices(shape)
            dark = (x + y) % _HATCH_PERIOD < _HATCH_PERIOD // 2
            self._hatch = np.where(dark[..., None], *(np.uint8(grey) for grey in _HATCH))
        return self._hatch
