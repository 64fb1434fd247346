# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests that drive a simulated robot at a wall share."""
import threading
import time

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry

from rostest_tools import Recorder
from support.ros_system import wait_for

# The wall to the east of the hall [m].
WALL_M = 12.0
STANDS_S = 1.5
PATIENCE_S = 60.0


class Hand:
    """Holds the stick: says the same 20 times a second, as the mux does."""

    def __init__(self, mux, linear, angular=0.0):
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(mux, linear, angular), daemon=True)
        self._thread.start()

    def _run(self, mux, linear, angular):
        while not self._done.wait(0.05):
            mux.say(linear, angular)

    def let_go(self):
        """Say nothing any more."""
        self._done.set()
        self._thread.join()


class Hall:
    """Where a robot that motion capture sees is, along the hall; a plain one, by its odometry.

    :param radius_m: of its body
    :param wall_m: where the wall of a plain robot is, None for a robot of the simulator
    """

    def __init__(self, robot, radius_m, wall_m=None):
        self._radius_m = radius_m
        self._wall_m = WALL_M if wall_m is None else wall_m
        if wall_m is None:
            self.places = Recorder('/vrpn_client_node/{}/pose'.format(robot), PoseStamped,
                                   lambda message: message.pose.position.x)
        else:
            self.places = Recorder('/{}/odom'.format(robot), Odometry,
                                   lambda message: message.pose.pose.position.x)
        self.places.wait(lambda where: True, patience_s=PATIENCE_S)

    def rests(self):
        """Wait until it has stood still for a while; return its gap to the wall [m]."""
        begun = time.monotonic()

        def still():
            if time.monotonic() - begun < STANDS_S:
                return False
            lately = [item.value for item in self.places.since(time.monotonic() - STANDS_S)]
            return len(lately) > 10 and max(lately) - min(lately) < 0.002
        wait_for(still, PATIENCE_S, 'the robot to stand', poll_s=0.1)
        return self._wall_m - self.places.last() - self._radius_m

    def least_gap(self, since):
        """Return the least gap to the wall since a time [m]."""
        return self._wall_m - self._radius_m - max(item.value for item in self.places.since(since))
