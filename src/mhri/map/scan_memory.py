# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The newest scan of each laser of a robot, for the map."""
from typing import Dict, Optional, Tuple

import numpy as np

# Time that a scan is drawn [s].
OLD_SCAN_S = 1.0


class ScanMemory:
    """The newest scan of each laser of a robot; times are those of one clock [s]."""

    def __init__(self) -> None:
        self._newest: Dict[int, Tuple[float, np.ndarray]] = {}

    def add(self, laser: int, points: np.ndarray, now_s: float) -> None:
        """Store the points of a laser, an array (n, 2) in the frame of the map [m]."""
        self._newest[laser] = now_s, points

    def points(self, now_s: float) -> Optional[np.ndarray]:
        """Return the recent points of all lasers (n, 2) [m], or None."""
        fresh = [points for at_s, points in self._newest.values() if now_s - at_s <= OLD_SCAN_S]
        return np.vstack(fresh) if fresh else None
