# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures as plain values, from a camera feed to the screen."""
from dataclasses import dataclass
from typing import Optional, Tuple

import numpy as np


RGB = 'rgb'
DEPTH = 'depth'

#: width and height [pixels]
Size = Tuple[int, int]
#: the nearest and the farthest [m]
Range = Tuple[float, float]

# 8K video has 33 million pixels. A larger size counts as a corrupted header, so that no frame can
# make the program allocate gigabytes.
MAX_PIXELS = 40_000_000
# A picture older than this is not live [s].
OLD_AFTER_S = 1.0


class FrameError(ValueError):
    """A picture cannot be decoded; the text names its declared format and the fault."""


@dataclass(frozen=True)
class Frame:
    """One decoded picture, at its displayed size.

    ``kind`` is 'rgb' or 'depth'; ``rgb`` a C-contiguous uint8 array (h, w, 3) in RGB order, ready
    to show (depth: coloured already). ``depth_m``: float32 (h, w), distance along the optical axis
    [m], NaN if invalid; None for 'rgb'. ``full_size`` is (width, height) of the picture as sent
    [pixels]; ``depth_range_m`` the (near, far) of the colours [m] or None (rgb, or no valid pixel
    yet). ``received_s``: time of receipt [s, monotonic]. ``grey_range``: the values of grey in more
    than 8 bits that are shown as black and as white, else None.
    """

    kind: str
    rgb: np.ndarray
    depth_m: Optional[np.ndarray] = None
    full_size: Size = (0, 0)
    depth_range_m: Optional[Range] = None
    received_s: float = 0.0
    grey_range: Optional[Range] = None


@dataclass(frozen=True)
class StreamStatus:
    """The state of a camera's stream.

    ``transport`` is the received format: 'jpeg', 'png', 'raw', 'compressedDepth png' ...; '' before
    the first picture. ``rate_hz`` and ``bits_per_s`` are measured on the network over the last 2 s;
    ``age_s`` is the age of the newest good picture [s], None before the first. ``shown`` counts the
    pictures taken, ``bad`` undecodable ones. ``problem`` is the fault of the last bad picture, or
    the reason why no picture is received; '' without a problem. ``stale``: the newest good picture
    is older than the newest bad one, or than ``old_after_s`` [s], which is longer for a limited
    stream. ``thinned`` is the limit and its reason, '' without a limit. ``detail`` is the problem
    in the terms of ROS, or ''. ``source`` is the received topic, with better ones that are silent.
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
    source: str = ''


def check_size(what: str, width: int, height: int) -> None:
    """Check that a picture has pixels, but at most :data:`MAX_PIXELS`.

    :param what: the declared format, for the error's text
    :raises FrameError: the size is absurd
    """
    if width <= 0 or height <= 0 or width * height > MAX_PIXELS:
        raise FrameError('{}: refused, its header says {} x {} pixels'.format(what, width, height))


def fit(full: Size, view: Optional[Size]) -> Size:
    """Return the size at which to show a picture: within the view, same aspect, never enlarged.

    :param full: (width, height) of the picture [pixels], > 0
    :param view: (width, height) of the room for it [pixels], or None for the full size
    """
    if view is None:
        return full
    scale = min(1.0, view[0] / full[0], view[1] / full[1])
    return max(1, round(full[0] * scale)), max(1, round(full[1] * scale))
