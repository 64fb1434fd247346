# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thread that waits for the disk: writes messages, monitors free space, closes the file."""
import logging
import queue
import threading
import time

from mhri.recording.recording import warning_of
from mhri.recording.ros.bag_file import error_text

_LOG = logging.getLogger(__name__)


class BagWriter:
    """Writes messages in the order of :meth:`put`, without dropping any.

    ``failure`` is the reason why nothing more can be written, ``warning`` the present problem of
    the disk ('' while all is well); the event ``closed`` is set once the file is closed and
    renamed, or closing has failed.

    :param file: :class:`mhri.recording.ros.bag_file.BagFile`; closed by this thread
    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    :param on_trouble: called once, on this thread, when the recording must stop
    """

    def __init__(self, file, limits, on_trouble):
        self.file = file
        self.failure = ''
        self.warning = ''
        self.closed = threading.Event()
        self._limits = limits
        self._on_trouble = on_trouble
        self._queue = queue.Queue()
        self._put_bytes = 0
        self._done_bytes = 0
        self._synced_at = time.monotonic()

    def start(self):
        """Start the thread."""
        self._judge(self.file.free_bytes())
        threading.Thread(target=self._run, name='bag_writer', daemon=True).start()

    def put(self, messages, size):
        """Queue messages for one chunk of the file; return at once.

        :param messages: as for :meth:`mhri.recording.ros.bag_file.BagFile.write`
        :param size: their total bytes
        """
        self._put_bytes += size
        self._queue.put((messages, size))
        if self.queue_bytes >= self._limits.warn_queue_bytes:
            # Check the queue here, too: the disk may be blocking the writing thread.
            self._judge(None)

    def finish(self):
        """Close the file after everything queued is written; return at once."""
        self._queue.put(None)

    @property
    def queue_bytes(self):
        """The number of bytes queued and not written yet."""
        return self._put_bytes - self._done_bytes

    def _judge(self, free_bytes):
        """Check the queue and the free space; stop the recording if necessary."""
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
            self._fail(error_text(error))
        finally:
            self.closed.set()

    def _write(self, messages):
        """Write one chunk; return whether more can be written."""
        try:
            self.file.write(messages)
            if time.monotonic() - self._synced_at >= self._limits.sync_s:
                self.file.sync()
                self._synced_at = time.monotonic()
        except OSError as error:
            self._fail(error_text(error))
            return False
        self._judge(self.file.free_bytes())
        return True
