# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The operator's drive settings: speed limits, common pace, obstacle brake."""
from typing import NamedTuple, Optional, Sequence, Tuple


class Settings(NamedTuple):
    """The fields of ``mhri/DriveSettings``, with the same names; limits in m/s and rad/s."""

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

    :param wished: no :class:`Settings` (those in force stay) or one
    """
    if len(wished) > 1:
        return '{} settings: expected one at most'.format(len(wished))
    for one in wished:
        # Far above any robot: only wrong units or garbled messages exceed these.
        for value, most, unit in ((one.linear_mps, 5.0, 'm/s'),
                                  (one.angular_rad_s, 10.0, 'rad/s')):
            if not 0.0 < value <= most:
                return 'speed limit {!r}: expected more than 0, at most {:g} {}'.format(
                    value, most, unit)
    return None
