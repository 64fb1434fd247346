# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The process beside the screen: it stops all robots if STOP is pressed while the screen hangs.

Its standard input is a socket from :mod:`mhri.screen.presenters.stop_watch`. Each packet is a beat:
:func:`mhri.driving.gui.stop_button.stop_places` as JSON. It answers in packets of JSON what it did,
 ``{"said": text}``, or why it can do nothing, ``{"cannot": text}``. It ends with the screen.
"""
import contextlib
import json
import select
import signal
import socket
import sys
import time

from mhri.driving.gui.x_presses import XError, XPresses
from mhri.driving.ros.stop_line import StopLine
from mhri.screen.hang import PressWatch

# Its caller id; not a node's name.
_CALLER = '/mhri_stop_watch'
_PACKET_BYTES = 1 << 18
_RETRY_S = 0.25
# How often to look for a missing mux.
_LOOK_S = 2.0
STOPPED = 'STOP ALL was pressed while this screen hung: the robots were stopped without it'
UNCONFIRMED = ('STOP ALL was pressed while this screen hung, NOT CONFIRMED: the drive service does '
               'not answer; asking again')


class StopWatchProcess:
    """All of it, on one thread.

    :param screen: the socket
    :param presses: :class:`mhri.driving.gui.x_presses.XPresses`
    :param line: :class:`mhri.driving.ros.stop_line.StopLine`
    """

    def __init__(self, screen, presses, line):
        self._screen, self._presses, self._line = screen, presses, line
        self._watch = PressWatch(time.monotonic())
        self._places = {}
        self._asking = self._told = False
        self._try_at = 0.0

    def run(self):
        """Run until the screen has gone.

        :raises XError: the X server has gone
        """
        # Beats first: a process that had to wait must not mistake the screen for hung.
        while self._hear():
            if self._presses.stops(self._places):
                self._watch.press(time.monotonic())
            if self._watch.take(time.monotonic()):
                self._asking, self._told, self._try_at = True, False, 0.0
            if time.monotonic() >= self._try_at:
                self._try()
            self._wait()

    def _hear(self):
        """Take in the beats; return whether the screen is still there."""
        packet = None
        try:
            while True:
                packet = self._screen.recv(_PACKET_BYTES)
                if not packet:
                    return False
                self._watch.beat(time.monotonic())
        except BlockingIOError:
            if packet:
                self._places = {int(window): places for window, places in
                                json.loads(packet.decode()).items()}
            return True
        except OSError:
            return False

    def _try(self):
        """Stop if a press asks for it; else keep the line up for that moment."""
        if self._asking:
            self._asking = not self._line.call(True)[0]
            if not self._asking or not self._told:
                self._told = True
                tell(self._screen, said=UNCONFIRMED if self._asking else STOPPED)
        else:
            self._line.connect()
        self._try_at = time.monotonic() + (_RETRY_S if self._asking else _LOOK_S)

    def _wait(self):
        """Wait for a beat, a press, or the time to do something."""
        now = time.monotonic()
        waits = [self._watch.wait_s(now)]
        poll = select.poll()
        poll.register(self._screen, select.POLLIN)
        poll.register(self._presses, select.POLLIN)
        if self._line.fileno() is not None:
            # The only news from there is its end.
            poll.register(self._line, select.POLLIN)
        if self._asking or self._line.fileno() is None:
            waits.append(max(0.0, self._try_at - now))
        waits = [wait_s for wait_s in waits if wait_s is not None]
        ready = dict(poll.poll(1000.0 * min(waits) + 1.0 if waits else None))
        if self._line.fileno() in ready:
            self._line.close()


def tell(screen, **words):
    """Send a packet to the screen; do not wait if it no longer listens."""
    try:
        screen.send(json.dumps(words).encode())
    except OSError:
        pass


def main():
    """Watch until the screen ends; the master's URI is the one argument."""
    # Ctrl-C in a terminal goes to the whole group; this process ends when the screen has.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    screen = socket.socket(fileno=sys.stdin.fileno())
    screen.setblocking(False)
    try:
        StopWatchProcess(screen, XPresses(), StopLine(_CALLER, sys.argv[1])).run()
    except XError as error:
        tell(screen, cannot=str(error))
        # Ending with unread beats would destroy that message: the screen ends this process.
        screen.setblocking(True)
        with contextlib.suppress(ConnectionError):
            while screen.recv(_PACKET_BYTES):
                pass
