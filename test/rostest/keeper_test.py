#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gates of the panel and those of its keeper: one of the two speaks, whatever ends."""
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

from geometry_msgs.msg import Twist
import psutil
import rosgraph
import rospy
import rostest
from std_msgs.msg import Bool

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.core.robots.robot_types import Limits  # noqa: E402
from mhri.msg import RobotSelect  # noqa: E402
from mhri.ros.driving.gate import Gate  # noqa: E402
from mhri.ros.driving.gates import GateBank  # noqa: E402
from mhri.ros.driving.keeper import KeeperLink  # noqa: E402
from mhri.ros.resources import robot_types  # noqa: E402
from support.deaf_robot import DeafRobot  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

START_S = 60.0
ZERO = (0.0, 0.0)


class Pilot:
    """The mux's part: the one command, again and again, until it is told to stop."""

    def __init__(self, publisher):
        self._publisher = publisher
        self._value = None
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        while not rospy.is_shutdown():
            value = self._value
            if value is not None:
                message = Twist()
                message.linear.x = value
                self._publisher.publish(message)
            time.sleep(0.05)

    def drive(self, value):
        """Go on with this speed [m/s]; None: silence."""
        self._value = value


class KeeperTest(unittest.TestCase):
    """A panel's gates here, its keeper as a child."""

    number = 0

    @classmethod
    def setUpClass(cls):
        cls.generic = robot_types()[0]['generic']
        cls.twist = rospy.Publisher('/robot_controller/twist', Twist, queue_size=10)
        cls.select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=10,
                                     latch=True)
        cls.stop = rospy.Publisher('/robot_controller/stop_all', Bool, queue_size=10, latch=True)
        cls.pilot = Pilot(cls.twist)

    def setUp(self):
        self.stop.publish(False)
        self.bank = GateBank()
        self.link = KeeperLink(self.bank)
        self.link.start()
        self.bank.start()
        self.addCleanup(self.end)

    def end(self):
        self.pilot.drive(None)
        self.link.end()
        self.bank.close()
        self.bank.unregister()

    def robot(self):
        """Add a robot and wait until the keeper leads it; return (name, gate, receiving end)."""
        KeeperTest.number += 1
        name = 'kept{}'.format(KeeperTest.number)
        end = VelocityEnd('/{}/cmd_vel'.format(name))
        gate = Gate.of_type(name, self.generic)
        self.bank.add(gate)
        self.led(gate)
        return name, gate, end

    def led(self, gate):
        wait_for(lambda: gate.follows, START_S, 'the keeper to lead')

    def driven(self, value=0.2):
        """Return a robot that is being driven, through the keeper."""
        name, gate, end = self.robot()
        self.select.publish([name])
        self.pilot.drive(value)
        wait_for(lambda: (value, 0.0) in end.values(), START_S, 'the robot to be driven')
        return name, gate, end

    def child(self):
        """Return the process of the keeper."""
        return psutil.Process(self.link._process.pid)

    def zero_after(self, end, when, what):
        """Wait for a zero; print and return how long it took [s]."""
        def zeros():
            return [entry for entry in end.after(when) if entry[1:] == ZERO]
        wait_for(zeros, 5.0, 'the zero')
        delay = zeros()[0][0] - when
        print('MEASURED first zero, {}: {:.1f} ms'.format(what, delay * 1e3))
        return delay

    def test_each_command_arrives_once_and_from_the_keeper(self):
        name, _, end = self.driven()
        self.pilot.drive(None)
        wait_for(lambda: end.values()[-1] == ZERO, 5.0, 'the zero of a stale command')
        end.received[:] = []
        for number in range(1, 101):
            message = Twist()
            message.linear.x = number / 1000.0
            self.twist.publish(message)
            wait_for(lambda: end.values() and end.values()[-1][0] == number / 1000.0, 5.0, 'it')
        self.assertEqual([value for value, _ in end.values()],
                         [number / 1000.0 for number in range(1, 101)])
        others = {header.get('callerid') for header in (
            link.header for link in end._subscriber.impl.connections)}
        self.assertEqual(len(others), 2, 'the keeper and the panel: {}'.format(others))

    def test_every_way_to_stop_is_one_zero(self):
        name, gate, end = self.driven()
        ways = {'deselected': lambda: self.select.publish([]),
                'deselected in the panel': lambda: self.bank.deselect_others([]),
                'stop-all of the mux': lambda: self.stop.publish(True),
                'stop-all of the panel': self.bank.press_stop}
        for what, way in ways.items():
            when = time.monotonic()
            way()
            self.assertLess(self.zero_after(end, when, what), 0.25, 'promised: 50 ms')
            again = len(end.received)
            # The commands go on; a hundred of another robot's prove that nothing more came here.
            other = VelocityEnd('/robot_controller/twist')
            wait_for(lambda: len(other.received) > 10, 10.0, 'commands that are not for it')
            self.assertEqual(len(end.received), again, what)
            self.assertEqual([entry[1:] for entry in end.after(when)].count(ZERO), 1, what)
            other._subscriber.unregister()
            self.bank.withdraw_press()
            self.stop.publish(False)
            self.select.publish([])
            wait_for(lambda: not gate.rule.selected and not gate.rule.stopped, 5.0, 'the release')
            self.select.publish([name])
            wait_for(lambda: end.values()[-1] == (0.2, 0.0), 10.0, 'it to be driven again')

    def test_a_group_keeps_together_and_to_a_slow_link(self):
        name, gate, end = self.robot()
        KeeperTest.number += 1
        slow = 'kept{}'.format(KeeperTest.number)
        slow_end = VelocityEnd('/{}/cmd_vel'.format(slow))
        slow_gate = Gate(slow, ['/{}/cmd_vel'.format(slow)], Limits(0.1, 1.0))
        self.bank.add(slow_gate)
        self.led(slow_gate)
        self.select.publish([name, slow])
        self.pilot.drive(0.2)

        def told(speeds):
            wait_for(lambda: (end.values()[-1:], slow_end.values()[-1:])
                     == tuple([(speed, 0.0)] for speed in speeds), 10.0, str(speeds))
        told((0.2, 0.1))
        self.bank.set_pace(True, 1.0)
        told((0.1, 0.1))
        self.bank.set_pace(False, 0.5)
        told((0.1, 0.1))
        self.pilot.drive(0.1)
        told((0.05, 0.05))
        self.bank.set_pace(True, 1.0)
        self.pilot.drive(0.2)
        told((0.1, 0.1))
        self.select.publish([name])
        told((0.2, 0.0))

    def test_the_last_word_on_the_selection_holds_however_fast_they_come(self):
        first, _, first_end = self.robot()
        second, _, second_end = self.robot()
        self.pilot.drive(0.2)
        for number in range(40):
            # As two clicks do: each closes what is not selected at once, and says so on the topic.
            for names in ([first], [first, second], [second]):
                self.bank.deselect_others(names)
                self.select.publish(names)
            when = time.monotonic()
            wait_for(lambda: (0.2, 0.0) in [entry[1:] for entry in second_end.after(when)], 10.0,
                     'the robot selected last to be driven, time {}'.format(number))
            first, second = second, first
            first_end, second_end = second_end, first_end

    def test_closing_is_one_zero_by_the_keeper(self):
        _, _, end = self.driven()
        keeper = self.child()
        when = time.monotonic()
        self.link.end()
        self.bank.close()
        self.assertLess(self.zero_after(end, when, 'program closed'), 0.25, 'promised: 50 ms')
        keeper.wait(20)
        self.assertEqual([entry[1:] for entry in end.after(when)].count(ZERO), 1)
        self.assertEqual(end.values()[-1], ZERO)

    def test_a_removed_robot_gets_one_zero(self):
        name, gate, end = self.driven()
        when = time.monotonic()
        self.bank.remove(name)
        gate.unregister()
        self.zero_after(end, when, 'robot removed')
        wait_for(lambda: not end.connected(), 10.0, 'both to give the topic back')
        self.assertEqual([entry[1:] for entry in end.after(when)][-1], ZERO)

    def test_the_panel_takes_over_from_a_keeper_that_was_killed(self):
        name, gate, end = self.driven()
        keeper, when = self.child(), time.monotonic()
        keeper.kill()
        wait_for(lambda: not gate.follows, 5.0, 'the panel to lead')
        print('MEASURED keeper killed: the panel leads after {:.1f} ms'.format(
            (time.monotonic() - when) * 1e3))
        wait_for(lambda: len(end.after(time.monotonic() - 0.1)) > 1, 5.0, 'commands')
        times = [when] + [entry[0] for entry in end.after(when)]
        print('MEASURED keeper killed: longest pause of the commands {:.0f} ms (20 Hz)'.format(
            max(late - early for early, late in zip(times, times[1:])) * 1e3))
        when = time.monotonic()
        self.select.publish([])
        self.assertLess(self.zero_after(end, when, 'deselected with the keeper killed'), 0.25)
        self.led(gate)
        self.assertNotEqual(self.child().pid, keeper.pid, 'there is a new keeper')
        self.select.publish([name])
        wait_for(lambda: end.values()[-1] == (0.2, 0.0), 10.0, 'it to be driven by the new one')
        when = time.monotonic()
        self.bank.press_stop()
        self.zero_after(end, when, 'stop-all through the new keeper')

    def test_a_keeper_that_is_replaced_leaves_no_gap_and_no_trace(self):
        """After a robot of which it had to drop the connection is back; another one goes on."""
        name, gate, end = self.robot()
        other, other_gate, other_end = self.robot()
        self.select.publish([name, other])
        self.pilot.drive(0.2)
        for one in (end, other_end):
            wait_for(lambda: (0.2, 0.0) in one.values(), START_S, 'both to be driven')
        keeper, began = self.child(), time.monotonic()
        before = self.keepers_of(gate)
        self.link._take('dropped', name)
        self.assertFalse(gate.follows, 'the panel speaks for it')
        self.zero_after(end, began, 'its connection was dropped')
        when = time.monotonic()
        wait_for(lambda: len(other_end.after(when)) > 10, 5.0, 'commands of the other one')
        # One of each process: in truth this keeper has a connection still.
        self.assertEqual([entry[1:] for entry in end.after(began)][-2:], [ZERO, ZERO])
        sent = len(end.received)
        when = time.monotonic()
        self.bank.hold(name, False)
        wait_for(lambda: not keeper.is_running() or keeper.status() == psutil.STATUS_ZOMBIE, 5.0,
                 'the keeper to leave')
        self.led(gate)
        self.led(other_gate)
        times = [when] + [entry[0] for entry in other_end.after(when)]
        print('MEASURED keeper replaced: longest pause of the commands {:.0f} ms (20 Hz)'.format(
            max(late - early for early, late in zip(times, times[1:])) * 1e3))
        self.assertNotIn(ZERO, [entry[1:] for entry in other_end.after(began)])
        self.assertEqual(len(end.received), sent, 'it waits for a centred stick')
        self.pilot.drive(0.0)
        wait_for(lambda: len(end.received) > sent, 5.0, 'the zero of the centred stick')
        self.pilot.drive(0.2)
        wait_for(lambda: end.values()[-1] == (0.2, 0.0), 5.0, 'it to be driven again')
        wait_for(lambda: len(self.keepers_of(gate)) == 1, 10.0, 'one keeper')
        self.assertNotEqual(self.keepers_of(gate), before, 'the old one is still registered')

    @staticmethod
    def keepers_of(gate):
        """Return the names of the keepers that the master knows for a robot."""
        publishers = dict(rosgraph.Master('/keeper_test').getSystemState()[0])
        return [node for node in publishers.get(gate.topics[0], ()) if 'gate_keeper' in node]

    def test_a_zero_that_died_with_the_keeper_is_said_again(self):
        _, gate, end = self.driven()
        self.child().send_signal(signal.SIGSTOP)
        when = time.monotonic()
        self.select.publish([])
        delay = self.zero_after(end, when, 'deselected while the keeper hangs')
        self.assertLess(delay, 1.5, 'promised: 0.55 s')
        self.led(gate)

    def test_a_robot_that_missed_the_announcement_of_a_keeper_gets_another(self):
        """The master tells once; a robot that was out of reach then hears of no keeper."""
        KeeperTest.number += 1
        name = 'kept{}'.format(KeeperTest.number)
        deaf = DeafRobot('/{}/cmd_vel'.format(name))
        self.addCleanup(deaf.close)
        gate = Gate.of_type(name, self.generic)
        self.bank.add(gate)
        wait_for(lambda: any('gate_keeper' in names for names in deaf.told), START_S,
                 'the keeper to be announced')
        deaf.told[:] = []
        self.bank.announce(name)
        wait_for(lambda: any('gate_keeper' in names for names in deaf.told), 10.0,
                 'the keeper to be announced again')
        self.assertIn(rospy.get_name(), deaf.told[-1], 'and the panel')
        VelocityEnd('/{}/cmd_vel'.format(name))
        self.led(gate)
        deaf.told[:] = []
        self.bank.announce(name)
        self.bank.remove(name)
        gate.unregister()
        wait_for(lambda: deaf.told and rospy.get_name() not in deaf.told[-1], 10.0, 'the end')
        self.assertLess(len(deaf.told), 6, 'a robot that listens was told again')

    def test_a_press_before_there_is_a_keeper_holds_in_it(self):
        name, gate, end = self.driven()
        self.child().kill()
        self.bank.press_stop()
        self.led(gate)
        when = time.monotonic()
        other = VelocityEnd('/robot_controller/twist')
        wait_for(lambda: len(other.received) > 20, 10.0, 'a second of commands')
        self.assertNotIn((0.2, 0.0), [entry[1:] for entry in end.after(when)])
        other._subscriber.unregister()

    def test_a_keeper_that_waits_for_a_master_ends_with_its_panel(self):
        environment = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:9')
        keeper = subprocess.Popen(
            [sys.executable, '-c', 'from mhri.nodes.gate_keeper import main; main()', '1'],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            env=environment)
        self.addCleanup(keeper.kill)
        keeper.stdin.write(b'["select", []]\n')
        keeper.stdin.close()
        self.assertEqual(keeper.wait(START_S), 0)

    def test_a_killed_panel_leaves_a_keeper_that_sends_the_zeros(self):
        KeeperTest.number += 1
        name = 'kept{}'.format(KeeperTest.number)
        end = VelocityEnd('/{}/cmd_vel'.format(name))
        panel = subprocess.Popen([sys.executable, '-c', KILLED_PANEL, name],
                                 stdout=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(panel.stdout.close)
        self.assertEqual(panel.stdout.readline().strip(), 'led by its keeper')
        self.select.publish([name])
        self.pilot.drive(0.2)
        wait_for(lambda: (0.2, 0.0) in end.values(), START_S, 'the robot to be driven')
        when = time.monotonic()
        panel.kill()
        panel.wait()
        self.zero_after(end, when, 'SIGKILL of the panel')
        # The commands go on: the keeper must be deaf to them from now on, until it has ended.
        wait_for(lambda: not end.connected(), 20.0, 'the keeper to end')
        values = [entry[1:] for entry in end.after(when)]
        self.assertEqual(set(values[values.index(ZERO):]), {ZERO})


KILLED_PANEL = """
import sys, time
import rospy
from mhri.ros.driving.gate import Gate
from mhri.ros.driving.gates import GateBank
from mhri.ros.driving.keeper import KeeperLink
from mhri.ros.resources import robot_types
rospy.init_node('killed_panel', disable_signals=True)
bank = GateBank()
KeeperLink(bank).start()
bank.start()
gate = Gate.of_type(sys.argv[1], robot_types()[0]['generic'])
bank.add(gate)
while not gate.follows:
    time.sleep(0.02)
print('led by its keeper', flush=True)
time.sleep(1000)
"""


if __name__ == '__main__':
    rospy.init_node('keeper_test')
    rostest.rosrun('mhri', 'keeper', KeeperTest)
