#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A mux with a lab's own sources: dead-man button, an added row, and what is refused."""
import sys
import time
import unittest

from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Log
from rostest_tools import (
    FORWARD, measured, moves, NEUTRAL, Recorder, rests, Stick, twist_recorder, wait_until)
import rospy
import rostest
from std_msgs.msg import String

from mhri.msg import ControlMode

HELD, RELEASED = (0, 1), (0, 0)
DRIVE = (0.4, 0.0)
REFUSED = {
    'no axes': ((), HELD), 'not finite': ((float('nan'), 0.0), HELD),
    'too few axes': ((0.0,), HELD), 'too few buttons': (FORWARD, (1,))}


def _counts(message):
    """Return {key: value} of the mux's status of driving in one /diagnostics message."""
    for status in message.status:
        if status.name.endswith('driving'):
            return {item.key: item.value for item in status.values}
    return {}


class MuxLab(unittest.TestCase):
    """One pad with a dead-man button, one steering wheel."""

    @classmethod
    def setUpClass(cls):
        """Open everything once."""
        cls.twists = twist_recorder()
        cls.modes = Recorder('/mux/mode', ControlMode, lambda message: message.source)
        cls.waits = Recorder('/mux/waits_for', String, lambda message: message.data)
        cls.diagnostics = Recorder('/diagnostics', DiagnosticArray, _counts)
        cls.log = Recorder('/rosout', Log, lambda message: (message.name, message.level,
                                                            message.msg))
        cls.pad, cls.wheel = Stick('/mux_in/joy', HELD), Stick('/lab/wheel')
        cls.select = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        for stick in (cls.pad, cls.wheel):
            stick.wait_listener()
        wait_until(cls.select.get_num_connections, 'the mux does not listen')
        for recorder in (cls.twists, cls.modes, cls.diagnostics, cls.log):
            recorder.wait_publisher()

    def setUp(self):
        """Begin with the pad in force, held at neutral."""
        self.wheel.silence()
        self.select.publish(source='joy')
        self.modes.wait(lambda _: self.modes.last() == 'joy')
        self.pad.press(self.waits)

    def _drive(self):
        start = self.pad.hold(FORWARD, HELD)
        self.twists.wait(lambda value: value == DRIVE, start)

    def test_dead_man_released_means_zero(self):
        """At once, then silence; pressed again on the stick held out it drives nothing."""
        self._drive()
        begun = self.pad.hold(FORWARD, RELEASED)
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('first zero after the dead-man button', first.at - begun), 0.05)
        self.waits.wait(lambda _: self.waits.last() == 'dead_man')
        self.twists.wait_silence(0.4)
        again = self.pad.hold(FORWARD, HELD)
        self.waits.wait(lambda value: value == 'neutral', again)
        wait_until(lambda: self.pad.last_sent > again + 0.5, 'nothing sent')
        self.assertFalse([item for item in self.twists.since(first.at) if moves(item.value)])
        self.pad.hold(NEUTRAL, HELD)
        self.waits.wait(lambda _: self.waits.last() == '')
        self._drive()

    def test_an_added_row_drives(self):
        """Its topic is its own; it is in the list for the drop-down."""
        self.assertEqual([row['name'] for row in rospy.get_param('/mux/sources')],
                         ['joy', 'wheel'])
        self.select.publish(source='wheel')
        self.modes.wait(lambda _: self.modes.last() == 'wheel')
        self.wheel.hold(NEUTRAL)
        self.waits.wait(lambda _: self.waits.last() == '')
        start = self.wheel.hold((0.5, 0.0))
        self.twists.wait(lambda value: value == (0.0, 0.5), start)

    def test_unusable_messages_are_refused_and_counted_in_diagnostics(self):
        """Each under its own word, an unknown mode as well; nothing moves."""
        start = time.monotonic()
        for axes, buttons in REFUSED.values():
            self.pad.hold(axes, buttons)
            sent = self.pad.last_sent
            wait_until(lambda: self.pad.last_sent > sent, 'nothing sent')
        self.pad.hold(NEUTRAL, HELD)
        self.select.publish(source='telepathy')

        def all_counted(counts):
            return all(int(counts.get('refused: ' + kind, 0)) > 0
                       for kind in list(REFUSED) + ['unknown mode'])
        counted = self.diagnostics.wait(all_counted, start)
        measured('refusals in /diagnostics', counted.at - start)
        self.assertEqual(counted.value['mode'], 'joy')
        self.assertFalse([item for item in self.twists.since(start) if moves(item.value)])

    def test_unusable_messages_are_logged_at_most_once_a_second(self):
        """Fifty a second for more than two seconds: a full log hides what matters."""
        start = self.pad.hold((float('inf'), 0.0), HELD)
        self.diagnostics.wait(lambda _: time.monotonic() - start > 2.2, start + 2.2)
        self.pad.hold(NEUTRAL, HELD)
        said = [item for item in self.log.since(start)
                if item.value[0] == '/mux' and 'refused' in item.value[2]]
        self.assertTrue(2 <= len(said) <= 4, said)
        gaps = [later.at - sooner.at for sooner, later in zip(said, said[1:])]
        self.assertTrue(all(gap > 0.95 for gap in gaps), gaps)

    def test_a_source_that_turns_to_garbage_stops_like_a_silent_one(self):
        """NaN is no sign of life."""
        self._drive()
        begun = self.pad.hold((float('nan'), 0.0), HELD)
        first = self.twists.wait(rests, begun)
        self.assertLess(measured('first zero after garbage', first.at - begun), 0.55)


if __name__ == '__main__':
    rospy.init_node('mux_lab')
    rostest.rosrun('mhri', 'mux_lab', MuxLab, sys.argv)
