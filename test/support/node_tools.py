# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests that are nodes share: recorders of messages, sticks that are held, processes.

Nothing here sleeps to let something happen: whoever waits, waits for a condition.
"""
import contextlib
import operator
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

from geometry_msgs.msg import Twist
import roslib.packages
import rospy
from sensor_msgs.msg import Joy

from mhri.msg import DriveState
from support import graph
from support.paths import SUPPORT
from support.ros_system import insist, NotYet, tell, wait_for

TIMEOUT_S = 60.0
# Within this what was sent has been heard, and what was on its way has come [s].
ANSWERS_S = 0.15
# How many times what is promised it may take where others share the machine.
SHARED = 10.0
FORWARD = (0.0, 1.0)
NEUTRAL = (0.0, 0.0)


def measured(what, seconds, promised_s=None):
    """Print a time that was measured, and return it.

    :param promised_s: what is promised on an idle machine; None for nothing. The runner gives the
        whole machine to tests that compare with a promise, and sets ``MHRI_BOUNDS=exact``
    :raises AssertionError: it is longer; where others share the machine, ten times as long
    """
    print('MEASURED {}: {:.3f} ms{}'.format(
        what, seconds * 1000.0, '' if promised_s is None else ', promised {:g} ms {}'.format(
            promised_s * 1000.0, os.environ.get('PYTEST_CURRENT_TEST', ''))))
    sys.stdout.flush()
    assert promised_s is None or seconds <= promised_s * (
        1.0 if os.environ.get('MHRI_BOUNDS') == 'exact' else SHARED), (
            '{}: {:.3f} s, promised {}'.format(what, seconds, promised_s))
    return seconds


class Noted:
    """One message: when it came [s, monotonic], what it said, and which node sent it."""

    def __init__(self, value, sender):
        self.at = time.monotonic()
        self.value = value
        self.sender = sender

    def __repr__(self):
        """Say it in one line of a failed test."""
        return '{:.3f} {!r} from {}'.format(self.at, self.value, self.sender)


class Recorder:
    """Notes every message of a topic.

    :param read: function from the message to a value
    """

    def __init__(self, topic, message_class, read):
        self.topic = topic
        self._read = read
        self._noted = []
        self._changed = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, message_class, self._on_message,
                                            queue_size=1000, tcp_nodelay=True)

    def _on_message(self, message):
        with self._changed:
            self._noted.append(Noted(self._read(message), message._connection_header['callerid']))
            self._changed.notify_all()

    def __repr__(self):
        """Say what came last."""
        return '{}: {}'.format(self.topic, self.since(0.0)[-5:])

    def since(self, start):
        """Return what was noted after a time."""
        with self._changed:
            return [item for item in self._noted if item.at >= start]

    def last(self):
        """Return the newest value, or None."""
        with self._changed:
            return self._noted[-1].value if self._noted else None

    def wait(self, good, start=None, patience_s=TIMEOUT_S):
        """Wait for the first message after a time of which ``good(value)`` is true; return it.

        :param start: that time; None: from now on
        :raises NotYet: none came
        """
        start = time.monotonic() if start is None else start
        deadline = time.monotonic() + patience_s
        with self._changed:
            while True:
                for item in self._noted:
                    if item.at >= start and good(item.value):
                        return item
                left = deadline - time.monotonic()
                if left <= 0.0:
                    raise NotYet('nothing of the kind on {} in {} s, only {}'.format(
                        self.topic, patience_s, [item for item in self._noted
                                                 if item.at >= start][-20:]))
                self._changed.wait(left)

    def settle(self, *values, patience_s=TIMEOUT_S):
        """Wait for a message with one of these values that answers what is sent by now.

        The newest one may be older than that, and so may the next.

        :raises NotYet: none came
        """
        return self.wait(lambda now: now in values, time.monotonic() + ANSWERS_S, patience_s)

    def wait_newest(self, value, patience_s=TIMEOUT_S):
        """Wait until the newest message of a topic that says only what changes has this value.

        :raises NotYet: it has not
        """
        wait_for(lambda: self.last() == value, patience_s, lambda: '{} as the newest of {}'.format(
            value, self))

    def wait_silence(self, seconds, patience_s=TIMEOUT_S):
        """Wait until nothing has come for so long; return the newest message, None without one.

        :raises NotYet: messages never ceased
        """
        deadline = time.monotonic() + patience_s
        begun = time.monotonic()
        with self._changed:
            while True:
                newest = self._noted[-1].at if self._noted else begun
                left = max(newest, begun) + seconds - time.monotonic()
                if left <= 0.0:
                    return self._noted[-1] if self._noted else None
                if time.monotonic() > deadline:
                    raise NotYet('{} never falls silent'.format(self.topic))
                self._changed.wait(left)

    def wait_zeros(self, first, least=5, most=12):
        """Wait for the zeros at 20 Hz for half a second that end motion, and silence behind them.

        They are counted: a busy computer may read several at once, or be late with them.

        :param first: the first of them
        :param least: their number: 11 on an idle one
        :raises AssertionError: they are fewer or more, or anything else is among them
        """
        def zeros():
            return [item for item in self.since(first.at) if rests(item.value)]
        wait_for(lambda: len(zeros()) >= least, what=lambda: 'the zeros, only {}'.format(
            self.since(first.at)))
        self.wait_silence(0.5)
        assert zeros() == self.since(first.at), 'something moves behind the first zero'
        assert len(zeros()) <= most, zeros()

    def wait_publisher(self, patience_s=TIMEOUT_S):
        """Wait until somebody who publishes is connected."""
        wait_for(lambda: self._subscriber.get_num_connections() > 0,
                 what='no publisher of ' + self.topic, timeout_s=patience_s)

    def close(self):
        """Stop listening."""
        self._subscriber.unregister()


def twist_recorder():
    """Return a recorder of the one velocity command, as (m/s, rad/s)."""
    return Recorder(graph.COMMAND, Twist, velocity)


def state_recorder(read):
    """Return a recorder of ``/mux/state``.

    :param read: the name of a field of ``mhri/DriveState``, or a function from it to a value
    """
    return Recorder(graph.DRIVE_STATE, DriveState,
                    read if callable(read) else operator.attrgetter(read))


def advice_recorder():
    """Return a recorder of what keeps the source from driving: (code, what it is about)."""
    return state_recorder(operator.attrgetter('advice', 'advice_about'))


def velocity(twist):
    """Return a Twist as (m/s, rad/s)."""
    return twist.linear.x, twist.angular.z


def moves(value):
    """Return whether a command is other than zero."""
    return value != (0.0, 0.0)


def rests(value):
    """Return whether a command is zero."""
    return value == (0.0, 0.0)


class Stick:
    """A stick on a Joy topic, held at 50 Hz as a pad's driver does, by this process.

    :param buttons: what is held with it where nothing else is said
    """

    def __init__(self, topic, buttons=()):
        self._buttons = buttons
        self.publisher = rospy.Publisher(topic, Joy, queue_size=10, tcp_nodelay=True)
        self._held = None
        self._frame = ''
        self._changed = threading.Condition()
        self.last_sent = 0.0
        rospy.on_shutdown(self.silence)
        threading.Thread(target=self._run, daemon=True).start()

    def wait_listener(self):
        """Wait until the mux listens."""
        wait_for(lambda: self.publisher.get_num_connections() > 0, what='nobody listens')
        return self

    def _run(self):
        with self._changed:
            while not rospy.is_shutdown():
                changed = self._changed.wait(None if self._held is None else 0.02)
                if self._held is not None and not changed:
                    self._send(*self._held)

    def _send(self, axes, buttons):
        self.last_sent = time.monotonic()
        message = Joy(axes=axes, buttons=buttons)
        message.header.frame_id = self._frame
        self.publisher.publish(message)

    @contextlib.contextmanager
    def frame(self, frame_id):
        """Send with this ``header.frame_id`` for a while."""
        self._frame = frame_id
        try:
            yield
        finally:
            self._frame = ''

    def hold(self, axes, buttons=None):
        """Hold the stick like this from now on; return the time of it."""
        with self._changed:
            now = time.monotonic()
            self._held = (axes, self._buttons if buttons is None else buttons)
            # Here, not by the thread: what is held for no time at all has been said as well.
            self._send(*self._held)
            self._changed.notify()
            return now

    def repeat(self, axes, buttons=None, seconds=0.1):
        """Hold the stick like this, and repeat it for a while; return the time of the first.

        Of what is sent faster than it is read the newest alone counts.
        """
        begun = self.hold(axes, buttons)
        wait_for(lambda: self.last_sent > begun + seconds, what='nothing is sent')
        return begun

    def press(self, waits, axes=NEUTRAL):
        """Let its buttons go and press them, until a mux has seen both and waits for nothing."""
        def seen():
            for buttons in ((0,) * len(self._buttons), self._buttons):
                self.repeat(axes, buttons)
            return waits.last() == ''
        insist(seen, lambda: 'the mux to wait for nothing: {}'.format(waits.last()))

    def set_out(self, waits, twists, axes=FORWARD, buttons=None):
        """Centre the stick, and push it until robots move; return when the first command came."""
        def moved():
            self.hold(NEUTRAL, buttons)
            waits.settle('')
            begun = self.hold(axes, buttons)
            return twists.wait(moves, begun, 5.0).at
        return insist(moved, 'motion')

    def silence(self):
        """Send nothing from now on; return when the last message was sent."""
        with self._changed:
            self._held = None
            self._changed.notify()
            return self.last_sent

    def once(self, axes, buttons=()):
        """Send one message; return when."""
        with self._changed:
            self._send(axes, buttons)
            return self.last_sent


class Process:
    """A process of its own, with what it said; ended at the latest by :meth:`end`."""

    def __init__(self, command, env=None, stdin=None, output=None):
        self._said = tempfile.NamedTemporaryFile('w+', suffix='.log')
        self._popen = subprocess.Popen(command, stdout=output or self._said,
                                       stderr=subprocess.STDOUT,
                                       stdin=stdin, env=dict(os.environ, **(env or {})))
        self.stdin, self.number = self._popen.stdin, self._popen.pid

    def said(self):
        """Return everything the process has written."""
        with open(self._said.name, encoding='utf-8', errors='replace') as stream:
            return stream.read()

    def send(self, number):
        """Send a signal; return the time of it."""
        now = time.monotonic()
        self._popen.send_signal(number)
        return now

    def running(self):
        """Return whether the process lives."""
        return self._popen.poll() is None

    def wait(self, patience_s=TIMEOUT_S):
        """Wait for its end; return its exit code.

        :raises subprocess.TimeoutExpired: it does not end
        """
        return self._popen.wait(patience_s)

    def end(self):
        """Make sure that it is gone."""
        if self.running():
            self._popen.send_signal(signal.SIGCONT)
            self._popen.kill()
        self._popen.wait()
        if self.stdin:
            self.stdin.close()
        self._said.close()


def start_mux(*arguments, env=None, output=None):
    """Start the real mux node, e.g. with '__name:=other'; ``output``: where it writes instead."""
    path = roslib.packages.find_node('mhri', 'mux')[0]
    return Process([path] + list(arguments), env, output=output)


class StickProcess:
    """A stick in a process of its own, to be killed: it holds what it was last told.

    :param name: name of its node
    """

    def __init__(self, topic, name='stick_process'):
        self.process = Process([sys.executable, str(SUPPORT / 'stick_process.py'),
                                topic, '__name:=' + name], stdin=subprocess.PIPE)

    def hold(self, axes):
        """Hold the stick like this from now on."""
        tell(self.process, ' '.join(map(str, axes)))
