# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Speeds: a command in SI units, the operator's limits on it, and a robot's own limits."""
import math
from typing import NamedTuple

from mhri.base.robot_types import Limits


class Velocity(NamedTuple):
    """A planar velocity command: along x [m/s], about z [rad/s], along y, left + [m/s] (REP-103).

    The last component is for holonomic robots; it is 0 for all others.
    """

    linear_mps: float = 0.0
    angular_rad_s: float = 0.0
    lateral_mps: float = 0.0

    @property
    def speed_mps(self) -> float:
        """Its speed in any direction [m/s, >= 0]."""
        return math.hypot(self[0], self[2])

    def is_zero(self) -> bool:
        """Return whether this is exactly zero."""
        return not any(self)

    def is_finite(self) -> bool:
        """Return whether all components are finite numbers."""
        return math.isfinite(self[0]) and math.isfinite(self[1]) and math.isfinite(self[2])

    def slower(self, share: float) -> 'Velocity':
        """Return a velocity with a fraction of the speed and the same turn."""
        return Velocity(share * self.linear_mps, self.angular_rad_s, share * self.lateral_mps)


ZERO = Velocity()


def clamp_keeping_curvature(velocity: Velocity, limits: Limits) -> Velocity:
    """Scale all components by one factor so that neither speed nor turn exceeds a robot's limit.

    The path stays the one the operator steered; only the speed drops. A robot that is not holonomic
    gets no sideways component. A velocity that is not finite becomes zero.

    :param velocity: :class:`Velocity`
    :param limits: :class:`mhri.base.robot_types.Limits`
    """
    if not velocity.is_finite():
        return ZERO
    if velocity.lateral_mps and not limits.holonomic:
        velocity = Velocity(velocity.linear_mps, velocity.angular_rad_s)
    excess = max(velocity.speed_mps / limits.linear_mps,
                 abs(velocity.angular_rad_s) / limits.angular_rad_s)
    return velocity if excess <= 1.0 else Velocity(*(part / excess for part in velocity))


def within_limits(velocity: Velocity, linear_mps: float, angular_rad_s: float) -> Velocity:
    """Scale all components by one factor so that neither speed nor turn exceeds a limit.

    A limit of 0 makes a velocity that needs that component zero.

    :param velocity: :class:`Velocity`, finite
    :param linear_mps: the operator's limit, in any direction [m/s], >= 0
    :param angular_rad_s: the limit [rad/s], >= 0
    """
    share = 1.0
    for wanted, most in ((velocity.speed_mps, linear_mps),
                         (abs(velocity.angular_rad_s), angular_rad_s)):
        if wanted > most:
            share = min(share, most / wanted)
    return Velocity(*(part * share for part in velocity))
