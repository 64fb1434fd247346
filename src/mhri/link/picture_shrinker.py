# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shrinks compressed colour pictures: by stronger compression, then by fewer pixels."""
import struct
from typing import Optional

import numpy as np

from mhri.base.opencv import cv2
from mhri.base.wire import Wire

# Maximum width and height of a jpeg.
MAX_SIDE = 65500
_LENGTH = struct.Struct('<I')
# (reduction of width and height, jpeg quality), from large to small.
STEPS = ((1, 60), (1, 40), (1, 25), (2, 70), (2, 50), (2, 30), (4, 70), (4, 45), (8, 50), (8, 20))
# Below this fraction of the limit the next picture tries the next larger step.
_ROOM = 0.6
KIND = 'sensor_msgs/CompressedImage'


class PictureShrinker:
    """Shrinks the pictures of one stream; remembers the step that fitted."""

    def __init__(self) -> None:
        self._step = 0

    def fit(self, data: bytes, most: float) -> bytes:
        """Return a serialized ``sensor_msgs/CompressedImage`` of at most about ``most`` bytes.

        Only colour jpegs and 8 bit pngs are changed. If no step fits, the smallest one is used.
        """
        if len(data) <= most:
            return data
        try:
            wire = Wire(KIND, data)
            wire.header()
            for _ in ('frame_id', 'format'):
                wire.array()
        except ValueError:
            return data
        begin = wire.at
        coded = np.frombuffer(data, np.uint8)[begin + 4:]
        while coded.size:
            factor, quality = STEPS[self._step]
            pixels = _decoded(coded)
            if pixels is None or max(pixels.shape) > MAX_SIDE * factor:
                return data
            if factor > 1:
                # OpenCV 4.2 cannot decode at reduced size from memory.
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
        pixels: Optional['np.ndarray'] = cv2.imdecode(
            coded, cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH)
    except cv2.error:  # too many pixels
        return None
    return pixels if pixels is not None and pixels.dtype == np.uint8 else None
