# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A publisher that writes on the caller's thread, and never into a link that has stalled.

rospy's own, with a queue, hands every message to a thread of each connection: two changes of
threads, several hundred microseconds where others are busy. Without a queue it writes at once, and
waits for a robot whose link has stalled. Here nothing is ever waited for: what the socket does not
take now goes to the connection's thread, and there the newest message wins as always.

And TCP keeps what it was given: a link that comes back after a second brings a second of old
commands. So nothing is given to a connection whose peer has confirmed nothing for a while; the
newest message follows as soon as it confirms something again. A connection that has stalled with
commands in it can be dropped before the robot's own watchdog has stopped it
(:meth:`PromptPublisher.drop_cut`): what is taken back moves nothing later.
"""
import socket
import struct
import threading
import time

import rospy
from rospy.impl.tcpros_pubsub import QueuedConnection

# A peer may take 40 ms before it confirms (RFC 1122, 4.2.3.2: at most 500, Linux: 40).
LEAST_STALL_S = 0.1
# Of the watchdogs the quickest, TurtleBot3's, stops a robot 0.5 s after the last command it heard,
# which is one period (0.05 s) before the first one it did not; looked at ten times a second.
CUT_S = 0.33
_CONFIRMS_WITHIN_S = 0.05
_LOOK_AGAIN_S = 0.01
# struct tcp_info of linux/tcp.h: unacked, last_ack_recv [ms], rtt [us].
_INFO = struct.Struct('=24xI28xI8xI')


class Flow:
    """Tells whether a connection's peer still confirms what it is sent.

    :param end: its socket
    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, end, clock=time.monotonic):
        self._end = end
        self.clock = clock
        self.clear_at = clock()
        self._option = getattr(socket, 'TCP_INFO', None) if end.family in (
            socket.AF_INET, socket.AF_INET6) else None

    def stalled(self, least_s=LEAST_STALL_S):
        """Tell whether nothing has been confirmed for longer than two round trips take.

        Never less than ``least_s``; False where the system does not tell. ``clear_at`` is when
        everything was last seen confirmed.
        """
        if self._option is None:
            return False
        try:
            unacked, ack_ms, rtt_us = _INFO.unpack(
                self._end.getsockopt(socket.IPPROTO_TCP, self._option, _INFO.size))
        except (OSError, struct.error):
            return False
        now = self.clock()
        if not unacked:
            self.clear_at = now
            return False
        quiet_s = min(now - self.clear_at, ack_ms * 1e-3)
        return quiet_s > max(least_s, 2e-6 * rtt_us + _CONFIRMS_WITHIN_S)


class _Call(threading.local):
    """What the caller says of the message that it publishes now."""

    urgent = False


class PromptConnection(QueuedConnection):
    """A connection to one subscriber.

    Bytes leave in order whatever happens: while the thread has anything to do, all goes through it,
    and a message that was taken in part is finished before any other.

    :param connection: rospy's ``TCPROSTransport``
    :param queue_size: the most messages that wait, the oldest are left out
    :param call: ``call.urgent``: the message is sent into a stalled link as well
    """

    def __init__(self, connection, queue_size, call):
        self._flow = Flow(connection.socket)
        self._call = call
        self._busy = self._urgent = False
        self._rest = b''
        self._moves_at = None
        super().__init__(connection, queue_size)

    def write_data(self, data):
        """Send a message, or leave it to the thread; never waits.

        :raises Exception: what went wrong with the message before (rospy drops the connection)
        """
        with self._lock:
            if self._error:
                error, self._error = self._error, None
                raise error
            self._urgent = self._call.urgent
            if self._urgent and not self._busy:
                # What waited for the link is older.
                self._queue = []
            sent = 0
            if not self._busy and not self._queue and (self._urgent or not self._flow.stalled()):
                sent = self._send(data)
            if sent and not self._urgent:
                self._moves_at = self._flow.clock()
            if sent == len(data):
                return True
            if sent:
                self._rest, self._busy = data[sent:], True
            else:
                if 0 < self._queue_size <= len(self._queue):
                    del self._queue[0]
                self._queue.append(data)
            self._cond_data_available.notify()
        return True

    def _send(self, data):
        """Return how many bytes the socket has taken."""
        connection = self._connection
        try:
            sent = connection.socket.send(data, socket.MSG_DONTWAIT)
        except (OSError, AttributeError):
            # A full buffer, or a connection that has ended: the thread finds that out in rospy's
            # own way.
            return 0
        if sent == len(data):
            connection.stat_bytes += sent
            connection.stat_num_msg += 1
        return sent

    def drop_if_cut(self):
        """Close a connection that has stalled for :data:`CUT_S`, with all that is on its way.

        Only where that may be more than the word to stop; tell whether it was closed. The peer does
        not learn of it: it would take a new connection from another node at once, from this one
        only when its own keepalive has found out (rospy: after a minute).
        """
        if not self._flow.stalled(CUT_S) or self._moves_at is None \
                or self._moves_at < self._flow.clear_at:
            return False
        try:
            # Without lingering TCP forgets what was not confirmed.
            self._connection.socket.setsockopt(
                socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('=ii', 1, 0))
        except (OSError, AttributeError):
            return False
        self._connection.close()
        return True

    def _next(self):
        """Wait for something to send; return the list of it, [] at the end (the thread)."""
        with self._lock:
            while not self._connection.done:
                if self._rest:
                    rest, self._rest = self._rest, b''
                    return [rest]
                if self._queue and (self._urgent or not self._flow.stalled()):
                    waiting, self._queue = self._queue, []
                    self._busy = True
                    self._moves_at = self._flow.clock()
                    return waiting
                self._cond_data_available.wait(_LOOK_AGAIN_S if self._queue else None)
            return []

    def _run(self):
        """Send what did not go at once (the connection's thread)."""
        while True:
            waiting = self._next()
            if not waiting:
                return
            error = None
            try:
                for data in waiting:
                    self._connection.write_data(data)
            except Exception as reason:  # handed to whoever publishes next, as rospy does
                error = reason
            with self._lock:
                self._busy = False
                self._moves_at = self._flow.clock()
                self._error = error or self._error


class PromptPublisher(rospy.Publisher):
    """A ``rospy.Publisher`` with a queue, ``tcp_nodelay`` and :class:`PromptConnection`.

    :param name: the topic
    :param message_class: its type
    :param queue_size: see :class:`PromptConnection`
    """

    def __init__(self, name, message_class, queue_size=1):
        super().__init__(name, message_class, tcp_nodelay=True, queue_size=queue_size)
        self._call = call = _Call()
        impl = self.impl
        plain = type(impl).add_connection

        def add_connection(connection):
            return plain(impl, PromptConnection(connection, queue_size, call))

        # It wraps each connection in rospy's own where the topic has a size.
        impl.set_queue_size(None)
        impl.add_connection = add_connection

    def drop_cut(self):
        """Close the connections that have stalled with commands in them; return how many."""
        return sum(connection.drop_if_cut() for connection in list(self.impl.connections)
                   if isinstance(connection, PromptConnection))

    def publish_urgent(self, message):
        """Publish what may be late but must not be left out: the word to stop.

        It is given to a stalled link, too, behind the little that is in it: whatever comes to this
        program meanwhile, the robot hears it before anything newer.
        """
        self._call.urgent = True
        try:
            self.publish(message)
        finally:
            self._call.urgent = False
