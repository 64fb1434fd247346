# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes STOP work while the GUI thread hangs: a process watches heartbeats of that thread.

A thread is not enough: painting C++ code may hold the GIL, and then no Python thread runs.
"""
from python_qt_binding.QtCore import QObject, QTimer, Signal
from python_qt_binding.QtGui import QGuiApplication
import rospy

from mhri.devices.io.child import Child
from mhri.driving.gui.stop_button import stop_places
from mhri.screen.hang import BEAT_S

_PROCESS = 'mhri.screen.presenters.stop_watch_process'
# A watch that was killed or failed to start is started again after this many beats.
_AGAIN_AFTER = 50


class StopWatch(QObject):
    """Starts the watch and sends heartbeats; it covers all visible windows of the program.

    :param master_uri: URI of the mux's master
    """

    #: a sentence on the action of the watch while this screen hung
    said = Signal(str)

    def __init__(self, master_uri, parent=None):
        super().__init__(parent)
        self._master_uri = master_uri
        self._child = None
        self._beats_to_start = 0
        self._reported = False
        self._timer = QTimer(self, interval=round(1000 * BEAT_S), timeout=self._beat)

    def start(self):
        """Start; without an X server, log once that the watch is not available."""
        if QGuiApplication.platformName() == 'xcb':
            self._timer.start()
        else:
            self._cannot('it needs an X server')

    def _cannot(self, why):
        rospy.logwarn('STOP ALL of this screen does not work while it hangs: %s', why)

    def _is_started(self):
        """Start the process if due; return whether it is running.

        A failed start is retried, because a lack of memory for a process is often temporary.
        """
        if self._child is None:
            self._beats_to_start -= 1
            if self._beats_to_start >= 0:
                return False
            try:
                self._child = Child(_PROCESS, self._master_uri, stdout=None, stderr=None)
            except OSError as error:
                self._beats_to_start = _AGAIN_AFTER
                if not self._reported:
                    self._cannot('its watch cannot be started, but is tried again: {}'.format(
                        error))
                self._reported = True
                return False
            self._reported = False
        return True

    def _beat(self):
        """Send a heartbeat, and handle the messages of the watch."""
        if not self._is_started():
            return
        try:
            for words in self._child.messages():
                if 'cannot' in words:
                    self.close()
                    self._cannot(words['cannot'])
                    return
                rospy.logwarn(words['said'])
                self.said.emit(words['said'])
            self._child.send(stop_places())
        except BlockingIOError:
            pass  # it has not read the previous beats yet
        except (EOFError, OSError):
            self._end_process()
            self._beats_to_start = _AGAIN_AFTER

    def close(self):
        """End the watch."""
        self._timer.stop()
        self._end_process()

    def _end_process(self):
        """End the process."""
        if self._child is not None:
            self._child.end()
            self._child = None
