# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the marks of a session are on the map."""
import math
from typing import Any, Iterable, Optional, Tuple

from mhri.base.views import FlagView
from mhri.recording.folder import SessionMark

# Maximum number of flags on a map; the newest are shown.
MAX_FLAGS = 100


def place_of(pose: Any) -> Optional[Tuple[float, float, str]]:
    """Return (x [m], y [m], frame) of a mark's pose, None if malformed."""
    if not isinstance(pose, list) or len(pose) < 2:
        return None
    x_m, y_m = pose[0], pose[1]
    if not all(type(value) in (int, float) and math.isfinite(value) and abs(value) < 1e7
               for value in (x_m, y_m)):
        return None
    return float(x_m), float(y_m), str(pose[3]) if len(pose) > 3 else ''


def flag_of(mark: SessionMark, frame: str = '') -> Optional[FlagView]:
    """Return the flag of a mark, None if its place is unknown.

    It is where the robot was at which it was made; of a mark that names none, where the first
    robot was.

    :param frame: a place in another frame does not count; '' for any frame
    """
    names = [mark.robot] if mark.robot else list(mark.poses)
    for name in names:
        place = place_of(mark.poses.get(name))
        if place is not None and frame in ('', place[2]):
            return FlagView(mark.label, *place)
    return None


def flags_of(marks: Iterable[SessionMark], frame: str = '') -> Tuple[FlagView, ...]:
    """Return the flags of marks in a frame, the newest :data:`MAX_FLAGS` at most."""
    flags = (flag_of(mark, frame) for mark in marks)
    return tuple(flag for flag in flags if flag is not None)[-MAX_FLAGS:]
