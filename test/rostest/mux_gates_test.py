#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mux and the gates: a stop that outlives the mux, tasks, a mux that hangs, who is in control.

The gates are played by this test, which says what they say; the mux is the real one, started again
by roslaunch.
"""
import os
import signal
import sys
import threading
import time
import unittest

from geometry_msgs.msg import Twist, Vector3
import psutil
from rosgraph_msgs.msg import Log
from rostest_tools import (
    FORWARD, measured, moves, NEUTRAL, Process, Recorder, rests, Stick, StickProcess,
    twist_recorder, wait_until)
import rospy
import rostest
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger

from mhri.msg import ControlMode, DriveSettings, GatesState, RobotSelect, TeamTwist

# Commands are 50 ms apart: none for so long, and none comes any more [s].
SILENCE_S = 0.4


class Gates:
    """What the gates say of themselves, twice a second."""

    def __init__(self):
        self._topic = rospy.Publisher('/gates/state', GatesState, queue_size=10, latch=True)
        # Who serves it is believed.
        rospy.Service('/gates/take_control', Trigger, lambda request: (True, ''))
        self._state = GatesState()
        self._changed = threading.Condition()
        self._silent = False
        threading.Thread(target=self._run, daemon=True).start()

    def say(self, **state):
        """Say something else from now on."""
        with self._changed:
            for key, value in state.items():
                setattr(self._state, key, value)
            self._changed.notify()

    def be(self, silent):
        """Fall silent, or speak again."""
        with self._changed:
            self._silent = silent
            self._changed.notify()

    def _run(self):
        with self._changed:
            while not rospy.is_shutdown():
                if not self._silent:
                    self._topic.publish(self._state)
                self._changed.wait(0.5)


class MuxGates(unittest.TestCase):
    """One mux, one stick, one stand-in for the gates."""

    @classmethod
    def setUpClass(cls):
        """Open everything once."""
        cls.gates = Gates()
        cls.twists = twist_recorder()
        cls.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        cls.advice = Recorder('/mux/advice', String, lambda message: message.data)
        cls.stops = Recorder('/robot_controller/stop_all', Bool, lambda message: message.data)
        cls.tasks = Recorder('/robot_controller/task_twist', TeamTwist, lambda message: [
            (name, twist.linear.x) for name, twist in zip(message.robots, message.twists)])
        cls.log = Recorder('/rosout', Log, lambda message: message.msg)
        cls.task = rospy.Publisher('/mux_in/task', TeamTwist, queue_size=1, tcp_nodelay=True)
        cls.stick = Stick('/mux_in/joy')
        cls.set_stop = rospy.ServiceProxy('/mux/set_stop_all', SetBool)

    def setUp(self):
        """Begin ready: whichever mux runs now is connected, nothing is stopped."""
        self.set_stop.wait_for_service(10.0)
        for recorder in (self.twists, self.waits, self.advice, self.stops, self.tasks):
            recorder.wait_publisher()
        self.stick.wait_listener()
        wait_until(self.task.get_num_connections, 'the mux does not listen')
        self.gates.be(silent=False)
        self.gates.say(stop_all=False, operator='')
        self.stick.hold(NEUTRAL)
        wait_until(lambda: self.set_stop(False).success, 'not released')
        self.waits.wait(lambda _: self.waits.last() == '')

    def _drive(self):
        start = self.stick.hold(FORWARD)
        self.twists.wait(moves, start)

    def _restart_mux(self, forget):
        """Kill the mux as a power cut would, its memory at the master as well."""
        os.kill(_pid_of('/mux'), signal.SIGKILL)
        begun = time.monotonic()
        for name in forget:
            if rospy.has_param(name):
                rospy.delete_param(name)
        return begun

    def test_a_stop_comes_back_with_the_gates_where_master_and_mux_have_forgotten_it(self):
        self.assertTrue(self.set_stop(True).success)
        self.gates.say(stop_all=True)
        begun = self._restart_mux(['/mux/stop_all'])
        self.waits.wait(lambda value: value == 'release', begun + 0.1)
        self.stops.wait(lambda _: self.stops.last() is True, begun + 0.1)
        wait_until(lambda: rospy.get_param('/mux/stop_all', None), 'not written down')
        self.stick.wait_listener()
        start = self.stick.hold(FORWARD)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(start) if moves(item.value)])

    def test_a_second_operators_selection_does_not_stop_the_first_ones_robots(self):
        select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1)
        wait_until(select.get_num_connections, 'the mux does not listen')
        self.gates.say(operator='/other_panel')
        rospy.rostime.wallsleep(0.2)
        self._drive()
        start = time.monotonic()
        for number in range(10):
            select.publish(robots=['stranger{}'.format(number)])
            rospy.rostime.wallsleep(0.05)
        self.assertFalse([item for item in self.twists.since(start) if rests(item.value)])
        self.gates.say(operator='/mux_gates')
        rospy.rostime.wallsleep(0.2)
        select.publish(robots=['newcomer'])
        self.twists.wait(rests, start)
        select.unregister()

    def test_the_limits_are_those_that_the_gates_say_and_a_moving_robot_follows(self):
        limits = Recorder('/mux/speed_limit', Twist, lambda said: (said.linear.x, said.angular.z))
        self.addCleanup(limits.close)
        self.addCleanup(self.gates.say, settings=DriveSettings(0.5, 1.5, False, False, False))
        self._drive()
        begun = time.monotonic()
        self.gates.say(settings=DriveSettings(0.25, 1.0, False, False, False))
        got = self.twists.wait(lambda value: value == (0.25, 0.0), begun)
        measured('speed limit to command', got.at - begun)
        self.stick.hold((1.0, 0.0))
        self.twists.wait(lambda value: value == (0.0, 1.0), begun)
        limits.wait(lambda value: value == (0.25, 1.0))
        nan, inf = float('nan'), float('inf')
        for linear, angular in ((nan, 1.0), (1e30, 1.0), (0.3, inf), (-1.0, 1.0), (0.3, nan),
                                (0.0, 0.0)):
            start = time.monotonic()
            self.gates.say(settings=DriveSettings(linear, angular, False, False, False))
            self.twists.wait(lambda _: len(self.twists.since(start)) > 4)
            self.assertEqual({item.value for item in self.twists.since(start)}, {(0.0, 1.0)})
        self.assertEqual(limits.last(), (0.25, 1.0))

    def test_the_mode_is_chosen_by_the_operator_or_an_input_node_and_by_nobody_else(self):
        mode = Recorder('/mux/mode', ControlMode, lambda said: said.source)
        self.addCleanup(mode.close)
        mode.wait(lambda value: value == 'joy')
        strange = Process(['rostopic', 'pub', '-r', '10', '/mux_in/mode_select',
                           'mhri/ControlMode', 'pedal'])
        self.addCleanup(strange.end)
        mode.wait(lambda value: value == 'pedal')
        self.addCleanup(self.gates.say, operator='')
        self.gates.say(operator=rospy.get_name())
        wish = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1)
        self.addCleanup(wish.unregister)
        wait_until(wish.get_num_connections, 'the mux does not listen')
        begun = time.monotonic()
        # From here on the stranger has no say.
        wait_until(lambda: wish.publish(mode='joy') or mode.last() == 'joy', 'no joy')
        for _ in range(40):
            wish.publish(mode='joy')
            rospy.rostime.wallsleep(0.02)
        self.assertEqual({item.value for item in mode.since(begun)}, {'joy'})
        strange.end()
        voice = Process(['rostopic', 'pub', '-r', '10', '/mux_in/mode_select', 'mhri/ControlMode',
                         'pedal', '__name:=mhri_voice'])
        self.addCleanup(voice.end)
        mode.wait(lambda value: value == 'pedal', begun)
        voice.end()
        # What is merely repeated chooses nothing.
        begun = time.monotonic()
        for _ in range(20):
            wish.publish(mode='joy')
            rospy.rostime.wallsleep(0.02)
        self.assertEqual(mode.since(begun), [])
        wish.publish(mode='voice')
        mode.wait(lambda value: value == 'voice', begun)
        wish.publish(mode='joy')
        mode.wait(lambda value: value == 'joy', begun)

    def test_a_stop_that_the_gates_hold_for_a_second_is_the_muxs_as_well(self):
        self._drive()
        begun = time.monotonic()
        self.gates.say(stop_all=True)
        stop = self.stops.wait(lambda value: value is True, begun)
        took = measured('stop of the gates to stop of the mux', stop.at - begun)
        self.assertTrue(1.0 < took < 2.1, took)
        self.twists.wait(rests, begun)

    def test_a_release_is_not_taken_back_by_what_the_gates_said_before_it(self):
        self.set_stop(True)
        self.gates.say(stop_all=True)
        wait_until(lambda: self.set_stop(False).success, 'not released')
        released = time.monotonic()
        # The gates hear of it half a second later.
        wait_until(lambda: time.monotonic() - released > 0.5, 'no time passes')
        self.gates.say(stop_all=False)
        self.stops.wait(lambda _: len(self.stops.since(released)) > 5, released)
        self.assertEqual({item.value for item in self.stops.since(released + 0.05)}, {False})

    def test_gates_that_fall_silent_hold_everything_until_neutral(self):
        self._drive()
        silent = time.monotonic()
        self.gates.be(silent=True)
        zero = self.twists.wait(rests, silent)
        self.assertLess(measured('silent gates to zero', zero.at - silent), 1.55)
        self.gates.be(silent=False)
        self.waits.wait(lambda _: self.waits.last() == 'neutral')
        self.stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        self._drive()

    def test_whoever_takes_control_owns_the_virtual_joystick(self):
        """The other one is refused, and its stick, held out, drives nothing any more."""
        other = StickProcess('/mux_in/joy', 'other_panel')
        try:
            self._drive()
            other.hold(NEUTRAL)
            self.advice.wait(lambda words: '/other_panel' in words)
            begun = time.monotonic()
            self.gates.say(operator='/other_panel')
            self.twists.wait(rests, begun)
            self.waits.wait(lambda _: self.waits.last() == '', begun)
            other.hold((0.0, -1.0))
            backward = self.twists.wait(moves, begun + 0.05)
            self.twists.wait(lambda _: len(self.twists.since(backward.at)) > 20)
            self.assertEqual({item.value for item in self.twists.since(backward.at)},
                             {(-0.5, 0.0)})
        finally:
            other.process.end()
            self.gates.say(operator='/mux_gates')

    def _send_task(self, robots=('bot1', 'bot2'), speeds=(0.1, 0.2)):
        self.task.publish(TeamTwist(robots=list(robots), twists=[
            Twist(linear=Vector3(x=speed)) for speed in speeds]))
        return time.monotonic()

    def _time_of_task(self, speed):
        """Send it until it is passed on, as a task does ten times a second; return how long."""
        for _ in range(20):
            sent = self._send_task(speeds=(speed, 0.2))
            try:
                return self.tasks.wait(lambda value: value == [('bot1', speed), ('bot2', 0.2)],
                                       sent, 0.1).at - sent
            except AssertionError:
                # On a busy computer the mux may have to doubt its age.
                continue
        raise AssertionError('no task is passed on')

    def test_a_task_is_passed_on_at_once_and_not_under_a_stop(self):
        took = []
        for count in range(20):
            speed = 0.1 + count / 100.0
            took.append(self._time_of_task(speed))
        self.assertLess(measured('task, p50', sorted(took)[10]), 0.010)
        self.set_stop(True)
        stopped = time.monotonic()
        for _ in range(10):
            self._send_task()
        marker = time.monotonic()
        self.stops.wait(lambda _: len(self.stops.since(marker)) > 1)
        self.assertEqual(self.tasks.since(stopped), [])
        self.tasks.wait_silence(0.5)

    def test_a_task_that_cannot_be_used_is_refused_and_said(self):
        begun = time.monotonic()
        nan = float('nan')
        for robots, speeds, words in (
                (('bot1',), (0.1, 0.2), '1 robots and 2 twists'), (('bot 1',), (0.1,), 'space'),
                (('bot1',), (nan,), 'NaN'), (('bot1', 'bot1'), (0.1, 0.1), 'twice'),
                (['bot{}'.format(n) for n in range(10000)], 10000 * [0.1], 'at most 100')):
            asked = time.monotonic()

            def said(robots=robots, speeds=speeds, words=words, asked=asked):
                self._send_task(robots, speeds)
                # A word of this kind is said once a second; not all that time at full speed.
                rospy.rostime.wallsleep(0.05)
                return any(words in item.value for item in self.log.since(asked))
            wait_until(said, words)
        self.assertEqual(self.tasks.since(begun), [])

    def test_a_mux_that_hung_takes_nothing_old_for_a_centred_stick(self):
        """Stopped while its sockets fill: neutral at first, then out, as an operator would."""
        self._drive()
        pid = _pid_of('/mux')
        os.kill(pid, signal.SIGSTOP)
        try:
            hung = time.monotonic()
            self.stick.hold(NEUTRAL)
            wait_until(lambda: time.monotonic() - hung > 2.5, 'no time passes')
            # The newest word in the sockets is neutral; the operator's hand is elsewhere by now.
            self.stick.silence()
        finally:
            os.kill(pid, signal.SIGCONT)
        woken = time.monotonic()
        self.twists.wait(rests, woken)
        self.stick.hold(FORWARD)
        self.twists.wait_silence(SILENCE_S)
        self.assertFalse([item for item in self.twists.since(woken) if moves(item.value)])
        self.stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        self._drive()


def _pid_of(node):
    """Return the number of a node's process, also of one that hangs: by the port it listens at."""
    port = int(rospy.get_master().lookupNode(node)[2].rsplit(':', 1)[1].strip('/'))
    for process in psutil.process_iter():
        try:
            ports = [entry.laddr.port for entry in process.connections('tcp')
                     if entry.status == 'LISTEN']
        except psutil.Error:
            continue
        if port in ports:
            return process.pid
    raise AssertionError('no process of this computer is ' + node)


if __name__ == '__main__':
    rospy.init_node('mux_gates')
    rostest.rosrun('mhri', 'mux_gates', MuxGates, sys.argv)
