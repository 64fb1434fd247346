# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The real drive on a terminal that takes nothing (Ctrl-S): what it says holds up no robot."""
import signal


from support.drive_case import DriveCase
from support.own_node import own_node
from support.ros_system import stuck_terminal

system = own_node('stuck_terminal')


class StuckTerminalTest(DriveCase):
    """Whatever is said, and on whichever of its threads."""

    @classmethod
    def setUpClass(cls):
        terminal = stuck_terminal()
        cls.output = terminal.__enter__()
        cls.addClassCleanup(terminal.__exit__, None, None, None)
        super().setUpClass()

    def drives(self, name, receiver):
        """Centre, drive, stop and deselect: each has to reach the robot."""
        for act, undo in ((self.operator.stop, self.operator.release),
                          (self.operator.check, lambda: self.operator.check(name))):
            self.ready(name)
            self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))
            self.first_zero('terminal stuck', receiver, act(), 1.0)
            undo()

    def test_it_drives_and_stops_whatever_it_has_to_say(self):
        (name, receiver), = self.robots(1)
        self.drives(name, receiver)
        # From a service.
        self.operator.take()
        self.drives(name, receiver)
        # From the thread that asks the master: a robot of a type that nobody knows.
        (name, receiver), = self.robots(1, 'no_such_type')
        self.drives(name, receiver)
        self.ready(name)
        self.drive(receiver, 0.25)
        self.first_zero('the end', receiver, self.drive_process.send(signal.SIGTERM), 1.0)
        self.assertEqual(self.drive_process.wait(), 0)
