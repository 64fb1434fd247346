# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The watch process: it stops all robots if any stop is pressed while the screen hangs.

A :class:`Child` of :mod:`mhri.screen.presenters.stop_watch`. Each message to it is a heartbeat with
the result of :func:`mhri.driving.gui.stop_button.stop_places`. It reports its actions as
``{"said": text}``, or why it cannot work as ``{"cannot": text}``. It ends with the screen.
"""
import contextlib
import select
import signal
import sys
import time

from mhri.devices.io.child import parent
from mhri.driving.gui.x_presses import XError, XPresses
from mhri.driving.ros.stop_line import StopLine
from mhri.screen.hang import PressWatch

# Caller id of the process, not the name of a node.
_CALLER = '/mhri_stop_watch'
_RETRY_S = 0.25
# Interval of reconnecting to a missing mux [s].
_LOOK_S = 2.0
STOPPED = 'a stop was pressed while this screen hung: all robots were stopped without it'
UNCONFIRMED = ('a stop was pressed while this screen hung, NOT CONFIRMED: the drive service does '
               'not answer; asking again')


class StopWatchProcess:
    """The watch, on a single thread.

    :param screen: :class:`mhri.devices.io.child.Channel`
    :param presses: :class:`mhri.driving.gui.x_presses.XPresses`
    :param line: :class:`mhri.driving.ros.stop_line.StopLine`
    """

    def __init__(self, screen, presses, line):
        self._screen, self._presses, self._line = screen, presses, line
        self._watch = PressWatch(time.monotonic())
        self._places = {}
        self._asking = self._reported = False
        self._try_at = 0.0

    def run(self):
        """Run until the screen is gone.

        :raises XError: the X server is gone
        """
        # Beats first: after a delay of this process, the screen must not seem to hang.
        while self._read_beats():
            if self._presses.stops(self._places):
                self._watch.press(time.monotonic())
            if self._watch.take(time.monotonic()):
                self._asking, self._reported, self._try_at = True, False, 0.0
            if time.monotonic() >= self._try_at:
                self._try()
            self._wait()

    def _read_beats(self):
        """Handle the beats; return whether the screen is still there."""
        try:
            beats = self._screen.messages()
        except (EOFError, OSError):
            return False
        for _ in beats:
            self._watch.beat(time.monotonic())
        if beats:
            self._places = {int(window): places for window, places in beats[-1].items()}
        return True

    def _try(self):
        """Stop if a press is pending; else keep the connection to the drive service open."""
        if self._asking:
            self._asking = not self._line.call(True)[0]
            if not self._asking or not self._reported:
                self._reported = True
                send(self._screen, said=UNCONFIRMED if self._asking else STOPPED)
        else:
            self._line.connect()
        self._try_at = time.monotonic() + (_RETRY_S if self._asking else _LOOK_S)

    def _wait(self):
        """Wait for a beat, a press, or the next attempt."""
        now = time.monotonic()
        waits = [self._watch.wait_s(now)]
        poll = select.poll()
        poll.register(self._screen, select.POLLIN)
        poll.register(self._presses, select.POLLIN)
        if self._line.fileno() is not None:
            # The connection is readable only when closed by the other side.
            poll.register(self._line, select.POLLIN)
        if self._asking or self._line.fileno() is None:
            waits.append(max(0.0, self._try_at - now))
        waits = [wait_s for wait_s in waits if wait_s is not None]
        ready = dict(poll.poll(1000.0 * min(waits) + 1.0 if waits else None))
        if self._line.fileno() in ready:
            self._line.close()


def send(screen, **words):
    """Send a message to the screen; ignore a screen that has ended."""
    try:
        screen.send(words)
    except OSError:
        pass


def main():
    """Watch until the screen ends; the only argument is the master's URI."""
    # Ctrl-C reaches the whole process group, but this process must end after the screen.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    screen = parent()
    try:
        StopWatchProcess(screen, XPresses(), StopLine(_CALLER, sys.argv[1])).run()
    except XError as error:
        send(screen, cannot=str(error))
        # Let the screen end this process, else sending a beat might fail before the screen has
        # read the reason.
        with contextlib.suppress(EOFError, OSError):
            while True:
                screen.messages(None)
