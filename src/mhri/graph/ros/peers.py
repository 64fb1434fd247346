# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Limits the resources of a TCPROS peer: time for its handshake, memory for a message.

rospy reads the header of a new connection on the thread that accepts connections, for as long as it
takes (``TCPServer.run`` of ``rospy/impl/tcpros_base.py``): one silent connection locks out every
later subscriber and service call, for ever. Here a separate thread waits for each header, for
:data:`LIMIT_S`; rospy's code gets the connection once the whole header has arrived.

When a connection of our own breaks in the middle of a message, or delivers garbage, rospy keeps the
bytes it has read: it treats them as the start of the next header, finds it invalid, and never
connects again (``TCPROSTransport.read_header``). Here each header starts with an empty buffer. It
also never reconnects after a break while the publisher is alive; we do.

rospy buffers a message of any announced size, up to 4 GB, before it checks it, and 20 MB of small
objects become 100 MB. Here a peer that announces more than its topic can need is disconnected.

A request that cannot be read ends rospy's thread for the connection with a traceback, and the
connection stays open (``ServiceImpl.handle`` of ``rospy/impl/tcpros_service.py``). Here it ends.
"""
import collections
import logging
import select
import socket
import struct
import threading
import time

import genpy
import rospy
from rospy.exceptions import TransportInitError, TransportTerminated
from rospy.impl import tcpros_base, tcpros_pubsub, tcpros_service
from rospy.impl.registration import get_topic_manager
from rospy.impl.tcpros_pubsub import check_if_still_publisher

from mhri.graph.ros.rospy_inside import connect_publishers, require

LIMIT_S = 10.0
# A header is a few hundred bytes. A larger size means another protocol: "GET " is 541 million.
MAX_BYTES = 64 * 1024
# Maximum message size of topics subscribed with a large buffer (pictures, clouds, maps), and of any
# other: thousands of names, beams or transforms fit into that.
LARGE_BUFFER, LARGEST_BYTES, LARGEST_OTHER_BYTES = 1 << 20, 64 << 20, 1 << 20
# Maximum number of waiting threads; beyond that the longest-waiting connection is closed.
MAX_WAITING = 32
_LOOK_AGAIN_S = 0.01
# A publisher that did not answer is called again after this time [s].
_CALL_AGAIN_S = 1.0
_LENGTH = struct.Struct('<I')
_LOG = logging.getLogger('rosout')


require([], [
    (tcpros_base.TCPServer.run, ('accept', 'inbound_handler')),
    (tcpros_base.TCPROSServer._tcp_server_callback, ('read_ros_handshake_header',)),
    (tcpros_base.TCPROSTransport.read_header, ('read_buff', 'read_ros_handshake_header')),
    (tcpros_base.TCPROSTransport.receive_once, ('read_messages', 'tell', 'TransportTerminated')),
    (tcpros_base.TCPROSTransportProtocol.__init__, ('buff_size', 'resolved_name')),
    (tcpros_pubsub.robust_connect_subscriber, ('connect', 'receive_loop')),
    (tcpros_service.ServiceImpl.handle, ('receive_once', 'TransportTerminated', 'close'))])


class HandshakeTimeout:
    """Waits for the headers of new connections; calls ``enter(connection, address)`` for each.

    :param enter: reads the header and takes over the connection; called on one thread at a time
    :param limit_s: timeout for a whole header [s]
    :param most: maximum number of headers to wait for at a time
    """

    def __init__(self, enter, limit_s=LIMIT_S, most=MAX_WAITING):
        self._enter = enter
        self._limit_s = limit_s
        self._most = most
        self._lock = threading.Lock()
        self._entering = threading.Lock()
        self._waiting = collections.OrderedDict()

    def receive(self, connection, address):
        """Accept a new connection; return at once."""
        with self._lock:
            self._waiting[connection] = address
            late = list(self._waiting.items())[:-self._most]
        for other, place in late:
            self._reject(other, place, 'too many others wait')
        threading.Thread(target=self._wait, args=(connection, address), daemon=True).start()

    def waiting(self):
        """Return the number of connections with a pending header."""
        with self._lock:
            return len(self._waiting)

    def _wait(self, connection, address):
        """Wait for the header; accept or close the connection."""
        try:
            problem = _header_problem(connection, time.monotonic() + self._limit_s)
        except OSError as error:
            problem = str(error)
        if problem:
            self._reject(connection, address, problem)
            return
        with self._lock:
            mine = self._waiting.pop(connection, None) is not None
        if mine:
            with self._entering:
                self._enter(connection, address)

    def _reject(self, connection, address, why):
        """Close the connection, unless already closed."""
        with self._lock:
            if self._waiting.pop(connection, None) is None:
                return
        try:
            # Wakes the thread that waits for it; close() alone would not.
            connection.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass  # the other end was quicker
        connection.close()
        # Only to the log file: a peer must not be able to fill the terminal.
        _LOG.debug('a connection from %s was closed: %s', address, why)


def _header_problem(connection, deadline):
    """Wait for a whole header without reading it; return why it is missing, '' if it arrived.

    :raises OSError: the connection broke
    """
    poll = select.poll()
    poll.register(connection, select.POLLIN | select.POLLRDHUP)
    while True:
        left_s = deadline - time.monotonic()
        events = poll.poll(left_s * 1e3) if left_s > 0.0 else []
        if not events:
            return 'no whole header in time'
        data = connection.recv(MAX_BYTES, socket.MSG_PEEK)
        if len(data) >= _LENGTH.size:
            whole = _LENGTH.unpack_from(data)[0] + _LENGTH.size
            if whole > MAX_BYTES:
                return 'what it says is no header'
            if len(data) >= whole:
                return ''
        if not data or events[0][1] & ~select.POLLIN:
            return 'it ended before its header did'
        # The bytes stay in the socket, so poll would return at once.
        time.sleep(_LOOK_AGAIN_S)


def _begin_headers_afresh():
    """Let a transport discard the bytes of its last connection, with a timeout for new ones."""
    read = tcpros_base.TCPROSTransport.read_header

    def read_header(self):
        """Read the header of a connection, with an empty buffer."""
        self.read_buff.seek(0)
        self.read_buff.truncate()
        problem = _header_problem(self.socket, time.monotonic() + LIMIT_S)
        if problem:
            self.mhri_unanswered = True
            self.close()
            raise TransportInitError(problem)
        read(self)
    tcpros_base.TCPROSTransport.read_header = read_header


def _call_again():
    """Reconnect to publishers that did not answer, or whose connection broke."""
    connect = tcpros_pubsub.robust_connect_subscriber

    def robust_connect_subscriber(conn, dest_addr, dest_port, pub_uri, receive_cb, topic):
        """Connect and receive; rospy's thread for one publisher of one topic."""
        connect(conn, dest_addr, dest_port, pub_uri, receive_cb, topic)
        if not rospy.is_shutdown():
            # A program waits for rospy's thread when it ends; a publisher may hang.
            threading.Thread(target=reconnect, daemon=True, args=(
                getattr(conn, 'mhri_unanswered', False), topic, pub_uri)).start()

    def reconnect(unanswered, topic, pub_uri):
        if get_topic_manager().has_subscription(topic) and (
                unanswered or check_if_still_publisher(topic, pub_uri)):
            time.sleep(_CALL_AGAIN_S)
            connect_publishers(topic, [pub_uri])
    tcpros_pubsub.robust_connect_subscriber = robust_connect_subscriber


def _cut_off_bad_messages():
    """Close connections with a message larger than its topic can need, or with a bad request."""
    read = tcpros_base.TCPROSTransportProtocol.read_messages

    def read_messages(self, b, msg_queue, sock):
        """Read the received data, unless its first message is too large."""
        size = _LENGTH.unpack_from(b.getbuffer())[0]
        most = LARGEST_BYTES if self.buff_size >= LARGE_BUFFER else LARGEST_OTHER_BYTES
        if size > most:
            _LOG.warning('%s: a message was not read: it has %.0f MB, %.0f MB are the most',
                         self.resolved_name, size * 1e-6, most * 1e-6)
            raise TransportTerminated('a message of {} bytes'.format(size))
        read(self, b, msg_queue, sock)

    def read_requests(self, b, msg_queue, sock):
        """Read the received requests; end a connection whose bytes are none."""
        try:
            read_messages(self, b, msg_queue, sock)
        except genpy.DeserializationError as error:
            raise TransportTerminated(str(error)) from error
    tcpros_base.TCPROSTransportProtocol.read_messages = read_messages
    tcpros_service.TCPService.read_messages = read_requests


def limit_peers():
    """Limit each connection to this process to :data:`LIMIT_S` for its header, and a message size.

    The process's own connections start each header with an empty buffer, and have the same timeout.
    Call it before or after ``rospy.init_node``; further calls have no effect.
    """
    server_class = tcpros_base.TCPROSServer
    read = server_class._tcp_server_callback
    if getattr(read, 'limited', False):
        return

    def callback(self, connection, address):
        """Replace the callback that waits for the header itself."""
        if getattr(self, 'mhri_handshakes', None) is None:
            self.mhri_handshakes = HandshakeTimeout(lambda *taken: read(self, *taken))
        self.mhri_handshakes.receive(connection, address)
    callback.limited = True
    server_class._tcp_server_callback = callback
    _begin_headers_afresh()
    _cut_off_bad_messages()
    _call_again()
    running = tcpros_base._tcpros_server
    if running is not None and running.tcp_ros_server is not None:
        # In rqt another plugin may have started the server, which then keeps its first callback.
        running.tcp_ros_server.inbound_handler = running._tcp_server_callback
