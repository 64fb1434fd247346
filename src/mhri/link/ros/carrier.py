# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What carries the link: zenoh (the library ``eclipse-zenoh``), used in this file alone."""
import importlib
import json
import os
import re
import sys
import threading

import rospkg

from mhri.link.carried import COMMAND, key_of, PICTURE
from mhri.link.keys import ALONE, LITTLE, says_all, TLS
from mhri.link.records import RECORD
from mhri.link.ros.datagrams import open_port
from mhri.link.sealed import OFFER
from mhri.robots.owners import called

# utils/host/common.sh installs it.
VERSION = '1.5.1'
ENDPOINT = re.compile(r'(tcp|udp|tls|quic)/(\[[0-9a-fA-F:.]+\]|[A-Za-z0-9.-]+):[0-9]{1,5}\Z')
# A peer that says nothing for so long is gone; knocks at one that is not there yet [ms].
_LEASE_MS, _KNOCK_MS, _KNOCK_MOST_MS, _OPEN_MS = 1500, 200, 1000, 1000
# Beside datagrams TLS has the time for repeating what a bad radio loses: their keys need it.
_LONG_LEASE_MS, _LONG_OPEN_MS = 5000, 4000
# What is larger is no message, to a robot, and from one or through a router [bytes].
MAX_TO_ROBOT, MAX_FROM_ROBOT = 1 << 23, 1 << 25


class LibraryMissing(Exception):
    """The library is not installed, or cannot be loaded; says the remedy."""


class CarrierError(Exception):
    """An endpoint that cannot be used; says which."""


def load_library():
    """Return the module ``zenoh``, from the place of mhri's own or from the system.

    :raises LibraryMissing: it is in neither
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
    """Refuse what is no list of endpoints.

    :param secret: keys are in use
    :raises CarrierError: names the option and the remedy
    """
    for endpoint in endpoints:
        if not ENDPOINT.match(endpoint) or int(endpoint.rpartition(':')[2]) > 65535:
            raise CarrierError('--{}: {:.60} is no endpoint: give one such as '
                               'tcp/192.168.0.7:7447 or udp/192.168.0.7:7447'.format(
                                   name, repr(endpoint)))
        protocol = endpoint.partition('/')[0]
        if protocol not in (TLS if secret else ALONE):
            raise CarrierError('--{}: {} {}'.format(name, endpoint, (
                'asks nobody for a key: with keys give tls/ or quic/ in place of {}/, or '
                '--keys off'.format(protocol) if secret else
                'needs keys: put one in place with mhri_keys.sh, or give --keys FOLDER')))


class Carrier:
    """A zenoh session of one robot's link; it finds the other side by itself, again and again.

    Everything is sent at once or dropped, never kept: commands before states before pictures.

    :param listen: endpoints on which the other side may call, e.g. ``['tcp/0.0.0.0:7447']``
    :param connect: endpoints to call
    :param secrets: settings of zenoh for keys, see :meth:`mhri.link.ros.key_folder.KeyFolder.read`;
        None for a link without
    :param place: ``peer``; ``routed`` if what is called is a zenoh router; or ``router`` itself
    :param own: the name in the own key: between peers that have one sealed datagrams go, too
    :param max_bytes: of a message that comes: who sends a larger one is hung up on
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
        # What to declare anew: {key: its publisher and its class}, [(keys, function, subscriber)].
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
            'connect/retry': {'period_init_ms': _KNOCK_MS, 'period_max_ms': _KNOCK_MOST_MS,
                              'period_increase_factor': 1.5},
            # A router passes nothing on between peers of which it hears no gossip. Whom the others
            # gossip about is never called.
            'scouting/multicast/enabled': False,
            'scouting/gossip/enabled': self._place != 'peer',
            'scouting/gossip/autoconnect': {'router': [], 'peer': []},
            'transport/unicast/open_timeout': _LONG_OPEN_MS if self._datagrams else _OPEN_MS,
            'transport/link/tx/lease': _LONG_LEASE_MS if self._datagrams else _LEASE_MS,
            'transport/link/rx/max_message_size': self._max_bytes,
            'transport/link/protocols': list(ALONE if secrets is None else TLS)}
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
            self._kept = [(keys, hear, session.declare_subscriber(keys, hear))
                          for keys, hear, _ in self._kept]

    def renew(self, secrets):
        """Hang up, and call again with other keys; what is sent meanwhile is dropped.

        :raises CarrierError: the endpoint cannot be listened on yet; try again
        """
        self.hang_up()
        self._open(secrets)

    def hang_up(self):
        """Hear and reach nobody any more, until :meth:`renew`."""
        with self._lock:
            session, self._session = self._session, None
            self._publishers = {key: (None, urgency)
                                for key, (_, urgency) in self._publishers.items()}
        if self._datagrams is not None:
            self._datagrams.forget()
        if session is not None:
            session.close()

    def agree_again(self, owners):
        """Let those with these names in their certificates show by TLS once more who they are.

        Until they have, no datagram of theirs counts.
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
        """Call a function with (key, bytes) of all that comes, on zenoh's thread."""
        def hear(sample):
            """Pass a message on."""
            on_bytes(str(sample.key_expr), sample.payload.to_bytes())
        with self._lock:
            # zenoh forgets what nobody holds.
            self._kept.append((keys, hear, self._session and
                               self._session.declare_subscriber(keys, hear)))

    def leave(self, root, way):
        """Say and hear nothing more below a key, and by a way of datagrams (or None)."""
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
        """Return what carries the link of a robot with one host."""
        return Between(self, robot, host)

    def way(self, *words):
        """Return a :class:`mhri.link.ros.datagrams.Way`, None where there are no datagrams."""
        return self._datagrams and self._datagrams.way(*words)

    def fill(self, status):
        """Add the figures of the datagrams to a ``DiagnosticStatusWrapper``."""
        if self._datagrams is not None:
            self._datagrams.fill(status)
        return status

    def lets(self, host, topic):
        """Tell whether a host may say something to the robot here, as zenoh does for TLS."""
        return topic in LITTLE or says_all(self._own, host)

    def close(self):
        """Hang up for good."""
        if self._datagrams is not None:
            self._datagrams.close()
        self.hang_up()


class Between:
    """The part of a :class:`Carrier` that belongs to one robot and one host."""

    def __init__(self, carrier, robot, host):
        self._carrier, self._robot, self._host = carrier, robot, host
        self._way = None

    def sender(self, way, topic, urgency):
        """Return a function that sends bytes as a stream's next message."""
        send = self._carrier.sender(key_of(self._robot, self._host, way, topic), urgency)

        def go(data):
            """Send by a sealed datagram where those pass."""
            if self._way is None or not self._way.send(topic, data):
                send(data)
        return go

    def listen(self, way, on_bytes):
        """Call a function with (topic, bytes) of all that comes on a way, on another thread."""
        root = key_of(self._robot, self._host, way, '')
        back = key_of(self._robot, self._host, 'up' if way == 'down' else 'down', OFFER)
        self._way = self._carrier.way(
            '{} with {}'.format(self._robot, called(self._host)), (self._robot, self._host),
            self._carrier.sender(back, COMMAND),
            lambda topic: way == 'up' or self._carrier.lets(self._host, topic))
        if self._way is not None:
            self._way.listen(on_bytes)

        def hear(key, data):
            """Take in what came over TLS, or without keys."""
            if key[len(root):] != OFFER:
                on_bytes(key[len(root):], data)
            elif self._way is not None:
                self._way.on_offer(data)
        self._carrier.listen(root + '**', hear)

    def close(self):
        """Say and hear nothing more."""
        self._carrier.leave(key_of(self._robot, self._host, '', '')[:-1], self._way)
