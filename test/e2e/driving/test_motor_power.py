# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The power of a robot's motors, by topic and by service; and what its own emergency stop says."""
import sys
import threading
import time
import unittest

import rospy
from std_msgs.msg import Bool, UInt8
from std_srvs.srv import SetBool, SetBoolResponse

from support.own_node import own_node  # noqa: E402
from support.paths import MESSAGES
try:
    from kobuki_msgs.msg import MotorPower as KobukiPower
except ImportError:
    sys.path.insert(0, MESSAGES)
    from kobuki_msgs.msg import MotorPower as KobukiPower

from mhri.base.robot_types import resolve_robot_type  # noqa: E402
from mhri.driving.ros.motor_power import MotorPower, PARAMETER  # noqa: E402
from mhri.graph.ros.messages import MessageMissing  # noqa: E402
from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.robots.ros.streams import HARDWARE_STOP  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

system = own_node('motor_power')


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
                wait_for(lambda: power.state == 'cut_sent', what='the words')
                self.assertTrue(power.is_cut)
                self.at_once(power.restore)
                wait_for(lambda: len(base.heard) > 1, what='the power')
                wait_for(lambda: power.state == 'on', what='the words')
                # Connected while the cut was due, it may have been told of that twice.
                self.assertEqual([base.heard[0], base.heard[-1]], words)
                self.assertEqual(base.heard.count(words[1]), 1)

    def test_a_base_that_comes_up_later_is_told(self):
        power = self.power(robot_type='turtlebot3')
        power.cut()
        why = 'no robot listens to /{}/motor_power'.format(self.name)
        wait_for(lambda: power.problem == why, what='the reason')
        for _ in range(2):
            base = self.base('motor_power', Bool, 'data')
            wait_for(lambda: base.heard, what='the cut')
            self.assertEqual(set(base.heard), {False})
            wait_for(lambda: power.state == 'cut_sent', what='the words')
            base.close()

    def test_a_service_confirms_and_one_that_refuses_is_quoted_and_asked_again(self):
        switch, power = self.by_service()
        switch.refuses = True
        power.cut()
        wait_for(lambda: power.problem.endswith('refuses: the key is turned'), what='the reason')
        switch.refuses = False
        wait_for(lambda: power.state == 'cut', what='the answer')
        self.at_once(power.restore)
        wait_for(lambda: power.state == 'on', what='the answer')
        self.assertIs(switch.called[-1], True)

    def test_a_service_that_hangs_delays_nothing(self):
        switch, power = self.by_service()
        switch.hangs.set()
        self.at_once(power.cut)
        wait_for(lambda: power.problem == 'no answer for 3 s', what='the reason')
        wait_for(lambda: power.state == 'cut', what='the second call')
        self.assertEqual(switch.called, [False])

    def test_a_type_that_names_nothing_or_a_wrong_field_says_so(self):
        for parameters, words in (
                ({}, 'its type names no way'),
                ({'mhri': {'motor_power': {'topic': 'power', 'type': 'no_such_msgs/Power'}}},
                 'no_such_msgs is not installed here'),
                ({'mhri': {'motor_power': {'topic': 'power', 'field': 'state'}}}, 'no field state'),
                ({'mhri': {'motor_power': {'topic': 'power', 'type': 'std_msgs/UInt8', 'cut': -1}}},
                 'std_msgs/UInt8: ')):
            power = self.power(**parameters)
            self.assertIn(words, power.problem)
            for act in (power.cut, power.restore):
                self.at_once(act)
                self.assertEqual((power.available, power.state, power.is_cut),
                                 (False, 'cannot', False))

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
        heard = HARDWARE_STOP.stream(self.name, kind)
        self.addCleanup(heard.close)
        heard.open()
        self.assertIsNone(heard.value_while_connected())
        publisher = rospy.Publisher('/{}/{}'.format(self.name, spec['topic']), type(said),
                                    queue_size=1, latch=True)
        publisher.publish(said)
        wait_for(lambda: heard.value_while_connected() is not None, what='the emergency stop')
        self.assertIs(heard.value_while_connected(), stopped)
        publisher.unregister()
        wait_for(lambda: heard.value_while_connected() is None, what='its end')

    def test_an_emergency_stop_that_cannot_be_read_is_said(self):
        for spec, words in (({'topic': 'a', 'type': 'no_such_msgs/Stop'}, 'no_such_msgs is not'),
                            ({'topic': 'a', 'field': 'state'}, 'no field state')):
            kind = resolve_robot_type(robot_types()[0], 'bot1', {'mhri': {'hardware_stop': spec}})
            with self.assertRaisesRegex(MessageMissing, words):
                HARDWARE_STOP.stream('bot1', kind[0])
        self.assertEqual(HARDWARE_STOP.stream('bot1', robot_types()[0]['generic']).topics, ())
