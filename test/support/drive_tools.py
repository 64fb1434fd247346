# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests that drive a simulated robot at a wall share."""
import signal
import sys
import time

from geometry_msgs.msg import PoseStamped
import rospy

from support.drive_case import DriveCase
from support.node_tools import Process, Recorder
from support.paths import GUARD
from support.ros_system import wait_for

# The wall to the east of the hall [m].
WALL_M = 12.0
STANDS_S = 1.0


class Hall:
    """Where a robot that motion capture sees is, along the hall.

    :param radius_m: of its body
    """

    def __init__(self, robot, radius_m):
        self._radius_m = radius_m
        self.places = Recorder('/vrpn_client_node/{}/pose'.format(robot), PoseStamped,
                               lambda message: message.pose.position.x)
        self.places.wait(lambda where: True)

    def rests(self):
        """Wait until it has stood still for a while; return its gap to the wall [m]."""
        begun = time.monotonic()

        def still():
            if time.monotonic() - begun < STANDS_S:
                return False
            lately = [item.value for item in self.places.since(time.monotonic() - STANDS_S)]
            return len(lately) > 10 and max(lately) - min(lately) < 0.002
        wait_for(still, what='the robot to stand', poll_s=0.1)
        return WALL_M - self.places.last() - self._radius_m

    def least_gap(self, since):
        """Return the least gap to the wall since a time [m]."""
        return WALL_M - self._radius_m - max(item.value for item in self.places.since(since))


class HallCase(DriveCase):
    """The drive, and ``bot1`` of the simulator in the hall."""

    radius_m = 0.177

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.hall = Hall('bot1', cls.radius_m)

    def start_guard(self, *options):
        """Start a guard on bot1, a TurtleBot3, until the end of the test; return its process."""
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel',
                         '_radius_m:={}'.format(self.radius_m), '_no_return:=0,inf@3.5', *options],
                        env={'ROS_NAMESPACE': 'bot1'})

        def leave():
            guard.send(signal.SIGTERM)
            guard.wait()
            guard.end()
            rospy.delete_param('/bot1/mhri_guard')
        self.addCleanup(leave)
        return guard

    def drive_past(self, x, linear):
        """Drive bot1 past a place along the hall [m]; return where it is then."""
        self.keep_on(lambda: (self.hall.places.last() - x) * linear > 0.0,
                     'it to be at {} m'.format(x), linear)
        return self.hall.places.last()

    def drive_to(self, x, linear=-0.4):
        """Drive bot1 past a place, let go, and wait until it stands."""
        self.drive_past(x, linear)
        self.operator.centre()
        self.hall.rests()

    def push_to_rest(self, linear):
        """Drive bot1 until it stands though it is pushed; return its gap to the wall [m]."""
        def stands():
            gap_m = self.hall.rests()
            drives = not (self.state.message.waits_for or self.state.robot('bot1').stands)
            return drives and [gap_m]
        gap_m, = self.keep_on(stands, 'it to stand', linear)
        return gap_m


class BrakeCase(HallCase):
    """In which the brake is off again after each test."""

    speed_mps = 0.6

    def tearDown(self):
        self.ask(False)

    def ask(self, brake):
        """Switch the brake on or off."""
        self.operator.set(1.0, brake=brake)
        self.state.wait(lambda state: state.settings.brake == brake, 'the brake')

    def bot1(self):
        """Select the simulated robot, and centre the stick."""
        self.operator.check('bot1')
        self.ready('bot1')

    def until_it_brakes(self, *states):
        """Drive bot1 ahead until its brake is in one of these states; return what is said then."""
        def acts():
            robot = self.state.robot('bot1')
            return robot.brake in states and robot
        return self.keep_on(acts, 'the brake to act', self.speed_mps)
