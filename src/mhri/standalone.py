# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel in a window of its own, for machines without rqt."""
import os
import signal
import socket
import threading

from python_qt_binding.QtCore import QEvent, QSize, QSocketNotifier, QTimer, Signal
from python_qt_binding.QtWidgets import QApplication, QMainWindow
import rospy

from mhri.base.gui import theme
from mhri.base.gui.geometry import fitting, geometry_of, restore_geometry
from mhri.screen.presenters.screen_host import ScreenHost
from mhri.screen.presenters.settings_file import SettingsError, SettingsFile
from mhri.screen.ros.backend import ScreenBackend
from mhri.screen.saved_state import read_geometry

# How soon the number of a new robot is saved: it must survive even a killed program.
KEEP_NUMBERS_MS = 1000


class MainWindow(QMainWindow):
    """A main window around the panel; closing it stops the robots and ends the program."""

    closing = Signal()

    def __init__(self, host):
        super().__init__()
        self._host = host
        self._sure = False
        host.screen.leave_bar.close_requested.connect(self.close_now)
        self.setWindowTitle('mhri')
        self.setCentralWidget(host.screen)
        self.resize(fitting(QSize(1280, 720)))

    def close_now(self):
        """Close, whatever drives or records."""
        self._sure = True
        self.close()

    def closeEvent(self, event):  # noqa: N802
        """Stop the robots before the window goes; ask first while anything drives or records."""
        question = '' if self._sure else self._host.asks_before_closing()
        if question:
            self._host.screen.leave_bar.ask(question)
            event.ignore()
            return
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
    :param settings_path: a JSON file, None for the user's own
    :param remember: False leaves the settings alone, whatever happens
    :param host: the :class:`ScreenHost` to show, None for one that drives
    """

    def __init__(self, argv, settings_path=None, remember=True, host=None):
        self._remember = remember
        self._settings = SettingsFile(settings_path)
        self.host = host or ScreenHost(ScreenBackend(argv))
        self.window = MainWindow(self.host)
        self.window.closing.connect(self.close)
        # The whole program is ours: its tool tips and questions look the same.
        looks = self.host.screen.arrangement
        looks.theme_chosen.connect(lambda name: theme.apply(QApplication.instance(), name))
        theme.apply(QApplication.instance(), looks.theme)
        # Whoever sends a signal cannot be asked.
        self._bell = SignalBell(self.window.close_now)
        self._robots_at_first = None
        self._closed = False
        self._saved = {}
        self._numbers = {}
        self._writing = threading.Lock()
        self._numbers_timer = QTimer()
        self._numbers_timer.setInterval(KEEP_NUMBERS_MS)
        self._numbers_timer.timeout.connect(self._keep_numbers)
        if remember:
            self._numbers_timer.start()

    def restore(self, afresh=False):
        """Take over the settings of the last run, as far as they are usable.

        :param afresh: only the numbers of the robots, which are theirs for good
        """
        problems, saved, placed = [], {}, False
        try:
            saved = self._settings.read()
            self._saved, state = saved, saved.get('state', {})
            if afresh:
                numbers = state.get('numbers', {}) if isinstance(state, dict) else {}
                saved, state = {}, {'numbers': numbers}
            problems += self.host.restore_state(state)
            self._numbers = self.host.operator.selection.numbers.kept()
            if 'geometry' in saved:
                placed = restore_geometry(self.window, read_geometry(saved['geometry']))
        except (SettingsError, ValueError) as error:
            problems.append(str(error))
        if problems:
            rospy.logwarn('left out of the saved settings: %s (the file is kept as %s)',
                          '; '.join(problems)[:500], self._settings.keep_aside())
        if not placed:
            self.window.showMaximized()

    def begin_afresh(self):
        """Keep the saved settings until the operator changes robots or mode in this run.

        Call it when the robots of the command line are in the list.
        """
        self._remember = False
        self._robots_at_first = self.host.operator.selection.robots
        # The mux publishes a mode by itself, so its value does not tell who chose it.
        self.host.screen.mode_requested.connect(self._on_change)

    def _on_change(self, *_):
        self._remember = True

    def _has_changed_robots(self):
        """Tell whether robots came or went in a run that began afresh."""
        return self._robots_at_first not in (None, self.host.operator.selection.robots)

    def _keep_numbers(self):
        """Add the numbers of new robots to the settings as they were read (off the GUI thread)."""
        numbers = self.host.operator.selection.numbers.kept()
        if numbers != self._numbers:
            self._numbers = numbers
            state = self._saved.get('state')
            state = {**(state if isinstance(state, dict) else {}), 'numbers': numbers}
            self.host.operator.do(self._write_unless_closed, {**self._saved, 'state': state})

    def _write_unless_closed(self, settings):
        with self._writing:
            if not self._closed:
                self._write(settings)

    def _write(self, settings):
        try:
            self._settings.write(settings)
        except SettingsError as error:
            rospy.logwarn('the settings are not saved: %s', error)

    def run(self, app):
        """Work until the window is closed; nothing of it may be used after that."""
        app.exec_()
        self.delete_window()

    def delete_window(self):
        """Delete every widget, before the application: Python would in any order, and may crash."""
        self.window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.DeferredDelete)

    def close(self):
        """Stop the robots, save the settings, end."""
        if self._closed:
            return
        self._numbers_timer.stop()
        with self._writing:
            self._closed = True
        # Their zero leaves first: on a busy computer the rest takes a while.
        self.host.operator.select(())
        kept = {'state': self.host.save_state(), 'geometry': geometry_of(self.window)}
        remember = self._remember or self._has_changed_robots()
        self.host.close()
        if remember:
            self._write(kept)
        rospy.signal_shutdown('the panel was closed')
        QApplication.instance().quit()


def make_replay(argv, path):
    """Return the program that shows the replay of a session (blocking: it reads its events).

    :raises NotASession: its events cannot be read
    """
    # Whoever shows no replay need not load it.
    from mhri.replay.presenters.replay_host import make_host
    host = make_host(argv, path)
    program = Standalone(argv, remember=False, host=host)
    program.window.takeCentralWidget()
    program.window.setCentralWidget(host.widget())
    program.window.setWindowTitle('mhri: replay of {}'.format(
        os.path.basename(os.path.normpath(path))))
    return program
