# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake: how fast a robot may go, with what its laser measures in the way.

The robot is a disc, driven along the arc of its command. Its speed is kept to what it can lose
within the way that is free, after the time that scan and command take: zero before contact.
"""
from dataclasses import dataclass, replace
import math
from typing import Callable, Dict, Iterable, Optional, Tuple

import numpy as np

from mhri.base.limits import Velocity
from mhri.base.mocap import Pose
from mhri.sensors.readings import LaserLife

# A scan that is older is trusted by nobody [s].
SCAN_OLD_S = 0.3
# What is left between the robot and what is in its way [m].
MARGIN_M = 0.08
# So much more for who has only a depth camera: what is near and beside is out of its picture [m].
NARROW_M = 0.05
# What a TurtleBot loses with its smoother on is 0.8 to 1 m/s^2; and the time from a scan to the
# moment at which the command that it led to acts.
BRAKES_MPS2, REACTION_S = 0.5, 0.2
# Backing away without an eye for it [m/s].
CRAWL_MPS = 0.1
# What was met is remembered this far around the robot while no scan looks there [m].
KEEP_M = 1.2
_GRID_M = 0.03
_EDGE_M = 0.05
# No gap between the last beam and the first hides anything if it is twice as wide at most [rad].
_GAP_RAD = 0.05
# Ground that is seen free is remembered in cells of this size, so far beyond what is too near [m],
# and while nothing looks for so long [s].
_CELL_M, _AHEAD_M, _KNOWN_S = 0.05, 0.2, 10.0
_COLUMNS = 1 << 30
# What was met no further off a robot than this was that robot [m].
_BESIDE_M = 0.15
_NOTHING = np.zeros((0, 2))
# So close to each other are the places that have to be looked at [m].
_STEP_M = 0.03
# What is tried where a robot would come to a way at which nothing looks [share of its speed].
_SLOWER = (1.0, 0.75, 0.5, 0.25, 0.1)
_HERE = Pose(0.0, 0.0, 0.0)
# For each point (n, 2) in the robot's frame [m]: is anything looking that way?
Looks = Callable[[np.ndarray], np.ndarray]


def everywhere(points: np.ndarray) -> np.ndarray:
    """Return that each point is looked at."""
    return np.ones(len(points), dtype=bool)


@dataclass(frozen=True)
class Scan:
    """A laser scan: ranges [m] with NaN where nothing was met, angles [rad], 0 is ahead.

    ``mount`` is where its middle lies on the robot. ``blind_m`` tells for each beam up to which
    distance it says nothing [m], inf for one that was not measured; None: all were. ``near_m`` is
    up to which distance such a laser may say nothing, 0 where that is within the robot.
    ``sure_share`` is the share of beams that a dead laser would not send.
    """

    ranges: np.ndarray
    angle_min: float
    step: float
    range_min_m: float
    range_max_m: float

    mount: Pose = _HERE
    blind_m: Optional[np.ndarray] = None
    near_m: float = 0.0
    sure_share: float = 1.0

    @property
    def _whole(self) -> bool:
        return abs(self.step) * len(self.ranges) + 2.0 * _GAP_RAD >= 2.0 * math.pi

    @property
    def all_round(self) -> bool:
        """Whether its beams leave no gap that anything could hide in."""
        return self.blind_m is None and self._whole

    @property
    def looks_anywhere(self) -> bool:
        """Whether any beam was measured, or found nothing."""
        return bool(len(self.ranges)) and (
            self.blind_m is None or bool(np.isfinite(self.blind_m).any()))

    def points(self) -> np.ndarray:
        """Return what was met as an array (n, 2) in the robot's frame [m]."""
        met = np.isfinite(self.ranges)
        angles = self.angle_min + self.step * np.flatnonzero(met)
        beams = self.ranges[met][:, None] * np.column_stack((np.cos(angles), np.sin(angles)))
        return _out_of(self.mount, beams)

    def faces(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether a beam goes that way that would have met it."""
        points = _into(self.mount, points)
        far = np.hypot(points[:, 0], points[:, 1])
        faced: np.ndarray = (self._blind(points, _GAP_RAD) <= far) & (far <= self.range_max_m)
        return faced

    def faces_past(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether a beam goes that way, though it may be too near for it."""
        return np.isfinite(self._blind(_into(self.mount, points), _GAP_RAD))

    def clears(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether nothing is there by this scan."""
        points = _into(self.mount, points)
        far = np.hypot(points[:, 0], points[:, 1])
        met = np.where(np.isfinite(self.ranges), self.ranges, np.inf)
        clear: np.ndarray = ((self._blind(points) <= far) & (far <= self.range_max_m)
                             & (far < met[self._number(self._beam(points)[1])]))
        return clear

    def looks_at(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether this scan would have met it."""
        points = _into(self.mount, points)
        far = np.hypot(points[:, 0], points[:, 1])
        seen: np.ndarray = ((self._blind(points) <= far) & (far > self.range_min_m + _EDGE_M)
                            & (far < self.range_max_m))
        return seen

    def _beam(self, points: np.ndarray, slack_rad: float = 0.0) -> Tuple[np.ndarray, np.ndarray]:
        """Return for each point (is it in the field of view, the number its beam would have)."""
        turn = np.mod(np.arctan2(points[:, 1], points[:, 0]) - self.angle_min + slack_rad,
                      2.0 * math.pi)
        step, count = abs(self.step), len(self.ranges)
        beam = np.rint((turn - slack_rad) / step).astype(int)
        return turn <= step * count + 2.0 * slack_rad, beam

    def _number(self, beam: np.ndarray) -> np.ndarray:
        count = len(self.ranges)
        found: np.ndarray = np.mod(beam, count) if self._whole else np.clip(beam, 0, count - 1)
        return found

    def _blind(self, points: np.ndarray, slack_rad: float = 0.0) -> np.ndarray:
        """Return up to which distance nothing is known that way [m], inf: nothing at all."""
        if not len(self.ranges) or not self.step:
            return np.full(len(points), np.inf)
        inside, beam = self._beam(points, slack_rad)
        if self.blind_m is None:
            return np.where(inside, 0.0, np.inf)
        wide = int(slack_rad / abs(self.step))
        beams = self._number(beam[:, None] + np.arange(-wide, wide + 1))
        return np.where(inside, self.blind_m[beams].min(axis=1), np.inf)


@dataclass(frozen=True)
class _Seen:
    """The newest scan of one laser: when and where it was made, what it met in odometry's frame."""

    at_s: float
    scan: Scan
    odometry: Pose
    points: np.ndarray


class Unplaced:
    """The lasers that are heard while nobody says where they sit: where they look is unknown.

    A robot that has one does not crawl where no other laser looks: it may see what is there.
    """

    def __init__(self) -> None:
        self._heard: Dict[str, float] = {}

    def hear(self, laser: str, at_s: float) -> None:
        """Take in that a laser without a place was heard."""
        self._heard[laser] = at_s

    def place(self, laser: str) -> None:
        """Take in that it has a place."""
        self._heard.pop(laser, None)

    def any(self, now: float) -> bool:
        """Tell whether there are any, as far as they were heard of late."""
        return any(now - at_s <= SCAN_OLD_S for at_s in list(self._heard.values()))


class _Ground:
    """The ground around a robot that was seen to be free, or that it stood on itself."""

    def __init__(self, radius_m: float) -> None:
        self._radius_m = radius_m
        self._cells = np.zeros(0, dtype=np.int64)
        self._at_s = -math.inf

    def learn(self, scan: Scan, odometry: Pose, at_s: float) -> None:
        """Take in a scan of which some beams see nothing that is near."""
        reach_m = scan.near_m + _AHEAD_M
        count = int(reach_m / _CELL_M) + 1
        around = np.arange(-count, count + 1)
        columns = math.floor(odometry.x_m / _CELL_M) + around
        rows = math.floor(odometry.y_m / _CELL_M) + around
        cells = np.stack(np.meshgrid(columns, rows, indexing='ij'), axis=-1).reshape(-1, 2)
        here = _into(odometry, (cells + 0.5) * _CELL_M)
        free = scan.clears(here) | (np.hypot(here[:, 0], here[:, 1]) < self._radius_m)
        kept = self._cells if at_s - self._at_s <= _KNOWN_S else self._cells[:0]
        kept = kept[np.isin(kept, _codes(cells))]
        self._cells = np.union1d(kept, _codes(cells[free]))
        self._at_s = at_s

    def has(self, points: np.ndarray) -> np.ndarray:
        """Return for each point, in the frame of odometry, whether it is known to be free."""
        found: np.ndarray = np.isin(_codes(np.floor(points / _CELL_M).astype(np.int64)),
                                    self._cells)
        return found


def _codes(cells: np.ndarray) -> np.ndarray:
    codes: np.ndarray = cells[:, 0].astype(np.int64) * _COLUMNS + cells[:, 1]
    return codes


class Surroundings:
    """What a robot's lasers have met: the newest scan of each, and what they no longer look at.

    Many lasers do not see what is nearer than 0.45 m, or only what is ahead: what came that close
    is remembered, in the frame of odometry, until a scan has looked there again. Where their beams
    say nothing of what is near, ground counts as free that was seen to be.

    :param radius_m: of the disc around all of the robot
    """

    def __init__(self, radius_m: float = 0.0) -> None:
        self._radius_m = radius_m
        self._lives: Dict[str, LaserLife] = {}
        self.clear()

    def clear(self) -> None:
        """Forget everything but which lasers live: odometry has begun anew."""
        self._met = _NOTHING
        self._fresh = 0
        self._newest: Dict[str, _Seen] = {}
        self._ground = _Ground(self._radius_m)
        # Seen from here, nothing is nearer than this [m].
        self._clear: Tuple[Pose, float] = (_HERE, math.inf)
        self._all_round_m = 0.0

    def see(self, scan: Scan, odometry: Pose, at_s: float = 0.0, laser: str = '') -> bool:
        """Take in a scan that was made here; return whether it looked anywhere.

        :param at_s: when [s]; where another laser looks counts for :data:`SCAN_OLD_S` from its own
        :param laser: which one it was, on a robot that has several
        """
        life = self._lives.setdefault(laser, LaserLife())
        if not life.look(scan.sure_share, odometry, at_s, abs(scan.step) * len(scan.ranges)):
            scan = replace(scan, blind_m=np.full(len(scan.ranges), np.inf))
        before = self._newest.pop(laser, None)
        old = [name for name, seen in self._newest.items() if at_s - seen.at_s > SCAN_OLD_S]
        gone = [self._newest.pop(name) for name in old] + ([before] if before else [])
        kept = np.vstack([seen.points for seen in gone] + [self._met[self._fresh:]])
        here = _into(odometry, kept)
        kept = kept[~scan.looks_at(here) & (np.hypot(here[:, 0], here[:, 1]) < KEEP_M)]
        if len(kept):
            # One of each cell; none is moved, which time after time would lead it astray.
            kept = kept[np.unique(np.round(kept / _GRID_M), axis=0, return_index=True)[1]]
        if scan.near_m > 0.0:
            self._ground.learn(scan, odometry, at_s)
        self._newest[laser] = _Seen(at_s, scan, odometry, _out_of(odometry, scan.points()))
        fresh = [seen.points for seen in self._newest.values()]
        self._fresh = sum(map(len, fresh))
        self._met = met = np.vstack((*fresh, kept))
        far = np.hypot(met[:, 0] - odometry.x_m, met[:, 1] - odometry.y_m)
        self._clear = odometry, float(far.min()) if len(met) else math.inf
        self._all_round_m = max(seen.scan.range_max_m if seen.scan.all_round else 0.0
                                for seen in self._newest.values())
        return scan.looks_anywhere

    def forget(self, odometry: Pose, robots: Iterable[Tuple[float, float, float]]) -> None:
        """Forget what is remembered where robots are known to be: they move, and leave nothing.

        :param robots: (ahead, to the left, radius) [m] of each, seen from here
        """
        where = np.array(list(robots)).reshape(-1, 3)
        kept = self._met[self._fresh:]
        if not len(where) or not len(kept):
            return
        gaps = kept[:, None, :] - _out_of(odometry, where[:, :2])
        near = (np.hypot(gaps[..., 0], gaps[..., 1]) < where[:, 2] + _BESIDE_M).any(axis=1)
        self._met = np.vstack((self._met[:self._fresh], kept[~near]))

    def around(self, odometry: Pose, reach_m: float = math.inf) -> np.ndarray:
        """Return what is around the robot, were it here: an array (n, 2) in its frame [m].

        :param reach_m: nothing that is further off need be in it
        """
        there, clear_m = self._clear
        way_m = math.hypot(odometry.x_m - there.x_m, odometry.y_m - there.y_m)
        return _NOTHING if clear_m - way_m > reach_m else _into(odometry, self._met)

    def looks(self, odometry: Pose, reach_m: float = KEEP_M) -> Looks:
        """Return what tells where the newest scans look, seen from a robot that is here.

        :param reach_m: nothing that is further off will be asked for
        """
        if self._all_round_m > reach_m:
            return everywhere
        newest, ground = list(self._newest.values()), self._ground

        def look(points: np.ndarray) -> np.ndarray:
            found, there = np.zeros(len(points), dtype=bool), _out_of(odometry, points)
            for seen in newest:
                here = _into(seen.odometry, there)
                found |= seen.scan.faces(here)
                if seen.scan.near_m > 0.0 and not found.all():
                    found |= seen.scan.faces_past(here) & ground.has(there)
            return found
        return look


def _turned(angle_rad: float) -> np.ndarray:
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    return np.array(((cos, -sin), (sin, cos)))


def _out_of(frame: Pose, points: np.ndarray) -> np.ndarray:
    """Return points that are given in a frame in the one that the frame is given in."""
    found: np.ndarray = points @ _turned(frame.heading_rad).T + (frame.x_m, frame.y_m)
    return found


def _into(frame: Pose, points: np.ndarray) -> np.ndarray:
    """Return points in a frame that is given where they are."""
    found: np.ndarray = (points - (frame.x_m, frame.y_m)) @ _turned(frame.heading_rad)
    return found


def within_reach(points: np.ndarray, reach_m: float) -> np.ndarray:
    """Return those of some points (n, 2) that are no further from the middle than this [m]."""
    if not len(points):
        return points
    found: np.ndarray = points[np.einsum('ij,ij->i', points, points) <= reach_m * reach_m]
    return found


def free_way(points: np.ndarray, radius_m: float, velocity: Velocity) -> float:
    """Return how far a disc gets along the arc of a velocity before it touches a point [m].

    :param points: array (n, 2) in the robot's frame [m]
    :returns: inf where nothing is in the way; 0 where it touches already and would go on; half a
        turn at most is looked at
    """
    if not len(points) or velocity.linear_mps == 0.0:
        return math.inf
    x, y = points[:, 0], points[:, 1]
    if velocity.linear_mps < 0.0:
        x = -x
    curvature = velocity.angular_rad_s / abs(velocity.linear_mps)
    if velocity.linear_mps < 0.0:
        curvature = -curvature
    if abs(curvature) < 1e-3:
        near = (np.abs(y) < radius_m) & (x > 0.0)
        ways = x[near] - np.sqrt(radius_m ** 2 - y[near] ** 2)
    else:
        ways = _along_arc(x, y if curvature > 0.0 else -y, 1.0 / abs(curvature), radius_m)
    return max(0.0, float(ways.min())) if len(ways) else math.inf


def _along_arc(x: np.ndarray, y: np.ndarray, turn_m: float, radius_m: float) -> np.ndarray:
    """Return the ways [m] along a left turn of that radius to the points which are touched."""
    far = np.hypot(x, y - turn_m)
    near = np.abs(far - turn_m) < radius_m
    far, angle = far[near], np.mod(np.arctan2(x[near], turn_m - y[near]), 2.0 * math.pi)
    cosine = (turn_m ** 2 + far ** 2 - radius_m ** 2) / np.maximum(2.0 * turn_m * far, 1e-9)
    travelled = angle - np.arccos(np.clip(cosine, -1.0, 1.0))
    ways: np.ndarray = turn_m * travelled[angle < math.pi]
    return ways


def stopping_speed(way_m: float, delay_s: float) -> float:
    """Return the speed [m/s] that is lost within a way, after a delay in which it is kept."""
    if not math.isfinite(way_m):
        return math.inf
    lag = BRAKES_MPS2 * delay_s
    return math.sqrt(lag * lag + 2.0 * BRAKES_MPS2 * max(0.0, way_m)) - lag


def fronts(velocity: Velocity, radius_m: float, delay_s: float) -> np.ndarray:
    """Return where a disc's foremost point comes until the disc can stand, (n, 2) [m]."""
    speed, turn = velocity.linear_mps, velocity.angular_rad_s
    lasts_s = delay_s + abs(speed) / (2.0 * BRAKES_MPS2)
    times = np.linspace(0.0, lasts_s, 5 + min(95, int(abs(speed) * lasts_s / _STEP_M)))
    angles = turn * times
    if abs(turn) < 1e-6:
        middle = np.column_stack((speed * times, np.zeros(len(times))))
    else:
        middle = speed / turn * np.column_stack((np.sin(angles), 1.0 - np.cos(angles)))
    found: np.ndarray = middle + math.copysign(radius_m, speed) * np.column_stack(
        (np.cos(angles), np.sin(angles)))
    return found


def seen_speed(velocity: Velocity, radius_m: float, delay_s: float, looks: Looks,
               crawl_mps: float = CRAWL_MPS) -> float:
    """Return how fast [m/s] a disc may go to stand before it comes where nothing looks.

    Not at all where nothing looks ahead; a crawl where nothing looks back, to get away by.

    :param crawl_mps: how fast that is; 0 where a laser looks nobody knows where
    """
    speed = velocity.linear_mps
    if looks is everywhere:
        return speed
    least = 0.0 if speed > 0.0 else max(speed, -crawl_mps)
    for share in _SLOWER:
        slower = Velocity(share * speed, velocity.angular_rad_s)
        if looks(fronts(slower, radius_m, delay_s)).all():
            return max(slower.linear_mps, least) if speed > 0.0 else min(slower.linear_mps, least)
    return least


def reach_of(speed_mps: float, radius_m: float, age_s: float) -> float:
    """Return how far from its middle something can limit a robot of this speed [m].

    :param age_s: of the newest scan [s]
    """
    speed_mps = abs(speed_mps)
    return radius_m + MARGIN_M + speed_mps * (
        REACTION_S + age_s + speed_mps / (2.0 * BRAKES_MPS2))


def braked(velocity: Velocity, points: np.ndarray, radius_m: float,
           age_s: Optional[float], looks: Looks = everywhere,
           crawl_mps: float = CRAWL_MPS) -> Velocity:
    """Return the velocity that a robot may have; turning on the spot is always allowed.

    :param velocity: what is wanted
    :param points: what its laser has met, in its frame [m]
    :param radius_m: of the disc around all of the robot [m]
    :param age_s: of the newest scan [s], None before the first: no way forward then, and a crawl
        backward, as far as nothing was met there before
    :param looks: where its laser looks, see :func:`seen_speed`
    :param crawl_mps: likewise
    """
    wanted, turn = velocity.linear_mps, velocity.angular_rad_s
    if wanted == 0.0:
        return velocity
    if age_s is None or age_s > SCAN_OLD_S:
        # What was met behind before is still there.
        wanted, age_s = min(0.0, max(wanted, -crawl_mps)), 0.0
    else:
        wanted = seen_speed(velocity, radius_m + MARGIN_M, REACTION_S + age_s, looks, crawl_mps)
    points = within_reach(points, reach_of(wanted, radius_m, age_s))
    # Slower with the same turn is another arc: looked at once more.
    for _ in range(2):
        way_m = free_way(points, radius_m + MARGIN_M, Velocity(wanted, turn))
        most = stopping_speed(way_m, REACTION_S + age_s)
        wanted = max(-most, min(most, wanted))
    return Velocity(0.0 if abs(wanted) < 1e-3 else wanted, turn)
