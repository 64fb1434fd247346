# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A layout that wraps its widgets into lines, like text."""
from python_qt_binding.QtCore import QRect, QSize, Qt
from python_qt_binding.QtWidgets import QLayout, QSizePolicy


class FlowLayout(QLayout):
    """Widgets side by side, on as many lines as needed.

    Expanding widgets share the remaining width of a line; none is wider than the layout.

    :param gap: space between two widgets of a line [px]
    :param line_gap: space between two lines [px]
    """

    def __init__(self, parent=None, gap=8, line_gap=4):
        super().__init__(parent)
        self._gap, self._line_gap = gap, line_gap
        self._items = []
        self.setContentsMargins(0, 0, 0, 0)

    def addItem(self, item):  # noqa: N802
        """Append an item."""
        self._items.append(item)

    def count(self):
        """Return the number of items, including hidden ones."""
        return len(self._items)

    def itemAt(self, index):  # noqa: N802
        """Return an item, None if the index is out of range."""
        return self._items[index] if 0 <= index < len(self._items) else None

    def takeAt(self, index):  # noqa: N802
        """Remove and return an item, None if the index is out of range."""
        return self._items.pop(index) if 0 <= index < len(self._items) else None

    def expandingDirections(self):  # noqa: N802
        """Return no directions: the layout does not use extra space."""
        return Qt.Orientations()

    def hasHeightForWidth(self):  # noqa: N802
        """Return True: the height depends on the width."""
        return True

    def heightForWidth(self, width):  # noqa: N802
        """Return the height of all lines [px] at a width [px]."""
        lines = self._lines(width)
        return sum(height for _, height in lines) + self._line_gap * max(0, len(lines) - 1)

    def sizeHint(self):  # noqa: N802
        """Return the size of all items in one line."""
        hints = [item.sizeHint() for item in self._seen()]
        return QSize(sum(hint.width() for hint in hints) + self._gap * max(0, len(hints) - 1),
                     max([hint.height() for hint in hints], default=0))

    def minimumSize(self):  # noqa: N802
        """Return the size that fits the widest and the highest item."""
        least = [item.minimumSize() for item in self._seen()]
        return QSize(max([size.width() for size in least], default=0),
                     max([size.height() for size in least], default=0))

    def setGeometry(self, rect):  # noqa: N802
        """Place the widgets."""
        super().setGeometry(rect)
        y = rect.y()
        for items, height in self._lines(rect.width()):
            widths = [self._width_of(item, rect.width()) for item in items]
            wide = [bool(item.expandingDirections() & Qt.Horizontal) for item in items]
            left = rect.width() - sum(widths) - self._gap * (len(items) - 1)
            x = rect.x()
            for item, width, more in zip(items, widths, wide):
                width += left // sum(wide) if more else 0
                item.setGeometry(QRect(x, y, width, height))
                x += width + self._gap
            y += height + self._line_gap

    def _seen(self):
        """Return the items that are not hidden."""
        return [item for item in self._items if not item.isEmpty()]

    @staticmethod
    def _width_of(item, width):
        """Return the width of an item in lines of a width [px]."""
        return min(item.sizeHint().width(), width)

    def _lines(self, width):
        """Return ([items], height [px]) of each line."""
        lines, x = [], 0
        for item in self._seen():
            needed = self._width_of(item, width)
            high = item.heightForWidth(needed) if item.hasHeightForWidth() \
                else item.sizeHint().height()
            if lines and x + needed <= width:
                lines[-1] = (lines[-1][0] + [item], max(lines[-1][1], high))
            else:
                lines.append(([item], high))
                x = 0
            x += needed + self._gap
        return lines


def let_height_follow(widget):
    """Make the height of a widget with such a layout follow its width."""
    policy = QSizePolicy(QSizePolicy.Preferred, QSizePolicy.Preferred)
    policy.setHeightForWidth(True)
    widget.setSizePolicy(policy)
