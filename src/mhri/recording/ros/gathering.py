# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gathers messages into chunks for the disk, limited in size and age."""
import threading
import time


class Gathering:
    """Pending messages of a bag.

    ``lock`` is held while a chunk is passed on, and must be held to change the target.

    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    :param hand_on: called with (messages, their bytes), at least one message, each
        (:class:`mhri.recording.ros.bag_file.Publisher`, receipt time [ns], frame)
    """

    def __init__(self, limits, hand_on):
        self.lock = threading.Lock()
        self._limits = limits
        self._hand_on = hand_on
        self._messages, self._size, self._due_s = [], 0, None

    def add(self, publisher, time_ns, frame):
        """Add a message (call it under the lock)."""
        self._messages.append((publisher, time_ns, frame))
        self._size += len(frame)
        if self._due_s is None:
            self._due_s = time.monotonic() + self._limits.chunk_s
        if self._size >= self._limits.chunk_bytes:
            self.flush()

    def flush(self):
        """Pass the pending messages on (call it under the lock)."""
        if self._messages:
            messages, size = self._messages, self._size
            self._messages, self._size = [], 0
            self._hand_on(messages, size)
        self._due_s = None

    def on_turn(self):
        """Pass a chunk on if it is due; return the time until the next [s], None without one."""
        due_s = self._due_s
        if due_s is None:
            return None
        left_s = due_s - time.monotonic()
        if left_s > 0.0:
            return left_s
        with self.lock:
            self.flush()
        return None
