# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All lasers of one robot: each for the map, together for the robot's own view."""
from mhri.robots.ros.tf_feed import SHARED
from mhri.sensors.all_round import all_round, Sweep, turned
from mhri.sensors.nearest import OLD_S
from mhri.sensors.ros.mounts import Mounts, NoPlace
from mhri.sensors.ros.scan_feed import ScanFeed


class Lasers:
    """The scans of a robot's lasers, and where these sit, between :meth:`open` and :meth:`close`.

    :param robot: the robot's name (namespace)
    :param robot_type: its :class:`mhri.base.robot_types.RobotType`
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the lasers of a robot, None for a type without a laser scanner."""
        return cls(robot, kind) if getattr(kind, key) else None

    def __init__(self, robot, robot_type):
        self._mounts = Mounts(robot_type, SHARED)
        self._feeds = [ScanFeed(robot, [topic], no_return=robot_type.no_return)
                       for topic in robot_type.scan]
        self._newest = {}

    def open(self):
        """Start listening (blocking: it asks the master)."""
        SHARED.open(self)
        for feed in self._feeds:
            feed.open()

    def close(self):
        """Stop listening and forget (blocking: it asks the master)."""
        for feed in self._feeds:
            feed.close()
        SHARED.close(self)
        self._newest = {}

    def refused(self):
        """Return the number of impossible scans left out."""
        return sum(feed.refused() for feed in self._feeds)

    def age_s(self):
        """Return the age of the newest scan [s], None before the first."""
        return min((age_s for age_s in (feed.age_s() for feed in self._feeds)
                    if age_s is not None), default=None)

    def each(self, frames):
        """Return the new scans: {number of the laser: (scan, its age [s], its mount)}.

        Those of a laser of which nobody says where it sits are left out.

        :param frames: :class:`mhri.base.tf_tree.OdometryFrames` of the robot
        :returns: scans as :class:`mhri.sensors.all_round.Sweep`, mounts as
            :meth:`Mounts.laser` has them
        """
        self._mounts.frames = frames
        found = {}
        for number, feed in enumerate(self._feeds):
            scan = feed.take()
            if scan is None:
                continue
            try:
                mount = self._mounts.laser(feed.frame, number)
            except NoPlace as problem:
                feed.note(problem, NoPlace.verdict)
                continue
            found[number] = (Sweep(*scan), feed.age_s() or 0.0, mount)
        return found

    def take(self, frames):
        """Return what all of them see as one :class:`Sweep`, None if nothing is new.

        One laser's distances are measured from itself, those of several from the robot's middle.
        A laser that is silent for longer than a view is new says nothing.

        :param frames: as :meth:`each` has them
        """
        new = self.each(frames)
        if not new:
            return None
        self._newest.update({number: (scan, mount) for number, (scan, _, mount) in new.items()})
        ages = [feed.age_s() for feed in self._feeds]
        seen = [found for number, found in self._newest.items()
                if number in new or (ages[number] is not None and ages[number] <= OLD_S)]
        return turned(*seen[0]) if len(seen) == 1 else all_round(seen)
