# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keyboard of the X server, pressed by xdotool."""
import subprocess

from python_qt_binding.QtCore import QEvent, QObject
from python_qt_binding.QtGui import QWindow
from python_qt_binding.QtWidgets import QApplication


def xdotool(*words):
    """Run xdotool with these arguments."""
    subprocess.run(['xdotool', *map(str, words)], check=True, timeout=120)


class Keyboard(QObject):
    """Presses keys, and waits until Qt has read their releases.

    A release that Qt reads after the next press of the same key counts as one of X's repeats.
    Create it after every other event filter of the application.

    :param until: function (condition, what) that runs Qt until the condition is true
    """

    def __init__(self, until):
        super().__init__()
        self._until = until
        self._released = 0
        QApplication.instance().installEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802
        """Count the releases that reach a window."""
        if event.type() == QEvent.KeyRelease and isinstance(watched, QWindow) \
                and not event.isAutoRepeat():
            self._released += 1
        return False

    def press(self, *keys):
        """Press keys and release them, one after the other, e.g. 'shift+Tab'."""
        for key in keys:
            self._released = 0
            xdotool('key', key)
            self._until_released(len(key.split('+')), key)

    def type(self, text):
        """Type a text."""
        xdotool('type', '--delay', '20', text)

    def release(self, key):
        """Release a key that is held."""
        self._released = 0
        xdotool('keyup', key)
        self._until_released(1, key)

    def _until_released(self, count, key):
        self._until(lambda: self._released >= count, 'the release of ' + key)

    def close(self):
        """Stop counting."""
        QApplication.instance().removeEventFilter(self)
