# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins the window of the doctor with the examination; everything here runs on the GUI thread."""
from python_qt_binding.QtCore import Qt

from mhri.gui.doctor.doctor_window import DoctorWindow
from mhri.gui.screen.placing import place_window


class DoctorHost:
    """Opens the window when it is asked for, and shows what comes of it.

    :param operator: :class:`mhri.ros.screen.backend.ScreenBackend`
    :param panel: the panel's widget
    :param windows: dict of the robots' windows, kept up to date by its owner
    """

    def __init__(self, operator, panel, windows):
        self._operator = operator
        self._panel = panel
        self._windows = windows
        self.window = None
        panel.doctor_requested.connect(self.open)

    def open(self):
        """Show the window, where it covers the panel least, and examine."""
        if self.window is None:
            self.window = DoctorWindow()
            self.window.examine_requested.connect(self._examine)
            self.window.setAttribute(Qt.WA_ShowWithoutActivating)
            place_window(self.window, self._panel, self._windows.values())
        self.window.show()
        self.window.raise_()
        self._examine()

    def _examine(self):
        self.window.show_busy()
        self._operator.examine()

    def show(self, findings, took_s):
        """Show what was found; a sentence in place of the list says why there is none."""
        if self.window is None:
            return
        if isinstance(findings, str):
            self.window.show_failure(findings)
        else:
            self.window.show_findings(findings, took_s)

    def close(self):
        """Close the window with the program."""
        if self.window is not None:
            self.window.close()
