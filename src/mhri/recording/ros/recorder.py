# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Save IMU Data: one recording of one robot, from the sockets to the file.

One thread makes the connections and one reads them, so that no display in this program and no disk
holds a message up; one writes, so that nobody waits for the disk.
"""
from datetime import datetime
import io
import logging
import os
import struct
import threading
import time

import rospy

from mhri.recording.recording import (
    ENDED, FAILED, OFF, PathRefused, RateMeter, RECORDING, RecordingLimits, RecordingStatus,
    size_text)
from mhri.recording.ros.bag_file import open_bag, Publisher, words_of
from mhri.recording.ros.bag_writer import BagWriter
from mhri.recording.ros.raw_reader import RawReader
from mhri.recording.ros.tap_node import TapNode

_LOG = logging.getLogger(__name__)


def receipt_clock():
    """Return a function that returns the time now [ns]: ROS time if it is simulated.

    Else it is the time of day at the start plus the time elapsed since: setting the clock meanwhile
    does not disorder the messages.
    """
    if rospy.rostime.is_rostime_initialized() and not rospy.rostime.is_wallclock():
        return lambda: max(1, rospy.get_rostime().to_nsec())
    monotonic_ns = time.monotonic_ns
    begun_ns = time.time_ns() - monotonic_ns()
    return lambda: begun_ns + monotonic_ns()


class Recorder:
    """One recording: start it once, stop it once, and then only ask for its status.

    It subscribes (to any type, as the node ``/mhri_recorder_<robot>_<number>``) and writes every
    message that arrives, with its receipt time, in the order of receipt. Call ``stop(wait=True)``
    before the program ends (also on SIGTERM): that closes the file whole. A killed program leaves
    ``<file>.bag.active``, from which ``rosbag reindex`` saves all but the last half second.

    :param robot: its name
    :param topics: absolute names (:func:`mhri.recording.recording.topics_of`); not the
        robot's velocity topics: whoever subscribes to those counts as the robot
    :param path: as the operator typed it, '' for the default
    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    :param clock_ns: function that returns the receipt time [ns], default :func:`receipt_clock`
    """

    _numbers = iter(range(1, 10 ** 9))

    def __init__(self, robot, topics, path='', limits=RecordingLimits(), clock_ns=None):
        self.robot = robot
        self.topics = tuple(dict.fromkeys(topics))
        self._asked = path
        self._limits = limits
        self._clock_ns = clock_ns or receipt_clock()
        # One lock for start and end, one for the messages: a message may bring the end.
        self._life = threading.Lock()
        self._lock = threading.Lock()
        self._state = OFF
        self._note = ''
        self._writer = None
        self._reader = None
        self._node = None
        self._stop_asked = False
        self._ended = threading.Event()
        self._begun_s = self._ended_s = None
        self._meter = RateMeter()
        self._publishers = {}
        self._chunk = []
        self._chunk_size = 0
        self._chunk_due_s = None
        self._messages = 0
        self._bytes = 0
        self._complete = False

    def start(self):
        """Open the file and subscribe; return at once; :meth:`status` has the result."""
        with self._life:
            if self._state != OFF:
                return
            self._state = RECORDING
        threading.Thread(target=self._begin, name='recording', daemon=True).start()

    def stop(self, wait=False, timeout_s=10.0):
        """Write what has come by now and close the file; return at once unless told to wait.

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

    def put(self, topic, message):
        """Record a message of this program's own, e.g. a command that it sends to the robot.

        :param message: a ROS message
        """
        if self._state != RECORDING or self._reader is None:
            return
        buffer = io.BytesIO()
        message.serialize(buffer)
        data = buffer.getvalue()
        kind = type(message)
        fields = {'topic': topic, 'type': kind._type, 'md5sum': kind._md5sum,
                  'message_definition': kind._full_text, 'callerid': rospy.get_name()}
        with self._lock:
            if not self._complete:
                self._add(self._publisher(fields), struct.pack('<I', len(data)) + data)
        self._reader.wake()

    def status(self):
        """Return the present :class:`mhri.recording.recording.RecordingStatus`; cheap."""
        writer, state, now = self._writer, self._state, time.monotonic()
        note, attention = self._note, bool(self._note)
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
            note=note, attention=attention)

    def _begin(self):
        """Open everything (on its own thread: a disk or a name server may be slow)."""
        try:
            self._open()
        except PathRefused as error:
            self._end(FAILED, str(error))
        except Exception as error:  # the guard of this thread: tell the operator, and log it
            _LOG.exception('a recording of %s could not begin', self.robot)
            self._end(FAILED, 'cannot record: {}'.format(words_of(error)))

    def _open(self):
        file, self._note = open_bag(self._asked, self.robot, datetime.now())
        self._writer = BagWriter(file, self._limits, on_trouble=self.stop)
        self._begun_s = time.monotonic()
        name = '/mhri_recorder_{}_{}_{}'.format(self.robot, os.getpid(), next(self._numbers))
        try:
            reader = RawReader(name, self._on_frame, self._on_turn, self._on_read)
            self._node = TapNode(name, self.topics, reader.want)
            self._node.start()
        except OSError as error:
            self._end(FAILED, 'cannot receive anything: {}'.format(words_of(error)))
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
        with self._lock:
            publisher = link.publisher
            if publisher is None:
                publisher = link.publisher = self._publisher(link.fields)
            self._add(publisher, frame)

    def _add(self, publisher, frame):
        """Add one message to the chunk (under the lock)."""
        self._chunk.append((publisher, self._clock_ns(), frame))
        self._chunk_size += len(frame)
        self._messages += 1
        self._bytes += len(frame)
        if self._chunk_due_s is None:
            self._chunk_due_s = time.monotonic() + self._limits.chunk_s
        if self._chunk_size >= self._limits.chunk_bytes:
            self._flush()

    def _publisher(self, fields):
        """Return the publisher with this description; a returning one is the same."""
        return self._publishers.setdefault(tuple(sorted(fields.items())), Publisher(fields))

    def _flush(self):
        """Pass the chunk to the writer (under the lock)."""
        if self._chunk:
            self._writer.put(self._chunk, self._chunk_size)
            self._chunk, self._chunk_size = [], 0
        self._chunk_due_s = None

    def _on_turn(self):
        """Return in how many seconds the chunk must go to the disk."""
        due_s = self._chunk_due_s
        if due_s is None:
            return None
        left_s = due_s - time.monotonic()
        if left_s > 0.0:
            return left_s
        with self._lock:
            self._flush()
        return None

    def _on_read(self):
        """Close the file and leave the graph after everything is read (on the reading thread)."""
        self._node.stop()
        with self._lock:
            self._complete = True
            self._flush()
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
