# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot whose link has gone, as TCP sees it: connected, and never reading again."""
import socket
import xmlrpc.client

from geometry_msgs.msg import Twist
import rosgraph
from rosgraph.network import encode_ros_handshake_header


class StuckRobot:
    """A robot whose link has gone: it has connected, and never reads again."""

    def __init__(self, topic):
        master = rosgraph.Master('/stuck_robot')
        publishers = dict(master.getSystemState()[0])
        node = xmlrpc.client.ServerProxy(master.lookupNode(publishers[topic][0]))
        _, _, (_, host, port) = node.requestTopic('/stuck_robot', topic, [['TCPROS']])
        self._socket = socket.socket()
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        self._socket.connect((host, port))
        header = {'topic': topic, 'type': Twist._type, 'md5sum': Twist._md5sum,
                  'callerid': '/stuck_robot', 'message_definition': Twist._full_text}
        self._socket.sendall(encode_ros_handshake_header(header))

    def close(self):
        self._socket.close()
