# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thread that the disk may hold up: it writes messages, watches the space, closes the file."""
import logging
import queue
import threading
import time

from mhri.recording.recording import warning_of
from mhri.recording.ros.bag_file import words_of

_LOG = logging.getLogger(__name__)


class BagWriter:
    """Writes messages in the order of :meth:`put`; drops none.

    ``failure`` says why nothing more can be written, ``warning`` what is wrong with the disk now
    ('' while all is well); ``closed`` is an event: the file is closed and has its name, or closing
    failed.

    :param file: :class:`mhri.recording.ros.bag_file.BagFile`; closed by this thread
    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    :param on_trouble: called once, on this thread, when the recording must stop
    """

    def __init__(self, file, limits, on_trouble=lambda: None, clock=time.monotonic):
        self.file = file
        self.failure = ''
        self.warning = ''
        self.closed = threading.Event()
        self._limits = limits
        self._on_trouble = on_trouble
        self._clock = clock
        self._queue = queue.Queue()
        self._put_bytes = 0
        self._done_bytes = 0
        self._synced_at = clock()

    def start(self):
        """Begin to write."""
        self._judge(self.file.free_bytes())
        threading.Thread(target=self._run, name='bag_writer', daemon=True).start()

    def put(self, messages, size):
        """Queue messages for one chunk of the file; return at once.

        :param messages: as :meth:`mhri.recording.ros.bag_file.BagFile.write` takes them
        :param size: their bytes
        """
        self._put_bytes += size
        self._queue.put((messages, size))
        if self.queue_bytes >= self._limits.warn_queue_bytes:
            # Judge it here, too: the disk may be holding up the thread that writes.
            self._judge(None)

    def finish(self):
        """Close the file once everything queued is written; return at once."""
        self._queue.put(None)

    @property
    def queue_bytes(self):
        """The bytes queued and not written yet."""
        return self._put_bytes - self._done_bytes

    def _judge(self, free_bytes):
        """Note the queue and the space left; end the recording if need be."""
        self.warning, stop = warning_of(self._limits, free_bytes, self.queue_bytes)
        if stop:
            self._fail(self.warning)

    def _fail(self, reason):
        if not self.failure:
            self.failure = reason
            _LOG.warning('recording of %s stops: %s', self.file.path, reason)
            self._on_trouble()

    def _run(self):
        broken = False
        try:
            for messages, size in iter(self._queue.get, None):
                if not broken:
                    broken = not self._write(messages)
                self._done_bytes += size
            self.file.close()
        except Exception as error:  # the guard of this thread: tell the operator, and log it
            _LOG.exception('%s could not be closed', self.file.path)
            self._fail(words_of(error))
        finally:
            self.closed.set()

    def _write(self, messages):
        """Write one chunk; return whether more can follow."""
        try:
            self.file.write(messages)
            if self._clock() - self._synced_at >= self._limits.sync_s:
                self.file.sync()
                self._synced_at = self._clock()
        except OSError as error:
            self._fail(words_of(error))
            return False
        self._judge(self.file.free_bytes())
        return True
