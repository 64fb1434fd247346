# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The UDP port of a link with keys, for its sealed datagrams (:mod:`mhri.link.sealed`).

On the listening end it has the same number as the TLS port. If datagrams do not pass, for example
because of a firewall, all messages use TLS.
"""
import collections
import logging
import os
import selectors
import socket
import threading

from mhri.link.frames import FrameError
from mhri.link.keys import is_of
from mhri.link.ros.clock import boot_clock
from mhri.link.sealed import SealedChannel, MAX_BYTES, OFFER, REPLAYED, run_of, SealError, STRANGER

# Period of the keepalives, which test whether datagrams pass [s].
SHOW_S = 0.25
# Period of the offers over TLS, while datagrams do not pass and while they do [s].
OFFER_S, REMIND_S = 1.0, 10.0
# Period of address look-ups while nothing is received from the called address [s].
LOOK_UP_S = 5.0
# After this silence the original address of an end is used, and less often [s].
GONE_S = 10.0
# Period of the log lines for each reason [s].
LOG_S = 10.0
PASS = 'pass: lost packets delay nothing'
PASS_NOT = 'do not pass: everything goes over TLS'
_LARGEST = 65536
# Socket buffer: the default is too small for the parts of a recording in one request.
BUFFER_BYTES = 1 << 20
# Number of datagrams to read from one port before serving others.
_AT_ONCE = 64
# The logger of rospy, without importing it.
_LOG = logging.getLogger('rosout')
# Refusals that also occur between legitimate ends: counted, but not logged.
_QUIET = (REPLAYED, STRANGER)


def open_port(listen, connect):
    """Return running :class:`Datagrams`, None if the endpoints have no TLS.

    :param listen: endpoints; the UDP port of each TLS endpoint is listened on
    :param connect: endpoints to call
    """
    ends = [[address_of(end) for end in row if end.startswith('tls/')] for row in (listen, connect)]
    if not any(ends):
        return None
    try:
        from cryptography.exceptions import InvalidTag
        from cryptography.hazmat.primitives.ciphers.aead import AESGCM
    except ImportError as error:
        _LOG.warning('no sealed datagrams, so everything goes over TLS, too slow to drive on a bad '
                     'radio: install python3-cryptography (%s)', error)
        return None
    return Datagrams(*ends, lambda: SealedChannel(AESGCM, os.urandom, InvalidTag)).start()


def address_of(endpoint):
    """Return (host, port) of an endpoint such as ``tls/192.168.0.7:7447``."""
    host, _, port = endpoint.partition('/')[2].rpartition(':')
    return host.strip('[]'), int(port)


class Datagrams:
    """Sends and receives the sealed datagrams of one :class:`mhri.link.ros.carrier.Carrier`.

    :param listen: (address, port) to listen on
    :param connect: (address, port) to call
    :param channel: returns a new :class:`mhri.link.sealed.SealedChannel`
    """

    def __init__(self, listen, connect, channel, clock=boot_clock):
        self._clock = clock
        self._make_channel = channel
        self._ways = []
        self._lock = threading.Lock()
        self.refused = collections.Counter()
        self._logged_at = {}
        self._ended = False
        self._selector = selectors.DefaultSelector()
        for address in listen:
            self._bind(*address)
        self._calls = [_Call(*address) for address in connect]

    def _bind(self, host, port):
        bound = None
        try:
            family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            bound = socket.socket(family, socket.SOCK_DGRAM)
            bound.bind(address)
        except OSError as error:
            if bound is not None:
                bound.close()
            _LOG.warning('no datagrams on UDP port %d: %s; everything goes over TLS, too slow to '
                         'drive on a bad radio', port, error)
            return
        self._add(bound)

    def _add(self, bound):
        bound.setblocking(False)
        for buffer in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            # Linux limits this to its maximum.
            bound.setsockopt(socket.SOL_SOCKET, buffer, BUFFER_BYTES)
        self._selector.register(bound, selectors.EVENT_READ)

    def start(self):
        """Start the thread."""
        threading.Thread(target=self._run, name='datagrams', daemon=True).start()
        return self

    def way(self, name, ends, offer, topics):
        """Return the path to one other end.

        :param name: name of that end, for the log
        :param ends: (robot, host) of the link
        :param offer: called with an offer, sends it over TLS
        :param topics: called with a topic, returns whether that end may send it
        """
        found = DatagramPath(name, ends, self, self._make_channel(), offer, topics)
        with self._lock:
            self._ways.append(found)
        return found

    def leave(self, way):
        """Stop sending and receiving on a path."""
        with self._lock:
            self._ways = [other for other in self._ways if other is not way]

    def forget(self, owners=None):
        """Negotiate new keys with some ends or all; meanwhile all messages use TLS.

        :param owners: names in certificates; None for all
        """
        for way in list(self._ways):
            if owners is None or any(is_of(owner, *way.ends) for owner in owners):
                way.forget()

    def close(self):
        """Stop sending and receiving."""
        self._ended = True
        with self._lock:
            self._ways = []

    def fill(self, status):
        """Add to a ``DiagnosticStatusWrapper`` whether datagrams pass, and the drops."""
        now = self._clock()
        for way in list(self._ways):
            status.add('sealed datagrams, ' + way.name, PASS if way.channel.used(now) else PASS_NOT)
        for why, count in sorted(self.refused.items()):
            status.add('dropped: ' + why, count)

    def places(self):
        """Return [(socket, address)] of the called ends."""
        return [(call.socket, call.address) for call in self._calls if call.address]

    def now(self):
        """Return the time [s]."""
        return self._clock()

    def _run(self):
        due = 0.0
        while not self._ended:
            for key, _ in self._selector.select(max(0.0, min(SHOW_S, due - self._clock()))):
                self._read(key.fileobj)
            if self._clock() >= due:
                due = self._clock() + SHOW_S
                self._tick()
        for key in list(self._selector.get_map().values()):
            key.fileobj.close()

    def _tick(self):
        now = self._clock()
        try:
            for call in self._calls:
                fresh = call.look_up(now, any(way.place for way in self._ways))
                if fresh is not None:
                    self._add(fresh)
            for way in list(self._ways):
                way.tick(now)
        except Exception as error:  # this thread must not end: it receives all datagrams
            self.log('the datagrams failed', error)

    def _read(self, source):
        for _ in range(_AT_ONCE):
            try:
                packet, address = source.recvfrom(_LARGEST)
            except OSError:
                return
            try:
                self._receive(packet, source, address)
            except SealError as error:
                self._refuse(str(error), address)
            except Exception as error:  # as above
                self.log('a datagram failed', error)

    def _receive(self, packet, source, address):
        run = run_of(packet)
        way = next((way for way in list(self._ways) if way.channel.run == run), None)
        if way is None:
            raise SealError(STRANGER)
        way.receive(packet, source, address)

    def _refuse(self, why, address):
        self.refused[why] += 1
        if why not in _QUIET:
            self.log('dropped from {}'.format(address[0]), why)

    def log(self, what, why):
        """Log a line, once per period for each reason."""
        now = self._clock()
        if now - self._logged_at.get(str(why), -LOG_S) >= LOG_S:
            self._logged_at[str(why)] = now
            _LOG.warning('%s: %s', what, why)


class _Call:
    """An address to connect to."""

    def __init__(self, host, port):
        self._host, self._port = host, port
        self._looked_at = -LOOK_UP_S
        self.socket = self.address = None

    def look_up(self, now, connected):
        """Resolve the address periodically; return a new socket, or None."""
        if connected and self.address or now - self._looked_at < LOOK_UP_S:
            return None
        self._looked_at = now
        try:
            family, *_, self.address = socket.getaddrinfo(
                self._host, self._port, type=socket.SOCK_DGRAM)[0]
        except OSError:
            return None
        if self.socket is not None and self.socket.family == family:
            return None
        self.socket = socket.socket(family, socket.SOCK_DGRAM)
        return self.socket


class DatagramPath:
    """Datagrams to and from one other end; made by :meth:`Datagrams.way`."""

    def __init__(self, name, ends, port, channel, offer, topics):
        self.name, self.ends, self.channel = name, ends, channel
        # The socket and the source address of the newest datagram.
        self.place = None
        self._port, self._offer, self._topics = port, offer, topics
        self._lock = threading.Lock()
        self._on_bytes = None
        self._offered_at = self._sent_at = float('-inf')
        self._used = False

    def listen(self, on_bytes):
        """Set the callback of (topic, bytes) for messages, called on the thread of the port."""
        self._on_bytes = on_bytes

    def send(self, topic, data):
        """Send a message; return whether it was sent, otherwise it has to use TLS."""
        now = self._port.now()
        if len(data) > MAX_BYTES or not self.channel.used(now):
            return False
        return self._go(topic, data, now)

    def _go(self, topic, data, now):
        with self._lock:
            packet = self.channel.seal(topic, data, now)
            if packet is None:
                return False
            self._sent_at = now
        for sender, address in [self.place] if self.place else self._port.places():
            try:
                sender.sendto(packet, address)
            except OSError:
                pass  # lost, like any other datagram
        return True

    def receive(self, packet, source, address):
        """Handle a datagram for this run of the link.

        :raises mhri.link.sealed.SealError: the datagram is refused
        """
        with self._lock:
            topic, data = self.channel.open(packet, self._port.now())
            self.place = source, address
        if topic and topic != OFFER and self._topics(topic) and self._on_bytes is not None:
            self._on_bytes(topic, data)

    def on_offer(self, data):
        """Handle an offer of the other end, received over TLS."""
        try:
            with self._lock:
                news = self.channel.on_offer(data, self._port.now())
        except FrameError as error:
            self._port.log('{}: refused'.format(self.name), error)
            return
        if news:
            self._send_offer(self._port.now())

    def _send_offer(self, now):
        self._offered_at = now
        with self._lock:
            offer = self.channel.offer()
        self._offer(offer)

    def tick(self, now):
        """Repeat the offer periodically, and send keepalives."""
        used = self.channel.used(now)
        if now - self._offered_at >= (REMIND_S if used else OFFER_S):
            self._send_offer(now)
        gone = self.channel.silence_s(now) > GONE_S
        if gone and self._port.places():
            self.place = None
        if now - self._sent_at >= (OFFER_S if gone else SHOW_S):
            self._go('', b'', now)
        if used != self._used:
            _LOG.info('%s: sealed datagrams %s', self.name, PASS if used else PASS_NOT)
        self._used = used

    def forget(self):
        """Negotiate new keys."""
        with self._lock:
            self.channel.forget()
            self.place = None
        self._offered_at = float('-inf')
