# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A new link as a QR code to scan and an address to copy, over the drawer."""
from python_qt_binding.QtCore import QEvent, QRect, QSize, Qt
from python_qt_binding.QtGui import QGuiApplication, QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.base.gui.labels import plain_label
from mhri.base.gui.layouts import in_column, in_row


class Code(QWidget):
    """A QR code, black on white in every theme: rows of booleans, True for dark."""

    def __init__(self, parent=None):
        super().__init__(parent, objectName='web_code', accessibleName='QR code of the link')
        self._rows = ()
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    def show_rows(self, rows):
        """Show a code with its quiet margin."""
        self._rows = rows
        self.update()

    def minimumSizeHint(self):  # noqa: N802
        """Return the size at which a module has 3 pixels, which a phone can still read."""
        return QSize(*2 * (3 * len(self._rows),))

    def sizeHint(self):  # noqa: N802
        """Return the size at which a phone reads it from an arm's length."""
        return 2 * self.minimumSizeHint()

    def paintEvent(self, event):  # noqa: N802
        """Paint the modules, all of whole pixels."""
        painter, count = QPainter(self), max(1, len(self._rows))
        px = max(1, min(self.width(), self.height()) // count)
        left, top = ((side - px * count) // 2 for side in (self.width(), self.height()))
        painter.fillRect(QRect(left, top, px * count, px * count), Qt.white)
        for y, row in enumerate(self._rows):
            for x, dark in enumerate(row):
                if dark:
                    painter.fillRect(left + px * x, top + px * y, px, px, Qt.black)


class CodeCard(QWidget):
    """Covers the drawer until it is closed, and nothing else: no picture, and not STOP ALL.

    Child widgets: ``web_code``, ``web_url``, ``web_copy_button``, ``web_close_button``.

    :param side: the side of the screen with the drawer
    """

    def __init__(self, side):
        super().__init__(side, objectName='web_card')
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.setAutoFillBackground(True)
        self.title = plain_label(self, '', theme.TITLE, bold=True)
        self.note = plain_label(self)
        self.code = Code(self)
        self.url = plain_label(self)
        self.url.setObjectName('web_url')
        self.copy_button = theme.finger_button(
            self, 'web_copy_button', 'Copy').set_icon('copy')
        self.close_button = theme.finger_button(self, 'web_close_button', 'Close')
        in_column(self.title, self.note, (self.code, 1), self.url,
                  in_row(self.copy_button, 1, self.close_button), of=self,
                  margins=[3 * theme.GRID] * 4, gap=2 * theme.GRID)
        self.hide()

    def _connect(self):
        """Wire the buttons, and follow the size of the drawer."""
        self.close_button.clicked.connect(self.hide)
        self.copy_button.clicked.connect(
            lambda: QGuiApplication.clipboard().setText(self.code.toolTip()))
        self.parentWidget().installEventFilter(self)

    def show_link(self, title, note, url, rows):
        """Show a link.

        :param rows: its QR code, rows of booleans
        """
        self.title.setText(title)
        self.note.setText(note)
        # Offer places to wrap an address that is longer than the drawer is wide.
        self.url.setText(url.replace('/', '/\u200b'))
        self.code.setToolTip(url)
        self.code.show_rows(rows)
        self.show()
        self.raise_()
        self._place()

    def _place(self):
        """Cover the drawer; with little room, leave out what the code needs least."""
        self.setGeometry(self.parentWidget().rect())
        for part in (self.note, self.url):
            part.show()
        for part in (self.url, self.note):
            if self.layout().totalHeightForWidth(self.width()) > self.height():
                part.hide()
        self.layout().activate()

    def keyPressEvent(self, event):  # noqa: N802
        """Close with Escape."""
        if event.key() == Qt.Key_Escape:
            self.hide()
        else:
            super().keyPressEvent(event)

    def eventFilter(self, watched, event):  # noqa: N802
        """Follow the size of the drawer."""
        if event.type() in (QEvent.Resize, QEvent.LayoutRequest) and self.isVisible():
            self._place()
        return False
