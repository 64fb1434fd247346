# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What lies over the map: the robots that are not on it, and the field for a mark's name."""
from python_qt_binding.QtCore import QPoint, Qt, Signal
from python_qt_binding.QtWidgets import (
    QFrame, QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget)

from mhri.base.gui import theme
from mhri.base.gui.labels import TextLine

# So many robots have a line of their own.
MOST_LINES = 4
NOBODY_SAYS = 'Nobody says where robots are: the task service is not running.'
MOST_NAME = 40


class UnplacedStrip(QFrame):
    """A button in words for each robot that is not on the map; a click places it.

    Buttons are called ``unplaced_<robot>``.
    """

    #: place this robot
    chosen = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._shown = None
        self._build()

    def _build(self):
        """Make room for the lines."""
        self.setObjectName('unplaced')
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        self._column.setSpacing(3)
        self.note = TextLine(self)
        self.note.setAutoFillBackground(True)
        self._column.addWidget(self.note)

    def show_robots(self, robots, answers, large):
        """Show the robots of a scene that are not placed.

        :param answers: whether anybody says where robots are
        :param large: a line for each, or how many there are
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
        lines = missing[:MOST_LINES] if large and answers else []
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
        button = QPushButton(words, self)
        button.setObjectName('unplaced_' + name)
        button.setFont(theme.base_font(self.font()))
        button.setToolTip(words)
        button.setFocusPolicy(Qt.TabFocus)
        button.setMinimumHeight(theme.touch_size(self))
        button.clicked.connect(lambda: self.chosen.emit(name))
        return button

    def fit(self, corner, width):
        """Be at a corner, no wider than there is room."""
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
    """Asks in place what a mark is called: Enter sets it, Escape drops it."""

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
        row = QHBoxLayout(self)
        row.setContentsMargins(4, 4, 4, 4)
        self.edit = QLineEdit(self)
        self.edit.setObjectName('mark_edit')
        self.edit.setPlaceholderText('name of the mark')
        self.edit.setMaxLength(MOST_NAME)
        self.set_button = QPushButton('Set', self)
        self.drop_button = QPushButton('Cancel', self)
        for part in (self.edit, self.set_button, self.drop_button):
            part.setFont(theme.base_font(self.font()))
            part.setMinimumHeight(theme.touch_size(self))
            row.addWidget(part)
        self.edit.setMinimumWidth(theme.text_width(self.edit.font(), 'name of the mark') + 20)
        self.hide()

    def _connect(self):
        """Wire them."""
        self.edit.returnPressed.connect(self._set)
        self.set_button.clicked.connect(self._set)
        self.drop_button.clicked.connect(self._drop)

    def ask(self, pose, pixel):
        """Ask for the name of a mark.

        :param pixel: (x, y) where it is on the map
        """
        self._pose = pose
        self._count += 1
        self.edit.setText('mark {}'.format(self._count))
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
        """Drop it with Escape."""
        if event.key() == Qt.Key_Escape:
            self._drop()
        else:
            QWidget.keyPressEvent(self, event)
