# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures as plain values, from a camera feed to the screen."""
from dataclasses import dataclass
from typing import Optional, Tuple, Union

import numpy as np


RGB = 'rgb'
DEPTH = 'depth'

#: a message or a part of it, as it came over the wire
Data = Union[bytes, bytearray, memoryview]
#: width and height [pixels]
Size = Tuple[int, int]
#: the nearest and the farthest [m]
Range = Tuple[float, float]

# 8K video has 33 million pixels. A larger claim counts as a corrupted header, so that no frame can
# make the program allocate gigabytes.
MAX_PIXELS = 40_000_000
# A picture older than this is not live [s].
OLD_AFTER_S = 1.0


class FrameError(ValueError):
    """A picture that cannot be decoded; the text says what it claims to be and what is wrong."""


@dataclass(frozen=True)
class Frame:
    """One decoded picture, at the size it is shown at.

    ``kind`` is 'rgb' or 'depth'; ``rgb`` a C-contiguous uint8 array (h, w, 3) in RGB order, ready
    to show (depth: coloured already). ``depth_m``: float32 (h, w), distance along the optical axis
    [m], NaN if invalid; None for 'rgb'. ``full_size`` is (width, height) of the picture as sent
    [pixels]; ``depth_range_m`` the (near, far) of the colours [m] or None (rgb, or no valid pixel
    yet). ``received_s``: time of receipt [s, monotonic].
    """

    kind: str
    rgb: np.ndarray
    depth_m: Optional[np.ndarray] = None
    full_size: Size = (0, 0)
    depth_range_m: Optional[Range] = None
    received_s: float = 0.0


@dataclass(frozen=True)
class StreamStatus:
    """The state of a camera's stream.

    ``transport`` says what arrives: 'jpeg', 'png', 'raw', 'compressedDepth png' ...; '' before the
    first picture. ``rate_hz`` and ``bits_per_s`` are what the network brought in the last 2 s;
    ``age_s`` the age of the newest good picture [s], None before it. ``shown`` counts the pictures
    taken, ``bad`` those that could not be decoded. ``problem`` says what was wrong with the last
    bad one, or why no picture comes; '' if there is nothing to say. ``stale``: the newest good
    picture is older than the newest bad one, or than ``old_after_s`` [s], which is longer for a
    picture that is held back. ``thinned`` says that it is held back, and why; '' if it is not.
    ``detail`` is the problem in the words of ROS, '' where it has none.
    """

    transport: str = ''
    rate_hz: float = 0.0
    age_s: Optional[float] = None
    bits_per_s: float = 0.0
    shown: int = 0
    bad: int = 0
    problem: str = ''
    stale: bool = False
    thinned: str = ''
    old_after_s: float = OLD_AFTER_S
    detail: str = ''


def check_size(what: str, width: int, height: int) -> None:
    """Refuse a picture without pixels, or with more than :data:`MAX_PIXELS`.

    :param what: what the picture calls itself, for the error's text
    :raises FrameError: the size is absurd
    """
    if width <= 0 or height <= 0 or width * height > MAX_PIXELS:
        raise FrameError('{}: refused, its header says {} x {} pixels'.format(what, width, height))


def fit(full: Size, view: Optional[Size]) -> Size:
    """Return the size at which to show a picture: within the view, same shape, never enlarged.

    :param full: (width, height) of the picture [pixels], > 0
    :param view: (width, height) of the room for it [pixels], or None for the full size
    """
    if view is None:
        return full
    scale = min(1.0, view[0] / full[0], view[1] / full[1])
    return max(1, round(full[0] * scale)), max(1, round(full[1] * scale))
