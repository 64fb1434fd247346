# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stand-in of the drive for tests of its clients: it says what a test tells it to, at 2 Hz."""
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.msg import DriveSettings, DriveState, RobotDrive, RobotSelect
from support import graph

PERIOD_S = 0.5


def moving(linear_mps=0.1):
    """Return a velocity that is not zero."""
    twist = Twist()
    twist.linear.x = linear_mps
    return twist


class FakeDrive:
    """Says a ``mhri/DriveState`` and keeps what it is asked, by caller id.

    ``selections`` are (caller, robots), ``wishes`` (caller, settings or None) of those, ``takers``
    and ``power`` what the services were called with. A stop is in force only once a test says so.
    """

    def __init__(self):
        self.state = DriveState(mode='joy', share=1.0, leased=True, settings=DriveSettings(
            linear_mps=0.5, angular_rad_s=1.5))
        self.selections, self.wishes, self.takers, self.power = [], [], [], []
        #: when the last selection came [s, monotonic]
        self.selected_at = 0.0
        self._lock = threading.Lock()
        self._silent = threading.Event()
        self._ended = threading.Event()
        self._publisher = rospy.Publisher(graph.DRIVE_STATE, DriveState, queue_size=10, latch=True)
        self._parts = [
            rospy.Subscriber(graph.SELECT, RobotSelect, self._hear),
            self._publisher]
        self._services = [
            rospy.Service(graph.TAKE_CONTROL, Trigger, self._take),
            rospy.Service(graph.SET_MOTOR_POWER, SetBool, self._set_power),
            rospy.Service(graph.SET_STOP_ALL, SetBool, lambda request: SetBoolResponse(True, ''))]
        threading.Thread(target=self._repeat, daemon=True).start()

    def _hear(self, message):
        caller = message._connection_header['callerid']
        self.selected_at = time.monotonic()
        self.selections.append((caller, tuple(message.robots)))
        self.wishes.append((caller, *message.settings[:1]) if message.settings
                           else (caller, None))
        if not self.state.operator:
            self.say(operator=caller)

    def _take(self, request):
        caller = request._connection_header['callerid']
        self.takers.append(caller)
        self.say(operator=caller)
        return TriggerResponse(success=True, message='')

    def _set_power(self, request):
        self.power.append(request.data)
        return SetBoolResponse(success=True, message='bot1: motor power cut')

    def say(self, **values):
        """Change the state and say it at once."""
        with self._lock:
            for key, value in values.items():
                setattr(self.state, key, value)
            if not self._silent.is_set():
                self._publisher.publish(self.state)

    def say_robot(self, name, **values):
        """Change what is said of one robot."""
        known = {robot.name: robot for robot in self.state.robots}
        robot = known.setdefault(name, RobotDrive(
            name=name, round_trip_s=float('nan'), odometry_follows=True))
        for key, value in values.items():
            setattr(robot, key, value)
        self.say(robots=list(known.values()))

    def hang(self, hangs=True):
        """Say nothing, or speak again."""
        (self._silent.set if hangs else self._silent.clear)()

    def _repeat(self):
        while not self._ended.wait(PERIOD_S):
            self.say()

    def close(self):
        """Take everything back."""
        self._ended.set()
        for service in self._services:
            service.shutdown()
        for part in self._parts:
            part.unregister()
