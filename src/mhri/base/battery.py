# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's battery: its charge, and the common levels of row, tile, line and event."""
from typing import Optional

from mhri.base.plausible import BATTERY, can_be

# Levels of a battery, best first.
FINE, LOW, FLAT = 'fine', 'low', 'flat'
LOW_AT = 0.30
FLAT_AT = 0.15
# A battery sags while the robot drives: leaving a level takes this much more charge.
HYSTERESIS = 0.03
# A charge above this is in percent. Drivers that divide by a nominal voltage report a little over 1
# (turtlebot3_core does).
_MAX_FRACTION = 1.5


class Charge:
    """Reads the charge that a robot reports: a fraction (``sensor_msgs/BatteryState``) or percent.

    Many drivers report percent. Near 1 the two look alike, so the unit is that of the robot's type,
    or percent for good once a value too large for a fraction was seen.

    :param unit: one of :data:`mhri.base.robot_types.BATTERY_UNITS`
    """

    def __init__(self, unit: str = '') -> None:
        self._unit = unit

    def read(self, value: float) -> Optional[float]:
        """Return a reported charge as a fraction in [0, 1], None if it is not possible."""
        if not can_be(BATTERY, value):
            return None
        if not self._unit and value > _MAX_FRACTION:
            self._unit = 'percent'
        if self._unit == 'percent':
            return min(1.0, value / 100.0)
        return min(1.0, value) if value <= _MAX_FRACTION else None


def battery_level(fraction: Optional[float], before: str = FINE) -> str:
    """Return the level of a battery: FINE, LOW (30 % or less) or FLAT (15 % or less).

    :param fraction: its charge in [0, 1]; None and NaN leave the level unchanged
    :param before: the previous level
    """
    if fraction is None or fraction != fraction:
        return before
    for level, limit, worse in ((FLAT, FLAT_AT, (FLAT,)), (LOW, LOW_AT, (LOW, FLAT))):
        if fraction <= limit + (HYSTERESIS if before in worse else 0.0):
            return level
    return FINE
