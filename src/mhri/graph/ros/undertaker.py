# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The last zero to a robot, sent at once when the program that drives it was killed or hangs.

A robot keeps its last velocity until it receives another. So the standby process
(:mod:`mhri.graph.ros.stand_by`) holds a duplicate of every connection to a robot, and writes the
zero itself. The program that drives is its child and uses :class:`Undertaker` and :class:`Line`;
the parent uses :class:`FinalFrames`.

**Partial frames.** A program may be killed when the kernel has accepted a part of a message. A zero
after that part is garbage to the subscriber: it closes the connection and keeps the last velocity.
So the child writes each frame into shared memory before it sends it, with the number of bytes sent
before it, and the kernel reports the total number of bytes it has accepted. The parent finishes the
frame, then writes the zero. And nothing is sent into a buffer that is not nearly empty: the kernel
then accepts a frame as a whole.

The memory is shared by two processes, and either may end at any instruction. So every decision is a
single byte, written by one side only; longer data is written next to the valid data, before the
byte that selects it. Each connection has a slot with the number of its use, written by the child
(0: free) and repeated by the parent once it holds the duplicate.
"""
import array
import fcntl
import mmap
import os
import socket
import struct
import sys
import termios
import threading
import time

# The first bytes: flags of the child and the parent for all connections.
_BEAT, _ENDS, _SPEAKS, _STOP, _WATCHES = range(5)
# A slot: the number of its use; the same, from the parent; whether it carried motion; whether the
# zero is repeated; the valid one of two ledgers, and of two pairs of last words; the base.
_USE, _HELD, _MOVED, _REPEATS, _LEDGER, _WORDS = range(6)
_BASE, _BASE_AT = struct.Struct('<Q'), 8
# Bytes sent before the frame, and the frame; the zero, and the zero under a stop.
_OWED, _PAIR = struct.Struct('<Q256p'), struct.Struct('<256p256p')
_OWED_AT = _BASE_AT + _BASE.size
_PAIR_AT = _OWED_AT + 2 * _OWED.size
_SLOT = _PAIR_AT + 2 * _PAIR.size
#: maximum size of a frame, including its length prefix [bytes]
MAX_FRAME = 255
# Slot 0 is for connections without room elsewhere; it is never read.
_SLOTS = 1024
# Data sent with a duplicate: the offset of its slot, the number of its use.
_PASSED = struct.Struct('<IB')
# Offset in tcp_info (linux/tcp.h): tcpi_bytes_acked.
_ACKED = struct.Struct('=120xQ')
# Maximum number of bytes in the buffer of a connection when the next frame is sent: motion, a zero.
_ROOM = 2048, 4096
# An unconfirmed duplicate is passed again after this time [s]: the parent had no room.
_AGAIN_S = 0.25
# After this time without a beat the parent counts as silent [s].
SILENT_S = 1.5
# Period and duration of repeated zeros [s], unless the next program sends commands before.
_REPEAT_S, _LAST_S = 0.05, 3.0


def bytes_written(end):
    """Return the number of bytes written to a TCP connection in total, None if unknown.

    It is the sum of the confirmed bytes and those in the buffer, read until they are consistent.
    """
    try:
        while True:
            acked = end.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, _ACKED.size)
            waiting = _waiting(end)
            if end.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, _ACKED.size)[-8:] == acked[-8:]:
                return _ACKED.unpack(acked)[0] + waiting
    except (OSError, struct.error):
        return None


def _waiting(end):
    """Return the number of bytes of a socket not yet confirmed by its peer (SIOCOUTQ).

    :raises OSError: the system does not support it
    """
    return int.from_bytes(fcntl.ioctl(end, termios.TIOCOUTQ, bytes(4)), sys.byteorder)


def shared_memory():
    """Return the memory shared by a child and its parent; create it before the fork."""
    return mmap.mmap(-1, _SLOT * (_SLOTS + 1))


class Undertaker:
    """The child's side: its sign of life, and the connections passed to the parent.

    Without a parent, as in tests, everything counts as watched.

    :param shared: :func:`shared_memory`
    :param passes: ``socket.socket`` on which the parent receives duplicates, None without a parent
    :param parent: the parent's process id
    """

    def __init__(self, shared=None, passes=None, parent=None):
        self._shared = shared_memory() if shared is None else shared
        self._parent = parent
        self._passes = passes
        self._lock = threading.Lock()
        self._slot = self._use = 0
        self._seen = None, 0.0

    def beat(self):
        """Report that the program works; call it in the driving loop, not on another thread."""
        self._shared[_BEAT] = (self._shared[_BEAT] + 1) & 255

    def end(self):
        """Report that the program is about to end, and stops beating."""
        self._shared[_ENDS] = 1

    def alive(self):
        """Return whether the parent was active within the last 1.5 s; call it at 1 Hz or faster.

        Nothing may move without it.
        """
        now, beat = time.monotonic(), self._shared[_WATCHES]
        if beat != self._seen[0]:
            self._seen = beat, now
        return self._passes is None or now - self._seen[1] < SILENT_S

    def orphaned(self):
        """Return whether the parent has ended; a new parent then starts a node of this name."""
        return self._parent is not None and os.getppid() != self._parent

    def stop(self, pressed):
        """Store that a stop was pressed, before any other action, or that it was released.

        The parent then stops guarded robots by the second of :meth:`Line.store_final_frames`.
        """
        self._shared[_STOP] = bool(pressed)

    def watch(self, end, zero=b'', repeats=False):
        """Pass a connection to the parent; return its :class:`Line`.

        :param end: the connected socket, with nothing sent yet; it may have ended
        :param zero: the frame that stops the robot, with its length prefix
        :param repeats: whether it is repeated until the next program sends commands, for a robot
            without a lease
        """
        with self._lock:
            line = Line(self._shared, self._passes, end, *self._free())
        line.begin(zero, repeats)
        return line

    def _free(self):
        """Return a free slot and the number of its use; 0 and 0 if all are in use."""
        for _ in range(_SLOTS):
            self._slot = self._slot % (_SLOTS - 1) + 1
            at = (1 + self._slot) * _SLOT
            if not self._shared[at + _USE] and not self._shared[at + _HELD]:
                self._use = self._use % 255 + 1
                self._shared[at + _USE] = self._use
                return at, self._use
        return _SLOT, 0


class Line:
    """The shared state of one connection; not thread-safe.

    Created by :meth:`Undertaker.watch`.
    """

    def __init__(self, shared, passes, end, at, use):
        self._shared, self._passes, self._end = shared, passes, end
        self._at, self._use = at, use
        self._sent = 0
        self._again_at = 0.0

    def begin(self, zero, repeats):
        """Write the data for the parent, and pass the duplicate."""
        shared, at = self._shared, self._at
        for each, value in ((_MOVED, 0), (_REPEATS, repeats), (_LEDGER, 0), (_WORDS, 0)):
            shared[at + each] = value
        _BASE.pack_into(shared, at + _BASE_AT, (self._end and bytes_written(self._end)) or 0)
        _OWED.pack_into(shared, at + _OWED_AT, 0, b'')
        self.store_final_frames(zero)
        self._pass()

    @property
    def watched(self):
        """Whether the parent holds the duplicate; the robot must not move before."""
        if self._passes is None or self._use and self._shared[self._at + _HELD] == self._use:
            return True
        if time.monotonic() >= self._again_at:
            self._pass()
        return False

    def _pass(self):
        """Pass the duplicate to the parent, if the socket accepts it now."""
        if self._passes is None or not self._use or self._end is None:
            return
        self._again_at = time.monotonic() + _AGAIN_S
        try:
            self._passes.sendmsg(
                [_PASSED.pack(self._at, self._use)],
                [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array('i', [self._end.fileno()]))],
                socket.MSG_DONTWAIT)
        except OSError:
            pass  # the connection has ended, or the parent hangs

    def has_room(self, urgent):
        """Return whether a frame may be sent: the kernel would accept it as a whole.

        :param urgent: whether it is a zero
        """
        try:
            return _waiting(self._end) <= _ROOM[urgent]
        except (OSError, ValueError, TypeError):
            return True  # the connection has ended: sending raises the error

    def moves(self):
        """Store that motion will be sent: from now on the parent owes the robot a zero."""
        self._shared[self._at + _MOVED] = 1

    def about_to_send(self, frame):
        """Store the frame that will be sent next, with its length prefix.

        :raises ValueError: the frame is longer than :data:`MAX_FRAME`
        """
        if len(frame) > MAX_FRAME:
            raise ValueError('{} bytes, {} at most'.format(len(frame), MAX_FRAME))
        shared, at = self._shared, self._at
        half = 1 - shared[at + _LEDGER]
        _OWED.pack_into(shared, at + _OWED_AT + half * _OWED.size, self._sent, frame)
        shared[at + _LEDGER] = half
        shared[_SPEAKS] = 1

    def sent(self, count):
        """Store the number of bytes that the socket has accepted."""
        self._sent += count

    def store_final_frames(self, zero, stop=b''):
        """Store the parent's last frame after the program's end; update it at each guard echo.

        :param zero: the frame that stops the robot, with its length prefix; empty for none
        :param stop: sent instead while a stop is in force, even if nothing has moved
        """
        shared, at = self._shared, self._at
        pair = 1 - shared[at + _WORDS]
        _PAIR.pack_into(shared, at + _PAIR_AT + pair * _PAIR.size, zero, stop)
        shared[at + _WORDS] = pair

    def forget(self):
        """Let the parent close its duplicate: the connection has ended."""
        if self._use and self._shared[self._at + _USE] == self._use:
            self._shared[self._at + _USE] = 0
        # Another connection may have the slot soon.
        self._at, self._use = _SLOT, 0


class FinalFrames:
    """The parent's side: the duplicates, and the frames written to them at the end of the child.

    Everything runs on the caller's thread, nothing blocks, and rospy is not used.

    :param shared: :func:`shared_memory`
    :param hears: non-blocking ``socket.socket`` on which the child passes duplicates
    :param say: function that prints a line
    """

    def __init__(self, shared, hears, say=lambda line: None):
        self._shared = shared
        self.hears = hears
        self._say = say
        # {offset of its slot: duplicate}; [duplicate, outstanding bytes, the zero to repeat]
        self._held, self._owed = {}, []
        self._again_at = self._until = 0.0
        self._reported = False

    def beats(self):
        """Return (a number that changes with each beat of the child, whether it is ending)."""
        return self._shared[_BEAT], bool(self._shared[_ENDS])

    def busy(self):
        """Return whether :meth:`tick` is due soon."""
        return bool(self._owed)

    def tick(self, now):
        """Beat for this process, accept and close duplicates, and repeat zeros."""
        shared = self._shared
        shared[_WATCHES] = (shared[_WATCHES] + 1) & 255
        self.take()
        for at, end in list(self._held.items()):
            if shared[at + _USE] != shared[at + _HELD]:
                end.close()
                del self._held[at]
                shared[at + _HELD] = 0
        if self._owed:
            self._repeat(now)

    def take(self):
        """Accept the duplicates passed by the child, and confirm them."""
        while True:
            try:
                said, passed, _, _ = self.hears.recvmsg(16, socket.CMSG_SPACE(4))
            except BlockingIOError:
                return
            ends = [socket.socket(fileno=number) for _, _, data in passed
                    for number in array.array('i', data[:len(data) // 4 * 4])]
            if not ends and not self._reported:
                self._say('a robot stands: no descriptor is left for its connection\n')
            self._reported = not ends
            if ends and len(said) == _PASSED.size:
                at, use = _PASSED.unpack(said)
                if self._shared[at + _USE] == use:
                    before, self._held[at] = self._held.get(at), ends.pop()
                    self._shared[at + _HELD] = use
                    ends += [before] if before else []
            for end in ends:
                end.close()

    def stop(self, now):
        """Write the zero to every robot that was moved by a child that has ended.

        :returns: the number of connections
        """
        shared = self._shared
        self.take()
        for at, end in self._held.items():
            word = self._word(at) if shared[at + _USE] == shared[at + _HELD] else b''
            if not word:
                end.close()
                continue
            line = [end, self._rest(at, end) + word, word if shared[at + _REPEATS] else b'']
            if self._write(line):
                self._owed.append(line)
        self._held = {}
        # The next child starts; a stop stays in force until it is released.
        for at in range(_SLOT, len(shared), _SLOT):
            shared[at + _USE] = shared[at + _HELD] = 0
        for each in (_BEAT, _ENDS, _SPEAKS):
            shared[each] = 0
        self._again_at, self._until = now + _REPEAT_S, now + _LAST_S
        return len(self._owed)

    def _word(self, at):
        """Return the frame that stops a robot, b'' if it has not been moved."""
        shared = self._shared
        zero, stop = _PAIR.unpack_from(shared, at + _PAIR_AT + shared[at + _WORDS] * _PAIR.size)
        if shared[_STOP] and stop:
            return stop
        return zero if shared[at + _MOVED] else b''

    def _rest(self, at, end):
        """Return the missing rest of the frame that the child was sending, b'' for none."""
        shared, written = self._shared, bytes_written(end)
        begun, frame = _OWED.unpack_from(
            shared, at + _OWED_AT + shared[at + _LEDGER] * _OWED.size)
        left = (written or 0) - _BASE.unpack_from(shared, at + _BASE_AT)[0] - begun
        return frame[left:] if 0 < left < len(frame) else b''

    def _write(self, line):
        """Send the outstanding bytes of a connection, if accepted; return False if it has ended."""
        try:
            line[1] = line[1][line[0].send(line[1], socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL):]
        except BlockingIOError:
            pass  # its buffer is full: try later
        except OSError:
            line[0].close()
            return False
        return True

    def _repeat(self, now):
        """Send outstanding bytes, and repeat zeros until the next program sends commands."""
        silent = now >= self._until or self._shared[_SPEAKS]
        again = now >= self._again_at and not silent
        if again:
            self._again_at = now + _REPEAT_S
        for line in self._owed:
            if again and not line[1] and _waiting(line[0]) <= _ROOM[True]:
                line[1] = line[2]
        over = [line for line in self._owed
                if line[1] and not self._write(line) or silent and (
                    not line[1] or now >= self._until)]
        for line in over:
            line[0].close()
        self._owed = [line for line in self._owed if line not in over]

    def close(self):
        """Close every duplicate, in the next child as well, so that none stays open."""
        for end in [line[0] for line in self._owed] + list(self._held.values()):
            end.close()
        self._owed, self._held = [], {}
