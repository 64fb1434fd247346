# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The limits in force while robots are selected: a parameter cannot raise them meanwhile."""
from typing import Collection, Dict, Mapping, Sequence, Set

from mhri.base.robot_types import common_limits, Limits


class DrivenLimits:
    """Keeps a selected robot at its limits until it is selected again.

    A lower limit takes effect at once and is kept from then on.
    """

    def __init__(self) -> None:
        self._held: Dict[str, Limits] = {}
        # The robots whose type is only presumed.
        self._presumed: Set[str] = set()

    def of(self, name: str, limits: Limits) -> Limits:
        """Return the limits in force for a robot.

        :param limits: its current limits by type and parameters
        """
        return common_limits([limits, self._held.get(name, limits)])

    def note(self, name: str, limits: Limits) -> None:
        """Store the limits of a robot that the operator drives, or has selected."""
        self._held[name] = self.of(name, limits)

    def open(self, name: str, limits: Limits, presumed: bool) -> None:
        """Handle new limits of a robot: a noted one keeps lower ones from now on.

        :param presumed: whether its type is only presumed
        """
        (self._presumed.add if presumed else self._presumed.discard)(name)
        if name in self._held:
            self.note(name, limits)

    def on_selected(self, name: str, limits: Limits) -> None:
        """Handle a selected robot, with its current limits by type and parameters."""
        if name not in self._presumed:
            self.note(name, limits)

    def select(self, names: Collection[str]) -> None:
        """Handle the operator's selection; the limits of all other robots are dropped."""
        self._held = {name: held for name, held in self._held.items() if name in names}

    def kept(self) -> Dict[str, Sequence[float]]:
        """Return the state for the next process, as JSON values."""
        return {name: [held.linear_mps, held.angular_rad_s, held.holonomic]
                for name, held in self._held.items()}

    def restore(self, kept: Mapping[str, Sequence[float]]) -> None:
        """Restore the result of :meth:`kept` of the previous process.

        :raises AttributeError, TypeError, ValueError: it is malformed
        """
        self._held = {name: Limits(float(linear), float(angular), bool(holonomic))
                      for name, (linear, angular, holonomic) in kept.items()}
        if not all(held.linear_mps > 0.0 and held.angular_rad_s > 0.0
                   for held in self._held.values()):
            raise ValueError('a limit that is not above 0')
