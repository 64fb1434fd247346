# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where robots are placed in the frame of the map, and what that rests on.

A robot's own odometry begins anywhere. Placed is a robot whose origin of odometry is known in the
frame of the map: its pose there is that origin, composed with its odometry. By priority it rests on
motion capture, on tf (``map`` to the frame of its odometry), or on the operator's hand.
"""
from dataclasses import dataclass
import math
from typing import List, Optional, Tuple

from mhri.base.mocap import Pose

NOT_PLACED, TF, MOTION_CAPTURE, HAND = '', 'tf', 'motion_capture', 'hand'
WORDS = {TF: 'tf', MOTION_CAPTURE: 'motion capture', HAND: 'hand'}
# A place that is older is no place [s]; one that is older than this has gone: the next one counts.
OLD_S, GONE_S = 0.5, 5.0
# Odometry that leaps further than this, and than a robot drives meanwhile, began anew.
LEAP_M, LEAP_RAD, FASTEST_MPS, FASTEST_RAD_S = 0.5, 1.0, 1.0, 4.0
# Nobody knows what happened to a robot in a silence of its odometry that is longer [s]; in the one
# that a restart of this program makes, for longer.
GAP_S, RESTART_S = 5.0, 30.0
# A place that moves by more against odometry is said [m], and the robot stands for so long [s].
CORRECTED_M, SETTLES_S = 1.0, 1.0
REMEDY = 'place it by hand on the map'


def composed(frame: Pose, pose: Pose) -> Pose:
    """Return a pose, given in a frame, in that frame's own frame."""
    cos, sin = math.cos(frame.heading_rad), math.sin(frame.heading_rad)
    return Pose(frame.x_m + cos * pose.x_m - sin * pose.y_m,
                frame.y_m + sin * pose.x_m + cos * pose.y_m,
                math.remainder(frame.heading_rad + pose.heading_rad, 2.0 * math.pi))


def inverse(pose: Pose) -> Pose:
    """Return where the frame of a pose lies, seen from the pose."""
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return Pose(-cos * pose.x_m - sin * pose.y_m, sin * pose.x_m - cos * pose.y_m,
                -pose.heading_rad)


@dataclass(frozen=True)
class Place:
    """What a robot's place rests on, that in a sentence, and its age [s], NaN where it has none.

    ``odometry`` is the origin of its odometry in the frame of the map, None: it is not placed.
    """

    by: str = NOT_PLACED
    text: str = 'it is not placed: ' + REMEDY
    age_s: float = math.nan
    odometry: Optional[Pose] = None

    @property
    def is_fresh(self) -> bool:
        """Tell whether it may be relied on now."""
        return self.odometry is not None and not self.age_s > OLD_S

    def pose(self, odometry: Optional[Pose]) -> Optional[Pose]:
        """Return the robot's pose in the frame of the map, None where that is not known."""
        if self.odometry is None or odometry is None:
            return None
        return composed(self.odometry, odometry)


@dataclass(frozen=True)
class Odometry:
    """A pose by odometry, when it was heard, and its number at the publisher, None for none."""

    pose: Pose
    at_s: float
    number: Optional[int] = None

    def problem(self, before: 'Odometry', gap_s: float) -> str:
        """Return why it cannot go on from an earlier one, '' where it can."""
        after_s = max(0.0, self.at_s - before.at_s)
        moved_m = math.hypot(self.pose.x_m - before.pose.x_m, self.pose.y_m - before.pose.y_m)
        turned = abs(math.remainder(self.pose.heading_rad - before.pose.heading_rad,
                                    2.0 * math.pi))
        if moved_m > LEAP_M + FASTEST_MPS * after_s \
                or turned > LEAP_RAD + FASTEST_RAD_S * after_s:
            return 'its odometry jumped'
        if self.number is not None and before.number is not None and self.number < before.number:
            return 'its odometry began anew'
        return 'its odometry was silent for {:.0f} s'.format(after_s) if after_s > gap_s else ''


class RobotPlace:
    """The place of one robot, from what is heard of it.

    What the hand has placed is relative to odometry::

        state      put         odometry that cannot go on  take_back  resume
        not put    put         not put                     not put    put
        put        put anew    lost                        not put    (as it is)
        lost       put         lost                        not put    (as it is)

    Times are those of one clock [s].
    """

    def __init__(self) -> None:
        self.odometry: Optional[Odometry] = None
        self._gap_s = GAP_S
        # When motion capture was heard last.
        self.seen_at: Optional[float] = None
        self._captured: Optional[Tuple[Pose, float]] = None
        self._tf: Optional[Tuple[Pose, Optional[float]]] = None
        self._no_tf = ''
        self.hand: Optional[Pose] = None
        self._lost = ''

    def drive(self, odometry: Odometry) -> None:
        """Take in what its odometry says; what cannot go on from the last takes away the hand's."""
        problem = odometry.problem(self.odometry, self._gap_s) if self.odometry else ''
        if problem and self.hand is not None:
            self.hand, self._lost = None, 'it was placed by hand, but {}: place it again'.format(
                problem)
        self.odometry, self._gap_s = odometry, GAP_S

    def capture(self, pose: Pose, at_s: float) -> None:
        """Take in its pose by motion capture, which counts from the first odometry on."""
        self.seen_at = at_s
        if self.odometry is not None:
            self._captured = (composed(pose, inverse(self.odometry.pose)), at_s)

    def see_tf(self, origin: Optional[Pose], at_s: Optional[float] = None,
               problem: str = '') -> None:
        """Take in the origin of its odometry by tf, None with the reason.

        :param at_s: None: it does not grow old
        """
        if origin is not None:
            self._tf = (origin, at_s)
        self._no_tf = '' if origin is not None else problem

    def forget_tf(self, problem: str) -> None:
        """Do without tf at once, for a reason."""
        self._tf, self._no_tf = None, problem

    def put(self, pose: Pose, now_s: float) -> str:
        """Place it by hand where it is now; return why that cannot be, '' if it is done."""
        rests = self.place(now_s)
        if rests.by in (MOTION_CAPTURE, TF):
            return 'it is placed by {} already{}'.format(
                WORDS[rests.by], ': correct its localisation instead' if rests.by == TF else '')
        if self.odometry is None or now_s - self.odometry.at_s > GAP_S:
            return 'its odometry is not heard: it cannot be placed by hand'
        self.hand = composed(pose, inverse(self.odometry.pose))
        self._lost = ''
        return ''

    def take_back(self) -> None:
        """Forget what the hand has placed."""
        self.hand, self._lost = None, ''

    def resume(self, origin: Pose, odometry: Pose, at_s: float) -> None:
        """Place it as the hand had, before this program was started again."""
        if self.odometry is None and self.hand is None:
            self.hand, self.odometry = origin, Odometry(odometry, at_s)
            self._gap_s = RESTART_S

    def place(self, now_s: float) -> Place:
        """Return what its place rests on now."""
        for by, found in ((MOTION_CAPTURE, self._captured), (TF, self._tf)):
            if found is None:
                continue
            origin, at_s = found
            age_s = math.nan if at_s is None else max(0.0, now_s - at_s)
            if not age_s > GONE_S:
                text = 'by ' + WORDS[by]
                if age_s > OLD_S:
                    text += ', which has said nothing for {:.1f} s'.format(age_s)
                return Place(by, text, age_s, origin)
        if self.hand is not None:
            return Place(HAND, 'by hand', math.nan, self.hand)
        if self._lost:
            return Place(text=self._lost)
        if self.odometry is None:
            return Place(text='it is not placed: its odometry is not heard')
        return Place(text='it is not placed: {}{}'.format(
            self._no_tf + ': ' if self._no_tf else '', REMEDY))


def tf_problem(frame: str, odometry_frame: str, frames: List[str]) -> str:
    """Return why tf cannot place a robot, '' where it might.

    :param frame: that of the map
    :param odometry_frame: of this robot's odometry, '' for none
    :param frames: the same of all robots
    """
    if not odometry_frame:
        return 'its odometry names no frame'
    if frames.count(odometry_frame) > 1:
        return 'several robots call the frame of their odometry {}'.format(odometry_frame[:60])
    if odometry_frame == frame:
        return 'its odometry says that it is the map'
    return ''


class Corrections:
    """Watches the place of one robot on its way, which its localisation may correct."""

    def __init__(self) -> None:
        self._origin: Optional[Pose] = None
        self._until_s = -math.inf
        self._text = ''

    def settling(self, place: Place, odometry: Pose, now_s: float) -> str:
        """Return in words that its place was just corrected by far, '' where it was not."""
        before, self._origin = self._origin, place.odometry
        if before is not None and place.odometry is not None:
            was, now = composed(before, odometry), composed(place.odometry, odometry)
            moved_m = math.hypot(now.x_m - was.x_m, now.y_m - was.y_m)
            if moved_m > CORRECTED_M:
                self._text = 'its place was corrected by {:.1f} m'.format(moved_m)
                self._until_s = now_s + SETTLES_S
        return self._text if now_s < self._until_s else ''
