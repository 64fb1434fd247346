# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shortest way for a message into and out of a process, beneath rospy's public interface.

It is tested at import, see :mod:`mhri.graph.ros.rospy_inside`.

**Publishing.** rospy's own publisher, with a queue, passes every message to a thread of each
connection: two thread switches, several hundred microseconds on a busy computer. Without a queue it
writes at once, but blocks on a robot whose link has stalled. :class:`NonBlockingPublisher` writes
at once and never blocks: data that the socket does not accept now goes to one thread for all late
messages, where the newest message wins as usual. Moreover, TCP keeps all data: a link that comes
back after a second delivers a second of old commands. So a connection whose peer has confirmed
nothing for a while gets only zeros; the newest message follows as soon as the peer confirms again.

A connection to a robot has a :class:`mhri.graph.ros.undertaker.Line` (``watch``): it carries no
motion before another process can send a zero there, and nothing while its buffer is not nearly
empty.

**Receiving.** rospy copies each message through a buffer, four times. :func:`read_inline` reads
a message that arrives whole and alone without copies; on the driving path all do.
"""
import functools
import io
import select
import socket
import struct
import threading
import time

import genpy
import rospy
from rospy.exceptions import TransportInitError, TransportTerminated
from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import QueuedConnection
from rospy.msg import serialize_message

from mhri.graph.ros.rospy_inside import require

# A peer may delay its confirmation by 40 ms (RFC 1122, 4.2.3.2: at most 500, Linux: 40).
MIN_STALL_S = 0.1
_CONFIRMS_WITHIN_S = 0.05
_LOOK_AGAIN_S = 0.01
# struct tcp_info of linux/tcp.h: unacked, last_ack_recv [ms], rtt [us].
_INFO = struct.Struct('=24xI28xI8xI')
_LENGTH = struct.Struct('<I')
# Socket options of a connection, in this order, if the kernel supports them. By default TCP doubles
# the pause between retransmissions, so that a robot drives on for as long again as its radio was
# away. With these options seven retransmissions in a row are as quick as the first (linux/tcp.h:
# TCP_THIN_LINEAR_TIMEOUTS; with "reno", since a connection with "bbr" never counts as thin), later
# ones follow after at most a second (TCP_RTO_MAX_MS, since Linux 6.15). With such short pauses the
# kernel would give up after 14 s, and the robot, not notified, would keep its velocity: keep trying
# for a quarter of an hour, as by default.
_TRY_SOON = (
    (socket.TCP_CONGESTION, b'reno'), (16, 1), (socket.TCP_USER_TIMEOUT, 1000000), (44, 1000))


class Flow:
    """Detects whether a connection's peer still confirms the data sent.

    :param end: its socket
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, end, clock=time.monotonic):
        self._end = end
        self.clock = clock
        self._alive_at = clock()
        self._option = getattr(socket, 'TCP_INFO', None) if end.family in (
            socket.AF_INET, socket.AF_INET6) else None

    def quiet_s(self):
        """Return how long nothing was confirmed although data is outstanding [s], else 0.

        Also 0 if the system does not support it, and until two round trips have passed.
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
        """Return whether nothing has been confirmed for :data:`MIN_STALL_S`, or two round trips.

        Within that time after the connection was alive no system call is needed: it takes longer
        than the rest of a command's way out.
        """
        return (self.clock() - self._alive_at > MIN_STALL_S
                and self.quiet_s() > MIN_STALL_S)


def _try_soon(end):
    """Set the options for quick retransmissions on a connection."""
    try:
        for option, value in _TRY_SOON:
            end.setsockopt(socket.IPPROTO_TCP, option, value)
    except OSError:
        pass  # an older system, or no TCP


class _NoLine:
    """Replaces a :class:`mhri.graph.ros.undertaker.Line` on connections without commands."""

    watched = True

    def has_room(self, urgent):
        return True

    def ignore(self, *_):
        pass

    moves = about_to_send = sent = store_final_frames = forget = ignore


NO_LINE = _NoLine()


class NonBlockingConnection:
    """A connection to one subscriber, in place of rospy's ``QueuedConnection``.

    Bytes are always sent in order: while anything waits, everything waits behind it, and a partly
    sent message is finished before any other.

    :param connection: rospy's ``TCPROSTransport``
    :param queue_size: maximum number of waiting messages; the oldest are dropped
    :param watch: function that returns the :class:`mhri.graph.ros.undertaker.Line` of a socket
    """

    def __init__(self, connection, queue_size, watch):
        self._connection = connection
        self._queue_size = queue_size
        self._lock = threading.Lock()
        self._flow = Flow(connection.socket)
        _try_soon(connection.socket)
        #: the state of this connection for another process
        self.line = watch(connection.socket)
        # The rest of a message; whole messages; whether the first of them is urgent.
        self._rest, self._queue, self._urgent = b'', [], False
        connection.set_cleanup_callback(lambda _: self.line.forget())

    def __getattr__(self, name):
        if name.startswith('__'):
            raise AttributeError(name)
        return getattr(self._connection, name)

    @property
    def waits(self):
        """Whether data waits for the socket, or for a confirmation of the peer."""
        return bool(self._rest or self._queue)

    @property
    def torn(self):
        """Whether a message is partly sent and its rest waits for the socket."""
        return bool(self._rest)

    def write_data(self, data, urgent=False):
        """Send a message, or leave it to the thread for late messages; never block.

        :param urgent: send it even into a stalled link
        :raises rospy.exceptions.TransportTerminated: the connection has ended
        """
        with self._lock:
            if urgent:
                # The messages that wait for the link are older.
                self._queue, self._urgent = [], True
            else:
                self.line.moves()
            sent = 0 if self.waits or not self._may_send(urgent) else self._send(data)
            if sent == len(data):
                self._urgent = False
                return True
            if sent:
                self._urgent = False
            else:
                # A waiting zero is never dropped for a newer message.
                if 0 < self._queue_size <= len(self._queue) - self._urgent:
                    del self._queue[self._urgent]
                self._queue.append(data)
        _LATE.add(self)
        return True

    def send_late(self):
        """Send waiting data as far as the socket accepts it; return whether all is sent.

        :raises rospy.exceptions.TransportTerminated: the connection has ended
        """
        with self._lock:
            if self._rest:
                self._rest = self._rest[self._give(self._rest):]
            while self._queue and not self._rest and self._may_send(self._urgent):
                if not self._send(self._queue[0]):
                    break
                del self._queue[0]
                self._urgent = False
            return not self.waits

    def _may_send(self, urgent):
        """Return whether a message may be sent now."""
        line = self.line
        return line.has_room(urgent) and (urgent or line.watched and not self._flow.stalled())

    def _send(self, data):
        """Start sending a message; return the number of bytes sent. The rest waits."""
        self.line.about_to_send(data)
        sent = self._give(data)
        if sent:
            self._rest = data[sent:]
            self._connection.stat_num_msg += 1
        return sent

    def _give(self, data):
        """Send bytes; return how many the socket accepted."""
        connection = self._connection
        try:
            sent = connection.socket.send(data, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return 0  # its buffer is full
        except (OSError, AttributeError) as error:
            raise TransportTerminated(str(error))
        self.line.sent(sent)
        connection.stat_bytes += sent
        return sent

    def stalled_s(self):
        """Return how long the peer has not confirmed the data sent [s], 0 if it does."""
        return self._flow.quiet_s()

    @property
    def ended(self):
        """Whether the peer has hung up; a subscriber sends nothing, so there is nothing to read."""
        try:
            return not self._connection.socket.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT)
        except BlockingIOError:
            return False
        except (OSError, AttributeError):
            return True


class _Late:
    """Sends data that sockets did not accept at once: one thread for all, blocked by none."""

    def __init__(self):
        self._changed = threading.Condition()
        self._waiting = set()
        self._begun = False

    def add(self, connection):
        """Send the waiting data of a connection as soon as it accepts it."""
        with self._changed:
            self._waiting.add(connection)
            if not self._begun:
                self._begun = True
                threading.Thread(target=self._run, name='late sends', daemon=True).start()
            self._changed.notify()

    def _run(self):
        while True:
            with self._changed:
                while not self._waiting:
                    self._changed.wait()
                waiting, self._waiting = self._waiting, set()
            left = waiting
            try:
                left = [connection for connection in waiting if not _has_sent(connection)]
                _wait_for_room(left)
            except Exception:  # e.g. no memory: without this thread no late zero would be sent
                time.sleep(_LOOK_AGAIN_S)
            with self._changed:
                self._waiting.update(left)


def _wait_for_room(connections):
    """Wait until a socket accepts the rest of a message, or briefly; return at once without any."""
    full = select.poll()
    for connection in connections:
        if connection.torn:
            full.register(connection.fileno(), select.POLLOUT)
    if connections:
        full.poll(1000 * _LOOK_AGAIN_S)


def _has_sent(connection):
    """Return whether all data of a connection is sent; close it if it has ended."""
    try:
        return connection.done or connection.send_late()
    except Exception:  # as in rospy, a lost subscriber subscribes again
        connection.close()
        return True


_LATE = _Late()


class _Ended:
    """The content of rospy's wrapper after its connection was moved to ours."""

    done = True


def _prompt(link, size, watch):
    """Return a connection in our own wrapper; end rospy's wrapper if it has one."""
    if isinstance(link, NonBlockingConnection):
        return link
    bare = link
    if isinstance(link, QueuedConnection):
        # Its thread would wait for ever for the end of the connection, which only our wrapper gets,
        # and the program could not end.
        bare, link._connection = link._connection, _Ended()
        link._closed_connection_callback(bare)
    return NonBlockingConnection(bare, size, watch)


_add_plainly = rospy.topics._TopicImpl.add_connection


def _add_connection(topic, connection):
    """Add a connection to a topic, in our own wrapper if it is of a :class:`NonBlockingPublisher`.

    This includes a connection that rospy was about to add when the publisher was created. One that
    comes while the publisher is closed is ended: rospy would leave it, its duplicate at the standby
    process would keep it open, and its robot would wait there for commands for ever.

    :raises rospy.exceptions.TransportInitError: the publisher was closed meanwhile
    """
    with topic.c_lock:
        options = getattr(topic, 'mhri_options', None)
        if options is None:
            return _add_plainly(topic, connection)
        link = _prompt(connection, *options)
        if _add_plainly(topic, link):
            return True
    link.close()
    raise TransportInitError('{} was closed meanwhile'.format(topic.resolved_name))


rospy.topics._TopicImpl.add_connection = _add_connection


class NonBlockingPublisher(rospy.Publisher):
    """A ``rospy.Publisher`` with a queue, ``tcp_nodelay`` and :class:`NonBlockingConnection`.

    :param name: the topic
    :param message_class: its type
    :param queue_size: see :class:`NonBlockingConnection`
    :param watch: see :class:`NonBlockingConnection`
    """

    def __init__(self, name, message_class, queue_size=1, watch=lambda end: NO_LINE):
        super().__init__(name, message_class, tcp_nodelay=True, queue_size=queue_size)
        impl, options = self.impl, (queue_size, watch)
        # Given a size, rospy wraps each connection in its own class; another publisher of this
        # topic in the same process (a plugin beside us in rqt) would set one.
        impl.set_queue_size(None)
        impl.set_queue_size = lambda size: None
        with impl.c_lock:
            impl.mhri_options = options
            # A waiting robot may have connected since the topic was registered, above.
            impl.connections = [_prompt(link, *options) for link in impl.connections]

    def publish(self, message, urgent=False):
        """Publish a message.

        :param urgent: a stop command, which may be late but must not be dropped. It is sent even
            into a stalled link, behind the little data in it: whatever happens to this program
            meanwhile, the robot receives it before anything newer
        """
        self.publish_packed(self._packed(message), urgent)

    def publish_packed(self, data, urgent=False):
        """Publish a serialized message, preceded by its length.

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
            except Exception:  # as in rospy, a lost subscriber subscribes again
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
        """Return how long the worst connection to some nodes confirmed nothing [s], 0 if all do.

        :param names: their caller ids
        """
        return max((connection.stalled_s() for connection in self.links()
                    if connection.endpoint_id in names), default=0.0)

    def watched(self, names):
        """Return whether every connection to some nodes may carry motion."""
        return all(connection.line.watched for connection in self.links()
                   if connection.endpoint_id in names)

    def drop_ended(self):
        """Close the connections whose subscribers have hung up.

        rospy notices that only by the message after the next one, which would be lost silently.
        """
        for connection in self.links():
            if connection.ended:
                connection.close()

    def links(self):
        """Return the open connections, a tuple replaced at each change."""
        impl = self.impl
        return impl.connections if impl else ()


def _receive(connection, hear):
    """Pass messages on as long as each arrives whole and alone; return other data.

    :param hear: called with a list of one message and the connection, as rospy would
    :raises TransportTerminated: the publisher has closed the connection
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
    """Return the message in some bytes, None if they are not exactly one valid message."""
    if len(data) > _LENGTH.size and _LENGTH.unpack_from(data)[0] == len(data) - _LENGTH.size:
        try:
            return message_class().deserialize(data[_LENGTH.size:])
        except genpy.DeserializationError:
            pass  # rospy logs it and reconnects
    return None


def read_inline(subscriber):
    """Shorten the receive path of a ``rospy.Subscriber``; call it right after its creation."""
    impl = subscriber.impl
    plain = impl.add_connection

    def shorten(connection):
        """Switch a connection to our own receive path."""
        connection.receive_once = functools.partial(_receive, connection, impl.receive_callback)

    def add_connection(connection):
        """Add the connection, shortened."""
        shorten(connection)
        return plain(connection)

    impl.add_connection = add_connection
    for connection in impl.connections:
        # One message may still arrive through rospy's own path.
        shorten(connection)
    return subscriber


require(
    [(rospy.topics._PublisherImpl, ('add_connection', 'set_queue_size')),
     (rospy.topics._TopicImpl, ('add_connection',)),
     (rospy.topics._SubscriberImpl, ('add_connection', 'receive_callback')),
     (TCPROSTransport, ('set_cleanup_callback', 'write_data', 'close', 'receive_once')),
     (QueuedConnection, ('_closed_connection_callback',))],
    [(rospy.topics._TopicImpl.__init__, ('connections', 'closed')),
     (rospy.topics._PublisherImpl.__init__, ('message_data_sent',)),
     (TCPROSTransport.__init__, ('endpoint_id', 'header', 'is_latched', 'protocol', 'read_buff')),
     (TCPROSTransport.receive_loop, ('receive_once',)),
     (QueuedConnection.__init__, ('_connection',))])
