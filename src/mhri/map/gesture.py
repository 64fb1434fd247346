# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drawing on the map, from press to release: a goal, a route, a fence, ..."""
from dataclasses import dataclass
import math
from typing import List, Optional, Tuple

from mhri.base.geometry import Pose

# The tools; LOOK draws nothing: the map is dragged. CARRY has no button: a robot is dragged.
LOOK, GOTO, ROUTE, FENCE, PLACE, MARK, LEADER, CARRY = (
    'look', 'goto', 'route', 'fence', 'place', 'mark', 'leader', 'carry')
TOOLS = (GOTO, ROUTE, FENCE, PLACE, MARK, LEADER)
# Places with a heading, made by a drag; corners, made by clicks; a robot, chosen by a click.
POSES, CORNERS = (GOTO, PLACE, MARK), (ROUTE, FENCE)
_MIN_CORNERS = {ROUTE: 1, FENCE: 3}
MAX_CORNERS = 200

# Instructions; {} is the robot. Before the colon: the action and the robot, also at the pointer.
HINTS = {
    LOOK: '',
    GOTO: 'Send {}: click where it should go; drag to set the heading. Esc ends.',
    ROUTE: 'Route of {}: click its corners; Enter or a double click starts it. Esc ends.',
    FENCE: 'Fence: click its corners; Enter or a double click sets it. Esc ends.',
    PLACE: 'Place {}: press where it is, drag to set its heading. Esc ends.',
    MARK: 'Mark: click where to set it; drag for a heading. Esc ends.',
    LEADER: '{} follows: click the robot that it should follow. Esc ends.',
    CARRY: 'Send {}: release where it should go; back on its mark, or Esc, ends.',
}


@dataclass(frozen=True)
class Act:
    """A finished drawing: a tool, and its pose or its corners [m].

    ``aimed`` is whether the heading was drawn.
    """

    tool: str
    pose: Optional[Pose] = None
    aimed: bool = False
    corners: Tuple[Tuple[float, float], ...] = ()


class Gesture:
    """The tool in use; it is put away after each :class:`Act`.

    Positions are [m], in the frame of the map.
    """

    def __init__(self) -> None:
        self.tool = LOOK
        #: where a dragged robot was, None without one
        self.start: Optional[Tuple[float, float]] = None
        self._anchor: Optional[Tuple[float, float]] = None
        self._heading_rad: Optional[float] = None
        self._corners: List[Tuple[float, float]] = []

    def choose_tool(self, tool: str) -> None:
        """Select a tool, LOOK to deselect; an unfinished drawing is discarded."""
        self.tool = tool
        self.start = self._anchor = self._heading_rad = None
        self._corners = []

    @property
    def corners(self) -> Tuple[Tuple[float, float], ...]:
        """The corners drawn so far."""
        return tuple(self._corners)

    @property
    def pose(self) -> Optional[Pose]:
        """The pose being drawn; its heading is NaN until the drag is long enough."""
        if self._anchor is None:
            return None
        return Pose(*self._anchor, math.nan if self._heading_rad is None else self._heading_rad)

    def press(self, x_m: float, y_m: float) -> None:
        """Start a pose; corners are set on release."""
        if self.tool in POSES:
            self._anchor, self._heading_rad = (x_m, y_m), None

    def carry(self, x_m: float, y_m: float) -> None:
        """Start to drag a robot from its position: its goal is where the drag ends."""
        self.choose_tool(CARRY)
        self.start = (x_m, y_m)

    def drag(self, x_m: float, y_m: float, least_m: float) -> None:
        """Turn the pose towards a position, or drag a robot there, unless it is too near [m]."""
        if self.start is not None:
            far = math.hypot(x_m - self.start[0], y_m - self.start[1]) >= least_m
            self._anchor = (x_m, y_m) if far else None
            return
        if self._anchor is None:
            return
        ahead, left = x_m - self._anchor[0], y_m - self._anchor[1]
        if math.hypot(ahead, left) >= least_m:
            self._heading_rad = math.atan2(left, ahead)

    def release(self, x_m: float, y_m: float, least_m: float) -> Optional[Act]:
        """Finish a pose, or add a corner; return the act if it is complete.

        A robot that is dragged back to its position stays: there is no act, and no tool.
        """
        if self.start is not None or self.tool in POSES and self._anchor is not None:
            self.drag(x_m, y_m, least_m)
            if self._anchor is None:
                self.choose_tool(LOOK)
                return None
            act = Act(self.tool, Pose(*self._anchor, self._heading_rad or 0.0),
                      self._heading_rad is not None)
            self.choose_tool(LOOK)
            return act
        if self.tool in CORNERS and len(self._corners) < MAX_CORNERS:
            # The second click of a double click is at the same corner.
            if not self._corners or math.hypot(
                    self._corners[-1][0] - x_m, self._corners[-1][1] - y_m) >= least_m:
                self._corners.append((x_m, y_m))
        if self.tool == LEADER:
            self.choose_tool(LOOK)
            return Act(LEADER, Pose(x_m, y_m, 0.0))
        return None

    def undo(self) -> None:
        """Remove the last corner."""
        if self._corners:
            self._corners.pop()

    def problem(self) -> str:
        """Return why the drawing cannot be finished yet, '' if it can."""
        least = _MIN_CORNERS.get(self.tool, 0)
        if len(self._corners) >= least:
            return ''
        return 'a {} has {} corner{} or more'.format(self.tool, least, 's' if least > 1 else '')

    def finish(self) -> Optional[Act]:
        """Finish a route or a fence; None if it has too few corners, see :meth:`problem`."""
        if self.tool not in CORNERS or self.problem():
            return None
        act = Act(self.tool, corners=tuple(self._corners))
        self.choose_tool(LOOK)
        return act
