# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Levels of a robot's battery: common thresholds for row, tile, line and event."""
from typing import Optional

# Levels of a battery, best first.
FINE, LOW, FLAT = 'fine', 'low', 'flat'
LOW_AT = 0.30
FLAT_AT = 0.15
# A battery sags while the robot drives: leaving a level takes this much more charge.
HYSTERESIS = 0.03


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
