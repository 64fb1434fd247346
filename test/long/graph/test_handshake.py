# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connections that say nothing lock nobody out of a node: subscribers and services get through."""
import socket
import struct
import threading
import time
import unittest
from unittest import mock
from xmlrpc.server import SimpleXMLRPCServer

import rosgraph
from rosgraph.network import encode_ros_handshake_header
import rospy
from rospy.impl.tcpros_base import get_tcpros_server_address
from std_msgs.msg import String
from std_srvs.srv import SetBool, SetBoolResponse

from mhri.graph.ros import peers
from mhri.graph.ros.peers import limit_peers
from mhri.recording.ros.raw_link import RawLink
from support.own_node import own_node
from support.ros_system import wait_for

# Before the node starts.
limit_peers()
system = own_node('handshake')

CONNECT_S = 5.0
DRIBBLE_S = 0.2
SILENT = 8


class SilentAtFirst:
    """A publisher of one word that takes a first connection and never answers it."""

    def __init__(self, topic, word):
        self.calls = []
        self._head = encode_ros_handshake_header({
            'callerid': '/late', 'topic': topic, 'type': String._type, 'md5sum': String._md5sum})
        text = word.encode()
        self._word = struct.pack('<II', len(text) + 4, len(text)) + text
        self._door = socket.create_server(('127.0.0.1', 0))
        self._node = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        self._node.register_function(lambda *_: (1, '', [
            'TCPROS', '127.0.0.1', self._door.getsockname()[1]]), 'requestTopic')
        for work in (self._node.serve_forever, self._answer):
            threading.Thread(target=work, daemon=True).start()
        self._master = rosgraph.Master('/late')
        self._said = topic, 'http://127.0.0.1:{}/'.format(self._node.server_address[1])
        self._master.registerPublisher(topic, String._type, self._said[1])

    def _answer(self):
        while True:
            try:
                self.calls.append(self._door.accept()[0])
            except OSError:
                return
            if len(self.calls) > 1:
                self.calls[-1].sendall(self._head + self._word)

    def close(self):
        self._master.unregisterPublisher(*self._said)
        self._node.shutdown()
        self._node.server_close()
        for end in [self._door] + self.calls:
            end.close()


class HandshakeTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.publisher = rospy.Publisher('/said', String, queue_size=1, latch=True)
        cls.publisher.publish('yes')
        rospy.Service('/asked', SetBool, lambda request: SetBoolResponse(request.data, 'yes'))
        wait_for(lambda: get_tcpros_server_address()[1], CONNECT_S, 'the server')

    def connect(self, data=b''):
        """Connect to this node, and say this."""
        connection = socket.create_connection(get_tcpros_server_address(), CONNECT_S)
        self.addCleanup(connection.close)
        connection.sendall(data)
        return connection

    def assert_open(self):
        """Others get through, as subscribers and as callers of a service, at once."""
        begun = time.monotonic()
        link = RawLink('/said', rosgraph.Master('/test').lookupNode(rospy.get_name()),
                       '/listener', CONNECT_S)
        self.addCleanup(link.close)
        wait_for(link.read, CONNECT_S, 'what was said')
        took_s = time.monotonic() - begun
        self.assertTrue(rospy.ServiceProxy('/asked', SetBool)(True).success)
        print('MEASURED subscriber {:.1f} ms, service {:.1f} ms'.format(
            took_s * 1e3, (time.monotonic() - begun - took_s) * 1e3))
        self.assertLess(time.monotonic() - begun, CONNECT_S)

    def test_connections_that_say_nothing(self):
        for _ in range(SILENT):
            self.connect()
        self.assert_open()

    def test_a_connection_that_says_a_byte_at_a_time(self):
        slow, ended = self.connect(b'\xff\x00\x00\x00'), threading.Event()

        def dribble():
            """Say a little, for as long as it is heard."""
            try:
                while not ended.wait(DRIBBLE_S):
                    slow.sendall(b'x')
            except OSError:
                pass  # sent away, as it should be in the end
        thread = threading.Thread(target=dribble)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(ended.set)
        self.assert_open()

    def test_a_publisher_that_does_not_answer_is_called_again(self):
        heard = []
        with mock.patch.object(peers, 'LIMIT_S', 1.0):
            publisher = SilentAtFirst('/late_word', 'at last')
            self.addCleanup(publisher.close)
            listener = rospy.Subscriber('/late_word', String, heard.append)
            self.addCleanup(listener.unregister)
            wait_for(lambda: heard, 60.0, lambda: '{} calls'.format(len(publisher.calls)))
        self.assertEqual(heard[0].data, 'at last')
        wait_for(lambda: listener.get_num_connections() == 1, 60.0, 'one connection')

    def test_a_request_that_is_none_ends_its_connection(self):
        caller = self.connect(encode_ros_handshake_header({
            'callerid': '/torn', 'service': '/asked', 'md5sum': '*', 'persistent': '1'}))
        self.assertTrue(caller.recv(4096), 'the header of the answer')
        # Both arrive at once: a call, and one that is too short to be any.
        caller.sendall(struct.pack('<I?I', 1, True, 0))
        self.assertEqual(caller.recv(4096), b'', 'the end of the connection')
        self.assert_open()

    def test_more_than_are_waited_for(self):
        for _ in range(100):
            self.connect()
        self.assert_open()
