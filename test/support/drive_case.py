# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the drive share: the real node, driven through its inputs by an operator."""
import contextlib
import os
import shutil
import signal
import tempfile
import time
import unittest

import roslib.packages
import rospy
from std_srvs.srv import SetBool

from support import graph
from support.fake_mux import FakeOperator, StateEar
from support.ros_system import children, wait_for
from support.node_tools import measured, NEUTRAL, Process, Stick
from support.velocity import VelocityEnd

ZERO = (0.0, 0.0)
# Who follows a drive that is killed right after its start waits, and remembers nothing [s].
OLD_S = 2.5


class Driver(FakeOperator):
    """The operator in control, with the virtual joystick in the hand."""

    def __init__(self):
        super().__init__()
        self.stick = Stick(graph.STICK)
        self._set_stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)

    def push(self, linear, angular=0.0):
        """Hold the stick for a velocity from now on [m/s, rad/s]; return when."""
        return self.stick.hold((angular / self.limits[1], linear / self.limits[0]))

    def centre(self):
        """Let the stick go; return when."""
        return self.stick.hold(NEUTRAL)

    def stop(self):
        """Stop everything; return when [s, monotonic]."""
        when = time.monotonic()
        self._set_stop(True)
        return when

    def release(self):
        """Release the stop with the stick centred."""
        self.centre()
        wait_for(lambda: self._set_stop(False).success, what='the release', poll_s=0.02)


class DriveCase(unittest.TestCase):
    """The drive, and robots that are added, selected and ready; it stands by, as in mhri.launch."""

    number = 0
    output = None

    @classmethod
    def setUpClass(cls):
        home = tempfile.mkdtemp(prefix='mhri_drive_')
        cls.addClassCleanup(shutil.rmtree, home, ignore_errors=True)
        cls.home = os.path.join(home, 'mhri')
        cls.operator, cls.state = Driver(), StateEar()
        cls.operator.check()
        cls.start_drive()
        cls.addClassCleanup(lambda: cls.end_drive())

    @classmethod
    def start_drive(cls):
        """Start the drive, and wait until it listens and this node is in control."""
        before = cls.state.message.run if cls.state.message else ''
        cls.launch_drive()
        cls.wait_for_drive(before)

    @classmethod
    def launch_drive(cls):
        """Start the drive with what stands by; return at once."""
        cls.drive_process = Process(
            roslib.packages.find_node('mhri', 'mux')[:1] + ['--stand-by'],
            {'ROS_HOME': os.path.dirname(cls.home)}, output=cls.output)

    @classmethod
    def kill_both(cls):
        """Kill the drive and what stands by, and start both anew as roslaunch does."""
        run = cls.state.message.run
        for number in (cls.drive_process.number, cls.worker()):
            os.kill(number, signal.SIGKILL)
        cls.drive_process.end()
        cls.launch_drive()
        cls.state.wait(lambda state: state.run != run, 'the next one', 20.0)

    @classmethod
    def wait_for_drive(cls, before):
        """Wait for another run of the drive than the one before, with this node in control."""
        cls.state.wait(lambda state: state.run != before and state.operator == rospy.get_name()
                       and state.leased, 'the drive to listen', 20.0)
        cls.operator.stick.wait_listener()

    @classmethod
    def end_drive(cls):
        """Let the drive end by itself, and make sure; return when it was asked to."""
        when = cls.drive_process.send(signal.SIGTERM)
        with contextlib.suppress(Exception):
            cls.drive_process.wait()
        cls.drive_process.end()
        return when

    @classmethod
    def worker(cls):
        """Return the number of the process that drives, None while there is none."""
        return next(iter(children(cls.drive_process.number)), None)

    @classmethod
    def kill_drive(cls):
        """Kill the process that drives; return (when, the run that has ended)."""
        # The process is older than its work: it stood by.
        wait_for(lambda: time.monotonic() - cls.state.run_at > OLD_S, what='a while', poll_s=0.1)
        number, run = wait_for(cls.worker, what='the drive'), cls.state.message.run
        when = time.monotonic()
        os.kill(number, signal.SIGKILL)
        return when, run

    @classmethod
    def start_second(cls):
        """Start another drive of the same name, whereupon the first one ends."""
        run, first = cls.state.message.run, cls.drive_process
        cls.launch_drive()
        cls.state.wait(lambda state: state.run != run, 'the second one', 20.0)
        first.end()

    def setUp(self):
        self.operator.check()
        self.operator.set()
        # What was said before may be of a drive that the last test has ended.
        if self.state.wait(lambda state: True, 'the drive').operator != rospy.get_name():
            self.operator.take()
        self.operator.release()
        self.state.wait(lambda state: not state.stop_all and state.operator == rospy.get_name()
                        and not any(robot.selected for robot in state.robots), 'a quiet start')

    @staticmethod
    def next_name():
        """Return the name of the robot that is added next."""
        return 'robot{}'.format(DriveCase.number + 1)

    @staticmethod
    def new_name():
        """Return the name of a robot that there was not yet."""
        DriveCase.number += 1
        return 'robot{}'.format(DriveCase.number)

    def robots(self, count, kind=None, topic='cmd_vel'):
        """Add robots, selected; return [(name, receiving end)] once they are ready to be driven."""
        made = []
        for _ in range(count):
            name = self.new_name()
            if kind:
                rospy.set_param('/{}/robot_type'.format(name), kind)
            made.append((name, VelocityEnd('/{}/{}'.format(name, topic))))
        self.operator.check(*[name for name, _ in made])
        self.ready(*[name for name, _ in made])
        return made

    def wait_robot(self, name, good, what):
        """Wait until what is said of a robot is good; return it."""
        return self.state.wait_robot(name, good, what)

    def select_anew(self, *names, besides=()):
        """Select robots after a selection without them, which is ``besides``."""
        self.operator.check(*besides)
        # One that has just started has selected nobody. Leased, it hears what this node says.
        self.state.wait(lambda state: state.leased and state.operator == rospy.get_name()
                        and not any(robot.selected and robot.name in names
                                    for robot in state.robots), 'the end of the selection')
        self.operator.check(*names, *besides)

    def waits(self, name):
        """Wait until a selected robot does not move before the stick has been centred."""
        self.wait_robot(name, lambda robot: robot.selected and (
            robot.stands == 'joining'
            or not robot.stands and self.state.message.waits_for == 'neutral'), 'the wait')

    def ready(self, *names):
        """Centre the stick until selected robots are ready to be driven."""
        when = self.operator.centre() + 0.05

        def are():
            found = [self.state.robot(name) for name in names]
            return self.state.at > when and not self.state.message.waits_for and all(
                robot and robot.topic and robot.selected and not robot.stands for robot in found)
        wait_for(are, what=lambda: '{} to be ready; waits for {!r}, {}'.format(
            names, self.state.message.waits_for, [
                (robot.name, robot.selected, robot.stands) for robot in self.state.message.robots]))

    def drive(self, receiver, linear, angular=0.0):
        """Push the stick; return what arrives."""
        when = self.operator.push(linear, angular)

        def arrived():
            # What was under way before may come behind.
            told = [value for at, *value in receiver.after(when + 0.03)]
            return len(told) > 1 and told[-2] == told[-1] != list(ZERO) and tuple(told[-1])
        return wait_for(arrived, what=lambda: 'the command, after {}'.format(
            receiver.received[-5:]))

    def keep_on(self, good, what, linear, angular=0.0):
        """Hold the stick until something is good; return that.

        It is centred where the drive asks for that.
        """
        def there():
            state = self.state.message
            asks = state.waits_for == 'neutral' or any(
                robot.selected and robot.stands == 'joining' for robot in state.robots)
            self.operator.push(*(ZERO if asks else (linear, angular)))
            return good()
        return wait_for(there, what=what, poll_s=0.05)

    def first_zero(self, what, receiver, when, within_s):
        """Wait for the next zero, behind which nothing moves any more, and which is in time."""
        wait_for(lambda: ZERO in [entry[1:] for entry in receiver.after(when)],
                 what='the zero: ' + what)
        told = receiver.after(when)
        first = next(at for at, *value in told if tuple(value) == ZERO)
        measured('first zero, ' + what, first - when, within_s)
        self.assertLessEqual({entry[1:] for entry in told if entry[0] >= first}, {ZERO})
        return first

    def stays_at_rest(self, receiver, when, linear=0.25, seconds=0.4):
        """Hold the stick for a while; whatever came since a time is a zero."""
        begun = self.operator.push(linear)
        wait_for(lambda: time.monotonic() - begun > seconds, what='a while', poll_s=0.02)
        self.assertLessEqual({entry[1:] for entry in receiver.after(when)}, {ZERO})

    def zeros_then_silence(self, receiver, first):
        """See zeros at 20 Hz for half a second since the first one, and then nothing.

        They are counted: a busy computer may read several at once, or be late with them.
        """
        wait_for(lambda: len(receiver.after(first)) >= 5, what='the zeros')
        wait_for(receiver.is_silent, what='silence', poll_s=0.02)
        told = receiver.after(first)
        self.assertEqual({entry[1:] for entry in told}, {ZERO})
        self.assertLessEqual(len(told), 13, told)
