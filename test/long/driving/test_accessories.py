# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories of every kind at the real drive, with real messages, services and actions."""
import itertools
import os
import signal
import threading
import time
import unittest

import actionlib
from actionlib.msg import TestAction, TestResult
from geometry_msgs.msg import Vector3
from nav_msgs.msg import Odometry
import rospy
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool, SetBoolResponse

from mhri.base.reasons import NO_LISTENER
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.driving.accessory_rule import SILENT_S
from mhri.msg import Accessory, ControlMode
from support import graph
from support.drive_case import DriveCase
from support.joy_tools import JoyNode, NO_PADS
from support.own_node import own_node
from support.ros_system import freeze, insist, wait_for
from support.node_tools import measured

system = own_node('accessories')

ROWS = {
    'lamp': {'kind': 'toggle', 'topic': 'lamp', 'state': 'lamp_state', 'on_stop': 'keep'},
    'beacon': {'kind': 'toggle', 'topic': 'beacon', 'state': 'beacon_state', 'on_stop': 'keep'},
    'flipper': {'kind': 'hold', 'topic': 'flipper/velocity', 'type': 'std_msgs/Float64',
                'range': [-2.0, 1.0], 'rate_hz': 20, 'on_stop': 'stop'},
    'fan': {'kind': 'hold', 'topic': 'fan', 'type': 'std_msgs/Float64', 'on_stop': 'keep'},
    'head': {'kind': 'axis2', 'mode': 'position', 'topic': 'head/cmd',
             'type': 'geometry_msgs/Vector3', 'state': 'head_state',
             'range': [[-1.5, 1.5], [-0.5, 0.8]], 'on_stop': 'stop'},
    'arm': {'kind': 'tap', 'action': 'arm', 'type': 'actionlib/Test',
            'choices': {'open': {'goal': 3}, 'close': {'goal': 4}}, 'on_stop': 'cancel'},
    'horn': {'kind': 'toggle', 'service': 'horn', 'type': 'std_srvs/SetBool',
             'choices': {'on': {'data': True}, 'off': {'data': False}}, 'on_stop': 'keep'},
    'claw': {'kind': 'tap', 'topic': 'claw', 'type': 'no_such_msgs/Claw',
             'choices': {'open': {'data': 1}}, 'on_stop': 'stop'},
    'nose': {'kind': 'tap', 'topic': 'nose', 'type': 'std_msgs/Bool',
             'choices': {'sniff': {'air': 1}}, 'on_stop': 'stop'}}
# What is promised of the zero of a robot holds for the neutral value of a moving part [s].
STOP_S, KILLED_S, HUNG_S = 0.05, 0.05, 0.6
PAD = '''
name: tools
forward: {axis: 1}
turn: {axis: 0}
shift_button: 1
accessories:
  lamp: {button: 2, choice: toggle}
  flipper: {button: 0, value: -1.0}
  head: {axes: [0, 1], shift: true}
'''
FEET = '''
name: feet
kind: keys
pedals:
  - {name: go, keys: [KEY_A], forward: 1.0}
  - {name: lamp, keys: [KEY_B]}
accessories:
  lamp: {button: 2, choice: off}
'''
CENTRED, FLIP, SHIFT, LAMP = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
# A pad with 4 axes, 3 buttons and a hat, which the node sends as two more axes: right, and down.
GRIP = 'Tool grip'
GRIP_PAD = '''
name: grip
forward: {axis: 1}
turn: {axis: 0}
accessories:
  lamp: {button: 2, choice: toggle}
  flipper: {button: 0, value: -1.0}
  head: {axes: [4, 5], value: [-1.0, -1.0]}
match: {names: [Tool grip]}
'''
HAT_UP, AT_REST = 1, {'buttons': {0: 0, 2: 0}, 'hats': {0: 0}}


class Tools:
    """The accessories of a robot: what each was sent, as [(time, value)]."""

    def __init__(self, name):
        self.sent = {'flipper': [], 'fan': [], 'lamp': [], 'head': [], 'horn': [], 'arm': []}
        self.goal, self.answers = threading.Event(), True
        place = '/{}/'.format(name)
        self.ears = [
            rospy.Subscriber(place + topic, kind, self._note, (key, read), tcp_nodelay=True)
            for key, topic, kind, read in (
                ('flipper', 'flipper/velocity', Float64, lambda message: message.data),
                ('fan', 'fan', Float64, lambda message: message.data),
                ('lamp', 'lamp', Bool, lambda message: message.data),
                ('head', 'head/cmd', Vector3, lambda message: (message.x, message.y)))]
        self.lamp = rospy.Publisher(place + 'lamp_state', Bool, queue_size=1, latch=True)
        self.beacon = rospy.Publisher(place + 'beacon_state', Bool, queue_size=1, latch=True)
        self.beacon.publish(True)
        self.head = rospy.Publisher(place + 'head_state', Vector3, queue_size=1, latch=True)
        self.horn = rospy.Service(place + 'horn', SetBool, self._hoot)
        self.arm = actionlib.SimpleActionServer(place + 'arm', TestAction, self._grip, False)
        self.arm.start()

    def _note(self, message, told):
        key, read = told
        self.sent[key].append((time.monotonic(), read(message)))

    def _hoot(self, request):
        self.sent['horn'].append((time.monotonic(), request.data))
        return SetBoolResponse(self.answers, 'no air')

    def _grip(self, goal):
        """Move until the goal is cancelled, or allowed to end."""
        self.sent['arm'].append((time.monotonic(), goal.goal))
        while not (self.arm.is_preempt_requested() or self.goal.is_set()):
            time.sleep(0.002)
        if self.arm.is_preempt_requested():
            self.sent['arm'].append((time.monotonic(), 'cancelled'))
            self.arm.set_preempted()
        else:
            self.arm.set_succeeded(TestResult())

    def close(self):
        """Unregister all of it."""
        self.goal.set()
        for end in (*self.ears, self.lamp, self.beacon, self.head):
            end.unregister()
        self.horn.shutdown()

    def last(self, key):
        """Return the last value, None for nothing."""
        return self.sent[key][-1][1] if self.sent[key] else None

    def first_since(self, key, when, good):
        """Return when the first good value came after a time, None if none did."""
        return next((at for at, value in list(self.sent[key]) if at >= when and good(value)), None)


class AccessoriesTest(DriveCase):

    def setUp(self):
        super().setUp()
        name = self.next_name()
        rospy.set_param('/{}/mhri'.format(name), {'accessories': ROWS})
        self.tools = Tools(name)
        self.addCleanup(self.tools.close)
        (self.name, self.receiver), = self.robots(1)
        self.hand = rospy.Publisher(graph.ACCESSORY, Accessory, queue_size=10, tcp_nodelay=True)
        self.addCleanup(self.hand.unregister)
        self.held, self.stop_holding = {}, threading.Event()
        thread = threading.Thread(target=self.keep_holding, daemon=True)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.stop_holding.set)
        wait_for(self.hand.get_num_connections, what='the drive to listen')
        self.wait_for_lines()

    def wait_for_lines(self, held=''):
        """Wait until the drive reaches the accessories.

        :param held: why those stand that are held
        """
        wanted = {'lamp': '', 'arm': '', 'flipper': held, 'head': held}

        def reached():
            found = self.accessories()
            return found and all(found[key].stands == stands for key, stands in wanted.items())
        wait_for(reached, what=lambda: 'the accessories: {}'.format(self.accessories()))

    def accessories(self):
        robot = self.state.robot(self.name)
        return {one.key: one for one in robot.accessories} if robot else {}

    def use(self, key, choice='', *value):
        self.hand.publish(robots=[self.name], key=key, choice=choice, value=value)

    def keep_holding(self):
        """Repeat what is held, as the program of the operator does."""
        while not self.stop_holding.wait(0.05):
            for key, value in list(self.held.items()):
                self.use(key, '', *value)

    def flip(self, share=-1.0, sent=-2.0):
        """Hold the flipper until it moves so."""
        self.held['flipper'] = (share,)
        wait_for(lambda: self.tools.last('flipper') == sent, what='the flipper')

    def ends(self, what, when, within_s, key='flipper', good=lambda value: value == 0.0):
        """Wait for what ends the motion; nothing else comes behind it."""
        at = wait_for(lambda: self.tools.first_since(key, when, good), what=what)
        measured('neutral of an accessory, ' + what, at - when, within_s)
        return at

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

    def test_what_was_reported_only_once_before_the_drive_came_is_known(self):
        wait_for(lambda: self.accessories()['beacon'].choice == 'on', what='its state')

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

    def test_what_is_not_installed_or_refused_is_said(self):
        found = self.accessories()
        self.assertIn('no_such_msgs', found['claw'].stands)
        self.assertIn('air', found['nose'].stands)
        self.tools.answers = False
        wait_for(lambda: self.use('horn', 'on') or self.accessories()['horn'].stands == 'no air',
                 what='the refusal', poll_s=0.1)
        self.tools.answers = True
        self.use('horn', 'off')
        wait_for(lambda: not self.accessories()['horn'].stands, what='the answer')

    def test_a_tap_whose_listener_has_just_gone_is_answered(self):
        """The drive learns of a listener's end by the message after the one that is lost."""
        ear = next(one for one in self.tools.ears if one.name.endswith('/lamp'))
        self.tools.ears.remove(ear)
        ear.unregister()
        wait_for(lambda: self.use('lamp', 'on') or self.accessories()['lamp'].stands not in (
            '', NO_LISTENER), what='the answer', poll_s=0.1)
        wait_for(lambda: self.accessories()['lamp'].stands == NO_LISTENER, what='its end')

    def add_profile(self, folder, name, text):
        """Add a profile of a pad or a pedal."""
        os.makedirs(os.path.join(self.home, folder), exist_ok=True)
        with open(os.path.join(self.home, folder, name + '.yaml'), 'w') as file:
            file.write(text)

    def mode_switch(self, name, text):
        """Add a profile of a pad; return a publisher of the mode."""
        self.add_profile('pads', name, text)
        mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=10)
        self.addCleanup(mode.unregister)
        wait_for(mode.get_num_connections, what='the drive to listen')
        return mode

    @unittest.skipIf(NO_PADS, NO_PADS)
    def test_a_real_pad_uses_them_by_a_button_and_its_hat(self):
        mode = self.mode_switch('grip', GRIP_PAD)
        node = JoyNode(env={'ROS_HOME': os.path.dirname(self.home)})
        self.addCleanup(node.end)
        pad = node.attach(GRIP, counts=(4, 3, 1))
        mode.publish(source='ps3joy')
        self.state.wait(lambda state: state.mode == 'ps3joy', 'the mode')
        self.ready(self.name)
        for what, state, key, value in (
                ('the lamp by a button', {'buttons': {2: 1}}, 'lamp', True),
                ('the flipper by a button', {'buttons': {0: 1}}, 'flipper', -2.0),
                ('the head by the hat', {'hats': {0: HAT_UP}}, 'head', (0.0, 0.8))):
            # What was held as a process stood still has to be let go first.
            turns = itertools.cycle((AT_REST, state))
            wait_for(lambda state=state, key=key, value=value, turns=turns: node.set(
                pad, **next(turns)) and value in [
                    told for _, told in list(self.tools.sent[key])], what=what, poll_s=0.2)
            node.set(pad, **AT_REST)
        wait_for(lambda: self.tools.last('flipper') == 0.0, what='the flipper to stand')
        self.assertLessEqual({entry[1:] for entry in self.receiver.after(0.0)}, {(0.0, 0.0)})
        mode.publish(source='joy')
        self.state.wait(lambda state: state.mode == 'joy', 'the mode')

    def test_a_pad_and_a_pedal_use_them_by_their_profiles(self):
        mode = self.mode_switch('tools', PAD)
        self.add_profile('pedals', 'feet', FEET)
        stick, rest = self.operator.stick, (0.0, 0.0)

        def pressed(before, axes, buttons, good, what):
            # What was silent for 0.25 s has to be let go first.
            def is_good():
                stick.repeat(rest, before)
                stick.hold(axes, buttons)
                return wait_for(good, 1.0, what)
            insist(is_good, what)

        def took(end):
            self.ready(self.name)
            pressed(CENTRED, rest, FLIP, lambda: self.tools.last('flipper') == -2.0, 'the flipper')
            when = time.monotonic()
            end()
            wait_for(lambda: self.tools.last('flipper') == 0.0, what='its end')
            at = self.tools.first_since('flipper', when, lambda value: value == 0.0)
            # None: it had ended before, as this process stood still.
            return at and at - when

        with stick.frame('profile:tools'):
            self.ready(self.name)
            begun = time.monotonic()
            pressed(SHIFT, (1.0, 0.0), SHIFT, lambda: self.tools.last('head') == (1.5, 0.0),
                    'the head by the shifted stick')
            self.assertLessEqual({tuple(value[1:]) for value in self.receiver.after(begun)},
                                 {(0.0, 0.0)})
            pressed(CENTRED, rest, LAMP, lambda: (True in [
                value for _, value in self.tools.sent['lamp']]), 'the lamp')
            for what, end, within_s in (
                    ('button let go', lambda: stick.hold(rest, CENTRED), STOP_S),
                    ('pad silent', stick.silence, SILENT_S + 0.05),
                    ('another mode', lambda: mode.publish(source='pedal'), STOP_S)):
                measured('neutral of an accessory, ' + what,
                         wait_for(lambda end=end: took(end), what=what), within_s)
            mode.publish(source='joy')
            self.state.wait(lambda state: state.mode == 'joy', 'the mode')
        with stick.frame('profile:pedal:feet'):
            self.ready(self.name)
            begun = time.monotonic()
            pressed(CENTRED, rest, LAMP, lambda: self.tools.first_since(
                'lamp', begun, lambda value: value is False), 'the lamp by a pedal')

    def test_a_server_that_hangs_delays_nobody(self):
        gone = threading.Event()
        self.addCleanup(gone.set)
        self.tools.horn.shutdown()
        self.tools.horn = rospy.Service('/{}/horn'.format(self.name), SetBool,
                                        lambda request: gone.wait(30.0) and (True, ''))
        self.use('horn', 'on')
        self.flip()
        self.drive(self.receiver, 0.2)
        when = self.operator.stop()
        self.ends('stop-all, a server hangs', when, STOP_S)
