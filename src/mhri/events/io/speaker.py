# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plays tones through SDL's mixer (pygame), in a child process.

Loading pygame takes 0.3 s, opening the device of a busy sound server may take seconds, and without
a device ALSA fills the terminal: too much for a process that drives robots.
"""
import logging
import os
import threading

from mhri.devices.io.child import Child, parent
from mhri.devices.io.reader import DeviceAbsent
from mhri.events.tones import samples, TONES, urgency

RATE_HZ = 22050
_BUFFER = 512
# The device is closed after this idle time, as other programs may need it or it may be replaced.
_HOLD_S = 5.0
_RESTART_S = 10.0
_LOG = logging.getLogger(__name__)


class Speaker:
    """Plays tones; every method returns at once. The first tone starts the child if needed.

    :param on_absent: called once with a sentence, on its own thread, at the first failure to play
        a tone; later tones are still attempted
    """

    def __init__(self, on_absent=lambda text: None):
        self._on_absent = on_absent
        self._lock = threading.Lock()
        self._started = False
        self._child = None
        self._waiting = ''
        self._reported = False
        self._closed = threading.Event()

    def start(self):
        """Start the child in the background, unless already started."""
        with self._lock:
            if self._started or self._closed.is_set():
                return self
            self._started = True
        threading.Thread(target=self._run, name='speaker', daemon=True).start()
        return self

    def play(self, tone):
        """Play a tone; a less urgent tone is dropped while another one is playing."""
        self.start()
        with self._lock:
            if self._child is None:
                self._waiting = max(self._waiting, tone, key=urgency)
                return
            self._send(tone)

    def _send(self, tone):
        """Send a tone to the child (under the lock)."""
        try:
            self._child.send(tone)
        except OSError as error:  # the child has ended, or hangs
            _LOG.debug('not played: %s', error)

    def close(self):
        """End the child."""
        self._closed.set()
        with self._lock:
            if self._child is not None:
                self._child.process.kill()

    def _run(self):
        """Restart the child until it exits with 0, which means that it can never play."""
        while not self._closed.is_set():
            try:
                if self._serve() == 0:
                    return
            except OSError as error:
                self._report('the player cannot be started: {}'.format(error))
            self._closed.wait(_RESTART_S)

    def _serve(self):
        """Start a child and read its messages; return its exit status."""
        child = Child('mhri.events.io.speaker')
        with self._lock:
            self._child = child
            if self._waiting:
                self._send(self._waiting)
                self._waiting = ''
            if self._closed.is_set():
                child.process.kill()
        try:
            while True:
                for absent in child.messages(None):
                    self._report(absent)
        except EOFError:
            with self._lock:
                self._child = None
            return child.end(_RESTART_S)

    def _report(self, problem):
        """Report the first problem with sound."""
        if not self._reported and not self._closed.is_set():
            self._reported = True
            self._on_absent(problem)


class Player:
    """The mixer in the child, which opens the device for a tone and closes it later.

    :raises DeviceAbsent: pygame is missing
    """

    def __init__(self):
        os.environ['PYGAME_HIDE_SUPPORT_PROMPT'] = '1'
        try:
            from pygame import error, mixer
        except ImportError as problem:
            raise DeviceAbsent('pygame cannot be loaded ({}): apt install python3-pygame'.format(
                problem))
        self._mixer, self._error = mixer, error
        self._sounds = {}
        self._channel = None
        self._playing = ''

    @property
    def is_open(self):
        """Whether the device is open."""
        return self._channel is not None

    @property
    def is_busy(self):
        """Whether a tone is being played."""
        return self.is_open and self._channel.get_busy()

    def open(self):
        """Open the device, unless already open.

        :raises DeviceAbsent: no device is available or usable
        """
        if self.is_open:
            return
        try:
            self._mixer.init(RATE_HZ, -16, 1, _BUFFER)
        except self._error as error:
            raise DeviceAbsent('no sound device can be opened: {}'.format(error))
        rate_hz, bits, channels = self._mixer.get_init()
        if bits != -16:
            self._mixer.quit()
            raise DeviceAbsent('the sound device takes no 16 bit samples')
        self._sounds = {tone: self._mixer.Sound(buffer=samples(tone, rate_hz, channels).tobytes())
                        for tone in TONES}
        self._channel = self._mixer.Channel(0)

    def play(self, tone):
        """Play a tone, unless one of at least the same urgency is playing.

        :raises DeviceAbsent: see :meth:`open`
        """
        if tone not in TONES:
            return
        self.open()
        if self.is_busy and urgency(self._playing) >= urgency(tone):
            return
        self._playing = tone
        self._channel.play(self._sounds[tone])

    def close(self):
        """Close the device."""
        self._channel = None
        self._mixer.quit()


def _follow(player, screen):
    """Play the requested tones until the parent ends."""
    while True:
        wanted = screen.messages(_HOLD_S)
        if not wanted and player.is_open and not player.is_busy:
            player.close()
        # Of queued tones only the most urgent one is played.
        for tone in sorted(set(wanted) & set(TONES), key=urgency)[-1:]:
            try:
                player.play(tone)
            except DeviceAbsent as problem:
                screen.send(str(problem))


def main():
    """Run the child of :class:`Speaker`; exit with 0 if a restart is useless."""
    screen = parent()
    try:
        player = Player()
    except DeviceAbsent as problem:
        screen.send(str(problem))
        return
    try:
        try:
            player.open()
        except DeviceAbsent as problem:
            screen.send(str(problem))
        _follow(player, screen)
    except (EOFError, OSError):
        pass  # the parent has ended
    # Skip SDL's clean-up: it could hang with the device.
    os._exit(0)
