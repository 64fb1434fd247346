# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen in this process, with robots, to be measured."""
from support.ros_system import wait_for

TIMEOUT_S = 60.0


class LiveScreen:
    """A screen that has begun: every robot is live, and has its tile.

    :param size: of the window [px]
    :param restored: names of the robots that are in its list as it begins
    :param selected: names of further ones, which are checked
    """

    def __init__(self, size, restored=(), selected=()):
        from python_qt_binding.QtWidgets import QApplication
        from mhri.screen.presenters.screen_presenter import ScreenPresenter
        from mhri.screen.ros.backend import ScreenBackend
        self._app = QApplication(['panel'])
        self.presenter = ScreenPresenter(ScreenBackend(['panel']))
        self.operator = self.presenter.operator
        self.presenter.screen.resize(*size)
        self.presenter.screen.show()
        self.presenter.start(restored, selected)
        names = (*restored, *selected)
        self.until(lambda: len(self.presenter.windows) == len(names) and all(
            self.operator.robot_view(name).link == 'live' for name in names), 'the robots')

    def until(self, condition, what):
        """Let Qt work until a condition comes true."""
        wait_for(condition, TIMEOUT_S, what, turn=self._app.processEvents)

    def run(self, seconds):
        """Let Qt work for some seconds, without a measurement's own work."""
        from python_qt_binding.QtCore import QTimer
        QTimer.singleShot(round(seconds * 1000), self._app.quit)
        self._app.exec_()

    def close(self):
        """Close it; delete every widget before the application: Python's own order may crash."""
        from python_qt_binding.QtCore import QEvent
        self.presenter.close()
        self.presenter.screen.deleteLater()
        self._app.sendPostedEvents(None, QEvent.DeferredDelete)
