# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map in the empty place of a film: the path of each robot so far, and where it is."""
from dataclasses import replace
import math
from typing import Dict, Mapping, Optional, Tuple

import numpy as np

from mhri.base.geometry import Pose
from mhri.base.opencv import cv2
from mhri.map.grid import Grid
from mhri.session.report import Report, ways_of
from mhri.session.sheet import (
    bounds_points, draw_path, draw_robot, drawn, ground, Sheet, sheet_of)

# Sizes of lines and words, as a share of those of the report's map of 1000 px.
_UNIT = 1.3
# A step between two frames larger than both limits is a jump, not motion [m, m/s].
_LEAP_M, _FASTEST_MPS = 0.5, 5.0


class FilmMap:
    """Draws the map of a film, frame by frame in order of time.

    :param grid: the map of the session, None without one
    :param size: (width, height) of the picture [px]
    """

    def __init__(self, report: Report, grid: Optional[Grid], size: Tuple[int, int]) -> None:
        ways = ways_of(report.robots, 0.0)
        #: the robots on the map
        self.names = tuple(way.name for way in ways)
        #: whether they are placed in the frame of the map, else by their odometry
        self.placed = bool(report.placed)
        self._ways = {way.name: way for way in ways}
        self._sheet, base = _fitted(sheet_of(grid, bounds_points(ways, ())), grid, size)
        self._picture = drawn(self._sheet, base, (), ())
        self._last: Dict[str, Tuple[float, Pose]] = {}

    def at(self, at_s: float, poses: Mapping[str, Tuple[Pose, bool]]) -> np.ndarray:
        """Return the picture (height, width, 3) BGR at a time from the start [s].

        :param poses: {robot: (its newest pose on the map, whether it is lost)}; one that is not
            known yet is left out
        """
        for name, (pose, lost) in poses.items():
            before = self._last.get(name)
            step_m = math.inf if before is None else math.hypot(
                pose.x_m - before[1].x_m, pose.y_m - before[1].y_m)
            if before is not None and step_m <= max(_LEAP_M, _FASTEST_MPS * (at_s - before[0])):
                draw_path(self._picture, self._sheet, np.array([
                    [before[1].x_m, before[1].y_m], [pose.x_m, pose.y_m]]),
                          self._ways[name].colour, _UNIT)
            self._last[name] = at_s, pose
        picture = self._picture.copy()
        for name, (pose, lost) in poses.items():
            draw_robot(picture, self._sheet, (pose.x_m, pose.y_m), self._ways[name], _UNIT, lost)
        return picture


def _fitted(sheet: Sheet, grid: Optional[Grid], size: Tuple[int, int]) -> Tuple[Sheet, np.ndarray]:
    """Return a sheet and its ground that fit a size [px]."""
    scale = min(1.0, size[0] / sheet.width, size[1] / sheet.height)
    width, height = (max(1, int(side * scale)) for side in (sheet.width, sheet.height))
    small = replace(sheet, px_m=sheet.px_m / scale, width=width, height=height)
    base = ground(sheet, grid) if grid is not None else ground(small, None)
    return small, cv2.resize(base, (width, height), interpolation=cv2.INTER_AREA)
