# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drift of the odometry relative to motion capture."""
from dataclasses import dataclass
import math
from typing import Optional, Tuple

from mhri.base.geometry import composed, inverse, Pose


@dataclass(frozen=True)
class Drift:
    """Odometry minus motion capture: distance [m], heading in (-pi, pi] [rad]."""

    distance_m: float
    heading_rad: float


class DriftMeter:
    """Tracks a robot in both frames at once.

    ``odom`` starts where the robot was switched on, while motion capture uses the room's frame
    (REP-105), so their numbers cannot be compared directly. The first pair aligns the frames; from
    then on the difference is the error of the odometry.
    """

    def __init__(self) -> None:
        self._first: Optional[Tuple[Pose, Pose]] = None

    def drift(self, odometry: Optional[Pose], captured: Optional[Pose]) -> Optional[Drift]:
        """Return the current :class:`Drift`; zero at the first pair.

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
        expected = composed(base, composed(inverse(begun), odometry))
        heading = math.remainder(expected.heading_rad - captured.heading_rad, 2.0 * math.pi)
        return Drift(math.hypot(expected.x_m - captured.x_m, expected.y_m - captured.y_m),
                     heading if heading > -math.pi else math.pi)
