# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What carries the link: zenoh (the library ``eclipse-zenoh``), used in this file alone."""
import importlib
import json
import os
import re
import sys

import rospkg

from mhri.core.link.carried import COMMAND, key_of, PICTURE
from mhri.core.link.records import RECORD

# utils/host/common.sh installs it.
VERSION = '1.5.1'
ENDPOINT = re.compile(r'(tcp|udp)/(\[[0-9a-fA-F:.]+\]|[A-Za-z0-9.-]+):[0-9]{1,5}\Z')
# A peer that says nothing for so long is gone; knocks at one that is not there yet [ms].
_LEASE_MS, _KNOCK_MS, _KNOCK_MOST_MS, _OPEN_MS = 1500, 200, 1000, 1000


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


def check_endpoints(name, endpoints):
    """Refuse what is no list of endpoints.

    :raises CarrierError: names the option and the remedy
    """
    for endpoint in endpoints:
        if not ENDPOINT.match(endpoint) or int(endpoint.rpartition(':')[2]) > 65535:
            raise CarrierError('--{}: {:.60} is no endpoint: give one such as '
                               'tcp/192.168.0.7:7447 or udp/192.168.0.7:7447'.format(
                                   name, repr(endpoint)))


class Carrier:
    """A zenoh session of one robot's link; it finds the other side by itself, again and again.

    Everything is sent at once or dropped, never kept: commands before states before pictures.

    :param listen: endpoints on which the other side may call, e.g. ``['tcp/0.0.0.0:7447']``
    :param connect: endpoints to call
    :raises LibraryMissing: see :func:`load_library`
    :raises CarrierError: an endpoint cannot be listened on
    """

    def __init__(self, robot, listen=(), connect=()):
        check_endpoints('listen', listen)
        check_endpoints('connect', connect)
        self._zenoh = load_library()
        self._robot = robot
        settings = {
            'mode': 'peer', 'listen/endpoints': list(listen), 'connect/endpoints': list(connect),
            'connect/timeout_ms': -1, 'connect/exit_on_failure': False,
            'connect/retry': {'period_init_ms': _KNOCK_MS, 'period_max_ms': _KNOCK_MOST_MS,
                              'period_increase_factor': 1.5},
            'scouting/multicast/enabled': False, 'scouting/gossip/enabled': False,
            'transport/unicast/open_timeout': _OPEN_MS, 'transport/link/tx/lease': _LEASE_MS}
        config = self._zenoh.Config()
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
        try:
            self._session = self._zenoh.open(config)
        except self._zenoh.ZError as error:
            raise CarrierError('cannot listen on {}: {}'.format(
                ' '.join(listen) or 'any port', str(error)[:300])) from None
        # zenoh forgets what nobody holds.
        self._kept = []

    def sender(self, way, topic, urgency):
        """Return a function that sends bytes as a stream's next message."""
        priorities = {COMMAND: self._zenoh.Priority.REAL_TIME,
                      PICTURE: self._zenoh.Priority.DATA_LOW,
                      RECORD: self._zenoh.Priority.BACKGROUND}
        publisher = self._session.declare_publisher(
            key_of(self._robot, way, topic), express=urgency == COMMAND,
            congestion_control=self._zenoh.CongestionControl.DROP,
            priority=priorities.get(urgency, self._zenoh.Priority.DATA),
            reliability=self._zenoh.Reliability.BEST_EFFORT)
        return publisher.put

    def listen(self, way, on_bytes):
        """Call a function with (topic, bytes) of all that comes on a way, on zenoh's thread."""
        root = key_of(self._robot, way, '')

        def hear(sample):
            """Pass a message on."""
            on_bytes(str(sample.key_expr)[len(root):], sample.payload.to_bytes())
        self._kept.append(self._session.declare_subscriber(root + '**', hear))

    def close(self):
        """Hang up."""
        self._session.close()
