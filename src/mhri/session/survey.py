# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Figures from the messages of a session: paths, distances, silences, links, proofs of stops."""
from bisect import bisect_right
from dataclasses import dataclass
import math
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import beside, Pose
from mhri.base.opencv import cv2
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.base.views import PROOF_STOPPED, ProofView
from mhri.robots.link import Motion
from mhri.robots.stop_proof import StopProof
from mhri.session.timeline import Span

# Odometry of a resting robot jitters by less than this [m].
_STEP_M = 0.02
# A step between two readings larger than both limits is a jump, not motion [m, m/s].
_LEAP_M, _FASTEST_MPS = 0.5, 5.0
# A reading this shortly before a stop [s] shows whether the robot stood already.
_JUST_BEFORE_S = 1.0
# The drive publishes its state twice a second; a state counts for this long at most [s].
_STATE_S = 2.0


@dataclass(frozen=True)
class Stopped:
    """A stop according to a robot's own odometry.

    ``proof`` is the proof at the release, by the rule of the screen; None without messages from the
    robot. ``moved_m`` is the distance driven during the stop, ``stood`` whether the robot stood
    before the stop and throughout it.
    """

    proof: Optional[ProofView] = None
    moved_m: float = 0.0
    stood: bool = False

    @property
    def proved(self) -> bool:
        """Whether the robot provably stood still at the end."""
        return self.proof is not None and self.proof.state == PROOF_STOPPED

    def words(self) -> str:
        """Return a description."""
        if self.proof is None:
            return 'NOT CONFIRMED: no messages from it'
        if not self.proved:
            return self.proof.text
        return 'stood already' if self.stood else '{}, {:.2f} m further'.format(
            self.proof.text, self.moved_m)


class _StopWatch:
    """Follows one robot through one stop."""

    def __init__(self, proof: StopProof, before: Optional[Motion]) -> None:
        self.proof = proof
        self._last = before
        self._stood = before is not None and before.is_standstill()
        self._moved_m = 0.0

    def update(self, at_s: float, motion: Motion, follows: bool) -> None:
        self.proof.follows = follows
        self.proof.on_motion(motion, at_s)
        if self._last is not None:
            step_m = math.hypot(motion.x_m - self._last.x_m, motion.y_m - self._last.y_m)
            self._moved_m += step_m if step_m < _LEAP_M else 0.0
        self._last = motion
        self._stood = self._stood and motion.is_standstill()

    def read(self, end_s: float) -> Stopped:
        return Stopped(self.proof.view(end_s), self._moved_m, self._stood)


class RobotSurvey:
    """Collects the recorded data of one robot, in chronological order.

    Times are seconds from the start of the session. Impossible readings are ignored.

    :param stops: spans of STOP ALL, in chronological order
    :param silent_after_s: time after which the robot counts as silent, for the proof of a stop [s]
    ``distance_m`` is by odometry; ``pieces`` are its paths, in the map's frame if ``placed``, else
    in that of its odometry; ``silences`` are the spans without messages, each longer than
    :data:`SILENT_AFTER_S`; ``on_tasks`` those in which a task drove it, None if the drive never
    published a state of it.
    """

    def __init__(self, stops: Sequence[Span] = (),
                 silent_after_s: float = SILENT_AFTER_S) -> None:
        self._stops = stops
        self._silent_after_s = silent_after_s
        self._begins = [span.begin_s for span in stops]
        self._watches: Dict[int, _StopWatch] = {}
        self._last: Optional[Tuple[float, Motion]] = None
        self._anchor: Optional[Motion] = None
        self._origin: Optional[Pose] = None
        self._follows = True
        self.placed = False
        self.first_s: Optional[float] = None
        self.distance_m = self.fastest_mps = 0.0
        self.readings = self.impossible = 0
        self.silences: List[Span] = []
        self.on_tasks: Optional[List[Span]] = None
        self._task_until_s: Optional[float] = None
        self.pieces: List[List[Tuple[float, float]]] = []
        self.round_trips_s: List[float] = []

    def on_place(self, origin: Optional[Pose]) -> None:
        """Handle the pose of its odometry's origin on the map, None if not placed."""
        known = origin is not None and origin.is_finite()
        if known != (self._origin is not None):
            self._break()
        self._origin = origin if known else None
        if known and not self.placed:
            # The path so far, in the odometry frame, cannot be placed on the map.
            self.placed, self.pieces = True, []

    def on_drive(self, at_s: float, on_task: bool) -> None:
        """Handle whether a task drives the robot, by the drive; a state holds until the next."""
        if self.on_tasks is None:
            self.on_tasks = []
        if self._task_until_s is not None:
            begun_s = self.on_tasks[-1].begin_s
            self.on_tasks[-1] = Span(begun_s, min(at_s, self._task_until_s))
        if on_task and (self._task_until_s is None or at_s > self._task_until_s):
            self.on_tasks.append(Span(at_s, at_s))
        self._task_until_s = at_s + _STATE_S if on_task else None

    def on_witness(self, follows: bool) -> None:
        """Handle whether, by the mux, the odometry follows commands."""
        self._follows = follows

    def on_round_trip(self, round_trip_s: float) -> None:
        """Handle a round trip [s], NaN if unknown."""
        if 0.0 <= round_trip_s < 3600.0:
            self.round_trips_s.append(round_trip_s)

    def on_motion(self, at_s: float, motion: Motion) -> None:
        """Handle an odometry reading."""
        if not motion.is_possible():
            self.impossible += 1
            return
        self.readings += 1
        self.fastest_mps = max(self.fastest_mps, motion.speed_mps)
        self._watch_stop(at_s, motion)
        if self._last is None:
            self.first_s = at_s
        elif at_s - self._last[0] > SILENT_AFTER_S:
            self.silences.append(Span(self._last[0], at_s))
        self._go(at_s, motion)
        self._last = (at_s, motion)

    def _watch_stop(self, at_s: float, motion: Motion) -> None:
        place = bisect_right(self._begins, at_s) - 1
        if place >= 0 and at_s < self._stops[place].end_s:
            if place not in self._watches:
                begin_s, before = self._begins[place], self._last
                round_trip_s = self.round_trips_s[-1] if self.round_trips_s else None
                self._watches[place] = _StopWatch(
                    StopProof(begin_s, round_trip_s, self._silent_after_s),
                    before[1] if before and begin_s - before[0] < _JUST_BEFORE_S else None)
            self._watches[place].update(at_s, motion, self._follows)

    def _go(self, at_s: float, motion: Motion) -> None:
        """Extend the path and the distance by a reading."""
        if self._anchor is None or self._last is None:
            self._add(motion)
            return
        step_m = math.hypot(motion.x_m - self._anchor.x_m, motion.y_m - self._anchor.y_m)
        if step_m < _STEP_M:
            return
        if step_m > max(_LEAP_M, _FASTEST_MPS * (at_s - self._last[0])):
            self._break()
        else:
            self.distance_m += step_m
        self._add(motion)

    def _break(self) -> None:
        if self.pieces and self.pieces[-1]:
            self.pieces.append([])

    def _add(self, motion: Motion) -> None:
        self._anchor = motion
        x_m, y_m = motion.x_m, motion.y_m
        if self._origin is not None:
            x_m, y_m = beside(self._origin, x_m, y_m)
        elif self.placed:
            return
        if not self.pieces:
            self.pieces.append([])
        piece = self.pieces[-1]
        if piece and math.hypot(x_m - piece[-1][0], y_m - piece[-1][1]) > _LEAP_M \
                + _STEP_M:
            piece = []
            self.pieces.append(piece)
        piece.append((x_m, y_m))

    def end(self, length_s: float) -> None:
        """Handle the end of the session."""
        if self._task_until_s is not None:
            self.on_drive(length_s, False)
        if self._last is not None and length_s - self._last[0] > SILENT_AFTER_S:
            self.silences.append(Span(self._last[0], length_s))

    def stopped(self, place: int) -> Stopped:
        """Return the behaviour of the robot in a stop, by index."""
        watch = self._watches.get(place)
        return watch.read(self._stops[place].end_s) if watch else Stopped()

    def way(self, within_m: float) -> List[np.ndarray]:
        """Return its simplified path in pieces (n, 2) [m].

        Pieces of a single point are left out, unless there are no others.

        :param within_m: maximum deviation from the path [m]
        """
        pieces = [piece for piece in self.pieces if len(piece) > 1] or \
            [piece for piece in self.pieces if piece][:1]
        return [simplified(np.array(piece), within_m) for piece in pieces]


def simplified(points: np.ndarray, within_m: float) -> np.ndarray:
    """Return a line (n, 2) [m] simplified by the Douglas-Peucker algorithm."""
    if len(points) < 3:
        return points
    # OpenCV needs single precision; relative to the first point it is enough.
    near = (points - points[0]).astype(np.float32).reshape(-1, 1, 2)
    return np.asarray(cv2.approxPolyDP(near, within_m, False).reshape(-1, 2) + points[0])


def link_words(round_trips_s: Sequence[float]) -> Tuple[str, str]:
    """Return the median and the 95th percentile of the round trips, "-" if unknown."""
    if not round_trips_s:
        return '-', '-'
    ordered = sorted(round_trips_s)

    def at(share: float) -> str:
        return '{:.0f} ms'.format(1e3 * ordered[min(len(ordered) - 1, int(share * len(ordered)))])
    return at(0.5), at(0.95)
