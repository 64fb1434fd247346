# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated body: closed forms, limits, the base's watchdog, collisions, wheels that drift."""
import math
from pathlib import Path
import random

import numpy as np
import pytest

from mhri.base.config import ConfigError
from mhri.base.robot_types import Limits
from mhri.sim.body import Body, Bumper, parse_bodies

BODIES_FILE = Path(__file__).resolve().parents[3] / 'resource' / 'sim' / 'bodies.yaml'
BODIES = parse_bodies(BODIES_FILE.read_text(), 'bodies.yaml')
LIMITS = {'turtlebot2': Limits(0.65, 3.14), 'turtlebot3_burger': Limits(0.22, 2.84),
          'turtlebot3_waffle': Limits(0.26, 1.82), 'holonomic': Limits(0.5, 2.0, True)}
DT = 0.01


class Still:
    """A source of chance without any."""

    @staticmethod
    def gauss(mean, _):
        return mean


class Rig:
    """A body, the time, and what stands around: a function of distance and a list of discs."""

    def __init__(self, kind='turtlebot2', pose=(0.0, 0.0, 0.0), distance=lambda x, y: math.inf,
                 chance=Still):
        self.now = 50.0
        self.others = []
        self.asked = 0
        self.kind = BODIES[kind]

        def counting(x, y):
            self.asked += 1
            return distance(x, y)
        bumper = Bumper(self.kind.radius_m, counting,
                        lambda: np.array(self.others, dtype=float).reshape(-1, 3))
        self.body = Body(self.kind, LIMITS[kind], pose, bumper, chance)

    def drive(self, v, w, seconds, each=lambda: None):
        """Command at 20 Hz for some time."""
        for tick in range(round(seconds / DT)):
            if tick % 5 == 0:
                assert self.body.command(v, w, self.now)
            self.step()
            each()
        return self.body

    def step(self, seconds=DT):
        for _ in range(round(seconds / DT)):
            self.now += DT
            self.body.step(DT, self.now)

    def at_speed(self, v, w):
        """Reach a speed and forget the way there."""
        body = self.drive(v, w, 3.0)
        body.x = body.y = body.yaw = body.odom_x = body.odom_y = body.odom_yaw = 0.0
        return body


def wall_ahead(x_m):
    """Return the distance to a wall across the x axis."""
    return lambda x, y: abs(x_m - x)


@pytest.mark.parametrize('kind', ['turtlebot2', 'holonomic'])
@pytest.mark.parametrize('v, w, seconds', [(-0.2, 0.0, 2.0), (0.0, -1.8, 5.0), (0.2, -0.5, 4.0)])
def test_motion_is_the_closed_form(kind, v, w, seconds):
    rig = Rig(kind)
    rig.at_speed(v, w)
    body = rig.drive(v, w, seconds)
    seconds = round(seconds / DT) * DT
    turned = w * seconds
    if w:
        x, y = v / w * math.sin(turned), v / w * (1.0 - math.cos(turned))
    else:
        x, y = v * seconds, 0.0
    assert (body.x, body.y) == pytest.approx((x, y), abs=1e-4)
    assert math.remainder(body.yaw - turned, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert -math.pi <= body.yaw <= math.pi
    # Without noise the wheels say the same.
    assert (body.odom_x, body.odom_y, body.odom_yaw) == pytest.approx((body.x, body.y, body.yaw))
    assert (body.odom_v, body.odom_w) == pytest.approx((v, w))


@pytest.mark.parametrize('kind', ['turtlebot2', 'holonomic'])
@pytest.mark.parametrize('v, w', [(-9.0, 0.0), (9.0, -99.0)])
def test_motors_have_limits(kind, v, w):
    body = Rig(kind).drive(v, w, 3.0)
    top = LIMITS[kind]
    assert abs(body.v) == pytest.approx(top.linear_mps if v else 0.0)
    assert abs(body.w) == pytest.approx(top.angular_rad_s if w else 0.0)
    assert body.v * v >= 0.0 and body.w * w >= 0.0


@pytest.mark.parametrize('v, w, u, seconds', [
    (0.0, 0.0, 0.3, 2.0), (0.2, 0.0, -0.3, 2.0), (0.2, 0.5, 0.2, 3.0), (-0.1, -0.7, 0.3, 4.0)])
def test_a_holonomic_one_goes_sideways_on_an_arc(v, w, u, seconds):
    rig = Rig('holonomic')
    rig.body.v, rig.body.w, rig.body.u = v, w, u
    x = y = 0.0
    for step in range(round(seconds / DT)):
        assert rig.body.command(v, w, rig.now, u)
        rig.step()
        yaw = w * DT * (step + 0.5)
        x += DT * (v * math.cos(yaw) - u * math.sin(yaw))
        y += DT * (v * math.sin(yaw) + u * math.cos(yaw))
    body = rig.body
    assert (body.x, body.y) == pytest.approx((x, y), abs=1e-6)
    assert (body.odom_x, body.odom_y, body.odom_u) == pytest.approx((x, y, u))


@pytest.mark.parametrize('kind', ['turtlebot2', 'holonomic'])
def test_acceleration_is_limited(kind):
    rig = Rig(kind)
    speeds = [(0.0, 0.0)]
    for v, w in ((9.0, 9.0), (-9.0, -9.0), (0.0, 0.0)):
        rig.drive(v, w, 3.0, lambda: speeds.append((rig.body.v, rig.body.w)))
    steps = np.abs(np.diff(speeds, axis=0)) / DT
    assert steps.max(axis=0) == pytest.approx((rig.kind.accel_mps2, rig.kind.accel_rad_s2))
    assert speeds[-1] == (0.0, 0.0)


@pytest.mark.parametrize('v, w', [(math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0),
                                  (0.1, -math.inf)])
def test_what_is_not_finite_is_refused(v, w):
    rig = Rig()
    rig.drive(0.1, 0.0, 0.3)
    given = rig.now
    assert not rig.body.command(v, w, rig.now)
    rig.step(0.5)
    assert rig.body.v == pytest.approx(0.1), 'what was commanded before still holds'
    while rig.body.v:
        rig.step()
    assert rig.now - given < rig.kind.watchdog_s + 0.1, 'and the watchdog was not fed'


@pytest.mark.parametrize('kind', ['turtlebot2', 'holonomic'])
def test_without_power_nothing_drives_and_power_alone_neither(kind):
    rig = Rig(kind)
    rig.drive(0.2, 0.5, 1.0)
    rig.body.set_power(False)
    rig.drive(0.2, 0.5, 0.2)
    assert (rig.body.v, rig.body.w) == (0.0, 0.0)
    rig.body.set_power(True)
    rig.step(0.3)
    assert (rig.body.v, rig.body.w) == (0.0, 0.0), 'a command from before'
    rig.drive(0.2, 0.5, 0.1)
    assert rig.body.v > 0.0


@pytest.mark.parametrize('kind, watchdog_s, v, w', [
    ('turtlebot2', 0.6, 9.0, 0.0), ('turtlebot3_burger', 0.5, -9.0, -9.0)])
def test_watchdog(kind, watchdog_s, v, w):
    rig = Rig(kind)
    body = rig.drive(v, w, 3.0)
    body.command(v, w, rig.now)
    silent_since, speed = rig.now, (body.v, body.w)
    while rig.now - silent_since < watchdog_s - 1.5 * DT:
        rig.step()
        assert (body.v, body.w) == speed, 'too early'
    while body.v or body.w:
        rig.step()
        assert rig.now - silent_since < watchdog_s + 0.2, 'too late'
    # It brakes, it does not stop dead.
    braking_s = max(abs(speed[0]) / rig.kind.brake_mps2,
                    abs(speed[1]) * rig.kind.wheel_separation_m / 2.0 / rig.kind.brake_mps2)
    assert rig.now - silent_since == pytest.approx(watchdog_s + braking_s, abs=2.5 * DT)
    assert (body.odom_v, body.odom_w) == (0.0, 0.0)
    assert rig.drive(v, w, 3.0).v == speed[0], 'a new command wakes it'


def test_wall_stops_it_and_lets_it_back_out():
    rig = Rig('turtlebot2', distance=wall_ahead(1.0))
    body = rig.drive(0.5, 0.0, 5.0)
    assert body.blocked and body.x == pytest.approx(1.0 - rig.kind.radius_m, abs=0.006)
    assert body.x <= 1.0 - rig.kind.radius_m
    rig.drive(0.5, 0.0, 5.0, lambda: pytest.fail('inside') if body.x > 0.823 else None)
    turned = body.yaw
    rig.drive(0.5, 1.0, 1.0)
    assert body.yaw > turned + 0.5, 'a round body can turn where it stands'
    rig.drive(0.0, -1.0, 1.0)
    assert rig.drive(-0.3, 0.0, 2.0).x < 0.5 and not body.blocked


def test_landmark_or_another_robot_stops_it():
    rig = Rig('turtlebot3_burger')
    rig.others = [(5.0, 5.0, 0.2), (1.0, 0.0, 0.2)]
    body = rig.drive(0.2, 0.0, 8.0)
    assert body.x == pytest.approx(0.8 - rig.kind.radius_m, abs=0.004)
    rig.others = [(5.0, 5.0, 0.2)]
    assert rig.drive(0.2, 0.0, 2.0).x > 1.0, 'gone when the other has driven on'


def test_two_that_met_within_one_step_can_part():
    """Each looks where the other was; then both have moved."""
    one, two = Rig('turtlebot2'), Rig('turtlebot2', pose=(0.358, 0.0, math.pi))
    for rig in (one, two):
        rig.body.v = 0.3
        rig.body.command(0.3, 0.0, rig.now)
    one.others, two.others = [(two.body.x, 0.0, 0.177)], [(one.body.x, 0.0, 0.177)]
    one.step(), two.step()
    assert two.body.x - one.body.x < 0.354, 'they overlap'
    for tick in range(200):
        for rig, other in ((one, two), (two, one)):
            rig.others = [(other.body.x, other.body.y, 0.177)]
            rig.drive(-0.3, 0.0, DT)
    assert two.body.x - one.body.x > 0.6


def test_odometry_drifts_from_the_truth():
    ends = []
    for seed in range(40):
        rig = Rig('turtlebot2', chance=random.Random(seed))
        body = rig.drive(0.5, 0.0, 20.0)
        ends.append((body.odom_x - body.x, body.odom_y - body.y, body.odom_yaw - body.yaw))
    spread = np.std(ends, axis=0)
    assert np.abs(ends).min() > 0.0
    # 10 m with wheels that are 0.3 % different: centimetres along, and a heading that is off.
    assert 0.005 < spread[0] < 0.3 and 0.05 < spread[1] < 1.5 and 0.02 < spread[2] < 0.4
    assert np.abs(np.mean(ends, axis=0)).max() < 0.5


@pytest.mark.parametrize('change, key', [
    (('radius_m: 0.177', 'radius_m: .nan'), 'bodies.turtlebot2.radius_m'),
    (('watchdog_s: 0.6', 'watchdog: 0.6'), 'bodies.turtlebot2.watchdog_s'),
    (('watchdog_s: 0.6', 'watchdog_s: 0.6\n    wings: 2'), 'bodies.turtlebot2.wings'),
    (('colour: [60, 60, 64]', 'colour: [60, 60, 256]'), 'bodies.turtlebot2.colour'),
    (('bodies:', 'boddies:'), 'boddies')])
def test_wrong_bodies_are_refused_by_file_and_key(change, key):
    text = BODIES_FILE.read_text()
    assert change[0] in text
    with pytest.raises(ConfigError) as caught:
        parse_bodies(text.replace(*change, 1), 'my/bodies.yaml')
    assert (caught.value.origin, caught.value.key) == ('my/bodies.yaml', key)


def test_a_stuck_motor_turns_the_robot_about_its_wheel():
    rig = Rig()
    rig.body.left_share = 0.0
    body = rig.drive(0.2, 0.0, 1.0)
    assert body.v == pytest.approx(0.1) and body.w == pytest.approx(0.2 / 0.23)
    assert body.odom_w == pytest.approx(body.w, rel=0.01)


def test_a_slipping_robot_turns_and_its_wheels_do_not_know():
    rig = Rig()
    rig.body.slip = math.radians(90.0)
    body = rig.drive(0.5, 0.0, 2.0)
    assert body.yaw == pytest.approx(math.radians(90.0) * body.odom_x, rel=0.01)
    assert body.odom_yaw == pytest.approx(0.0, abs=0.02)
    assert body.turn_rate == pytest.approx(0.5 * math.radians(90.0))
