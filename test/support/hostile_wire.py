# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How hostile things get onto the wire: torn messages, torn headers, absurd calls."""
import socket
import struct
import xmlrpc.client


def class_of(ros_type):
    import genpy
    import roslib.message
    return {'time': genpy.Time, 'duration': genpy.Duration}.get(ros_type) or \
        roslib.message.get_message_class(ros_type)


def torn_class(kind, hostile):
    class Torn(kind):
        """Says that it is of a type, and is not."""

        def serialize(self, buff):
            buff.write(hostile.torn())
    return Torn


class Fixed:
    """Tears all messages the same way."""

    def __init__(self, data):
        self._data = data

    def torn(self):
        return self._data


def torn_call(uri, header, body, wait_s=0.2):
    """Speak to a service's port as nobody should."""
    with socket.create_connection((uri.hostname, uri.port), 20.0) as link:
        link.settimeout(wait_s)
        try:
            link.sendall(header + body)
            link.recv(4096)
        except OSError:
            pass


def handshake(**fields):
    """Return the bytes of a TCPROS header."""
    lines = ['{}={}'.format(key, value).encode('utf-8', 'replace')
             for key, value in fields.items()]
    body = b''.join(struct.pack('<I', len(line)) + line for line in lines)
    return struct.pack('<I', len(body)) + body


def call(proxy, hostile):
    """Call the slave API with what is none of its words (nor ``shutdown``, which anybody may)."""
    method = hostile.random.choice(('requestTopic', 'publisherUpdate', 'paramUpdate', 'getBusStats',
                                    'getPid', 'no_such_method', 'getSubscriptions'))
    try:
        getattr(proxy, method)(*[hostile.value(2) for _ in range(hostile.random.randrange(5))])
    except (xmlrpc.client.Error, OSError, OverflowError, ValueError, TypeError):
        pass
