# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Publisher of the drive's state: ``/mux/state``."""
import threading
import time

import rospy

from mhri.msg import DriveState

# Publishing periods at rest, and while anything moves [s].
PERIOD_S, MOVING_S = 0.5, 0.1
# Changes within this time are published together [s].
MIN_S = 0.02


class DriveSpeaker:
    """A thread that publishes ``mhri/DriveState``, latched, on change, at 2 Hz, moving at 10 Hz.

    :param read: returns the message, without its header
    :param moving: returns whether anything moves
    """

    def __init__(self, read, moving):
        self._read = read
        self._moving = moving
        self._changed = threading.Event()
        self._publisher = rospy.Publisher('/mux/state', DriveState, queue_size=1, latch=True,
                                          tcp_nodelay=True)

    def start(self):
        """Start the thread; return at once."""
        threading.Thread(target=self._run, name='drive_state', daemon=True).start()

    def on_change(self):
        """Publish soon; return at once."""
        self._changed.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._changed.wait((MOVING_S if self._moving() else PERIOD_S) - MIN_S)
            self._changed.clear()
            message = self._read()
            message.header.stamp = rospy.Time.from_sec(time.time())
            try:
                self._publisher.publish(message)
            except rospy.ROSException:
                return  # the node has just ended
            time.sleep(MIN_S)
