# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One radio for all hosts of a robot: who has control comes first, who does not report last."""
import math
from typing import Dict, Tuple

from mhri.link.bearing import LEAST_BYTES_PER_S

# While the radio does not bear all that the holder gets, all others get this part of that.
TO_OTHERS = 0.25
# Who was not heard for so long is not there [s].
HERE_S = 2.0


class Budget:
    """What is sent to each host of a robot; times are [s] of a clock that never goes back."""

    def __init__(self) -> None:
        # {host: (what the radio bears of what it gets, when it was heard)}
        self._hosts: Dict[str, Tuple[float, float]] = {}

    def share(self, host: str, holder: str, bears: float, reports: bool, now: float) -> float:
        """Return what a host that is heard now may be sent [bytes/s], infinite for all.

        :param holder: of control, '' for nobody
        :param bears: what the radio bears by the host's own reports [bytes/s], infinite for all
        :param reports: it says what comes; else nobody knows what the radio bears
        """
        if not reports:
            bears = LEAST_BYTES_PER_S
        self._hosts[host] = bears, now
        here = {name: row[0] for name, row in list(self._hosts.items()) if now - row[1] <= HERE_S}
        first = here.get(holder, math.inf)
        if host == holder or math.isinf(first):
            return bears
        return min(bears, max(LEAST_BYTES_PER_S, TO_OTHERS * first) / (len(here) - 1))

    def forget(self, host: str) -> None:
        """Forget a host."""
        self._hosts.pop(host, None)
