# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A differential-drive body: how it obeys a velocity command, and what its wheels measure."""
from dataclasses import dataclass
import math

from mhri.base.config import parse_yaml
from mhri.sim.plan import Colour, disc_distance, read_colour

_KEYS = ('radius_m', 'height_m', 'wheel_separation_m', 'accel_mps2', 'accel_rad_s2', 'brake_mps2',
         'watchdog_s', 'scan_min_m', 'scan_max_m')


@dataclass(frozen=True)
class BodyType:
    """Size [m], accelerations [m/s^2, rad/s^2], watchdog [s] and laser range [m] of a robot.

    ``colour`` (red, green, blue) is how other robots' cameras see it.
    """

    radius_m: float
    height_m: float
    wheel_separation_m: float
    accel_mps2: float
    accel_rad_s2: float
    brake_mps2: float
    watchdog_s: float
    scan_min_m: float
    scan_max_m: float
    colour: Colour


def parse_bodies(text, origin):
    """Return {name: BodyType} of a YAML text.

    :raises ConfigError: names the file and the wrong key
    """
    top = parse_yaml(text, origin)
    bodies = {}
    for name, section in top.named_sections('bodies').items():
        bodies[name] = BodyType(colour=read_colour(section, 'colour'), **{
            key: section.number(key, 0.01, 100.0) for key in _KEYS})
        section.close()
    top.close()
    return bodies


class Bumper:
    """How much room there is around a round body.

    It asks for fixed things only if they may be near: a distance once measured rules them out for
    some way around.

    :param radius_m: of the body
    :param distance: function (x, y) -> metres to the nearest fixed thing
    :param others: function () -> array (n, 3) of x, y, radius [m] of what moves
    """

    _NEAR_M = 0.02

    def __init__(self, radius_m, distance, others):
        self._radius_m = radius_m
        self._distance = distance
        self._others = others
        self._measured = (0.0, 0.0, -math.inf)

    def room(self, x, y):
        """Return the gap [m] between the body, if it were at x, y, and what it would meet first.

        The gap is < 0 if they overlap, and never more than the true one.
        """
        measured_x, measured_y, distance = self._measured
        still = distance - math.hypot(x - measured_x, y - measured_y)
        if still < self._radius_m + self._NEAR_M:
            still = self._distance(x, y)
            self._measured = (x, y, still)
        return min(still, disc_distance(self._others(), x, y)) - self._radius_m


def _approach(value, target, step):
    """Return the value moved towards the target by at most one step."""
    return min(target, value + step) if target > value else max(target, value - step)


class Body:
    """A robot in the plan: the truth about it, and the odometry of its wheels, which drifts.

    ``x, y, yaw`` are the truth [m, m, rad]; ``odom_*`` what the wheels say, from 0 at the start;
    ``v, w`` the speeds [m/s, rad/s]. At rest the wheel noise is exactly zero: encoders do not tick.
    Faults: ``left_share`` is the part of a command that the left motor follows, 0 to 1; ``slip``
    the turn to the left that the floor adds [rad/m], which the wheels do not measure.

    :param body_type: :class:`BodyType`
    :param limits: :class:`mhri.base.robot_types.Limits`, the most that the motors do
    :param bumper: :class:`Bumper`
    :param random: :class:`random.Random`
    """

    WHEEL_NOISE = 0.02
    WHEEL_BIAS = 0.001

    def __init__(self, body_type, limits, pose, bumper, random):
        self.type = body_type
        self._limits = limits
        self._bumper = bumper
        self._random = random
        self.x, self.y, self.yaw = pose
        self.v = self.w = 0.0
        self.forward_accel = 0.0
        self.odom_x = self.odom_y = self.odom_yaw = 0.0
        self.odom_v = self.odom_w = 0.0
        self._bias = [1.0 + random.gauss(0.0, self.WHEEL_BIAS) for _ in range(2)]
        self._order = (0.0, 0.0, -math.inf)
        self.blocked = False
        self.left_share, self.slip = 1.0, 0.0
        self._powered = True

    @property
    def turn_rate(self):
        """The true turn rate [rad/s]: that of the wheels, and what the floor adds."""
        return self.w + self.v * self.slip

    def set_power(self, powered):
        """Switch the power of the motors; switched on again, they stand until commanded."""
        self._powered = powered
        self._order = (0.0, 0.0, -math.inf)

    def command(self, v, w, now):
        """Accept a velocity command [m/s, rad/s]; refuse one that is not finite.

        Call it on any thread, not only the one that steps.

        :returns: whether it was accepted
        """
        if not (math.isfinite(v) and math.isfinite(w)):
            return False
        if not self._powered:
            return True
        limits = self._limits
        # One assignment, so that a step never sees half a command.
        self._order = (max(-limits.linear_mps, min(limits.linear_mps, v)),
                       max(-limits.angular_rad_s, min(limits.angular_rad_s, w)), now)
        return True

    def step(self, dt, now):
        """Move on by ``dt`` seconds; the base brakes when commands or power are gone."""
        v, w, commanded_at = self._order
        v, w = self._by_motors(v, w)
        before = self.v
        if now - commanded_at > self.type.watchdog_s or not self._powered:
            brake = self.type.brake_mps2 * dt
            self.v = _approach(self.v, 0.0, brake)
            self.w = _approach(self.w, 0.0, 2.0 * brake / self.type.wheel_separation_m)
        else:
            self.v = _approach(self.v, v, self.type.accel_mps2 * dt)
            self.w = _approach(self.w, w, self.type.accel_rad_s2 * dt)
        self._move(dt)
        self.forward_accel = (self.v - before) / dt
        self._roll(dt)

    def _by_motors(self, v, w):
        """Return what becomes of a command if the left motor follows only a part of it."""
        if self.left_share == 1.0:
            return v, w
        half = 0.5 * self.type.wheel_separation_m
        left, right = (v - w * half) * self.left_share, v + w * half
        return 0.5 * (left + right), 0.5 * (right - left) / half

    def _move(self, dt):
        """Move the truth along the arc of this step, unless something is in the way.

        Two robots can meet within one step, or one can start inside another: then every move that
        makes more room is allowed.
        """
        self.blocked = False
        turn = self.turn_rate * dt
        middle = self.yaw + 0.5 * turn
        if self.v:
            x = self.x + self.v * dt * math.cos(middle)
            y = self.y + self.v * dt * math.sin(middle)
            room = self._bumper.room(x, y)
            if room >= 0.0 or room > self._bumper.room(self.x, self.y):
                self.x, self.y = x, y
            else:
                self.blocked = True
                self.v = 0.0
        self.yaw = math.remainder(self.yaw + turn, 2.0 * math.pi)

    def _roll(self, dt):
        """Let the wheels measure the step."""
        if not (self.v or self.w):
            self.odom_v = self.odom_w = 0.0
            return
        half = 0.5 * self.type.wheel_separation_m
        left, right = (
            speed * self._bias[side] * (1.0 + self._random.gauss(0.0, self.WHEEL_NOISE))
            for side, speed in enumerate((self.v - self.w * half, self.v + self.w * half)))
        self.odom_v = 0.5 * (left + right)
        self.odom_w = (right - left) / self.type.wheel_separation_m
        middle = self.odom_yaw + 0.5 * self.odom_w * dt
        self.odom_x += self.odom_v * dt * math.cos(middle)
        self.odom_y += self.odom_v * dt * math.sin(middle)
        self.odom_yaw = math.remainder(self.odom_yaw + self.odom_w * dt, 2.0 * math.pi)
