# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shortest way for a message into and out of a process, beneath rospy's public interface.

It is tested at import, see :mod:`mhri.graph.ros.rospy_inside`.

**Publishing.** rospy's own publisher, with a queue, passes every message to a thread of each
connection: two thread switches, several hundred microseconds on a busy computer. Without a queue it
writes at once, but waits for a robot whose link has stalled. :class:`PromptPublisher` writes at
once and never waits: what the socket does not take now goes to the connection's thread, and there
the newest message wins as always. And TCP keeps what it was given: a link that comes back after a
second brings a second of old commands. So a connection whose peer has confirmed nothing for a while
gets nothing but zeros; the newest message follows as soon as it confirms something.

**Receiving.** rospy copies each message through a buffer, four times. :func:`hear_promptly` reads
one that comes whole and alone as it is; on the driving path all do.
"""
import functools
import io
import socket
import struct
import time

import genpy
import rospy
from rospy.exceptions import TransportTerminated
from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import QueuedConnection
from rospy.msg import serialize_message

from mhri.graph.ros.rospy_inside import require

# A peer may take 40 ms before it confirms (RFC 1122, 4.2.3.2: at most 500, Linux: 40).
LEAST_STALL_S = 0.1
_CONFIRMS_WITHIN_S = 0.05
_LOOK_AGAIN_S = 0.01
# struct tcp_info of linux/tcp.h: unacked, last_ack_recv [ms], rtt [us].
_INFO = struct.Struct('=24xI28xI8xI')
_LENGTH = struct.Struct('<I')


class Flow:
    """Tells whether a connection's peer still confirms what it gets.

    :param end: its socket
    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, end, clock=time.monotonic):
        self._end = end
        self.clock = clock
        self._alive_at = clock()
        self._option = getattr(socket, 'TCP_INFO', None) if end.family in (
            socket.AF_INET, socket.AF_INET6) else None

    def quiet_s(self):
        """Return how long nothing was confirmed although something is due [s], else 0.

        Also 0 if the system does not tell, and until two round trips have passed.
        """
        if self._option is None:
            return 0.0
        try:
            unacked, ack_ms, rtt_us = _INFO.unpack(
                self._end.getsockopt(socket.IPPROTO_TCP, self._option, _INFO.size))
        except (OSError, struct.error):
            return 0.0
        now = self.clock()
        self._alive_at = max(self._alive_at, now - ack_ms * 1e-3) if unacked else now
        quiet_s = now - self._alive_at
        return quiet_s if quiet_s > 2e-6 * rtt_us + _CONFIRMS_WITHIN_S else 0.0

    def stalled(self):
        """Tell whether nothing has been confirmed for :data:`LEAST_STALL_S`, or two round trips.

        Less than that after it was alive it cannot be: most commands need not wait for the system's
        answer, which takes longer than the rest of their way out.
        """
        return (self.clock() - self._alive_at > LEAST_STALL_S
                and self.quiet_s() > LEAST_STALL_S)


class PromptConnection(QueuedConnection):
    """A connection to one subscriber.

    Bytes always leave in order: while the thread has anything to do, everything goes through it,
    and it finishes a partly sent message before any other.

    :param connection: rospy's ``TCPROSTransport``
    :param queue_size: the most messages that wait; the oldest are dropped
    """

    def __init__(self, connection, queue_size):
        self._flow = Flow(connection.socket)
        self._busy = self._urgent = False
        self._rest = b''
        super().__init__(connection, queue_size)

    def write_data(self, data, urgent=False):
        """Send a message, or leave it to the thread; never waits.

        :param urgent: send it even into a stalled link
        :raises Exception: what went wrong with an earlier message (rospy drops the connection)
        """
        with self._lock:
            if self._error:
                error, self._error = self._error, None
                raise error
            self._urgent = urgent
            if urgent and not self._busy:
                # What waits for the link is older.
                self._queue = []
            sent = 0
            if not self._busy and not self._queue and (urgent or not self._flow.stalled()):
                sent = self._send(data)
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
        """Return how many bytes the socket took."""
        connection = self._connection
        try:
            sent = connection.socket.send(data, socket.MSG_DONTWAIT)
        except (OSError, AttributeError):
            # A full buffer, or a closed connection: the thread finds out in rospy's own way.
            return 0
        if sent == len(data):
            connection.stat_bytes += sent
            connection.stat_num_msg += 1
        return sent

    def stalled_s(self):
        """Return how long the peer has confirmed nothing of what it was sent [s], 0 if it does."""
        return self._flow.quiet_s()

    def _next(self):
        """Wait for something to send; return it as a list, [] at the end (the thread)."""
        with self._lock:
            while not self._connection.done:
                if self._rest:
                    rest, self._rest = self._rest, b''
                    return [rest]
                if self._queue and (self._urgent or not self._flow.stalled()):
                    waiting, self._queue = self._queue, []
                    self._busy = True
                    return waiting
                self._cond_data_available.wait(_LOOK_AGAIN_S if self._queue else None)
            return []

    def _run(self):
        """Send what could not go at once (the connection's thread)."""
        while True:
            waiting = self._next()
            if not waiting:
                return
            error = None
            try:
                for data in waiting:
                    self._connection.write_data(data)
            except Exception as reason:  # raised to whoever publishes next, as in rospy
                error = reason
            with self._lock:
                self._busy = False
                self._error = error or self._error


class _Ended:
    """What a wrapper of rospy holds whose connection is in ours."""

    done = True


def _prompt(link, size):
    """Return a connection in our own wrapper; rospy's, where it has one already, ends."""
    if isinstance(link, PromptConnection):
        return link
    bare = link
    if isinstance(link, QueuedConnection):
        # Its thread would wait for ever for the end of the connection, which only ours is told,
        # and the program could not end.
        bare, link._connection = link._connection, _Ended()
        link._closed_connection_callback(bare)
    return PromptConnection(bare, size)


_add_plainly = rospy.topics._TopicImpl.add_connection


def _add_connection(topic, connection):
    """Add a connection to a topic of rospy, to one of :class:`PromptPublisher` in our own wrapper.

    Also one that rospy was about to add in its own, when the publisher was made.
    """
    with topic.c_lock:
        size = getattr(topic, 'mhri_queue_size', None)
        return _add_plainly(topic, connection if size is None else _prompt(connection, size))


rospy.topics._TopicImpl.add_connection = _add_connection


class PromptPublisher(rospy.Publisher):
    """A ``rospy.Publisher`` with a queue, ``tcp_nodelay`` and :class:`PromptConnection`.

    :param name: the topic
    :param message_class: its type
    :param queue_size: see :class:`PromptConnection`
    """

    def __init__(self, name, message_class, queue_size=1):
        super().__init__(name, message_class, tcp_nodelay=True, queue_size=queue_size)
        impl = self.impl
        # Given a size, rospy wraps each connection in its own class; another publisher of this
        # topic in the same process (a plugin beside us in rqt) would set one.
        impl.set_queue_size(None)
        impl.set_queue_size = lambda size: None
        with impl.c_lock:
            impl.mhri_queue_size = queue_size
            # A waiting robot may have connected since the topic was registered, above.
            impl.connections = [_prompt(link, queue_size) for link in impl.connections]

    def publish(self, message, urgent=False):
        """Publish a message.

        :param urgent: it may be late but must not be dropped: the word to stop. It goes even into
            a stalled link, behind the little already in it: whatever happens to this program
            meanwhile, the robot hears it before anything newer
        """
        self.publish_packed(self._packed(message), urgent)

    def publish_packed(self, data, urgent=False):
        """Publish a message as it goes over the line, its length before it.

        :param urgent: see :meth:`publish`
        :raises rospy.ROSException: this publisher was unregistered
        """
        impl = self.impl
        if impl is None or impl.closed:
            if not rospy.is_shutdown():
                raise rospy.ROSException('publish() to an unregistered topic')
            return
        failed = []
        for connection in impl.connections:
            try:
                connection.write_data(data, urgent)
            except Exception:  # as in rospy, whoever has gone subscribes again
                failed.append(connection)
        impl.message_data_sent += len(data)
        for connection in failed:
            connection.close()

    def _packed(self, message):
        """Return a message as bytes, and number it."""
        if self.impl:
            self.impl.seq += 1
        buffer = io.BytesIO()
        serialize_message(buffer, self.impl.seq if self.impl else 0, message)
        return buffer.getvalue()

    def stalled_s(self, names):
        """Return how long the worst connection to some nodes confirmed nothing [s]; 0: all do.

        :param names: their caller ids
        """
        return max((connection.stalled_s() for connection in self.links()
                    if connection.endpoint_id in names), default=0.0)

    def links(self):
        """Return the open connections, a tuple replaced at each change."""
        impl = self.impl
        return impl.connections if impl else ()


def _receive(connection, hear):
    """Pass messages on as long as each comes whole and alone; return what else comes.

    :param hear: called with a list of one message and the connection, as rospy would
    :raises TransportTerminated: the publisher has hung up
    """
    end, begun, protocol = connection.socket, connection.read_buff, connection.protocol
    if end is None or begun is None or begun.tell() or connection.is_latched:
        return TCPROSTransport.receive_once(connection)
    while not rospy.is_shutdown():
        try:
            data = end.recv(protocol.buff_size)
        except OSError as error:
            raise TransportTerminated(str(error))
        if not data:
            raise TransportTerminated('the publisher has hung up')
        connection.stat_bytes += len(data)
        message = _whole(data, protocol.recv_data_class)
        if message is None:
            begun.write(data)
            return TCPROSTransport.receive_once(connection)
        message._connection_header = connection.header
        connection.stat_num_msg += 1
        hear([message], connection)
    return []


def _whole(data, message_class):
    """Return the one message that some bytes are, None if they are no such thing."""
    if len(data) > _LENGTH.size and _LENGTH.unpack_from(data)[0] == len(data) - _LENGTH.size:
        try:
            return message_class().deserialize(data[_LENGTH.size:])
        except genpy.DeserializationError:
            pass  # rospy says so and connects anew
    return None


def hear_promptly(subscriber):
    """Let the messages of a ``rospy.Subscriber`` come on a shorter way; call it at once."""
    impl = subscriber.impl
    plain = impl.add_connection

    def shorten(connection):
        """Let a connection receive in our own way."""
        connection.receive_once = functools.partial(_receive, connection, impl.receive_callback)

    def add_connection(connection):
        """Add the connection, shortened."""
        shorten(connection)
        return plain(connection)

    impl.add_connection = add_connection
    for connection in impl.connections:
        # One message may still come in rospy's way.
        shorten(connection)
    return subscriber


require(
    [(rospy.topics._PublisherImpl, ('add_connection', 'set_queue_size')),
     (rospy.topics._TopicImpl, ('add_connection',)),
     (rospy.topics._SubscriberImpl, ('add_connection', 'receive_callback')),
     (TCPROSTransport, ('set_cleanup_callback', 'write_data', 'close', 'receive_once')),
     (QueuedConnection, ('write_data', '_run', '_closed_connection_callback'))],
    [(rospy.topics._TopicImpl.__init__, ('connections', 'closed')),
     (rospy.topics._PublisherImpl.__init__, ('message_data_sent',)),
     (TCPROSTransport.__init__, ('endpoint_id', 'header', 'is_latched', 'protocol', 'read_buff')),
     (TCPROSTransport.receive_loop, ('receive_once',)),
     (QueuedConnection.__init__, ('_queue', '_error', '_cond_data_available', '_thread'))])
