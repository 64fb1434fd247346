# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The link of a robot: its motion, and whether it still sends data."""
import math
from dataclasses import dataclass
from typing import Optional, Sequence

from mhri.base.geometry import Pose, rotation_words
from mhri.base.plausible import ANGLE, ANGULAR_VELOCITY, can_be, PLACE, QUATERNION, sifted, SPEED
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.base.views import GONE, LIVE, SILENT, WAITING

STANDSTILL_MPS = 0.01
STANDSTILL_RAD_S = 0.03
# A longer silence is named by its beginning [s].
LONG_S = 60.0
_KINDS = (SPEED, ANGULAR_VELOCITY, PLACE, PLACE, ANGLE, SPEED)


@dataclass(frozen=True)
class Motion:
    """A robot's motion by its own odometry: m/s, rad/s, m, m, rad in its ``odom`` frame.

    ``heading_rad`` is None if its odometry gives no orientation. ``lateral_mps`` is its speed to
    the left [m/s], for a robot that slides or can drive sideways. ``problem`` names an impossible
    value (:mod:`mhri.base.plausible`), which is NaN here, or the orientation that is none; None if
    all are possible.
    """

    linear_mps: float
    angular_rad_s: float
    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: Optional[float] = 0.0
    lateral_mps: float = 0.0
    problem: Optional[str] = None

    @classmethod
    def reported(cls, *values: float, turn: Sequence[float] = ()) -> 'Motion':
        """Return the motion of six reported values, in the order of the fields above.

        :param turn: the quaternion of the heading, () if it is not from one
        """
        (linear, angular, x_m, y_m, heading, lateral), problem = sifted(_KINDS, values)
        _, twisted = sifted((QUATERNION,) * len(turn), turn)
        given: Optional[float] = math.nan if twisted else heading
        if turn and not twisted and math.isnan(heading):
            given, problem = None, problem or rotation_words(*turn)
        return cls(linear, angular, x_m, y_m, given, lateral, problem or twisted)

    @property
    def pose(self) -> Optional[Pose]:
        """Its pose, None unless its heading is known and all values are possible."""
        if self.heading_rad is None or not self.is_possible():
            return None
        return Pose(self.x_m, self.y_m, self.heading_rad)

    @property
    def note(self) -> str:
        """What is wrong with it, for the operator; '' if nothing is."""
        if not self.problem:
            return ''
        if self.heading_rad is None:
            return 'no heading: its odometry has an {}; its driver has to send one of length ' \
                '1'.format(self.problem)
        return 'its odometry has an impossible {}'.format(self.problem)

    @property
    def speed_mps(self) -> float:
        """Its speed in any direction [m/s, >= 0]."""
        return math.hypot(self.linear_mps, self.lateral_mps)

    def is_possible(self) -> bool:
        """Return whether all values are possible for a robot; it may be without a heading."""
        return all(map(can_be, _KINDS, (
            self.linear_mps, self.angular_rad_s, self.x_m, self.y_m,
            0.0 if self.heading_rad is None else self.heading_rad, self.lateral_mps)))

    def is_standstill(self) -> bool:
        """Return whether the speeds are those of a robot at rest.

        The thresholds are above the noise of wheel odometry at rest (which is zero, since encoders
        do not tick) and far below the slowest speed an operator can see.
        """
        return (self.is_possible() and self.speed_mps <= STANDSTILL_MPS
                and abs(self.angular_rad_s) <= STANDSTILL_RAD_S)


def link_state(age_s: Optional[float], connections: int, silent_after_s: float = SILENT_AFTER_S,
               reached: bool = False) -> str:
    """Return the state of a robot's link.

    :param age_s: age of its newest message [s], None if there was none
    :param connections: number of open connections to its streams
    :param silent_after_s: its messages may be this far apart [s]; 0: silence is ignored while a
        connection is open
    :param reached: whether a node of the robot subscribes commands; the only evidence for a robot
        without odometry
    :returns: WAITING, LIVE, SILENT or GONE
    """
    if age_s is not None and age_s <= (silent_after_s or SILENT_AFTER_S):
        return LIVE
    if connections:
        if not silent_after_s:
            return LIVE
        return SILENT if age_s is not None else WAITING
    if age_s is None:
        return LIVE if reached else WAITING
    return GONE


def link_note(state: str, age_s: Optional[float], heard_at: str, waited_s: float,
              no_odometry: str = '') -> str:
    """Return a note for the operator about a link; '' if all is well.

    :param heard_at: local time of the newest message as text, e.g. '14:02:11'
    :param waited_s: how long the robot has been in the list [s]
    :param no_odometry: what there is in place of its odometry, '' for nothing
    """
    if state == LIVE and age_s is None:
        return 'sends no odometry: ' + (no_odometry or 'mhri cannot tell whether it moves')
    if state == SILENT and age_s is not None:
        return 'nothing since {}'.format(heard_at) if age_s >= LONG_S \
            else 'nothing for {:.1f} s'.format(age_s)
    if state == GONE:
        return 'switched off or out of reach; last heard {}'.format(heard_at)
    if state == WAITING and waited_s > 3.0:
        return 'nothing heard yet: check its power and its name'
    return ''
