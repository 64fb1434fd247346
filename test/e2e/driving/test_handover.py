# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whoever takes over finds robots that stand still: a real mux, with two devices and a pedal."""
import os
import signal
import time
import unittest

import rospy
from std_msgs.msg import Bool

from mhri.msg import ControlMode, PanelRequest

from mhri.driving.io.stop_file import StopFile
from mhri.recording.recording import ros_home
from support import graph
from support.own_node import own_node
from support.ros_system import insist, wait_for
from support.node_tools import (
    FORWARD, measured, moves, NEUTRAL, Recorder, rests, start_mux, state_recorder, Stick,
    twist_recorder)

system = own_node('handover')

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
        cls.stop_file = StopFile(os.path.join(ros_home(os.environ), 'mhri', 'stop'),
                                 os.environ['ROS_MASTER_URI'])
        cls.joy, cls.pad = Stick(graph.STICK), Stick(graph.PAD, held(DEAD_MAN))
        cls.pedal = Stick(graph.PEDAL)
        cls.mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=10)

    def mux(self, *arguments):
        """Start a mux and wait until it hears and is heard."""
        # What an argument or a mux has set stays at the master, and a stop in its file.
        for name in filter(rospy.has_param, ('/mux/' + key for key in (
                'config', 'enabling', 'automatic_switching', 'dead_man', 'kept'))):
            rospy.delete_param(name)
        self.stop_file.keep(False)
        self.process = start_mux('__name:=mux', *arguments)
        self.addCleanup(self.end)
        self.twists = twist_recorder()
        self.modes = Recorder(graph.MODE, ControlMode, lambda message: message.source)
        self.waits = state_recorder('waits_for')
        self.stops = Recorder(graph.STOP_ALL, Bool, lambda message: message.data)
        self.requests = Recorder(graph.PANEL_REQUEST, PanelRequest, lambda message: message.action)
        self.recorders = (self.twists, self.modes, self.waits, self.stops, self.requests)
        for stick in (self.joy, self.pad, self.pedal):
            stick.wait_listener()
        wait_for(self.mode.get_num_connections,
                 what='the mux does not listen', timeout_s=30.0)
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
        stick.set_out(self.waits, self.twists, axes)

    def assert_held_until_neutral(self, begun, stick, axes=FORWARD):
        """Nothing may move from now on, until the stick was centred."""
        self.waits.settle('neutral')
        self.twists.wait_silence(0.7)
        first = self.twists.wait(rests, begun).at
        self.assertFalse([item for item in self.twists.since(first) if moves(item.value)])
        self.drive(stick, axes)

    def test_the_device_names_its_profile(self):
        """Axes and dead-man button are those of the pad's own file; without one it is refused."""
        self.mux()
        self.mode.publish(source='ps3joy')
        self.modes.wait_newest('ps3joy')
        self.pad.hold(NEUTRAL)
        self.waits.settle('dead_man')
        with self.pad.frame('profile:ps4'):
            self.drive(self.pad, PS3_UP)
        begun = self.pad.hold(PS3_UP)
        with self.pad.frame('profile:no_such_pad'):
            self.twists.wait(rests, begun)
            self.waits.settle('source')
            self.twists.wait_silence(0.7)
        self.assertIn('no_such_pad', self.process.said())
        with self.pad.frame('profile:ps3'):
            self.assert_held_until_neutral(begun, self.pad, PS3_UP)

    def test_without_dead_man_buttons_a_touched_device_takes_over_while_everything_stands(self):
        self.mux('_dead_man:=false', '_automatic_switching:=true')
        off = state_recorder('dead_man')
        self.addCleanup(off.close)
        off.wait(lambda value: value is False)
        self.pad.hold(NEUTRAL, held())
        self.drive()
        self.joy.hold(NEUTRAL)
        self.waits.settle('')
        self.twists.wait_silence(0.7)
        insist(self.pad_touched, 'the pad to take over')
        self.waits.settle('neutral')
        for frame in ('', 'profile:xbox'):
            with self.pad.frame(frame):
                self.pad.repeat(NEUTRAL, held())
                self.waits.settle('')
                begun = self.pad.set_out(self.waits, self.twists, PS3_UP, held())
                self.pad.hold(NEUTRAL, held())
                self.twists.wait(rests, begun)

    def pad_touched(self):
        """Centre the pad and push it; return whether it drives now."""
        for axes in (NEUTRAL, PS3_UP):
            self.pad.repeat(axes, held(), seconds=0.5)
        return self.modes.last() == 'ps3joy'

    def test_buttons(self):
        """Stop counts from every source, all else from the one that drives; once each press."""
        self.mux()
        self.joy.hold(NEUTRAL)
        self.pad.repeat(NEUTRAL, held())
        self.pad.repeat(NEUTRAL, held(PS3_BUTTONS['next']))
        begun = self.pad.hold(NEUTRAL, held(PS3_BUTTONS['stop_all']))
        stopped = self.stops.wait(lambda value: value, begun)
        measured('stop-all by an inactive pad', stopped.at - begun, 0.05)
        self.assertEqual(self.requests.since(0.0), [], 'the pad does not drive')
        wait_for(self.stop_file.stopped, what='the stop is not remembered')
        self.mode.publish(source='ps3joy')
        self.modes.wait_newest('ps3joy')
        for action in ('next', 'previous', 'select_all', 'mark'):
            self.pad.repeat(NEUTRAL, held())
            begun = self.pad.hold(NEUTRAL, held(PS3_BUTTONS[action]))
            self.requests.wait(lambda value: value == action, begun)
        self.pad.hold(NEUTRAL, held())
        self.twists.wait_silence(0.7)
        self.assertEqual([item.value for item in self.requests.since(0.0)],
                         ['next', 'previous', 'select_all', 'mark'])

    def test_the_enabling_pedal(self):
        self.mux('_enabling:=pedal')
        self.joy.hold(NEUTRAL)
        self.waits.settle('enabling')
        self.joy.hold(FORWARD)
        self.twists.wait_silence(0.7)
        self.assertFalse([item for item in self.twists.since(0.0) if moves(item.value)])
        for end in ('released', 'silent'):
            self.joy.hold(NEUTRAL)
            self.pedal.hold(NEUTRAL, (1,))
            self.drive()
            begun = time.monotonic()
            if end == 'released':
                self.pedal.hold(NEUTRAL, (0,))
            else:
                self.pedal.silence()
            first = self.twists.wait(rests, begun)
            measured('zero after the enabling pedal was ' + end, first.at - begun,
                     0.05 if end == 'released' else 0.3)
            self.pedal.hold(NEUTRAL, (1,))
            self.assert_held_until_neutral(begun, self.joy)

    def test_a_parameter_that_cannot_be_used_ends_it_with_the_reason(self):
        process = start_mux('__name:=other_mux', '_enabling:=no_such_source')
        self.addCleanup(process.end)
        self.assertNotEqual(process.wait(30.0), 0)
        self.assertIn('no_such_source', process.said())
