# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Speeds: a command in SI units, the operator's limits on it, and a robot's own limits."""
import math
from typing import NamedTuple, Optional, Tuple

from mhri.base.robot_types import Limits


class Velocity(NamedTuple):
    """A planar velocity command: linear along x [m/s], angular about z [rad/s] (REP-103)."""

    linear_mps: float = 0.0
    angular_rad_s: float = 0.0

    def is_zero(self) -> bool:
        """Tell whether this is exactly zero."""
        return self.linear_mps == 0.0 and self.angular_rad_s == 0.0

    def is_finite(self) -> bool:
        """Tell whether both components are finite numbers."""
        return math.isfinite(self.linear_mps) and math.isfinite(self.angular_rad_s)


ZERO = Velocity()


def clamp_keeping_curvature(velocity: Velocity, limits: Limits) -> Velocity:
    """Scale both components by one factor so that neither exceeds a robot's limit.

    The path (curvature = angular / linear) stays the one the operator steered; only the pace drops.
    A velocity that is not finite becomes zero.

    :param velocity: :class:`Velocity`
    :param limits: :class:`mhri.base.robot_types.Limits`
    """
    if not velocity.is_finite():
        return ZERO
    excess = max(abs(velocity.linear_mps) / limits.linear_mps,
                 abs(velocity.angular_rad_s) / limits.angular_rad_s)
    if excess <= 1.0:
        return velocity
    return Velocity(velocity.linear_mps / excess, velocity.angular_rad_s / excess)


def within_limits(velocity: Velocity, linear_mps: float, angular_rad_s: float) -> Velocity:
    """Scale both components by one factor so that neither exceeds the operator's limit.

    A limit of 0 makes a velocity that needs that component zero.

    :param velocity: :class:`Velocity`, finite
    :param linear_mps: the limit [m/s], >= 0
    :param angular_rad_s: the limit [rad/s], >= 0
    """
    share = 1.0
    for wanted, most in ((abs(velocity.linear_mps), linear_mps),
                         (abs(velocity.angular_rad_s), angular_rad_s)):
        if wanted > most:
            share = min(share, most / wanted)
    return Velocity(velocity.linear_mps * share, velocity.angular_rad_s * share)


def speed_limit_problem(linear_mps: float, angular_rad_s: float,
                        ceiling: Tuple[float, float] = (5.0, 10.0)) -> Optional[str]:
    """Return why a pair cannot be the operator's speed limit, or None if it can.

    :param ceiling: the largest limits accepted [m/s, rad/s]: far above any robot here, so that it
        refuses only wrong units or garbled messages
    """
    for value, most, unit in ((linear_mps, ceiling[0], 'm/s'),
                              (angular_rad_s, ceiling[1], 'rad/s')):
        if not math.isfinite(value) or not 0.0 <= value <= most:
            return 'speed limit {!r}: expected 0 to {:g} {}'.format(value, most, unit)
    return None
