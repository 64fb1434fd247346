#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gates that somebody ends, started as by mhri.launch; robots without guard and watchdog."""
import contextlib
import os
import signal
import sys
import time
import xmlrpc.client

import rosgraph
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, NEXT_S, ZERO  # noqa: E402
from rostest_tools import measured  # noqa: E402
from support.ros_system import children, wait_for  # noqa: E402


class GatesKilledTest(GatesCase):
    """Under the process that stands by, itself started again where it ends with an error."""

    stand_by = True

    def node(self):
        """Return the number of the process that works, None while there is none."""
        return next((number for standing_by in children(self.gates.number)
                     for number in children(standing_by)), None)

    def driven(self):
        """Return (number of the gates, name and receiving end of a robot that is driven)."""
        gates = wait_for(self.node, what='the gates')
        # Who is killed right after its start has to be loaded anew, and remembers nothing. The
        # process is older than its work: it stood by.
        seen = time.monotonic()
        wait_for(lambda: time.monotonic() - seen > 2.5, what='a while')
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.2)
        return gates, name, receiver

    def kill_by_name(self):
        """Do what ``rosnode kill`` does; return when."""
        uri = rosgraph.Master(rospy.get_name()).lookupNode('/mhri_gates')
        when = time.monotonic()
        # It may be gone before it has answered, and the client asks a second time.
        with contextlib.suppress(OSError):
            xmlrpc.client.ServerProxy(uri).shutdown('/rosnode', 'user request')
        return when

    def next_zero(self, what, receiver, when):
        """Hold the stick out; the first word of the next gates is a zero, and in time."""
        wait_for(lambda: self.mux.say(0.2) and receiver.after(when), what='a zero', poll_s=0.02)
        at, *value = receiver.after(when)[0]
        self.assertEqual(tuple(value), ZERO)
        self.assertLess(measured(what, at - when), NEXT_S)

    def back(self, name, receiver, when):
        """Show that it stays at rest with the stick out, released or not, until that is centred."""
        self.mux.say(0.2)
        self.wait_for_mux()
        self.state.wait(lambda state: state.stop_all, 'the stop')
        self.stays_at_rest(receiver, when)
        self.mux.stop(False)
        self.state.wait_robot(name, lambda gate: gate.stands == 'joining', 'that it waits')
        self.stays_at_rest(receiver, when)
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.1), (0.1, 0.0))

    def test_rosnode_kill_and_then_a_stop(self):
        gates, name, receiver = self.driven()
        when = self.kill_by_name()
        self.first_zero('rosnode kill', receiver, when, 0.05)
        wait_for(lambda: self.mux.say(0.2) and self.node() != gates, what='the end of the gates',
                 poll_s=0.02)
        stopped = self.mux.stop(True)
        self.next_zero('stopped while there were no gates', receiver, stopped)
        self.back(name, receiver, when)

    def test_rosnode_kill_under_a_stop(self):
        _, name, receiver = self.driven()
        when = self.mux.stop(True)
        self.first_zero('stop-all', receiver, when, 0.05)
        self.next_zero('the end of gates under a stop', receiver, self.kill_by_name())
        self.back(name, receiver, when)

    def test_killed_and_stopped_at_once(self):
        gates, name, receiver = self.driven()
        when = time.monotonic()
        os.kill(gates, signal.SIGKILL)
        self.mux.stop(True)
        self.next_zero('killed and stopped at once', receiver, when)
        self.back(name, receiver, when)

    def test_killed_while_the_master_has_forgotten_who_was_driven(self):
        """As one started anew; whoever is in control now has not checked that robot."""
        gates, name, receiver = self.driven()
        os.kill(gates, signal.SIGSTOP)
        rospy.delete_param('/mhri_gates/robots')
        self.operator.check()
        when = time.monotonic()
        os.kill(gates, signal.SIGKILL)
        self.next_zero('killed, driven robots forgotten', receiver, when)


if __name__ == '__main__':
    rospy.init_node('gates_killed_test')
    rostest.rosrun('mhri', 'gates_killed', GatesKilledTest)
