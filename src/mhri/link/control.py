# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decides, on the robot, which host is in control of it; one host at a time.

States and transitions::

    FREE    no host is in control  a host drives, or requests control -> HELD by it
    HELD    by a host              the host is silent for SILENT_S, or leaves -> FREE;
                                   another host requests control -> ASKED
    ASKED   holder is notified     the same host repeats the request after STEP_S -> HELD by it;
                                   no such request within ASK_S -> HELD as before

Commands of a new holder pass after its first zero command. A stop of any host that may drive always
passes, and blocks the commands of all others until that host releases it.
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
# Request that gives up control, as a host's last message.
LEAVE = b'[0]'
# A host loses control after this silence, which is longer than a gap of the radio [s].
SILENT_S = 3.0
# Earliest and latest time of the second request after the first [s].
STEP_S, ASK_S = 0.5, 20.0
# A host that drives without control is logged once per this time [s].
REFUSED_S = 5.0
_TWIST = struct.Struct('<6d')
# Upper limit of plausible numbers of requests.
_MAX_ASKED = 1 << 31


class Control:
    """The control of one robot; hosts are names as in :mod:`mhri.link.keys`.

    Times are [s] of a monotonic clock.

    :param may_drive: returns whether a host has the right to drive
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
        """Return whether a host is allowed to take control."""
        return is_host(host) and self._may_drive(host)

    def on_heard(self, host: str, now: float) -> None:
        """Note that a host is present."""
        self._heard_at[host] = now

    def on_gone(self, host: str) -> None:
        """Note that a host has left; its stop remains until another host takes control."""
        self._heard_at.pop(host, None)
        if host == self.asking:
            self.asking = ''
        if host == self.holder:
            self.holder = self.asking = ''
            self._tell('{} has given up control'.format(called(host)))

    def tick(self, now: float) -> None:
        """Take control from silent hosts, and drop an expired request."""
        for host in [host for host, at in self._heard_at.items() if now - at > SILENT_S]:
            self.on_gone(host)
        if self.asking and now - self._asked_at > ASK_S:
            self.asking = ''

    def passes(self, host: str, stop: bool, moving: bool, now: float) -> bool:
        """Return whether to pass a command of a host on to the guard.

        :param stop: whether it is a latching stop
        :param moving: whether its velocity is not zero
        """
        if not self.may_drive(host):
            return self._refuse(host, moving, now, 'may only watch')
        if stop:
            self._stopping[host] = None
            return True
        self._stopping.pop(host, None)
        if self._stopping:
            return self._refuse(host, moving, now, '{} has stopped it'.format(
                ', '.join(map(called, self._stopping))))
        if not self.holder and moving:
            self._give(host)
        if self.holder and host != self.holder:
            return self._refuse(host, moving, now, '{} has control'.format(called(self.holder)))
        self._neutral = self._neutral or not moving and host == self.holder
        return self._neutral or not moving

    def ask(self, host: str, now: float) -> str:
        """Handle a request for control; return the answer, '' if the host is in control now."""
        if not self.may_drive(host):
            self._tell('{} asked for control, and may only watch'.format(called(host)))
            return 'this computer may only watch'
        self.on_heard(host, now)
        self.tick(now)
        again = host == self.asking and STEP_S <= now - self._asked_at
        if self.holder in ('', host) or again:
            # The new holder takes responsibility: stops of absent hosts end here.
            for other in [other for other in self._stopping if other not in self._heard_at]:
                del self._stopping[other]
            self._give(host)
            return ''
        if host != self.asking:
            self.asking, self._asked_at = host, now
            self._tell('{} asks for control, which {} has'.format(
                called(host), called(self.holder)))
        return '{} has control and was informed of your request: ask again to take it'.format(
            called(self.holder))

    def _give(self, host: str) -> None:
        self.asking = ''
        if host == self.holder:
            return
        before, self.holder = self.holder, host
        # For a robot that was out of reach, guard and mux require neutral.
        self._neutral = self._neutral and self._last in ('', host)
        self._last = host
        self._tell('{} has taken control from {}'.format(called(host), called(before)) if before
                   else '{} has control'.format(called(host)))

    def _refuse(self, host: str, moving: bool, now: float, why: str) -> bool:
        if moving and now - self._refused_at.get(host, -math.inf) > REFUSED_S:
            self._tell('{} may not drive: {}'.format(called(host), why))
        if moving:
            self._refused_at[host] = now
        return False

    def _tell(self, text: str) -> None:
        self.events.append(text)


def moves(body: bytes) -> bool:
    """Return whether a ``geometry_msgs/TwistStamped`` is non-zero; False if malformed."""
    if len(body) < _TWIST.size:
        return True
    return any(value != 0.0 for value in _TWIST.unpack(body[-_TWIST.size:]))


@dataclass(frozen=True)
class ControlStatus:
    """The robot's report to a host about control.

    :param may: whether that host is allowed to take control
    :param said: the last change or refusal, as a sentence
    :param asked: number of the last received request of the host
    :param answer: answer to that request, see :meth:`Control.ask`
    """

    holder: str = ''
    asking: str = ''
    may: bool = False
    said: str = ''
    asked: int = 0
    answer: str = ''


def pack_control_status(standing: ControlStatus) -> bytes:
    """Return the bytes of a :class:`ControlStatus`."""
    return json.dumps(astuple(standing)).encode('ascii')


def unpack_control_status(body: bytes) -> ControlStatus:
    """Return the :class:`ControlStatus` of bytes.

    :raises FrameError: they are malformed
    """
    row = read_rows(body)
    kinds = [type(value) for value in astuple(ControlStatus())]
    if [type(value) for value in row] != kinds or not 0 <= row[4] <= _MAX_ASKED or any(
            owner and not is_host(owner) for owner in row[:2]):
        raise FrameError('not a control status')
    return ControlStatus(row[0], row[1], row[2], tidy_text(row[3]), row[4], tidy_text(row[5]))
