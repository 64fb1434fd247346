# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the gates share: the real node, beside a mux and an operator played here."""
import os
import signal
import subprocess
import unittest

import roslib.packages
import rospy

from rostest_tools import measured, Process
from support.fake_mux import FakeMux, FakeOperator, StateEar
from support.random_world import RESTARTER
from support.ros_system import children, wait_for
from support.velocity import VelocityEnd

ZERO = (0.0, 0.0)
# The next gates have said zero by then, on a busy computer [s]; promised: 1.5 s.
NEXT_S = 2.5


def start_gates(stand_by=False, output=None):
    """Start the real gates node, as mhri.launch does or alone; ``output``: where it writes."""
    words = roslib.packages.find_node('mhri', 'gates')[:1]
    return Process(['bash', '-c', RESTARTER, 'restarter'] + words + ['--stand-by']
                   if stand_by else words, output=output)


def end(process):
    """Let a process end by itself, and make sure."""
    for number in children(process.number):
        os.kill(number, signal.SIGTERM)
    process.send(signal.SIGTERM)
    try:
        process.wait()
    except subprocess.TimeoutExpired:
        pass
    process.end()


class GatesCase(unittest.TestCase):
    """Gates, and robots that are added, checked and centred."""

    number = 0
    stand_by = False
    output = None

    @classmethod
    def setUpClass(cls):
        cls.mux, cls.operator, cls.state = FakeMux(), FakeOperator(), StateEar()
        GatesCase.gates = start_gates(cls.stand_by, cls.output)
        cls.wait_for_mux()

    @classmethod
    def tearDownClass(cls):
        end(GatesCase.gates)

    @classmethod
    def wait_for_mux(cls):
        cls.state.message = None
        cls.state.wait(lambda state: state.mux == rospy.get_name() and state.mux_heard,
                       'the gates to believe the mux', 20.0)
        wait_for(lambda: cls.mux.twist.get_num_connections()
                 and cls.mux.task_twist.get_num_connections(), what='the gates to listen')

    def setUp(self):
        self.mux.stop(False)
        self.operator.check()
        self.state.wait(lambda state: not state.stop_all and state.operator == rospy.get_name(),
                        'a quiet start')

    def robots(self, count, kind=None, topic='cmd_vel'):
        """Add robots, checked; return [(name, receiving end)] once the gates reach them."""
        made = []
        for _ in range(count):
            GatesCase.number += 1
            name = 'gate{}'.format(GatesCase.number)
            if kind:
                rospy.set_param('/{}/robot_type'.format(name), kind)
            made.append((name, VelocityEnd('/{}/{}'.format(name, topic))))
        self.operator.check(*[name for name, _ in made])
        for name, _ in made:
            self.state.wait_robot(name, lambda gate: gate.topic and gate.obeys == 'operator',
                                  'the gate of ' + name, 20.0)
        for name, receiver in made:
            self.centre(name, receiver)
        return made

    def centre(self, name, receiver):
        """Centre the stick until the robot is ready to be driven."""
        wait_for(lambda: self.mux.say(0.0) and self.state.robot(name) is not None
                 and not self.state.robot(name).stands, what='the robot to be ready', poll_s=0.05)
        when = self.mux.say(0.0)
        wait_for(lambda: receiver.after(when), what='the zero')
        rospy.rostime.wallsleep(0.05)

    def drive(self, receiver, linear, angular=0.0):
        """Publish one command and return what arrives."""
        when = self.mux.say(linear, angular)
        wait_for(lambda: receiver.after(when), what='the command')
        return receiver.after(when)[-1][1:]

    def drive_all(self, made, linear):
        """Publish one command; return once every robot has it, so that none is under way."""
        when = self.mux.say(linear)
        for name, receiver in made:
            wait_for(lambda: receiver.after(when), what='the command for ' + name)

    def first_zero(self, what, receiver, when, within_s):
        """Wait for the next message, which has to be a zero and in time."""
        wait_for(lambda: receiver.after(when), what='the zero: ' + what)
        at, *value = receiver.after(when)[0]
        self.assertEqual(tuple(value), ZERO)
        self.assertLess(measured('first zero, ' + what, at - when), within_s)

    def stays_at_rest(self, receiver, when, linear=0.2, commands=20):
        """Hold the stick for a while; whatever comes is a zero."""
        for _ in range(commands):
            self.mux.say(linear)
            rospy.rostime.wallsleep(0.02)
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})
