# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories at the real drive: used by their messages, services and actions, and ended."""
import os
import signal
import time

from nav_msgs.msg import Odometry
import rospy

from mhri.base.robot_types import SILENT_AFTER_S
from mhri.driving.accessory_rule import SILENT_S
from support.accessories_case import AccessoriesCase
from support.own_node import own_node
from support.ros_system import freeze, wait_for

system = own_node('accessories')

# What is promised of the zero of a robot holds for the neutral value of a moving part [s].
STOP_S, KILLED_S, HUNG_S = 0.05, 0.05, 0.6


class AccessoriesTest(AccessoriesCase):

    def test_each_kind_is_told_with_its_own_message(self):
        self.use('lamp', 'on')
        wait_for(lambda: self.tools.last('lamp') is True, what='the lamp')
        self.flip(1.0, 1.0)
        self.held['head'] = (-1.0, 1.0)
        wait_for(lambda: self.tools.last('head') == (-1.5, 0.8), what='the head')
        self.use('horn', 'on')
        wait_for(lambda: self.tools.last('horn') is True, what='the horn')
        self.use('arm', 'close')
        wait_for(lambda: self.tools.last('arm') == 4, what='the arm')

    def test_a_state_is_unknown_until_it_is_reported(self):
        self.assertFalse(self.accessories()['lamp'].known)
        self.use('lamp', 'on')
        wait_for(lambda: self.tools.last('lamp') is True, what='the lamp')
        self.assertFalse(self.accessories()['lamp'].known)
        self.tools.lamp.publish(True)
        wait_for(lambda: self.accessories()['lamp'].choice == 'on', what='its state')
        self.tools.lamp.publish(False)
        wait_for(lambda: self.accessories()['lamp'].choice == 'off', what='its state')

    def test_what_is_held_is_repeated_and_released_by_silence(self):
        self.flip()
        wait_for(lambda: len(self.tools.sent['flipper']) > 10, what='repetitions')
        del self.held['flipper']
        self.ends('input silent', time.monotonic(), SILENT_S + 0.05)
        count = len(self.tools.sent['flipper'])
        self.state.wait(lambda state, at=self.state.at: self.state.at > at + 1.0, 'a while')
        self.assertEqual(len(self.tools.sent['flipper']), count)

    def test_a_stop_ends_moving_parts_and_leaves_the_lamp(self):
        self.use('lamp', 'on')
        self.tools.head.publish(0.3, -0.2, 0.0)
        wait_for(lambda: self.accessories()['head'].known, what='the place of the head')
        self.held['head'] = (1.0, 1.0)
        self.use('arm', 'open')
        self.flip()
        wait_for(lambda: self.tools.last('head') == (1.5, 0.8) and self.tools.last('arm') == 3,
                 what='the motion')
        when = self.operator.stop()
        self.ends('stop-all', when, STOP_S)
        self.ends('stop-all', when, STOP_S, 'head', lambda place: place == (0.3, -0.2))
        self.ends('stop-all', when, 0.1, 'arm', lambda word: word == 'cancelled')
        self.use('lamp', 'off')
        wait_for(lambda: self.tools.last('lamp') is False, what='the lamp under a stop')
        # The input is still held: nothing sets off after the release, but once it was let go.
        self.operator.release()
        self.ready(self.name)
        at = time.monotonic()
        wait_for(lambda: time.monotonic() - at > 0.5, what='a while', poll_s=0.05)
        self.assertEqual(self.tools.last('flipper'), 0.0)
        self.held.clear()
        wait_for(lambda: time.monotonic() - at > 1.0, what='a while', poll_s=0.05)
        self.flip()

    def test_the_end_of_the_selection_and_of_control_end_it(self):
        self.flip()
        when = time.monotonic()
        self.operator.check()
        self.ends('deselected', when, STOP_S)
        self.select_anew(self.name)
        self.ready(self.name)
        self.held.clear()
        self.wait_for_lines()
        wait_for(lambda: not self.accessories()['flipper'].stands, what='the flipper')

    def test_it_ends_when_the_robot_falls_silent(self):
        wheels = rospy.Publisher('/{}/odom'.format(self.name), Odometry, queue_size=1)
        self.addCleanup(wheels.unregister)
        wait_for(wheels.get_num_connections, what='the drive to listen to its wheels')
        wheels.publish(Odometry())
        self.ready(self.name)
        wait_for(lambda: wheels.publish(Odometry()) or self.accessories()['flipper'].stands == '',
                 what='the flipper', poll_s=0.05)
        self.held['flipper'] = (-1.0,)
        wait_for(lambda: wheels.publish(Odometry()) or self.tools.last('flipper') == -2.0,
                 what='the flipper', poll_s=0.05)
        self.ends('robot silent', time.monotonic(), SILENT_AFTER_S + 0.1)
        self.wait_robot(self.name, lambda robot: robot.stands == 'not_heard', 'its silence')

    def test_nobody_else_moves_it(self):
        self.held['flipper'] = (1.0,)
        self.operator.check()
        self.wait_robot(self.name, lambda robot: not robot.selected, 'the end of the selection')
        at = time.monotonic()
        wait_for(lambda: time.monotonic() - at > 0.5, what='a while', poll_s=0.05)
        self.assertEqual([value for when, value in self.tools.sent['flipper']
                          if when > at and value], [])
        self.assertEqual(self.accessories()['flipper'].stands, 'not_selected')

    def after(self, what, hit, within_s):
        """Hit the drive while the flipper moves; the process that stands by ends the motion."""
        self.tools.head.publish(0.1, 0.2, 0.0)
        wait_for(lambda: self.accessories()['head'].known, what='the place of the head')
        self.held['head'], self.held['fan'] = (1.0, 1.0), (1.0,)
        self.flip()
        wait_for(lambda: self.tools.last('head') == (1.5, 0.8), what='the head')
        wait_for(lambda: self.tools.last('fan') == 1.0, what='the fan')
        drive, run = wait_for(self.worker, what='the drive'), self.state.message.run
        when = time.monotonic()
        hit(drive)
        self.ends(what, when, within_s)
        self.ends(what, when, within_s, 'head', lambda place: place == (0.1, 0.2))
        self.ends(what, when, within_s, 'fan')
        self.wait_for_drive(run)
        # What was held before the start is released first.
        self.operator.check(self.name)
        self.ready(self.name)
        self.wait_for_lines('neutral')
        self.assertEqual(self.tools.last('flipper'), 0.0)

    def test_it_ends_when_the_drive_is_killed(self):
        self.after('drive killed', lambda drive: os.kill(drive, signal.SIGKILL), KILLED_S)

    def test_it_ends_when_the_drive_hangs(self):
        self.after('drive hung', freeze, HUNG_S)
