# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The newest transform to each frame of tf, and the pose of one frame in another.

Why not ``tf2_ros.Buffer``: it relies on the senders' clocks. With two of them 40 s apart it finds
no path from ``map`` to a robot, and ignores a robot whose clock was set back. It keeps every frame
ever sent (135 MB for 100,000), prints a line for each impossible transform, takes four times the
CPU for a dozen robots (2.1 % of a core instead of 0.5 %), and needs 33 packages under Debian.
"""
import math
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import is_rotation, Pose
from mhri.base.plausible import can_be, PLACE

# Maximum number of frames kept: a faulty node may send an unlimited number of names.
MAX_FRAMES, MAX_STEPS = 5000, 100

# Parent, x, y, z [m], quaternion x, y, z, w, and time of arrival [s], None if it never expires.
_Edge = Tuple[str, Sequence[float], Optional[float]]


def frame_name(name: str) -> str:
    """Return the name of a frame without the leading slash of early tf versions."""
    return name.strip('/')


class OdometryFrames(NamedTuple):
    """The frames in a robot's odometry messages, '' if empty.

    ``base`` is the robot's own frame (``child_frame_id``), ``odometry`` the frame of its pose. Some
    drivers, such as stage_ros, leave ``base`` empty: tf has it as the child of the other.
    """

    base: str = ''
    odometry: str = ''

    @classmethod
    def of(cls, message: Any) -> 'OdometryFrames':
        """Return the frames of an odometry message of any type."""
        header = getattr(message, 'header', None)
        return cls(frame_name(getattr(message, 'child_frame_id', '')),
                   frame_name(getattr(header, 'frame_id', '')))


class TfTree:
    """Frames by their names; times are those of one clock [s]."""

    def __init__(self) -> None:
        self._edges: Dict[str, _Edge] = {}

    def add(self, parent: str, child: str, numbers: Sequence[float],
            at_s: Optional[float]) -> None:
        """Handle a transform; beyond :data:`MAX_FRAMES` frames new ones are left out.

        :param numbers: x, y, z [m], quaternion x, y, z, w; checked by :meth:`find`
        :param at_s: time of arrival, None if it never expires
        """
        if child in self._edges or len(self._edges) < MAX_FRAMES:
            self._edges[child] = (parent, numbers, at_s)

    def knows(self, frame: str) -> bool:
        """Return whether a transform to a frame was received."""
        return frame in self._edges or any(edge[0] == frame for edge in self._edges.values())

    def child_above(self, parent: str, frame: str) -> str:
        """Return the child of ``parent`` on the path up from ``frame``, '' if it is not on it."""
        for name, edge in self._to_root(frame) or ():
            if edge is not None and edge[0] == parent:
                return name
        return ''

    def find(self, frame: str, other: str) -> Optional[Tuple[Pose, Optional[float]]]:
        """Return (pose of a frame in another, time of its oldest part), None if unknown.

        :param frame: the frame of the result
        :param other: the frame to look up
        """
        found = self.matrix(frame, other)
        if found is None:
            return None
        matrix, at_s = found
        return Pose(float(matrix[0, 3]), float(matrix[1, 3]),
                    math.atan2(matrix[1, 0], matrix[0, 0])), at_s

    def matrix(self, frame: str, other: str) -> Optional[Tuple[np.ndarray, Optional[float]]]:
        """Return the same with a matrix that transforms points of ``other`` into ``frame``."""
        up, down = self._to_root(frame), self._to_root(other)
        if up is None or down is None or up[-1][0] != down[-1][0]:
            return None
        # Frames above the first common one are irrelevant.
        common = {name for name, _ in up}
        shared = next(name for name, _ in down if name in common)
        times: List[float] = []
        matrix = _inverse(self._product(up, shared, times)) @ self._product(
            down, shared, times)
        if not np.isfinite(matrix).all():
            return None
        return matrix, min(times) if times else None

    def _to_root(self, frame: str) -> Optional[List[Tuple[str, Optional[_Edge]]]]:
        """Return the frames from one up to its root with their transforms, None for a loop."""
        found: List[Tuple[str, Optional[_Edge]]] = []
        while len(found) < MAX_STEPS:
            edge = self._edges.get(frame)
            found.append((frame, edge))
            if edge is None:
                return found
            frame = edge[0]
        return None

    @staticmethod
    def _product(chain: List[Tuple[str, Optional[_Edge]]], end: str,
                 times: List[float]) -> np.ndarray:
        matrix = np.eye(4)
        for name, edge in chain:
            if name == end or edge is None:
                break
            matrix = _matrix(edge[1]) @ matrix
            if edge[2] is not None:
                times.append(edge[2])
        return matrix


def _matrix(numbers: Sequence[float]) -> np.ndarray:
    """Return the matrix of a transform, NaN if it is impossible."""
    x, y, z, w = numbers[3:]
    if not (is_rotation(x, y, z, w) and all(can_be(PLACE, number) for number in numbers[:3])):
        return np.full((4, 4), np.nan)
    length = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = (part / length for part in (x, y, z, w))
    return np.array((
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), numbers[0]),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), numbers[1]),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), numbers[2]),
        (0.0, 0.0, 0.0, 1.0)))


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of a rigid transform (4, 4).

    Not by ``np.linalg.inv``: the threads of OpenBLAS busy-wait after each call, and took a core.
    """
    inverse = np.eye(4)
    inverse[:3, :3] = matrix[:3, :3].T
    inverse[:3, 3] = -matrix[:3, :3].T @ matrix[:3, 3]
    return inverse
