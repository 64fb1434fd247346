# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages between two processes: whole, never waited for, and none lost when one end goes."""
import socket

import pytest

from mhri.devices.io.child import Channel


@pytest.fixture
def ends():
    """Return the two ends of a channel, and the socket of the second."""
    here, there = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with here, there:
        yield Channel(here), Channel(there), there


def test_messages_come_whole_and_in_order(ends):
    here, there, _ = ends
    assert here.messages() == [] and here.packet() == b''
    for message in ({'robots': []}, ['a', 1.5], bytes(640)):
        there.send(message)
    assert here.packet() == b'{"robots": []}'
    assert here.packet(None) == b'["a", 1.5]'
    assert here.packet(60.0) == bytes(640)


def test_what_was_sent_before_the_end_comes_first(ends):
    """Also where the one that goes had not received all."""
    here, there, end = ends
    here.send('never received')
    there.send(1)
    there.send(2)
    end.close()
    assert here.messages(None) == [1, 2]
    for receive in (here.messages, here.packet):
        with pytest.raises(EOFError):
            receive()
    with pytest.raises(OSError):
        here.send('to nobody')


def test_one_that_receives_nothing_holds_nobody_up(ends):
    here, there, _ = ends
    with pytest.raises(BlockingIOError):
        while True:
            here.send('x' * 1000)
    assert set(there.messages()) == {'x' * 1000}
    here.send('there is room again')
