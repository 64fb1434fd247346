# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sealed datagrams for links with keys: a lost packet does not delay those behind it.

TLS retransmits lost data, and all following data waits. So ends that have accepted each other's
certificates exchange the secrets for sealed datagrams over TLS (:meth:`SealedChannel.offer`):

- a number of this run of the end, new at each start and whenever its keys are read again
- a secret of 32 random bytes, only for that run of the other end

A datagram is a head (``ms``, version, 0, number of the receiver's run, count) and a body sealed by
AES-256-GCM under the sender's secret, with the count as nonce and the head as associated data. The
count starts with the secret and never repeats, so nonces never repeat. A datagram that opens is
unchanged, and from the end of the TLS connection; repeated and late ones are refused
(:class:`ReplayWindow`). A restarted receiver has another number, so it refuses older datagrams.
"""
import math
import struct
from typing import Any, Callable, Optional, Tuple, Type

from mhri.link.frames import FrameError

VERSION = 1
# The stream of offers, only sent over TLS.
OFFER = '_key'
SECRET_BYTES = 32
# Maximum content of a datagram [bytes].
MAX_BYTES = 60000
# Datagrams are refused this long after the last offer over TLS: a certificate may have expired [s].
LIFE_S = 600.0
# Datagrams are used for this time after the other end confirmed that it receives them [s].
USE_S = 1.5
# Maximum number of counts by which a datagram may be behind the newest one.
LATE = 1024
_MAGIC = b'ms'
_HEAD = struct.Struct('>2sBxQQ')
_OFFER = struct.Struct('>2sBxQQ{}s'.format(SECRET_BYTES))
_TAG_BYTES = 16
# Reasons for refusing a datagram.
GARBAGE, STRANGER, FORGED, REPLAYED = (
    'not a datagram of the link', 'a datagram for another run of the link',
    'a datagram with another key', 'a repeated or late datagram')


class SealError(FrameError):
    """A refused datagram; the text is one of the reasons above."""


def run_of(packet: bytes) -> int:
    """Return the run that a datagram is addressed to.

    :raises SealError: it is malformed
    """
    if len(packet) < _HEAD.size + _TAG_BYTES:
        raise SealError(GARBAGE)
    magic, version, run, _ = _HEAD.unpack_from(packet)
    if (magic, version) != (_MAGIC, VERSION):
        raise SealError(GARBAGE)
    return int(run)


class ReplayWindow:
    """Accepts each count once, unless it is far behind the newest (like RFC 4303, 3.4.3)."""

    def __init__(self) -> None:
        self._newest = 0
        # A bit for each received count, the lowest for the newest.
        self._came = 0

    def lets(self, count: int) -> bool:
        """Return whether a count is new, without recording it."""
        behind = self._newest - count
        return behind < 0 or behind < LATE and not self._came >> behind & 1

    def note(self, count: int) -> None:
        """Record the count of a datagram that opened."""
        ahead = count - self._newest
        if ahead > 0:
            # Bound the shift, since a count may be arbitrarily large.
            self._came = (self._came << ahead if ahead < LATE else 0) & ((1 << LATE) - 1)
            self._newest = count
        self._came |= 1 << self._newest - count


class SealedChannel:
    """Seals and opens datagrams for one other end; times are [s] of a monotonic clock.

    :param cipher: creates an AEAD of a secret, with ``encrypt`` and ``decrypt`` (nonce, data,
        associated data)
    :param random: returns a number of random bytes
    :param broken: the exception raised by ``decrypt``
    """

    def __init__(self, cipher: Callable[[bytes], Any], random: Callable[[int], bytes],
                 broken: Type[Exception]) -> None:
        self._cipher, self._random, self._broken = cipher, random, broken
        self.forget()

    def forget(self) -> None:
        """Reset the channel: discard all negotiated secrets."""
        self.run = int.from_bytes(self._random(8), 'big') or 1
        self._theirs, self._count = 0, 0
        self._own_secret = self._their_secret = bytes(SECRET_BYTES)
        self._seals: Optional[Any] = None
        self._opens: Optional[Any] = None
        self._window = ReplayWindow()
        self._offered_at = self._heard_at = self._hears_at = -math.inf

    def offer(self) -> bytes:
        """Return the offer to the other end, to be repeated over TLS."""
        return _OFFER.pack(_MAGIC, VERSION, self.run, self._theirs, self._own_secret)

    def on_offer(self, data: bytes, now: float) -> bool:
        """Handle an offer of the other end, received over TLS; return whether it is new.

        :raises FrameError: it is malformed
        """
        if len(data) != _OFFER.size or data[:3] != _MAGIC + bytes((VERSION,)):
            raise FrameError('not an offer of keys for datagrams')
        _, _, run, for_run, secret = _OFFER.unpack(data)
        news: bool = run != self._theirs or for_run != self.run
        if run != self._theirs:
            self._theirs, self._count, self._hears_at = run, 0, -math.inf
            self._own_secret = self._random(SECRET_BYTES)
            self._seals = self._cipher(self._own_secret)
        if for_run == self.run:
            self._offered_at = now
            if secret != self._their_secret:
                self._their_secret, self._opens = secret, self._cipher(secret)
                self._window = ReplayWindow()
                news = True
        return news

    def _lives(self, now: float) -> bool:
        return now - self._offered_at < LIFE_S

    def silence_s(self, now: float) -> float:
        """Return the time since a datagram opened [s], infinite before the first."""
        return now - self._heard_at

    def used(self, now: float) -> bool:
        """Return whether datagrams pass in both directions."""
        return self._lives(now) and now - self._hears_at < USE_S

    def seal(self, topic: str, data: bytes, now: float) -> Optional[bytes]:
        """Return the datagram of a message, None before the other end is known.

        :param topic: '' without data for a keepalive
        """
        if self._seals is None:
            return None
        self._count += 1
        head = _HEAD.pack(_MAGIC, VERSION, self._theirs, self._count)
        name = topic.encode('ascii')
        body = bytes((now - self._heard_at < USE_S, len(name))) + name + data
        sealed: bytes = self._seals.encrypt(_nonce(self._count), body, head)
        return head + sealed

    def open(self, packet: bytes, now: float) -> Tuple[str, bytes]:
        """Return (topic, data) of a datagram for this run.

        :raises SealError: the datagram is refused
        """
        run, count = run_of(packet), _HEAD.unpack_from(packet)[3]
        if run != self.run or self._opens is None or not self._lives(now):
            raise SealError(STRANGER)
        if not self._window.lets(count):
            raise SealError(REPLAYED)
        try:
            body: bytes = self._opens.decrypt(_nonce(count), packet[_HEAD.size:],
                                              packet[:_HEAD.size])
        except self._broken:
            raise SealError(FORGED) from None
        if len(body) < 2:
            raise SealError(GARBAGE)
        self._window.note(count)
        self._heard_at = now
        if body[0]:
            self._hears_at = now
        end = 2 + body[1]
        return body[2:end].decode('ascii', 'replace'), body[end:]


def _nonce(count: int) -> bytes:
    return count.to_bytes(12, 'big')
