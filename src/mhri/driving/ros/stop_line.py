# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""STOP ALL, and its release: a line to the mux, kept open.

Calls ``/mux/set_stop_all`` (``std_srvs/SetBool``) by TCPROS itself
(http://wiki.ros.org/ROS/TCPROS), with a time limit on each step, and without the time and memory
that loading rospy and the messages takes: also for a small process that is not a node. Connected
ahead, it needs no master when it matters.
"""
import io
import select
import socket
import struct
from urllib.parse import urlsplit

from rosgraph.network import (
    read_ros_handshake_header, ROSHandshakeException, write_ros_handshake_header)

from mhri.graph.ros.master_api import MasterApi, MasterError

STOP_SERVICE = '/mux/set_stop_all'
# How often to look whether a line has to be connected anew [s].
LOOK_S = 0.5
# A mux that cannot reach the master answers late.
_TIMEOUT_S = 2.0
# SetBool's request behind its length, and what comes before its answer: whether the call succeeded,
# and the length of the rest: "success", and the message behind its own length.
_REQUEST = struct.Struct('<IB')
_ANSWER = struct.Struct('<BI')
_NO_ANSWER = 'the drive service does not answer'
_FAILURES = (OSError, MasterError, ROSHandshakeException, LookupError, ValueError, TypeError,
             struct.error)


class StopLine:
    """The line; every call ends within a few seconds.

    :param caller: the caller id; a node's name, or none's
    :param master_uri: the master, which knows the mux's address; default ``ROS_MASTER_URI``
    """

    def __init__(self, caller, master_uri=None):
        self._caller = caller
        self._master = MasterApi(caller, _TIMEOUT_S, master_uri)
        self._socket = None

    def fileno(self):
        """Return the descriptor to wait for, None if the line is down."""
        return None if self._socket is None else self._socket.fileno()

    def connect(self):
        """Connect the line if it is down; return whether it is up."""
        if self._has_ended():
            self.close()
        if self._socket is None:
            try:
                self._open(urlsplit(self._master.call('lookupService', STOP_SERVICE)))
            except _FAILURES:
                self.close()
        return self._socket is not None

    def _has_ended(self):
        """Tell whether there is news on the line: between calls that can only be its end."""
        if self._socket is None:
            return False
        poll = select.poll()
        poll.register(self._socket, select.POLLIN)
        return bool(poll.poll(0))

    def _open(self, place):
        """Connect and shake hands."""
        self._socket = socket.create_connection((place.hostname, place.port), _TIMEOUT_S)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        write_ros_handshake_header(self._socket, {
            'service': STOP_SERVICE, 'callerid': self._caller, 'md5sum': '*', 'persistent': '1'})
        found = read_ros_handshake_header(self._socket, io.BytesIO(), 4096)
        if 'error' in found:
            raise ValueError(found['error'])

    def call(self, value):
        """Stop all robots, or release them; return (whether the mux did so, words).

        :returns: the words are the mux's own, or say that it does not answer
        """
        # The line may have died unnoticed: try again over a new one.
        for _ in range(2):
            answer = self.connect() and self._ask(value)
            if answer:
                return answer
        return False, _NO_ANSWER

    def _ask(self, value):
        """Call the service over the line as it is; return its answer, None if there is none."""
        try:
            self._socket.sendall(_REQUEST.pack(1, value))
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
        """Hang up."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
