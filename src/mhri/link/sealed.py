# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sealed datagrams: what a link with keys sends so that a lost packet holds up none behind it.

TLS repeats what is lost, and all that follows waits. So the ends that have let each other in by
their certificates hand each other over TLS what seals datagrams (:meth:`Lane.offer`):

- a number for this run of the end, new at each start and whenever its keys are read anew
- a secret of 32 random bytes, made for that number of the other end and for nobody else

A datagram is a head (``ms``, version, 0, number of the receiver's run, count) and a body sealed by
AES-256-GCM under the sender's secret, with the count as nonce and the head as associated data. The
count begins with the secret and never comes twice, so no nonce does. What opens came from who got
its secret over TLS, as it was; what came before, or is too late, is refused (:class:`Window`). A
receiver that was started anew has another number, so nothing that was said to it before counts.
"""
import math
import struct
from typing import Any, Callable, Optional, Tuple, Type

from mhri.link.frames import FrameError

VERSION = 1
# The stream of offers, which go over TLS alone, and never in a datagram.
OFFER = '_key'
SECRET_BYTES = 32
# With more in them datagrams would be too long [bytes].
MOST_BYTES = 60000
# Without a word over TLS nothing counts after so long: a certificate may have run out [s].
LIFE_S = 600.0
# So long after the other end said that it hears this one datagrams are used [s].
USE_S = 1.5
# How far behind the newest one a datagram may come.
LATE = 1024
_MAGIC = b'ms'
_HEAD = struct.Struct('>2sBxQQ')
_OFFER = struct.Struct('>2sBxQQ{}s'.format(SECRET_BYTES))
_TAG_BYTES = 16
# Why a datagram is refused.
GARBAGE, STRANGER, FORGED, REPLAYED = (
    'what is no datagram of the link', 'a datagram for another run of the link',
    'a datagram with another key', 'a datagram for the second time, or late')


class SealError(FrameError):
    """A datagram that does not count; the text is one of the reasons above."""


def run_of(packet: bytes) -> int:
    """Return for whom a datagram is.

    :raises SealError: it is none
    """
    if len(packet) < _HEAD.size + _TAG_BYTES:
        raise SealError(GARBAGE)
    magic, version, run, _ = _HEAD.unpack_from(packet)
    if (magic, version) != (_MAGIC, VERSION):
        raise SealError(GARBAGE)
    return int(run)


class Window:
    """Lets each count through once, and none that is far behind the newest (as RFC 4303, 3.4.3)."""

    def __init__(self) -> None:
        self._newest = 0
        # A bit for each count that came, the lowest for the newest.
        self._came = 0

    def lets(self, count: int) -> bool:
        """Tell whether a count is new; it is not noted."""
        behind = self._newest - count
        return behind < 0 or behind < LATE and not self._came >> behind & 1

    def note(self, count: int) -> None:
        """Note that a count came, in a datagram that opened."""
        ahead = count - self._newest
        if ahead > 0:
            # Not shifted by what may be any number.
            self._came = (self._came << ahead if ahead < LATE else 0) & ((1 << LATE) - 1)
            self._newest = count
        self._came |= 1 << self._newest - count


class Lane:
    """Datagrams to and from one other end; times are [s] of a clock that never goes back.

    :param cipher: makes an AEAD of a secret, with ``encrypt`` and ``decrypt`` (nonce, data, beside)
    :param random: returns so many random bytes
    :param broken: what ``decrypt`` raises
    """

    def __init__(self, cipher: Callable[[bytes], Any], random: Callable[[int], bytes],
                 broken: Type[Exception]) -> None:
        self._cipher, self._random, self._broken = cipher, random, broken
        self.forget()

    def forget(self) -> None:
        """Begin again: nothing that was agreed on counts any more."""
        self.run = int.from_bytes(self._random(8), 'big') or 1
        self._theirs, self._count = 0, 0
        self._own_secret = self._their_secret = bytes(SECRET_BYTES)
        self._seals: Optional[Any] = None
        self._opens: Optional[Any] = None
        self._window = Window()
        self._offered_at = self._heard_at = self._hears_at = -math.inf

    def offer(self) -> bytes:
        """Return what the other end has to know, to be told over TLS again and again."""
        return _OFFER.pack(_MAGIC, VERSION, self.run, self._theirs, self._own_secret)

    def on_offer(self, data: bytes, now: float) -> bool:
        """Take in what the other end offers, as it came over TLS; tell whether it is news.

        :raises FrameError: it is none
        """
        if len(data) != _OFFER.size or data[:3] != _MAGIC + bytes((VERSION,)):
            raise FrameError('no key for datagrams')
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
                self._window = Window()
                news = True
        return news

    def _lives(self, now: float) -> bool:
        return now - self._offered_at < LIFE_S

    def silence_s(self, now: float) -> float:
        """Return since when no datagram opened [s], infinite before the first."""
        return now - self._heard_at

    def used(self, now: float) -> bool:
        """Tell whether datagrams pass both ways."""
        return self._lives(now) and now - self._hears_at < USE_S

    def seal(self, topic: str, data: bytes, now: float) -> Optional[bytes]:
        """Return the datagram of a message, None before the other end is known.

        :param topic: '' with no data only to show that datagrams pass
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

        :raises SealError: it does not count
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
