# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lets STOP work while the GUI thread hangs: a beat from it to a process of its own.

A thread would not do: what paints in C++ may hold Python's lock, and no thread runs then.
"""
import json
import socket
import subprocess

from python_qt_binding.QtCore import QObject, QTimer, Signal
from python_qt_binding.QtGui import QGuiApplication
import rospy

from mhri.core.screen.hang import BEAT_S
from mhri.gui.driving.stop_button import stop_places
from mhri.inputs import child

_PROCESS = 'mhri.presenters.stop_watch_process'
# A watch that was ended from elsewhere is started again after so many beats.
_AGAIN_AFTER = 50


class StopWatch(QObject):
    """Starts the watch and beats for it; everything that can be seen of the program is watched.

    :param master_uri: the master of the mux
    """

    #: what the watch did while nobody here could: a sentence
    said = Signal(str)

    def __init__(self, master_uri, parent=None):
        super().__init__(parent)
        self._master_uri = master_uri
        self._process = self._socket = None
        self._beats_to_start = 0
        self._timer = QTimer(self)
        self._timer.setInterval(round(1000 * BEAT_S))
        self._timer.timeout.connect(self._beat)

    def start(self):
        """Begin; where there is no X server it is said once that this cannot be had."""
        if QGuiApplication.platformName() == 'xcb':
            self._timer.start()
        else:
            self._cannot('it needs an X server')

    def _cannot(self, why):
        rospy.logwarn('STOP ALL of this screen does not work while it hangs: %s', why)

    def _start_process(self):
        """Start the process."""
        self._socket, end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with end:
            self._process = subprocess.Popen(child.command(_PROCESS, self._master_uri), stdin=end)
        self._socket.setblocking(False)

    def _beat(self):
        """Say that this thread lives, and hear what the watch has to say."""
        if self._socket is None:
            self._beats_to_start -= 1
            if self._beats_to_start >= 0:
                return
            self._start_process()
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
