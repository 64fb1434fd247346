# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The committed path: what the commands already sent to a robot will do.

With a round trip of T, a picture shows the robot where it was T / 2 ago, and a command sent now
acts T / 2 from now. In between it executes the commands of the last T, which nobody can take back.
Their path starts at the robot in the picture and ends where the next command finds it (a predictive
display: Sheridan, "Space teleoperation through time delay", IEEE T-RA 9(5), 1993).
"""
import collections
import math
from typing import Deque, Optional, Tuple

from mhri.base.geometry import Pose
from mhri.base.limits import Velocity

# A shorter round trip needs no path; it stays until this much less, so that it does not flicker.
FROM_S, STAY_S = 0.3, 0.05
# A longer round trip is not driven by picture: velocities are kept for this long.
MAX_S = 3.0
# Time between two poses of the path.
STEP_S = 0.05
# A path with less motion [m, rad] is none.
_MIN_M, _MIN_RAD = 0.02, 0.02

_START = Pose(0.0, 0.0, 0.0)
Path = Tuple[Pose, ...]


class SentCommands:
    """The velocities last sent to one robot; times are those of one clock [s], ascending."""

    def __init__(self) -> None:
        self._sent: Deque[Tuple[float, Velocity]] = collections.deque()
        self._long = False

    def add(self, velocity: Velocity, now: float) -> None:
        """Handle the velocity sent from now on [m/s, rad/s]; one that is not finite is a stop."""
        if not velocity.is_finite():
            velocity = Velocity()
        if not self._sent or self._sent[-1][1] != velocity:
            self._sent.append((now, velocity))
        # The oldest one acts until the next.
        while len(self._sent) > 1 and self._sent[1][0] < now - MAX_S:
            self._sent.popleft()

    def clear(self) -> None:
        """Forget all: another program has driven the robot, or its link was gone."""
        self._sent.clear()

    def path(self, round_trip_s: Optional[float], now: float) -> Path:
        """Return the poses of the robot from the newest picture to the end of all commands sent.

        In the frame of the robot in that picture, which is the first pose; they are
        :data:`STEP_S` apart. Acceleration is left out. Empty if the round trip is unknown, shorter
        than :data:`FROM_S` or longer than :data:`MAX_S`, and if the robot does not move.

        :param round_trip_s: of the link to the robot [s]
        """
        least_s = FROM_S - STAY_S if self._long else FROM_S
        self._long = round_trip_s is not None and least_s <= round_trip_s <= MAX_S
        if round_trip_s is None or not self._long:
            return ()
        path = [_START]
        begin = now - round_trip_s
        ends = [at for at, _ in self._sent][1:] + [now]
        for (at, velocity), end in zip(self._sent, ends):
            path += _driven(path[-1], velocity, min(end, now) - max(at, begin))
        moved = math.hypot(path[-1].x_m, path[-1].y_m) >= _MIN_M or any(
            abs(pose.heading_rad) >= _MIN_RAD for pose in path)
        return tuple(path) if moved else ()


def _driven(pose: Pose, velocity: Velocity, duration_s: float) -> Path:
    """Return the poses after a pose at a constant velocity, the last one after the duration."""
    if duration_s <= 0.0:
        return ()
    count = math.ceil(duration_s / STEP_S)
    step_s = duration_s / count
    turn = velocity.angular_rad_s * step_s
    found = []
    for _ in range(count):
        # Along the chord of the arc.
        middle = pose.heading_rad + 0.5 * turn
        cos, sin = math.cos(middle), math.sin(middle)
        ahead, left = velocity.linear_mps * step_s, velocity.lateral_mps * step_s
        pose = Pose(pose.x_m + ahead * cos - left * sin, pose.y_m + ahead * sin + left * cos,
                    math.remainder(pose.heading_rad + turn, 2.0 * math.pi))
        found.append(pose)
    return tuple(found)
