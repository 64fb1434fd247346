# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How long a window takes to come up: a bare one of PyQt's, or the screen of mhri.

``start_up.py bare`` or ``start_up.py screen ROBOT...``; it writes when it was painted and could be
used [s, CLOCK_MONOTONIC], and ends. The screen can be used when the mux has answered.
"""
import sys
import time

from python_qt_binding.QtCore import QTimer
from python_qt_binding.QtWidgets import QApplication


def bare():
    """Show a window with a button."""
    from python_qt_binding.QtWidgets import QMainWindow, QPushButton
    window = QMainWindow()
    window.setCentralWidget(QPushButton('STOP ALL'))
    window.show()
    return window, QApplication.exec_, window.isVisible


def screen(app, robots):
    """Show the screen as its executable does."""
    from mhri.standalone import Standalone
    program = Standalone(['panel'], remember=False)
    program.restore(afresh=True)
    program.window.show()
    program.presenter.start(robots)

    def usable():
        view = program.presenter.operator.view()
        return view.mode is not None and view.control.ours
    return program.window, lambda: program.run(app), usable


def main():
    """Run until it can be used."""
    app = QApplication(sys.argv[:1])
    window, run, usable = bare() if sys.argv[1] == 'bare' else screen(app, sys.argv[2:])

    def look():
        if usable():
            print(time.monotonic(), flush=True)
            window.close()
            app.quit()
    timer = QTimer()
    timer.timeout.connect(look)
    timer.start(5)
    run()


if __name__ == '__main__':
    main()
