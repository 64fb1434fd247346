# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All that reaches beneath rospy's public interface, in one place, tested at import.

Nobody develops rospy any further (ros_comm was archived in 2025), but a distribution may patch it:
this module looks at import for all it relies on, and an :class:`ImportError` says what is missing.

**Publishing.** rospy's own publisher, with a queue, passes every message to a thread of each
connection: two thread switches, several hundred microseconds on a busy computer. Without a queue it
writes at once, but waits for a robot whose link has stalled. :class:`PromptPublisher` writes at
once and never waits: what the socket does not take now goes to the connection's thread, and there
the newest message wins as always. And TCP keeps what it was given: a link that comes back after a
second brings a second of old commands. So a connection whose peer has confirmed nothing for a while
gets nothing but zeros; the newest message follows as soon as it confirms something.

**Who is there.** :func:`caller_of`, :func:`listeners`, :func:`on_publisher_gone` and
:func:`publisher_uri` tell who is at the other end of a connection, and when it is gone.
"""
import socket
import struct
import threading
import time

import rospy
from rospy.impl.masterslave import ROSHandler
from rospy.impl.paramserver import get_param_server_cache
from rospy.impl.registration import (
    get_registration_listeners, get_service_manager, get_topic_manager)
from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import QueuedConnection

# A peer may take 40 ms before it confirms (RFC 1122, 4.2.3.2: at most 500, Linux: 40).
LEAST_STALL_S = 0.1
_CONFIRMS_WITHIN_S = 0.05
_LOOK_AGAIN_S = 0.01
# struct tcp_info of linux/tcp.h: unacked, last_ack_recv [ms], rtt [us].
_INFO = struct.Struct('=24xI28xI8xI')


class Flow:
    """Tells whether a connection's peer still confirms what it gets.

    :param end: its socket
    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, end, clock=time.monotonic):
        self._end = end
        self.clock = clock
        self.clear_at = clock()
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
        if not unacked:
            self.clear_at = now
            return 0.0
        quiet_s = min(now - self.clear_at, ack_ms * 1e-3)
        return quiet_s if quiet_s > 2e-6 * rtt_us + _CONFIRMS_WITHIN_S else 0.0

    def stalled(self):
        """Tell whether nothing has been confirmed for :data:`LEAST_STALL_S`, or two round trips."""
        return self.quiet_s() > LEAST_STALL_S


class _Call(threading.local):
    """The caller's word on the message that it publishes now."""

    urgent = False


class PromptConnection(QueuedConnection):
    """A connection to one subscriber.

    Bytes always leave in order: while the thread has anything to do, everything goes through it,
    and it finishes a partly sent message before any other.

    :param connection: rospy's ``TCPROSTransport``
    :param queue_size: the most messages that wait; the oldest are dropped
    :param call: ``call.urgent``: send the message even into a stalled link
    """

    def __init__(self, connection, queue_size, call):
        self._flow = Flow(connection.socket)
        self._call = call
        self._busy = self._urgent = False
        self._rest = b''
        super().__init__(connection, queue_size)

    def write_data(self, data):
        """Send a message, or leave it to the thread; never waits.

        :raises Exception: what went wrong with an earlier message (rospy drops the connection)
        """
        with self._lock:
            if self._error:
                error, self._error = self._error, None
                raise error
            self._urgent = self._call.urgent
            if self._urgent and not self._busy:
                # What waits for the link is older.
                self._queue = []
            sent = 0
            if not self._busy and not self._queue and (self._urgent or not self._flow.stalled()):
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
            """Add the connection in our own wrapper."""
            return plain(impl, PromptConnection(connection, queue_size, call))

        # Given a size, rospy wraps each connection in its own class; another publisher of this
        # topic in the same process (a plugin beside us in rqt) would set one.
        impl.set_queue_size(None)
        impl.set_queue_size = lambda size: None
        impl.add_connection = add_connection
        with impl.c_lock:
            # A waiting robot may have connected since the topic was registered, above.
            impl.connections = [link if isinstance(link, PromptConnection) else PromptConnection(
                getattr(link, '_connection', link), queue_size, call)
                for link in impl.connections]

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

    def publish_urgent(self, message):
        """Publish what may be late but must not be dropped: the word to stop.

        It goes even into a stalled link, behind the little already in it: whatever happens to this
        program meanwhile, the robot hears it before anything newer.
        """
        self._call.urgent = True
        try:
            self.publish(message)
        finally:
            self._call.urgent = False


def caller_of(message):
    """Return the caller id of whoever sent a message, '' if unknown."""
    return (message._connection_header or {}).get('callerid', '')


def type_of(message):
    """Return the ROS type of a message as its publisher named it."""
    return message._connection_header['type']


def link_of(message):
    """Return an object that is the same for all messages of one connection."""
    return message._connection_header


def listeners(connections):
    """Return the caller ids at the other end of a publisher's connections."""
    return {connection.endpoint_id for connection in connections}


def publishers(subscriber):
    """Return the caller ids of the publishers that are connected to a ``rospy.Subscriber``."""
    impl = subscriber.impl
    return {link.callerid_pub for link in (impl.connections if impl else ())}


def publisher_uri(subscriber):
    """Return the XML-RPC address of a node that publishes the subscribed topic, or None."""
    impl = subscriber.impl
    return next((link.endpoint_id for link in (impl.connections if impl else ())
                 if link.endpoint_id), None)


def on_publisher_gone(subscriber, call):
    """Call a function whenever the connection to a publisher ends.

    rospy reports that only for subscribers. A killed publisher on this computer shows within
    milliseconds: the kernel closes its connections.

    :param call: called with the publisher's caller id on the connection's thread; must be quick
    """
    impl = subscriber.impl
    plain = impl.remove_connection

    def remove_connection(connection):
        """Let rospy forget the connection, then tell."""
        plain(connection)
        caller = connection.callerid_pub
        if not any(other.callerid_pub == caller for other in impl.connections):
            call(caller)

    impl.remove_connection = remove_connection


def ended_by_hand():
    """Return a function that tells whether somebody ended this node by ``rosnode kill``.

    The master, which ends the older of two nodes with one name, does not count. Call it after
    ``init_node``.
    """
    reasons = []
    rospy.core.add_preshutdown_hook(reasons.append)
    return lambda: any('user request' in reason for reason in reasons)


def unsubscribe(subscriber):
    """Unregister a ``rospy.Subscriber`` (blocking: it asks the master).

    rospy leaves the epoll handle of the topic open until the garbage collector comes to its oldest
    generation (ros_comm issue 2373), hundreds of them as an operator toggles views: this closes it.
    """
    impl = subscriber.impl
    subscriber.unregister()
    if impl is not None and impl.closed:
        impl.connection_poll.poller.close()


def never_ask_for(name, value):
    """Tell rospy the value of a parameter, so that it never asks the master for it."""
    get_param_server_cache().set(name, value)


def skip_number(publisher):
    """Count a message of a ``rospy.Publisher`` that is not sent, as if it were lost on the way."""
    publisher.impl.seq += 1


def answer_late(wait):
    """Call a function before this process answers who asks for its id, as the link probe does."""
    plain = ROSHandler.getPid

    def get_pid(handler, caller_id):
        wait()
        return plain(handler, caller_id)

    ROSHandler.getPid = get_pid


def registrations():
    """Return this node's registrations: ([(topic, type)], [(service, URI)], [(topic, type)]).

    These are publications, services and subscriptions.
    """
    topics = get_topic_manager()
    return (topics.get_publications(), get_service_manager().get_services(),
            topics.get_subscriptions())


def meet_publishers(topic, uris):
    """Connect this node's subscription to publishers, as if the master had reported them."""
    manager = next(iter(get_registration_listeners().listeners), None)
    if manager is not None:
        manager.publisher_update(topic, uris)


def _self_test():
    """Check for everything that this module relies on.

    :raises ImportError: rospy is not the version this was written for
    """
    wanted = [
        (ROSHandler, ('getPid',)),
        (rospy.topics._PublisherImpl, ('add_connection', 'set_queue_size', 'publish')),
        (rospy.topics._SubscriberImpl, ('add_connection', 'remove_connection')),
        (TCPROSTransport, ('set_cleanup_callback', 'write_data', 'close', 'receive_loop')),
        (QueuedConnection, ('write_data', '_run', '_closed_connection_callback'))]
    missing = ['{}.{}'.format(owner.__name__, name) for owner, names in wanted for name in names
               if not callable(getattr(owner, name, None))]
    constructors = {rospy.topics._TopicImpl: ('connections', 'connection_poll', 'closed'),
                    TCPROSTransport: ('callerid_pub', 'endpoint_id'),
                    QueuedConnection: ('_queue', '_error', '_cond_data_available', '_thread')}
    missing += ['{}.{}'.format(owner.__name__, name) for owner, names in constructors.items()
                for name in names if name not in owner.__init__.__code__.co_names]
    if missing:
        raise ImportError('mhri cannot work with this rospy: it has no {}; install ros_comm 1.15 '
                          'or 1.16'.format(', '.join(missing)))


_self_test()
