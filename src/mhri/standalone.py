# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel in a separate window, for computers without rqt."""
import os
import signal
import socket
import threading

from python_qt_binding.QtCore import QEvent, QSize, QSocketNotifier, QTimer, Signal
from python_qt_binding.QtWidgets import QApplication, QMainWindow
import rospy

from mhri.base.gui import theme
from mhri.base.gui.geometry import fitting, geometry_of, restore_geometry
from mhri.screen.presenters.fresh_start import FreshStart
from mhri.screen.presenters.screen_presenter import ScreenPresenter
from mhri.screen.presenters.settings_file import SettingsError, SettingsFile
from mhri.screen.ros.backend import ScreenBackend
from mhri.screen.saved_state import numbers_of, read_geometry, without_robots

# Delay before the number of a new robot is saved: it must survive even a killed program.
KEEP_NUMBERS_MS = 1000


class MainWindow(QMainWindow):
    """A main window around the panel; closing it stops the robots and ends the program."""

    closing = Signal()

    def __init__(self, presenter):
        super().__init__()
        self._presenter = presenter
        self._sure = False
        presenter.screen.leave_bar.close_requested.connect(self.close_now)
        self.setWindowTitle('mhri')
        self.setCentralWidget(presenter.screen)
        self.resize(fitting(QSize(1280, 720)))

    def close_now(self):
        """Close without a question, even while driving or recording."""
        self._sure = True
        self.close()

    def closeEvent(self, event):  # noqa: N802
        """Stop the robots before the window closes; ask first while driving or recording."""
        question = '' if self._sure else self._presenter.asks_before_closing()
        if question:
            self._presenter.screen.leave_bar.ask(question)
            event.ignore()
            return
        self.closing.emit()
        super().closeEvent(event)


class SignalBell:
    """Wakes Qt's event loop for SIGINT, SIGTERM and SIGHUP, which Python would not handle."""

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
    :param remember: False never saves the settings
    :param presenter: the :class:`ScreenPresenter` to show, None for one that drives
    :param simulated: the robots are simulated: keep nothing about them, and nothing of this run
        for others
    """

    def __init__(self, argv, settings_path=None, remember=True, presenter=None, simulated=False):
        self._remember = remember
        self._simulated = simulated
        self._settings = SettingsFile(settings_path, simulated)
        self.presenter = presenter or ScreenPresenter(ScreenBackend(argv))
        self.window = MainWindow(self.presenter)
        self.window.closing.connect(self.close)
        # The whole program is ours: apply the look to tool tips and dialogs, too.
        looks = self.presenter.screen.arrangement
        looks.theme_chosen.connect(lambda name: theme.apply(QApplication.instance(), name))
        theme.apply(QApplication.instance(), looks.theme)
        # A signal ends the program without a question.
        self._bell = SignalBell(self.window.close_now)
        self._fresh = None
        self._closed = False
        self._saved = {}
        self._numbers = {}
        self._writing = threading.Lock()
        self._numbers_timer = QTimer(interval=KEEP_NUMBERS_MS, timeout=self._keep_numbers)
        if remember and not simulated:
            self._numbers_timer.start()

    def restore(self, afresh=False):
        """Restore the settings of the last run, as far as they are usable.

        :param afresh: whether to restore only the numbers of the robots, which are permanent
        """
        problems, saved, placed = [], {}, False
        try:
            saved = self._settings.read()
            self._saved, state = saved, saved.get('state', {})
            if afresh:
                saved, state = {}, numbers_of(state)
            if self._simulated:
                state = without_robots(state)
            problems += self.presenter.restore_state(state)
            self._numbers = self.presenter.operator.selection.numbers.kept()
            if 'geometry' in saved:
                placed = restore_geometry(self.window, read_geometry(saved['geometry']))
        except (SettingsError, ValueError) as error:
            problems.append(str(error))
        if problems:
            rospy.logwarn('left out of the saved settings: %s (the file is kept as %s)',
                          '; '.join(problems)[:500], self._settings.keep_aside())
        self.presenter.screen.arrangement.begin_text_size()
        if not placed:
            self.window.showMaximized()

    def begin_afresh(self):
        """Keep the saved settings until the operator changes robots or mode in this run.

        Call it when the robots of the command line are in the list.
        """
        self._fresh = FreshStart(self.presenter)

    def _keep_numbers(self):
        """Save the loaded settings with the numbers of new robots (off the GUI thread)."""
        numbers = self.presenter.operator.selection.numbers.kept()
        if numbers != self._numbers:
            self._numbers = numbers
            state = self._saved.get('state')
            state = {**(state if isinstance(state, dict) else {}), 'numbers': numbers}
            self.presenter.operator.do(self._write_unless_closed, {**self._saved, 'state': state})

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
        """Run until the window is closed; the object must not be used after that."""
        app.exec_()
        self.delete_window()

    def delete_window(self):
        """Delete every widget before the application: Python's own order may crash."""
        self.window.deleteLater()
        QApplication.sendPostedEvents(None, QEvent.DeferredDelete)

    def close(self):
        """Stop the robots, save the settings, and end."""
        if self._closed:
            return
        self._numbers_timer.stop()
        with self._writing:
            self._closed = True
        # Send their zeros first: on a busy computer the rest takes a while.
        self.presenter.operator.select(())
        state = self.presenter.save_state()
        kept = {'state': without_robots(state) if self._simulated else state,
                'geometry': geometry_of(self.window)}
        remember = self._remember and (self._fresh is None or self._fresh.is_changed)
        self.presenter.close()
        if remember:
            self._write(kept)
        rospy.signal_shutdown('the panel was closed')
        QApplication.instance().quit()


def make_replay(argv, path):
    """Create the program that shows the replay of a session (blocking: reads the events).

    :raises NotASession: the events cannot be read
    """
    # Loaded only for a replay.
    from mhri.replay.presenters.replay_presenter import make_presenter
    presenter = make_presenter(argv, path)
    program = Standalone(argv, remember=False, presenter=presenter)
    program.window.takeCentralWidget()
    program.window.setCentralWidget(presenter.widget())
    program.window.setWindowTitle('mhri: replay of {}'.format(
        os.path.basename(os.path.normpath(path))))
    return program
