# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads one TCPROS connection to a publisher as bytes (http://wiki.ros.org/ROS/TCPROS)."""
import io
import select
import socket
import struct
import xmlrpc.client

from rosgraph.network import (
    read_ros_handshake_header, ROSHandshakeException, write_ros_handshake_header)

from mhri.graph.ros.master_api import ERRORS, TimedTransport
from mhri.graph.ros.messages import installed_class, MessageMissing
from mhri.recording.frames import FrameSplitter

_SMALL, _LARGE = 64 * 1024, 1024 * 1024
# A robot that loses power does not close its connections: probe after 5 s of silence, give up after
# 5 more.
_KEEPALIVE = ((socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1),
              (socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 5),
              (socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 1),
              (socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 5),
              (socket.IPPROTO_TCP, socket.TCP_NODELAY, 1))


class LinkError(Exception):
    """A connection to a publisher failed or broke; the text names the publisher and the reason."""


class RawLink:
    """A connection to one publisher of one topic.

    :param topic: its absolute name
    :param uri: the XML-RPC address of the publisher's node
    :param caller_id: the name under which to connect
    :param timeout_s: time-out of each step [s]
    ``fields`` is the publisher's header; ``publisher`` is free for the recorder's use.

    :raises LinkError: it does not answer, does not publish this topic, or uses another protocol
    """

    def __init__(self, topic, uri, caller_id, timeout_s=3.0):
        self.key = (topic, uri)
        self.publisher = None
        self._splitter = FrameSplitter()
        self._socket = None
        self._early = b''
        try:
            self.fields = self._connect(topic, uri, caller_id, timeout_s)
        except (ERRORS + (ROSHandshakeException, LookupError, ValueError, TypeError,
                          struct.error)) as error:
            self.close()
            raise LinkError('{} at {}: {}'.format(topic, uri, error))
        self._recv = self._socket.recv

    def _connect(self, topic, uri, caller_id, timeout_s):
        """Request the topic, connect, and return the publisher's header."""
        with xmlrpc.client.ServerProxy(uri, transport=TimedTransport(timeout_s)) as proxy:
            code, message, protocol = proxy.requestTopic(caller_id, topic, [['TCPROS']])
        if code != 1 or not protocol:
            raise ValueError('not available: {}'.format(message))
        self._socket = socket.create_connection((protocol[1], protocol[2]), timeout_s)
        for option in _KEEPALIVE:
            self._socket.setsockopt(*option)
        write_ros_handshake_header(self._socket, {
            'topic': topic, 'callerid': caller_id, 'md5sum': '*', 'type': '*',
            'message_definition': '', 'tcp_nodelay': '1'})
        rest = io.BytesIO()
        found = read_ros_handshake_header(self._socket, rest, 4096)
        if 'error' in found:
            raise ValueError(found['error'])
        self._early = rest.getvalue()
        self._socket.setblocking(False)
        fields = {'topic': topic, 'type': found['type'], 'md5sum': found['md5sum'],
                  'message_definition': _definition(found),
                  'callerid': found.get('callerid', '')}
        if found.get('latching') == '1':
            fields['latching'] = '1'
        return fields

    def fileno(self):
        """Return the descriptor to wait for."""
        return self._socket.fileno()

    def read(self):
        """Return the complete frames received, () for none.

        :raises LinkError: the publisher is gone
        """
        if self._early:
            data, self._early = self._early, b''
            return self._splitter.split(data)
        wanted = self._splitter.wanted
        try:
            data = self._recv(_SMALL if wanted <= _SMALL else min(wanted, _LARGE))
            if data:
                return self._splitter.split(data)
        except BlockingIOError:
            return ()
        except (OSError, ValueError) as error:
            raise LinkError('{} at {}: {}'.format(*self.key, error))
        raise LinkError('{} at {}: closed'.format(*self.key))

    def wait(self, timeout_s):
        """Return the next complete frames, () if none is received within a time [s].

        :raises LinkError: the publisher is gone
        """
        frames = self.read()
        if not frames and select.select([self], [], [], max(0.0, timeout_s))[0]:
            frames = self.read()
        return frames

    def read_all(self):
        """Yield all frames received so far."""
        while True:
            try:
                # Part of a message yields no frame, but more bytes may be available.
                before = self._splitter.wanted
                frames = self.read()
            except LinkError:
                return
            yield from frames
            if not frames and self._splitter.wanted == before:
                return

    def close(self):
        """Close the connection."""
        if self._socket is not None:
            self._socket.close()

    def cut(self):
        """Reset the connection, so that the publisher detects it before the next message.

        rospy would detect a normal close only after sending that whole message.
        """
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))
        self.close()


def _definition(found):
    """Return the definition of a type: as installed here, else from its publisher, or ''.

    The installed one is preferred, since programs that read the bag later compile the definition.
    """
    try:
        return installed_class(found['type'], found['md5sum'])._full_text
    except MessageMissing:
        return found.get('message_definition', '')
