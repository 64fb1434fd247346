# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""OpenCV's ``cv2``, loaded without losing an interrupt that arrives meanwhile.

Loading takes a third of a second, and seconds on a busy computer. If numpy is already loaded,
OpenCV's own code swallows the KeyboardInterrupt of a SIGINT in that time: the program runs on, and
roslaunch waits 15 s for its end.
"""
import signal
from types import FrameType
from typing import Any, List, Optional


def _loaded() -> Any:
    """Return the module; an interrupt during the import takes effect once it is loaded."""
    came: List[int] = []

    def note(number: int, _: Optional[FrameType]) -> None:
        came.append(number)

    try:
        before = signal.signal(signal.SIGINT, note)
    except ValueError:
        # Only the main thread gets interrupts.
        import cv2
        return cv2
    try:
        import cv2
    finally:
        signal.signal(signal.SIGINT, before)
    if came:
        signal.raise_signal(signal.SIGINT)
    return cv2


cv2 = _loaded()
