# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sensors of a simulated robot: inertial unit and laser scanner."""
import math

import numpy as np

GRAVITY_MPS2 = 9.80665


class ImuSensor:
    """A MEMS inertial unit: white noise and a constant bias on every axis.

    ``yaw`` is the integral of the measured yaw rate, so it drifts like the orientation of a real
    unit without a compass. Noise is the standard deviation of one sample at 100 Hz.

    :param random: :class:`random.Random`
    """

    GYRO_NOISE_RAD_S = 0.005
    GYRO_BIAS_RAD_S = 0.001
    ACCEL_NOISE_MPS2 = 0.05
    ACCEL_BIAS_MPS2 = 0.03

    def __init__(self, random):
        self._gauss = random.gauss
        self._gyro_bias = [random.gauss(0.0, self.GYRO_BIAS_RAD_S) for _ in range(3)]
        self._accel_bias = [random.gauss(0.0, self.ACCEL_BIAS_MPS2) for _ in range(3)]
        self.yaw = 0.0

    def measure(self, body, dt):
        """Return (gyro, accelerometer) in the body frame [rad/s, m/s^2], each (x, y, z)."""
        gauss = self._gauss
        gyro = [truth + bias + gauss(0.0, self.GYRO_NOISE_RAD_S)
                for truth, bias in zip((0.0, 0.0, body.turn_rate), self._gyro_bias)]
        true_accel = (body.forward_accel, body.v * body.turn_rate, GRAVITY_MPS2)
        accel = [truth + bias + gauss(0.0, self.ACCEL_NOISE_MPS2)
                 for truth, bias in zip(true_accel, self._accel_bias)]
        self.yaw = math.remainder(self.yaw + gyro[2] * dt, 2.0 * math.pi)
        return gyro, accel


class Laser:
    """A planar scanner at the robot's centre: rays counter-clockwise from straight ahead.

    A ray along a wall misses it; a ray from inside a disc hits it at once.

    :param walls: array (n, 4) of x1, y1, x2, y2 [m]
    :param random: :class:`numpy.random.Generator`
    :param nothing: value of its driver without an obstacle within range; if not that of REP 117,
        also for obstacles that are too near
    """

    NOISE_M = 0.01
    # Prevents rays from passing between two walls that share a corner.
    _OVERLAP = 1e-9

    def __init__(self, walls, range_min_m, range_max_m, random, rays=360, nothing=math.inf):
        self.range_min_m = range_min_m
        self.range_max_m = range_max_m
        self._nothing = nothing
        self._too_near = -math.inf if nothing == math.inf else nothing
        self.increment_rad = 2.0 * math.pi / rays
        self._angles = np.arange(rays) * self.increment_rad
        self._start = walls[:, :2]
        self._along = walls[:, 2:] - walls[:, :2]
        self._random = random

    def distances(self, x, y, yaw, discs):
        """Return the true distance along each ray [m], inf if it hits nothing.

        :param discs: array (n, 3) of x, y, radius [m]
        """
        angles = self._angles + yaw
        dx, dy = np.cos(angles)[:, None], np.sin(angles)[:, None]
        px, py = self._start[:, 0] - x, self._start[:, 1] - y
        ex, ey = self._along[:, 0], self._along[:, 1]
        with np.errstate(divide='ignore', invalid='ignore'):
            across = dx * ey - dy * ex
            far = (px * ey - py * ex) / across
            share = (px * dy - py * dx) / across
        hits = np.where((far > 0.0) & (share >= -self._OVERLAP) & (share <= 1.0 + self._OVERLAP),
                        far, np.inf)
        nearest = hits.min(axis=1)
        if len(discs):
            cx, cy = discs[:, 0] - x, discs[:, 1] - y
            along = dx * cx + dy * cy
            inside = discs[:, 2] ** 2 - (cx ** 2 + cy ** 2 - along ** 2)
            half_chord = np.sqrt(np.maximum(inside, 0.0))
            nearest = np.minimum(nearest, np.where(
                (inside > 0.0) & (along + half_chord > 0.0),
                np.maximum(along - half_chord, 0.0), np.inf).min(axis=1))
        return nearest

    def scan(self, x, y, yaw, discs):
        """Return the measured distances, with noise."""
        ranges = self.distances(x, y, yaw, discs)
        ranges = ranges + self._random.normal(0.0, self.NOISE_M, ranges.shape)
        far, near = ranges > self.range_max_m, ranges < self.range_min_m
        ranges[far], ranges[near] = self._nothing, self._too_near
        return ranges
