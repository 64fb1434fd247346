# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the calibration page with the pad; everything here runs on the GUI thread.

A process of its own reads the pad (:mod:`mhri.devices.io.pad_stream`), only while the page is
visible. To keep everything still, the page begins with STOP ALL, and the mode leaves the pad.
"""
import json
import os

from python_qt_binding.QtCore import QObject, QProcess, QTimer, Signal

from mhri.base.config import ConfigError
from mhri.base.part import Part
from mhri.base.views import VIRTUAL_JOYSTICK
from mhri.devices.calibration_page import CalibrationPage, READY, SAVING
from mhri.devices.gui.pad_calibration import PadCalibration
from mhri.devices.io.child import command
from mhri.devices.io.pad_calibration import write_profile
from mhri.devices.pads import choose_profile
from mhri.devices.ros.pad_profiles import own_folder, pad_profiles, shipped_names

TITLE = 'Pad'
PAD = 'pad'
# Fast enough for the picture of a stick to follow the hand.
DRAW_MS = 50
# A reading process that has ended is restarted no sooner.
RESTART_MS = 2000
MOST_BYTES = 100_000


class PadHost(QObject, Part):
    """Shows the page, feeds it and writes the result.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param program: the command of the process that reads the pad
    """

    _written = Signal(bool, str, bool)

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.backend, context.screen, parent=context.screen)

    def __init__(self, operator, screen, program=None, parent=None):
        super().__init__(parent)
        self._operator = operator
        self._program = program or command('mhri.devices.io.pad_stream')
        self._dialogue = CalibrationPage(shipped_names())
        self._begun = b''
        self._closed = False
        self._view = None
        self._build(screen)
        self._connect()

    def _build(self, screen):
        self.page = PadCalibration()
        screen.arrangement.add_page(TITLE, self.page)
        self._reader = QProcess(self)
        self._reader.setProcessChannelMode(QProcess.ForwardedErrorChannel)
        self._draw_timer = QTimer(self)
        self._draw_timer.setInterval(DRAW_MS)
        self._restart_timer = QTimer(self)
        self._restart_timer.setSingleShot(True)
        self._restart_timer.setInterval(RESTART_MS)

    def _connect(self):
        self.page.shown.connect(self._on_shown)
        self.page.confirmed.connect(self._confirm)
        self.page.restart_requested.connect(self._dialogue.again)
        self._reader.readyReadStandardOutput.connect(self._read)
        self._reader.finished.connect(self._on_end)
        self._reader.errorOccurred.connect(self._on_error)
        self._draw_timer.timeout.connect(self._draw)
        self._restart_timer.timeout.connect(self._start)
        self._written.connect(self._on_written)

    def show_view(self, view):
        """Take in the :class:`mhri.base.views.PanelView` of this moment."""
        self._view = view
        self._dialogue.on_stop(view.stop_all and view.stop_taken)

    def _on_shown(self, shown):
        """Read the pad while the page is visible."""
        if shown and not self._closed:
            self._start()
            self._draw_timer.start()
        else:
            self._end_reader()
            self._dialogue.close()
            self._draw()

    def _start(self):
        if self._reader.state() == QProcess.NotRunning:
            self._begun = b''
            self._reader.start(self._program[0], self._program[1:])

    def _end_reader(self):
        """End the reading process: it ends by itself when its standard input closes."""
        self._draw_timer.stop()
        self._restart_timer.stop()
        self._reader.closeWriteChannel()

    def _on_end(self, *_):
        """Start reading again if the process failed, or was still ending when it was wanted."""
        if self.page.isVisible() and not self._closed:
            self._dialogue.on_line({'kind': 'absent', 'reason': 'the program for the pad ended'})
            self._restart_timer.start()

    def _on_error(self, error):
        """Start again what could not be started: it does not count as finished."""
        if error == QProcess.FailedToStart:
            self._on_end()

    def _read(self):
        """Take in the output of the process."""
        *lines, self._begun = (self._begun + bytes(self._reader.readAllStandardOutput())
                               ).split(b'\n')
        self._begun = self._begun[-MOST_BYTES:]
        for text in lines:
            try:
                line = json.loads(text)
            except ValueError:
                continue  # ignore what a driver prints on the same channel
            if isinstance(line, dict):
                self._dialogue.on_line(line)

    def _draw(self):
        self.page.show_calibration(self._dialogue.view())

    def _confirm(self):
        """Carry out what the large button says."""
        begins = self._dialogue.state == READY
        self._dialogue.confirm()
        if begins:
            self._leave_pad()
            self._operator.stop_all()
        elif self._dialogue.state == SAVING:
            path = os.path.join(own_folder(), self._dialogue.name + '.yaml')
            self._operator.do(self._save, path, self._dialogue.text(), self._dialogue.replaces,
                              self._dialogue.name, self._dialogue.pad)
        self._draw()

    def _leave_pad(self):
        """Take the mode away from the pad: its buttons would go on choosing robots."""
        view = self._view
        if view and any(device.source == view.mode and device.kind == PAD
                        for device in view.devices):
            self._operator.request_mode(VIRTUAL_JOYSTICK)

    def _save(self, path, text, replace, name, pad):
        """Write the profile (on a worker), and check that it applies to this pad."""
        try:
            write_profile(path, text, replace)
            used = choose_profile(pad_profiles(), *pad)[0].name
        except FileExistsError:
            self._written.emit(False, '{} exists already.'.format(path), True)
        except (OSError, ConfigError) as error:
            self._written.emit(False, 'cannot write {}: {}'.format(
                path, getattr(error, 'strerror', None) or error), False)
        else:
            self._written.emit(True, 'Saved: {}. {}'.format(
                path, 'Choose the pad in "Drive with" to drive with it.' if used == name else
                'But the profile "{}" is for this pad, too, and comes first: remove one of '
                'them.'.format(used)), False)

    def _on_written(self, done, sentence, exists):
        if done:
            self._dialogue.saved(sentence)
        else:
            self._dialogue.refused(sentence, exists)
        self._draw()

    def close(self):
        """End the reading with the screen."""
        self._closed = True
        self._end_reader()
        if self._reader.state() != QProcess.NotRunning and not self._reader.waitForFinished(200):
            self._reader.kill()
            self._reader.waitForFinished(200)
