# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A body on wheels: its response to velocity commands, and its wheel odometry."""
from dataclasses import dataclass
import math

from mhri.base.config import parse_yaml
from mhri.base.limits import Velocity, ZERO
from mhri.sim.plan import Colour, disc_distance, read_colour

_KEYS = ('radius_m', 'height_m', 'wheel_separation_m', 'accel_mps2', 'accel_rad_s2', 'brake_mps2',
         'watchdog_s', 'scan_min_m', 'scan_max_m')


@dataclass(frozen=True)
class BodyType:
    """Size [m], accelerations [m/s^2, rad/s^2], watchdog [s] and laser range [m] of a robot.

    ``colour`` (red, green, blue) is its colour in the pictures of other robots' cameras.
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

    :raises ConfigError: the text is invalid; the error names the file and the key
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
    """Measures the clearance around a round body.

    Fixed obstacles are only queried if they may be near: a measured distance excludes them
    within that radius.

    :param radius_m: of the body
    :param distance: function (x, y) -> metres to the nearest fixed obstacle
    :param others: function () -> array (n, 3) of x, y, radius [m] of moving bodies
    """

    _NEAR_M = 0.02

    def __init__(self, radius_m, distance, others):
        self._radius_m = radius_m
        self._distance = distance
        self._others = others
        self._measured = (0.0, 0.0, -math.inf)

    def room(self, x, y):
        """Return the gap [m] between the body at x, y and the nearest obstacle.

        It is negative if they overlap, and at most the true gap.
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
    """A robot in the plan: its true state, and the odometry of its wheels, which drifts.

    ``x, y, yaw`` are the true pose [m, m, rad]; ``odom_*`` the odometry, from 0 at the start;
    ``v, w, u`` the speed ahead, the turn rate and the speed to the left [m/s, rad/s, m/s], the
    last 0 unless the limits are holonomic. At rest the wheel noise is exactly zero: encoders do
    not tick.
    Faults: ``left_share`` is the part of a command that the left motor follows, 0 to 1; ``slip``
    the additional turn to the left due to the floor [rad/m], which the wheels do not measure.

    :param body_type: :class:`BodyType`
    :param limits: :class:`mhri.base.robot_types.Limits`, the limits of the motors
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
        self.v = self.w = self.u = 0.0
        self.forward_accel = 0.0
        self.odom_x = self.odom_y = self.odom_yaw = 0.0
        self.odom_v = self.odom_w = self.odom_u = 0.0
        self._bias = [1.0 + random.gauss(0.0, self.WHEEL_BIAS) for _ in range(2)]
        self._order = (ZERO, -math.inf)
        self.blocked = False
        self.left_share, self.slip = 1.0, 0.0
        self._powered = True

    @property
    def turn_rate(self):
        """The true turn rate [rad/s]: that of the wheels, plus the slip."""
        return self.w + self.v * self.slip

    def ahead(self, way_m):
        """Return the position (x, y) [m] at a distance ahead of its centre."""
        return self.x + way_m * math.cos(self.yaw), self.y + way_m * math.sin(self.yaw)

    def set_power(self, powered):
        """Switch the power of the motors; after switching on they stop until the next command."""
        self._powered = powered
        self._order = (ZERO, -math.inf)

    def command(self, v, w, now, u=0.0):
        """Accept a velocity command [m/s, rad/s, m/s] if it is finite; thread-safe.

        :returns: whether it was accepted
        """
        velocity, limits = Velocity(v, w, u if self._limits.holonomic else 0.0), self._limits
        if not velocity.is_finite() or not math.isfinite(u):
            return False
        if not self._powered:
            return True
        share = min(1.0, limits.linear_mps / (velocity.speed_mps or 1.0))
        # One assignment, so that a step never sees half a command.
        self._order = (velocity.slower(share)._replace(angular_rad_s=max(
            -limits.angular_rad_s, min(limits.angular_rad_s, w))), now)
        return True

    def step(self, dt, now):
        """Advance by ``dt`` seconds; without commands or power the base brakes."""
        (v, w, u), commanded_at = self._order
        v, w = self._by_motors(v, w)
        before = self.v
        if now - commanded_at > self.type.watchdog_s or not self._powered:
            brake = self.type.brake_mps2 * dt
            self.v, self.u = _approach(self.v, 0.0, brake), _approach(self.u, 0.0, brake)
            self.w = _approach(self.w, 0.0, 2.0 * brake / self.type.wheel_separation_m)
        else:
            step = self.type.accel_mps2 * dt
            self.v, self.u = _approach(self.v, v, step), _approach(self.u, u, step)
            self.w = _approach(self.w, w, self.type.accel_rad_s2 * dt)
        self._move(dt)
        self.forward_accel = (self.v - before) / dt
        self._roll(dt)

    def _by_motors(self, v, w):
        """Return the effective command if the left motor follows only a part of it."""
        if self.left_share == 1.0:
            return v, w
        half = 0.5 * self.type.wheel_separation_m
        left, right = (v - w * half) * self.left_share, v + w * half
        return 0.5 * (left + right), 0.5 * (right - left) / half

    def _move(self, dt):
        """Advance the true pose along the arc of this step, unless an obstacle is in the way.

        If robots overlap, after a collision within one step or at the start, every move that
        increases the clearance is allowed.
        """
        self.blocked = False
        turn = self.turn_rate * dt
        middle = self.yaw + 0.5 * turn
        if self.v or self.u:
            x = self.x + dt * (self.v * math.cos(middle) - self.u * math.sin(middle))
            y = self.y + dt * (self.v * math.sin(middle) + self.u * math.cos(middle))
            room = self._bumper.room(x, y)
            if room >= 0.0 or room > self._bumper.room(self.x, self.y):
                self.x, self.y = x, y
            else:
                self.blocked = True
                self.v = self.u = 0.0
        self.yaw = math.remainder(self.yaw + turn, 2.0 * math.pi)

    def _roll(self, dt):
        """Update the odometry for this step."""
        if not (self.v or self.w or self.u):
            self.odom_v = self.odom_w = self.odom_u = 0.0
            return
        half = 0.5 * self.type.wheel_separation_m
        left, right = (
            speed * self._bias[side] * (1.0 + self._random.gauss(0.0, self.WHEEL_NOISE))
            for side, speed in enumerate((self.v - self.w * half, self.v + self.w * half)))
        self.odom_v = 0.5 * (left + right)
        self.odom_w = (right - left) / self.type.wheel_separation_m
        self.odom_u = self.u and self.u * (1.0 + self._random.gauss(0.0, self.WHEEL_NOISE))
        middle = self.odom_yaw + 0.5 * self.odom_w * dt
        self.odom_x += dt * (self.odom_v * math.cos(middle) - self.odom_u * math.sin(middle))
        self.odom_y += dt * (self.odom_v * math.sin(middle) + self.odom_u * math.cos(middle))
        self.odom_yaw = math.remainder(self.odom_yaw + self.odom_w * dt, 2.0 * math.pi)
