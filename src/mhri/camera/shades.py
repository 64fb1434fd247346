# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shows pictures of more than 8 bits, as infrared and thermal cameras send them, in 8 bits.

Their values may fill only a small part of 16 bits: the top 8 bits of a 10-bit picture are black.
"""
from typing import Optional, Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.camera.images import Range
from mhri.camera.range_follower import RangeFollower

# Minimum width of the range of grey integers, so that noise stays faint, and of other numbers.
MIN_SPAN, MIN_FLOAT_SPAN = 16.0, 1e-3


class Shades:
    """Reduces the pictures of one stream to 8 bits.

    Grey is shown from its 2nd to its 98th percentile, smoothed over a second. Colours keep their
    balance: white is the least of 8, 10, 12, 14 and 16 bits that held all values so far.
    """

    def __init__(self) -> None:
        self._follower: Optional[RangeFollower] = None
        self._dtype: Optional[np.dtype] = None
        self._white = 255

    def rgb(self, pixels: np.ndarray, now: float) -> Tuple[np.ndarray, Optional[Range]]:
        """Return (rgb uint8 (h, w, 3), values of grey shown as black and white; else None).

        :param pixels: grey of any number type (h, w), or RGB in 8 or 16 bits (h, w, 3)
        :param now: time of receipt [s], for the smoothing
        """
        if pixels.ndim > 2:
            return self._colours(pixels), None
        if pixels.dtype == np.uint8:
            return cv2.cvtColor(pixels, cv2.COLOR_GRAY2RGB), None
        if self._follower is None or pixels.dtype != self._dtype:
            self._dtype = pixels.dtype
            self._follower = RangeFollower(
                MIN_FLOAT_SPAN if pixels.dtype.kind == 'f' else MIN_SPAN)
        shown = self._follower.follow(pixels, now)
        low, high = shown or (0.0, 1.0)
        scale = 255.0 / (high - low)
        # cv2 rounds, clips to 0..255 and makes NaN 0.
        grey = cv2.addWeighted(pixels, scale, pixels, 0.0, -low * scale, dtype=cv2.CV_8U)
        return cv2.cvtColor(grey, cv2.COLOR_GRAY2RGB), shown

    def _colours(self, pixels: np.ndarray) -> np.ndarray:
        if pixels.dtype == np.uint8:
            return pixels
        most = int(pixels.max())
        self._white = max(self._white, next(
            2 ** bits - 1 for bits in (8, 10, 12, 14, 16) if most < 2 ** bits))
        return cv2.convertScaleAbs(pixels, alpha=255.0 / self._white)
