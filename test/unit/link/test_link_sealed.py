# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sealed datagrams: who has the key is heard, once, and nobody else."""
import itertools
import os
import random

import pytest

from mhri.link.frames import FrameError
from mhri.link.sealed import (
    FORGED, GARBAGE, LATE, LIFE_S, REPLAYED, run_of, SealedChannel, SealError, STRANGER, USE_S,
    ReplayWindow)

aead = pytest.importorskip('cryptography.hazmat.primitives.ciphers.aead')
InvalidTag = pytest.importorskip('cryptography.exceptions').InvalidTag


def channel():
    return SealedChannel(aead.AESGCM, os.urandom, InvalidTag)


def agree(one, other, now=0.0):
    """Tell both ends over TLS, until neither has news; return how often."""
    for turn in range(10):
        if not (other.on_offer(one.offer(), now) | one.on_offer(other.offer(), now)):
            return turn
    raise AssertionError('they never agree')


@pytest.fixture
def ends():
    one, other = channel(), channel()
    assert agree(one, other) <= 3
    return one, other


def refused(receiver, packet, now=0.0):
    with pytest.raises(SealError) as caught:
        receiver.open(packet, now)
    return str(caught.value)


def test_what_one_seals_the_other_opens(ends):
    one, other = ends
    for here, there in (ends, ends[::-1]):
        packet = here.seal('mhri_guard/command', b'turn', 0.0)
        assert there.open(packet, 0.0) == ('mhri_guard/command', b'turn')
        assert b'turn' not in packet and b'guard' not in packet
        assert run_of(packet) == there.run


def test_before_they_agree_nothing_is_sealed_or_opened(ends):
    new = channel()
    assert new.seal('odom', b'', 0.0) is None and not new.used(0.0)
    packet = ends[0].seal('odom', b'', 0.0)
    assert refused(new, packet) == STRANGER
    assert refused(ends[0], packet) == STRANGER, 'its own, sent back'


def test_used_once_both_have_heard_each_other_and_only_while_they_do(ends):
    one, other = ends
    other.open(one.seal('', b'', 0.0), 0.0)
    assert not one.used(0.0) and not other.used(0.0), 'nobody knows of the way back'
    one.open(other.seal('', b'', 0.1), 0.1)
    assert one.used(0.1)
    assert not one.used(0.1 + USE_S)
    # The other end has heard nothing for long, and says so.
    one.open(other.seal('', b'', 9.0), 9.0)
    assert not one.used(9.0)


def test_each_datagram_counts_once(ends):
    one, other = ends
    packets = [one.seal('odom', bytes((number,)), 0.0) for number in range(50)]
    mixed = packets[:]
    random.Random(1).shuffle(mixed)
    assert sorted(other.open(packet, 0.0)[1][0] for packet in mixed) == list(range(50))
    for packet in packets:
        assert refused(other, packet) == REPLAYED


def test_what_is_far_behind_is_refused_though_it_is_new(ends):
    one, other = ends
    first, second = (one.seal('odom', b'', 0.0) for _ in range(2))
    for packet in [one.seal('odom', b'', 0.0) for _ in range(LATE)]:
        other.open(packet, 0.0)
    assert refused(other, first) == refused(other, second) == REPLAYED


def test_any_changed_byte_is_noticed(ends):
    one, other = ends
    packet = one.seal('odom', b'12345678', 0.0)
    for place in range(len(packet)):
        changed = bytearray(packet)
        changed[place] ^= 1
        assert refused(other, bytes(changed)) in (GARBAGE, STRANGER, FORGED)
    assert other.open(packet, 0.0) == ('odom', b'12345678'), 'none of them was noted'


def test_who_knows_all_but_the_secret_is_not_heard(ends):
    attacker = channel()
    # It knows the run of the robot, which is in every datagram, and seals with a key of its own.
    attacker.on_offer(ends[1].offer(), 0.0)
    assert refused(ends[1], attacker.seal('mhri_guard/command', b'turn', 0.0)) == FORGED


@pytest.mark.parametrize('seed', range(20))
def test_garbage(ends, seed):
    noise = random.Random(seed)
    packet = noise.getrandbits(8 * 300).to_bytes(300, 'big')[:noise.randrange(300)]
    assert refused(ends[1], packet) == GARBAGE


def test_after_a_new_start_nothing_of_before_is_heard(ends):
    one, other = ends
    before = [one.seal('mhri_guard/command', b'turn', 0.0) for _ in range(3)]
    other.open(before[0], 0.0)
    again = channel()
    agree(one, again)
    for packet in before:
        assert refused(again, packet) == STRANGER
    assert again.open(one.seal('odom', b'new', 0.0), 0.0) == ('odom', b'new')
    assert refused(other, one.seal('odom', b'new', 0.0)) == STRANGER


def test_keys_that_are_read_anew_end_what_was_agreed(ends):
    one, other = ends
    packet = one.seal('odom', b'', 0.0)
    other.forget()
    assert refused(other, packet) == STRANGER
    assert other.seal('odom', b'', 0.0) is None and not other.used(0.0)
    agree(one, other)
    assert other.open(one.seal('odom', b'', 0.0), 0.0) == ('odom', b'')


def test_without_a_word_over_tls_it_ends(ends):
    one, other = ends
    assert other.open(one.seal('odom', b'', LIFE_S - 1.0), LIFE_S - 1.0)
    assert refused(other, one.seal('odom', b'', LIFE_S), LIFE_S) == STRANGER
    assert not one.used(LIFE_S)
    agree(one, other, LIFE_S)
    assert other.open(one.seal('odom', b'', LIFE_S), LIFE_S) == ('odom', b'')


@pytest.mark.parametrize('data', [b'', b'ms', b'ms\1', b'ms\2' + bytes(49), b'xx\1' + bytes(49),
                                  b'ms\1' + bytes(60)])
def test_what_is_no_offer_is_refused(ends, data):
    with pytest.raises(FrameError):
        ends[0].on_offer(data, 0.0)


def test_a_peer_that_seals_nothing_at_all_is_refused(ends):
    class Empty:
        def __init__(self, secret):
            self._real = aead.AESGCM(secret)

        def encrypt(self, nonce, _, head):
            return self._real.encrypt(nonce, b'', head)
    odd, other = SealedChannel(Empty, os.urandom, InvalidTag), channel()
    agree(odd, other)
    assert refused(other, odd.seal('odom', b'', 0.0)) == GARBAGE


def test_a_window_lets_each_count_through_once():
    window, came = ReplayWindow(), set()
    noise = random.Random(3)
    for step in itertools.accumulate(noise.choice((0, 1, 1, 3, 2000)) for _ in range(500)):
        count = max(0, step - noise.randrange(LATE + 20))
        expected = count not in came and count > max(came, default=-1) - LATE
        assert window.lets(count) == expected
        if expected:
            window.note(count)
            came.add(count)
    window.note((1 << 64) - 1)
    assert not window.lets((1 << 64) - 1) and window.lets((1 << 64) - 2) and not window.lets(5)
