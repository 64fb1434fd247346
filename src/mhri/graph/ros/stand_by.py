# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replaces a program's process when it is killed, crashes or hangs, by one that is already loaded.

Loading Python and rospy takes a third of a second on an idle processor, and seconds on a busy one;
driven robots wait for their zero meanwhile. And roslaunch does nothing about a hanging node, and
restarts (``respawn="true"``) one that ended because a newer one took its name: the two would
compete for it for ever. So roslaunch restarts this process if it is killed or cannot load;
everything else is decided here.
"""
import ctypes
import json
import math
import mmap
import os
import select
import signal
import socket
import sys
import threading
import time

from mhri.graph.ros.undertaker import FinalFrames, shared_memory, Undertaker

_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# Option of prctl(2): the signal for this process at the end of its parent. Python has no call for
# it, and setpriv(1) would restart a program that is already loaded.
_PR_SET_PDEATHSIG = 1
# A process that ends this soon after its start [s] might do so again: the next one starts after a
# pause, which doubles each time.
MIN_LIFE_S = 2.0
# The memory itself may be the cause: it is discarded when this many processes in a row have
# recalled it, and failed or hung before they worked.
MAX_RECALLS = 3
_PAUSES_S = 0.1, 0.2, 0.4
#: maximum interval between beats [s]: of a program, and of one that drives robots
HUNG_S, DRIVE_HUNG_S = 1.8, 0.5
# Maximum time until the first beat [s]: at a load of 40, a start takes at most 5 s.
START_S = 20.0
# How often this process checks the beats [s]. If a check is late by LATE_S, this process itself was
# delayed, and grants the child more time.
LOOK_S, LATE_S = 0.025, 0.05
# The kernel kills other processes before this one when memory is short (proc(5), oom_score_adj).
_OOM_SCORE = '/proc/self/oom_score_adj'
_OOM_LAST = '-900'


def stand_by(label, hung_s=None, memory=None, always=False):
    """Return in a child of this process, and in another one whenever that ends unexpectedly.

    Only with the argument ``--stand-by``; without it, this returns at once, and the process is not
    supervised. A process started by hand that ends before the first beat is not replaced: its
    reason is on the terminal. Call it when everything is loaded, and before there are threads. The
    calling process stays and does nothing else: it passes on the signals to end, and then ends like
    its child.
    When the child has ended, for any reason, each robot whose connection was passed to this process
    (:meth:`Undertaker.watch`) gets a zero at once; a hanging child is killed first, so that two
    processes never write at the same time. A child that ends by itself with status 0 is not
    replaced; this process still waits for a signal to end, since roslaunch would restart it. The
    child has its own session, so that it gets each signal once; it gets SIGTERM if the parent is
    killed.

    :param label: the name of the program, for the line that reports its end
    :param hung_s: maximum interval between calls of :meth:`Undertaker.beat` by the child [s], above
        which it hangs; None if it does not beat
    :param memory: :class:`Memory` that each child leaves to the next
    :param always: also without the argument
    :returns: :class:`mhri.graph.ros.undertaker.Undertaker`
    """
    by_hand = '--stand-by' not in sys.argv
    if by_hand and not always:
        return Undertaker()
    shared, (hears, speaks) = shared_memory(), socket.socketpair(
        socket.AF_UNIX, socket.SOCK_SEQPACKET)
    hears.setblocking(False)
    words = FinalFrames(shared, hears, _say)
    score = _oom_score(_OOM_LAST)
    # Wait for signals, do not handle them: a handler could miss a signal that arrives just before
    # the wait.
    signal.pthread_sigmask(signal.SIG_BLOCK, _ENDS + (signal.SIGCHLD,))
    sys.stdout.flush()
    sys.stderr.flush()
    waits = Waits(words)
    brief, worked = 0, False
    while True:
        parent, begun, watch = os.getpid(), time.monotonic(), hung_s and Watch(hung_s)
        child = _fork(label, waits)
        if not child:
            waits.close()
            words.close()
            hears.close()
            _oom_score(score)
            _be_child(parent)
            return Undertaker(shared, speaks, parent)
        status, asked, hung = _end_of(child, waits, watch)
        words.stop(time.monotonic())
        brief = 0 if time.monotonic() - begun > MIN_LIFE_S else brief + 1
        # After one process has worked, retry until another can start: the master may come back.
        worked = worked or not watch or watch.worked
        if by_hand and not worked and os.WIFEXITED(status):
            os._exit(os.WEXITSTATUS(status))  # the reason is on the user's terminal
        _follow('{}: process {}'.format(label, child), status, asked, hung, brief, waits, by_hand)
        # A process killed from outside does not prove anything about its memory.
        if memory is not None and (hung or status != signal.SIGKILL):
            memory.on_failure(not watch.worked if watch else bool(brief))


def _oom_score(score):
    """Set the kernel's OOM score adjustment of this process if permitted; return the old one."""
    try:
        with open(_OOM_SCORE, 'r+') as stream:
            before = stream.read()
            stream.seek(0)
            stream.write(score)
        return before
    except OSError:
        return '0'  # needs a rare privilege


def _follow(name, status, asked, hung, brief, waits, by_hand):
    """Return when another process may follow one that ended; end this one if none may.

    :param status: as from ``os.waitpid``
    :param brief: number of processes in a row that did not live long
    """
    killer = os.WTERMSIG(status) if os.WIFSIGNALED(status) else None
    code = os.WEXITSTATUS(status) if killer is None else 128 + killer
    if asked:
        os._exit(code)
    if not code:
        _say(name + ' has ended; it is not started again\n')
        if not by_hand:
            waits.signal(_ENDS, math.inf)
        os._exit(0)
    # Repeated failures are reported until the pauses have reached their maximum.
    if brief <= len(_PAUSES_S):
        _say('{} {}, another one takes over\n'.format(
            name, 'hung and was ended' if hung else 'failed with status {}'.format(code)
            if killer is None else 'was killed by signal {}'.format(killer)))
    if brief:
        _pause(waits, _PAUSES_S[min(brief, len(_PAUSES_S)) - 1])


def _pause(waits, time_s):
    """Wait; end this process on a signal to end meanwhile."""
    asked = waits.signal(_ENDS, time_s)
    if asked is not None:
        os._exit(128 + asked)


def _fork(label, waits):
    """Fork like ``os.fork()``; if the system cannot create a process, wait until it can.

    The cause of the last one's end, e.g. a shortage of memory, may last a moment longer.
    """
    reported = False
    while True:
        try:
            return os.fork()
        except OSError as error:
            if not reported:
                _say('{}: no process can be started yet: {}\n'.format(label, error))
            reported = True
            _pause(waits, LOOK_S)


class Waits:
    """Waits for signals, which are blocked; meanwhile robots get their outstanding zeros.

    :param words: :class:`FinalFrames`
    """

    def __init__(self, words):
        self.words = words
        mask = (ctypes.c_uint64 * 16)(sum(1 << number - 1 for number in _ENDS + (signal.SIGCHLD,)))
        # With signalfd(2), since Python's sigtimedwait cannot also wait for a socket.
        self._signals = ctypes.CDLL(None).signalfd(-1, mask, os.O_NONBLOCK | os.O_CLOEXEC)
        self._poll = select.poll()
        for end in (self._signals, words.hears):
            self._poll.register(end, select.POLLIN)

    def signal(self, signs, time_s):
        """Return the number of the first of some signals within a time [s], None on timeout."""
        until = time.monotonic() + time_s
        while True:
            try:
                number = int.from_bytes(os.read(self._signals, 128)[:4], sys.byteorder)
                if number in signs:
                    return number
            except BlockingIOError:
                pass  # no signal
            now = time.monotonic()
            self.words.tick(now)
            if now >= until:
                return None
            left_s = min(until - now, LOOK_S if self.words.busy() else math.inf)
            self._poll.poll(None if left_s == math.inf else math.ceil(1000 * left_s))

    def close(self):
        """Free the resources that a child does not need."""
        os.close(self._signals)


def _say(line):
    """Print a line on stderr if it is writable now: a terminal (Ctrl-S) must not block this."""
    try:
        if select.select([], [2], [], 0.0)[1]:
            os.write(2, line.encode())
    except OSError:
        pass  # stderr is closed


# Layout of a memory: the valid half, whether it was recalled; then the halves.
_HALF, _RECALLED, _KEPT_AT = range(3)


class Memory:
    """The state for the next process: JSON values by name; create it before :func:`stand_by`.

    Two halves hold the whole state in turn, and one byte selects the valid one: a process that is
    killed while writing leaves the previous state.

    :param size: maximum size of all values together [bytes]; beyond it the previous state stays
    :param fallback: {name: value after the state was discarded}
    """

    def __init__(self, size=131072, fallback=None):
        self._size, self._fallback = size, fallback or {}
        self._shared = mmap.mmap(-1, _KEPT_AT + 2 * size)
        self._lock = threading.Lock()
        self._recalls = 0

    def keep(self, name, value):
        """Store a value, replacing the old one; return whether there was room for it."""
        with self._lock:
            values = self._read()
            if name in values and values[name] == value:
                return True
            text = json.dumps({**values, name: value}).encode()
            if len(text) > self._size:
                return False
            half = 1 - self._shared[_HALF]
            begin = _KEPT_AT + half * self._size
            self._shared[begin:begin + self._size] = text.ljust(self._size, b' ')
            self._shared[_HALF] = half
            return True

    def on_failure(self, soon):
        """Handle, in the parent, the failure of a process; discard a state that may be the cause.

        :param soon: whether it never worked or, without beats, did not live long
        """
        # A process without a master has recalled nothing, so the state was not the cause.
        if self._shared[_RECALLED]:
            self._recalls = self._recalls + 1 if soon else 0
        self._shared[_RECALLED] = 0
        if self._recalls >= MAX_RECALLS:
            self._recalls = 0
            self._shared[:] = bytes(len(self._shared))
            for name, value in self._fallback.items():
                self.keep(name, value)
            _say('what was kept for the next process has ended several, and is forgotten\n')

    def recall(self, name, default=None):
        """Return a stored value, as decoded from JSON."""
        self._shared[_RECALLED] = 1
        with self._lock:
            return self._read().get(name, default)

    def _read(self):
        begin = _KEPT_AT + self._shared[_HALF] * self._size
        text = self._shared[begin:begin + self._size].rstrip(b' \0')
        return json.loads(text.decode()) if text else {}


class Watch:
    """Detects by its beats whether a program hangs.

    :param hung_s: time without a beat after which it hangs [s]
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, hung_s, clock=time.monotonic):
        self._hung_s = hung_s
        self._clock = clock
        self._looked_at = clock()
        self._due = self._looked_at + START_S
        self._beat = 0
        #: whether there was any beat
        self.worked = False

    def hung(self, beat, ends):
        """Return whether a beat is overdue; call it every :data:`LOOK_S`.

        :param beat: a number that changes with each beat, 0 before the first
        :param ends: whether the program is about to end, and need not beat any more
        """
        now = self._clock()
        if beat != self._beat:
            self._beat, self._due, self.worked = beat, now + self._hung_s, True
        elif now - self._looked_at > LOOK_S + LATE_S:
            self._due = max(self._due, now + self._hung_s)
        self._looked_at = now
        return not ends and now > self._due


def _be_child(parent):
    """Restore the signals of an ordinary process, and end with the parent."""
    os.setsid()
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDS + (signal.SIGCHLD,))
    if os.getppid() != parent:
        os._exit(1)


def _end_of(child, waits, watch):
    """Wait until the child ends; pass on signals to end, and kill it if it hangs.

    :param watch: :class:`Watch`, None without beats
    :returns: (its status, whether it was signalled to end, whether it hung)
    """
    asked = hung = False
    while True:
        number = waits.signal(_ENDS + (signal.SIGCHLD,), LOOK_S if watch else math.inf)
        if number in _ENDS:
            asked = True
            os.kill(child, number)
        elif number is not None:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                return status, asked, hung
        if watch and not hung and watch.hung(*waits.words.beats()):
            hung = True
            os.kill(child, signal.SIGKILL)
