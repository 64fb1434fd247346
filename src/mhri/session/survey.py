# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the messages of a session add up to: ways, distances, silences, links, what stops did."""
from bisect import bisect_right
from dataclasses import dataclass
import math
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

from mhri.base.mocap import Pose
from mhri.base.opencv import cv2
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.map.places import composed
from mhri.robots.gate_words import NO_WITNESS
from mhri.robots.link import Motion
from mhri.session.timeline import Span

# A robot that rests jitters by less than this, which is no way [m].
_STEP_M = 0.02
# What is further than both between two readings was not driven [m, m/s].
_LEAP_M, _FASTEST_MPS = 0.5, 5.0
# What a robot did in so long [s] before a stop tells whether it stood already.
_JUST_BEFORE_S = 1.0


@dataclass(frozen=True)
class Stopped:
    """What a robot's own odometry says of a stop.

    ``after_s`` is from the stop to the first reading of the standstill that lasted until the
    release, 0 for a robot that stood already, None if it moved at the end or was not heard
    (``heard`` is false then); ``moved_m`` how far it went meanwhile; ``follows`` is false if its
    odometry did not follow commands before, and proves nothing.
    """

    heard: bool = False
    after_s: Optional[float] = None
    moved_m: float = 0.0
    stood_before: bool = False
    follows: bool = True

    def words(self) -> str:
        """Return it in words."""
        if not self.heard:
            return 'NOT CONFIRMED: nothing was heard from it'
        if not self.follows:
            return 'NOT CONFIRMED: ' + NO_WITNESS
        if self.after_s is None:
            return 'NOT CONFIRMED: it still moved at the end of the stop'
        if self.stood_before:
            return 'stood already'
        return 'stood still after {:.2f} s, {:.2f} m further'.format(self.after_s, self.moved_m)


class _StopWatch:
    """Follows one robot through one stop."""

    def __init__(self, begin_s: float, before: Optional[Tuple[float, Motion]],
                 follows: bool) -> None:
        self._begin_s = begin_s
        self._follows = follows
        self._stood_before = before is not None and before[1].is_standstill() \
            and begin_s - before[0] < _JUST_BEFORE_S
        self._last = before[1] if before is not None else None
        self._moved_m = 0.0
        self._rests: Optional[float] = None
        self._heard = False

    def see(self, at_s: float, motion: Motion) -> None:
        self._heard = True
        if self._last is not None:
            step_m = math.hypot(motion.x_m - self._last.x_m, motion.y_m - self._last.y_m)
            self._moved_m += step_m if step_m < _LEAP_M else 0.0
        self._last = motion
        if not motion.is_standstill():
            self._rests, self._stood_before = None, False
        elif self._rests is None:
            self._rests = at_s

    def read(self) -> Stopped:
        after_s = None if self._rests is None else max(0.0, self._rests - self._begin_s)
        stood = self._stood_before and after_s is not None
        return Stopped(self._heard, 0.0 if stood else after_s, self._moved_m, stood,
                       self._follows)


class RobotSurvey:
    """Collects what is recorded of one robot, in the order of time.

    Times are seconds from the start of the session. Impossible readings are left out.

    :param stops: when everything was stopped, in order of time
    ``distance_m`` is by its odometry, ``pieces`` are its ways in the frame of the map (as far as it
    is placed there, see ``placed``; else in that of its odometry), ``silences`` are when nothing
    was heard of it for longer than a robot may be silent.
    """

    def __init__(self, stops: Sequence[Span] = ()) -> None:
        self._stops = stops
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
        self.pieces: List[List[Tuple[float, float]]] = []
        self.round_trips_s: List[float] = []

    def on_place(self, origin: Optional[Pose]) -> None:
        """Take in where the origin of its odometry lies on the map, None: nowhere."""
        known = origin is not None and origin.is_finite()
        if known != (self._origin is not None):
            self._break()
        self._origin = origin if known else None
        if known and not self.placed:
            # What it drove before in its own frame has no place on the map.
            self.placed, self.pieces = True, []

    def on_witness(self, follows: bool) -> None:
        """Take in whether the gates say that its odometry follows commands."""
        self._follows = follows

    def on_round_trip(self, round_trip_s: float) -> None:
        """Take in a round trip [s]; NaN: it was not known."""
        if 0.0 <= round_trip_s < 3600.0:
            self.round_trips_s.append(round_trip_s)

    def on_motion(self, at_s: float, motion: Motion) -> None:
        """Take in a reading of its odometry."""
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
                self._watches[place] = _StopWatch(
                    self._begins[place], self._last, self._follows)
            self._watches[place].see(at_s, motion)

    def _go(self, at_s: float, motion: Motion) -> None:
        """Add to its way what it drove since the last place of it."""
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
        pose = Pose(motion.x_m, motion.y_m, motion.heading_rad)
        if self._origin is not None:
            pose = composed(self._origin, pose)
        elif self.placed:
            return
        if not self.pieces:
            self.pieces.append([])
        piece = self.pieces[-1]
        if piece and math.hypot(pose.x_m - piece[-1][0], pose.y_m - piece[-1][1]) > _LEAP_M \
                + _STEP_M:
            piece = []
            self.pieces.append(piece)
        piece.append((pose.x_m, pose.y_m))

    def end(self, length_s: float) -> None:
        """Take in that the session ends."""
        if self._last is not None and length_s - self._last[0] > SILENT_AFTER_S:
            self.silences.append(Span(self._last[0], length_s))

    def stopped(self, place: int) -> Stopped:
        """Return what it did in one of the stops, counted from 0."""
        watch = self._watches.get(place)
        return watch.read() if watch else Stopped()

    @property
    def silent_s(self) -> float:
        """How long it was silent, all in all [s]."""
        return sum(span.end_s - span.begin_s for span in self.silences)

    def way(self, within_m: float) -> List[np.ndarray]:
        """Return its way in pieces (n, 2) [m], with no more corners than needed.

        A place that it did not drive to, nor from, is left out, unless there is no other.

        :param within_m: the lines may leave the way by this
        """
        pieces = [piece for piece in self.pieces if len(piece) > 1] or \
            [piece for piece in self.pieces if piece][:1]
        return [simplified(np.array(piece), within_m) for piece in pieces]


def simplified(points: np.ndarray, within_m: float) -> np.ndarray:
    """Return a line (n, 2) [m] with fewer corners, by Douglas and Peucker."""
    if len(points) < 3:
        return points
    # In single precision, so counted from its first place.
    near = (points - points[0]).astype(np.float32).reshape(-1, 1, 2)
    return np.asarray(cv2.approxPolyDP(near, within_m, False).reshape(-1, 2) + points[0])


def link_words(round_trips_s: Sequence[float]) -> Tuple[str, str]:
    """Return the middle round trip, and the one that 95 % are below; "-" where none is known."""
    if not round_trips_s:
        return '-', '-'
    ordered = sorted(round_trips_s)

    def at(share: float) -> str:
        return '{:.0f} ms'.format(1e3 * ordered[min(len(ordered) - 1, int(share * len(ordered)))])
    return at(0.5), at(0.95)
