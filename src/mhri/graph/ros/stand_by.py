# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replaces a program's process when it is killed or hangs: the next one is loaded already.

Loading Python and rospy takes a third of a second on an idle processor, and seconds on a busy one;
driven robots wait for their zero meanwhile. And roslaunch, which restarts a node that has ended,
does nothing about one that hangs.
"""
import ctypes
import json
import math
import mmap
import os
import select
import signal
import sys
import threading
import time

from mhri.base.pulse import SLEPT_S

_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# Of prctl(2): the signal that this process gets when its parent has ended.
_PR_SET_PDEATHSIG = 1
# A process killed so soon after its start would be killed again [s].
LEAST_LIFE_S = 2.0
# One that beats must do so this often [s]; the first beat may take longer: at a load of 40, a start
# takes 5 s at most.
HUNG_S = 1.8
START_S = 20.0
_LOOK_S = 0.1
# What the child says.
_WORKS, _ENDS_ITSELF = b'.', b'e'


def stand_by(label, beats=False):
    """Return in a child of this process, and in another one whenever that is killed or hangs.

    Only with the argument ``--stand-by``; else it returns at once, and nobody looks after this
    process. Call it when everything is loaded, and before there are threads. The calling process
    stays and does nothing else: it passes on the signals to end, and ends as its child ended. The
    child has its own session, so that it gets each signal once; it is told to end (SIGTERM) if the
    parent is killed.

    :param label: the name of the program, for the line that says it was killed
    :param beats: whether the child calls the returned :class:`Beat`, and hangs if it does not
    """
    if '--stand-by' not in sys.argv:
        return Beat()
    # Wait for signals, do not handle them: a handler could miss one that comes just before the
    # wait.
    signal.pthread_sigmask(signal.SIG_BLOCK, _ENDS + (signal.SIGCHLD,))
    sys.stdout.flush()
    sys.stderr.flush()
    while True:
        parent, begun = os.getpid(), time.monotonic()
        hears, speaks = os.pipe()
        os.set_blocking(hears, False)
        os.set_blocking(speaks, False)
        child = _fork(label)
        if not child:
            os.close(hears)
            _be_child(parent)
            return Beat(speaks)
        os.close(speaks)
        status, asked, hung = _end_of(child, Watch(hears) if beats else None)
        os.close(hears)
        if not os.WIFSIGNALED(status):
            os._exit(os.WEXITSTATUS(status))
        killer = os.WTERMSIG(status)
        if asked or time.monotonic() - begun < LEAST_LIFE_S:
            os._exit(128 + killer)
        _say('{}: process {} {}, another one takes over\n'.format(
            label, child, 'hung and was ended' if hung else 'was killed by signal {}'.format(
                killer)))


def _fork(label):
    """Return as ``os.fork()`` does; where there is no room for a process, wait until there is some.

    What killed the last one, such as a computer short of memory, may last a moment longer.
    """
    told = False
    while True:
        try:
            return os.fork()
        except OSError as error:
            if not told:
                _say('{}: no process can be started yet: {}\n'.format(label, error))
            told = True
            asked = _signal_soon(_ENDS)
            if asked is not None:
                os._exit(128 + asked)


def _signal_soon(signs):
    """Return the number of the signal that comes within :data:`_LOOK_S`, None for none."""
    info = signal.sigtimedwait(signs, _LOOK_S)
    # Python returns what happens to be in its memory (seen with 3.11) where the time was over while
    # this process was stopped, by Ctrl-Z or with a computer that slept.
    return info.si_signo if info is not None and info.si_signo in signs else None


def _say(line):
    """Print a line on stderr, if that takes one now: nobody may wait for a terminal (Ctrl-S)."""
    try:
        if select.select([], [2], [], 0.0)[1]:
            os.write(2, line.encode())
    except OSError:
        pass  # it is closed


class Beat:
    """The child's sign of life, from any thread; without a parent that listens it does nothing.

    :param pipe: leads to the parent, and does not block
    """

    def __init__(self, pipe=None):
        self._pipe = pipe

    def __call__(self, word=_WORKS):
        """Say that the program works."""
        if self._pipe is not None:
            try:
                os.write(self._pipe, word)
            except OSError:
                pass  # the parent has ended, or hangs itself

    def end(self):
        """Say that the program is about to end by itself, and beats no more."""
        self(_ENDS_ITSELF)


class Memory:
    """What the next process has to know, too: JSON values by name; make it before :func:`stand_by`.

    Each of two halves holds all of it in turn, and one byte says which counts: a process that is
    killed while it writes leaves what was kept before.

    :param size: most bytes of all values together; beyond that what was kept before stays
    """

    def __init__(self, size=131072):
        self._size = size
        self._shared = mmap.mmap(-1, 1 + 2 * size)
        self._lock = threading.Lock()

    def keep(self, name, value):
        """Keep a value instead of the one before; return whether there was room for it."""
        with self._lock:
            values = self._read()
            if name in values and values[name] == value:
                return True
            text = json.dumps({**values, name: value}).encode()
            if len(text) > self._size:
                return False
            half = 1 - self._shared[0]
            self._shared[1 + half * self._size:1 + (half + 1) * self._size] = text.ljust(
                self._size, b' ')
            self._shared[0] = half
            return True

    def recall(self, name, default=None):
        """Return what was kept, as JSON gives it back."""
        with self._lock:
            return self._read().get(name, default)

    def _read(self):
        begin = 1 + self._shared[0] * self._size
        text = self._shared[begin:begin + self._size].rstrip(b' \0')
        return json.loads(text.decode()) if text else {}


class Watch:
    """The parent's ear for the beats.

    :param pipe: where they arrive; does not block
    :param clock: function returning seconds that never go back
    """

    def __init__(self, pipe, clock=time.monotonic):
        self._pipe = pipe
        self._clock = clock
        self._looked_at = clock()
        self._due = self._looked_at + START_S

    def hung(self):
        """Tell whether a beat is overdue; ask every 0.1 s. A beat after the last word is old."""
        now = self._clock()
        if now - self._looked_at > SLEPT_S:
            self._due = max(self._due, now + HUNG_S)
        self._looked_at = now
        try:
            said = os.read(self._pipe, 65536)
            if self._due < math.inf:
                self._due = math.inf if _ENDS_ITSELF in said else now + HUNG_S
        except BlockingIOError:
            pass  # nothing yet
        return now > self._due


def _be_child(parent):
    """Restore the signals of an ordinary process, and end with the parent."""
    os.setsid()
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDS + (signal.SIGCHLD,))
    if os.getppid() != parent:
        os._exit(1)


def _end_of(child, watch):
    """Wait until the child ends; pass on signals to end, and kill it if it hangs.

    :param watch: :class:`Watch`, None: without beats
    :returns: (its status, whether it was asked to end, whether it hung)
    """
    asked = hung = False
    while True:
        watching = watch is not None and not asked and not hung
        signs = _ENDS + (signal.SIGCHLD,)
        number = _signal_soon(signs) if watching else signal.sigwaitinfo(signs).si_signo
        if number in _ENDS:
            asked = True
            os.kill(child, number)
        elif number is not None:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                return status, asked, hung
        elif watch.hung():
            hung = True
            os.kill(child, signal.SIGKILL)
