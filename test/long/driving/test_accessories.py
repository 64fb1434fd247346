# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories by pads and a pedal; those that are not there, refuse or hang."""
import itertools
import os
import threading
import time
import unittest

import rospy
from std_srvs.srv import SetBool

from mhri.base.reasons import NO_LISTENER
from mhri.driving.accessory_rule import SILENT_S
from mhri.msg import ControlMode
from support import graph
from support.accessories_case import AccessoriesCase
from support.joy_tools import JoyNode, NO_PADS
from support.node_tools import measured
from support.own_node import own_node
from support.ros_system import insist, wait_for

system = own_node('accessories')

# What is promised of the zero of a robot holds for the neutral value of a moving part [s].
STOP_S = 0.05
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


class AccessoriesTest(AccessoriesCase):

    def test_what_was_reported_only_once_before_the_drive_came_is_known(self):
        wait_for(lambda: self.accessories()['beacon'].choice == 'on', what='its state')

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
