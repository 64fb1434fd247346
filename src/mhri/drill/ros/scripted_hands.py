# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The scripted operator on the graph: sees what a screen sees, and drives as a screen does.

Publishes ``/mux_in/joy`` (``sensor_msgs/Joy``), ``/robot_controller/robot_select``
(``mhri/RobotSelect``, repeated as the lease asks) and ``/mux_in/mode_select``. Subscribes ``/tf``,
``/<robot>/scan`` (``sensor_msgs/LaserScan``), ``/mux/waits_for`` and ``/gates/state``. Takes
control by ``/gates/take_control`` if another screen has it.
"""
import math
import threading
import time

import rospy
from sensor_msgs.msg import Joy, LaserScan
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from mhri.base.mocap import Pose
from mhri.drill.operator import Act, ahead_of, RATE_HZ, ScriptedOperator, Seen
from mhri.map.places import composed
from mhri.msg import ControlMode, GatesState, RobotGate, RobotSelect

LEASE_S = 0.5
# Without a scan for so long nothing is known of what is ahead [s].
SCAN_S = 1.0


def _pose(transform):
    turn = transform.rotation
    return Pose(transform.translation.x, transform.translation.y, 2.0 * math.atan2(turn.z, turn.w))


class _Eye:
    """What is known of one robot: two transforms and a scan, and when they came."""

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
        """Return the robot as the operator sees it, None before anything was heard."""
        parts, now = self._parts, time.monotonic()
        if len(parts) < 2:
            return None
        place = composed(parts['odom'], parts['base_link'])
        ahead_m = self._ahead_m if now - self._scanned_at < SCAN_S else math.inf
        return Seen(place.x_m, place.y_m, place.heading_rad, ahead_m, now - self._heard_at)


class ScriptedHands:
    """Looks and acts on a thread of its own, from :meth:`start` on until every robot has arrived.

    :param scenario: :class:`mhri.drill.scenario.Scenario`
    :param fronts_m: {robot: from its laser to its front [m]}
    :param turn_rad_s: turn rate of a stick pushed all the way to the side
    """

    def __init__(self, scenario, fronts_m, turn_rad_s):
        self._operator = ScriptedOperator(scenario.routes, turn_rad_s)
        self._eyes = {name: _Eye(name, fronts_m[name]) for name in scenario.robots}
        self._waits_for, self._gates = '?', None
        self._leased_at, self._chosen = -math.inf, None
        self._select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1,
                                       latch=True, tcp_nodelay=True)
        self._joy = rospy.Publisher('/mux_in/joy', Joy, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber('/tf', TFMessage, self._on_tf, queue_size=10, tcp_nodelay=True)
        rospy.Subscriber('/mux/waits_for', String, self._on_waits, queue_size=1)
        rospy.Subscriber('/gates/state', GatesState, self._on_gates, queue_size=1)
        self._done = threading.Event()

    def start(self):
        """Begin to drive."""
        rospy.on_shutdown(self.stop)
        threading.Thread(target=self._run, name='scripted operator', daemon=True).start()
        return self

    def stop(self):
        """Let go of the stick and of every robot."""
        if not self._done.is_set():
            self._done.set()
            self._send(Act())

    def _on_tf(self, message):
        for each in message.transforms:
            name, _, frame = each.child_frame_id.partition('/')
            if name in self._eyes and frame in ('odom', 'base_link'):
                self._eyes[name].on_transform(frame, _pose(each.transform))

    def _on_waits(self, message):
        self._waits_for = message.data

    def _on_gates(self, state):
        self._gates = state

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
        """Take control from another screen, once the gates are heard."""
        while self._gates is None and not self._done.wait(0.05):
            pass
        if self._gates is not None and self._gates.operator not in ('', rospy.get_name()):
            rospy.ServiceProxy('/gates/take_control', Trigger)()

    def _ready(self, robot):
        """Tell whether the stick counts: else it has to be centred first."""
        gate = next((each for each in self._gates.robots if each.name == robot), None)
        return not self._waits_for and gate is not None and gate.stands != RobotGate.JOINING

    def _send(self, act):
        now = time.monotonic()
        if act.robot != self._chosen or now - self._leased_at >= LEASE_S:
            self._chosen, self._leased_at = act.robot, now
            self._select.publish(robots=[act.robot] if act.robot else [],
                                 mode=ControlMode.VIRTUAL_JOYSTICK)
        self._joy.publish(Joy(axes=[act.turn, act.forward]))
