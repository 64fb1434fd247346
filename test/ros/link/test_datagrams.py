# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sealed datagrams between two ports on loopback; what would go over TLS is handed over here."""
import builtins
import random
import socket

import pytest

from mhri.link.ros import datagrams
from mhri.link.sealed import FORGED, GARBAGE, MAX_BYTES, REPLAYED, STRANGER
from support.ros_system import free_port, wait_for

pytest.importorskip('cryptography')
LONG_S = 60.0


class Tap:
    """Takes what the host says in place of its socket."""

    def __init__(self):
        self.packets = []

    def sendto(self, packet, _):
        """Keep a packet, if it is not only to show that datagrams pass."""
        if len(packet) > 100:
            self.packets.append(packet)


class Ends:
    """A robot that listens and a host that calls it."""

    def __init__(self, topics=lambda topic: True):
        self.port = free_port()
        self.robot = datagrams.open_port(['tls/127.0.0.1:{}'.format(self.port)], [])
        self.host = datagrams.open_port([], ['tls/localhost:{}'.format(self.port)])
        self.at_robot, self.at_host = [], []
        # Whether TLS carries what seals datagrams.
        self.tls = True
        ends = ('bot1', 'host:lab')
        self.down = self.host.way('bot1', ends, lambda data: self.tls and self.up.on_offer(data),
                                  lambda topic: True)
        self.up = self.robot.way('lab', ends, lambda data: self.tls and self.down.on_offer(data),
                                 topics)
        self.up.listen(lambda *row: self.at_robot.append(row))
        self.down.listen(lambda *row: self.at_host.append(row))

    def passes(self, way, topic, data):
        """Send until a datagram was used."""
        wait_for(lambda: way.send(topic, data), LONG_S, 'datagrams to pass', 0.02)

    def close(self):
        for port in (self.robot, self.host):
            port.close()


@pytest.fixture
def ends():
    made = Ends()
    yield made
    made.close()


def test_messages_go_both_ways(ends):
    ends.passes(ends.down, 'mhri_guard/command', b'turn')
    ends.passes(ends.up, 'camera/image', bytes(MAX_BYTES))
    wait_for(lambda: ends.at_robot and ends.at_host, LONG_S, 'them to come')
    assert ends.at_robot == [('mhri_guard/command', b'turn')]
    assert ends.at_host == [('camera/image', bytes(MAX_BYTES))]
    assert not ends.up.send('camera/image', bytes(MAX_BYTES + 1)), 'that is for TLS'


def test_who_may_only_watch_says_no_more_by_datagrams():
    ends = Ends(topics=lambda topic: topic == '_beat')
    try:
        for topic in ('mhri_guard/command', '_key', '_control', '_beat'):
            ends.passes(ends.down, topic, b'x')
        wait_for(lambda: ends.at_robot, LONG_S, 'the beat')
        assert ends.at_robot == [('_beat', b'x')]
    finally:
        ends.close()


def test_what_is_not_sealed_for_it_is_counted_and_goes_nowhere(ends, caplog):
    ends.passes(ends.down, 'odom', b'1')
    ends.robot.refused.clear()
    tap, noise = Tap(), random.Random(5)

    def tapped():
        ends.down.place = tap, None
        ends.down.send('odom', bytes(100))
        return len(tap.packets) >= 3
    wait_for(tapped, LONG_S, 'datagrams', 0.02)
    packets = tap.packets[:3]
    forged = [packet[:20] + noise.getrandbits(8 * 60).to_bytes(60, 'big') for packet in packets]
    other = [b'ms\1\0' + bytes(8) + packet[12:] for packet in packets]
    garbage = [b'', b'GET / HTTP/1.1\r\n\r\n' * 3, noise.getrandbits(8000).to_bytes(1000, 'big')]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        for packet in forged + other + garbage + packets + packets:
            stranger.sendto(packet, ('127.0.0.1', ends.port))
    wanted = {FORGED: 3, STRANGER: 3, GARBAGE: 3, REPLAYED: 3}
    wait_for(lambda: dict(ends.robot.refused) == wanted, LONG_S, lambda: str(ends.robot.refused))
    ends.down.place = None
    ends.passes(ends.down, 'odom', b'3')
    wait_for(lambda: ends.at_robot[-1][1] == b'3', LONG_S, lambda: str(ends.at_robot))
    assert [data for _, data in ends.at_robot] == [b'1'] + 3 * [bytes(100)] + [b'3']
    assert [record.message for record in caplog.records if 'dropped' in record.message] == [
        'dropped from 127.0.0.1: ' + why for why in (FORGED, GARBAGE)]


def test_with_other_keys_they_agree_again(ends):
    ends.passes(ends.down, 'odom', b'1')
    before = ends.up.channel.run
    ends.robot.forget()
    assert ends.up.channel.run != before
    ends.passes(ends.up, 'odom', b'2')
    wait_for(lambda: ends.at_host == [('odom', b'2')], LONG_S, 'it to come')


@pytest.mark.parametrize('at, owners, goes_on', [
    ('robot', {'host:lab'}, False), ('host', {'robot:bot1.2'}, False),
    ('host', {'watched:bot1'}, False), ('robot', {'host:desk', 'host:lab.2', 'robot:bot2'}, True)])
def test_whose_certificate_has_run_out_is_not_heard_until_tls_knows_it(ends, at, owners, goes_on):
    sender, heard = (ends.down, ends.at_robot) if at == 'robot' else (ends.up, ends.at_host)
    ends.passes(sender, 'odom', b'before')
    wait_for(lambda: heard, LONG_S, 'it to come')
    ends.tls = False
    here = getattr(ends, at)
    here.refused.clear()
    here.forget(owners)
    sender.send('odom', b'after')
    wait_for(lambda: heard[1:] or here.refused[STRANGER], LONG_S, 'the datagram')
    assert (heard[1:] == [('odom', b'after')]) is goes_on
    ends.tls = True
    wait_for(lambda: sender.send('odom', b'again') and heard[-1][1] == b'again', LONG_S,
             'it to be heard again', 0.02)


def test_a_port_that_is_taken_is_no_end_of_the_link(caplog):
    first = Ends()
    second = datagrams.open_port(['tls/127.0.0.1:{}'.format(first.port)], [])
    try:
        assert 'no datagrams on UDP port {}'.format(first.port) in caplog.text
        assert second is not None
    finally:
        first.close()
        second.close()


def test_without_the_library_it_says_so(monkeypatch, caplog):
    real = builtins.__import__

    def missing(name, *rest):
        if name.startswith('cryptography'):
            raise ImportError('No module named ' + name)
        return real(name, *rest)
    monkeypatch.setattr(builtins, '__import__', missing)
    assert datagrams.open_port(['tls/127.0.0.1:7447'], []) is None
    assert 'install python3-cryptography' in caplog.text
