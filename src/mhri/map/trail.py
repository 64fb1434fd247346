# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The trail of a robot on the map: positions, times, and the quality of its link there."""
import math
from typing import Iterator, List, NamedTuple, Tuple

import numpy as np

from mhri.base.geometry import Pose
from mhri.base.views import LinkFigures
from mhri.robots.link_quality import SLOW_ROUND_TRIP_S, WARN_LOSS

# Quality of a link.
GOOD, SLOW, LOST = 0, 1, 2
LINK_WORDS = ('good link', 'slow link', 'no link')
# Upper limits of the age classes 0 and 1 [s]; 2 is older.
AGES_S = (10.0, 60.0)

_MOST = 600
_STEP_M, _TURN_M = 0.05, 0.5


def link_grade(figures: LinkFigures, live: bool) -> int:
    """Return the quality of a link: GOOD, SLOW or LOST.

    :param live: whether the robot is live
    """
    if not live:
        return LOST
    slow = (figures.round_trip_s or 0.0) > SLOW_ROUND_TRIP_S or (figures.loss or 0.0) > WARN_LOSS
    return SLOW if slow else GOOD


class _Spot(NamedTuple):
    """One point of a trail; ``follows`` is whether the robot drove there from the last one."""

    x_m: float
    y_m: float
    at_s: float
    link: int
    follows: bool


class Trail:
    """The newest positions of a robot in the frame of the map, at most ``most``.

    Older points are kept at larger spacing.
    """

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._spots: List[_Spot] = []

    def __len__(self) -> int:
        return len(self._spots)

    def add(self, pose: Pose, link: int, now_s: float) -> bool:
        """Add a pose; return whether it becomes a new point.

        A step of more than half a metre was not driven: the robot was placed again.
        """
        if self._spots:
            last = self._spots[-1]
            step_m = math.hypot(pose.x_m - last.x_m, pose.y_m - last.y_m)
            if step_m < _STEP_M and link <= last.link:
                return False
            follows = step_m <= _TURN_M
        else:
            follows = False
        self._spots.append(_Spot(pose.x_m, pose.y_m, now_s, link, follows))
        if len(self._spots) > self._most:
            self._thin()
        return True

    def _thin(self) -> None:
        """Drop every second point of the older half, except where something changes."""
        half = len(self._spots) // 2
        kept: List[_Spot] = []
        for index, spot in enumerate(self._spots[:half]):
            after = self._spots[index + 1]
            if not index % 2 or not spot.follows or not after.follows or after.link != spot.link:
                kept.append(spot)
        self._spots = (kept + self._spots[half:])[-self._most:]

    def tail(self, since_s: float) -> np.ndarray:
        """Return the points (n, 2) [m] after a time, and the one before them."""
        newest: List[Tuple[float, float]] = []
        for spot in reversed(self._spots):
            newest.append((spot.x_m, spot.y_m))
            if spot.at_s < since_s or not spot.follows:
                break
        return np.array(newest[::-1]).reshape(-1, 2)

    def pieces(self, by_link: bool, now_s: float) -> Iterator[Tuple[int, np.ndarray]]:
        """Yield (grade, positions (n, 2) [m]) of pieces of one grade, each joined to the previous.

        :param by_link: whether the grade is GOOD, SLOW or LOST, else the age class of
            :data:`AGES_S`
        """
        piece: List[Tuple[float, float]] = []
        grade = -1
        for spot in self._spots:
            mine = spot.link if by_link else sum(now_s - spot.at_s > age for age in AGES_S)
            if piece and not (spot.follows and mine == grade):
                if spot.follows:
                    piece.append((spot.x_m, spot.y_m))
                if len(piece) > 1:
                    yield grade, np.array(piece)
                piece = []
            piece.append((spot.x_m, spot.y_m))
            grade = mine
        if len(piece) > 1:
            yield grade, np.array(piece)
