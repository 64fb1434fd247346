# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the journal of the drive (:mod:`mhri.driving.journal`) to a file, in the background."""
import collections
from functools import partial
import threading

import rospy

from mhri.driving.journal import JournalDrive, LEFT, line_of
from mhri.graph.ros.worker import Worker

# Maximum delay of an entry to the file, unless the disk is slow [s].
WRITE_S = 0.1
# Maximum number of entries waiting for the disk.
MAX_WAITING = 20000
#: suffix of the name of every journal
ENDING = '.journal'
# How long the shutdown of the program waits for the journal [s].
LAST_S = 1.0


class JournalWriter:
    """Appends to a file; if that fails, or the disk is too slow, it stops and logs this once.

    A failure never affects the driving.

    :param path: path of the file, which may hold the journals of earlier drives; it ends in
        :data:`ENDING`
    """

    def __init__(self, path):
        self._path, self._run = path, ''
        self._stream, self._problem, self._closed = None, None, False
        self._waiting = collections.deque()
        self._worker = Worker('journal', self._write, WRITE_S).start()

    def drive(self, run, *facts):
        """Return a drive whose events are all recorded.

        :param run: identifies this run of the drive
        :param facts: the parameters of :class:`mhri.driving.drive.Drive`
        """
        self._run = run
        return JournalDrive(self._note, *facts)

    def watch(self, robot, publishers):
        """Record the velocities sent to a robot by these ``NonBlockingPublisher``."""
        for publisher in publishers:
            publisher.publish_packed = partial(self._pass_on, robot, publisher.resolved_name,
                                               publisher.publish_packed)

    def _pass_on(self, robot, topic, publish, data, urgent=False):
        publish(data, urgent)
        self._note(LEFT, robot, topic, data)

    def _note(self, *entry):
        """Queue an entry, with the lock of the drive held; return at once."""
        if len(self._waiting) < MAX_WAITING and not self._problem:
            self._waiting.append(entry)
        else:
            # A journal must not have gaps.
            self._problem = self._problem or 'the disk is too slow'

    def _write(self):
        """Write the waiting entries (on the worker)."""
        if self._closed:
            return
        try:
            if self._stream is None:
                if not self._path.endswith(ENDING):
                    # Any node can set the parameter of the path, even to another kind of file.
                    raise ValueError('its name does not end in ' + ENDING)
                # Without a buffer, so that each write ends with a line.
                self._stream = open(self._path, 'ab', buffering=0)
                # The previous drive may have left an incomplete line.
                self._stream.write(b'\n')
            data = ''.join(line_of(self._run, *self._waiting.popleft()) + '\n'
                           for _ in range(len(self._waiting))).encode()
            while data:
                data = data[self._stream.write(data):]
            if not self._problem:
                return
        except Exception as error:  # no error of the journal may affect the driving
            self._problem = error
        rospy.logerr('the journal %s ends here, the robots drive on: %s', self._path,
                     self._problem)
        self._close()

    def _close(self):
        self._closed = True
        self._waiting.clear()
        if self._stream is not None:
            self._stream.close()

    def stop(self):
        """Write the last entries, and end; wait at most :data:`LAST_S` for the disk."""
        done = threading.Event()
        for job in (self._write, self._close, done.set):
            self._worker.do(job)
        done.wait(LAST_S)
        self._worker.stop()
