# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Motion capture beside odometry: how far the two have come apart."""
from dataclasses import dataclass
import math
from typing import Optional, Tuple


@dataclass(frozen=True)
class Pose:
    """A place in the plane [m] and a heading [rad]."""

    x_m: float
    y_m: float
    heading_rad: float

    def is_finite(self) -> bool:
        """Tell whether every number is finite."""
        return all(map(math.isfinite, (self.x_m, self.y_m, self.heading_rad)))


@dataclass(frozen=True)
class Drift:
    """Odometry minus motion capture: distance [m], heading in (-pi, pi] [rad]."""

    distance_m: float
    heading_rad: float


class DriftMeter:
    """Follows a robot in both frames at once.

    ``odom`` begins where the robot was switched on, while motion capture uses the room's frame
    (REP-105), so their numbers cannot be compared directly. The first pair aligns the frames; from
    then on the difference is the error of the odometry.
    """

    def __init__(self) -> None:
        self._first: Optional[Tuple[Pose, Pose]] = None

    def drift(self, odometry: Optional[Pose], captured: Optional[Pose]) -> Optional[Drift]:
        """Return the present :class:`Drift`; zero at the first pair.

        :param odometry: :class:`Pose` in ``odom``, None if unknown
        :param captured: :class:`Pose` in the frame of motion capture, None if unknown
        :returns: None while one is missing or not finite
        """
        if odometry is None or captured is None \
                or not (odometry.is_finite() and captured.is_finite()):
            return None
        if self._first is None:
            self._first = (odometry, captured)
        begun, base = self._first
        turn = base.heading_rad - begun.heading_rad
        moved_x, moved_y = odometry.x_m - begun.x_m, odometry.y_m - begun.y_m
        expected_x = base.x_m + moved_x * math.cos(turn) - moved_y * math.sin(turn)
        expected_y = base.y_m + moved_x * math.sin(turn) + moved_y * math.cos(turn)
        heading = math.remainder(odometry.heading_rad + turn - captured.heading_rad, 2.0 * math.pi)
        return Drift(math.hypot(expected_x - captured.x_m, expected_y - captured.y_m),
                     heading if heading > -math.pi else math.pi)
