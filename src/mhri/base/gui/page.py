# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The building blocks of the drawer's pages: sections that fold, scrolling, visibility."""
from python_qt_binding.QtCore import QRectF, QSize, Qt, QTimer, Signal
from python_qt_binding.QtGui import QPainter, QPalette
from python_qt_binding.QtWidgets import (
    QAbstractButton, QFrame, QScrollArea, QScrollBar, QSizePolicy, QStyle, QStyleOptionSlider,
    QWidget)

from mhri.base.gui import icons, theme
from mhri.base.gui.layouts import in_column, in_row, TIGHT


class WideScrollBar(QScrollBar):
    """A scroll bar wide enough for touch; a style sheet for that would not follow the theme."""

    def sizeHint(self):  # noqa: N802
        """Return the size for touch."""
        wide, long = round(0.6 * theme.touch_size(self)), super().sizeHint()
        return QSize(wide, long.height()) if self.orientation() == Qt.Vertical else QSize(
            long.width(), wide)

    def paintEvent(self, event):  # noqa: N802
        """Paint the handle alone, where the style has it."""
        painter, palette = QPainter(self), self.palette()
        painter.fillRect(self.rect(), palette.color(QPalette.Window))
        option = QStyleOptionSlider()
        self.initStyleOption(option)
        handle = self.style().subControlRect(
            QStyle.CC_ScrollBar, option, QStyle.SC_ScrollBarSlider, self)
        beside, above = (4, 0) if self.orientation() == Qt.Vertical else (0, 4)
        if self.maximum() > self.minimum():
            theme.paint_box(painter, QRectF(handle).adjusted(
                beside, above, -beside, -above), theme.colour(
                theme.DRIVE, palette) if self.isSliderDown() else theme.edge_colour(palette))


class Scroll(QScrollArea):
    """Scrolls vertically if its contents do not fit, also by touch; keys go to the contents.

    Initially it contains a widget without a layout.
    """

    def __init__(self, parent=None):
        super().__init__(parent, frameShape=QFrame.NoFrame, focusPolicy=Qt.NoFocus,
                         widgetResizable=True, horizontalScrollBarPolicy=Qt.ScrollBarAlwaysOff)
        self.setVerticalScrollBar(WideScrollBar(self))
        self.setWidget(QWidget(self))


class FoldRow(QAbstractButton):
    """A flat row with a title that folds and unfolds what is below it; all of it is the target.

    :param icon: name of an icon of :mod:`mhri.base.gui.icons` before the title
    """

    def __init__(self, title, icon, parent=None):
        super().__init__(parent, checkable=True)
        self._icon = icon
        self.setText(title)
        self.setAccessibleName(title)
        self.setFocusPolicy(Qt.TabFocus)
        self.setAttribute(Qt.WA_Hover)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self.setFont(theme.larger(self.font(), theme.BODY, bold=True))

    def sizeHint(self):  # noqa: N802
        """Return the size for touch."""
        touch = theme.touch_size(self)
        return QSize(theme.text_width(self.font(), self.text()) + 2 * touch, touch)

    def minimumSizeHint(self):  # noqa: N802
        """Return the size for touch, with room for a short title."""
        touch = theme.touch_size(self)
        return QSize(min(self.sizeHint().width(), 7 * touch), touch)

    def paintEvent(self, event):  # noqa: N802
        """Paint a line, the icon, the title, and an arrow that points down while it is open."""
        painter, palette = QPainter(self), self.palette()
        rect, unit = self.rect(), self.fontMetrics().height()
        if self.underMouse():
            painter.fillRect(rect, theme.hover_colour(palette))
        painter.fillRect(rect.adjusted(0, 0, 0, 1 - rect.height()), theme.line_colour(palette))
        ink, quiet = (theme.colour(name, palette) for name in (theme.TEXT, theme.MUTED))
        icons.paint_icon(painter, QRectF(theme.GRID, 0, unit, rect.height()), self._icon, quiet)
        icons.paint_icon(painter, QRectF(rect.width() - unit - theme.GRID, 0, unit, rect.height()),
                         'chevron-down' if self.isChecked() else 'chevron-right', quiet)
        painter.setPen(ink)
        room = rect.adjusted(unit + 3 * theme.GRID, 0, -unit - 2 * theme.GRID, 0)
        painter.drawText(room, int(Qt.AlignLeft | Qt.AlignVCenter), theme.fitting_text(
            self.fontMetrics(), (self.text(),), room.width()))
        if self.hasFocus():
            theme.paint_focus(painter, rect, palette)


class Section(QWidget):
    """A part of a page below a row that folds it; without a title it is always open.

    :param part: the widget to show while it is open
    :param order: its place on the page, from above
    """

    #: it was opened or folded
    toggled = Signal()

    def __init__(self, title, icon, part, order, parent=None):
        super().__init__(parent)
        self.part, self.order = part, order
        self.row = FoldRow(title, icon, self)
        self.row.setObjectName('fold_' + part.objectName())
        self.row.setVisible(bool(title))
        self.row.setChecked(True)
        self.row.toggled.connect(self._fold)
        self._column = in_column(self.row, (part, 1), of=self, margins=TIGHT, gap=theme.GRID)
        part.show()

    @property
    def grows(self):
        """Whether it can use more height than it needs."""
        return self.row.isChecked() and not self.isHidden() and \
            bool(self.part.layout().expandingDirections() & Qt.Vertical)

    def open(self, is_open=True):
        """Open it, or fold it."""
        self.row.setChecked(is_open or not self.row.text())

    def _fold(self, is_open):
        """Show the part or not."""
        self.part.setVisible(is_open)
        self.toggled.emit()


def _focus_chain(part):
    """Return what Tab reaches inside a widget, in order."""
    found, widget = [], part.nextInFocusChain()
    while widget is not part:
        if part.isAncestorOf(widget) and widget.focusPolicy() & Qt.TabFocus:
            found.append(widget)
        widget = widget.nextInFocusChain()
    return found


class SectionPage(Scroll):
    """A page of sections, one below the other; it scrolls if they do not all fit.

    It asks for the width that they need, and scrolls sideways if it gets less. Sections that can
    use more height share what is left over.
    """

    #: minimum height [line heights]
    MIN_UNITS = 10

    def __init__(self, parent=None):
        super().__init__(parent)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarAsNeeded)
        self.setHorizontalScrollBar(WideScrollBar(self))
        self._sections = []
        self._wanted = None
        self._column = in_column(of=self.widget(), margins=TIGHT, gap=2 * theme.GRID)
        self._column.addStretch(0)
        self._reveal_timer = QTimer(self, singleShot=True, interval=0, timeout=self._reveal)

    def minimumSizeHint(self):  # noqa: N802
        """Return the width of its contents with the scroll bar, and a small height."""
        return QSize(self.widget().minimumSizeHint().width()
                     + self.verticalScrollBar().sizeHint().width(),
                     self.MIN_UNITS * self.fontMetrics().height())

    @property
    def sections(self):
        """Its sections, from above."""
        return tuple(self._sections)

    def add(self, section):
        """Add a :class:`Section` at its place."""
        self._sections.append(section)
        self._sections.sort(key=lambda each: each.order)
        place = self._sections.index(section)
        self._column.insertWidget(place, section)
        section.toggled.connect(self.share)
        self.share()
        self._chain()

    def _chain(self):
        """Let Tab go through the sections in their order, to the row of each first."""
        last = None
        for section in self._sections:
            for widget in (section.row, *_focus_chain(section.part)):
                if last is not None:
                    QWidget.setTabOrder(last, widget)
                last = widget

    def share(self):
        """Share the height that is left over."""
        for section in self._sections:
            self._column.setStretchFactor(section, int(section.grows))
        self._column.setStretch(len(self._sections), int(not any(
            section.grows for section in self._sections)))

    def reveal(self, section):
        """Open a section, and scroll to it."""
        section.open()
        self._wanted = section
        # Its place is known once the layout has made room for it.
        self._reveal_timer.start()

    def _reveal(self):
        """Scroll to the wanted section."""
        if self._wanted is not None:
            self.verticalScrollBar().setValue(self._wanted.y())
            self._wanted = None


class Page(QWidget):
    """A page, or a part of one: a column from edge to edge."""

    #: whether it is visible now
    shown = Signal(bool)

    def __init__(self, name, parent=None):
        super().__init__(parent, objectName=name)
        self.setFont(theme.base_font(self.font()))
        self.column = in_column(of=self, margins=TIGHT)

    def showEvent(self, event):  # noqa: N802
        """Report that it is visible."""
        super().showEvent(event)
        self.shown.emit(True)

    def hideEvent(self, event):  # noqa: N802
        """Report that it is hidden."""
        super().hideEvent(event)
        self.shown.emit(False)


class WithTools(QWidget):
    """A view of a robot's data with figures and controls below it, which a tile may place."""

    def lay_out(self, view, *tools):
        """Place the parts.

        :param tools: (widget, share of the width) of each
        """
        #: the figures and controls
        self.tools = QWidget(self)
        in_row(*tools, of=self.tools, margins=TIGHT, gap=8)
        in_column((view, 1), self.tools, of=self, margins=TIGHT, gap=4)
