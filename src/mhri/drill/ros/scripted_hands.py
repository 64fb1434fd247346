# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The scripted operator on the graph, which uses the data and topics of a screen.

Publishes ``/mux_in/joy`` (``sensor_msgs/Joy``), ``/robot_controller/robot_select``
(``mhri/RobotSelect``, repeated to renew the lease) and ``/mux_in/mode_select``. Subscribes ``/tf``,
``/<robot>/scan`` (``sensor_msgs/LaserScan``) and ``/mux/state``. Takes control by
``/mux/take_control`` if another screen has it.
"""
import math
import threading
import time

import rospy
from sensor_msgs.msg import Joy, LaserScan
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from mhri.base.geometry import composed, Pose
from mhri.drill.operator import Act, ahead_of, RATE_HZ, ScriptedOperator, Seen
from mhri.msg import ControlMode, DriveState, RobotDrive, RobotSelect
from mhri.robots.ros.convert import yaw_of

LEASE_S = 0.5
# Older scans are ignored [s].
SCAN_S = 1.0


def _pose(transform):
    return Pose(transform.translation.x, transform.translation.y, yaw_of(transform.rotation))


class _Eye:
    """The data of one robot: two transforms and a scan, with their receipt times."""

    def __init__(self, name, front_m):
        self._front_m = front_m
        self._parts = {}
        self._heard_at = self._scanned_at = -math.inf
        self._ahead_m = math.inf
        rospy.Subscriber('/{}/scan'.format(name), LaserScan, self._on_scan, queue_size=1,
                         tcp_nodelay=True)

    def on_transform(self, frame, pose):
        self._parts = {**self._parts, frame: pose}
        self._heard_at = time.monotonic()

    def _on_scan(self, message):
        self._ahead_m = ahead_of(message.ranges, message.angle_increment, self._front_m,
                                 message.range_min)
        self._scanned_at = time.monotonic()

    def seen(self):
        """Return the robot as known to the operator, None before both transforms are known."""
        parts, now = self._parts, time.monotonic()
        if len(parts) < 2:
            return None
        place = composed(parts['odom'], parts['base_link'])
        ahead_m = self._ahead_m if now - self._scanned_at < SCAN_S else math.inf
        return Seen(place.x_m, place.y_m, place.heading_rad, ahead_m, now - self._heard_at)


class ScriptedHands:
    """Drives on its own thread, from :meth:`start` until every robot has arrived.

    :param scenario: :class:`mhri.drill.scenario.Scenario`
    :param fronts_m: {robot: distance from its laser to its front [m]}
    :param turn_rad_s: turn rate at full sideways deflection of the stick [rad/s]
    """

    def __init__(self, scenario, fronts_m, turn_rad_s):
        self._operator = ScriptedOperator(scenario.routes, turn_rad_s)
        self._eyes = {name: _Eye(name, fronts_m[name]) for name in scenario.robots}
        self._drive = None
        self._leased_at, self._chosen = -math.inf, None
        self._select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=10,
                                       latch=True, tcp_nodelay=True)
        self._joy = rospy.Publisher('/mux_in/joy', Joy, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber('/tf', TFMessage, self._on_tf, queue_size=10, tcp_nodelay=True)
        rospy.Subscriber('/mux/state', DriveState, self._on_state, queue_size=1, tcp_nodelay=True)
        self._done = threading.Event()

    def start(self):
        """Start to drive."""
        rospy.on_shutdown(self.stop)
        threading.Thread(target=self._run, name='scripted operator', daemon=True).start()
        return self

    def stop(self):
        """Centre the stick and deselect all robots."""
        if not self._done.is_set():
            self._done.set()
            self._send(Act())

    def _on_tf(self, message):
        for each in message.transforms:
            name, _, frame = each.child_frame_id.partition('/')
            if name in self._eyes and frame in ('odom', 'base_link'):
                self._eyes[name].on_transform(frame, _pose(each.transform))

    def _on_state(self, state):
        self._drive = state

    def _run(self):
        rate = rospy.Rate(RATE_HZ)
        try:
            self._take_control()
            while not self._done.is_set():
                seen = {name: eye.seen() for name, eye in self._eyes.items()}
                act = self._operator.act({name: each for name, each in seen.items() if each})
                self._send(act if self._ready(act.robot) else Act(act.robot))
                rate.sleep()
        except rospy.ROSException:
            if not rospy.is_shutdown():
                raise

    def _take_control(self):
        """Take control from another screen, once the mux state is known."""
        while self._drive is None and not self._done.wait(0.05):
            pass
        if self._drive is not None and self._drive.operator not in ('', rospy.get_name()):
            rospy.ServiceProxy('/mux/take_control', Trigger)()

    def _ready(self, robot):
        """Return whether the stick drives the robot, or must be centred first."""
        drive = self._drive
        found = next((each for each in drive.robots if each.name == robot), None)
        return not drive.waits_for and found is not None and found.stands != RobotDrive.JOINING

    def _send(self, act):
        now = time.monotonic()
        if act.robot != self._chosen or now - self._leased_at >= LEASE_S:
            self._chosen, self._leased_at = act.robot, now
            self._select.publish(robots=[act.robot] if act.robot else [],
                                 mode=ControlMode.VIRTUAL_JOYSTICK)
        self._joy.publish(Joy(axes=[act.turn, act.forward]))
