# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A room to listen to, as a stream of sound."""
import os
import shutil
import tempfile
import threading
import time

import numpy as np

from mhri.voice.sound import BLOCK_BYTES, BLOCK_S
from support import speech


class Room:
    """A FIFO into which a room is written in real time: hiss, and what is said in it.

    It stands in for a microphone: ``path`` is a ``~source`` of ``mhri_voice``.
    """

    def __init__(self):
        self._folder = tempfile.mkdtemp(prefix='mhri_room_')
        self.path = os.path.join(self._folder, 'microphone')
        os.mkfifo(self.path)
        self._changed = threading.Condition()
        self._random = np.random.RandomState(1)
        self._hiss = [self._quiet(np.zeros(BLOCK_BYTES // 2)) for _ in range(50)]
        self._to_say = []
        self._ended = False
        self._fd = None
        self.plug()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _quiet(self, sound):
        return speech.in_room(sound, self._random, before_s=0.0, after_s=0.0)

    def plug(self):
        """Be there."""
        with self._changed:
            # Reading as well, so that it opens whether anybody listens or not.
            self._fd = os.open(self.path, os.O_RDWR | os.O_NONBLOCK)

    def pull(self):
        """Be gone; return when."""
        with self._changed:
            self._fd, fd = None, self._fd
            self._to_say = []
            at = time.monotonic()
            os.close(fd)
            return at

    def _run(self):
        due, number = time.monotonic(), 0
        with self._changed:
            while not self._ended:
                self._changed.wait(max(0.0, due - time.monotonic()))
                if time.monotonic() < due:
                    continue
                due, number = due + BLOCK_S, number + 1
                self._write(self._to_say.pop(0) if self._to_say else self._hiss[number % 50])
                self._changed.notify_all()

    def _write(self, block):
        if self._fd is not None:
            try:
                os.write(self._fd, block)
            except BlockingIOError:
                return  # Nobody listens: the pipe is full of hiss.

    def say(self, text, voice=speech.Voice('en-us+m3', 150, 50)):
        """Say something after a pause that ends what was said before; return when it is out."""
        sound = speech.in_room(speech.speak(text, voice), self._random, before_s=0.8, after_s=0.0)
        blocks = [sound[at:at + BLOCK_BYTES] for at in range(0, len(sound), BLOCK_BYTES)]
        blocks[-1] = blocks[-1].ljust(BLOCK_BYTES, b'\0')
        with self._changed:
            self._to_say += blocks
            deadline = time.monotonic() + len(blocks) * BLOCK_S + 10.0
            while self._to_say and time.monotonic() < deadline:
                self._changed.wait(1.0)
            assert not self._to_say, 'nobody could speak in time'
            return time.monotonic()

    def end(self):
        """Leave nothing behind."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join(10.0)
        if self._fd is not None:
            os.close(self._fd)
        shutil.rmtree(self._folder, ignore_errors=True)
