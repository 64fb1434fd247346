# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All lasers of one robot: each for the map, together for the robot's own view."""
from mhri.robots.ros.tf_feed import SHARED
from mhri.sensors.all_round import all_round, turned
from mhri.sensors.nearest import OLD_S
from mhri.sensors.ros.beams import read_sweep, SCAN
from mhri.sensors.ros.mounts import Mounts, NoPlace


class Lasers:
    """The scans of a robot's lasers with their mounts, between :meth:`open` and :meth:`close`.

    :param robot: the robot's name (namespace)
    :param robot_type: its :class:`mhri.base.robot_types.RobotType`
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the lasers of a robot, None for a type without a laser scanner."""
        return cls(robot, kind) if getattr(kind, key) else None

    def __init__(self, robot, robot_type):
        self._mounts = Mounts(robot_type, SHARED)
        self._scans = SCAN.stream(robot, robot_type)
        self._newest = {}

    def open(self):
        """Subscribe (blocking: it asks the master)."""
        SHARED.open(self)
        self._scans.open()

    def close(self):
        """Unsubscribe, and forget all scans (blocking: it asks the master)."""
        self._scans.close()
        SHARED.close(self)
        self._newest = {}

    def refused(self):
        """Return the number of impossible scans left out."""
        return self._scans.refused()

    def age_s(self):
        """Return the age of the newest scan [s], None before the first."""
        return self._scans.age_s()

    def each(self, frames):
        """Return the new scans: {number of the laser: (scan, its age [s], its mount)}.

        Scans of a laser with an unknown mount are left out.

        :param frames: :class:`mhri.base.tf_tree.OdometryFrames` of the robot
        :returns: scans as :class:`mhri.sensors.all_round.Sweep`, mounts as from
            :meth:`Mounts.laser`
        """
        self._mounts.frames = frames
        found = {}
        for message, _, number in self._scans.take_each():
            try:
                mount = self._mounts.laser(message.header.frame_id, number)
            except NoPlace as problem:
                self._scans.note(problem, NoPlace.verdict, number)
                continue
            found[number] = (read_sweep(message, self._mounts.robot_type.no_return),
                             self._scans.age_s(number) or 0.0, mount)
        return found

    def take(self, frames):
        """Return the scans of all lasers as one :class:`Sweep`, None if nothing is new.

        The distances of a single laser are from the laser, those of several from the robot's
        centre. A laser that has been silent for too long is left out.

        :param frames: as for :meth:`each`
        """
        new = self.each(frames)
        if not new:
            return None
        self._newest.update({number: (scan, mount) for number, (scan, _, mount) in new.items()})
        seen = [found for number, found in self._newest.items()
                if number in new or (
                    (age_s := self._scans.age_s(number)) is not None and age_s <= OLD_S)]
        return turned(*seen[0]) if len(seen) == 1 else all_round(seen)
