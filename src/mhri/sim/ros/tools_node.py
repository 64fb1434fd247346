# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The accessories of a simulated robot on ROS: those of its type that the simulator knows.

By key, with the names in the row (``resource/sim/accessories.yaml``):

- ``lamp``: ``std_msgs/Bool``, and its state; without it the picture is a little darker
- ``head``: ``geometry_msgs/Vector3``, x to the left, y up [rad], and its state; turns the camera
- ``gripper``: the action ``actionlib/Test``, goal and result are how far it is open [mm], and its
  state as ``std_msgs/Int32``
- ``gas``: ``std_msgs/Float32`` [ppm], 2 Hz

States are latched, and sent when they change.
"""
import actionlib
from actionlib.msg import TestAction, TestFeedback, TestResult
from geometry_msgs.msg import Vector3
import rospy
from std_msgs.msg import Bool, Float32, Int32

from mhri.base.accessories import ACTION, HEAD, TOPIC
from mhri.base.names import topic_of
from mhri.sim.ticks import Due
from mhri.sim.tools import (
    Actuator, DIM, gas_ppm, GRIPPER_MM_S, HEAD_RAD_S, MAX_TILT_RAD, OPEN_MM, rows_of_tilt)

LAMP, GRIPPER, GAS = 'lamp', 'gripper', 'gas'
# The way and type of what is simulated of each key.
KINDS = {LAMP: (TOPIC, 'std_msgs/Bool'), HEAD: (TOPIC, 'geometry_msgs/Vector3'),
         GRIPPER: (ACTION, 'actionlib/Test'), GAS: (TOPIC, 'std_msgs/Float32')}
# Ticks of 10 ms between two states of a part that moves, and two readings of gas.
STATE_EVERY, GAS_EVERY = 5, 50


class SimTools:
    """The accessories of one robot; :meth:`step` moves and publishes them.

    :param name: the robot
    :param template: :class:`mhri.base.robot_types.RobotType`
    :param failing: :class:`mhri.sim.ros.fault_node.Failing`
    :param leak: place of a gas leak [m], () without one
    """

    def __init__(self, name, template, failing, leak=()):
        self._name, self._failing, self._leak = name, failing, leak
        self._rows = {row.key: row for row in template.accessories
                      if KINDS.get(row.key) == (row.way, row.type)}
        self._lamp = LAMP not in self._rows
        self._head = self._gripper = self._server = self._gas = None
        self._states = {}
        self._state_due, self._gas_due = Due(STATE_EVERY), Due(GAS_EVERY)
        for key, start in ((LAMP, self._start_lamp), (HEAD, self._start_head),
                           (GRIPPER, self._start_gripper), (GAS, self._start_gas)):
            if key in self._rows:
                start(self._rows[key])

    def _start_lamp(self, row):
        self._publish_on(row, Bool, 'std_msgs/Bool')
        self._say(LAMP, Bool(False))
        self._listen(row, Bool, self._on_lamp)

    def _start_head(self, row):
        (left, right), (low, high) = row.ranges
        self._head = Actuator(HEAD_RAD_S, ((left, right), (
            max(low, -MAX_TILT_RAD), min(high, MAX_TILT_RAD))))
        self._publish_on(row, Vector3, 'geometry_msgs/Vector3')
        self._say(HEAD, Vector3(*self._head.place, 0.0))
        self._listen(row, Vector3, lambda message: self._head.go((message.x, message.y)))

    def _start_gripper(self, row):
        self._gripper = Actuator(GRIPPER_MM_S, ((0.0, OPEN_MM),))
        self._publish_on(row, Int32, 'std_msgs/Int32')
        self._say(GRIPPER, Int32(0))
        self._server = actionlib.SimpleActionServer(
            topic_of(self._name, row.name), TestAction, auto_start=False)
        self._server.start()

    def _start_gas(self, row):
        self._gas = rospy.Publisher(topic_of(self._name, row.name), Float32, queue_size=1)

    def _publish_on(self, row, kind, name):
        """Offer the state of a row, if it has one of this kind."""
        if row.state is not None and row.state.kind == name:
            self._states[row.key] = rospy.Publisher(
                topic_of(self._name, row.state.name), kind, queue_size=1, latch=True)

    def _listen(self, row, kind, call):
        """Subscribe the commands of a row, subject to faults."""
        def act(message):
            try:
                call(message)
            except ValueError as error:
                rospy.logwarn_throttle(1.0, '{}: refused: {}'.format(row.key, error))
        rospy.Subscriber(topic_of(self._name, row.name), kind, lambda message:
                         self._failing.receive(lambda _: act(message)), queue_size=1,
                         tcp_nodelay=True)

    def _say(self, key, message):
        if key in self._states:
            self._failing.send(self._states[key], message)

    def _on_lamp(self, message):
        self._lamp = message.data
        self._say(LAMP, Bool(self._lamp))

    @property
    def turns(self):
        """Whether it has a head that turns the camera."""
        return self._head is not None

    @property
    def pan_rad(self):
        """How far the camera is turned to the left [rad]."""
        return self._head.place[0] if self._head else 0.0

    @property
    def shift(self):
        """The rows by which the horizon is below the middle of the picture."""
        return rows_of_tilt(self._head.place[1]) if self._head else 0

    @property
    def light(self):
        """How bright the picture is, 0 to 1."""
        return 1.0 if self._lamp else DIM

    def step(self, tick, dt, body):
        """Advance by ``dt`` seconds, and publish what is due."""
        if self._gas is not None and self._gas_due.at(tick) and self._gas.get_num_connections():
            self._failing.send(self._gas, Float32(gas_ppm(self._leak, body.x, body.y)))
        turns = self._head is not None and not self._head.there
        grips = self._server is not None and (
            self._server.is_active() or self._server.is_new_goal_available())
        if not (turns or grips) or self._failing.has('computer_frozen'):
            return
        due = self._state_due.at(tick)
        if turns and self._head.step(dt) and (due or self._head.there):
            self._say(HEAD, Vector3(*self._head.place, 0.0))
        if grips:
            self._grip(dt, due)

    def _grip(self, dt, due):
        """Follow the goal of the action."""
        server = self._server
        if server.is_new_goal_available():
            self._gripper.go((float(server.accept_new_goal().goal),))
        if server.is_active() and server.is_preempt_requested():
            self._gripper.halt()
            server.set_preempted(TestResult(round(self._gripper.place[0])))
        if self._gripper.step(dt) and (due or self._gripper.there):
            place = round(self._gripper.place[0])
            self._say(GRIPPER, Int32(place))
            server.publish_feedback(TestFeedback(place))
        if server.is_active() and self._gripper.there:
            server.set_succeeded(TestResult(round(self._gripper.place[0])))
