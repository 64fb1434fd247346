# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lets STOP work while the GUI thread hangs: that thread sends a beat to a separate process.

A thread would not do: C++ code that paints may hold Python's lock, and then no thread runs.
"""
import json
import socket
import subprocess

from python_qt_binding.QtCore import QObject, QTimer, Signal
from python_qt_binding.QtGui import QGuiApplication
import rospy

from mhri.devices.io import child
from mhri.driving.gui.stop_button import stop_places
from mhri.screen.hang import BEAT_S

_PROCESS = 'mhri.screen.presenters.stop_watch_process'
# A watch that was ended from elsewhere, or cannot be started, is tried again after so many beats.
_AGAIN_AFTER = 50


class StopWatch(QObject):
    """Starts the watch and sends it beats; it watches all visible windows of the program.

    :param master_uri: the master of the mux
    """

    #: what the watch did while this screen could not: a sentence
    said = Signal(str)

    def __init__(self, master_uri, parent=None):
        super().__init__(parent)
        self._master_uri = master_uri
        self._process = self._socket = None
        self._beats_to_start = 0
        self._told = False
        self._timer = QTimer(self)
        self._timer.setInterval(round(1000 * BEAT_S))
        self._timer.timeout.connect(self._beat)

    def start(self):
        """Start; without an X server, log once that this is not available."""
        if QGuiApplication.platformName() == 'xcb':
            self._timer.start()
        else:
            self._cannot('it needs an X server')

    def _cannot(self, why):
        rospy.logwarn('STOP ALL of this screen does not work while it hangs: %s', why)

    def _start_process(self):
        """Start the process.

        :raises OSError: there is no room for it now
        """
        ours, end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with end:
            try:
                self._process = subprocess.Popen(
                    child.command(_PROCESS, self._master_uri), stdin=end)
            except OSError:
                ours.close()
                raise
        ours.setblocking(False)
        self._socket = ours

    def _is_started(self):
        """Start the process where it is time to; tell whether it is there.

        A computer that has no room for a process often has some a little later.
        """
        if self._socket is None:
            self._beats_to_start -= 1
            if self._beats_to_start >= 0:
                return False
            try:
                self._start_process()
            except OSError as error:
                self._beats_to_start = _AGAIN_AFTER
                if not self._told:
                    self._cannot('its watch cannot be started, but is tried again: {}'.format(
                        error))
                self._told = True
                return False
            self._told = False
        return True

    def _beat(self):
        """Send a sign of life, and take in what the watch says."""
        if not self._is_started():
            return
        try:
            words = self._hear()
            if 'cannot' in words:
                self.close()
                self._cannot(words['cannot'])
                return
            self._socket.send(json.dumps(stop_places()).encode())
        except BlockingIOError:
            pass  # it has not read the last ones; it will
        except OSError:
            self._end_process()
            self._beats_to_start = _AGAIN_AFTER
            return
        if 'said' in words:
            rospy.logwarn(words['said'])
            self.said.emit(words['said'])

    def _hear(self):
        """Return what the watch has said, {} for nothing.

        :raises OSError: it has gone
        """
        try:
            packet = self._socket.recv(4096)
        except BlockingIOError:
            return {}
        if not packet:
            raise ConnectionError('the watch has gone')
        return json.loads(packet.decode())

    def close(self):
        """End the watch."""
        self._timer.stop()
        self._end_process()

    def _end_process(self):
        """End the process, which has nothing to lose."""
        if self._process is not None:
            self._socket.close()
            self._process.kill()
            self._process.wait()
            self._process = self._socket = None
