# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel in a window of its own, for machines without rqt."""
import json
import signal
import socket

from python_qt_binding.QtCore import QSettings, QSocketNotifier, Signal
from python_qt_binding.QtGui import QGuiApplication
from python_qt_binding.QtWidgets import QApplication, QMainWindow
import rospy

from mhri.presenters.panel_host import PanelHost
from mhri.ros.screen.backend import ScreenBackend


class PanelWindow(QMainWindow):
    """A main window around the panel; closing it stops the robots and ends the program."""

    closing = Signal()

    def __init__(self, host):
        super().__init__()
        self._host = host
        self.setWindowTitle('mhri')
        self.setCentralWidget(host.panel)
        self.resize(940, 600)

    def closeEvent(self, event):  # noqa: N802
        """Stop the robots before the window goes."""
        self.closing.emit()
        super().closeEvent(event)


class SignalBell:
    """Wakes Qt's event loop for SIGINT, SIGTERM and SIGHUP, which Python alone would not see."""

    def __init__(self, on_signal):
        self._reading, self._writing = socket.socketpair()
        self._writing.setblocking(False)
        self._notifier = QSocketNotifier(self._reading.fileno(), QSocketNotifier.Read)
        self._notifier.activated.connect(lambda *_: on_signal())
        signal.set_wakeup_fd(self._writing.fileno())
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: None)


class Standalone:
    """The program: settings, signals, window.

    :param argv: the node's command line
    :param settings_path: an INI file, None for the user's own
    :param remember: False leaves the settings alone, whatever happens
    """

    def __init__(self, argv, settings_path=None, remember=True):
        self._remember = remember
        self._settings = QSettings(settings_path, QSettings.IniFormat) if settings_path else \
            QSettings('mhri', 'panel')
        self.host = PanelHost(ScreenBackend(argv))
        self.window = PanelWindow(self.host)
        self.window.closing.connect(self.close)
        self._bell = SignalBell(self.window.close)
        self._robots_at_first = None
        self._closed = False

    def restore(self):
        """Take over the settings of the last run."""
        try:
            self.host.restore_state(json.loads(self._settings.value('state', '{}')))
        except (ValueError, TypeError, AttributeError) as error:
            rospy.logwarn('the saved settings cannot be used and are left out: %s', error)
        geometry = self._settings.value('geometry')
        if geometry is not None:
            self.window.restoreGeometry(geometry)
        else:
            # In a corner, and not in the middle, it leaves room for the robots' windows.
            self.window.move(QGuiApplication.primaryScreen().availableGeometry().topLeft())

    def begin_afresh(self):
        """Keep the saved settings until the operator changes robots, mode or limits in this run.

        Call it when the robots of the command line are in the list.
        """
        self._remember = False
        self._robots_at_first = self.host.operator.selection.robots
        panel = self.host.panel
        # The mux tells a mode and limits by itself, so that their values do not say who chose them.
        for signal_ in (panel.mode_requested, panel.limits_requested, panel.together_requested):
            signal_.connect(self._on_change)

    def _on_change(self, *_):
        self._remember = True

    def _has_changed_robots(self):
        """Tell whether robots came or went in a run that began afresh."""
        return self._robots_at_first not in (None, self.host.operator.selection.robots)

    def close(self):
        """Stop the robots, save the settings, end."""
        if self._closed:
            return
        self._closed = True
        state = json.dumps(self.host.save_state())
        remember = self._remember or self._has_changed_robots()
        self.host.close()
        if remember:
            self._settings.setValue('state', state)
            self._settings.setValue('geometry', self.window.saveGeometry())
            self._settings.sync()
        rospy.signal_shutdown('the panel was closed')
        QApplication.instance().quit()
