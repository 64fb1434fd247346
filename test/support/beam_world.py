# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot driven by the stick's brake through walls; what its laser sends is as its type's does.

No ROS and no clock: scans go the way of the mux, raw, by the rule for its type.
"""
import math
import random

import numpy as np

from mhri.base.limits import Velocity
from mhri.base.geometry import Pose
from mhri.driving.stick_brake import StickBrake
from mhri.sensors.laser_scan import laser_scan
from mhri.sim.sensors import Laser
from support.task_world import wall_distance

DT_S = 0.05
NAN, INF = math.nan, math.inf


class Kind:
    """A robot with a laser.

    :param no_return: as its type's file has it
    :param nothing: what its driver sends for nothing; ``near`` for what is too near
    :param beams: of a full turn, of which it has those within ``half_rad`` of ahead
    """

    def __init__(self, radius_m, x_m, limits, no_return, nothing, near=None, speed_mps=0.3,
                 half_rad=math.pi, reach_m=None):
        self.radius_m, self.x_m, self.limits, self.no_return = radius_m, x_m, limits, no_return
        self.nothing, self.near = nothing, nothing if near is None else near
        self.speed_mps, self.half_rad = speed_mps, half_rad
        self.reach_m = reach_m or limits[1]


TURTLEBOT3 = Kind(0.22, -0.064, (0.12, 3.5), {3.5: (0.0, INF)}, 0.0, speed_mps=0.26)
TURTLEBOT2 = Kind(0.18, -0.087, (0.45, 10.0), {None: (NAN, INF)}, NAN, speed_mps=0.65,
                  half_rad=math.radians(29.0), reach_m=3.5)
RPLIDAR = Kind(0.2, 0.0, (0.15, 12.0), {}, INF, near=-INF, speed_mps=0.5)
STAGE = Kind(0.2, 0.0, (0.0, 8.0), {}, 8.0, speed_mps=0.5)
KINDS = {'TurtleBot3': TURTLEBOT3, 'TurtleBot2': TURTLEBOT2, 'RPLidar': RPLIDAR, 'Stage': STAGE}


class Drive:
    """A robot in a world of walls, and the brake of whoever drives it.

    ``sends`` replaces what its laser sends: a function of the ranges.
    """

    def __init__(self, kind, walls, pose=Pose(0.0, 0.0, 0.0), every=2, discs=()):
        self.kind, self.walls, self.pose, self.every = kind, np.array(walls, dtype=float), pose, 2
        self.every = every
        self.laser = Laser(self.walls.reshape(-1, 4), kind.limits[0], kind.reach_m,
                           np.random.default_rng(1), nothing=kind.nothing)
        self.laser._too_near = kind.near
        self.discs = np.array(discs, dtype=float).reshape(-1, 3)
        self.now_s, self.tick = 100.0, 0
        self.odometry = self.pose
        self.speed_mps = 0.0
        self.sends = lambda ranges: ranges
        self.chance = random.Random(1)
        self.fastest_mps = 0.0
        self.closest_m = math.inf
        self.restart()

    def restart(self):
        """Let another brake take over that has seen nothing."""
        self.brake = StickBrake(self.kind.radius_m, True)
        self.brake.ask(True)
        self.brake.move(self.odometry)

    def look(self):
        """Let the laser measure once."""
        x = self.pose.x_m + self.kind.x_m * math.cos(self.pose.heading_rad)
        y = self.pose.y_m + self.kind.x_m * math.sin(self.pose.heading_rad)
        ranges = self.laser.scan(x, y, self.pose.heading_rad, self.discs)
        step = self.laser.increment_rad
        half = int(self.kind.half_rad / step)
        first = -half * step
        ranges = np.roll(ranges, half)[:min(len(ranges), 2 * half + 1)]
        self.brake.see(laser_scan(self.sends(ranges), (first, step), self.kind.limits,
                                  self.kind.no_return, self.kind.radius_m,
                                  (Pose(self.kind.x_m, 0.0, 0.0), False)), self.now_s)

    def go(self, seconds, linear=None, angular=0.0):
        """Hold the stick for so long; return how far it went [m], back being negative."""
        begun = self.pose
        wanted = Velocity(self.kind.speed_mps if linear is None else linear, angular)
        self.fastest_mps = 0.0
        for _ in range(int(seconds / DT_S)):
            self.now_s += DT_S
            self.tick += 1
            if self.tick % self.every == 0:
                self.look()
            self.brake.move(self.pose)
            given = self.brake.allow(wanted, self.now_s)
            # Gaining speed takes its time, as losing it does.
            most = (1.0 if abs(given.linear_mps) > abs(self.speed_mps) else 0.8) * DT_S
            self.speed_mps += max(-most, min(most, given.linear_mps - self.speed_mps))
            heading = self.pose.heading_rad + given.angular_rad_s * DT_S
            self.pose = Pose(self.pose.x_m + self.speed_mps * DT_S * math.cos(heading),
                             self.pose.y_m + self.speed_mps * DT_S * math.sin(heading), heading)
            self.odometry = self.pose
            self.fastest_mps = max(self.fastest_mps, abs(self.speed_mps))
            self.closest_m = min(self.closest_m, self.gap_m())
        return ((self.pose.x_m - begun.x_m) * math.cos(begun.heading_rad)
                + (self.pose.y_m - begun.y_m) * math.sin(begun.heading_rad))

    def gap_m(self):
        """Return what is between the robot and the nearest wall or disc [m]."""
        gaps = [wall_distance(self.walls, self.pose.x_m, self.pose.y_m)]
        gaps += [math.hypot(self.pose.x_m - x, self.pose.y_m - y) - radius
                 for x, y, radius in self.discs]
        return min(gaps) - self.kind.radius_m

    def says(self):
        """Return the word of its brake."""
        return self.brake.state(self.now_s)[0]


def corridor(length_m=10.0, width_m=2.0, begin_m=-1.0):
    """Return two walls; the hall it leads into has no end."""
    return [(begin_m, 0.5 * side * width_m, begin_m + length_m, 0.5 * side * width_m)
            for side in (-1, 1)]


def wall_at(x_m, half_m=3.0):
    """Return a wall across the way."""
    return [(x_m, -half_m, x_m, half_m)]
