# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The state of a robot's obstacle brake, for its row and its tile, and its description."""
import math
from dataclasses import dataclass

from mhri.base.reasons import NO_PLACE, NO_SCAN, SLOWS, UNSEEN

# States of the brake. UNSEEN: no sensor covers that direction, so the robot crawls back or stops;
# NO_SCAN: no recent scan of laser or depth camera, so no motion forward; NO_PLACE: the pose of a
# laser is unknown, so the robot moves only where others cover; CANNOT: robots of this type have no
# such sensor, so they are driven without a brake.
OFF, ON, CANNOT = '', 'on', 'cannot'
WORDS = (OFF, ON, SLOWS, UNSEEN, NO_SCAN, NO_PLACE, CANNOT)


@dataclass(frozen=True)
class BrakeView:
    """The state of the brake: one of :data:`WORDS`.

    ``free_way_m`` is the distance to the obstacle that slows the robot down [m], NaN without one.
    ``on_robot`` is true if the brake is that of its guard. ``back_after_s`` is the time without a
    link after which the robot drives back by itself [s], 0 for never.
    """

    word: str = ''
    free_way_m: float = math.nan
    on_robot: bool = False
    back_after_s: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether the brake may keep the robot still while the stick is deflected."""
        return self.word in (SLOWS, UNSEEN, NO_SCAN, NO_PLACE)


def brake_words(brake: BrakeView) -> str:
    """Describe the brake's state for the operator, '' if there is nothing to report."""
    if brake.word == SLOWS:
        if not math.isfinite(brake.free_way_m):
            return 'brake: slows for something ahead'
        return 'brake: slows for something {:.1f} m ahead'.format(brake.free_way_m)
    return {NO_SCAN: 'brake: no laser or depth data, no way forward',
            UNSEEN: 'brake: slow, it does not see that way',
            NO_PLACE: 'brake: place of a laser unknown, no way that no other sees',
            CANNOT: 'no brake: it has no laser or depth camera'}.get(brake.word, '')


def guard_words(brake: BrakeView) -> str:
    """Describe the autonomous functions of the guard on a robot, '' for none."""
    return ', '.join(filter(None, ('brakes by itself' if brake.on_robot else '',
                                   back_words(brake))))


def back_words(brake: BrakeView) -> str:
    """Describe when a robot drives back by itself, '' if it stays in place."""
    if brake.back_after_s <= 0.0:
        return ''
    return 'goes back alone after {:g} s without a link'.format(brake.back_after_s)
