# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel with a view that hangs when it is told to: argv[1] is the folder for the telling.

A file ``sleep`` or ``hold`` there lets the view block while it is painted, asleep or with Python's
lock held, until there is a file ``end``, or the seconds in the file have passed. ``stuck`` is there
while it does; ``place`` says where the stop button is while it is shown [px of the screen].
"""
import ctypes
import json
import os
import sys
import time

from python_qt_binding.QtCore import QTimer
from python_qt_binding.QtWidgets import QWidget

from mhri.driving.gui.stop_bar import StopBar
import mhri.nodes.panel

STEP_S = 0.02


def sleep(end, seconds):
    """Block until there is a file; Python's lock is free."""
    for _ in range(int(seconds / STEP_S)):
        if os.path.exists(end):
            return
        time.sleep(STEP_S)


def hold(end, seconds):
    """Block until there is a file, in one call of C with Python's lock held."""
    ctypes.PyDLL(None).system(
        'i=0; until [ -e "{}" ] || [ $i = {:.0f} ]; do i=$((i + 1)); sleep {}; done'.format(
            end, seconds / STEP_S, STEP_S).encode())


HANGS = {'sleep': sleep, 'hold': hold}


class StuckView(QWidget):
    """A small view."""

    def __init__(self, folder, window):
        super().__init__(window)
        self._folder, self._todo = folder, None
        self.setGeometry(0, 0, 20, 20)
        self.show()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)
        self._timer.start(20)

    def _look(self):
        button = self.window().findChild(StopBar).stop_button
        if button.isVisible():
            at = button.mapToGlobal(button.rect().center())
            self._write('place', json.dumps([at.x(), at.y()]))
        for word in HANGS:
            path = os.path.join(self._folder, word)
            if os.path.exists(path):
                with open(path) as file:
                    self._todo = HANGS[word], float(file.read())
                os.remove(path)
                # What is seen now is to be known to the watch by then.
                QTimer.singleShot(500, self.update)

    def _write(self, name, text):
        path = os.path.join(self._folder, name)
        with open(path + '.part', 'w') as file:
            file.write(text)
        os.rename(path + '.part', path)

    def paintEvent(self, event):  # noqa: N802
        """Hang where that was asked for."""
        if self._todo is not None:
            (hang, seconds), self._todo = self._todo, None
            self._write('stuck', '')
            hang(os.path.join(self._folder, 'end'), seconds)
            os.remove(os.path.join(self._folder, 'stuck'))


def main():
    """Run the panel; the view comes with its window."""
    folder = sys.argv.pop(1)
    made = mhri.nodes.panel.Standalone

    def with_view(*args, **kwargs):
        program = made(*args, **kwargs)
        program.view = StuckView(folder, program.window)
        return program
    mhri.nodes.panel.Standalone = with_view
    mhri.nodes.panel.main()


if __name__ == '__main__':
    main()
