# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robots of the screen: their types and monitors, managed off the GUI thread."""
import threading
import time

import rospy

from mhri.base.names import topic_of
from mhri.base.views import GONE, RobotView, WAITING
from mhri.graph.ros.master_api import MasterError
from mhri.robots.link_quality import LinkQuality
from mhri.robots.ros.bot_feeds import BotFeeds
from mhri.robots.ros.registry import RobotRegistry
from mhri.robots.ros.robot_monitor import RobotMonitor


class RobotMonitors:
    """A :class:`RobotMonitor` for each robot in the list.

    :param types: {name: RobotType}
    :param drive: :class:`mhri.driving.ros.drive_client.DriveClient`
    :param worker: :class:`mhri.graph.ros.worker.Worker` for the feeds of the tiles
    :param clock: function that returns monotonic seconds
    :param wall: function that returns the time of day [s since 1970]
    """

    def __init__(self, types, drive, worker, clock=time.monotonic, wall=time.time):
        self._registry = RobotRegistry(types)
        self._drive = drive
        self._worker = worker
        self._clock = clock
        self._wall = wall
        self._lock = threading.Lock()
        self._links = {}
        self._wanted = set()
        self._stopped = False
        #: factory of the link measurement
        self.quality = LinkQuality

    def add(self, name):
        """Add a robot to the list; :meth:`connect` makes its monitor."""
        with self._lock:
            self._wanted.add(name)

    def drop(self, name):
        """Forget a robot; return its monitor, to be closed, or None."""
        with self._lock:
            self._wanted.discard(name)
            link = self._links.pop(name, None)
        self._registry.forget(name)
        return link

    def connect(self, name, facts=None):
        """Make the monitor of a robot, or a new one if its type has changed (blocking).

        :param facts: its :class:`mhri.robots.ros.graph_scan.Facts` if already known
        """
        try:
            robot_type = self._registry.note(name, facts) if facts is not None \
                else self._registry.look([name])[name]
        except (MasterError, ValueError, OSError) as error:
            rospy.logwarn('%s: %s', name, error)
            return
        self._link(name, robot_type)

    def _link(self, name, robot_type):
        with self._lock:
            old = self._links.get(name)
            if name not in self._wanted or old and old.robot_type == robot_type:
                return
            self._links.pop(name, None)
        if old is not None:
            old.close()
        link = RobotMonitor(name, robot_type, self._drive, BotFeeds(name, robot_type, self._worker),
                            self._clock, self._wall, self.quality)
        with self._lock:
            wanted = name in self._wanted
            if wanted:
                self._links[name] = link
            stopped = self._stopped
        if not wanted:  # forgotten meanwhile
            link.close()
        elif stopped:
            link.on_stop(True, self._clock())

    def supervise(self):
        """Query the type of each silent robot again: it may have started meanwhile.

        A robot within reach keeps its type: topics that appear or vanish must not change it while
        it moves; but sensors that it lacks may be found.
        """
        with self._lock:
            names = [name for name in self._wanted if name not in self._links
                     or self._links[name].view().link in (WAITING, GONE)
                     or self._links[name].robot_type.name == 'generic'
                     or not self._registry.is_complete(name)]
            known = [name for name in names if name in self._links and self._is_reached(name)]
        try:
            kinds = self._registry.look(names, known)
        except (MasterError, ValueError, OSError) as error:
            rospy.logdebug('cannot query the robots now: %s', error)
            return
        for name, robot_type in kinds.items():
            self._link(name, robot_type)
        with self._lock:
            links = list(self._links.values())
        for link in links:
            link.listen_to_guard()

    def _is_reached(self, name):
        """Return whether drive and screen agree on the velocity topic of a robot.

        If not, the drive has newer information.
        """
        robot = self._drive.robot(name)
        return robot is not None and (robot.guarded or robot.topic in [
            topic_of(name, topic) for topic in self._links[name].robot_type.command])

    def on_stop(self, stopped, now):
        """Start or end the proof of a stop for every robot."""
        with self._lock:
            self._stopped = stopped
            links = list(self._links.values())
        for link in links:
            link.on_stop(stopped, now)

    def on_drive(self, robots):
        """Handle the states of the robots in the drive (a list of ``mhri/RobotDrive``)."""
        with self._lock:
            links = [(self._links[robot.name], robot) for robot in robots
                     if robot.name in self._links]
        for link, robot in links:
            link.on_drive(robot)

    def robot_type(self, name):
        """Return the :class:`RobotType` of a robot, None before it has a monitor."""
        with self._lock:
            link = self._links.get(name)
        return link.robot_type if link else None

    def camera_bits_per_s(self):
        """Return the bandwidth of all shown pictures [bit/s]."""
        with self._lock:
            links = list(self._links.values())
        return sum(link.feeds.bits_per_s() for link in links)

    def feeds(self, name):
        """Return the :class:`BotFeeds` of a robot, None before it has a monitor."""
        with self._lock:
            link = self._links.get(name)
        return link.feeds if link else None

    def view(self, name, **ours):
        """Return the :class:`RobotView` of one robot; ``ours`` are fields of the screen."""
        with self._lock:
            link = self._links.get(name)
        if link is None:
            return RobotView(name=name, note='looking for it', **ours)
        return link.view(self._registry.problem(name), self._registry.no_odometry(name), **ours)

    def close(self):
        """Unregister the topics of all robots (blocking)."""
        with self._lock:
            self._wanted.clear()
            links, self._links = list(self._links.values()), {}
        for link in links:
            link.close()
