# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A log that nobody has to wait for.

rospy writes a line where it is logged: to the terminal, to the log file, to /rosout. A terminal
that takes nothing (Ctrl-S, a pipe that nobody reads) or a disk that hangs would hold up whoever
logs, and with it the zero that was to be sent next.
"""
import atexit
import logging
import os
import queue
import threading
import time

import rospy

# Lines that wait for one place; what comes on top of them is counted, not kept.
QUEUE_SIZE = 1000
# How long a program that ends waits for its last lines to be written [s].
LAST_WORDS_S = 0.5


class PatientHandler(logging.Handler):
    """Hands every record to another handler, on a thread of its own; never waits.

    :param handler: the one that may block
    :param size: the most records that wait
    """

    def __init__(self, handler, size=QUEUE_SIZE):
        super().__init__(handler.level)
        self._handler = handler
        self._waiting = queue.Queue(size)
        self._counting = threading.Lock()
        self._lost = 0
        threading.Thread(target=self._run, name='log', daemon=True).start()

    def createLock(self):
        """Do without: the queue has its own."""
        self.lock = None

    def emit(self, record):
        """Take a record; one too many is counted."""
        try:
            # Now: what it speaks of may have changed by the time it is written.
            record.msg, record.args = record.getMessage(), None
            self._waiting.put_nowait(record)
        except queue.Full:
            with self._counting:
                self._lost += 1
        except Exception:  # the words do not fit their arguments: that is for logging to say
            self.handleError(record)

    def written(self):
        """Tell whether nothing waits and nothing is being written."""
        return not self._waiting.unfinished_tasks

    def _run(self):
        """Write what waits, and how much is missing."""
        while True:
            record = self._waiting.get()
            with self._counting:
                lost, self._lost = self._lost, 0
            if lost:
                self._handler.handle(logging.makeLogRecord({
                    'name': record.name, 'levelno': logging.WARNING, 'levelname': 'WARNING',
                    'msg': '{} lines of the log are missing: nobody took them'.format(lost)}))
            self._handler.handle(record)
            self._waiting.task_done()


def install():
    """Put every handler that the program logs to behind a queue; call it after init_node.

    :returns: the :class:`PatientHandler` of each; none if they are in place already
    """
    patient = {}
    named = logging.root.manager.loggerDict.values()
    for logger in [logging.root] + [item for item in named if isinstance(item, logging.Logger)]:
        for handler in list(logger.handlers):
            if isinstance(handler, PatientHandler) or type(handler).__name__ == 'NullHandler':
                continue
            if handler not in patient:
                patient[handler] = PatientHandler(handler)
            logger.removeHandler(handler)
            logger.addHandler(patient[handler])
    if patient:
        atexit.register(_finish, list(patient.values()))
    return list(patient.values())


def _finish(handlers):
    """Wait a little for the last lines; leave without them where nobody takes them.

    Python's own end would wait for ever: it asks for the lock of a stream that is being written.
    """
    deadline = time.monotonic() + LAST_WORDS_S
    while not all(handler.written() for handler in handlers):
        if time.monotonic() > deadline:
            rospy.signal_shutdown('the program ends')
            os._exit(0)
        time.sleep(0.01)
