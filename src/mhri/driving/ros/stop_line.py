# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stop, of all robots or of single ones, over a persistent connection to the mux.

Calls ``/mux/set_stop_all`` (``std_srvs/SetBool``) or ``/mux/stop_robots`` (``mhri/StopRobots``)
directly over TCPROS (http://wiki.ros.org/ROS/TCPROS), with a timeout on each step, and without the
time and memory that rospy and the messages take to load: a small process that is not a node can use
it, too. Connected in advance, it needs no master for a stop.
"""
import io
import select
import socket
import struct
from urllib.parse import urlsplit

from rosgraph.network import (
    read_ros_handshake_header, ROSHandshakeException, write_ros_handshake_header)

from mhri.base.reasons import DRIVE_SILENT, Reason
from mhri.graph.ros.master_api import MasterApi, MasterError

STOP_SERVICE, ROBOTS_SERVICE = '/mux/set_stop_all', '/mux/stop_robots'
# How often to check whether the line has to be reconnected [s].
LOOK_S = 0.5
# A mux that cannot reach the master answers late.
_TIMEOUT_S = 2.0
# The length of a request, of a list, or of a text.
_LENGTH = struct.Struct('<I')
# The header of both services' response: whether the call succeeded, and the length of the rest,
# which is "success" and the message with its own length.
_ANSWER = struct.Struct('<BI')
_NO_ANSWER = Reason(DRIVE_SILENT).what
_FAILURES = (OSError, MasterError, ROSHandshakeException, LookupError, ValueError, TypeError,
             struct.error)


def _framed(data):
    """Return bytes behind their length."""
    return _LENGTH.pack(len(data)) + data


def _request(value):
    """Return the request of a service: SetBool for a bool, StopRobots for a list of names."""
    if isinstance(value, bool):
        return _framed(bytes([value]))
    names = b''.join(_framed(name.encode()) for name in value)
    return _framed(_LENGTH.pack(len(value)) + names)


class StopLine:
    """The connection to one service; every call ends within a few seconds.

    :param caller: the caller id; need not be the name of a node
    :param master_uri: the master, which provides the mux's address; default ``ROS_MASTER_URI``
    :param service: ``STOP_SERVICE`` or ``ROBOTS_SERVICE``
    """

    def __init__(self, caller, master_uri=None, service=STOP_SERVICE):
        self._caller = caller
        self._service = service
        self._master = MasterApi(caller, _TIMEOUT_S, master_uri)
        self._socket = None

    def fileno(self):
        """Return the file descriptor to wait for, None if the line is down."""
        return None if self._socket is None else self._socket.fileno()

    def connect(self):
        """Connect the line if it is down; return whether it is up."""
        if self._has_ended():
            self.close()
        if self._socket is None:
            try:
                self._open(urlsplit(self._master.call('lookupService', self._service)))
            except _FAILURES:
                self.close()
        return self._socket is not None

    def _has_ended(self):
        """Return whether the line is readable: between calls, that can only be its end."""
        if self._socket is None:
            return False
        poll = select.poll()
        poll.register(self._socket, select.POLLIN)
        return bool(poll.poll(0))

    def _open(self, place):
        """Connect, and do the TCPROS handshake."""
        self._socket = socket.create_connection((place.hostname, place.port), _TIMEOUT_S)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        write_ros_handshake_header(self._socket, {
            'service': self._service, 'callerid': self._caller, 'md5sum': '*', 'persistent': '1'})
        found = read_ros_handshake_header(self._socket, io.BytesIO(), 4096)
        if 'error' in found:
            raise ValueError(found['error'])

    def call(self, value):
        """Stop or release all robots, or stop single ones; return (success, text).

        :param value: True or False for ``STOP_SERVICE``, a list of robots for ``ROBOTS_SERVICE``
        :returns: the text is the mux's own; success None: the mux does not answer
        """
        # The line may have died unnoticed: try again over a new one.
        for _ in range(2):
            answer = self.connect() and self._ask(value)
            if answer:
                return answer
        return None, _NO_ANSWER

    def _ask(self, value):
        """Call the service over the open line; return its response, None if the call failed."""
        try:
            self._socket.sendall(_request(value))
            done, size = _ANSWER.unpack(self._read(_ANSWER.size))
            answer = self._read(size)
            if done != 1:
                raise ValueError(answer)
            return answer[:1] == b'\x01', answer[5:].decode(errors='replace')
        except _FAILURES:
            self.close()
            return None

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
        """Close the connection."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
