# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lost robots stay on the map: each where it was last, with the time, until it is removed."""
from dataclasses import replace
from datetime import datetime
from typing import Collection, Dict, Set

from mhri.base.geometry import Pose
from mhri.base.views import GONE, LIVE, RobotView, SILENT
from mhri.map.scene import MapRobot

# A robot that is connected, but silent for longer, is lost, too [s].
LOST_S = 5.0
TAKEN_OFF = 'lost, and taken off the map'


def lost_word(wall_s: float) -> str:
    """Return the label of a lost robot, e.g. "lost 19:23".

    :param wall_s: time of its last message [s since 1970]
    """
    try:
        return 'lost {:%H:%M}'.format(datetime.fromtimestamp(wall_s))
    except (ValueError, OverflowError, OSError):
        return 'lost'


class LastPlaces:
    """The last place of each robot in the frame of the map.

    A robot's own source of its place may end with it: tf and motion capture do after seconds.
    """

    def __init__(self) -> None:
        self._poses: Dict[str, Pose] = {}
        self._lost: Dict[str, str] = {}
        self._off: Set[str] = set()

    def update(self, robot: MapRobot, view: RobotView, wall_s: float) -> MapRobot:
        """Return a robot as it is drawn: a lost one at its last place, pale, with the time.

        :param wall_s: the time of day [s since 1970]
        """
        name, age_s = view.name, view.age_s or 0.0
        if view.link == LIVE:
            self._off.discard(name)
            self._lost.pop(name, None)
            if robot.pose is not None and not robot.old:
                self._poses[name] = robot.pose
            return robot
        if view.link != GONE and (view.link != SILENT or age_s < LOST_S):
            return robot
        # Kept, since the two clocks drift apart.
        word = self._lost.setdefault(name, lost_word(wall_s - age_s))
        if name in self._off:
            return replace(robot, pose=None, text=TAKEN_OFF, old=True, points=None)
        return replace(robot, pose=self._poses.get(name, robot.pose), lost=word, old=True,
                       points=None)

    def take_off(self, name: str) -> None:
        """Remove a lost robot from the map, until it is live again."""
        self._poses.pop(name, None)
        self._off.add(name)

    def keep(self, names: Collection[str]) -> None:
        """Forget every robot that is no longer in the list."""
        for name in {*self._poses, *self._lost, *self._off}.difference(names):
            self._poses.pop(name, None)
            self._lost.pop(name, None)
            self._off.discard(name)
