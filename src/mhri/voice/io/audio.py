# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sound in blocks of 20 ms: from a microphone, a WAV file, or a raw stream.

All of it has the form of :mod:`mhri.voice.sound`; a microphone that has another rate is
resampled by PortAudio's ALSA plug, a WAV file has to be converted
(``sox in.wav -r 16000 -c 1 -b 16 out.wav``).
"""
import fcntl
import json
import os
import select
import stat
import subprocess
import time
import wave

from mhri.devices.io import child
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.voice.sound import BLOCK_BYTES, BLOCK_S, RATE_HZ

# A microphone that gives nothing for this long is gone; ALSA does not always say so.
_SILENT_S = 2.0
_OPEN_S = 10.0
# What is said while an utterance is recognised waits here: 4 s of sound.
_PIPE_BYTES = 1 << 17
_SET_PIPE_SIZE = 1031  # F_SETPIPE_SZ of Linux; Python has it from 3.10 on


class Microphone:
    """A microphone by PortAudio, see :mod:`mhri.voice.io.microphone`.

    :param wanted: part of the device's name, in any case; '' for the system's default
    """

    def __init__(self, wanted=''):
        self._wanted = wanted
        self._process = None
        self._held = b''
        self._last = 0.0

    def open(self):
        """Open it; return its name.

        :raises DeviceAbsent: there is none, or it cannot be opened
        """
        self._held = b''
        try:
            self._process = subprocess.Popen(
                child.command('mhri.voice.io.microphone', self._wanted),
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        except OSError as error:
            raise DeviceAbsent('the driver of the microphone cannot be started: {}'.format(error))
        fcntl.fcntl(self._process.stdout, _SET_PIPE_SIZE, _PIPE_BYTES)
        deadline = time.monotonic() + _OPEN_S
        try:
            while b'\n' not in self._held:
                left_s = deadline - time.monotonic()
                if left_s <= 0.0:
                    raise DeviceAbsent('the driver of the microphone does not answer')
                self._take(left_s)
        except DeviceLost:
            self.close()
            raise DeviceAbsent('the driver of the microphone failed')
        except DeviceAbsent:
            self.close()
            raise
        line, self._held = self._held.split(b'\n', 1)
        answer = json.loads(line.decode())
        if 'absent' in answer:
            self.close()
            raise DeviceAbsent(answer['absent'])
        self._last = time.monotonic()
        return answer['device']

    def _take(self, timeout_s):
        """Read what comes within a time.

        :raises DeviceLost: nothing more will come
        """
        stream = self._process.stdout
        if not select.select([stream], [], [], timeout_s)[0]:
            return
        data = os.read(stream.fileno(), BLOCK_BYTES)
        if not data:
            raise DeviceLost('the microphone is gone: was it pulled out?')
        self._held += data
        self._last = time.monotonic()

    def read(self, timeout_s):
        """Return the next block, or b'' if too little came in time.

        :raises DeviceLost: it was pulled out
        """
        if len(self._held) < BLOCK_BYTES:
            self._take(timeout_s)
            if time.monotonic() - self._last > _SILENT_S:
                raise DeviceLost('the microphone gives no sound any longer: was it pulled out?')
        if len(self._held) < BLOCK_BYTES:
            return b''
        block, self._held = self._held[:BLOCK_BYTES], self._held[BLOCK_BYTES:]
        return block

    def waits(self):
        """Tell whether more of it waits to be read."""
        return len(self._held) >= BLOCK_BYTES or bool(
            select.select([self._process.stdout], [], [], 0.0)[0])

    def close(self):
        """Give it back; does nothing if it is not open."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            process.stdout.close()


class WavFile:
    """A recording, played once at the pace it was spoken at; silence follows.

    Its end does not count as a lost device: found again, it would drive the robots again.

    :param paced: False: as fast as it is read
    """

    def __init__(self, path, paced=True):
        self._path = path
        self._paced = paced
        self._file = None
        self._due = 0.0

    def open(self):
        """Open it; return its name.

        :raises DeviceAbsent: it cannot be read, or has another form
        """
        try:
            self._file = wave.open(self._path, 'rb')
        except (OSError, EOFError, wave.Error) as error:
            raise DeviceAbsent('cannot read the recording {}: {}'.format(self._path, error))
        form = self._file.getframerate(), self._file.getnchannels(), self._file.getsampwidth()
        if form != (RATE_HZ, 1, 2):
            self.close()
            raise DeviceAbsent('{} has {} Hz, {} channels, {} bytes a sample; convert it: sox {} '
                               '-r 16000 -c 1 -b 16 out.wav'.format(self._path, *form, self._path))
        return 'the recording ' + self._path

    def read(self, timeout_s):
        """Return the next block, or b'' if it is not time for it."""
        now = time.monotonic()
        # The first block is due when it is asked for: loading the recogniser takes a while.
        self._due = self._due or now
        wait_s = self._due - now
        if self._paced:
            time.sleep(max(0.0, min(wait_s, timeout_s)))
            if wait_s > timeout_s:
                return b''
        self._due += BLOCK_S
        return self._file.readframes(BLOCK_BYTES // 2).ljust(BLOCK_BYTES, b'\0')

    def waits(self):
        """Tell whether the next block should have been read already."""
        return time.monotonic() > self._due

    def close(self):
        """Close it; does nothing if it is not open."""
        self._due = 0.0
        if self._file is not None:
            self._file.close()
            self._file = None


class RawStream:
    """Raw sound from a FIFO, a character device, or the standard input ('-').

    It exists while somebody writes to it, and is lost when the last writer closes it.
    """

    def __init__(self, path):
        self._path = path
        self._name = 'the standard input' if path == '-' else 'the sound stream ' + path
        self._fd = None
        self._held = b''

    def open(self):
        """Open it; return its name.

        :raises DeviceAbsent: it is not there, or nobody writes to it
        """
        self._held = b''
        try:
            self._fd = os.dup(0) if self._path == '-' else os.open(
                self._path, os.O_RDONLY | os.O_NONBLOCK)
            kind = os.fstat(self._fd).st_mode
            if not (stat.S_ISFIFO(kind) or stat.S_ISCHR(kind) or stat.S_ISSOCK(kind)):
                raise DeviceAbsent('{} is no stream: make one with mkfifo, or name a .wav '
                                   'file'.format(self._path))
            # A FIFO that never had a writer does not count as ready, but has ended all the same.
            if self._path != '-' or self._ready(0.0):
                self._take()
        except OSError as error:
            self.close()
            raise DeviceAbsent('cannot read {}: {}; make one with mkfifo'.format(
                self._name, error.strerror))
        except DeviceLost:
            self.close()
            raise DeviceAbsent('nobody writes to {}'.format(self._name))
        except DeviceAbsent:
            self.close()
            raise
        return self._name

    def _ready(self, timeout_s):
        return bool(select.select([self._fd], [], [], timeout_s)[0])

    def _take(self):
        """Read what is available, at most up to the end of a block.

        :raises DeviceLost: it has ended
        """
        try:
            data = os.read(self._fd, BLOCK_BYTES - len(self._held))
        except BlockingIOError:
            return
        if not data:
            raise DeviceLost('nobody writes to {} any longer'.format(self._name))
        self._held += data

    def read(self, timeout_s):
        """Return the next block, or b'' if too little came in time.

        :raises DeviceLost: it has ended, or cannot be read
        """
        if len(self._held) < BLOCK_BYTES:
            if not self._ready(timeout_s):
                return b''
            try:
                self._take()
            except OSError as error:
                raise DeviceLost('{}: {}'.format(self._name, error.strerror))
        if len(self._held) < BLOCK_BYTES:
            return b''
        block, self._held = self._held, b''
        return block

    def waits(self):
        """Tell whether more of it waits to be read."""
        return self._ready(0.0)

    def close(self):
        """Close it; does nothing if it is not open."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None


def open_source(text):
    """Return the source that a text describes, not open yet.

    '' or ``microphone`` is the default microphone, ``microphone:<part of its name>`` another,
    ``-`` the standard input, ``<path>.wav`` a recording, any other path a raw stream.
    """
    kind, _, name = text.partition(':')
    if not text or kind == 'microphone':
        return Microphone(name)
    if text.endswith('.wav'):
        return WavFile(text)
    return RawStream(text)
