# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shorter way in gives what rospy's would: whole messages, in order, and errors as before."""
import io
import socket
import struct
import types

import pytest

pytest.importorskip('rospy')

import genpy  # noqa: E402
from geometry_msgs.msg import Twist  # noqa: E402
from mhri.ros.convert import packed_twist, PlanarTwist, ShortJoy, to_twist  # noqa: E402
from mhri.ros.graph.prompt import hear_promptly  # noqa: E402
from rospy.exceptions import TransportException, TransportTerminated  # noqa: E402
from rospy.impl.tcpros_base import TCPROSTransport  # noqa: E402
from rospy.impl.tcpros_pubsub import TCPROSSub  # noqa: E402
from sensor_msgs.msg import Joy  # noqa: E402


@pytest.fixture(name='link')
def _link():
    """Return (a connection of a subscriber that hears promptly, the publisher's end)."""
    ours, theirs = socket.socketpair()
    connection = TCPROSTransport(TCPROSSub('/twist', PlanarTwist, queue_size=1), '/twist')
    connection.set_socket(ours, 'mux')
    connection.header = {'callerid': '/mux'}
    impl = types.SimpleNamespace(connections=[], add_connection=lambda added: True)
    hear_promptly(types.SimpleNamespace(impl=impl))
    assert impl.add_connection(connection)
    yield connection, theirs
    connection.close()
    theirs.close()


def speeds(connection):
    return [message.velocity.linear_mps for message in connection.receive_once()]


def test_a_whole_message_is_read_and_counted(link):
    connection, publisher = link
    for number in range(3):
        publisher.sendall(packed_twist(number, 0.5))
        message, = connection.receive_once()
        assert message.velocity.linear_mps == number and message.velocity.angular_rad_s == 0.5
        assert message._connection_header is connection.header
    assert connection.stat_num_msg == 3 and connection.stat_bytes == 3 * 52


def test_of_several_at_once_the_newest_counts(link):
    connection, publisher = link
    publisher.sendall(packed_twist(1.0, 0.0) + packed_twist(2.0, 0.0) + packed_twist(3.0, 0.0))
    assert speeds(connection) == [3.0]
    publisher.sendall(packed_twist(4.0, 0.0))
    assert speeds(connection) == [4.0]


@pytest.mark.parametrize('cut', [1, 3, 4, 5, 51])
def test_a_message_in_two_parts_is_joined(link, cut):
    connection, publisher = link
    publisher.sendall(packed_twist(1.0, 0.0) + packed_twist(2.0, 0.0)[:cut])
    assert speeds(connection) == [1.0]
    publisher.sendall(packed_twist(2.0, 0.0)[cut:])
    assert speeds(connection) == [2.0]
    publisher.sendall(packed_twist(3.0, 0.0))
    assert speeds(connection) == [3.0]


def test_who_hangs_up_or_sends_garbage_ends_the_connection(link):
    connection, publisher = link
    publisher.sendall(struct.pack('<I', 7) + b'garbage')
    with pytest.raises(TransportException):
        connection.receive_once()
    publisher.close()
    connection.read_buff.seek(0)
    connection.read_buff.truncate()
    with pytest.raises(TransportTerminated):
        connection.receive_once()


def packed(message):
    stream = io.BytesIO()
    message.serialize(stream)
    return stream.getvalue()


def test_a_packed_twist_is_what_genpy_makes_of_it():
    assert packed_twist(0.25, -1.5) == struct.pack('<I', 48) + packed(to_twist(0.25, -1.5))
    assert PlanarTwist._md5sum == Twist._md5sum and PlanarTwist._type == Twist._type


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
    with pytest.raises(genpy.DeserializationError):
        PlanarTwist().deserialize(data[:47])


def test_a_joy_that_claims_to_be_huge_is_refused():
    with pytest.raises(genpy.DeserializationError):
        ShortJoy().deserialize(struct.pack('<5I', 0, 0, 0, 0, 0xffffffff) + bytes(40))
