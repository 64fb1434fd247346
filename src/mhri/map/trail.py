# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The trail of a robot on the map: where it was, when, and how good its link was there."""
import math
from typing import Iterator, List, NamedTuple, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.base.views import LinkFigures
from mhri.robots.link_quality import SLOW_ROUND_TRIP_S, WARN_LOSS

# How good a link is.
GOOD, SLOW, LOST = 0, 1, 2
LINK_WORDS = ('good link', 'slow link', 'no link')
# How long ago it was, 0 to 2: up to each of these [s], and longer.
AGES_S = (10.0, 60.0)

_MOST = 600
_STEP_M, _TURN_M = 0.05, 0.5


def link_grade(figures: LinkFigures, live: bool) -> int:
    """Return how good a link is: GOOD, SLOW or LOST.

    :param live: whether the robot is heard
    """
    if not live:
        return LOST
    slow = (figures.round_trip_s or 0.0) > SLOW_ROUND_TRIP_S or (figures.loss or 0.0) > WARN_LOSS
    return SLOW if slow else GOOD


class _Spot(NamedTuple):
    """One place of a trail; ``follows`` is false where it did not drive there from the last."""

    x_m: float
    y_m: float
    at_s: float
    link: int
    follows: bool


class Trail:
    """The newest places of a robot in the frame of the map, never more than ``most``.

    The older a place is, the fewer of its neighbours are kept.
    """

    def __init__(self, most: int = _MOST) -> None:
        self._most = most
        self._spots: List[_Spot] = []

    def __len__(self) -> int:
        return len(self._spots)

    def add(self, pose: Pose, link: int, now_s: float) -> bool:
        """Take in where it is; return whether that is worth a place of its own.

        A step of more than half a metre is none that it drove: it was placed anew.
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
        """Drop every second place of the older half, but none at which something changes."""
        half = len(self._spots) // 2
        kept: List[_Spot] = []
        for index, spot in enumerate(self._spots[:half]):
            after = self._spots[index + 1]
            if not index % 2 or not spot.follows or not after.follows or after.link != spot.link:
                kept.append(spot)
        self._spots = (kept + self._spots[half:])[-self._most:]

    def tail(self, since_s: float) -> np.ndarray:
        """Return the places (n, 2) [m] that came later, and the one before them."""
        newest: List[Tuple[float, float]] = []
        for spot in reversed(self._spots):
            newest.append((spot.x_m, spot.y_m))
            if spot.at_s < since_s or not spot.follows:
                break
        return np.array(newest[::-1]).reshape(-1, 2)

    def pieces(self, by_link: bool, now_s: float) -> Iterator[Tuple[int, np.ndarray]]:
        """Yield (grade, places (n, 2) [m]) of pieces of one grade; each begins where one ended.

        :param by_link: the grade is GOOD, SLOW or LOST; else how old it is, see
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
