# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What robots were told and did, and a stick to drive them: for tests that are nodes."""
import contextlib
import math
import threading
import time

from nav_msgs.msg import Odometry
import rospy

from mhri.robots.link import Motion
from support import graph, node_tools
from support.ros_system import insist, wait_for


class Witness:
    """Follows ``/<robot>/odom``: when the robot moved, how far, and when it stood still."""

    READINGS = 3

    def __init__(self, name):
        self.name = name
        self._lock = threading.Lock()
        self._log = []
        self.path_m = 0.0
        self._subscriber = rospy.Subscriber('/{}/odom'.format(name), Odometry, self._on_odometry,
                                            queue_size=50, tcp_nodelay=True)

    def _on_odometry(self, message):
        now = time.monotonic()
        twist, place = message.twist.twist, message.pose.pose.position
        with self._lock:
            if self._log:
                last = self._log[-1][2]
                self.path_m += math.hypot(place.x - last[0], place.y - last[1])
            self._log.append((now, Motion(twist.linear.x, twist.angular.z), (place.x, place.y)))

    def __repr__(self):
        """Say what it did last, as (when, speeds, place)."""
        return '{}: {}'.format(self.name, self._log[-3:])

    def live(self):
        with self._lock:
            return bool(self._log) and time.monotonic() - self._log[-1][0] < 0.2

    def latest(self):
        with self._lock:
            return self._log[-1][1]

    def fastest(self):
        """Return the highest speed that its odometry ever said [m/s]."""
        with self._lock:
            return max((abs(entry[1].speed_mps) for entry in self._log), default=0.0)

    def moving(self):
        return self.live() and not self.latest().is_standstill()

    def at_rest(self):
        with self._lock:
            last = self._log[-self.READINGS:]
        return (len(last) == self.READINGS and time.monotonic() - last[-1][0] < 0.2
                and all(entry[1].is_standstill() for entry in last))

    def stood_still_at(self, since):
        """Return the time of the first of three readings of standstill in a row, or None."""
        with self._lock:
            log = [entry for entry in self._log if entry[0] >= since]
        for index in range(len(log) - self.READINGS + 1):
            if all(entry[1].is_standstill() for entry in log[index:index + self.READINGS]):
                return log[index][0]
        return None

    def moved_since(self, since):
        with self._lock:
            return any(entry[0] >= since and not entry[1].is_standstill() for entry in self._log)


def seconds_to_standstill(witnesses, since):
    """Wait until all robots stand still; return {name: seconds from ``since``}."""
    wait_for(lambda: all(witness.stood_still_at(since) for witness in witnesses),
             what='the robots to stand still')
    return {witness.name: witness.stood_still_at(since) - since for witness in witnesses}


def report(event, times):
    """Print the measured times of an event for the record."""
    print('MEASURED {}: {}'.format(event, ', '.join(
        '{} stands still after {:.0f} ms'.format(name, seconds * 1e3)
        for name, seconds in sorted(times.items()))), flush=True)


class RobotLog:
    """What one robot was told, and how its body moved: rows (when [s], m/s, rad/s)."""

    def __init__(self, path):
        self.path = path
        self._read = {}

    def rows(self, what='told'):
        """Return all rows of ``told`` or ``moved``; in an hour those are too many to read anew."""
        at, rows = self._read.setdefault(what, [0, []])
        with contextlib.suppress(FileNotFoundError), open('{}.{}'.format(self.path, what)) as log:
            log.seek(at)
            for line in iter(log.readline, ''):
                if not line.endswith('\n'):
                    break
                rows.append(tuple(map(float, line.split())))
                self._read[what][0] += len(line)
        return rows[:]

    def after(self, since, until=math.inf):
        """Return what it was told in a time."""
        return [row for row in self.rows() if since <= row[0] <= until]

    def flips(self, since=0.0):
        """Return what its flipper was told after a time: rows (when [s], value)."""
        return [row for row in self.rows('told.flipper') if row[0] >= since]

    def moves(self):
        """Return whether its last command was to move."""
        return any(any(row[1:]) for row in self.rows()[-1:])

    def drives(self):
        """Return whether its last command was to move, and its body does."""
        return self.moves() and any(abs(row[1]) > 0.05 for row in self.rows('moved')[-1:])

    def stands_from(self, since, what, least=0.0):
        """Return when it stands for good: the first row after which no other moves it.

        None where it never does.
        """
        rows = self.rows(what)
        moves = [index for index, row in enumerate(rows)
                 if max(abs(row[1]), abs(row[2])) > least]
        after = rows[moves[-1] + 1:] if moves else rows
        return max(since, after[0][0]) if after else None


class Stick(node_tools.Stick):
    """The stick of a pedal, whose node this process is."""

    def __init__(self, topic=graph.PEDAL):
        super().__init__(topic)
        self.hold(0.0, 0.0)

    def hold(self, forward, turn):
        """Hold the stick at fractions in [-1, 1] from now on."""
        return super().hold((turn, forward))

    def drive(self, forward, turn, moving, timeout_s, what):
        """Centre the stick and push it, until who is driven moves.

        :raises NotYet: see :func:`wait_for`
        """
        def driven():
            self.repeat(0.0, 0.0)
            self.hold(forward, turn)
            return wait_for(moving, 2.0, what, poll_s=0.02)
        insist(driven, what, timeout_s)
