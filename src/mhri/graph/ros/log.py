# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A log that nobody has to wait for.

rospy writes each line on the thread that logs it: to the terminal, to the log file, to /rosout. A
terminal that takes nothing (Ctrl-S, a pipe that nobody reads) or a hanging disk would hold up that
thread, and with it the zero that it had to send next.
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

# Lines that may wait for one destination; any more are counted, not kept.
QUEUE_SIZE = 1000
# How long an ending program waits for its last lines [s].
LAST_WORDS_S = 0.5
# A program that has not ended so long after its shutdown waits for an output that takes nothing:
# what is written past these handlers (the traceback of a thread, Python's own last flush) blocks.
ENDED_WITHIN_S = 10.0


class PatientHandler(logging.Handler):
    """Passes every record to another handler, on its own thread; never waits.

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
        """Make no lock: the queue has its own."""
        self.lock = None

    def emit(self, record):
        """Take a record; count one too many."""
        try:
            # Format it now: what it speaks of may change before it is written.
            record.msg, record.args = record.getMessage(), None
            self._waiting.put_nowait(record)
        except queue.Full:
            with self._counting:
                self._lost += 1
        except Exception:  # text and arguments do not match: logging itself reports that
            self.handleError(record)

    def written(self):
        """Tell whether nothing waits and nothing is being written."""
        return not self._waiting.unfinished_tasks

    def _run(self):
        """Write the waiting records, and how many are missing."""
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
    """Writes what is logged before rospy has set up its handlers.

    It has no lock: setting them up asks every handler there is for its own, and would wait.
    """

    def createLock(self):
        self.lock = None

    def emit(self, record):
        print(self.format(record), file=sys.stderr)


def start_screen_node(name, argv):
    """Start the node of a screen, which goes on where that is ended; its log holds up nobody.

    In rqt, which has started one, this does nothing: the log is rqt's, too.
    """
    if not is_initialised():
        rospy.init_node(name, argv=argv, disable_signals=True)
        install(lives_on=True)


def install(lives_on=False):
    """Put a queue in front of every log handler of the program; call it after init_node.

    One that logs before that, on a thread that must not wait, calls it at its start as well.

    :param lives_on: whether the program goes on where its node is ended
    :returns: the :class:`PatientHandler` of each; none if they are in place already
    """
    patient = {}
    if not isinstance(logging.lastResort, PatientHandler):
        before = logging.lastResort
        logging.lastResort = patient[before] = PatientHandler(_Stderr(logging.WARNING))
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
        if not lives_on:
            rospy.on_shutdown(_end_in_time)
    return list(patient.values())


def _end_in_time():
    """End the program, whatever holds it up."""
    timer = threading.Timer(ENDED_WITHIN_S, os._exit, (0,))
    timer.daemon = True
    timer.start()


def _finish(handlers):
    """Wait a little for the last lines; leave without them if nobody takes them.

    Python's own end would wait for ever: it asks for the lock of a stream that is being written.
    """
    deadline = time.monotonic() + LAST_WORDS_S
    while not all(handler.written() for handler in handlers):
        if time.monotonic() > deadline:
            rospy.signal_shutdown('the program ends')
            os._exit(0)
        time.sleep(0.01)
