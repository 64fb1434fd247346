# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shorter way in gives what rospy's would: whole messages, in order, and errors as before."""
import io
import queue
import socket
import struct
import threading
import types

import pytest

pytest.importorskip('rospy')

import genpy  # noqa: E402
from geometry_msgs.msg import Twist  # noqa: E402
from mhri.graph.ros.non_blocking import read_inline  # noqa: E402
from mhri.robots.ros.convert import packed_twist, ShortJoy  # noqa: E402
from rospy.impl.tcpros_base import TCPROSTransport  # noqa: E402
from rospy.impl.tcpros_pubsub import TCPROSSub  # noqa: E402
from sensor_msgs.msg import Joy  # noqa: E402


class Link:
    """A connection of a subscriber that hears promptly, with the publisher's end of it."""

    def __init__(self):
        ours, self.publisher = socket.socketpair()
        self.connection = TCPROSTransport(TCPROSSub('/twist', Twist, queue_size=1), '/twist')
        self.connection.set_socket(ours, 'mux')
        self.connection.header = {'callerid': '/mux'}
        self.messages, self.ended = queue.Queue(), threading.Event()
        impl = types.SimpleNamespace(
            connections=[], add_connection=lambda added: True,
            receive_callback=lambda messages, _: [self.messages.put(one) for one in messages])
        read_inline(types.SimpleNamespace(impl=impl))
        assert impl.add_connection(self.connection)
        self._hear = impl.receive_callback
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()

    def _receive(self):
        """Do as rospy's thread does."""
        self.connection.receive_loop(self._hear)
        self.ended.set()

    def heard(self):
        """Return the next message."""
        return self.messages.get(timeout=20.0)

    def close(self):
        """End the thread."""
        self.publisher.close()
        assert self.ended.wait(20.0)


@pytest.fixture(name='link')
def _link():
    found = Link()
    yield found
    found.close()


def test_a_whole_message_is_read_and_counted(link):
    for number in range(3):
        link.publisher.sendall(packed_twist(number, 0.5))
        message = link.heard()
        assert message.linear.x == number and message.angular.z == 0.5
        assert message._connection_header is link.connection.header
    assert link.connection.stat_num_msg == 3 and link.connection.stat_bytes == 3 * 52


def test_of_several_at_once_the_newest_counts(link):
    link.publisher.sendall(packed_twist(1.0, 0.0) + packed_twist(2.0, 0.0) + packed_twist(3.0, 0.0))
    assert link.heard().linear.x == 3.0
    link.publisher.sendall(packed_twist(4.0, 0.0))
    assert link.heard().linear.x == 4.0
    assert link.messages.empty()


@pytest.mark.parametrize('cut', [1, 3, 4, 5, 51])
def test_a_message_in_two_parts_is_joined(link, cut):
    link.publisher.sendall(packed_twist(1.0, 0.0) + packed_twist(2.0, 0.0)[:cut])
    assert link.heard().linear.x == 1.0
    link.publisher.sendall(packed_twist(2.0, 0.0)[cut:])
    assert link.heard().linear.x == 2.0
    link.publisher.sendall(packed_twist(3.0, 0.0))
    assert link.heard().linear.x == 3.0


def test_garbage_drops_the_connection_as_in_rospy(link):
    link.publisher.sendall(struct.pack('<I', 7) + b'garbage')
    link.publisher.settimeout(20.0)
    assert link.publisher.recv(1) == b'', 'rospy hangs up and connects anew'
    assert link.messages.empty()
    link.connection.close()


def packed(message):
    stream = io.BytesIO()
    message.serialize(stream)
    return stream.getvalue()


@pytest.mark.parametrize('joy', [
    Joy(), Joy(axes=[0.5, -1.0]), Joy(axes=[0.25] * 20, buttons=[0, 1, -7]), Joy(buttons=[1])])
@pytest.mark.parametrize('frame', ['', 'profile:ps3', 'g\u00e9rard'])
def test_a_joy_is_read_as_genpy_reads_it(joy, frame):
    joy.header.frame_id = frame
    data = packed(joy)
    found, expected = ShortJoy().deserialize(data), Joy().deserialize(data)
    assert (found.frame_id, found.axes, found.buttons) == (
        expected.header.frame_id, tuple(expected.axes), tuple(expected.buttons))
    for size in range(len(data)):
        with pytest.raises(genpy.DeserializationError):
            ShortJoy().deserialize(data[:size])
