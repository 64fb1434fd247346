# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The places of robots in the frame of the map, and their sources.

A robot's odometry starts anywhere. A robot is placed if the origin of its odometry is known in the
frame of the map: its pose there is that origin, composed with its odometry. Sources by priority are
motion capture, tf (``map`` to the frame of its odometry), and placing by hand.
"""
from dataclasses import dataclass
import math
from typing import List, Optional, Tuple

from mhri.base.geometry import composed, inverse, Pose

NOT_PLACED, TF, MOTION_CAPTURE, HAND = '', 'tf', 'motion_capture', 'hand'
WORDS = {TF: 'tf', MOTION_CAPTURE: 'motion capture', HAND: 'hand'}
# An older place is unusable [s]; beyond the second age its source is gone, and the next applies.
OLD_S, GONE_S = 0.5, 5.0
# Odometry has restarted if it jumps by more than this, and by more than a robot can drive.
LEAP_M, LEAP_RAD, FASTEST_MPS, FASTEST_RAD_S = 0.5, 1.0, 1.0, 4.0
# After a longer silence of odometry the robot may have been moved [s]; a restart of this program
# may take longer.
GAP_S, RESTART_S = 5.0, 30.0
# A larger correction of a place is reported [m], and the robot stops for this time [s].
CORRECTED_M, SETTLES_S = 1.0, 1.0
REMEDY = 'place it by hand on the map'


@dataclass(frozen=True)
class Place:
    """The source of a robot's place, a sentence about it, and its age [s], NaN if it does not age.

    ``odometry`` is the origin of its odometry in the frame of the map, None if it is not placed.
    """

    by: str = NOT_PLACED
    text: str = 'it is not placed: ' + REMEDY
    age_s: float = math.nan
    odometry: Optional[Pose] = None

    @property
    def is_fresh(self) -> bool:
        """Return whether it is usable now."""
        return self.odometry is not None and not self.age_s > OLD_S

    def pose(self, odometry: Optional[Pose]) -> Optional[Pose]:
        """Return the robot's pose in the frame of the map, None if unknown."""
        if self.odometry is None or odometry is None:
            return None
        return composed(self.odometry, odometry)


@dataclass(frozen=True)
class Odometry:
    """A pose by odometry, its time of receipt, and its number at the publisher or None."""

    pose: Pose
    at_s: float
    number: Optional[int] = None

    def problem(self, before: 'Odometry', gap_s: float) -> str:
        """Return why it does not continue an earlier one, '' if it does."""
        after_s = max(0.0, self.at_s - before.at_s)
        moved_m = math.hypot(self.pose.x_m - before.pose.x_m, self.pose.y_m - before.pose.y_m)
        turned = abs(math.remainder(self.pose.heading_rad - before.pose.heading_rad,
                                    2.0 * math.pi))
        if moved_m > LEAP_M + FASTEST_MPS * after_s \
                or turned > LEAP_RAD + FASTEST_RAD_S * after_s:
            return 'its odometry jumped'
        if self.number is not None and before.number is not None and self.number < before.number:
            return 'its odometry restarted'
        return 'its odometry was silent for {:.0f} s'.format(after_s) if after_s > gap_s else ''


class RobotPlace:
    """The place of one robot, from all sources.

    Placement by hand is relative to odometry::

        state      put         discontinuous odometry      take_back  resume
        not put    put         not put                     not put    put
        put        replaced    lost                        not put    unchanged
        lost       put         lost                        not put    unchanged

    Times are those of one clock [s].
    """

    def __init__(self) -> None:
        self.odometry: Optional[Odometry] = None
        #: what is wrong with it, '' if nothing
        self.odometry_note = ''
        self._gap_s = GAP_S
        # Time of the last motion capture.
        self.seen_at: Optional[float] = None
        self._captured: Optional[Tuple[Pose, float]] = None
        self._tf: Optional[Tuple[Pose, Optional[float]]] = None
        self._no_tf = ''
        self.hand: Optional[Pose] = None
        self._lost = ''

    def drive(self, odometry: Odometry) -> None:
        """Handle odometry; if it does not continue the last, the placement by hand is lost."""
        problem = odometry.problem(self.odometry, self._gap_s) if self.odometry else ''
        if problem and self.hand is not None:
            self.hand, self._lost = None, 'it was placed by hand, but {}: place it again'.format(
                problem)
        self.odometry, self._gap_s = odometry, GAP_S

    def capture(self, pose: Pose, at_s: float) -> None:
        """Handle its pose by motion capture, which is used once there is odometry."""
        self.seen_at = at_s
        if self.odometry is not None:
            self._captured = (composed(pose, inverse(self.odometry.pose)), at_s)

    def update_tf(self, origin: Optional[Pose], at_s: Optional[float] = None,
                  problem: str = '') -> None:
        """Handle the origin of its odometry by tf, None with a reason if tf lacks it.

        :param at_s: time of receipt, None if it does not age
        """
        if origin is not None:
            self._tf = (origin, at_s)
        self._no_tf = '' if origin is not None else problem

    def forget_tf(self, problem: str) -> None:
        """Discard the origin by tf, for a reason."""
        self._tf, self._no_tf = None, problem

    def put(self, pose: Pose, now_s: float) -> str:
        """Place it by hand; return the problem, '' on success."""
        rests = self.place(now_s)
        if rests.by in (MOTION_CAPTURE, TF):
            return 'it is placed by {} already{}'.format(
                WORDS[rests.by], ': correct its localisation instead' if rests.by == TF else '')
        if self.odometry is None or now_s - self.odometry.at_s > GAP_S:
            return self._no_odometry() + ', so it cannot be placed by hand'
        self.hand = composed(pose, inverse(self.odometry.pose))
        self._lost = ''
        return ''

    def _no_odometry(self) -> str:
        return self.odometry_note or 'it has no odometry'

    def take_back(self) -> None:
        """Remove the placement by hand."""
        self.hand, self._lost = None, ''

    def resume(self, origin: Pose, odometry: Pose, at_s: float) -> None:
        """Restore the placement by hand after a restart of this program."""
        if self.odometry is None and self.hand is None:
            self.hand, self.odometry = origin, Odometry(odometry, at_s)
            self._gap_s = RESTART_S

    def place(self, now_s: float) -> Place:
        """Return its present place."""
        for by, found in ((MOTION_CAPTURE, self._captured), (TF, self._tf)):
            if found is None:
                continue
            origin, at_s = found
            age_s = math.nan if at_s is None else max(0.0, now_s - at_s)
            if not age_s > GONE_S:
                text = 'by ' + WORDS[by]
                if age_s > OLD_S:
                    text += ', without data for {:.1f} s'.format(age_s)
                return Place(by, text, age_s, origin)
        if self.hand is not None:
            return Place(HAND, 'by hand', math.nan, self.hand)
        if self._lost:
            return Place(text=self._lost)
        if self.odometry is None:
            return Place(text='it is not placed: ' + self._no_odometry())
        return Place(text='it is not placed: {}{}'.format(
            self._no_tf + ': ' if self._no_tf else '', REMEDY))


def tf_problem(frame: str, odometry_frame: str, frames: List[str]) -> str:
    """Return why tf cannot place a robot, '' if it can.

    :param frame: frame of the map
    :param odometry_frame: frame of this robot's odometry, '' if unknown
    :param frames: frames of the odometry of all robots
    """
    if not odometry_frame:
        return 'its odometry names no frame'
    if frames.count(odometry_frame) > 1:
        return 'several robots use the odometry frame {}'.format(odometry_frame[:60])
    if odometry_frame == frame:
        return 'its odometry uses the frame of the map'
    return ''


class Corrections:
    """Detects corrections of a robot's place by its localisation."""

    def __init__(self) -> None:
        self._origin: Optional[Pose] = None
        self._until_s = -math.inf
        self._text = ''

    def settling(self, place: Place, odometry: Pose, now_s: float) -> str:
        """Return a sentence if its place was just corrected by far, else ''."""
        before, self._origin = self._origin, place.odometry
        if before is not None and place.odometry is not None:
            was, now = composed(before, odometry), composed(place.odometry, odometry)
            moved_m = math.hypot(now.x_m - was.x_m, now.y_m - was.y_m)
            if moved_m > CORRECTED_M:
                self._text = 'its place was corrected by {:.1f} m'.format(moved_m)
                self._until_s = now_s + SETTLES_S
        return self._text if now_s < self._until_s else ''
