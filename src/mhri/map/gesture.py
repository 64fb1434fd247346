# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the operator draws on the map, from press to release: a goal, a route, a fence, ..."""
from dataclasses import dataclass
import math
from typing import List, Optional, Tuple

from mhri.base.mocap import Pose

# The tools; LOOK draws nothing: the map is dragged.
LOOK, GOTO, ROUTE, FENCE, PLACE, MARK, LEADER = (
    'look', 'goto', 'route', 'fence', 'place', 'mark', 'leader')
TOOLS = (GOTO, ROUTE, FENCE, PLACE, MARK, LEADER)
# Places with a heading, made by a drag; corners, made by clicks; a robot, chosen by a click.
POSES, CORNERS = (GOTO, PLACE, MARK), (ROUTE, FENCE)
_LEAST_CORNERS = {ROUTE: 1, FENCE: 3}
MOST_CORNERS = 200

# What to do next, in words; {} is who it is for.
HINTS = {
    LOOK: '',
    GOTO: 'Press where {} should go, drag to where it should look, let go to start. Esc cancels.',
    ROUTE: 'Click the corners of the route of {}; Enter or a double click starts it, Esc cancels.',
    FENCE: 'Click the corners of the fence; Enter or a double click sets it, Esc cancels.',
    PLACE: 'Press where {} stands, drag to where it looks. Esc cancels.',
    MARK: 'Click where the mark is; drag for a heading. Esc cancels.',
    LEADER: 'Click the robot that {} should follow. Esc cancels.',
}


@dataclass(frozen=True)
class Act:
    """What was drawn: a tool, and its pose or its corners [m].

    ``aimed`` is false where the heading was not drawn.
    """

    tool: str
    pose: Optional[Pose] = None
    aimed: bool = False
    corners: Tuple[Tuple[float, float], ...] = ()


class Gesture:
    """One tool in the hand; after each :class:`Act` it is put away.

    Places are [m], in the frame of the map.
    """

    def __init__(self) -> None:
        self.tool = LOOK
        self._anchor: Optional[Tuple[float, float]] = None
        self._heading_rad: Optional[float] = None
        self._corners: List[Tuple[float, float]] = []

    def take(self, tool: str) -> None:
        """Take a tool into the hand, or LOOK: none; what was begun is dropped."""
        self.tool = tool
        self._anchor = self._heading_rad = None
        self._corners = []

    @property
    def corners(self) -> Tuple[Tuple[float, float], ...]:
        """The corners drawn so far."""
        return tuple(self._corners)

    @property
    def pose(self) -> Optional[Pose]:
        """The pose that is being drawn; its heading is NaN before the drag is long enough."""
        if self._anchor is None:
            return None
        return Pose(*self._anchor, math.nan if self._heading_rad is None else self._heading_rad)

    def press(self, x_m: float, y_m: float) -> None:
        """Begin a pose; a corner is made at the release."""
        if self.tool in POSES:
            self._anchor, self._heading_rad = (x_m, y_m), None

    def drag(self, x_m: float, y_m: float, least_m: float) -> None:
        """Turn the pose to a place at least so far from it [m]; nearer, it keeps its heading."""
        if self._anchor is None:
            return
        ahead, left = x_m - self._anchor[0], y_m - self._anchor[1]
        if math.hypot(ahead, left) >= least_m:
            self._heading_rad = math.atan2(left, ahead)

    def release(self, x_m: float, y_m: float, least_m: float) -> Optional[Act]:
        """End a pose, or add a corner; return what is complete with it."""
        if self.tool in POSES and self._anchor is not None:
            self.drag(x_m, y_m, least_m)
            act = Act(self.tool, Pose(*self._anchor, self._heading_rad or 0.0),
                      self._heading_rad is not None)
            self.take(LOOK)
            return act
        if self.tool in CORNERS and len(self._corners) < MOST_CORNERS:
            # The second click of a double click is at the same corner.
            if not self._corners or math.hypot(
                    self._corners[-1][0] - x_m, self._corners[-1][1] - y_m) >= least_m:
                self._corners.append((x_m, y_m))
        if self.tool == LEADER:
            self.take(LOOK)
            return Act(LEADER, Pose(x_m, y_m, 0.0))
        return None

    def undo(self) -> None:
        """Take the last corner back."""
        if self._corners:
            self._corners.pop()

    def problem(self) -> str:
        """Return why what is drawn cannot be ended yet, '' if it can."""
        least = _LEAST_CORNERS.get(self.tool, 0)
        if len(self._corners) >= least:
            return ''
        return 'a {} has {} corner{} or more'.format(self.tool, least, 's' if least > 1 else '')

    def finish(self) -> Optional[Act]:
        """End a route or a fence; None if it has too few corners, see :meth:`problem`."""
        if self.tool not in CORNERS or self.problem():
            return None
        act = Act(self.tool, corners=tuple(self._corners))
        self.take(LOOK)
        return act
