# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Limits the speed of a robot so that no task leaves the fence.

As with obstacles, the robot has to be able to stop within the remaining distance. A robot too near
to the fence, or outside, may only drive further inside.
"""
import math

import numpy as np

from mhri.base.geometry import Pose
from mhri.base.limits import Velocity
from mhri.sensors.brake import BRAKES_MPS2, MARGIN_M, REACTION_S, stopping_speed, within_way
from mhri.tasks.base import Body

_STEP_M = 0.04


def depths(fence: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the depth of positions inside a fence [m]; negative outside.

    :param fence: its corners, an array (n, 2) [m] with n >= 3
    :param places: positions, an array (m, 2) in the same frame [m]
    """
    start, end = fence, np.roll(fence, -1, axis=0)
    along = end - start
    gap = places[:, None, :] - start
    share = np.clip((gap * along).sum(axis=2) / np.maximum((along ** 2).sum(axis=1), 1e-12),
                    0.0, 1.0)
    far = np.hypot(*np.moveaxis(gap - share[:, :, None] * along, 2, 0)).min(axis=1)
    x, y = places[:, 0, None], places[:, 1, None]
    beside = (start[:, 1] > y) != (end[:, 1] > y)
    rise = np.where(along[:, 1] == 0.0, 1.0, along[:, 1])
    crossed = beside & (x < start[:, 0] + (y - start[:, 1]) / rise * along[:, 0])
    found: np.ndarray = np.where(crossed.sum(axis=1) % 2 == 1, far, -far)
    return found


def is_inside(fence: np.ndarray, x_m: float, y_m: float) -> bool:
    """Return whether a position is inside; True without a fence."""
    return not len(fence) or bool(depths(fence, np.array([[x_m, y_m]]))[0] > 0.0)


def kept_inside(velocity: Velocity, pose: Pose, fence: np.ndarray, body: Body) -> Velocity:
    """Return the allowed velocity of a robot; turning on the spot is always allowed.

    :param velocity: the requested velocity
    :param pose: pose of the robot in the frame of the fence
    :param fence: its corners, an array (n, 2) [m]; empty: no fence
    """
    if not len(fence) or velocity.speed_mps == 0.0:
        return velocity
    return within_way(velocity, lambda slower: stopping_speed(
        _way_inside(slower, pose, fence, body), REACTION_S))


def _way_inside(velocity: Velocity, pose: Pose, fence: np.ndarray, body: Body) -> float:
    """Return how far the robot may go along the arc of a velocity [m]; inf: it can stop inside."""
    speed = velocity.speed_mps
    if speed < 1e-6:
        return math.inf
    look_m = speed * REACTION_S + speed ** 2 / (2.0 * BRAKES_MPS2) + 2 * _STEP_M
    ways = np.arange(0.0, look_m + _STEP_M, _STEP_M)
    # The heading at the middle of each step.
    headings = pose.heading_rad + math.atan2(velocity.lateral_mps, velocity.linear_mps) + (
        ways - 0.5 * _STEP_M) * velocity.angular_rad_s / speed
    steps = _STEP_M * np.column_stack((np.cos(headings), np.sin(headings)))
    steps[0] = (pose.x_m, pose.y_m)
    inside = depths(fence, np.cumsum(steps, axis=0))
    over = inside[1:] < min(inside[0], body.radius_m + MARGIN_M)
    return float(ways[int(np.argmax(over))]) if over.any() else math.inf
