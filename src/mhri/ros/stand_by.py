# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps a program's next process ready for when this one is killed: nothing needs loading again.

Loading Python and rospy takes a third of a second on an idle processor, and seconds on a busy one;
driven robots wait for their zero meanwhile.
"""
import ctypes
import os
import signal
import sys
import time

_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# Of prctl(2): the signal that this process gets when its parent has ended.
_PR_SET_PDEATHSIG = 1
# A process killed so soon after its start would be killed again [s].
LEAST_LIFE_S = 2.0


def stand_by(label):
    """Return in a child of this process, and in another one whenever a signal kills that.

    Call it when everything is loaded, and before there are threads. The calling process stays and
    does nothing else: it passes on the signals to end, and ends as its child ended. The child has
    its own session, so that it gets each signal once; it is told to end (SIGTERM) if the parent is
    killed.

    :param label: the name of the program, for the line that says it was killed
    """
    # Wait for signals, do not handle them: a handler could miss one that comes just before the
    # wait.
    signal.pthread_sigmask(signal.SIG_BLOCK, _ENDS + (signal.SIGCHLD,))
    while True:
        sys.stdout.flush()
        sys.stderr.flush()
        parent, begun = os.getpid(), time.monotonic()
        child = os.fork()
        if not child:
            _be_child(parent)
            return
        status, asked = _end_of(child)
        if not os.WIFSIGNALED(status):
            os._exit(os.WEXITSTATUS(status))
        killer = os.WTERMSIG(status)
        if asked or time.monotonic() - begun < LEAST_LIFE_S:
            os._exit(128 + killer)
        print('{}: process {} was killed by signal {}, another one takes over'.format(
            label, child, killer), file=sys.stderr)


def _be_child(parent):
    """Restore the signals of an ordinary process, and end with the parent."""
    os.setsid()
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDS + (signal.SIGCHLD,))
    if os.getppid() != parent:
        os._exit(1)


def _end_of(child):
    """Pass on signals to end until the child ends; return (its status, whether it was asked to)."""
    asked = False
    while True:
        number = signal.sigwait(_ENDS + (signal.SIGCHLD,))
        if number != signal.SIGCHLD:
            asked = True
            os.kill(child, number)
            continue
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status, asked
