# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one device here that is written to: tones through SDL's mixer (pygame), in a child process.

Loading pygame takes 0.3 s, opening a device of a busy sound server may take seconds, and where
there is none ALSA writes a page to the terminal: nothing for a process that drives robots.
"""
import json
import logging
import os
import select
import subprocess
import sys
import threading

from mhri.devices.io import child
from mhri.devices.io.reader import DeviceAbsent
from mhri.events.tones import samples, TONES, urgency

RATE_HZ = 22050
_BUFFER = 512
# The device is held only while it sounds: another program may want it, or another be plugged in.
_HOLD_S = 5.0
_RESTART_S = 10.0
_LOG = logging.getLogger(__name__)


class Speaker:
    """Plays tones; every method returns at once. The first tone starts the child at the latest.

    :param on_absent: called with a sentence, on a thread of its own, the first time that no tone
        can be heard; later tones are tried all the same
    """

    def __init__(self, on_absent=lambda text: None):
        self._on_absent = on_absent
        self._lock = threading.Lock()
        self._started = False
        self._process = None
        self._waiting = ''
        self._told = False
        self._closed = threading.Event()

    def start(self):
        """Start the child in the background, where that has not been done."""
        with self._lock:
            if self._started or self._closed.is_set():
                return self
            self._started = True
        threading.Thread(target=self._run, name='speaker', daemon=True).start()
        return self

    def play(self, tone):
        """Play one of the tones; a less urgent one is left out while another is heard."""
        self.start()
        with self._lock:
            if self._process is None:
                self._waiting = max(self._waiting, tone, key=urgency)
                return
            self._send(tone)

    def _send(self, tone):
        """Tell the child; the lock is held."""
        try:
            os.write(self._process.stdin.fileno(), tone.encode() + b'\n')
        except OSError as error:  # it has ended, or hangs with a full pipe
            _LOG.debug('not played: %s', error)

    def close(self):
        """End the child."""
        self._closed.set()
        with self._lock:
            if self._process is not None:
                self._process.kill()

    def _run(self):
        """Keep the child running; one that ends by itself knows that nothing can be done."""
        while not self._closed.is_set():
            try:
                if self._serve() == 0:
                    return
            except OSError as error:
                self._tell('the player cannot be started: {}'.format(error))
            self._closed.wait(_RESTART_S)

    def _serve(self):
        """Start a child and hear what it says; return its exit status."""
        process = subprocess.Popen(
            child.command('mhri.events.io.speaker'), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL)
        os.set_blocking(process.stdin.fileno(), False)
        with self._lock:
            self._process = process
            if self._waiting:
                self._send(self._waiting)
                self._waiting = ''
            if self._closed.is_set():
                process.kill()
        for line in process.stdout:
            absent = json.loads(line.decode()).get('absent')
            if absent:
                self._tell(absent)
        with self._lock:
            self._process = None
            process.stdin.close()
        process.stdout.close()
        return process.wait()

    def _tell(self, problem):
        """Say once that there is no sound."""
        if not self._told and not self._closed.is_set():
            self._told = True
            self._on_absent(problem)


class Player:
    """The mixer in the child: opens the device when a tone is to be heard, and gives it back.

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
        """Whether the device is held."""
        return self._channel is not None

    @property
    def is_busy(self):
        """Whether a tone is being heard."""
        return self.is_open and self._channel.get_busy()

    def open(self):
        """Open the device; does nothing if it is open.

        :raises DeviceAbsent: there is none, or it cannot be used
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
        """Play a tone, unless one that is as urgent is being heard.

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
        """Give the device back."""
        self._channel = None
        self._mixer.quit()


def _say(**words):
    """Tell the parent."""
    sys.stdout.write(json.dumps(words) + '\n')
    sys.stdout.flush()


def _follow(player):
    """Play what comes from the standard input, one tone a line, until it ends."""
    held = b''
    while True:
        if not select.select([0], [], [], _HOLD_S)[0]:
            if player.is_open and not player.is_busy:
                player.close()
            continue
        data = os.read(0, 4096)
        if not data:
            return
        *lines, held = (held + data).split(b'\n')
        # What has piled up is one tone: the most urgent.
        wanted = [line.decode('ascii', 'replace') for line in lines]
        for tone in sorted(set(wanted) & set(TONES), key=urgency)[-1:]:
            try:
                player.play(tone)
            except DeviceAbsent as problem:
                _say(absent=str(problem))


def main():
    """Be the child: see :class:`Speaker`; ends with 0 if no try is worth another."""
    try:
        player = Player()
    except DeviceAbsent as problem:
        _say(absent=str(problem))
        return
    try:
        player.open()
        _say(device=True)
    except DeviceAbsent as problem:
        _say(absent=str(problem))
    _follow(player)
    # Not through what SDL does at the end: a device that hangs would keep it.
    os._exit(0)
