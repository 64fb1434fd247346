# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The value of a robot's other sensors: a row ``readout`` of its type. No ROS, no clock."""
import math
from typing import Optional, Tuple

from mhri.base.accessories import Accessory

# For how long a value beyond its limits is shown [s]: a bumper is pressed for less than a redraw.
PEAK_S = 0.5


def is_number(value: object) -> bool:
    """Return whether a field holds a number; true and false count as 1 and 0."""
    return isinstance(value, (bool, int, float))


class Readout:
    """The newest value of one sensor; one beyond its limits for at least :data:`PEAK_S`.

    :param spec: its row
    """

    def __init__(self, spec: Accessory) -> None:
        self._spec = spec
        self._newest: Optional[float] = None
        self._peak: Tuple[float, float] = (math.nan, -math.inf)

    def on_value(self, value: float, now: float) -> None:
        """Handle a value; NaN for an impossible one."""
        if self._spec.warns(value):
            self._peak = value, now
        self._newest = value

    def value(self, now: float) -> Tuple[float, ...]:
        """Return its value, () before the first."""
        if self._newest is None:
            return ()
        peak, at_s = self._peak
        return (peak if now - at_s < PEAK_S and not self._spec.warns(self._newest)
                else self._newest,)
