# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Save IMU Data: one recording of one robot, from the sockets to the file.

One thread makes the connections and one reads them, so that neither the displays of this program
nor the disk delay a message; another one writes, so that no other thread waits for the disk.
"""
from datetime import datetime
import logging
import os
import threading
import time

import rospy

from mhri.recording.recording import (
    ENDED, FAILED, OFF, PathRefused, RateMeter, RECORDING, RecordingLimits, RecordingStatus,
    size_text)
from mhri.recording.ros.bag_file import open_bag, Publisher, error_text
from mhri.recording.ros.bag_writer import BagWriter
from mhri.recording.ros.gathering import Gathering
from mhri.recording.ros.raw_reader import RawReader
from mhri.recording.ros.tap_node import TapNode

_LOG = logging.getLogger(__name__)


def receipt_clock():
    """Return a function that returns the present time [ns]: ROS time if it is simulated.

    Otherwise it is the time of day at the start plus the time elapsed since, so that setting the
    clock meanwhile does not disorder the messages.
    """
    if rospy.rostime.is_rostime_initialized() and not rospy.rostime.is_wallclock():
        return lambda: max(1, rospy.get_rostime().to_nsec())
    monotonic_ns = time.monotonic_ns
    begun_ns = time.time_ns() - monotonic_ns()
    return lambda: begun_ns + monotonic_ns()


class Recorder:
    """One recording: it can be started once and stopped once; its status remains available.

    It subscribes topics of any type, as the node ``/mhri_recorder_<robot>_<number>``, and writes
    every message with its receipt time, in the order of receipt. Call ``stop(wait=True)`` before
    the program ends (also on SIGTERM) to close the file with its index. A killed program leaves
    ``<file>.bag.active``, from which ``rosbag reindex`` recovers all but the last half second.

    :param robot: its name
    :param topics: absolute names (:func:`mhri.recording.recording.topics_of`); not the
        robot's velocity topics, since their subscribers count as the robot
    :param path: as the operator typed it, '' for the default
    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    """

    _numbers = iter(range(1, 10 ** 9))

    def __init__(self, robot, topics, path='', limits=RecordingLimits()):
        self.robot = robot
        self.topics = tuple(dict.fromkeys(topics))
        self._asked = path
        self._limits = limits
        self._clock_ns = receipt_clock()
        # Separate locks for start and stop and for the messages: a message may cause the stop.
        self._life = threading.Lock()
        self._gathering = Gathering(
            limits, lambda messages, size: self._writer.put(messages, size))
        self._state = OFF
        self._note = self._elsewhere = ''
        self._writer = None
        self._reader = None
        self._node = None
        self._stop_asked = False
        self._ended = threading.Event()
        self._begun_s = self._ended_s = None
        self._meter = RateMeter()
        self._publishers = {}
        self._messages = 0
        self._bytes = 0

    def start(self):
        """Open the file and subscribe; return at once; :meth:`status` has the result."""
        with self._life:
            if self._state != OFF:
                return
            self._state = RECORDING
        threading.Thread(target=self._begin, name='recording', daemon=True).start()

    def stop(self, wait=False, timeout_s=10.0):
        """Write the messages so far and close the file; return at once unless ``wait`` is set.

        :param wait: return only when the file is closed, or after ``timeout_s`` [s]
        :returns: whether the recording has ended
        """
        with self._life:
            self._stop_asked = True
            reader = self._reader
            if self._state == OFF:
                self._state = ENDED
                self._ended.set()
        if reader is not None:
            reader.stop()
        return self._ended.wait(timeout_s) if wait else self._ended.is_set()

    def status(self):
        """Return the present :class:`mhri.recording.recording.RecordingStatus`; cheap."""
        writer, state, now = self._writer, self._state, time.monotonic()
        note, attention = self._note, bool(self._note or self._elsewhere)
        if state == RECORDING and writer is not None and writer.warning:
            note, attention = '; '.join(filter(None, (writer.warning, note))), True
        if state == ENDED:
            attention = False
        begun = self._begun_s
        return RecordingStatus(
            state=state, path=writer.file.path if writer else '',
            duration_s=0.0 if begun is None else (self._ended_s or now) - begun,
            messages=self._messages, bytes=self._bytes,
            rate_hz=self._meter.rate_hz(now, self._messages) if state == RECORDING else 0.0,
            note=note, attention=attention, elsewhere=self._elsewhere)

    def _begin(self):
        """Open everything (on its own thread: a disk or a name server may be slow)."""
        try:
            self._open()
        except PathRefused as error:
            self._end(FAILED, str(error))
        except Exception as error:  # the guard of this thread: tell the operator, and log it
            _LOG.exception('a recording of %s could not begin', self.robot)
            self._end(FAILED, 'cannot record: {}'.format(error_text(error)))

    def _open(self):
        file, self._note, self._elsewhere = open_bag(self._asked, self.robot, datetime.now())
        self._writer = BagWriter(file, self._limits, on_trouble=self.stop)
        self._begun_s = time.monotonic()
        name = '/mhri_recorder_{}_{}_{}'.format(self.robot, os.getpid(), next(self._numbers))
        try:
            reader = RawReader(name, self._on_frame, self._gathering.on_turn, self._on_read)
            self._node = TapNode(name, self.topics, reader.connect)
            self._node.start()
        except OSError as error:
            self._end(FAILED, 'cannot receive anything: {}'.format(error_text(error)))
            self._writer.finish()
            self._writer.start()
            return
        with self._life:
            self._reader = reader
            stop_asked = self._stop_asked
        self._writer.start()
        reader.start()
        if stop_asked:
            reader.stop()

    def _on_frame(self, link, frame):
        with self._gathering.lock:
            publisher = link.publisher
            if publisher is None:
                publisher = link.publisher = self._publisher(link.fields)
            self._add(publisher, frame)

    def _add(self, publisher, frame):
        """Add one message (under the lock)."""
        self._messages += 1
        self._bytes += len(frame)
        self._gathering.add(publisher, self._clock_ns(), frame)

    def _publisher(self, fields):
        """Return the publisher with this header; a reconnecting one is the same object."""
        return self._publishers.setdefault(tuple(sorted(fields.items())), Publisher(fields))

    def _on_read(self):
        """Close the file and leave the graph once everything is read (on the reading thread)."""
        self._node.stop()
        with self._gathering.lock:
            self._gathering.flush()
        writer = self._writer
        writer.finish()
        writer.closed.wait()
        file = writer.file
        text = '{} messages, {}: {}'.format(file.messages, size_text(file.size), file.path)
        if writer.failure:
            self._end(FAILED, 'recording stopped, {}; saved {}'.format(writer.failure, text))
        else:
            self._end(ENDED, 'saved ' + text)

    def _end(self, state, note):
        self._ended_s = time.monotonic()
        self._note = '; '.join(filter(None, (self._note, note)))
        self._state = state
        self._ended.set()
        (_LOG.warning if state == FAILED else _LOG.info)('%s: %s', self.robot, note)
