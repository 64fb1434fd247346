# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The last zero of a panel that was killed.

A program that gets SIGKILL (or runs out of memory) cannot say zero any more, and not every robot
has a watchdog (turtlebot3#1154). So the panel keeps a child process which knows the velocity topics
of the robots being driven. Their pipe breaks the moment the panel is gone, however it went, and the
child sends the zeros. A panel that ends in good order says so first.

The pipe carries one JSON list per line: ``["open", topic]``, ``["close", topic]``,
``["driven", [topic, ...]]``, ``["bye"]``.
"""
import json
import os
import subprocess
import sys
import time

from geometry_msgs.msg import Twist
import rospy

from mhri.core.arbiter import REPEAT_HZ, ZEROS_S


class KeeperLink:
    """The panel's end of the pipe; a keeper that cannot be started or has died is done without."""

    def __init__(self):
        self._process = None
        self._driven = ()
        self._open = set()

    def start(self):
        """Start the child (on a ROS thread: it takes a moment)."""
        command = [sys.executable, '-c', 'from mhri.nodes.gate_keeper import main; main()']
        try:
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE,
                                             start_new_session=True)
        except OSError as error:
            rospy.logwarn('no gate keeper: a robot without a watchdog would drive on if this '
                          'program were killed (%s)', error)
            return
        os.set_blocking(self._process.stdin.fileno(), False)
        for topic in sorted(self._open):
            self._say('open', topic)

    def open(self, topics):
        """Let the child connect to the velocity topics of a robot."""
        for topic in topics:
            self._open.add(topic)
            self._say('open', topic)

    def close(self, topics):
        """Let the child forget them."""
        for topic in topics:
            self._open.discard(topic)
            self._say('close', topic)

    def drive(self, topics):
        """Tell which topics would need a zero now; said only when it changes."""
        if topics != self._driven:
            self._driven = topics
            self._say('driven', list(topics))

    def end(self):
        """Say goodbye: the gates have sent their zeros themselves."""
        self._say('bye')
        if self._process:
            self._process.stdin.close()
            self._process = None

    def _say(self, *words):
        """Write one line; never wait for the child."""
        process = self._process
        if process is None:
            return
        try:
            os.write(process.stdin.fileno(), (json.dumps(words) + '\n').encode('ascii'))
        except OSError as error:
            rospy.logwarn_throttle(10.0, 'the gate keeper does not listen: {}'.format(error))


class Keeper:
    """The child: reads the pipe until it breaks, then sends zeros where they are needed.

    :param lines: iterable of text lines, ends when the panel is gone
    :param advertise: function from a topic to something with ``publish`` and ``unregister``
    """

    def __init__(self, lines, advertise, sleep=time.sleep):
        self._lines = lines
        self._advertise = advertise
        self._sleep = sleep
        self._publishers = {}
        self._driven = []

    def run(self):
        """Return when the panel has ended; return the topics that were sent zeros."""
        for line in self._lines:
            word, *rest = json.loads(line)
            if word == 'bye':
                return []
            self._obey(word, *rest)
        for _ in range(int(ZEROS_S * REPEAT_HZ) if self._driven else 0):
            for topic in self._driven:
                self._publishers[topic].publish(Twist())
            self._sleep(1.0 / REPEAT_HZ)
        return self._driven

    def _obey(self, word, value):
        """Follow one line of the panel."""
        if word == 'open' and value not in self._publishers:
            self._publishers[value] = self._advertise(value)
        elif word == 'close' and value in self._publishers:
            self._publishers.pop(value).unregister()
        elif word == 'driven':
            self._driven = [topic for topic in value if topic in self._publishers]
