#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The power of a robot's motors, by topic and by service; and what its own emergency stop says."""
import os
import subprocess
import sys
import threading
import time
import unittest

import rosgraph
import rospy
import rostest
from std_msgs.msg import Bool, UInt8
from std_srvs.srv import SetBool, SetBoolResponse

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, '..'))
try:
    from kobuki_msgs.msg import MotorPower as KobukiPower
except ImportError:
    sys.path.insert(0, os.path.join(HERE, '..', 'support', 'messages'))
    from kobuki_msgs.msg import MotorPower as KobukiPower

from mhri.base.robot_types import resolve_robot_type  # noqa: E402
from mhri.driving.ros.motor_power import MotorPower, PARAMETER  # noqa: E402
from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.robots.ros.hardware_stop import HardwareStop  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

# A call that waits for nothing takes far less; one that waits for a robot, 3 s.
AT_ONCE_S = 1.0


class Base:
    """Notes what a robot's base is told, and when."""

    def __init__(self, topic, kind, field):
        self.heard = []
        self._subscriber = rospy.Subscriber(
            topic, kind, lambda message: self.heard.append(getattr(message, field)))

    def close(self):
        self._subscriber.unregister()


class Switch:
    """A ``std_srvs/SetBool`` service that notes its calls and answers as it is told to."""

    def __init__(self, name):
        self.called = []
        self.refuses = False
        self.hangs = threading.Event()
        self.goes_on = threading.Event()
        self._server = rospy.Service(name, SetBool, self._on_call)

    def _on_call(self, request):
        if self.hangs.is_set():
            self.hangs.clear()
            self.goes_on.wait()
        self.called.append(request.data)
        return SetBoolResponse(not self.refuses, 'the key is turned' if self.refuses else '')

    def close(self):
        self.goes_on.set()
        self._server.shutdown()


class MotorPowerTest(unittest.TestCase):

    number = 0

    def setUp(self):
        MotorPowerTest.number += 1
        self.name = 'bot{}'.format(self.number)

    def power(self, name=None, **parameters):
        """Return the power of a robot with these parameters."""
        kind, errors = resolve_robot_type(robot_types()[0], self.name, parameters)
        self.assertEqual(errors, [])
        power = MotorPower(name or self.name, kind)
        self.addCleanup(power.close)
        return power

    def by_service(self):
        """Return a switch, and the power that uses it."""
        switch = Switch('/{}/switch'.format(self.name))
        self.addCleanup(switch.close)
        return switch, self.power(mhri={'motor_power': {'service': 'switch'}})

    def base(self, topic, kind, field):
        base = Base('/{}/{}'.format(self.name, topic), kind, field)
        self.addCleanup(base.close)
        return base

    def at_once(self, act):
        begun = time.monotonic()
        act()
        self.assertLess(time.monotonic() - begun, AT_ONCE_S)

    def test_each_type_is_told_in_its_own_words(self):
        for robot_type, topic, kind, field, words in (
                ('turtlebot2', 'mobile_base/commands/motor_power', KobukiPower, 'state', [0, 1]),
                ('turtlebot3', 'motor_power', Bool, 'data', [False, True])):
            with self.subTest(robot_type):
                self.setUp()
                power, base = self.power(robot_type=robot_type), self.base(topic, kind, field)
                self.assertEqual((power.available, power.problem, power.state), (True, '', ''))
                self.at_once(power.cut)
                wait_for(lambda: base.heard, what='the cut')
                wait_for(lambda: power.state == 'cut sent', what='the words')
                self.assertTrue(power.is_cut)
                self.at_once(power.restore)
                wait_for(lambda: len(base.heard) > 1, what='the power')
                wait_for(lambda: power.state == '', what='the words')
                # Connected while the cut was due, it may have been told of that twice.
                self.assertEqual([base.heard[0], base.heard[-1]], words)
                self.assertEqual(base.heard.count(words[1]), 1)

    def test_a_base_that_comes_up_later_is_told(self):
        power = self.power(robot_type='turtlebot3')
        power.cut()
        why = 'failed: no robot listens to /{}/motor_power'.format(self.name)
        wait_for(lambda: power.state == why, what='the reason')
        for _ in range(2):
            base = self.base('motor_power', Bool, 'data')
            wait_for(lambda: base.heard, what='the cut')
            self.assertEqual(set(base.heard), {False})
            wait_for(lambda: power.state == 'cut sent', what='the words')
            base.close()

    def test_somebody_who_merely_listens_is_no_robot(self):
        topic = '/{}/motor_power'.format(self.name)
        echo = subprocess.Popen(['rostopic', 'echo', topic], stdout=subprocess.DEVNULL)
        self.addCleanup(echo.wait)
        self.addCleanup(echo.terminate)
        power = self.power(robot_type='turtlebot3')
        wait_for(lambda: any(
            node.startswith('/rostopic_') for name, nodes in rosgraph.Master(
                rospy.get_name()).getSystemState()[1] if name == topic for node in nodes),
                 what='rostopic', poll_s=0.05)
        power.cut()
        wait_for(lambda: power.state == 'failed: no robot listens to ' + topic, what='the reason')
        base = self.base('motor_power', Bool, 'data')
        wait_for(lambda: base.heard == [False] and power.state == 'cut sent', what='the cut')

    def test_power_is_never_given_unasked(self):
        power, base = self.power(robot_type='turtlebot3'), self.base('motor_power', Bool, 'data')
        power.cut()
        wait_for(lambda: base.heard, what='the cut')
        power.close()
        self.assertNotIn(True, base.heard)

    def test_a_service_confirms(self):
        switch, power = self.by_service()
        self.at_once(power.cut)
        wait_for(lambda: power.state == 'cut', what='the answer')
        self.at_once(power.restore)
        wait_for(lambda: power.state == '', what='the answer')
        self.assertEqual(switch.called, [False, True])

    def test_a_service_that_refuses_is_quoted_and_asked_again(self):
        switch, power = self.by_service()
        switch.refuses = True
        power.cut()
        wait_for(lambda: power.state.endswith('refuses: the key is turned'), what='the reason')
        switch.refuses = False
        wait_for(lambda: power.state == 'cut', what='the answer')

    def test_a_service_that_is_not_there_is_named(self):
        power = self.power(mhri={'motor_power': {'service': 'switch'}})
        power.cut()
        wait_for(lambda: '/{}/switch'.format(self.name) in power.state, what='the reason')
        self.assertTrue(power.state.startswith('failed: '))

    def test_a_service_that_hangs_delays_nothing(self):
        switch, power = self.by_service()
        switch.hangs.set()
        self.at_once(power.cut)
        wait_for(lambda: power.state == 'failed: no answer for 3 s', what='the reason')
        wait_for(lambda: power.state == 'cut', what='the second call')
        self.assertEqual(switch.called, [False])

    def test_power_that_comes_late_under_a_cut_is_taken_again(self):
        switch, power = self.by_service()
        switch.hangs.set()
        power.restore()
        wait_for(lambda: not switch.hangs.is_set(), what='the call that hangs')
        power.cut()
        wait_for(lambda: power.state == 'cut', what='the cut')
        switch.goes_on.set()
        wait_for(lambda: True in switch.called, what='the late call')
        wait_for(lambda: switch.called[-1] is False, what='the cut after it')
        wait_for(lambda: power.state == 'cut', what='the words')

    def test_without_the_message_package_it_says_so_and_does_nothing(self):
        power = self.power(mhri={'motor_power': {'topic': 'power', 'type': 'no_such_msgs/Power'}})
        self.assertFalse(power.available)
        self.assertEqual(power.problem, 'cannot cut its motor power: no_such_msgs is '
                         'not installed here')
        for act in (power.cut, power.restore):
            self.at_once(act)
            self.assertEqual((power.state, power.is_cut), ('', False))

    def test_a_type_that_names_nothing_or_a_wrong_field_says_so(self):
        for parameters, words in (
                ({}, 'its type names no way'),
                ({'mhri': {'motor_power': {'topic': 'power', 'field': 'state'}}}, 'no field state'),
                ({'mhri': {'motor_power': {'topic': 'power', 'type': 'std_msgs/UInt8', 'cut': -1}}},
                 'std_msgs/UInt8: ')):
            power = self.power(**parameters)
            self.assertIn(words, power.problem)
            self.assertFalse(power.available)

    def test_whoever_takes_over_knows_of_the_cut_and_tells_it_again(self):
        parameter = '/{}/{}'.format(self.name, PARAMETER)
        switch, first = self.by_service()
        first.cut()
        wait_for(lambda: rospy.get_param(parameter, False), what='the word at the master')
        first.close()
        second = self.power(mhri={'motor_power': {'service': 'switch'}})
        wait_for(lambda: second.state == 'cut' and switch.called == [False, False], what='the cut')
        self.assertTrue(second.is_cut)
        second.restore()
        wait_for(lambda: not rospy.has_param(parameter), what='nothing left behind')
        wait_for(lambda: switch.called[-1] is True, what='the power')

    def test_what_its_own_emergency_stop_says(self):
        for said, stopped in ((Bool(True), True), (Bool(False), False)):
            with self.subTest(said=said.data):
                self.setUp()
                self.check_stop({'topic': 'e_stop'}, said, stopped)
        for value, stopped in ((2, True), (3, True), (1, False)):
            with self.subTest(said=value):
                self.setUp()
                self.check_stop({'topic': 'mode', 'type': 'std_msgs/UInt8', 'stopped': [2, 3]},
                                UInt8(value), stopped)

    def check_stop(self, spec, said, stopped):
        """Hear one message, and then nothing from nobody."""
        kind, errors = resolve_robot_type(robot_types()[0], self.name,
                                          {'mhri': {'hardware_stop': spec}})
        self.assertEqual(errors, [])
        heard = HardwareStop(self.name, kind)
        self.addCleanup(heard.close)
        self.assertIsNone(heard.stopped)
        publisher = rospy.Publisher('/{}/{}'.format(self.name, spec['topic']), type(said),
                                    queue_size=1, latch=True)
        publisher.publish(said)
        wait_for(lambda: heard.stopped is not None, what='the emergency stop')
        self.assertIs(heard.stopped, stopped)
        publisher.unregister()
        wait_for(lambda: heard.stopped is None, what='its end')

    def test_an_emergency_stop_that_cannot_be_read_is_said(self):
        for spec, words in (({'topic': 'a', 'type': 'no_such_msgs/Stop'}, 'no_such_msgs is not'),
                            ({'topic': 'a', 'field': 'state'}, 'no field state')):
            kind = resolve_robot_type(robot_types()[0], 'bot1', {'mhri': {'hardware_stop': spec}})
            heard = HardwareStop('bot1', kind[0])
            self.assertIn(words, heard.problem)
            self.assertIsNone(heard.stopped)
        heard = HardwareStop('bot1', robot_types()[0]['generic'])
        self.assertEqual((heard.stopped, heard.problem), (None, ''))


if __name__ == '__main__':
    rospy.init_node('motor_power_test')
    rostest.rosrun('mhri', 'motor_power', MotorPowerTest)
