# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which host is in control of a linked robot: one at a time, decided on the robot.

States and what leads out of them::

    FREE    nobody is in control   a host drives -> HELD by it
    HELD    by a host              that one is not heard for SILENT_S, or leaves -> FREE;
                                   another asks -> ASKED
    ASKED   the holder is told     the same asks again after STEP_S at the earliest -> HELD by it;
                                   it does not within ASK_S -> HELD as before

After a change to another host its commands count once it has said zero. A stop of any host that may
drive counts always; until that host has taken it back nobody else's commands do.
"""
from dataclasses import astuple, dataclass
import json
import math
import struct
from typing import Callable, Dict, List

from mhri.base.text import tidy_text
from mhri.link.frames import FrameError, read_rows
from mhri.robots.owners import called, is_host

FREE, HELD, ASKED = 'free', 'held', 'asked'
# So long unheard, and a host has control no more [s]; the radio may have a gap.
SILENT_S = 3.0
# The second step comes after this long at the earliest, and at the latest [s].
STEP_S, ASK_S = 0.5, 20.0
# Whoever drives without control is told of once in so long [s].
REFUSED_S = 5.0
_TWIST = struct.Struct('<6d')
# So often nobody asks.
_MAX_ASKED = 1 << 31


class Control:
    """Who is in control of one robot; hosts are names as in :mod:`mhri.link.keys`.

    Times are [s] of a clock that never goes back.

    :param may_drive: whether a host may at all
    """

    def __init__(self, may_drive: Callable[[str], bool]) -> None:
        self._may_drive = may_drive
        self._heard_at: Dict[str, float] = {}
        self._refused_at: Dict[str, float] = {}
        self._stopping: Dict[str, None] = {}
        self._last = ''
        self._neutral = True
        self._asked_at = -math.inf
        self.holder = ''
        self.asking = ''
        self.events: List[str] = []

    @property
    def state(self) -> str:
        """One of FREE, HELD, ASKED."""
        return FREE if not self.holder else ASKED if self.asking else HELD

    def may_drive(self, host: str) -> bool:
        """Tell whether a host could have control."""
        return is_host(host) and self._may_drive(host)

    def on_heard(self, host: str, now: float) -> None:
        """Take note that a host is there."""
        self._heard_at[host] = now

    def on_gone(self, host: str) -> None:
        """Take note that a host has left; its stop stays until somebody takes control."""
        self._heard_at.pop(host, None)
        if host == self.asking:
            self.asking = ''
        if host == self.holder:
            self.holder = self.asking = ''
            self._tell('{} has given up control'.format(called(host)))

    def tick(self, now: float) -> None:
        """Let time pass: who is silent has control no more, a request is forgotten."""
        for host in [host for host, at in self._heard_at.items() if now - at > SILENT_S]:
            self.on_gone(host)
        if self.asking and now - self._asked_at > ASK_S:
            self.asking = ''

    def passes(self, host: str, stop: bool, moving: bool, now: float) -> bool:
        """Tell whether a command of a host goes on to the guard.

        :param stop: it is one that latches
        :param moving: its velocity is not zero
        """
        if not self.may_drive(host):
            return self._refuse(host, moving, now, 'may only watch')
        if stop:
            self._stopping[host] = None
            return True
        self._stopping.pop(host, None)
        if self._stopping:
            return self._refuse(host, moving, now, '{} has stopped it'.format(
                ', '.join(called(other, host) for other in self._stopping)))
        if not self.holder and moving:
            self._give(host)
        if self.holder and host != self.holder:
            return self._refuse(host, moving, now, '{} has control'.format(
                called(self.holder, host)))
        self._neutral = self._neutral or not moving and host == self.holder
        return self._neutral or not moving

    def ask(self, host: str, now: float) -> str:
        """Take in that a host asks for control; return what to tell it, '' once it has it."""
        if not self.may_drive(host):
            self._tell('{} asked for control, and may only watch'.format(called(host)))
            return 'this computer may only watch'
        self.on_heard(host, now)
        self.tick(now)
        again = host == self.asking and STEP_S <= now - self._asked_at
        if self.holder in ('', host) or again:
            # Who takes it answers for it: a stop of somebody who is not there ends here.
            for other in [other for other in self._stopping if other not in self._heard_at]:
                del self._stopping[other]
            self._give(host)
            return ''
        if host != self.asking:
            self.asking, self._asked_at = host, now
            self._tell('{} asks for control, which {} has'.format(
                called(host, self.holder), called(self.holder, host)))
        return '{} has control and is told that you ask: ask again to take it'.format(
            called(self.holder, host))

    def _give(self, host: str) -> None:
        self.asking = ''
        if host == self.holder:
            return
        before, self.holder = self.holder, host
        # The guard and the gates see to it that who was away begins at neutral.
        self._neutral = self._neutral and self._last in ('', host)
        self._last = host
        self._tell('{} has taken control from {}'.format(called(host, before), called(before, host))
                   if before else '{} has control'.format(called(host)))

    def _refuse(self, host: str, moving: bool, now: float, why: str) -> bool:
        if moving and now - self._refused_at.get(host, -math.inf) > REFUSED_S:
            self._tell('{} may not drive: {}'.format(called(host, self.holder), why))
        if moving:
            self._refused_at[host] = now
        return False

    def _tell(self, text: str) -> None:
        self.events.append(text)


def moves(body: bytes) -> bool:
    """Tell whether a ``geometry_msgs/TwistStamped`` is more than a zero; so is what is none."""
    if len(body) < _TWIST.size:
        return True
    return any(value != 0.0 for value in _TWIST.unpack(body[-_TWIST.size:]))


@dataclass(frozen=True)
class Standing:
    """What the robot tells a host of control.

    :param may: that host could have it
    :param said: the last change or refusal, in a sentence
    :param asked: number of the host's last request that was heard
    :param answer: to that, see :meth:`Control.ask`
    """

    holder: str = ''
    asking: str = ''
    may: bool = False
    said: str = ''
    asked: int = 0
    answer: str = ''


def pack_standing(standing: Standing) -> bytes:
    """Return the bytes of a :class:`Standing`."""
    return json.dumps(astuple(standing)).encode('ascii')


def unpack_standing(body: bytes) -> Standing:
    """Return the :class:`Standing` of bytes.

    :raises FrameError: they are none
    """
    row = read_rows(body)
    kinds = [type(value) for value in astuple(Standing())]
    if [type(value) for value in row] != kinds or not 0 <= row[4] <= _MAX_ASKED or any(
            owner and not is_host(owner) for owner in row[:2]):
        raise FrameError('no word on who has control')
    return Standing(row[0], row[1], row[2], tidy_text(row[3]), row[4], tidy_text(row[5]))
