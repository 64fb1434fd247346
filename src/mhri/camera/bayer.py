# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures as a colour sensor takes them: one colour per pixel, in a mosaic of two by two."""
from typing import Optional

import numpy as np

from mhri.base.opencv import cv2


# ROS names a Bayer pattern by its first two pixels, OpenCV by the second row's second and third:
# the two names are opposites (cv_bridge.cpp, "Deal with Bayer").
_CONVERSIONS = {'bayer_rggb': cv2.COLOR_BayerBG2RGB, 'bayer_bggr': cv2.COLOR_BayerRG2RGB,
                'bayer_gbrg': cv2.COLOR_BayerGR2RGB, 'bayer_grbg': cv2.COLOR_BayerGB2RGB}
#: encoding of ``sensor_msgs/Image``: how cv2 makes RGB of it
BAYER = {name + bits: conversion for name, conversion in _CONVERSIONS.items()
         for bits in ('8', '16')}


def bayer_encoding(fmt: str) -> Optional[str]:
    """Return the Bayer pattern of a compressed picture, None for any other picture.

    image_transport's ``compressed`` plugin compresses a mosaic as a grey picture and says so only
    in the format, e.g. 'bayer_rggb8; jpeg compressed ' (compressed_publisher.cpp: a pattern counts
    as no colour); its subscriber passes the mosaic on, and cv_bridge makes colours of it.

    :param fmt: ``format`` of a ``sensor_msgs/CompressedImage``
    """
    encoding = fmt.partition(';')[0].strip()
    return encoding if encoding in BAYER else None


def debayered(mosaic: np.ndarray, encoding: str) -> np.ndarray:
    """Return the RGB picture (h, w, 3) uint8 of a mosaic (h, w) of 8 or 16 bits.

    :param encoding: key of :data:`BAYER`
    """
    if mosaic.dtype == np.uint16:
        mosaic = (mosaic >> 8).astype(np.uint8)
    return cv2.cvtColor(mosaic, BAYER[encoding])
