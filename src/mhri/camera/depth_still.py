# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A picture of a depth camera to keep: coloured as on the screen, with its scale below."""
import numpy as np

from mhri.base.opencv import cv2
from mhri.base.wire import Data
from mhri.camera.depth_codec import decode_depth
from mhri.camera.depth_colour import colour_at, DepthColour
from mhri.camera.images import Range

# Height of the scale below the picture, as a fraction of its width.
_SCALE_SHARE = 0.045
_MIN_SCALE_PX, _LINE_PX = 12, 2


def depth_still(fmt: str, data: Data) -> np.ndarray:
    """Return a ``compressedDepth`` picture in colours, BGR (h, w, 3), above a scale in metres.

    Without a valid pixel there is no scale.

    :param fmt: ``format`` of its ``sensor_msgs/CompressedImage``
    :raises FrameError: it cannot be decoded
    """
    depth_m, _, _ = decode_depth(fmt, data)
    rgb, depth_range_m = DepthColour().colour(depth_m, 0.0)
    picture = np.ascontiguousarray(rgb[..., ::-1])
    if depth_range_m is None:
        return picture
    line = np.full((_LINE_PX, picture.shape[1], 3), 255, np.uint8)
    return np.vstack((picture, line, _scale(picture.shape[1], depth_range_m)))


def _scale(width: int, depth_range_m: Range) -> np.ndarray:
    """Return the scale, from near at the left to far at the right, with both written on it."""
    near, far = depth_range_m
    height = max(_MIN_SCALE_PX, round(_SCALE_SHARE * width))
    steps = np.array([colour_at(near + (far - near) * column / max(1, width - 1), depth_range_m)
                      for column in range(width)], np.uint8)[:, ::-1]
    scale = np.ascontiguousarray(np.broadcast_to(steps, (height, width, 3)))
    size, low = height / 28.0, round(0.76 * height)
    # Black on yellow, white on purple.
    for text, ink, right in (('{:.1f} m'.format(near), (0, 0, 0), False),
                             ('{:.1f} m'.format(far), (255, 255, 255), True)):
        wide = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, 1)[0][0]
        left = width - wide - height // 4 if right else height // 4
        cv2.putText(scale, text, (left, low), cv2.FONT_HERSHEY_SIMPLEX, size, ink, 1, cv2.LINE_AA)
    return scale
