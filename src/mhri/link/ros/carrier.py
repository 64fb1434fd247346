# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The transport of the link: zenoh (the library ``eclipse-zenoh``), used only in this file."""
import importlib
import json
import os
import re
import sys
import threading

import rospkg

from mhri.link.carried import COMMAND, key_of, PICTURE
from mhri.link.keys import LITTLE, protocol_of, says_all
from mhri.link.records import RECORD
from mhri.link.ros.datagrams import open_port
from mhri.link.sealed import OFFER
from mhri.robots.owners import called

# Installed by utils/host/common.sh.
VERSION = '1.5.1'
ENDPOINT = re.compile(r'(tcp|tls|udp|quic)/(\[[0-9a-fA-F:.]+\]|[A-Za-z0-9.-]+):[0-9]{1,5}\Z')
# Protocols of earlier versions, which carry nothing any more.
GONE = ('udp', 'quic')
# Lease of a silent peer; period of the attempts to connect; time to open a connection [ms].
_LEASE_MS, _RETRY_MS, _MAX_RETRY_MS, _OPEN_MS = 1500, 200, 1000, 1000
# With datagrams TLS only has to carry their keys, so it may take longer to retransmit [ms].
_LONG_LEASE_MS, _LONG_OPEN_MS = 5000, 4000
# Maximum size of a message to a robot, and from one or through a router [bytes].
MAX_TO_ROBOT, MAX_FROM_ROBOT = 1 << 23, 1 << 25


class LibraryMissing(Exception):
    """The library is missing, or cannot be loaded; the text names the remedy."""


class CarrierError(Exception):
    """An unusable endpoint, named in the text."""


def load_library():
    """Return the module ``zenoh``, from mhri's workspace or from the system.

    :raises LibraryMissing: it is missing in both, or cannot be loaded
    """
    package = rospkg.RosPack().get_path('mhri')
    # The checkout's workspace, as devel space and as install space.
    for place in ((package, 'build', '.ws', 'link'), (package, '..', '..', '..', 'link')):
        folder = os.path.realpath(os.path.join(*place))
        if os.path.isdir(os.path.join(folder, 'zenoh')) and folder not in sys.path:
            sys.path.append(folder)
    try:
        return importlib.import_module('zenoh')
    except ImportError as error:
        raise LibraryMissing(
            'the link needs the library zenoh ({}): run utils/host/mhri_run.sh --link once, or '
            'pip3 install eclipse-zenoh=={}'.format(error, VERSION)) from None


def check_endpoints(name, endpoints, secret=False):
    """Reject invalid endpoints.

    :param secret: whether keys are in use
    :raises CarrierError: an endpoint is invalid; the text names the option and the remedy
    """
    for endpoint in endpoints:
        if not ENDPOINT.match(endpoint) or int(endpoint.rpartition(':')[2]) > 65535:
            raise CarrierError('--{}: {:.60} is not an endpoint: give one such as '
                               'tls/192.168.0.7:7447'.format(name, repr(endpoint)))
        protocol, _, address = endpoint.partition('/')
        if protocol in GONE:
            raise CarrierError(
                '--{}: {}: {}/ is no longer a way to connect: give tls/{} with keys, which drives '
                'on a bad radio, or tcp/{} with --keys off on a network that you trust'.format(
                    name, endpoint, protocol, address, address))
        if protocol != protocol_of(secret):
            raise CarrierError('--{}: {} {}'.format(name, endpoint, (
                'does not check keys: with keys give tls/{}, or --keys off'.format(address)
                if secret else
                'needs keys: put one in place with mhri_keys.sh, or give --keys FOLDER')))


class Carrier:
    """A zenoh session of one robot's link, which reconnects by itself.

    Messages are sent at once or dropped, never queued: commands before states before pictures.

    :param listen: endpoints to listen on, e.g. ``['tcp/0.0.0.0:7447']``
    :param connect: endpoints to connect to
    :param secrets: settings of zenoh for keys, see :meth:`mhri.link.ros.key_folder.KeyFolder.read`;
        None for a link without keys
    :param place: ``peer``; ``routed`` if it connects to a zenoh router; or ``router``
    :param own: the name in the own key: peers with keys also use sealed datagrams
    :param max_bytes: maximum size of a received message: larger ones close the connection
    :raises LibraryMissing: see :func:`load_library`
    :raises CarrierError: an endpoint cannot be listened on
    """

    def __init__(self, listen=(), connect=(), secrets=None, place='peer', own='',
                 max_bytes=MAX_FROM_ROBOT):
        self._max_bytes = max_bytes
        check_endpoints('listen', listen, secrets is not None)
        check_endpoints('connect', connect, secrets is not None)
        self._zenoh = load_library()
        self._listen, self._connect, self._place = list(listen), list(connect), place
        self._lock = threading.Lock()
        self._session = None
        # Declared in every session: {key: publisher and class}, [(keys, function, subscriber)].
        self._publishers = {}
        self._kept = []
        self._own = own
        self._datagrams = open_port(listen, connect) if own and place == 'peer' else None
        self._open(secrets)

    def _open(self, secrets):
        settings = {
            'mode': 'router' if self._place == 'router' else 'peer',
            'listen/endpoints': self._listen, 'connect/endpoints': self._connect,
            'connect/timeout_ms': -1, 'connect/exit_on_failure': False,
            'connect/retry': {'period_init_ms': _RETRY_MS, 'period_max_ms': _MAX_RETRY_MS,
                              'period_increase_factor': 1.5},
            # A router only forwards between peers discovered by gossip; no direct connections are
            # made to them.
            'scouting/multicast/enabled': False,
            'scouting/gossip/enabled': self._place != 'peer',
            'scouting/gossip/autoconnect': {'router': [], 'peer': []},
            'transport/unicast/open_timeout': _LONG_OPEN_MS if self._datagrams else _OPEN_MS,
            'transport/link/tx/lease': _LONG_LEASE_MS if self._datagrams else _LEASE_MS,
            'transport/link/rx/max_message_size': self._max_bytes,
            'transport/link/protocols': [protocol_of(secrets is not None)]}
        settings.update(secrets or {})
        config = self._zenoh.Config()
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        try:
            session = self._zenoh.open(config)
        except self._zenoh.ZError as error:
            raise CarrierError('cannot listen on {}: {}'.format(
                ' '.join(self._listen) or 'any port', str(error)[:300])) from None
        with self._lock:
            self._session = session
            for key, (_, urgency) in list(self._publishers.items()):
                self._publishers[key] = self._publisher(key, urgency), urgency
            self._kept = [(keys, handler, session.declare_subscriber(keys, handler))
                          for keys, handler, _ in self._kept]

    def renew(self, secrets):
        """Reconnect with other keys; messages sent meanwhile are dropped.

        :raises CarrierError: the endpoint cannot be listened on yet; retry later
        """
        self.hang_up()
        self._open(secrets)

    def hang_up(self):
        """Close all connections until :meth:`renew`."""
        with self._lock:
            session, self._session = self._session, None
            self._publishers = {key: (None, urgency)
                                for key, (_, urgency) in self._publishers.items()}
        if self._datagrams is not None:
            self._datagrams.forget()
        if session is not None:
            session.close()

    def agree_again(self, owners):
        """Require the owners of these certificates to authenticate by TLS again.

        Until then their datagrams are refused.
        """
        if self._datagrams is not None:
            self._datagrams.forget(owners)

    def _publisher(self, key, urgency):
        priorities = {COMMAND: self._zenoh.Priority.REAL_TIME,
                      PICTURE: self._zenoh.Priority.DATA_LOW,
                      RECORD: self._zenoh.Priority.BACKGROUND}
        return self._session.declare_publisher(
            key, express=urgency == COMMAND,
            congestion_control=self._zenoh.CongestionControl.DROP,
            priority=priorities.get(urgency, self._zenoh.Priority.DATA),
            reliability=self._zenoh.Reliability.BEST_EFFORT)

    def sender(self, key, urgency):
        """Return a function that sends bytes as the next message of a stream."""
        with self._lock:
            self._publishers[key] = (
                self._publisher(key, urgency) if self._session else None), urgency

        def send(data):
            """Send bytes, or drop them."""
            with self._lock:
                publisher, _ = self._publishers.get(key, (None, None))
                if publisher is not None:
                    publisher.put(data)
        return send

    def listen(self, keys, on_bytes):
        """Register a callback of (key, bytes) for received messages, on zenoh's thread."""
        def handler(sample):
            """Pass a message on."""
            on_bytes(str(sample.key_expr), sample.payload.to_bytes())
        with self._lock:
            # zenoh drops subscribers without references.
            self._kept.append((keys, handler, self._session and
                               self._session.declare_subscriber(keys, handler)))

    def leave(self, root, way):
        """Stop sending and receiving below a key, and on a path of datagrams (None: without)."""
        with self._lock:
            gone = [row for row in self._kept if row[0].startswith(root)]
            self._kept = [row for row in self._kept if row not in gone]
            ended = [subscriber for *_, subscriber in gone] + [
                self._publishers.pop(key)[0] for key in list(self._publishers)
                if key.startswith(root)]
        if way is not None:
            self._datagrams.leave(way)
        for one in ended:
            if one is not None:
                one.undeclare()

    def between(self, robot, host):
        """Return the transport between a robot and one host."""
        return Between(self, robot, host)

    def way(self, *words):
        """Return a :class:`mhri.link.ros.datagrams.DatagramPath`, None without datagrams."""
        return self._datagrams and self._datagrams.way(*words)

    def fill(self, status):
        """Add the figures of the datagrams to a ``DiagnosticStatusWrapper``."""
        if self._datagrams is not None:
            self._datagrams.fill(status)
        return status

    def lets(self, host, topic):
        """Return whether a host may send a topic to this robot, by the same rules as for TLS."""
        return topic in LITTLE or says_all(self._own, host)

    def close(self):
        """Close the session."""
        if self._datagrams is not None:
            self._datagrams.close()
        self.hang_up()


class Between:
    """The part of a :class:`Carrier` between one robot and one host."""

    def __init__(self, carrier, robot, host):
        self._carrier, self._robot, self._host = carrier, robot, host
        self._way = None

    def sender(self, way, topic, urgency):
        """Return a function that sends bytes as a stream's next message."""
        send = self._carrier.sender(key_of(self._robot, self._host, way, topic), urgency)

        def go(data):
            """Send a sealed datagram if datagrams pass; else, and for recordings, use TLS."""
            if self._way is None or urgency == RECORD or not self._way.send(topic, data):
                send(data)
        return go

    def listen(self, way, on_bytes):
        """Register a callback of (topic, bytes) for a direction, called on another thread."""
        root = key_of(self._robot, self._host, way, '')
        back = key_of(self._robot, self._host, 'up' if way == 'down' else 'down', OFFER)
        self._way = self._carrier.way(
            '{} with {}'.format(self._robot, called(self._host)), (self._robot, self._host),
            self._carrier.sender(back, COMMAND),
            lambda topic: way == 'up' or self._carrier.lets(self._host, topic))
        if self._way is not None:
            self._way.listen(on_bytes)

        def handler(key, data):
            """Handle a message received by TLS, or without keys."""
            if key[len(root):] != OFFER:
                on_bytes(key[len(root):], data)
            elif self._way is not None:
                self._way.on_offer(data)
        self._carrier.listen(root + '**', handler)

    def close(self):
        """Stop sending and receiving."""
        self._carrier.leave(key_of(self._robot, self._host, '', '')[:-1], self._way)
