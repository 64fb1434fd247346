# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sound in blocks of 20 ms: from a microphone, a WAV file, or a raw stream.

All sources have the form of :mod:`mhri.voice.sound`; a microphone with another rate is resampled by
PortAudio's ALSA plug, a WAV file has to be converted (``sox in.wav -r 16000 -c 1 -b 16 out.wav``).
"""
import json
import os
import select
import stat
import time
import wave

from mhri.devices.io.child import Child
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.voice.sound import BLOCK_BYTES, BLOCK_S, RATE_HZ

# A microphone that is silent for this long is gone, which ALSA does not always report [s].
_SILENT_S = 2.0
_OPEN_S = 10.0


class Microphone:
    """A microphone by PortAudio, see :mod:`mhri.voice.io.microphone`.

    :param wanted: part of the device's name, in any case; '' for the system's default
    """

    def __init__(self, wanted=''):
        self._wanted = wanted
        self._child = None
        self._last = 0.0

    def open(self):
        """Open the microphone; return its name.

        :raises DeviceAbsent: no microphone is connected, or it cannot be opened
        """
        try:
            self._child = Child('mhri.voice.io.microphone', self._wanted)
        except OSError as error:
            raise DeviceAbsent('the driver of the microphone cannot be started: {}'.format(error))
        try:
            answer = self._child.packet(_OPEN_S)
        except EOFError:
            self.close()
            raise DeviceAbsent('the driver of the microphone failed')
        if not answer:
            self.close()
            raise DeviceAbsent('the driver of the microphone does not answer')
        answer = json.loads(answer.decode())
        if 'absent' in answer:
            self.close()
            raise DeviceAbsent(answer['absent'])
        self._last = time.monotonic()
        return answer['device']

    def read(self, timeout_s):
        """Return the next block, or b'' if none was received in time.

        :raises DeviceLost: the microphone is gone
        """
        try:
            block = self._child.packet(timeout_s)
        except EOFError:
            raise DeviceLost('the microphone is gone: was it pulled out?')
        if block:
            self._last = time.monotonic()
        elif time.monotonic() - self._last > _SILENT_S:
            raise DeviceLost('the microphone gives no sound any longer: was it pulled out?')
        return block

    def waits(self):
        """Return whether more sound is waiting to be read."""
        return bool(select.select([self._child], [], [], 0.0)[0])

    def close(self):
        """Release it; does nothing if it is not open."""
        child, self._child = self._child, None
        if child is not None:
            child.end()


class WavFile:
    """A recording, played once in real time, followed by silence.

    Its end does not count as a lost device: reopened, it would drive the robots again.

    :param paced: False: without pacing
    """

    def __init__(self, path, paced=True):
        self._path = path
        self._paced = paced
        self._file = None
        self._due = 0.0

    def open(self):
        """Open the file; return its name.

        :raises DeviceAbsent: the file cannot be read, or has another form
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
        """Return the next block, or b'' if it is not due within the time."""
        now = time.monotonic()
        # The first block is due at the first call: loading the recogniser takes a while.
        self._due = self._due or now
        wait_s = self._due - now
        if self._paced:
            time.sleep(max(0.0, min(wait_s, timeout_s)))
            if wait_s > timeout_s:
                return b''
        self._due += BLOCK_S
        return self._file.readframes(BLOCK_BYTES // 2).ljust(BLOCK_BYTES, b'\0')

    def waits(self):
        """Return whether the next block should have been read already."""
        return time.monotonic() > self._due

    def close(self):
        """Close it; does nothing if it is not open."""
        self._due = 0.0
        if self._file is not None:
            self._file.close()
            self._file = None


class RawStream:
    """Raw sound from a FIFO, a character device, or the standard input ('-').

    It exists while a program writes to it, and is lost when the last writer closes it.
    """

    def __init__(self, path):
        self._path = path
        self._name = 'the standard input' if path == '-' else 'the sound stream ' + path
        self._fd = None
        self._held = b''

    def open(self):
        """Open the stream; return its name.

        :raises DeviceAbsent: the path does not exist, or no program writes to it
        """
        self._held = b''
        try:
            self._fd = os.dup(0) if self._path == '-' else os.open(
                self._path, os.O_RDONLY | os.O_NONBLOCK)
            kind = os.fstat(self._fd).st_mode
            if not (stat.S_ISFIFO(kind) or stat.S_ISCHR(kind) or stat.S_ISSOCK(kind)):
                raise DeviceAbsent('{} is not a stream: make one with mkfifo, or name a .wav '
                                   'file'.format(self._path))
            # A FIFO that never had a writer is not reported as ready, but is at its end, too.
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
        """Read the available bytes, at most up to the end of a block.

        :raises DeviceLost: the stream has ended
        """
        try:
            data = os.read(self._fd, BLOCK_BYTES - len(self._held))
        except BlockingIOError:
            return
        if not data:
            raise DeviceLost('nobody writes to {} any longer'.format(self._name))
        self._held += data

    def read(self, timeout_s):
        """Return the next block, or b'' if it was not complete in time.

        :raises DeviceLost: the stream has ended, or cannot be read
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
        """Return whether more sound is waiting to be read."""
        return self._ready(0.0)

    def close(self):
        """Close it; does nothing if it is not open."""
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None


def open_source(text):
    """Return the source for a text, not open yet.

    '' or ``microphone`` is the default microphone, ``microphone:<part of its name>`` another,
    ``-`` the standard input, ``<path>.wav`` a recording, any other path a raw stream.
    """
    kind, _, name = text.partition(':')
    if not text or kind == 'microphone':
        return Microphone(name)
    if text.endswith('.wav'):
        return WavFile(text)
    return RawStream(text)
