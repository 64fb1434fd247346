# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a raw picture to the message of a camera with a compressed topic."""
import struct

import numpy as np

from mhri.base.opencv import cv2
from mhri.base.wire import Wire
from mhri.camera.depth_codec import encode_depth, MM_PER_M
from mhri.camera.image_message import read_raw
from mhri.camera.images import DEPTH, FrameError
from mhri.camera.jpeg import encode_jpeg
from mhri.camera.ros.pictures import decode_raw, decode_raw_depth

JPEG_QUALITY = 85


def recompressed(data, kind, shades, now):
    """Return (suffix of the topic, message) for a serialised ``sensor_msgs/Image``.

    The message is a ``sensor_msgs/CompressedImage`` with the same header: a jpeg, or for depth a
    png in whole millimetres in the format of ``compressedDepth``, 0 invalid, 65 m at most.

    :param kind: 'rgb' or 'depth'
    :param shades: :class:`mhri.camera.shades.Shades` of the stream
    :param now: time of receipt [s]
    :raises FrameError: the message cannot be decoded
    """
    image = read_raw(data)
    if kind == DEPTH:
        mm = np.nan_to_num(decode_raw_depth(image)[0] * np.float32(MM_PER_M))
        mm = np.where(mm < 65536.0, mm + 0.5, 0.0).astype(np.uint16)
        suffix, (form, coded) = '/compressedDepth', encode_depth(mm, depth_max_m=66.0)
    else:
        pixels, size = decode_raw(image)
        try:
            suffix, form, coded = '/compressed', 'jpeg', encode_jpeg(
                shades.rgb(pixels, now)[0], JPEG_QUALITY)
        except cv2.error:
            raise FrameError('{} x {} pixels are too many for a jpeg'.format(*size))
    return suffix, b''.join((_header(data), _sized(form.encode()), _sized(coded)))


def _header(data):
    """Return the serialised header."""
    wire = Wire('header', data)
    wire.header()
    wire.array()
    return bytes(data[:wire.at])


def _sized(part):
    return struct.pack('<I', len(part)) + part
