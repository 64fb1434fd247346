# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the lasers of one robot have met, for the map: the newest scan of each."""
from typing import Dict, Optional, Tuple

import numpy as np

# A scan is drawn for so long [s].
OLD_SCAN_S = 1.0


class Met:
    """The newest scan of each laser of a robot; times are those of one clock [s]."""

    def __init__(self) -> None:
        self._newest: Dict[int, Tuple[float, np.ndarray]] = {}

    def see(self, laser: int, points: np.ndarray, now_s: float) -> None:
        """Take in what a laser has met: an array (n, 2) in the frame of the map [m]."""
        self._newest[laser] = now_s, points

    def points(self, now_s: float) -> Optional[np.ndarray]:
        """Return what all of them have met (n, 2) [m], None where nothing is from now."""
        fresh = [points for at_s, points in self._newest.values() if now_s - at_s <= OLD_SCAN_S]
        return np.vstack(fresh) if fresh else None
