# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A peer has so long to say who it is, keeps nobody else waiting, and may say so much at a time."""
import importlib
import queue
import socket
import struct
import threading
import time

import pytest
import rosgraph.network
from rospy.exceptions import TransportTerminated
from rospy.impl import tcpros_base, tcpros_pubsub
from std_msgs.msg import String

from mhri.graph.ros import peers
from mhri.graph.ros.peers import HandshakeTimeout, MAX_BYTES

from support.ros_system import wait_for

HEADER = rosgraph.network.encode_ros_handshake_header({'topic': '/x', 'callerid': '/y'})
START_S = 20.0


def hung_up(outer):
    """Wait until the other end hangs up; tell whether it said nothing before."""
    try:
        return outer.recv(1) == b''
    except ConnectionResetError:
        return True  # for the bytes that nobody read


class Door:
    """Accepts connections, and keeps those whose header came."""

    def __init__(self, limit_s=START_S, most=4):
        self.entered = queue.Queue()
        self.handshakes = HandshakeTimeout(lambda connection, name: self.entered.put(
            (name, connection.recv(MAX_BYTES))), limit_s, most)

    def connect(self, name, data=b''):
        """Connect, and send something; return the outer end."""
        outer, inner = socket.socketpair()
        outer.settimeout(START_S)
        outer.sendall(data)
        self.handshakes.receive(inner, name)
        return outer


def test_a_whole_header_enters_with_all_its_bytes_unread():
    door = Door()
    door.connect('one', HEADER + b'more')
    assert door.entered.get(timeout=START_S) == ('one', HEADER + b'more')
    assert door.handshakes.waiting() == 0


def test_a_header_in_pieces_enters_when_it_is_whole():
    door = Door()
    outer = door.connect('one', HEADER[:3])
    for byte in HEADER[3:-1]:
        outer.sendall(bytes([byte]))
    assert door.handshakes.waiting() == 1 and door.entered.empty()
    outer.sendall(HEADER[-1:])
    assert door.entered.get(timeout=START_S) == ('one', HEADER)


def test_those_that_say_nothing_keep_nobody_waiting():
    door = Door()
    silent = [door.connect('silent') for _ in range(3)]
    door.connect('one', HEADER)
    assert door.entered.get(timeout=START_S)[0] == 'one'
    assert door.handshakes.waiting() == len(silent)


@pytest.mark.parametrize('data', [b'', HEADER[:2], HEADER[:-1]], ids=['nothing', 'two', 'part'])
def test_the_limit(data):
    """However much has come by then, and though more keeps coming."""
    door = Door(limit_s=0.3)
    begun = time.monotonic()
    outer = door.connect('late', data)
    assert hung_up(outer) and 0.3 <= time.monotonic() - begun < START_S
    assert door.entered.empty() and door.handshakes.waiting() == 0


@pytest.mark.parametrize('data', [
    b'GET / HTTP/1.0\r\n\r\n', struct.pack('<I', MAX_BYTES), struct.pack('<I', 0xffffffff)])
def test_what_is_no_header_is_not_waited_for(data):
    door = Door()
    outer = door.connect('browser', data)
    assert hung_up(outer)
    assert door.entered.empty()


@pytest.mark.parametrize('data', [b'', HEADER[:-1]], ids=['nothing', 'part'])
@pytest.mark.parametrize('end', [socket.socket.close, lambda outer: outer.shutdown(
    socket.SHUT_WR)], ids=['closed', 'half closed'])
def test_one_that_ends_within_its_header(data, end):
    door = Door()
    end(door.connect('gone', data))
    wait_for(lambda: door.handshakes.waiting() == 0, START_S, 'the end')
    assert door.entered.empty()


def test_of_too_many_the_one_that_waited_longest_goes():
    door = Door(most=4)
    outers = [door.connect(number) for number in range(6)]
    assert [outer.recv(1) for outer in outers[:2]] == [b'', b'']
    assert door.handshakes.waiting() == 4
    for outer in outers[2:]:
        outer.sendall(HEADER)
    assert {door.entered.get(timeout=START_S)[0] for _ in range(4)} == {2, 3, 4, 5}


@pytest.fixture
def limits():
    """The limits in force, and rospy as it was afterwards."""
    before = [(owner, name, getattr(owner, name)) for owner, name in (
        (tcpros_base.TCPROSServer, '_tcp_server_callback'),
        (tcpros_base.TCPROSTransport, 'read_header'),
        (tcpros_base.TCPROSTransportProtocol, 'read_messages'),
        (tcpros_pubsub, 'robust_connect_subscriber'))]
    peers.limit_peers()
    yield
    for owner, name, value in before:
        setattr(owner, name, value)


@pytest.mark.parametrize('buffer, most', [
    (1 << 16, peers.LARGEST_OTHER_BYTES), (peers.LARGE_BUFFER, peers.LARGEST_BYTES)])
def test_who_announces_more_than_its_topic_may_need_is_cut_off(limits, buffer, most):
    """Before it has sent it; what is as large as it may be is waited for."""
    sender, receiver = socket.socketpair()
    transport = tcpros_base.TCPROSTransport(
        tcpros_pubsub.TCPROSSub('/said', String, buff_size=buffer), '/said')
    transport.set_socket(receiver, 'here')
    text = b'a' * (most - 4)
    threading.Thread(target=sender.sendall, daemon=True, args=(
        struct.pack('<II', most, len(text)) + text + struct.pack('<I', most + 1),)).start()
    assert transport.receive_once()[0].data == text.decode()
    with pytest.raises(TransportTerminated, match=str(most + 1)):
        transport.receive_once()


class Other:
    """A server of another rospy."""

    def run(self):
        """Accept on threads."""

    def _tcp_server_callback(self, sock):
        """Take one argument."""


@pytest.mark.parametrize('name', ['TCPServer', 'TCPROSServer'])
def test_another_rospy_is_noticed_at_import(monkeypatch, name):
    monkeypatch.setattr(tcpros_base, name, Other)
    with pytest.raises(ImportError, match='cannot work with this rospy'):
        importlib.reload(peers)
    monkeypatch.undo()
    importlib.reload(peers)
