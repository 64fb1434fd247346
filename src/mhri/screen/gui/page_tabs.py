# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tabs of the drawer: they move together before any of them needs scrolling."""
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QStyle, QStyleOptionTab, QStylePainter, QTabBar

from mhri.base.gui import theme

# Beside the words of a tab there is at least so much [px].
_LEAST_SPACE_PX = 4


class PageTabs(QTabBar):
    """Tabs that are as wide as the style has them, or narrower where there is no room for all."""

    def tabSizeHint(self, index):  # noqa: N802
        """Return the size of a tab; beside their words all have the same space."""
        places = range(self.count())
        size = super().tabSizeHint(index)
        needed = sum(super(PageTabs, self).tabSizeHint(place).width() for place in places)
        if self.isVisible() and needed > self.width():
            widths = [theme.text_width(self.font(), self.tabText(place)) for place in places]
            space = max(_LEAST_SPACE_PX, (self.width() - sum(widths)) // len(widths))
            size.setWidth(min(size.width(), widths[index] + space))
        return size

    minimumTabSizeHint = tabSizeHint  # noqa: N815

    def resizeEvent(self, event):  # noqa: N802
        """Measure the tabs anew."""
        super().resizeEvent(event)
        # Qt keeps the sizes of tabs until something of this kind is set.
        self.setIconSize(self.iconSize())

    def paintEvent(self, event):  # noqa: N802
        """Paint the tabs; the style alone would cut words off to keep its own space."""
        painter = QStylePainter(self)
        current = self.currentIndex()
        for index in sorted(range(self.count()), key=lambda index: index == current):
            option = QStyleOptionTab()
            self.initStyleOption(option, index)
            words, option.text = option.text, ''
            painter.drawControl(QStyle.CE_TabBarTab, option)
            painter.setPen(option.palette.color(option.palette.WindowText))
            painter.drawText(option.rect, int(Qt.AlignCenter | Qt.TextShowMnemonic), words)
