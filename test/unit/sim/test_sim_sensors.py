# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the simulated robot senses: rays against distances worked out by hand, IMU statistics."""
import math
import random

import numpy as np
import pytest

from mhri.sim.sensors import GRAVITY_MPS2, ImuSensor, Laser

# A room 4 m x 2 m, its lower left corner in the origin.
ROOM = np.array([(0, 0, 4, 0), (4, 0, 4, 2), (4, 2, 0, 2), (0, 2, 0, 0)], dtype=float)
NOTHING = np.empty((0, 3))
DEGREE = math.pi / 180.0


class NoNoise:
    """A generator of numbers that are all the mean."""

    @staticmethod
    def normal(mean, _, shape):
        return np.full(shape, mean)


def laser(walls=ROOM, low=0.12, high=3.5, random_=NoNoise):
    return Laser(np.array(walls, dtype=float), low, high, random_)


@pytest.mark.parametrize('yaw', [0.0, 90.0 * DEGREE, -90.0 * DEGREE, 180.0 * DEGREE])
def test_walls_of_a_room(yaw):
    ranges = laser().distances(1.0, 0.5, yaw, NOTHING)
    turn = round(yaw / DEGREE)
    diagonal = math.sqrt(2.0)
    for degrees, wanted in ((0, 3.0), (90, 1.5), (180, 1.0), (270, 0.5), (45, 1.5 * diagonal),
                            (135, diagonal), (225, 0.5 * diagonal), (315, 0.5 * diagonal),
                            (30, 3.0), (60, 1.5 / math.sin(math.pi / 3.0))):
        assert ranges[(degrees - turn) % 360] == pytest.approx(wanted, abs=1e-9), degrees


@pytest.mark.parametrize('disc, degrees, wanted', [
    ((2.0, 0.0, 0.5), 0, 1.5),
    ((2.0, 0.0, 0.5), 180, math.inf),
    ((0.0, 1.0, 0.25), 90, 0.75),
    ((2.0, 0.3, 0.5), 0, 2.0 - 0.4),
    ((2.0, 0.51, 0.5), 0, math.inf),
    ((-1.0, -1.0, 0.2), 225, math.sqrt(2.0) - 0.2),
    ((0.0, 0.0, 0.3), 17, 0.0),
    ((0.1, 0.0, 0.3), 180, 0.0),
])
def test_discs(disc, degrees, wanted):
    ranges = laser([(90, 90, 91, 90)]).distances(0.0, 0.0, 0.0, np.array([disc]))
    assert ranges[degrees] == pytest.approx(wanted, abs=1e-9)


def test_rays_and_range():
    scanner = laser(low=0.6, high=2.5)
    ranges = scanner.scan(1.0, 0.5, 0.0, NOTHING)
    assert len(ranges) == 360 and scanner.increment_rad == pytest.approx(DEGREE)
    assert ranges[0] == math.inf, '3 m are beyond its range'
    assert ranges[270] == -math.inf, '0.5 m are too near'
    assert ranges[180] == pytest.approx(1.0)
    seen = ranges[np.isfinite(ranges) & (ranges > 0.0)]
    assert seen.min() >= 0.6 and seen.max() <= 2.5


def test_noise_of_the_laser():
    scanner = laser(high=10.0, random_=np.random.default_rng(3))
    truth = scanner.distances(1.0, 0.5, 0.3, NOTHING)
    errors = np.array([scanner.scan(1.0, 0.5, 0.3, NOTHING) - truth for _ in range(50)])
    assert abs(errors.mean()) < 0.0005
    assert errors.std() == pytest.approx(Laser.NOISE_M, rel=0.03)


class Motion:
    """A body's motion, as the unit looks at it."""

    def __init__(self, v=0.0, w=0.0, forward_accel=0.0):
        self.v, self.w, self.turn_rate, self.forward_accel = v, w, w, forward_accel


@pytest.mark.parametrize('motion, gyro_z, accel', [
    (Motion(), 0.0, (0.0, 0.0)),
    (Motion(w=1.5), 1.5, (0.0, 0.0)),
    (Motion(v=0.5, w=1.5), 1.5, (0.0, 0.75)),
    (Motion(v=0.5, w=-1.5), -1.5, (0.0, -0.75)),
    (Motion(v=-0.5, w=1.5), 1.5, (0.0, -0.75)),
    (Motion(v=0.5, forward_accel=-2.0), 0.0, (-2.0, 0.0)),
])
def test_imu_statistics(motion, gyro_z, accel):
    means = []
    for seed in range(20):
        imu = ImuSensor(random.Random(seed))
        samples = np.array([sum(imu.measure(motion, 0.01), []) for _ in range(1000)])
        means.append(samples.mean(axis=0))
        assert samples[:, :3].std(axis=0) == pytest.approx([ImuSensor.GYRO_NOISE_RAD_S] * 3,
                                                           rel=0.1)
        assert samples[:, 3:].std(axis=0) == pytest.approx([ImuSensor.ACCEL_NOISE_MPS2] * 3,
                                                           rel=0.1)
    # Over many units the biases are zero on average; within one they stay.
    wanted = (0.0, 0.0, gyro_z) + accel + (GRAVITY_MPS2,)
    biases = [ImuSensor.GYRO_BIAS_RAD_S] * 3 + [ImuSensor.ACCEL_BIAS_MPS2] * 3
    for number, bias in enumerate(biases):
        column = np.array(means)[:, number]
        assert column.mean() == pytest.approx(wanted[number], abs=bias)
        assert 0.4 * bias < column.std() < 1.8 * bias
