# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the operator drives: speed limits, keeping together, keeping off obstacles."""
from typing import NamedTuple, Optional, Sequence, Tuple

from mhri.base.limits import speed_limit_problem


class Settings(NamedTuple):
    """What ``mhri/DriveSettings`` says, under the same names; limits in m/s and rad/s."""

    linear_mps: float
    angular_rad_s: float
    together: bool = False
    slow_with_link: bool = False
    brake: bool = False

    @property
    def limits(self) -> Tuple[float, float]:
        """The speed limits [m/s, rad/s]."""
        return self.linear_mps, self.angular_rad_s


def settings_problem(wished: Sequence[Settings]) -> Optional[str]:
    """Return why the settings in a wish cannot be used, or None if they can.

    :param wished: :class:`Settings`: none (those in force stay) or one
    """
    if len(wished) > 1:
        return '{} settings: expected one at most'.format(len(wished))
    for one in wished:
        problem = speed_limit_problem(*one.limits)
        if problem is None and min(one.limits) <= 0.0:
            problem = 'speed limit 0: expected more than 0'
        if problem:
            return problem
    return None
