# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A page of the drawer that scrolls up and down where the screen is not high enough for it."""
from python_qt_binding.QtCore import QSize, Qt
from python_qt_binding.QtWidgets import QFrame, QScrollArea

from mhri.base.gui.wide_scroll_bar import WideScrollBar


class ScrolledPage(QScrollArea):
    """As wide as what is in it, which is not made smaller than a finger hits."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self._build()

    def _build(self):
        """Set what never changes."""
        self.setFrameShape(QFrame.NoFrame)
        self.setFocusPolicy(Qt.NoFocus)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarAlwaysOff)
        self.setVerticalScrollBar(WideScrollBar(self))

    def minimumSizeHint(self):  # noqa: N802
        """Return the size of what is in it, and of the bar: it scrolls if it has less."""
        inside = self.widget().minimumSizeHint() if self.widget() else QSize()
        return inside + QSize(self.verticalScrollBar().sizeHint().width(), 0)
