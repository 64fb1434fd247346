# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The nearest obstacle of a laser scan and its direction: one line for the operator."""
import math
from dataclasses import dataclass
from typing import Optional, Sequence

import numpy as np

from mhri.base.plausible import BOUNDS, RANGE

# An older scan is not described [s].
OLD_S = 1.0
# Eighths of a turn, from ahead to the left.
DIRECTIONS = ('ahead', 'ahead left', 'left', 'behind left', 'behind', 'behind right', 'right',
              'ahead right')


@dataclass(frozen=True)
class Nearest:
    """The distance of the nearest obstacle [m] and its direction, one of :data:`DIRECTIONS`."""

    distance_m: float
    direction: str

    def words(self) -> str:
        """Return a text for the operator."""
        return '{:.2f} m clear, {}'.format(self.distance_m, self.direction)


def nearest(ranges: Sequence[float], angle_min: float,
            angle_increment: float) -> Optional[Nearest]:
    """Return the :class:`Nearest` of a scan, None if no beam measured anything.

    :param ranges: distances [m]; NaN, infinity and impossible values are ignored
    :param angle_min: angle of the first one [rad], 0 ahead, left positive; may be off by full turns
    :param angle_increment: angle between beams [rad], negative for a scanner upside down
    """
    distances = np.asarray(ranges, dtype=float)
    with np.errstate(invalid='ignore'):
        seen = (distances >= BOUNDS[RANGE].least) & (distances <= BOUNDS[RANGE].greatest)
    if not seen.any():
        return None
    place = int(np.argmin(np.where(seen, distances, np.inf)))
    angle = angle_min + place * angle_increment
    if not math.isfinite(angle):
        return None
    eighth = round(angle / (math.pi / 4.0)) % len(DIRECTIONS)
    return Nearest(float(distances[place]), DIRECTIONS[eighth])
