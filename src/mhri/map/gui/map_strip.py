# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Overlays of the map: the robots that are not placed, and the field for a mark's name."""
from python_qt_binding.QtCore import QPoint, Qt, Signal
from python_qt_binding.QtWidgets import QFrame, QWidget

from mhri.base.gui import theme
from mhri.base.gui.controls import Button, LineField
from mhri.base.gui.labels import TextLine
from mhri.base.gui.layouts import in_column, in_row, TIGHT

# Maximum number of robots with their own line.
MAX_LINES = 4
NOBODY_SAYS = 'Nobody says where robots are: the task service is not running.'
MAX_NAME = 40


class UnplacedStrip(QFrame):
    """A text button for each robot that is not on the map; a click selects it for placing.

    Buttons are called ``unplaced_<robot>``.
    """

    #: place this robot
    chosen = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._shown = None
        self._build()

    def _build(self):
        """Make the layout."""
        self.setObjectName('unplaced')
        self.note = TextLine(self)
        self.note.setAutoFillBackground(True)
        self._column = in_column(self.note, of=self, margins=TIGHT, gap=4)

    def show_robots(self, robots, answers, large):
        """Show the robots of a scene that are not placed.

        :param answers: whether the task service reports places
        :param large: one line each, else only their number
        """
        missing = [(robot.number, robot.name, robot.text) for robot in robots
                   if robot.pose is None]
        shown = missing if answers else [], answers, large, len(missing)
        if shown == self._shown:
            return
        self._shown = shown
        while self._column.count() > 1:
            button = self._column.takeAt(1).widget()
            button.hide()
            button.deleteLater()
        lines = missing[:MAX_LINES] if large and answers else []
        for row in lines:
            self._column.addWidget(self._button(*row))
        more = len(missing) - len(lines)
        text = NOBODY_SAYS if not answers else '' if not more else \
            '{}{} not placed'.format('and {} more '.format(more) if lines else '{} '.format(more),
                                     'is' if more == 1 else 'are')
        self.note.show_text(text, theme.ATTENTION)
        self.note.setVisible(bool(text))
        self.setVisible(bool(text or lines))

    def _button(self, number, name, text):
        """Return the button of a robot."""
        words = '{} {} is {}'.format(number or '', name, text).strip()
        if 'not placed' not in text:
            words = '{} {} is not on the map: {}'.format(number or '', name, text).strip()
        button = theme.for_fingers(Button(words, self), 'unplaced_' + name, tip=words)
        button.clicked.connect(lambda: self.chosen.emit(name))
        return button

    def fit(self, corner, width):
        """Move to a corner, at most as wide as the available room."""
        buttons = [self._column.itemAt(index).widget() for index in range(1, self._column.count())]
        for button in buttons:
            whole, metrics = button.toolTip(), button.fontMetrics()
            button.setText(theme.fitting_text(
                metrics, (whole, whole.partition(' is ')[0]), width - metrics.height()))
        hint = max([theme.text_width(self.note.font(), self.note.text())] + [
            button.sizeHint().width() for button in buttons])
        self.setGeometry(corner.x(), corner.y(), max(1, min(width, hint)),
                         self.sizeHint().height())


class NameField(QFrame):
    """Field on the map for the name of a mark: Enter sets it, Escape discards it."""

    #: name, and its pose
    named = Signal(str, object)
    cancelled = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._pose = None
        self._count = 0
        self._build()
        self._connect()

    def _build(self):
        """Make field and buttons."""
        self.setObjectName('mark_name')
        self.setFrameShape(QFrame.StyledPanel)
        self.setAutoFillBackground(True)
        self.edit = LineField(self, objectName='mark_edit', placeholderText='name of the mark',
                              maxLength=MAX_NAME)
        self.set_button = Button('Set', self)
        self.drop_button = Button('Cancel', self)
        for part in (self.edit, self.set_button, self.drop_button):
            part.setFont(theme.base_font(self.font()))
            part.setMinimumHeight(theme.touch_size(self))
        in_row(self.edit, self.set_button, self.drop_button, of=self, margins=(4, 4, 4, 4))
        self.edit.setMinimumWidth(theme.text_width(self.edit.font(), 'name of the mark') + 20)
        self.hide()

    def _connect(self):
        """Wire them."""
        self.edit.returnPressed.connect(self._set)
        self.set_button.clicked.connect(self._set)
        self.drop_button.clicked.connect(self._drop)

    def ask(self, pose, pixel):
        """Prompt for the name of a mark.

        :param pixel: (x, y) of the mark on the map
        """
        self._pose = pose
        self._count += 1
        self.edit.setText('mark_{}'.format(self._count))
        self.edit.selectAll()
        size, room = self.sizeHint(), self.parentWidget().rect()
        corner = QPoint(round(min(pixel[0] + 12, room.width() - size.width())),
                        round(min(pixel[1] + 12, room.height() - size.height())))
        self.setGeometry(max(0, corner.x()), max(0, corner.y()), size.width(), size.height())
        self.show()
        self.raise_()
        self.edit.setFocus(Qt.OtherFocusReason)

    def _set(self):
        self.hide()
        self.named.emit(' '.join(self.edit.text().split()), self._pose)

    def _drop(self):
        self.hide()
        self.cancelled.emit()

    def keyPressEvent(self, event):  # noqa: N802
        """Discard the entry with Escape."""
        if event.key() == Qt.Key_Escape:
            self._drop()
        else:
            QWidget.keyPressEvent(self, event)
