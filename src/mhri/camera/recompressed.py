# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A raw picture turned into the message that a camera with a compressed twin would have sent."""
import struct
from typing import Tuple

import numpy as np

from mhri.base.opencv import cv2
from mhri.camera.depth_codec import encode_depth
from mhri.camera.image_message import RAW_TYPE, read_raw, Wire
from mhri.camera.images import Data, FrameError
from mhri.camera.raw_image import decode_raw, decode_raw_depth, MM_PER_M

JPEG_QUALITY = 85
_DEPTHS = ('16UC1', '32FC1')


def recompressed(data: Data) -> Tuple[str, bytes]:
    """Return (what its topic's name ends in, the message) for a serialised ``sensor_msgs/Image``.

    The message is a ``sensor_msgs/CompressedImage`` of the same header: a jpeg, or of depth a png
    of whole millimetres as ``compressedDepth`` has it, 0 invalid, 65 m at most.

    :raises FrameError: it cannot be decoded
    """
    image = read_raw(data)
    if image.encoding in _DEPTHS:
        mm = np.nan_to_num(decode_raw_depth(image)[0] * np.float32(MM_PER_M))
        mm = np.where(mm < 65536.0, mm + 0.5, 0.0).astype(np.uint16)
        suffix, (form, coded) = '/compressedDepth', encode_depth(mm, depth_max_m=66.0)
    else:
        bgr = cv2.cvtColor(decode_raw(image)[0], cv2.COLOR_RGB2BGR)
        try:
            jpeg = cv2.imencode('.jpg', bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1]
        except cv2.error:
            raise FrameError('{} x {} pixels are too many for a jpeg'.format(*bgr.shape[1::-1]))
        suffix, form, coded = '/compressed', 'jpeg', jpeg.tobytes()
    return suffix, b''.join((_header(data), _sized(form.encode()), _sized(coded)))


def _header(data: Data) -> bytes:
    """Return the header as it came."""
    wire = Wire(RAW_TYPE, data)
    parts = wire.numbers('<III')
    return struct.pack('<III', *parts) + _sized(bytes(wire.array()))


def _sized(part: bytes) -> bytes:
    return struct.pack('<I', len(part)) + part
