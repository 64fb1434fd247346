# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The moving parts of a simulated robot: a head that turns its camera, and a gripper."""
import math
from typing import Sequence, Tuple

from mhri.sim.lens import FOCAL_PX

# How fast the head turns [rad/s], and how fast the gripper opens and closes [mm/s].
HEAD_RAD_S, GRIPPER_MM_S = 1.5, 50.0
# The tilt of the head, up or down [rad]; the gripper wide open [mm].
MAX_TILT_RAD, OPEN_MM = 0.3, 80.0
# What a sensor of gas measures far from a leak, how much more at it [ppm], and how far it is
# noticed [m].
CLEAN_PPM, LEAK_PPM, LEAK_M = 4.0, 400.0, 1.5
# Light without the lamp, as a share of that with it.
DIM = 0.8


def rows_of_tilt(tilt_rad: float) -> int:
    """Return by how many rows of the picture a tilt [rad, up] shifts the horizon down."""
    return round(FOCAL_PX * math.tan(tilt_rad))


class Actuator:
    """Parts that go to a target at one speed each.

    :param speed: the speed of all parts [units/s]
    :param limits: the lowest and the highest place of each
    """

    def __init__(self, speed: float, limits: Sequence[Tuple[float, float]]) -> None:
        self._speed, self._limits = speed, limits
        self.place: Tuple[float, ...] = tuple(max(low, min(high, 0.0)) for low, high in limits)
        self._target = self.place

    def go(self, target: Sequence[float]) -> None:
        """Set the target, within the limits; values that are not finite are refused.

        :raises ValueError: one is not finite, or there are too few or too many
        """
        if len(target) != len(self._limits) or not all(map(math.isfinite, target)):
            raise ValueError('expected {} finite numbers'.format(len(self._limits)))
        self._target = tuple(max(low, min(high, one))
                             for one, (low, high) in zip(target, self._limits))

    def halt(self) -> None:
        """Stay in place."""
        self._target = self.place

    @property
    def there(self) -> bool:
        """Whether it is at its target."""
        return self.place == self._target

    def step(self, dt: float) -> bool:
        """Advance by ``dt`` seconds; return whether it moved."""
        if self.place == self._target:
            return False
        way = self._speed * dt
        self.place = tuple(target if abs(target - now) <= way else now + math.copysign(
            way, target - now) for now, target in zip(self.place, self._target))
        return True


def gas_ppm(leak: Sequence[float], x: float, y: float) -> float:
    """Return what a sensor of gas measures at a place [m].

    :param leak: the place of a leak [m]; () without one
    """
    if not leak:
        return CLEAN_PPM
    away = math.hypot(leak[0] - x, leak[1] - y) / LEAK_M
    return CLEAN_PPM + LEAK_PPM * math.exp(-away * away)
