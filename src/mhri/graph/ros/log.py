# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A log that never blocks the logging thread.

rospy writes each line on the thread that logs it: to the terminal, to the log file, to /rosout. A
blocked terminal (Ctrl-S, a pipe without a reader) or a hanging disk would block that thread, and
delay a zero that it has to send next.
"""
import atexit
import logging
import os
import queue
import sys
import threading
import time

import rospy

from mhri.graph.ros.rospy_inside import is_initialised

# Maximum number of lines waiting for one destination; further ones are counted, not kept.
QUEUE_SIZE = 1000
# How long a program waits for its last lines when it ends [s].
LAST_WORDS_S = 0.5
# A program that has not ended this long after its shutdown [s] is blocked by an output: writes that
# bypass these handlers (the traceback of a thread, Python's own last flush) block.
ENDED_WITHIN_S = 10.0


class QueuedLogHandler(logging.Handler):
    """Passes every record to another handler, on its own thread; never blocks.

    :param handler: the handler that may block
    :param size: maximum number of waiting records
    """

    def __init__(self, handler, size=QUEUE_SIZE):
        super().__init__(handler.level)
        self._handler = handler
        self._waiting = queue.Queue(size)
        self._counting = threading.Lock()
        self._lost = 0
        threading.Thread(target=self._run, name='log', daemon=True).start()

    def createLock(self):
        """Create no lock: the queue has its own."""
        self.lock = None

    def emit(self, record):
        """Queue a record; count those that are dropped."""
        try:
            # Format it now: its arguments may change before it is written.
            record.msg, record.args = record.getMessage(), None
            self._waiting.put_nowait(record)
        except queue.Full:
            with self._counting:
                self._lost += 1
        except Exception:  # text and arguments do not match: logging reports that itself
            self.handleError(record)

    def written(self):
        """Return whether all records are written."""
        return not self._waiting.unfinished_tasks

    def _run(self):
        """Write the waiting records, and the number of dropped ones."""
        while True:
            record = self._waiting.get()
            with self._counting:
                lost, self._lost = self._lost, 0
            if lost:
                self._handler.handle(logging.makeLogRecord({
                    'name': record.name, 'levelno': logging.WARNING, 'levelname': 'WARNING',
                    'msg': '{} log lines are missing: the output was stuck'.format(lost)}))
            self._handler.handle(record)
            self._waiting.task_done()


class _Stderr(logging.Handler):
    """Writes records logged before rospy has set up its handlers.

    It has no lock: the setup acquires the lock of every handler, and would wait.
    """

    def createLock(self):
        self.lock = None

    def emit(self, record):
        print(self.format(record), file=sys.stderr)


def start_screen_node(name, argv):
    """Start the node of a screen, which survives the end of the node; its log never blocks.

    In rqt, which has already started a node, this does nothing: the log is rqt's, too.
    """
    if not is_initialised():
        rospy.init_node(name, argv=argv, disable_signals=True)
        install(lives_on=True)


def install(lives_on=False):
    """Put a queue in front of every log handler of the program; call it after init_node.

    A program that logs before that, on a thread that must not block, also calls it at its start.

    :param lives_on: whether the program survives the end of its node
    :returns: the :class:`QueuedLogHandler` of each; none if they are in place already
    """
    patient = {}
    if not isinstance(logging.lastResort, QueuedLogHandler):
        before = logging.lastResort
        logging.lastResort = patient[before] = QueuedLogHandler(_Stderr(logging.WARNING))
    named = logging.root.manager.loggerDict.values()
    for logger in [logging.root] + [item for item in named if isinstance(item, logging.Logger)]:
        for handler in list(logger.handlers):
            if isinstance(handler, QueuedLogHandler) or type(handler).__name__ == 'NullHandler':
                continue
            if handler not in patient:
                patient[handler] = QueuedLogHandler(handler)
            logger.removeHandler(handler)
            logger.addHandler(patient[handler])
    if patient:
        atexit.register(_finish, list(patient.values()))
        if not lives_on:
            rospy.on_shutdown(_end_in_time)
    return list(patient.values())


def _end_in_time():
    """End the program even if an output is blocked."""
    timer = threading.Timer(ENDED_WITHIN_S, os._exit, (0,))
    timer.daemon = True
    timer.start()


def _finish(handlers):
    """Wait briefly for the last lines; exit without them if they cannot be written.

    Python's own exit would wait for ever for the lock of a stream that is being written.
    """
    deadline = time.monotonic() + LAST_WORDS_S
    while not all(handler.written() for handler in handlers):
        if time.monotonic() > deadline:
            rospy.signal_shutdown('the program ends')
            os._exit(0)
        time.sleep(0.01)
