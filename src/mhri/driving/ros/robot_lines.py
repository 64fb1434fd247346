# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The lines to all robots: opens and closes them, and sends the drive's orders."""
import itertools
import time

import rospy

from mhri.base.accessories import Act
from mhri.base.limits import ZERO
from mhri.driving.arbiter import REPEAT_HZ, ZEROS_S
from mhri.driving.ros.known_robots import KnownRobots
from mhri.driving.ros.robot_line import RobotLine
from mhri.robots.ros.tf_feed import TfFeed


class RobotLines:
    """Opens and closes a :class:`RobotLine` for each robot, and sends the drive's orders.

    :param drive: :class:`mhri.driving.drive.Drive`
    :param lock: a re-entrant lock that guards drive and lines
    :param types: {name: RobotType}
    :param memory: :class:`mhri.graph.ros.stand_by.Memory`
    :param wake: called, under the lock, when something is due earlier than before
    :param on_foreign_stop: called, under the lock, with a robot whose guard holds a stop unknown to
        this drive
    :param on_refused: called with (name, input) of a node or robot that cannot be trusted or driven
    :param undertaker: :class:`mhri.graph.ros.undertaker.Undertaker`
    :param run: identifies this run of the drive
    :param safely: returns a ROS callback, given a function and the event of the drive for its
        failure
    :param on_open: called with each robot and the publishers of its commands, before they are used
    """

    def __init__(self, drive, lock, types, memory, clock, wake, on_foreign_stop, on_refused,
                 undertaker, run, safely, on_open=lambda name, publishers: None):
        self.drive, self.lock, self.run = drive, lock, run
        self.wake, self.on_foreign_stop, self.on_refused = wake, on_foreign_stop, on_refused
        self._clock, self.undertaker, self._on_open = clock, undertaker, on_open
        self._safely = safely
        self._sessions = itertools.count(1)
        self._lines = {}
        self._moving = set()
        self._facts = []
        self._closed = False
        # Static transforms suffice: a laser does not move on its robot.
        self._frames = TfFeed(clock)
        self._known = KnownRobots(types, self._open, self._close, self._unheard, memory,
                                  self._watched, self._on_publishers, self._readers, self._on_twins,
                                  self._nodes)

    def start(self):
        """Start looking for robots; return at once."""
        self._known.start()

    @property
    def moving(self):
        """The robots whose last sent velocity was nonzero, as a set; read only."""
        return self._moving

    def carry_out(self, orders):
        """Send the drive's orders; a failure of one line must not affect the zeros of the others.

        Call it with the lock held: a zero must stay behind the command it ends.
        """
        for name, velocity in orders:
            line = self._lines.get(name)
            if line is None:
                continue
            if isinstance(velocity, Act):
                line.accessories.send(velocity)
                continue
            (self._moving.discard if velocity.is_zero() else self._moving.add)(name)
            try:
                line.send(velocity)
            except Exception as error:  # isolate the robots from each other
                rospy.logerr_throttle(1.0, '{}: nothing can be sent: {!r}'.format(name, error))

    def look_at_listeners(self, now):
        """Check the selected robots for new subscribers, before a command."""
        self._each(lambda line: line.look_at_listeners(now) if line.rule.selected else None)

    def new_session(self):
        """Return a name not yet used for a session with a guard; its numbers start again."""
        return '{}-{}'.format(self.run, next(self._sessions))

    def safely(self, name, act):
        """Return a callback of a robot's line; if it fails, that robot waits for neutral."""
        return self._safely(act, lambda now: self.drive.on_joined(name, now)
                            if name in self._lines else [])

    def _each(self, act):
        """Call a function with every line; a failure of one must not affect the others."""
        for line in list(self._lines.values()):
            try:
                act(line)
            except Exception as error:  # isolate the robots from each other
                rospy.logerr_throttle(1.0, '{}: its line failed: {!r}'.format(line.name, error))

    def on_task(self, caller, robots, now):
        """Handle the commands of a program of tasks for some robots."""
        self._each(lambda line: line.on_task(caller, line.name in robots, now))

    def follow(self, now):
        """Apply the selection and the robots' commanders."""
        self._known.check(self.drive.lease.selected)
        self._each(lambda line: line.follow(now))

    def tick(self, now):
        """Handle the passage of time; return whether the state of a robot has changed."""
        self._each(lambda line: line.tick(now))
        before, self._facts = self._facts, [line.facts() for line in self._lines.values()]
        return before != self._facts

    def next_tick(self):
        """Return when to call :meth:`tick` next [s], None if it is not urgent."""
        times = [line.next_tick() for line in self._lines.values()]
        return min([at for at in times if at is not None], default=None)

    def messages(self):
        """Return the ``mhri/RobotDrive`` of every robot; the lock is held for one at a time."""
        with self.lock:
            lines = list(self._lines.values())
        found = []
        for line in lines:
            with self.lock:
                if self._lines.get(line.name) is line:
                    found.append(line.message())
        return found

    def set_power(self, on):
        """Restore or cut the power of all motors; return the robots that do not support it."""
        for line in self._lines.values():
            (line.power.restore if on else line.power.cut)()
        return [name for name, line in self._lines.items() if not line.power.available]

    def on_stop(self, stopped):
        """Check at once for other commanders; the end of a stop restores the power."""
        for line in self._lines.values():
            if not stopped and line.power.is_cut:
                line.power.restore()
        self._known.look_now()

    def _open(self, name, robot_type, presumed):
        """Open the line to a robot, replacing its old one (on the thread of known robots)."""
        old = self._end(name)
        try:
            line = RobotLine(name, robot_type, self, self._clock, self._frames)
        finally:
            # Not before the new line has the topics: that keeps the connections. A robot's node
            # that is slow to notice the end of one ignores the announcement of the next.
            if old is not None:
                old.close()
        with self.lock:
            if self._closed:
                return
            self._lines[name] = line
            self._on_open(name, line.publishers)
            now = self._clock()
            orders = self.drive.open(name, robot_type.limits, now, line.brake,
                                     robot_type.accessories, presumed)
            line.rule = self.drive.robots[name]
            self.carry_out(orders)
            line.follow(now)
            self.wake()
        line.accessories.listen()

    def _close(self, name):
        """Close the line to a robot with zeros (blocking: calls the master)."""
        line = self._end(name)
        if line is not None:
            line.close()

    def _end(self, name):
        """End the line to a robot with zeros; return it to be closed, None if there was none."""
        with self.lock:
            line = self._lines.get(name)
            if line is None:
                return None
            was_moving = name in self._moving
            self.carry_out(self.drive.close_robot(name, self._clock()))
            del self._lines[name]
            self._moving.discard(name)
            line.rule = None
        for _ in range(int(ZEROS_S * REPEAT_HZ) if was_moving else 0):
            time.sleep(1.0 / REPEAT_HZ)
            with self.lock:
                line.send(ZERO)
        line.end()
        return line

    def leave(self):
        """Open no more lines, and announce the end of the drive to every guard."""
        with self.lock:
            self._closed = True
            self._each(lambda line: line.leave())

    def _unheard(self):
        """Return (topic, type) of each topic that present robots should subscribe but do not."""
        with self.lock:
            return [topic for line in self._lines.values() for topic in line.unheard(self._clock())]

    def _watched(self):
        """Return the velocity topics of stopped robots, which another node may command."""
        with self.lock:
            return {name: line.velocity_topics() for name, line in self._lines.items()
                    if line.rule.stopped}

    def _nodes(self):
        """Return {name: the nodes that read or publish the robot's velocity}."""
        with self.lock:
            return {name: line.nodes() for name, line in self._lines.items()}

    def _readers(self):
        """Return {name: its nodes that read one velocity topic} of robots with several."""
        with self.lock:
            found = {name: line.several_readers() for name, line in self._lines.items()}
        return {name: nodes for name, nodes in found.items() if nodes}

    def _on_twins(self, name, found):
        """Handle the nodes that are one robot each (on the thread of known robots)."""
        with self.lock:
            line = self._lines.get(name)
            if line is not None:
                line.on_twins(found)

    def _on_publishers(self, name, found):
        """Handle the publishers of a robot's velocity topics (on the thread of known robots)."""
        line = self._lines.get(name)
        if line is not None:
            line.on_publishers(found)
