# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes compressed colour pictures smaller: harder compressed, then with fewer pixels."""
import struct
from typing import Optional

import numpy as np

from mhri.base.opencv import cv2
from mhri.link.renaming import after_texts

# More pixels a side no jpeg has.
MAX_SIDE = 65500
_LENGTH = struct.Struct('<I')
# (how many times fewer pixels each way, jpeg quality), from large to small.
STEPS = ((1, 60), (1, 40), (1, 25), (2, 70), (2, 50), (2, 30), (4, 70), (4, 45), (8, 50), (8, 20))
# Less than this part of what may be used: a larger one is tried next time.
_ROOM = 0.6
KIND = 'sensor_msgs/CompressedImage'


class Smaller:
    """Makes the pictures of one stream smaller; remembers which step fitted."""

    def __init__(self) -> None:
        self._step = 0

    def fit(self, data: bytes, most: float) -> bytes:
        """Return a ``sensor_msgs/CompressedImage`` as bytes, of about so many at most.

        What is no colour jpeg, or png of 8 bits, comes back as it is; the smallest step is taken
        for one that fits nowhere.
        """
        if len(data) <= most:
            return data
        try:
            begin = after_texts(data, 2)
        except ValueError:
            return data
        coded = np.frombuffer(data, np.uint8)[begin + 4:]
        while coded.size:
            factor, quality = STEPS[self._step]
            pixels = _decoded(coded)
            if pixels is None or max(pixels.shape) > MAX_SIDE * factor:
                return data
            if factor > 1:
                # OpenCV 4.2 does not know how to read fewer pixels from memory.
                pixels = cv2.resize(pixels, None, fx=1.0 / factor, fy=1.0 / factor,
                                    interpolation=cv2.INTER_AREA)
            found: bytes = cv2.imencode(
                '.jpg', pixels, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
            if begin + 4 + len(found) <= most or self._step == len(STEPS) - 1:
                if begin + len(found) < _ROOM * most and self._step:
                    self._step -= 1
                return data[:begin] + _LENGTH.pack(len(found)) + found
            self._step += 1
        return data


def _decoded(coded: 'np.ndarray') -> Optional['np.ndarray']:
    try:
        pixels: Optional['np.ndarray'] = cv2.imdecode(coded, cv2.IMREAD_COLOR)
    except cv2.error:  # too many pixels
        return None
    return pixels
