# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All lasers of one robot: each for the map, together for the robot's own view."""
import time

from mhri.core.sensors.all_round import all_round, Sweep, turned
from mhri.core.sensors.nearest import OLD_S
from mhri.ros.map.tf_feed import TfFeed
from mhri.ros.sensors.mounts import Mounts
from mhri.ros.sensors.scan_feed import ScanFeed


class Lasers:
    """The scans of a robot's lasers, and where these sit, between :meth:`open` and :meth:`close`.

    :param robot: the robot's name (namespace)
    :param robot_type: its :class:`mhri.core.robots.robot_types.RobotType`
    :param frames: :class:`mhri.ros.map.tf_feed.TfFeed` that somebody else opens and closes; None:
        one of its own
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the lasers of a robot, None for a type without a laser scanner."""
        return cls(robot, kind) if getattr(kind, key) else None

    def __init__(self, robot, robot_type, frames=None):
        # Lasers sit still on their robots: what moves is not listened to.
        self._own = None if frames else TfFeed(time.monotonic, moving=False)
        self._mounts = Mounts(robot_type, frames or self._own)
        self._feeds = [ScanFeed(robot, [topic]) for topic in robot_type.scan]
        self._newest = {}

    def open(self):
        """Start listening (blocking: it asks the master)."""
        if self._own:
            self._own.open()
        for feed in self._feeds:
            feed.open()

    def close(self):
        """Stop listening and forget (blocking: it asks the master)."""
        for feed in self._feeds:
            feed.close()
        if self._own:
            self._own.close()
        self._newest = {}

    def refused(self):
        """Return the number of impossible scans left out."""
        return sum(feed.refused() for feed in self._feeds)

    def age_s(self):
        """Return the age of the newest scan [s], None before the first."""
        return min((age_s for age_s in (feed.age_s() for feed in self._feeds)
                    if age_s is not None), default=None)

    def each(self, base):
        """Return the new scans: {number of the laser: (scan, its age [s], its mount)}.

        :param base: the robot's own frame, '' where it is not known
        :returns: scans as :class:`mhri.core.sensors.all_round.Sweep`, mounts as
            :meth:`Mounts.laser` has them
        """
        self._mounts.base = base
        found = {}
        for number, feed in enumerate(self._feeds):
            scan = feed.take()
            if scan is not None:
                found[number] = (Sweep(*scan), feed.age_s() or 0.0,
                                 self._mounts.laser(feed.frame))
        return found

    def take(self, base):
        """Return what all of them see as one :class:`Sweep`, None if nothing is new.

        One laser's distances are measured from itself, those of several from the robot's middle.
        A laser that is silent for longer than a view is new says nothing.

        :param base: the robot's own frame, '' where it is not known
        """
        new = self.each(base)
        if not new:
            return None
        self._newest.update({number: (scan, mount) for number, (scan, _, mount) in new.items()})
        ages = [feed.age_s() for feed in self._feeds]
        seen = [found for number, found in self._newest.items()
                if number in new or (ages[number] is not None and ages[number] <= OLD_S)]
        return turned(*seen[0]) if len(seen) == 1 else all_round(seen)
