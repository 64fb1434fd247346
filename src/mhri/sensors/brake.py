# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The obstacle brake: how fast a robot may go, given the obstacles that its laser measures.

The robot is a disc, driven along the arc of its command, in any direction. Its speed is limited so
that it can stop within the free way, after the delay of scan and command: it is zero before
contact.
"""
from dataclasses import dataclass, replace
import math
import operator
from typing import Callable, Dict, Iterable, Optional, Sequence, Tuple

import numpy as np

from mhri.base.geometry import into, out_of, Pose
from mhri.base.limits import Velocity
from mhri.sensors.readings import LaserLife

# An older scan is not trusted [s].
SCAN_OLD_S = 0.3
# Remaining distance between a stopped robot and the obstacle [m].
MARGIN_M = 0.08
# Added for a robot with only a depth camera, which cannot see obstacles near and beside it [m].
NARROW_M = 0.05
# Deceleration: a TurtleBot with its smoother on reaches 0.8 to 1 m/s^2. And the time from a scan to
# the effect of the resulting command.
BRAKES_MPS2, REACTION_S = 0.5, 0.2
# Speed of backing away where no sensor looks [m/s].
CRAWL_MPS = 0.1
# Obstacles are remembered this far around the robot while no scan looks there [m].
KEEP_M = 1.2
_GRID_M = 0.03
_EDGE_M = 0.05
# A gap between the last beam and the first hides nothing if it is at most twice this wide [rad].
_GAP_RAD = 0.05
# Free ground is remembered in cells of this size, up to this far beyond the blind distance [m], and
# for this long without a new scan [s].
_CELL_M, _AHEAD_M, _KNOWN_S = 0.05, 0.2, 10.0
_COLUMNS = 1 << 30
# A remembered obstacle this close to a known robot is that robot [m].
_BESIDE_M = 0.15
_NOTHING = np.zeros((0, 2))
# Spacing of the places that have to be in view [m], and those on the front half of the rim, a tenth
# of a radian apart [rad].
_STEP_M = 0.03
_RIM = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 33)
# Of a laser that looks the way the robot goes, everything this close to that way is asked for, also
# where its field ends; for any other way its field counts without this much at each end, where the
# beams of depth cameras are often invalid [rad].
_CONE_RAD, _ENDS_RAD = 0.35, 0.15
# Tried in turn if the way of a robot leads out of view [share of its speed].
_SLOWER = (1.0, 0.75, 0.5, 0.25, 0.1)
_HERE = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Scan:
    """A laser scan: ranges [m], NaN for beams without an obstacle, angles [rad], 0 is ahead.

    ``mount`` is the pose of its centre on the robot. ``blind_m`` is the blind distance of each
    beam [m], inf for an invalid beam; None if all are valid and none is blind. ``near_m`` is the
    distance up to which such a laser may be blind, 0 if that is within the robot.
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
        """Whether its beams cover all directions without a gap."""
        return self.blind_m is None and self._whole

    @property
    def looks_anywhere(self) -> bool:
        """Whether any beam is valid: measured, or free."""
        return bool(len(self.ranges)) and (
            self.blind_m is None or bool(np.isfinite(self.blind_m).any()))

    def points(self) -> np.ndarray:
        """Return the measured points as an array (n, 2) in the robot's frame [m]."""
        met = np.isfinite(self.ranges)
        angles = self.angle_min + self.step * np.flatnonzero(met)
        beams = self.ranges[met][:, None] * np.column_stack((np.cos(angles), np.sin(angles)))
        return out_of(self.mount, beams)

    def faces(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether a beam in its direction covers its distance."""
        points = into(self.mount, points)
        far = np.hypot(points[:, 0], points[:, 1])
        faced: np.ndarray = (self._blind(points, _GAP_RAD) <= far) & (far <= self.range_max_m)
        return faced

    def faces_past(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether a beam has its direction, even if it is too near."""
        return np.isfinite(self._blind(into(self.mount, points), _GAP_RAD))

    def aims_at(self, points: np.ndarray, course_rad: float) -> np.ndarray:
        """Return for each point whether the laser should measure it, valid beam or not.

        :param course_rad: direction of travel in the robot's frame
        """
        points, course_rad = into(self.mount, points), course_rad - self.mount.heading_rad
        if self._whole or not len(self.ranges) or not self.step:
            return np.full(len(points), self._whole)
        aimed = self._beam(points, -_ENDS_RAD)[0]
        if self._beam(np.array([(math.cos(course_rad), math.sin(course_rad))]))[0][0]:
            aside = np.arctan2(points[:, 1], points[:, 0]) - course_rad + math.pi
            aimed |= np.abs(np.mod(aside, 2.0 * math.pi) - math.pi) <= _CONE_RAD
        return aimed

    def clears(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether it is free according to this scan."""
        points = into(self.mount, points)
        far = np.hypot(points[:, 0], points[:, 1])
        met = np.where(np.isfinite(self.ranges), self.ranges, np.inf)
        clear: np.ndarray = ((self._blind(points) <= far) & (far <= self.range_max_m)
                             & (far < met[self._number(self._beam(points)[1])]))
        return clear

    def looks_at(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether this scan would have measured an obstacle there."""
        points = into(self.mount, points)
        far = np.hypot(points[:, 0], points[:, 1])
        seen: np.ndarray = ((self._blind(points) <= far) & (far > self.range_min_m + _EDGE_M)
                            & (far < self.range_max_m))
        return seen

    def _beam(self, points: np.ndarray, slack_rad: float = 0.0) -> Tuple[np.ndarray, np.ndarray]:
        """Return for each point (whether it is in the field of view, the index of its beam)."""
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
        """Return the blind distance in the direction of each point [m], inf: no valid beam."""
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
    """The newest scan of a laser: time, pose of the robot, points in the frame of odometry."""

    at_s: float
    scan: Scan
    odometry: Pose
    points: np.ndarray


class Unplaced:
    """Lasers that send scans but have no known mount: the direction of their beams is unknown.

    A robot with such a laser does not crawl out of view of the others: the laser may be seeing an
    obstacle there.
    """

    def __init__(self) -> None:
        self._scanned_at: Dict[str, float] = {}

    def on_scan(self, laser: str, at_s: float) -> None:
        """Handle a scan of a laser whose mount is unknown."""
        self._scanned_at[laser] = at_s

    def place(self, laser: str) -> None:
        """Remove a laser: its mount is known now."""
        self._scanned_at.pop(laser, None)

    def any(self, now: float) -> bool:
        """Return whether any of them has sent a scan recently."""
        return any(now - at_s <= SCAN_OLD_S for at_s in list(self._scanned_at.values()))


class _Ground:
    """The ground around a robot that was measured as free, or that the robot stood on."""

    def __init__(self, radius_m: float) -> None:
        self._radius_m = radius_m
        self._cells = np.zeros(0, dtype=np.int64)
        self._at_s = -math.inf

    def learn(self, scan: Scan, odometry: Pose, at_s: float) -> None:
        """Handle a scan of a laser that may be blind at close range."""
        reach_m = scan.near_m + _AHEAD_M
        count = int(reach_m / _CELL_M) + 1
        around = np.arange(-count, count + 1)
        columns = math.floor(odometry.x_m / _CELL_M) + around
        rows = math.floor(odometry.y_m / _CELL_M) + around
        cells = np.stack(np.meshgrid(columns, rows, indexing='ij'), axis=-1).reshape(-1, 2)
        here = into(odometry, (cells + 0.5) * _CELL_M)
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


@dataclass(frozen=True)
class View:
    """The field of view of the newest scans, for a robot at a pose.

    Points are arrays (n, 2) in its frame [m].
    """

    newest: Sequence[_Seen]
    ground: _Ground
    odometry: Pose

    def sees(self, points: np.ndarray) -> np.ndarray:
        """Return for each point whether a scan looked there, or the ground is known to be free."""
        found, there = np.zeros(len(points), dtype=bool), out_of(self.odometry, points)
        for seen in self.newest:
            here = into(seen.odometry, there)
            found |= seen.scan.faces(here)
            if seen.scan.near_m > 0.0 and not found.all():
                found |= seen.scan.faces_past(here) & self.ground.has(there)
        return found

    def covers(self, foremost: np.ndarray, outline: np.ndarray, course_rad: float) -> bool:
        """Return whether the way of a disc is in view, see :func:`fronts`.

        The lasers have to look all along the path of its foremost point; elsewhere, as far as they
        should and the ground is not known to be free: what is too near to be measured was seen
        from further away.

        :param course_rad: direction of travel
        """
        points, ahead = np.vstack((foremost, outline)), len(foremost)
        sees = self.sees(points)
        if not sees[:ahead].all():
            return False
        there = out_of(self.odometry, points[~sees])
        there = there[~self.ground.has(there)]
        return not any(seen.scan.aims_at(
            into(seen.odometry, there),
            course_rad + self.odometry.heading_rad - seen.odometry.heading_rad).any()
            for seen in self.newest)


# None: everything is in view.
Looks = Optional[View]


class Surroundings:
    """The obstacles of a robot's lasers: the newest scan of each, and points now out of view.

    Many lasers are blind below 0.45 m, or see only ahead: obstacles that went out of view are
    remembered, in the frame of odometry, until a scan covers their place again. Where beams are
    blind at close range, ground that was seen to be free counts as free.

    :param radius_m: of the disc around all of the robot
    """

    def __init__(self, radius_m: float = 0.0) -> None:
        self._radius_m = radius_m
        self._lives: Dict[str, LaserLife] = {}
        self.clear()

    def clear(self) -> None:
        """Forget everything except which lasers are alive: odometry has restarted."""
        self._met = _NOTHING
        self._fresh = 0
        self._newest: Dict[str, _Seen] = {}
        self._ground = _Ground(self._radius_m)
        # From this pose nothing is nearer than this [m].
        self._clear: Tuple[Pose, float] = (_HERE, math.inf)
        self._all_round_m = 0.0

    def see(self, scan: Scan, odometry: Pose, at_s: float = 0.0, laser: str = '') -> bool:
        """Handle a scan made at this pose; return whether any of its beams is valid.

        :param at_s: its time [s]; scans of other lasers count for :data:`SCAN_OLD_S` after theirs
        :param laser: key of the laser, on a robot with several
        """
        life = self._lives.setdefault(laser, LaserLife())
        if not life.look(scan.sure_share, odometry, at_s, abs(scan.step) * len(scan.ranges)):
            scan = replace(scan, blind_m=np.full(len(scan.ranges), np.inf))
        before = self._newest.pop(laser, None)
        old = [name for name, seen in self._newest.items() if at_s - seen.at_s > SCAN_OLD_S]
        gone = [self._newest.pop(name) for name in old] + ([before] if before else [])
        kept = np.vstack([seen.points for seen in gone] + [self._met[self._fresh:]])
        here = into(odometry, kept)
        kept = kept[~scan.looks_at(here) & (np.hypot(here[:, 0], here[:, 1]) < KEEP_M)]
        if len(kept):
            # Keep one point per cell, unmoved: rounding it each time would make it drift.
            kept = kept[np.unique(np.round(kept / _GRID_M), axis=0, return_index=True)[1]]
        if scan.near_m > 0.0:
            self._ground.learn(scan, odometry, at_s)
        self._newest[laser] = _Seen(at_s, scan, odometry, out_of(odometry, scan.points()))
        fresh = [seen.points for seen in self._newest.values()]
        self._fresh = sum(map(len, fresh))
        self._met = met = np.vstack((*fresh, kept))
        far = np.hypot(met[:, 0] - odometry.x_m, met[:, 1] - odometry.y_m)
        self._clear = odometry, float(far.min()) if len(met) else math.inf
        self._all_round_m = max(seen.scan.range_max_m if seen.scan.all_round else 0.0
                                for seen in self._newest.values())
        return scan.looks_anywhere

    def forget(self, odometry: Pose, robots: Iterable[Tuple[float, float, float]]) -> None:
        """Forget remembered obstacles at the places of known robots, since robots move on.

        :param robots: (ahead, to the left, radius) [m] of each, relative to this pose
        """
        where = np.array(list(robots)).reshape(-1, 3)
        kept = self._met[self._fresh:]
        gaps = kept[:, None, :] - out_of(odometry, where[:, :2])
        near = (np.hypot(gaps[..., 0], gaps[..., 1]) < where[:, 2] + _BESIDE_M).any(axis=1)
        self._met = np.vstack((self._met[:self._fresh], kept[~near]))

    def around(self, odometry: Pose, reach_m: float = math.inf) -> np.ndarray:
        """Return the obstacles around a robot at this pose, an array (n, 2) in its frame [m].

        :param reach_m: obstacles further away may be left out
        """
        there, clear_m = self._clear
        way_m = math.hypot(odometry.x_m - there.x_m, odometry.y_m - there.y_m)
        return _NOTHING if clear_m - way_m > reach_m else into(odometry, self._met)

    def looks(self, odometry: Pose, reach_m: float = KEEP_M) -> Looks:
        """Return the field of view of the newest scans, for a robot at this pose.

        :param reach_m: maximum distance of the points that will be asked for
        """
        if self._all_round_m > reach_m:
            return None
        return View(list(self._newest.values()), self._ground, odometry)


def within_reach(points: np.ndarray, reach_m: float) -> np.ndarray:
    """Return the points (n, 2) whose distance from the origin is at most this [m]."""
    if not len(points):
        return points
    found: np.ndarray = points[np.einsum('ij,ij->i', points, points) <= reach_m * reach_m]
    return found


def free_way(points: np.ndarray, radius_m: float, velocity: Velocity) -> float:
    """Return how far a disc gets along the arc of a velocity before it touches a point [m].

    :param points: array (n, 2) in the robot's frame [m]
    :returns: inf if the way is free; 0 if the disc already touches a point ahead; at most half a
        turn is considered
    """
    speed_mps = velocity.speed_mps
    if not len(points) or speed_mps == 0.0:
        return math.inf
    course_rad = _course(velocity)
    x, y = (into(Pose(0.0, 0.0, course_rad), points) if course_rad else points).T
    curvature = velocity.angular_rad_s / speed_mps
    if abs(curvature) < 1e-3:
        near = (np.abs(y) < radius_m) & (x > 0.0)
        ways = x[near] - np.sqrt(radius_m ** 2 - y[near] ** 2)
    else:
        ways = _along_arc(x, y if curvature > 0.0 else -y, 1.0 / abs(curvature), radius_m)
    return max(0.0, float(ways.min())) if len(ways) else math.inf


def _course(velocity: Velocity) -> float:
    """Return the direction of travel in the robot's frame [rad]."""
    return math.atan2(velocity.lateral_mps, velocity.linear_mps)


def _along_arc(x: np.ndarray, y: np.ndarray, turn_m: float, radius_m: float) -> np.ndarray:
    """Return the ways [m] along a left turn of that radius to the points that the disc touches."""
    far = np.hypot(x, y - turn_m)
    near = np.abs(far - turn_m) < radius_m
    far, angle = far[near], np.mod(np.arctan2(x[near], turn_m - y[near]), 2.0 * math.pi)
    cosine = (turn_m ** 2 + far ** 2 - radius_m ** 2) / np.maximum(2.0 * turn_m * far, 1e-9)
    travelled = angle - np.arccos(np.clip(cosine, -1.0, 1.0))
    ways: np.ndarray = turn_m * travelled[angle < math.pi]
    return ways


def stopping_speed(way_m: float, delay_s: float) -> float:
    """Return the speed [m/s] from which a robot stops within a way, braking after a delay."""
    if not math.isfinite(way_m):
        return math.inf
    lag = BRAKES_MPS2 * delay_s
    return math.sqrt(lag * lag + 2.0 * BRAKES_MPS2 * max(0.0, way_m)) - lag


def fronts(velocity: Velocity, radius_m: float,
           delay_s: float) -> Tuple[np.ndarray, np.ndarray]:
    """Return the places that a disc comes to until it can have stopped, arrays (n, 2) [m].

    :returns: (the path of its foremost point, the outline of what its front half sweeps: the rim
        now and at the end, and the paths of both shoulders)
    """
    speed, turn, course_rad = velocity.speed_mps, velocity.angular_rad_s, _course(velocity)
    lasts_s = delay_s + speed / (2.0 * BRAKES_MPS2)
    count = 5 + min(95, int(speed * lasts_s / _STEP_M))
    times = np.arange(count) * (lasts_s / (count - 1))
    angles = course_rad + turn * times
    if abs(turn) < 1e-6:
        x, y = speed * math.cos(course_rad) * times, speed * math.sin(course_rad) * times
    else:
        x = speed / turn * (np.sin(angles) - math.sin(course_rad))
        y = speed / turn * (math.cos(course_rad) - np.cos(angles))
    # For each place on the rim: the step on the way, and the angle to the direction of travel.
    steps, ones = np.arange(count), np.ones(count)
    last = np.full(len(_RIM), count - 1)
    step = np.concatenate((steps, last, 0 * last, steps, steps))
    side = np.concatenate((0.0 * ones, _RIM, _RIM, _RIM[0] * ones, _RIM[-1] * ones))
    rim = angles[step] + side
    places = np.column_stack((x[step] + radius_m * np.cos(rim), y[step] + radius_m * np.sin(rim)))
    return places[:count], places[count:]


def seen_velocity(velocity: Velocity, radius_m: float, delay_s: float, looks: Looks,
                  crawl_mps: float = CRAWL_MPS) -> Velocity:
    """Return the velocity at which a disc can stop before it leaves the field of view.

    It is zero if no scan covers the direction of travel, or a laser that should see what lies
    before a shoulder did not measure it; but a crawl straight back, so that the robot can get away.

    :param crawl_mps: speed of the crawl [m/s]; 0 with a laser whose mount is unknown
    """
    if looks is None:
        return velocity
    least, course_rad = _crawl(velocity, crawl_mps), _course(velocity)
    for slower in map(velocity.slower, _SLOWER):
        if looks.covers(*fronts(slower, radius_m, delay_s), course_rad):
            return max(slower, least, key=_speed)
    return least


_speed = operator.attrgetter('speed_mps')


def _crawl(velocity: Velocity, crawl_mps: float) -> Velocity:
    """Return the velocity allowed out of view: a crawl straight back, and the turn."""
    back = velocity.lateral_mps == 0.0
    return Velocity(min(0.0, max(velocity.linear_mps, -crawl_mps)) if back else 0.0,
                    velocity.angular_rad_s)


def reach_of(speed_mps: float, radius_m: float, age_s: float) -> float:
    """Return the distance from its centre at which an obstacle can limit a robot's speed [m].

    :param age_s: of the newest scan [s]
    """
    speed_mps = abs(speed_mps)
    return radius_m + MARGIN_M + speed_mps * (
        REACTION_S + age_s + speed_mps / (2.0 * BRAKES_MPS2))


def braked(velocity: Velocity, points: np.ndarray, radius_m: float,
           age_s: Optional[float], looks: Looks = None,
           crawl_mps: float = CRAWL_MPS) -> Velocity:
    """Return the velocity allowed for a robot; turning on the spot is always allowed.

    :param velocity: the requested velocity
    :param points: obstacles of its laser, in its frame [m]
    :param radius_m: of the disc around all of the robot [m]
    :param age_s: of the newest scan [s], None before the first. If there is none or it is too old,
        only a crawl straight back is allowed, as far as no obstacle is remembered there.
    :param looks: field of view of its laser, see :func:`seen_velocity`
    :param crawl_mps: see :func:`seen_velocity`
    """
    if velocity.speed_mps == 0.0:
        return velocity
    if age_s is None or age_s > SCAN_OLD_S:
        # Obstacles seen behind the robot earlier are still there.
        wanted, age_s = _crawl(velocity, crawl_mps), 0.0
    else:
        wanted = seen_velocity(velocity, radius_m + MARGIN_M, REACTION_S + age_s, looks, crawl_mps)
    delay_s = REACTION_S + age_s
    points = within_reach(points, reach_of(wanted.speed_mps, radius_m, age_s))
    return within_way(wanted, lambda slower: stopping_speed(
        free_way(points, radius_m + MARGIN_M, slower), delay_s))


def within_way(velocity: Velocity, most_mps: Callable[[Velocity], float]) -> Velocity:
    """Return a velocity, slowed to what its way allows, with the same turn.

    :param most_mps: function of a velocity: the speed [m/s] that its way allows
    """
    # Slower with the same turn is another arc: check that one, too.
    for _ in range(2):
        speed_mps, most = velocity.speed_mps, most_mps(velocity)
        if speed_mps > most:
            velocity = velocity.slower(most / speed_mps)
    return velocity.slower(0.0) if velocity.speed_mps < 1e-3 else velocity
