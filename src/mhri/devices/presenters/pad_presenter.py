# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the calibration page with the pad; everything here runs on the GUI thread.

A separate process reads the pad (:mod:`mhri.devices.io.pad_stream`), only while the page is
visible. So that no robot moves, the page begins with STOP ALL, and the mode is switched away from
the pad.
"""
import os

from python_qt_binding.QtCore import QObject, QTimer, Signal

from mhri.base.config import ConfigError
from mhri.base.part import Part, SETUP
from mhri.base.views import VIRTUAL_JOYSTICK
from mhri.devices.calibration_page import CalibrationPage, READY, SAVING
from mhri.devices.gui.pad_calibration import PadCalibration
from mhri.devices.io.child import Child
from mhri.devices.pads import choose_profile
from mhri.devices.ros.pad_profiles import (
    own_folder, pad_profiles, shipped_names, write_profile)

TITLE = 'Pad'
PAD = 'pad'
# Fast enough for the picture of a stick to follow the hand without visible delay.
DRAW_MS = 50
# Delay before an ended reading process is restarted.
RESTART_MS = 2000


class PadPresenter(QObject, Part):
    """Shows the page, feeds it and writes the result.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    """

    _written = Signal(bool, str, bool)

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`."""
        return cls(context.backend, context.screen, parent=context.screen)

    def __init__(self, operator, screen, parent=None):
        super().__init__(parent)
        self._operator = operator
        self._dialogue = CalibrationPage(shipped_names())
        self._child = None
        self._closed = False
        self._view = None
        self._build(screen)
        self._connect()

    def _build(self, screen):
        self.page = PadCalibration()
        screen.arrangement.add_section(SETUP, TITLE, self.page, 20, 'gamepad-2')
        self._draw_timer = QTimer(self, interval=DRAW_MS, timeout=self._draw)
        self._restart_timer = QTimer(self, singleShot=True, interval=RESTART_MS)

    def _connect(self):
        self.page.shown.connect(self._on_shown)
        self.page.confirmed.connect(self._confirm)
        self.page.restart_requested.connect(self._dialogue.again)
        self._restart_timer.timeout.connect(self._start)
        self._written.connect(self._on_written)

    def show_view(self, view):
        """Handle the :class:`mhri.base.views.ScreenView` of this moment."""
        self._view = view
        self._dialogue.on_stop(view.stop_all and view.stop_taken)

    def _on_shown(self, shown):
        """Read the pad while the page is visible."""
        if shown and not self._closed:
            self._start()
            self._draw_timer.start()
        else:
            self._end()
            self._dialogue.close()
            self._draw()

    def _start(self):
        """Start the process that reads the pad; if that fails, retry later."""
        try:
            self._child = self._child or Child('mhri.devices.io.pad_stream', stderr=None)
        except OSError:
            self._lose()

    def _end(self):
        """End the process at once: it has no state to save."""
        self._draw_timer.stop()
        self._restart_timer.stop()
        if self._child is not None:
            self._child.end()
            self._child = None

    def _lose(self):
        """Show that the pad is not being read, and restart a little later."""
        self._child = None
        self._dialogue.on_line({'kind': 'absent', 'reason': 'the program for the pad ended'})
        self._restart_timer.start()

    def _draw(self):
        """Handle the messages of the process, and show the result."""
        try:
            for line in self._child.messages() if self._child is not None else ():
                self._dialogue.on_line(line)
        except EOFError:
            self._child.end()
            self._lose()
        self.page.show_calibration(self._dialogue.view())

    def _confirm(self):
        """Carry out the action of the large button."""
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
        """Switch the mode away from the pad, whose buttons would keep selecting robots."""
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

    def close(self, forget=False):
        """Stop reading at the end of the screen."""
        self._closed = True
        self._end()
