# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A thread for calls that may block, so that no other thread blocks."""
import logging
import queue
import threading

_LOG = logging.getLogger(__name__)


class Worker:
    """Runs jobs one after the other on a daemon thread.

    :param idle: called about every ``idle_s`` seconds between jobs
    """

    def __init__(self, name, idle=lambda: None, idle_s=2.0):
        self._jobs = queue.Queue()
        self._idle = idle
        self._idle_s = idle_s
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self):
        """Start working."""
        self._thread.start()
        return self

    def do(self, job, *args):
        """Queue a call; return at once."""
        self._jobs.put((job, args))

    def stop(self):
        """Accept no more jobs; return at once; a running job ends in its own time."""
        self._done.set()
        self._jobs.put((lambda: None, ()))

    def _run(self):
        while not self._done.is_set():
            try:
                job, args = self._jobs.get(timeout=self._idle_s)
            except queue.Empty:
                job, args = self._idle, ()
            try:
                job(*args)
            except Exception:  # keep this thread alive: log the error and continue
                _LOG.exception('a background job failed: %r', job)
