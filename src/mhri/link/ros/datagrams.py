# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The UDP port of a link with keys, for its sealed datagrams (:mod:`mhri.link.sealed`).

It has the number of the port of TLS, on the end that is called there. Where datagrams do not pass,
as a firewall lets none through, everything goes over TLS.
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
from mhri.link.sealed import Lane, MOST_BYTES, OFFER, REPLAYED, run_of, SealError, STRANGER

# Each end shows so often that datagrams pass, when it has nothing to say [s].
SHOW_S = 0.25
# The keys are told so often over TLS, while datagrams do not pass and while they do [s].
OFFER_S, REMIND_S = 1.0, 10.0
# The address that is called is looked up again so often while nothing comes from it [s].
LOOK_UP_S = 5.0
# Who is silent for so long is called where it was at first, and less often [s].
GONE_S = 10.0
# One line for each reason in so long [s].
TOLD_S = 10.0
PASS = 'pass: what is lost holds up nothing'
PASS_NOT = 'do not pass: all goes over TLS'
_LARGEST = 65536
# Of a socket: the usual one does not hold the parts of a recording that are asked for at once.
BUFFER_BYTES = 1 << 20
# Of one port so many are read before others are served.
_AT_ONCE = 64
# That of rospy, which need not be there.
_LOG = logging.getLogger('rosout')
# What an honest end may do: it is counted, and no line.
_QUIET = (REPLAYED, STRANGER)


def open_port(listen, connect):
    """Return :class:`Datagrams` that have begun, None where there can be none.

    :param listen: endpoints; where they are TLS the UDP port of that number is listened on
    :param connect: endpoints that are called
    """
    ends = [[address_of(end) for end in row if end.startswith('tls/')] for row in (listen, connect)]
    if not any(ends):
        return None
    try:
        from cryptography.exceptions import InvalidTag
        from cryptography.hazmat.primitives.ciphers.aead import AESGCM
    except ImportError as error:
        _LOG.warning('no sealed datagrams, so all goes over TLS, which does not drive on a bad '
                     'radio: install python3-cryptography (%s)', error)
        return None
    return Datagrams(*ends, lambda: Lane(AESGCM, os.urandom, InvalidTag)).start()


def address_of(endpoint):
    """Return (host, port) of an endpoint such as ``tls/192.168.0.7:7447``."""
    host, _, port = endpoint.partition('/')[2].rpartition(':')
    return host.strip('[]'), int(port)


class Datagrams:
    """Sends and takes in the sealed datagrams of one :class:`mhri.link.ros.carrier.Carrier`.

    :param listen: (address, port) to listen on
    :param connect: (address, port) to call
    :param lane: returns a new :class:`mhri.link.sealed.Lane`
    """

    def __init__(self, listen, connect, lane, clock=boot_clock):
        self._clock = clock
        self._lane = lane
        self._ways = []
        self._lock = threading.Lock()
        self.refused = collections.Counter()
        self._told_at = {}
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
            _LOG.warning('no datagrams on UDP port %d: %s; all goes over TLS, which does not '
                         'drive on a bad radio', port, error)
            return
        self._add(bound)

    def _add(self, bound):
        bound.setblocking(False)
        for buffer in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            # Linux gives what it may.
            bound.setsockopt(socket.SOL_SOCKET, buffer, BUFFER_BYTES)
        self._selector.register(bound, selectors.EVENT_READ)

    def start(self):
        """Begin; returns at once."""
        threading.Thread(target=self._run, name='datagrams', daemon=True).start()
        return self

    def way(self, name, ends, offer, topics):
        """Return the way to one other end.

        :param name: of it, for the log
        :param ends: (robot, host) whose link it is
        :param offer: called with bytes to be told to it over TLS
        :param topics: called with a topic, tells whether it may say that
        """
        found = Way(name, ends, self, self._lane(), offer, topics)
        with self._lock:
            self._ways.append(found)
        return found

    def leave(self, way):
        """Send and take in nothing more by a way."""
        with self._lock:
            self._ways = [other for other in self._ways if other is not way]

    def forget(self, owners=None):
        """Agree on new keys with some or everybody; meanwhile all goes over TLS.

        :param owners: names in certificates; None for everybody
        """
        for way in list(self._ways):
            if owners is None or any(is_of(owner, *way.ends) for owner in owners):
                way.forget()

    def close(self):
        """Send and take in nothing more."""
        self._ended = True
        with self._lock:
            self._ways = []

    def fill(self, status):
        """Add to a ``DiagnosticStatusWrapper`` with whom datagrams pass, and what was dropped."""
        now = self._clock()
        for way in list(self._ways):
            status.add('sealed datagrams, ' + way.name, PASS if way.lane.used(now) else PASS_NOT)
        for why, count in sorted(self.refused.items()):
            status.add('dropped: ' + why, count)

    def places(self):
        """Return [(socket, address)] of those that are called."""
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
        except Exception as error:  # without this thread no datagram would come any more
            self.tell('the datagrams failed', error)

    def _read(self, source):
        for _ in range(_AT_ONCE):
            try:
                packet, address = source.recvfrom(_LARGEST)
            except OSError:
                return
            try:
                self._hear(packet, source, address)
            except SealError as error:
                self._refuse(str(error), address)
            except Exception as error:  # as above
                self.tell('a datagram failed', error)

    def _hear(self, packet, source, address):
        run = run_of(packet)
        way = next((way for way in list(self._ways) if way.lane.run == run), None)
        if way is None:
            raise SealError(STRANGER)
        way.hear(packet, source, address)

    def _refuse(self, why, address):
        self.refused[why] += 1
        if why not in _QUIET:
            self.tell('dropped from {}'.format(address[0]), why)

    def tell(self, what, why):
        """Write a line into the log, of each reason once in a while."""
        now = self._clock()
        if now - self._told_at.get(str(why), -TOLD_S) >= TOLD_S:
            self._told_at[str(why)] = now
            _LOG.warning('%s: %s', what, why)


class _Call:
    """Whom this end calls."""

    def __init__(self, host, port):
        self._host, self._port = host, port
        self._looked_at = -LOOK_UP_S
        self.socket = self.address = None

    def look_up(self, now, heard):
        """Find the address, in a while again; return a socket that is new, or None."""
        if heard and self.address or now - self._looked_at < LOOK_UP_S:
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


class Way:
    """Datagrams to and from one other end; made by :meth:`Datagrams.way`."""

    def __init__(self, name, ends, port, lane, offer, topics):
        self.name, self.ends, self.lane = name, ends, lane
        # The socket and the address from where the newest datagram came.
        self.place = None
        self._port, self._offer, self._topics = port, offer, topics
        self._lock = threading.Lock()
        self._on_bytes = None
        self._offered_at = self._sent_at = float('-inf')
        self._used = False

    def listen(self, on_bytes):
        """Call a function with (topic, bytes) of all that comes, on a thread of the port's."""
        self._on_bytes = on_bytes

    def send(self, topic, data):
        """Send a message; return whether it is on its way, else TLS has to carry it."""
        now = self._port.now()
        if len(data) > MOST_BYTES or not self.lane.used(now):
            return False
        return self._go(topic, data, now)

    def _go(self, topic, data, now):
        with self._lock:
            packet = self.lane.seal(topic, data, now)
            if packet is None:
                return False
            self._sent_at = now
        for sender, address in [self.place] if self.place else self._port.places():
            try:
                sender.sendto(packet, address)
            except OSError:
                pass  # lost, as the radio loses others
        return True

    def hear(self, packet, source, address):
        """Take in a datagram for this run of the link.

        :raises mhri.link.sealed.SealError: it does not count
        """
        with self._lock:
            topic, data = self.lane.open(packet, self._port.now())
            self.place = source, address
        if topic and topic != OFFER and self._topics(topic) and self._on_bytes is not None:
            self._on_bytes(topic, data)

    def on_offer(self, data):
        """Take in what the other end told over TLS."""
        try:
            with self._lock:
                news = self.lane.on_offer(data, self._port.now())
        except FrameError as error:
            self._port.tell('{}: refused'.format(self.name), error)
            return
        if news:
            self._tell(self._port.now())

    def _tell(self, now):
        self._offered_at = now
        with self._lock:
            offer = self.lane.offer()
        self._offer(offer)

    def tick(self, now):
        """Tell the key now and then, and show that datagrams pass."""
        used = self.lane.used(now)
        if now - self._offered_at >= (REMIND_S if used else OFFER_S):
            self._tell(now)
        gone = self.lane.silence_s(now) > GONE_S
        if gone and self._port.places():
            self.place = None
        if now - self._sent_at >= (OFFER_S if gone else SHOW_S):
            self._go('', b'', now)
        if used != self._used:
            _LOG.info('%s: sealed datagrams %s', self.name, PASS if used else PASS_NOT)
        self._used = used

    def forget(self):
        """Agree on new keys."""
        with self._lock:
            self.lane.forget()
            self.place = None
        self._offered_at = float('-inf')
