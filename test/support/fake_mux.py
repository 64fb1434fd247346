# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the gates need of the world, played by the test's own node: a mux, an operator, robots."""
import collections
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, SetBoolResponse, Trigger

from mhri.msg import DriveSettings, GatesState, RobotSelect, TeamTwist
from support.graph import TAKE_CONTROL
from support.ros_system import wait_for


class FakeMux:
    """The words of a mux that is told what to say; it serves ``/mux/set_stop_all``, too."""

    def __init__(self):
        self.twist = rospy.Publisher('/robot_controller/twist', Twist, queue_size=10,
                                     tcp_nodelay=True)
        self.task_twist = rospy.Publisher('/robot_controller/task_twist', TeamTwist, queue_size=10,
                                          tcp_nodelay=True)
        self.stop_all = rospy.Publisher('/robot_controller/stop_all', Bool, queue_size=10,
                                        latch=True, tcp_nodelay=True)
        rospy.Service('/mux/set_stop_all', SetBool, lambda request: SetBoolResponse(True, ''))
        self.stopped = self.hangs = False
        rospy.Timer(rospy.Duration(0.5), self._repeat)

    def _repeat(self, event):
        """Say again what is in force, which is the heartbeat, too."""
        if not self.hangs:
            self.stop_all.publish(self.stopped)

    def say(self, linear, angular=0.0):
        """Publish one command; return when [s, monotonic]."""
        message = Twist()
        message.linear.x, message.angular.z = linear, angular
        when = time.monotonic()
        self.twist.publish(message)
        return when

    def stop(self, stopped):
        """Engage or release; return when [s, monotonic]."""
        self.stopped = stopped
        when = time.monotonic()
        self.stop_all.publish(stopped)
        return when


class FakeOperator:
    """Repeats its wish at 2 Hz, as whoever is in control has to."""

    def __init__(self):
        self.select = rospy.Publisher('/robot_controller/robot_select', RobotSelect,
                                      queue_size=1, latch=True, tcp_nodelay=True)
        self._names = None
        self._settings = []
        self._changed = threading.Event()
        threading.Thread(target=self._run, daemon=True).start()

    def check(self, *names):
        """Check exactly these robots; return when [s, monotonic]."""
        self._names = list(names)
        return self._publish()

    def set(self, linear_mps=0.5, angular_rad_s=1.5, **others):
        """Wish these settings from now on (None: say nothing of them); return when."""
        self._settings = [DriveSettings(linear_mps=linear_mps, angular_rad_s=angular_rad_s,
                                        **others)] if linear_mps else []
        return self._publish()

    def take(self):
        """Take control."""
        wait_for(lambda: rospy.ServiceProxy(TAKE_CONTROL, Trigger)().success, what='control')

    def _publish(self):
        when = time.monotonic()
        self.select.publish(robots=self._names or [], settings=self._settings)
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
            if self._names is not None:
                self._publish()


class StateEar:
    """The newest ``/gates/state``, and those before it."""

    def __init__(self):
        self.message = None
        self.at = None
        self._heard = collections.deque(maxlen=1000)
        self._subscriber = rospy.Subscriber('/gates/state', GatesState, self._hear, queue_size=100)

    def _hear(self, message):
        self.message, self.at = message, time.monotonic()
        self._heard.append((self.at, message))

    def said(self, good, what, since):
        """Wait until it has been good since a time, for however short a while; return when."""
        return wait_for(lambda: next((at for at, message in list(self._heard)
                                      if at >= since and good(message)), None), 5.0, what)

    def wait(self, good, what, timeout_s=60.0):
        """Wait until the state is good; return it."""
        return wait_for(lambda: self.message is not None and good(self.message) and self.message,
                        timeout_s, what)

    def robot(self, name):
        """Return what is said of one robot, or None."""
        return next((robot for robot in (self.message.robots if self.message else ())
                     if robot.name == name), None)

    def wait_robot(self, name, good, what, timeout_s=60.0):
        """Wait until what is said of one robot is good; return it."""
        return wait_for(lambda: self.robot(name) and good(self.robot(name)) and self.robot(name),
                        timeout_s, what)
