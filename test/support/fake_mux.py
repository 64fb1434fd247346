# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An operator played by the test's own node, and an ear for what the drive says of itself."""
import collections
import threading
import time

import rospy
from std_srvs.srv import Trigger

from mhri.msg import DriveSettings, DriveState, RobotSelect
from support import graph
from support.graph import TAKE_CONTROL
from support.ros_system import wait_for, words_of


class FakeOperator:
    """Repeats its wish at 2 Hz, as whoever is in control has to."""

    def __init__(self):
        self.come_back()
        self._names = None
        self._settings = []
        #: of the speed [m/s, rad/s], as wished; at first those of mux.yaml
        self.limits = 0.5, 1.5
        self._changed = threading.Event()
        threading.Thread(target=self._run, daemon=True).start()

    def check(self, *names):
        """Check exactly these robots; return when [s, monotonic]."""
        self._names = list(names)
        return self._publish(names)

    def set(self, linear_mps=0.5, angular_rad_s=1.5, **others):
        """Wish these settings from now on (None: say nothing of them); return when."""
        self.limits = (linear_mps, angular_rad_s) if linear_mps else self.limits
        self._settings = [DriveSettings(linear_mps=linear_mps, angular_rad_s=angular_rad_s,
                                        **others)] if linear_mps else []
        return self._publish(self._names or [])

    def take(self):
        """Take control."""
        wait_for(lambda: rospy.ServiceProxy(TAKE_CONTROL, Trigger)().success, what='control')

    def come_back(self):
        """Publish the topic again, with nothing to say yet."""
        self.select = rospy.Publisher(graph.SELECT, RobotSelect,
                                      queue_size=10, latch=True, tcp_nodelay=True)

    def _publish(self, names):
        when = time.monotonic()
        self.select.publish(robots=names, settings=self._settings)
        return when

    def fall_silent(self):
        """Say nothing any more, and stay there; return when."""
        self._names = None
        return time.monotonic()

    def leave(self):
        """Give the topic back, as a program that ends does."""
        self._names = None
        self.select.unregister()

    def _run(self):
        while not rospy.is_shutdown():
            self._changed.wait(0.5)
            names = self._names
            if names is not None:
                self._publish(names)


class StateEar:
    """The newest ``/mux/state``, and those before it."""

    def __init__(self):
        self.message = None
        self.at = None
        #: when the drive that speaks now was first heard [s, monotonic]
        self.run_at = None
        self._heard = collections.deque(maxlen=1000)
        self._subscriber = rospy.Subscriber(graph.DRIVE_STATE, DriveState, self._hear,
                                            queue_size=100)

    def _hear(self, message):
        now = time.monotonic()
        if self.message is None or message.run != self.message.run:
            self.run_at = now
        self.message, self.at = message, now
        self._heard.append((self.at, message))

    def __repr__(self):
        """Say how old the newest one is, and what it says."""
        return 'nothing' if self.at is None else 'the state of {:.1f} s ago: {}'.format(
            time.monotonic() - self.at, self.message)

    def said(self, good, what, since):
        """Wait until it has been good since a time, for however short a while; return when."""
        return wait_for(lambda: next((at for at, message in list(self._heard)
                                      if at >= since and good(message)), None), what=what)

    def wait(self, good, what, timeout_s=60.0):
        """Wait for a state that comes from now on and is good; return it.

        The newest one may be the last word of a drive that was killed.
        """
        asked = time.monotonic()

        def found():
            at, message = self._heard[-1] if self._heard else (asked, None)
            return at > asked and good(message) and message
        return wait_for(found, timeout_s, lambda: '{}, and not {!r}'.format(words_of(what), self))

    def robot(self, name):
        """Return what is said of one robot, or None."""
        return next((robot for robot in (self.message.robots if self.message else ())
                     if robot.name == name), None)

    def wait_robot(self, name, good, what, timeout_s=60.0):
        """Wait for a state that comes from now on with good news of one robot; return these."""
        def of(state):
            return next((robot for robot in state.robots if robot.name == name), None)
        return of(self.wait(lambda state: of(state) and good(of(state)), '{} of {}'.format(
            what, name), timeout_s))
