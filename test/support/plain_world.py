# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plain robots that are driven by the real mux, to see what each is told when something happens.

A robot is a subscriber of rospy as it is: it has neither guard nor watchdog.
"""
import threading
import time

import rospy
from sensor_msgs.msg import Joy

from support import graph
from support.fake_mux import FakeOperator, StateEar
from support.journals import Journal
from support.ros_system import children, wait_for
from support.velocity import VelocityEnd


class World:
    """Plain robots, an operator with a stick, and the real mux.

    :param robots: their names
    :param make: makes the end of a robot of its name, as :class:`VelocityEnd`
    """

    def __init__(self, system, robots, make=lambda name: VelocityEnd('/{}/cmd_vel'.format(name))):
        self.system, self.journal = system, Journal(system.home)
        self.state, self.operator = StateEar(), FakeOperator()
        self._make, self._made = make, {}
        self.select(*robots)
        self._joy = rospy.Publisher(graph.STICK, Joy, queue_size=1, tcp_nodelay=True)
        self._ends = threading.Event()
        threading.Thread(target=self._push, daemon=True).start()
        self.start()

    def select(self, *names):
        """Select these robots alone."""
        self.forward = 0.0
        self.names = names
        for name in set(names).difference(self._made):
            self._made[name] = self._make(name)
        self.robots = [self._made[name] for name in names]
        self.operator.check(*names)

    def start(self):
        """Start the mux as rosrun does, and wait until it drives."""
        run = self.state.message and self.state.message.run
        self.mux = self.system.node('mux', self.journal.argument)
        self.next(run)

    def _push(self):
        while not self._ends.wait(0.02):
            self._joy.publish(axes=[0.0, self.forward])

    def end(self):
        self._ends.set()

    def child(self):
        """Return the process number of the drive."""
        return wait_for(lambda: children(self.mux.pid), what='the drive')[0]

    def drive(self):
        """Centre the stick, then hold it out until every robot moves; return the drive's number."""
        self.forward = 0.0
        wait_for(self._sets_out, what=lambda: 'all to move: {}'.format(self.state.message))
        return self.child()

    def _sets_out(self):
        """Hold the stick out if all are ready; return whether all move."""
        state, now = self.state.message, time.monotonic()
        if self.forward and all(robot.after(now - 0.1) and robot.moves()
                                for robot in self.robots):
            return True
        ready = state and not state.waits_for and sum(
            robot.name in self.names and robot.selected and bool(robot.topic) and not robot.stands
            for robot in state.robots) == len(self.names)
        # One that has just joined waits for neutral once more.
        self.forward = 0.5 if ready else 0.0
        return False

    def zeros(self, since):
        """Return how long after that time each robot had its zero [s]."""
        found = [wait_for(lambda robot=robot: next(
            (entry for entry in robot.after(since) if entry[1:] == (0.0, 0.0)), None),
            what='a zero') for robot in self.robots]
        return [entry[0] - since for entry in found]

    def stays(self, since, until):
        """Show that with the stick held out no robot has moved since its zero."""
        wait_for(lambda: time.monotonic() > until, what='a while')
        for robot in self.robots:
            words = robot.after(since)
            zero = next(at for at, entry in enumerate(words) if entry[1:] == (0.0, 0.0))
            assert {entry[1:] for entry in words[zero:]} == {(0.0, 0.0)}

    def next(self, run):
        """Wait until the next drive is there."""
        self.state.wait(lambda state: state.run != run, 'the next drive')

    def hit(self, hit):
        """Hit the moving drive; return (when, zeros of the robots, next drive [s]).

        :param hit: called with the number of its process
        """
        drive, run = self.drive(), self.state.message.run
        since = time.monotonic()
        hit(drive)
        zeros = self.zeros(since)
        self.next(run)
        return since, zeros, time.monotonic() - since
