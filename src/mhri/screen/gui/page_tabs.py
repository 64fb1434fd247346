# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tabs of the drawer: an icon and a word for each job, side by side, of equal width."""
from python_qt_binding.QtCore import QRect, QRectF, QSize, Qt
from python_qt_binding.QtGui import QPainter, QPalette
from python_qt_binding.QtWidgets import QTabBar

from mhri.base.gui import icons, theme

# Height of the line below the current tab [px].
_LINE_PX = 4


class PageTabs(QTabBar):
    """Flat tabs; the current one is bold, on a lighter ground, above a line in the accent colour.

    The icon of a tab is the name in its data. Where a tab is too narrow for both, the word stays.
    """

    def tabSizeHint(self, index):  # noqa: N802
        """Return an equal share of the width, and the height for touch."""
        count, width = max(1, self.count()), self.width()
        # The first tabs take the remainder, so that all of the width is used.
        return QSize(width // count + (index < width % count),
                     theme.touch_size(self) + 2 * theme.GRID)

    def minimumTabSizeHint(self, index):  # noqa: N802
        """Return the size for its word."""
        return QSize(theme.text_width(self._bold(), self.tabText(index)) + 2 * theme.GRID,
                     self.tabSizeHint(index).height())

    def sizeHint(self):  # noqa: N802
        """Return the size for all words."""
        return self.minimumSizeHint()

    def minimumSizeHint(self):  # noqa: N802
        """Return the size for all words."""
        hints = [self.minimumTabSizeHint(index) for index in range(self.count())]
        return QSize(len(hints) * max((hint.width() for hint in hints), default=0),
                     theme.touch_size(self) + 2 * theme.GRID)

    def resizeEvent(self, event):  # noqa: N802
        """Recompute the sizes of the tabs."""
        super().resizeEvent(event)
        # Set a property, because Qt caches the sizes of tabs until then.
        self.setIconSize(self.iconSize())

    def _bold(self):
        """Return the font of the current tab."""
        return theme.larger(self.font(), theme.BODY, bold=True)

    def paintEvent(self, event):  # noqa: N802
        """Paint the tabs."""
        painter = QPainter(self)
        for index in range(self.count()):
            self._paint_tab(painter, index, self.tabRect(index))
        if self.hasFocus():
            theme.paint_focus(painter, self.tabRect(self.currentIndex()), self.palette())

    def _paint_tab(self, painter, index, rect):
        """Paint one tab."""
        palette, current = self.palette(), index == self.currentIndex()
        line = QRect(rect.left(), rect.bottom() - _LINE_PX + 1, rect.width(), _LINE_PX)
        if current:
            painter.fillRect(rect, palette.color(QPalette.Button))
            painter.fillRect(line, theme.colour(theme.DRIVE, palette))
        else:
            painter.fillRect(line.adjusted(0, _LINE_PX - 1, 0, 0), theme.line_colour(palette))
        ink = theme.colour(theme.TEXT if current else theme.MUTED, palette)
        painter.setFont(self._bold() if current else self.font())
        painter.setPen(ink)
        side, gap = self.fontMetrics().height(), 2 * theme.GRID
        width = painter.fontMetrics().horizontalAdvance(self.tabText(index))
        whole = side + gap + width
        if whole > rect.width() - gap:
            painter.drawText(rect, Qt.AlignCenter, self.tabText(index))
            return
        left = rect.left() + (rect.width() - whole) / 2.0
        icons.paint_icon(painter, QRectF(left, rect.top(), side, rect.height()),
                         self.tabData(index), ink)
        painter.drawText(QRectF(left + side + gap, rect.top(), width + 1, rect.height()),
                         int(Qt.AlignLeft | Qt.AlignVCenter), self.tabText(index))
