# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages that leave on the caller's thread: in order, whole, and never waited for."""
import select
import socket
import struct
import threading
import time

import pytest

pytest.importorskip('rospy')

from geometry_msgs.msg import Twist  # noqa: E402
from mhri.graph.ros.non_blocking import (  # noqa: E402
    Flow, NO_LINE, NonBlockingConnection, NonBlockingPublisher)
import rospy  # noqa: E402
from rospy.exceptions import TransportInitError, TransportTerminated  # noqa: E402
from support.ros_system import wait_for  # noqa: E402


class Transport:
    """What of rospy's ``TCPROSTransport`` a connection uses."""

    def __init__(self, end):
        self.socket = end
        self.done = False
        self.stat_bytes = self.stat_num_msg = 0
        self.endpoint_id = 'robot'
        self.cleanup_cb = lambda connection: None

    def set_cleanup_callback(self, callback):
        self.cleanup_cb = callback

    def fileno(self):
        return self.socket.fileno()

    def write_data(self, data):
        raise AssertionError('rospy would wait for the robot')

    def close(self):
        self.done = True
        self.cleanup_cb(self)


@pytest.fixture
def link():
    """Return (connection, transport, the subscriber's end)."""
    ours, theirs = socket.socketpair()
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    transport = Transport(ours)
    connection = NonBlockingConnection(transport, 1, lambda end: NO_LINE)
    yield connection, transport, theirs
    transport.close()
    theirs.close()
    ours.close()


def message(number, size=100):
    return number.to_bytes(4, 'big') * (size // 4)


def take(end, size):
    end.settimeout(20.0)
    found = b''
    while len(found) < size:
        found += end.recv(size - len(found))
    return found


def wait_until_idle(connection):
    """Wait until nothing is left to send."""
    wait_for(lambda: not connection.waits, what='nothing to be left')


def fill(connection, size=100):
    """Publish until the socket is full; return how many messages were published."""
    for number in range(100000):
        connection.write_data(message(number, size))
        if connection.waits:
            return number + 1
    raise AssertionError('the buffer never gets full')


def test_a_message_leaves_on_the_thread_of_the_caller(link):
    connection, transport, theirs = link
    for number in range(50):
        connection.write_data(message(number))
        assert take(theirs, 100) == message(number)
    assert transport.stat_num_msg == 50 and transport.stat_bytes == 5000


def test_a_stalled_robot_is_never_waited_for_and_gets_the_newest(link):
    connection, _, theirs = link
    count = fill(connection)
    begun = time.monotonic()
    for number in range(count, count + 2000):
        connection.write_data(message(number))
    assert time.monotonic() - begun < 10.0
    got = []
    while not got or got[-1] != count + 1999:
        data = take(theirs, 100)
        got.append(int.from_bytes(data[:4], 'big'))
        assert data == message(got[-1]), 'torn'
    assert got == sorted(got)
    # What the buffer held and a part of, and the newest.
    assert len(got) <= count + 2
    wait_until_idle(connection)
    connection.write_data(message(7))
    assert take(theirs, 100) == message(7), 'back on the short way'


def test_a_message_taken_in_part_is_finished_before_any_other(link):
    connection, transport, theirs = link
    big = bytes(range(256)) * 4000
    connection.write_data(big)
    connection.write_data(message(1))
    connection.write_data(message(2))
    assert take(theirs, len(big)) == big and take(theirs, 100) == message(2)


def test_one_thread_serves_all_that_is_late_and_waits_for_none():
    before, links = threading.active_count(), []
    for _ in range(50):
        ours, theirs = socket.socketpair()
        links.append((NonBlockingConnection(Transport(ours), 1, lambda end: NO_LINE), ours, theirs))
        fill(links[-1][0])
    assert threading.active_count() <= before + 1
    for connection, ours, theirs in reversed(links):
        connection.write_data(message(0), urgent=True)
        theirs.settimeout(20.0)
        while not theirs.recv(65536).endswith(message(0)):
            pass
        for end in (connection, ours, theirs):
            end.close()


def test_what_is_late_is_sent_though_waiting_has_failed(link, monkeypatch):
    """As without memory: the thread for all that is late goes on, and the zero comes."""
    connection, _, theirs = link
    failed = []

    def poll():
        monkeypatch.undo()
        failed.append(True)
        raise MemoryError('planted')
    monkeypatch.setattr(select, 'poll', poll)
    fill(connection)
    wait_for(lambda: failed, what='the failure')
    connection.write_data(message(0), urgent=True)
    theirs.settimeout(20.0)
    while not theirs.recv(65536).endswith(message(0)):
        pass


def test_the_end_of_a_connection_is_told_to_who_publishes_next(link):
    connection, _, theirs = link
    theirs.close()
    with pytest.raises(TransportTerminated):
        for number in range(1000):
            connection.write_data(message(number))
            time.sleep(0.001)


def test_a_subscriber_that_has_hung_up_is_noticed_before_the_next_message(link):
    connection, transport, theirs = link
    connection.write_data(message(1))
    assert not connection.ended
    take(theirs, 100)
    theirs.close()
    assert connection.ended
    ours, transport.socket = transport.socket, None
    assert connection.ended, 'rospy has closed it meanwhile'
    transport.socket = ours


def test_publishing_from_many_threads_tears_nothing(link):
    connection, _, theirs = link
    got = bytearray()
    ended = threading.Event()

    def receive():
        theirs.settimeout(0.2)
        while True:
            try:
                got.extend(theirs.recv(333))
            except socket.timeout:
                if ended.is_set():
                    return

    receiver = threading.Thread(target=receive)
    receiver.start()
    senders = [threading.Thread(target=lambda number=number: [
        connection.write_data(message(number)) for _ in range(2000)]) for number in range(1, 5)]
    for sender in senders:
        sender.start()
    for sender in senders:
        sender.join()
    wait_until_idle(connection)
    ended.set()
    receiver.join()
    assert len(got) % 100 == 0 and len(got) >= 100
    for at in range(0, len(got), 100):
        assert bytes(got[at:at + 100]) == message(int.from_bytes(got[at:at + 4], 'big'))


class Peer:
    """A TCP socket as :class:`Flow` looks at it."""

    family = socket.AF_INET

    def __init__(self):
        self.unacked, self.ack_ms, self.rtt_ms = 0, 0, 2

    def getsockopt(self, level, option, size):
        assert (level, option) == (socket.IPPROTO_TCP, socket.TCP_INFO)
        info = bytearray(size)
        struct.pack_into('=I', info, 24, self.unacked)
        struct.pack_into('=I', info, 56, self.ack_ms)
        struct.pack_into('=I', info, 68, self.rtt_ms * 1000)
        return bytes(info)


@pytest.mark.parametrize('what, steps, rtt_ms, stalled', [
    # steps: (after [s], packets not confirmed, last confirmation ago [ms])
    ('nothing under way', [(0.0, 0, 5), (9.0, 0, 9000)], 2, False),
    ('the first after a long rest', [(0.0, 0, 60000), (0.05, 1, 60050)], 2, False),
    ('always something under way', [(0.0, 0, 1)] + [(0.05, 3, 20)] * 40, 2, False),
    ('nothing comes back', [(0.0, 0, 1), (0.05, 1, 51), (0.06, 2, 111)], 2, True),
    ('a long way', [(0.0, 0, 1), (0.4, 8, 500), (0.4, 16, 900)], 500, False),
    ('a long way, nothing comes back', [(0.0, 0, 1), (1.1, 8, 1100)], 500, True),
    ('back again', [(0.0, 0, 1), (0.5, 9, 500), (0.1, 4, 3)], 2, False)])
def test_a_link_that_confirms_nothing_has_stalled(what, steps, rtt_ms, stalled):
    now, peer = [100.0], Peer()
    flow, peer.rtt_ms = Flow(peer, lambda: now[0]), rtt_ms
    for after_s, peer.unacked, peer.ack_ms in steps:
        now[0] += after_s
        found = flow.stalled()
    assert found == stalled


def test_the_system_is_not_asked_while_the_link_cannot_have_stalled():
    now, asked, peer = [100.0], [], Peer()
    flow, plain, peer.ack_ms = Flow(peer, lambda: now[0]), peer.getsockopt, 40
    peer.unacked, peer.getsockopt = 1, lambda *words: asked.append(now[0]) or plain(*words)
    for _ in range(100):
        now[0] += 0.013
        assert not flow.stalled()
    assert 1.3 / 0.11 < len(asked) < 1.3 / 0.05


def test_the_flow_of_a_real_connection_is_read():
    with socket.socket() as server:
        server.bind(('127.0.0.1', 0))
        server.listen(1)
        with socket.create_connection(server.getsockname()) as ours, server.accept()[0] as theirs:
            flow = Flow(ours)
            for _ in range(50):
                ours.sendall(b'x' * 50)
                assert take(theirs, 50) == b'x' * 50 and not flow.stalled()
            info = ours.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, 104)
            rtt_us = struct.unpack_from('=I', info, 68)[0]
            assert 0 < rtt_us < 1e6, 'not where the round trip is in struct tcp_info'


def test_a_connection_that_came_while_the_publisher_was_made_is_taken_over(monkeypatch):
    """A robot that waits connects as soon as the topic is registered, before we have replaced."""
    ours, theirs = socket.socketpair()
    early = Transport(ours)

    def register(self, name, message_class, **_):
        """Do as rospy does, with a robot that is quick."""
        self.impl = rospy.topics._PublisherImpl(name, message_class)
        self.impl.connections = [early]

    monkeypatch.setattr(rospy.Publisher, '__init__', register)
    publisher = NonBlockingPublisher('/bot1/cmd_vel', Twist)
    found, = publisher.links()
    stalled_s = publisher.stalled_s({'robot'}) if isinstance(found, NonBlockingConnection) else None
    early.close()
    for end in (ours, theirs):
        end.close()
    assert stalled_s == 0.0, 'it is still one of rospy'


def test_a_connection_that_rospy_is_adding_meanwhile_is_taken_over(monkeypatch):
    """Left in rospy's own wrapper, it was closed at the first word: a robot's zero."""
    ours, theirs = socket.socketpair()
    late = Transport(ours)
    late.fileno, late.cleanup_cb = ours.fileno, None
    wraps, go_on, adding, wrapper = threading.Event(), threading.Event(), [], []
    plain = rospy.topics.QueuedConnection

    def wrap(*args):
        """Take a while, as on a busy computer."""
        wraps.set()
        go_on.wait(20.0)
        wrapper.append(plain(*args))
        return wrapper[0]

    def register(self, name, message_class, **_):
        """Do as rospy does, with a robot that is quick."""
        self.impl = rospy.topics._PublisherImpl(name, message_class)
        self.impl.set_queue_size(1)
        adding.append(threading.Thread(target=self.impl.add_connection, args=(late,)))
        adding[0].start()
        assert wraps.wait(20.0)

    monkeypatch.setattr(rospy.topics, 'QueuedConnection', wrap)
    monkeypatch.setattr(rospy.Publisher, '__init__', register)
    publisher = NonBlockingPublisher('/bot1/cmd_vel', Twist)
    go_on.set()
    adding[0].join(20.0)
    publisher.publish(Twist(), urgent=True)
    found = len(publisher.links())
    wrapper[0]._thread.join(20.0)
    assert not wrapper[0]._thread.is_alive(), 'nothing would end it: the program could not end'
    late.close()
    for end in (ours, theirs):
        end.close()
    assert found == 1, 'the robot was hung up on'


def test_a_connection_that_comes_while_the_publisher_is_closed_is_ended(driven):
    """Else the robot would wait for ever for commands from a publisher that has gone."""
    _, line, _ = driven
    ours, theirs = socket.socketpair()
    publisher = NonBlockingPublisher('/bot3/cmd_vel', Twist, watch=lambda end: line)
    impl = publisher.impl
    publisher.unregister()
    late = Transport(ours)
    with pytest.raises(TransportInitError):
        impl.add_connection(late)
    assert late.done and line.noted[-1:] == ['forgotten']
    for end in (ours, theirs):
        end.close()


def test_nothing_but_the_word_to_stop_is_given_to_a_stalled_link(link):
    connection, transport, theirs = link
    stalled = [True]
    connection._flow.stalled = lambda: stalled[0]
    for number in range(30):
        connection.write_data(message(number))
    theirs.settimeout(0.1)
    with pytest.raises(socket.timeout):
        theirs.recv(1)
    stalled[0] = False
    assert take(theirs, 100) == message(29), 'the newest, and nothing before it'
    wait_until_idle(connection)
    stalled[0] = True
    connection.write_data(message(30))
    connection.write_data(message(0), urgent=True)
    assert take(theirs, 100) == message(0)
    connection.write_data(message(31))
    with pytest.raises(socket.timeout):
        theirs.settimeout(0.1)
        theirs.recv(1)
    stalled[0] = False
    assert take(theirs, 100) == message(31)


class SlowLine:
    """A line of a robot that reads slowly, or that the parent does not hold yet."""

    def __init__(self):
        self.room, self.watched, self.noted = True, True, []

    def has_room(self, urgent):
        return self.room

    def about_to_send(self, frame):
        self.noted.append(frame)

    def sent(self, count):
        self.noted.append(count)

    def moves(self):
        self.noted.append('moves')

    def forget(self):
        self.noted.append('forgotten')


@pytest.fixture
def driven():
    """Return (connection, its line, the subscriber's end)."""
    ours, theirs = socket.socketpair()
    transport, line = Transport(ours), SlowLine()
    connection = NonBlockingConnection(transport, 1, lambda end: line)
    yield connection, line, theirs
    transport.close()
    theirs.close()
    ours.close()
    assert line.noted[-1] == 'forgotten'


def test_no_motion_leaves_before_the_undertaker_holds_the_connection(driven):
    connection, line, theirs = driven
    line.watched = False
    connection.write_data(message(1))
    connection.write_data(message(0), urgent=True)
    assert take(theirs, 100) == message(0)
    connection.write_data(message(2))
    with pytest.raises(socket.timeout):
        theirs.settimeout(0.05)
        theirs.recv(1)
    line.watched = True
    assert take(theirs, 100) == message(2)
    wait_until_idle(connection)
    assert line.noted == ['moves', message(0), 100, 'moves', message(2), 100]


def test_a_robot_that_reads_slowly_gets_every_zero_that_ended_a_motion_and_then_the_newest(driven):
    connection, line, theirs = driven
    line.room = False
    for number in (1, 2, 0, 3, 4):
        connection.write_data(message(number), urgent=not number)
    time.sleep(0.05)
    line.room = True
    assert take(theirs, 200) == message(0) + message(4)
    wait_until_idle(connection)
    # Noted before it is sent.
    assert line.noted[-4:] == [message(0), 100, message(4), 100]


@pytest.mark.parametrize('ours_first', [True, False])
def test_another_publisher_of_the_topic_in_this_process_changes_nothing(ours_first):
    """As of another plugin of rqt: for rospy both are one, with the queue of the later."""
    topic, made = '/bot{}/cmd_vel'.format(int(ours_first)), {}
    for ours in (ours_first, not ours_first):
        made[ours] = NonBlockingPublisher(topic, Twist) if ours else rospy.Publisher(
            topic, Twist, queue_size=10)
    ours, theirs = socket.socketpair()
    transport = Transport(ours)
    made[True].impl.add_connection(transport)
    link, = made[True].links()
    try:
        made[True].publish(Twist())
        assert isinstance(link, NonBlockingConnection) and take(theirs, 52)
    finally:
        for end in (transport, ours, theirs):
            end.close()
