# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""STOP ALL for a small process that is not a node: a line to the mux, kept open.

Calls ``/mux/set_stop_all`` (``std_srvs/SetBool``, true) by TCPROS itself
(http://wiki.ros.org/ROS/TCPROS), with a time limit on each step, and without the time and memory
that loading rospy and the messages takes. Kept open, it needs no master when it matters.
"""
import io
import socket
import struct
from urllib.parse import urlsplit

from rosgraph.network import (
    read_ros_handshake_header, ROSHandshakeException, write_ros_handshake_header)

from mhri.ros.graph.master_api import MasterApi, MasterError

STOP_SERVICE = '/mux/set_stop_all'
# The caller id of the watch; not a node's name.
CALLER = '/mhri_stop_watch'
# A mux that cannot reach the master answers late.
_TIMEOUT_S = 2.0
# SetBool's request, true, and its answer: whether the call succeeded and, in the answer's own
# length, "success" before the message.
_REQUEST = struct.pack('<IB', 1, 1)
_ANSWER = struct.Struct('<BI')
_FAILURES = (OSError, MasterError, ROSHandshakeException, LookupError, ValueError, TypeError,
             struct.error)


class StopLine:
    """The line; every call ends within a few seconds.

    :param master_uri: the master, which knows the mux's address
    """

    def __init__(self, master_uri):
        self._master = MasterApi(CALLER, _TIMEOUT_S, master_uri)
        self._socket = None

    def fileno(self):
        """Return the descriptor to wait for, None if the line is down."""
        return None if self._socket is None else self._socket.fileno()

    def connect(self):
        """Connect the line if it is down; return whether it is up."""
        if self._socket is None:
            try:
                self._open(urlsplit(self._master.call('lookupService', STOP_SERVICE)))
            except _FAILURES:
                self.close()
        return self._socket is not None

    def _open(self, place):
        """Connect and shake hands."""
        self._socket = socket.create_connection((place.hostname, place.port), _TIMEOUT_S)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        write_ros_handshake_header(self._socket, {
            'service': STOP_SERVICE, 'callerid': CALLER, 'md5sum': '*', 'persistent': '1'})
        found = read_ros_handshake_header(self._socket, io.BytesIO(), 4096)
        if 'error' in found:
            raise ValueError(found['error'])

    def stop(self):
        """Stop all robots; return whether the mux has confirmed it."""
        # The line may have died unnoticed: try again over a new one.
        return any(self.connect() and self._ask() for _ in range(2))

    def _ask(self):
        """Call the service over the line as it is."""
        try:
            self._socket.sendall(_REQUEST)
            done, size = _ANSWER.unpack(self._read(_ANSWER.size))
            answer = self._read(size)
            return done == 1 and answer[:1] == b'\x01'
        except _FAILURES:
            self.close()
            return False

    def _read(self, size):
        """Read exactly this many bytes."""
        data = b''
        while len(data) < size:
            part = self._socket.recv(size - len(data))
            if not part:
                raise OSError('the mux has hung up')
            data += part
        return data

    def close(self):
        """Hang up."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
