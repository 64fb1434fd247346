#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whoever takes over finds robots that stand still: a real mux, with two devices and a pedal."""
import os
import signal
import time
import unittest

from rostest_tools import (
    FORWARD, measured, moves, NEUTRAL, Recorder, rests, start_mux, Stick, StickProcess,
    twist_recorder, wait_until)
import rospy
import rostest
from std_msgs.msg import Bool, String

from mhri.msg import ControlMode, PanelRequest, RobotSelect

HERE = os.path.dirname(os.path.abspath(__file__))
PS3_UP = (0.0, -1.0)
# Buttons of resource/pads/ps3.yaml and xbox.yaml that are tried here.
PS3_BUTTONS = {'stop_all': 1, 'next': 5, 'previous': 3, 'select_all': 2, 'mark': 8}
DEAD_MAN = 4


def held(*numbers):
    """Return 17 buttons of which these are down."""
    return tuple(int(number in numbers) for number in range(17))


class Handover(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.joy, cls.pad = Stick('/mux_in/joy'), Stick('/mux_in/ps3joy', held(DEAD_MAN))
        cls.pedal = Stick('/mux_in/pedal')
        cls.select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=10,
                                     latch=True)
        cls.mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)

    def mux(self, *arguments):
        """Start a mux and wait until it hears and is heard."""
        # What an argument has set stays at the master.
        for name in filter(rospy.has_param, ('/mux/' + key for key in (
                'stop_all', 'config', 'enabling', 'automatic_switching', 'dead_man'))):
            rospy.delete_param(name)
        self.process = start_mux('__name:=mux', *arguments)
        self.addCleanup(self.end)
        self.twists = twist_recorder()
        self.modes = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        self.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        self.stops = Recorder('/robot_controller/stop_all', Bool, lambda message: message.data)
        self.requests = Recorder('/panel_in/request', PanelRequest, lambda message: message.action)
        self.recorders = (self.twists, self.modes, self.waits, self.stops, self.requests)
        for stick in (self.joy, self.pad, self.pedal):
            stick.wait_listener()
        wait_until(lambda: self.select.get_num_connections() and self.mode.get_num_connections(),
                   'the mux does not listen', 30.0)
        for recorder in self.recorders:
            recorder.wait_publisher()

    def end(self):
        for stick in (self.joy, self.pad, self.pedal):
            stick.silence()
        self.process.send(signal.SIGTERM)
        self.process.wait()
        self.process.end()
        for recorder in self.recorders:
            recorder.close()

    def drive(self, stick=None, axes=FORWARD):
        """Centre a stick, with its buttons pressed anew, push it, and wait for motion."""
        stick = stick or self.joy
        stick.press(self.waits)
        begun = stick.hold(axes)
        self.twists.wait(moves, begun)

    def assert_held_until_neutral(self, begun, stick, axes=FORWARD):
        """Nothing may move from now on, until the stick was centred."""
        self.waits.wait(lambda _: self.waits.last() == 'neutral')
        self.twists.wait_silence(0.7)
        first = self.twists.wait(rests, begun).at
        self.assertFalse([item for item in self.twists.since(first) if moves(item.value)])
        self.drive(stick, axes)

    def test_a_robot_that_joins_makes_all_wait_for_neutral(self):
        self.mux()
        self.select.publish(robots=['bot1'])
        self.drive()
        begun = time.monotonic()
        self.select.publish(robots=['bot1', 'bot2'])
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('zero after a robot joined', first.at - begun), 0.2)
        self.assert_held_until_neutral(begun, self.joy)

    def test_a_change_of_mode_with_both_sticks_out(self):
        self.mux()
        self.drive()
        begun = self.pad.hold(PS3_UP)
        self.mode.publish(source='ps3joy')
        self.modes.wait(lambda value: value == 'ps3joy', begun)
        self.assert_held_until_neutral(begun, self.pad, PS3_UP)

    def test_a_killed_device_node_is_seen_before_it_counts_as_silent(self):
        self.mux()
        stick = StickProcess('/mux_in/voice', 'killed_stick')
        self.addCleanup(stick.process.end)
        self.mode.publish(source='voice')
        stick.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        stick.hold(FORWARD)
        self.twists.wait(moves)
        begun = stick.process.send(signal.SIGKILL)
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('zero after SIGKILL of a device node', first.at - begun), 0.4,
                        'its connection is gone at once')

    def test_the_device_names_its_profile(self):
        """The axes are read as the pad's own file says; one that does not exist is refused."""
        self.mux()
        self.mode.publish(source='ps3joy')
        self.modes.wait(lambda value: value == 'ps3joy')
        with self.pad.frame('profile:ps4'):
            self.drive(self.pad, PS3_UP)
        begun = self.pad.hold(PS3_UP)
        with self.pad.frame('profile:no_such_pad'):
            self.twists.wait(rests, begun)
            self.waits.wait(lambda _: self.waits.last() == 'source')
            self.twists.wait_silence(0.7)
        self.assertIn('no_such_pad', self.process.said())
        with self.pad.frame('profile:ps3'):
            self.assert_held_until_neutral(begun, self.pad, PS3_UP)

    def test_a_dead_man_button_that_is_taped_down_is_asked_for(self):
        """It drives nothing before it was seen released once; nor with another device."""
        self.mux()
        self.mode.publish(source='ps3joy')
        self.modes.wait(lambda value: value == 'ps3joy')
        for frame in ('', 'profile:ps4'):
            with self.pad.frame(frame):
                self.pad.hold(NEUTRAL)
                self.waits.wait(lambda _: self.waits.last() == 'dead_man')
                begun = self.pad.hold(PS3_UP)
                wait_until(lambda start=begun: self.pad.last_sent > start + 0.5, 'nothing sent')
                self.assertFalse([item for item in self.twists.since(begun) if moves(item.value)])
                self.assertEqual(self.waits.last(), 'dead_man')
                self.drive(self.pad, PS3_UP)

    def test_dead_man_buttons_can_be_turned_off_and_that_is_said(self):
        self.mux()
        on = Recorder('/mux/dead_man', Bool, lambda message: message.data)
        self.addCleanup(on.close)
        on.wait(lambda value: value is True)
        self.mode.publish(source='ps3joy')
        self.pad.hold(NEUTRAL, held())
        self.waits.wait(lambda _: self.waits.last() == 'dead_man')
        self.doCleanups()
        self.mux('_dead_man:=false')
        off = Recorder('/mux/dead_man', Bool, lambda message: message.data)
        self.addCleanup(off.close)
        off.wait(lambda value: value is False)
        self.mode.publish(source='ps3joy')
        self.pad.hold(NEUTRAL, held())
        self.waits.wait(lambda _: self.waits.last() == '')
        for frame in ('', 'profile:xbox'):
            with self.pad.frame(frame):
                begun = self.pad.hold(NEUTRAL, held())
                wait_until(lambda start=begun: self.pad.last_sent > start + 0.1, 'nothing sent')
                self.waits.wait(lambda _: self.waits.last() == '')
                begun = self.pad.hold(PS3_UP, held())
                self.twists.wait(moves, begun)
                self.pad.hold(NEUTRAL, held())
                self.twists.wait(rests, begun)

    def test_a_device_that_is_lost_has_to_be_centred_however_patient_its_source(self):
        """With timeout_s 2 a pad that comes back within it, held out, drives nothing."""
        self.mux('_config:=' + os.path.join(HERE, 'mux_patient.yaml'))
        self.drive(self.pad, PS3_UP)
        with self.pad.frame(' lost'):
            begun = self.pad.once(NEUTRAL, held())
            self.pad.silence()
        self.twists.wait(rests, begun)
        self.waits.wait(lambda _: self.waits.last() == 'neutral')
        wait_until(lambda: time.monotonic() - begun > 1.1, 'no time passes')
        back = self.pad.hold(PS3_UP)
        wait_until(lambda: self.pad.last_sent > back + 0.7, 'nothing sent')
        self.assertFalse([item for item in self.twists.since(back) if moves(item.value)])
        self.drive(self.pad, PS3_UP)

    def test_buttons(self):
        """Stop counts from every source, all else from the one that drives; once each press."""
        self.mux()
        self.pad.hold(NEUTRAL, held())
        self.joy.hold(NEUTRAL)
        self.pad.hold(NEUTRAL, held(PS3_BUTTONS['next']))
        begun = self.pad.hold(NEUTRAL, held(PS3_BUTTONS['stop_all']))
        stopped = self.stops.wait(lambda value: value, begun)
        self.assertLess(measured('stop-all by an inactive pad', stopped.at - begun), 0.2)
        self.assertEqual(self.requests.since(0.0), [], 'the pad does not drive')
        wait_until(lambda: rospy.get_param('/mux/stop_all', False), 'the stop is not remembered')
        self.mode.publish(source='ps3joy')
        self.modes.wait(lambda value: value == 'ps3joy')
        for action in ('next', 'previous', 'select_all', 'mark'):
            self.pad.hold(NEUTRAL, held())
            begun = self.pad.hold(NEUTRAL, held(PS3_BUTTONS[action]))
            self.requests.wait(lambda value: value == action, begun)
        self.pad.hold(NEUTRAL, held())
        self.twists.wait_silence(0.7)
        self.assertEqual([item.value for item in self.requests.since(0.0)],
                         ['next', 'previous', 'select_all', 'mark'])

    def test_a_touched_device_takes_over_while_everything_stands(self):
        self.mux('_automatic_switching:=true')
        self.pad.hold(NEUTRAL)
        self.drive()
        begun = self.pad.hold(PS3_UP)
        self.joy.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        self.twists.wait_silence(0.7)
        self.assertEqual(self.modes.last(), 'joy', 'held out while another drove: not touched')
        self.pad.hold(NEUTRAL)
        self.twists.wait_silence(0.2)
        begun = self.pad.hold(PS3_UP)
        self.modes.wait(lambda value: value == 'ps3joy', begun)
        self.assert_held_until_neutral(begun, self.pad, PS3_UP)

    def test_the_enabling_pedal(self):
        self.mux('_enabling:=pedal')
        self.joy.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == 'enabling')
        self.joy.hold(FORWARD)
        self.twists.wait_silence(0.7)
        self.assertFalse([item for item in self.twists.since(0.0) if moves(item.value)])
        for end in ('released', 'silent'):
            self.joy.hold(NEUTRAL)
            self.pedal.hold(NEUTRAL, (1,))
            self.drive()
            if end == 'released':
                self.pedal.hold(NEUTRAL, (0,))
            else:
                self.pedal.silence()
            begun = time.monotonic()
            first = self.twists.wait(rests, begun)
            self.assertLess(measured('zero after the enabling pedal was ' + end, first.at - begun),
                            0.2 if end == 'released' else 0.45)
            self.pedal.hold(NEUTRAL, (1,))
            self.assert_held_until_neutral(begun, self.joy)

    def test_a_parameter_that_cannot_be_used_ends_it_with_the_reason(self):
        process = start_mux('__name:=other_mux', '_enabling:=no_such_source')
        self.addCleanup(process.end)
        self.assertNotEqual(process.wait(30.0), 0)
        self.assertIn('no_such_source', process.said())


if __name__ == '__main__':
    rospy.init_node('handover_test')
    rostest.rosrun('mhri', 'handover', Handover)
