# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A witness of the robots' own odometry, and a stick to drive them: for tests that are nodes."""
import math
import threading
import time

from nav_msgs.msg import Odometry
import rospy
from sensor_msgs.msg import Joy

from mhri.robots.link import Motion
from support.ros_system import wait_for


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


def seconds_to_standstill(witnesses, since, timeout_s=5.0):
    """Wait until all robots stand still; return {name: seconds from ``since``}."""
    wait_for(lambda: all(witness.stood_still_at(since) for witness in witnesses), timeout_s,
             'the robots to stand still')
    return {witness.name: witness.stood_still_at(since) - since for witness in witnesses}


def report(event, times):
    """Print the measured times of an event for the record."""
    print('MEASURED {}: {}'.format(event, ', '.join(
        '{} stands still after {:.0f} ms'.format(name, seconds * 1e3)
        for name, seconds in sorted(times.items()))), flush=True)


class Stick:
    """A device that sends its Joy at 20 Hz on a thread, as an input node does."""

    def __init__(self, topic='/mux_in/pedal'):
        self._publisher = rospy.Publisher(topic, Joy, queue_size=1, tcp_nodelay=True)
        self._axes = (0.0, 0.0)
        self._changed = threading.Condition()
        self._done = False
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        with self._changed:
            while not self._done and not rospy.is_shutdown():
                self._publisher.publish(Joy(axes=list(self._axes)))
                self._changed.wait(0.05)

    def hold(self, forward, turn):
        """Hold the stick at fractions in [-1, 1] from now on."""
        with self._changed:
            self._axes = (turn, forward)
            self._changed.notify()

    def connected(self):
        return self._publisher.get_num_connections() > 0

    def unplug(self):
        """Fall silent in the middle of whatever is held."""
        with self._changed:
            self._done = True
            self._changed.notify()
