# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shares one radio among the hosts of a robot: the host in control first, silent ones last."""
import math
from typing import Dict, Tuple

from mhri.link.rate_estimator import MIN_BYTES_PER_S

# While the host in control is limited, all others together get this fraction of its rate.
TO_OTHERS = 0.25
# A host that has been silent for this long no longer counts [s].
HERE_S = 2.0


class Budget:
    """The rate to each host of a robot; times are [s] of a monotonic clock."""

    def __init__(self) -> None:
        # {host: (rate that the radio carries to it, time of its last beat)}
        self._hosts: Dict[str, Tuple[float, float]] = {}

    def share(self, host: str, holder: str, carries: float, reports: bool, now: float) -> float:
        """Return the rate to a host after its beat [bytes/s]; infinite: no limit.

        :param holder: the host in control, '' without one
        :param carries: rate that the radio carries according to the host [bytes/s], or infinite
        :param reports: whether the host reports its reception; otherwise its rate is unknown
        """
        if not reports:
            carries = MIN_BYTES_PER_S
        self._hosts[host] = carries, now
        here = {name: row[0] for name, row in list(self._hosts.items()) if now - row[1] <= HERE_S}
        first = here.get(holder, math.inf)
        if host == holder or math.isinf(first):
            return carries
        return min(carries, max(MIN_BYTES_PER_S, TO_OTHERS * first) / (len(here) - 1))

    def forget(self, host: str) -> None:
        """Forget a host."""
        self._hosts.pop(host, None)
