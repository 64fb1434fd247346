#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The real gates on a terminal that takes nothing (Ctrl-S): what they say holds up no robot."""
import os
import signal
import sys
import threading

import rospy
import rostest
from std_srvs.srv import Trigger

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, ZERO  # noqa: E402
from support.ros_system import stuck_terminal, wait_for  # noqa: E402


class GatesTerminalTest(GatesCase):
    """Whatever is said, and on whichever of their threads."""

    @classmethod
    def setUpClass(cls):
        terminal = stuck_terminal()
        cls.output = terminal.__enter__()
        cls.addClassCleanup(terminal.__exit__, None, None, None)
        super().setUpClass()

    def drives(self, name, receiver):
        """Centre, drive, stop and let go: each has to reach the robot."""
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.2), (0.2, 0.0))
        for act, undo in ((lambda: self.mux.stop(True), lambda: self.mux.stop(False)),
                          (self.operator.check, lambda: self.operator.check(name))):
            when = act()
            wait_for(lambda: receiver.after(when), what='the zero')
            self.assertEqual(receiver.after(when)[0][1:], ZERO)
            undo()
            self.state.wait_robot(name, lambda gate: gate.stands == 'joining', 'it waits')
            self.centre(name, receiver)
            self.assertEqual(self.drive(receiver, 0.1), (0.1, 0.0))

    def test_it_drives_and_stops_whatever_it_has_to_say(self):
        (name, receiver), = self.robots(1)
        self.drives(name, receiver)
        # From its clock: a mux that hangs, and one that is heard again.
        for hangs in (True, False):
            self.mux.hangs = hangs
            self.state.wait(lambda state: state.mux_heard != hangs, 'the word on the mux')
        self.drives(name, receiver)
        # From a service.
        answers, take = [], rospy.ServiceProxy('/gates/take_control', Trigger)
        threading.Thread(target=lambda: answers.append(take()), daemon=True).start()
        wait_for(lambda: answers, what='the answer of who has control')
        self.drives(name, receiver)
        # From the thread that asks the master: a robot of a type that nobody knows.
        (name, receiver), = self.robots(1, 'no_such_type')
        self.drives(name, receiver)
        when = self.gates.send(signal.SIGTERM)
        wait_for(lambda: receiver.after(when), what='the zero of the end')
        self.assertEqual(receiver.after(when)[0][1:], ZERO)
        self.assertEqual(self.gates.wait(), 0)


if __name__ == '__main__':
    rospy.init_node('gates_terminal_test')
    rostest.rosrun('mhri', 'gates_terminal', GatesTerminalTest)
