# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lasers that are covered in part: the brake, the guard and a task by one table of cases."""
import math

import numpy as np
from play_guard import load
import pytest

from mhri.base.geometry import Pose
from mhri.base.limits import Limits, Velocity
from mhri.driving.stick_brake import StickBrake
from mhri.sensors.brake import CRAWL_MPS, Surroundings
from mhri.sensors.laser_scan import laser_scan
from mhri.tasks.base import Body, RUNNING, Senses, Step, Task, WAITING
from mhri.tasks.run import Facts, RobotRun
from support.paths import GUARD

RADIUS_M, AGE_S, SPEED = 0.2, 0.1, 0.5
AHEAD, LEFT_BEND, TIGHT, BACK, ASIDE = (
    (SPEED, 0.0, 0.0), (SPEED, 0.8, 0.0), (0.1, 1.0, 0.0), (-SPEED, 0.0, 0.0), (0.0, 0.0, SPEED))
HERE = Pose(2.0, -1.0, 0.7)
NAN_IS_NOTHING = {None: (math.nan, math.inf)}
FAR_M = 5.0


class Wish(Task):
    """A task that wants one velocity."""

    def __init__(self, velocity):
        self._velocity = Velocity(*velocity)

    def step(self, senses):
        return Step(self._velocity)


class Eye:
    """A laser with a beam for each degree of its field.

    :param field: its first and last beam [degrees]
    :param covered: (first, last) beam of each part that says NaN [degrees]
    :param mount: ahead, to the left [m], turned to the left [degrees]
    """

    def __init__(self, field, *covered, mount=(0.0, 0.0, 0.0), least_m=0.1):
        beams = range(field[0], field[1] + 1)
        self.ranges = [math.nan if any(first <= beam <= last for first, last in covered) else FAR_M
                       for beam in beams]
        self.first, self.limits = math.radians(field[0]), (least_m, 10.0)
        self.mount = mount[0], mount[1], math.radians(mount[2])


ROUND, KINECT = (-180, 179), (-28, 28)
LEFT, RIGHT = (0.1, 0.15, 45.0), (0.1, -0.15, -45.0)


def kinect(*covered):
    """Return the laser of a TurtleBot2: it says NaN for nothing, and for what is too near."""
    return Eye(KINECT, *covered, mount=(-0.087, 0.0, 0.0), least_m=0.45)


CASES = [
    # A laser that looks all round.
    ('bare', [Eye(ROUND)], AHEAD, 1.0), ('bare', [Eye(ROUND)], LEFT_BEND, 1.0),
    ('right half', [Eye(ROUND, (-180, -5))], AHEAD, 0.0),
    ('left half', [Eye(ROUND, (5, 179))], AHEAD, 0.0),
    ('right half', [Eye(ROUND, (-180, -5))], LEFT_BEND, 0.0),
    ('left half', [Eye(ROUND, (5, 179))], LEFT_BEND, 0.0),
    ('a pole beside the middle', [Eye(ROUND, (5, 14))], AHEAD, 0.0),
    ('a pole beside the middle', [Eye(ROUND, (-14, -5))], AHEAD, 0.0),
    ('a pole in between', [Eye(ROUND, (40, 49))], AHEAD, 0.0),
    ('a pole before the shoulder', [Eye(ROUND, (-88, -78))], AHEAD, 0.0),
    ('a pole behind', [Eye(ROUND, (110, 130))], AHEAD, 1.0),
    ('a few beams', [Eye(ROUND, (-3, 0), (10, 13), (-50, -47))], AHEAD, 1.0),
    ('half, way back', [Eye(ROUND, (100, 179))], BACK, CRAWL_MPS / SPEED),
    ('ahead, way back', [Eye(ROUND, (-80, 80))], BACK, 1.0),
    ('half, way aside', [Eye(ROUND, (10, 60))], ASIDE, 0.0),
    ('right half, way aside', [Eye(ROUND, (-170, -10))], ASIDE, 1.0),
    ('beside, in a tight bend that way', [Eye(ROUND, (93, 115))], TIGHT, 0.0),
    ('beside, in a tight bend away', [Eye(ROUND, (-115, -93))], TIGHT, 1.0),
    # One that looks ahead and to the sides.
    ('right half', [Eye((-90, 90), (-90, -5))], AHEAD, 0.0),
    ('right half', [Eye((-135, 135), (-135, -30))], AHEAD, 0.0),
    ('both ends', [Eye((-90, 90), (-90, -83), (83, 90))], AHEAD, 1.0),
    ('a field that ends beside the middle', [Eye((-4, 135))], AHEAD, 0.0),
    # One that sees a sector ahead: nothing is asked for where it cannot look.
    ('bare', [Eye(KINECT)], AHEAD, 1.0),
    ('right half', [Eye(KINECT, (-28, -5))], AHEAD, 0.0),
    ('a pole', [Eye(KINECT, (8, 16))], AHEAD, 0.0),
    ('both ends', [Eye(KINECT, (-28, -22), (22, 28))], AHEAD, 1.0),
    ('bare', [kinect()], AHEAD, 1.0),
    ('right half', [kinect((-28, -5))], AHEAD, 0.0),
    ('a door too far to be measured', [kinect((2, 18))], AHEAD, 1.0),
    # Two, at the corners.
    ('bare', [Eye((-90, 90), mount=LEFT), Eye((-90, 90), mount=RIGHT)], AHEAD, 1.0),
    ('the right one', [Eye((-90, 90), mount=LEFT), Eye((-90, 90), (-90, 90), mount=RIGHT)],
     AHEAD, 0.0),
    ('where the other looks', [Eye((-110, 110), (-65, -45), mount=LEFT),
                               Eye((-110, 110), mount=RIGHT)], AHEAD, 1.0)]


def told_by_brake(eyes, no_return, velocity):
    brake = StickBrake(RADIUS_M, True)
    brake.ask(True)
    brake.move(HERE)
    for number, eye in enumerate(eyes):
        brake.see(scan_of(eye, no_return), 1.0, HERE, str(number))
    return tuple(brake.allow(Velocity(*velocity), 1.0 + AGE_S))


def scan_of(eye, no_return):
    ahead, left, turned = eye.mount
    return laser_scan(eye.ranges, (eye.first, math.radians(1.0)), eye.limits, no_return, RADIUS_M,
                      (Pose(ahead, left, turned), False))


def told_by_guard(eyes, no_return, velocity):
    sight = load(str(GUARD))['Sight'](RADIUS_M, [eye.mount for eye in eyes], no_return)
    sight.move((HERE.x_m, HERE.y_m, HERE.heading_rad), 1.0)
    for number, eye in enumerate(eyes):
        sight.see(eye.ranges, eye.first, math.radians(1.0), *eye.limits, 1.0, number)
    return sight.allow(velocity, 1.0 + AGE_S)


def told_by_task(eyes, no_return, velocity):
    run = RobotRun('bot1', Wish(velocity), Body(RADIUS_M, Limits(2.0, 2.0)), 0.0, 0.0)
    seen = Surroundings(RADIUS_M)
    for number, eye in enumerate(eyes):
        seen.see(scan_of(eye, no_return), HERE, 0.0, str(number))
    told = None
    for now_s, obeys in ((1.0, ''), (2.0, 'task'), (2.1, 'task')):
        told = run.tick(Facts(
            now_s, obeys=obeys, odometry_age_s=0.0, scan_age_s=AGE_S, looks=seen.looks(HERE),
            senses=Senses(now_s, HERE, HERE, HERE, seen.around(HERE), {}, np.zeros((0, 2)),
                          np.zeros((0, 2)))))
    assert run.state == (WAITING if told[::2] == (0.0, 0.0) else RUNNING)
    return tuple(told)


@pytest.mark.parametrize('told', [told_by_brake, told_by_guard, told_by_task])
@pytest.mark.parametrize('what, eyes, velocity, share', CASES, ids=lambda part: str(part)
                         if isinstance(part, (str, tuple)) else '')
def test_what_a_covered_laser_leaves(told, what, eyes, velocity, share):
    no_return = NAN_IS_NOTHING if eyes[0].limits[0] > RADIUS_M else {}
    linear, angular, lateral = velocity
    assert told(eyes, no_return, velocity) == pytest.approx(
        (share * linear, angular, share * lateral)), what
