# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The limits at which robots were driven: no parameter raises one under the operator's hand."""
from typing import Collection, Dict, Mapping, Sequence

from mhri.base.robot_types import Limits
from mhri.driving.gate import common_limits


class DrivenLimits:
    """Keeps a robot that was driven to its limits until it is selected anew.

    A limit that falls counts at once, and is the one to keep from then on.
    """

    def __init__(self) -> None:
        self._held: Dict[str, Limits] = {}

    def of(self, name: str, limits: Limits) -> Limits:
        """Return what a robot is held to.

        :param limits: what its type and parameters allow now
        """
        return common_limits([limits, self._held.get(name, limits)])

    def note(self, name: str, limits: Limits) -> None:
        """Take in that the operator drives a robot, which these parameters allow so much."""
        self._held[name] = self.of(name, limits)

    def select(self, names: Collection[str]) -> None:
        """Take in what the operator selects; who is left out is free of it."""
        self._held = {name: held for name, held in self._held.items() if name in names}

    def kept(self) -> Dict[str, Sequence[float]]:
        """Return what the next process has to know, as JSON values."""
        return {name: [held.linear_mps, held.angular_rad_s] for name, held in self._held.items()}

    def restore(self, kept: Mapping[str, Sequence[float]]) -> None:
        """Take back what another process has kept, of :meth:`kept`."""
        self._held = {name: Limits(*values) for name, values in kept.items()}
