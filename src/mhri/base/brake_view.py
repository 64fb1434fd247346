# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's obstacle brake does, for its row and its tile, and in words."""
import math
from dataclasses import dataclass

# What it does. UNSEEN: nothing looks that way, so it crawls back, or does not go; NO_SCAN: nothing
# fresh from laser or depth camera, so no way forward; NO_PLACE: nobody says where a laser sits, so
# it goes only where others look; CANNOT: robots of this type have neither, it is driven without a
# brake.
OFF, ON, SLOWS, UNSEEN = '', 'on', 'slows', 'unseen'
NO_SCAN, NO_PLACE, CANNOT = 'no_scan', 'no_place', 'cannot'
WORDS = (OFF, ON, SLOWS, UNSEEN, NO_SCAN, NO_PLACE, CANNOT)


@dataclass(frozen=True)
class BrakeView:
    """What the brake does: one of :data:`WORDS`.

    ``free_way_m`` is the way to what slows the robot down [m], NaN while nothing does. ``on_robot``
    is true where the brake is that of its guard. ``back_after_s`` is after how long without a link
    the robot goes back by itself [s], 0 for never.
    """

    word: str = ''
    free_way_m: float = math.nan
    on_robot: bool = False
    back_after_s: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether it may keep the robot still though the stick is held."""
        return self.word in (SLOWS, UNSEEN, NO_SCAN, NO_PLACE)


def brake_words(brake: BrakeView) -> str:
    """Return what an operator has to know of the brake, '' for nothing."""
    if brake.word == SLOWS:
        if not math.isfinite(brake.free_way_m):
            return 'brake: slows for something ahead'
        return 'brake: slows for something {:.1f} m ahead'.format(brake.free_way_m)
    return {NO_SCAN: 'brake: no laser or depth data, no way forward',
            UNSEEN: 'brake: slow, it does not see that way',
            NO_PLACE: 'brake: place of a laser unknown, no way that no other sees',
            CANNOT: 'no brake: it has no laser or depth camera'}.get(brake.word, '')


def standing_words(brake: BrakeView) -> str:
    """Return why the brake keeps a robot still, and what to do; '' where it does not."""
    if not brake.holds:
        return ''
    if brake.word == NO_SCAN:
        return 'brake: no laser or depth data: back away, or switch the brake off'
    if brake.word == NO_PLACE:
        return 'brake: place of a laser unknown: name it in tf or in the type, or switch the ' \
               'brake off'
    if brake.word == UNSEEN:
        return 'brake: it does not see that way: turn less, or turn to it first'
    return 'brake: something is in the way: back away or turn'


def guard_words(brake: BrakeView) -> str:
    """Return what the guard on a robot does by itself, '' for nothing."""
    return ', '.join(filter(None, ('brakes by itself' if brake.on_robot else '',
                                   back_words(brake))))


def back_words(brake: BrakeView) -> str:
    """Return that a robot would go back by itself, '' where it stays."""
    if brake.back_after_s <= 0.0:
        return ''
    return 'goes back alone after {:g} s without a link'.format(brake.back_after_s)
