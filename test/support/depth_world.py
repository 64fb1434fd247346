# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random drives in :mod:`support.task_world` of a robot with a depth camera instead of a laser."""
from dataclasses import replace
import math
import random

import numpy as np

from mhri.camera.depth_codec import metres
from mhri.sensors.brake import NARROW_M
from mhri.sensors.depth_beams import DepthBeams
from mhri.sensors.point_cloud import CloudError, Lens
from mhri.sim.camera import Camera, CENTRE_X_PX, CENTRE_Y_PX, FOCAL_PX, HEIGHT, WIDTH
from mhri.sim.plan import Landmark, Plan
from mhri.tasks.base import ENDS
from mhri.tasks.run import RobotRun
from support.task_world import Robot, room, Wander, World

LENS = Lens(FOCAL_PX, FOCAL_PX, CENTRE_X_PX, CENTRE_Y_PX, WIDTH, HEIGHT)
GREY = (128, 128, 128)
# Nearer than this a real one measures nothing [mm].
NEAR_MM = 450


class Seer(Robot):
    """A robot that looks with a depth camera, ten times a second."""

    def __init__(self, world, *args, **options):
        super().__init__(world, *args, **options)
        self._camera = Camera(Plan('room', world.walls, 2.4, GREY, GREY, tuple(
            Landmark('thing', GREY, x, y, radius, 0.5) for x, y, radius in world.discs), ()))
        self._mount = np.array([[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0],
                                [0.0, -1.0, 0.0, self._camera.height_m], [0.0, 0.0, 0.0, 1.0]])
        self._beams = DepthBeams()
        self.task_body = replace(self.task_body,
                                 radius_m=self.task_body.radius_m + NARROW_M)

    def sense(self, now_s, tick):
        """Look, when it is due."""
        if tick % 2 == 0:
            body = self.body
            depth = self._camera.depth(self._camera.look(body.x, body.y, body.yaw, ()))
            depth = metres(np.where(depth < NEAR_MM, 0, depth).astype(np.uint16))
            try:
                scan = self._beams.scan(depth, LENS, self._mount)
            except CloudError:
                # Right before a wall it measures nothing.
                return
            self.seen.see(scan, self.odometry())
            self.scan_at = now_s


def drive_by_depth(seed, most_s, brake):
    """Let a robot wander among four things; return it."""
    chance = random.Random(seed)
    discs = [(chance.uniform(-1.8, 1.8), chance.uniform(-1.8, 1.8), chance.uniform(0.03, 0.3))
             for _ in range(4)]
    world = World(room(5.0, 5.0), [disc for disc in discs
                                   if math.hypot(*disc[:2]) > 0.9 + disc[2]])
    robot = Seer(world, 'bot1', (0.0, 0.0, chance.uniform(-3.0, 3.0)), seed)
    world.robots.append(robot)
    while world.now_s < most_s:
        if robot.run is None or robot.run.state in ENDS:
            robot.run = RobotRun('bot1', Wander(chance.random()), robot.task_body, 0.0,
                                 world.now_s)
        world.step(has_laser=brake)
    return robot
