# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot in the list: its name and type, its link and its state."""
from python_qt_binding.QtCore import QPoint, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette
from python_qt_binding.QtWidgets import QGridLayout, QSizePolicy, QWidget

from mhri.base import views
from mhri.base.brake_view import brake_words, guard_words
from mhri.base.gui import theme, words
from mhri.base.gui.controls import Button
from mhri.base.gui.first_press import first_press
from mhri.base.gui.labels import BatteryLine, Pill, plain_tip, Sign, TextLine
from mhri.base.gui.layouts import in_row
from mhri.base.gui.long_press import LongPress
from mhri.base.gui.robot_sign import RobotNumber
from mhri.base.gui.switches import SquareBox
from mhri.base.task_words import interrupted_line, task_lines
from mhri.robots.gui.tile_words import DRIVING, ON_TASK
from mhri.robots.owners import ASK_FOR, TAKE_IT

CARRY_ON = 'Continue'
MOVING = 'moving'
RECORDING = 'rec'
_EDGE_PX = 6

_CONTROL_TIPS = {ASK_FOR: 'its screen is told that you ask; then you can take control',
                 TAKE_IT: 'the robot stops, and moves for you once your stick is centred'}


class RobotRow(QWidget):
    """Two lines of fixed height: identity and link; below them speed, then turn or a problem.

    The speed is hidden only for the reason why a task waits; old values are dimmed.
    """

    #: the check box was clicked: name, checked
    checked = Signal(str, bool)
    #: a click: name of the robot
    clicked = Signal(str)
    #: a double click: name of the robot that had the first press
    opened = Signal(str)
    #: it is to continue its interrupted task
    carry_on_requested = Signal(str)
    #: control of it is requested from another host
    ask_requested = Signal(str)
    #: a right click or a long press: name of the robot, and the place on the desktop
    menu_requested = Signal(str, QPoint)

    def __init__(self, name, parent=None):
        super().__init__(parent)
        self.name = name
        self._tone = None
        self._current = False
        self._changed_with = None
        self._trouble_shown = None
        self._build()
        self._connect()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('row_' + self.name)
        font = theme.base_font(self.font())
        numbers = theme.number_font(font)
        self.number = RobotNumber(self)
        self.number.setFont(theme.larger(numbers, theme.HEAD))
        self.box = SquareBox('', self)
        self.box.setObjectName('check_' + self.name)
        self.box.setAccessibleName('drive {}'.format(self.name))
        self.title = TextLine(self)
        self.title.setFont(theme.larger(font, theme.TITLE, bold=True))
        self.title.show_text(self.name, shorter=words.name_ends(self.name))
        # In a narrow dock the name is the last to be shortened: the type goes first, then the age.
        self.title.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        self.title.setMaximumWidth(theme.text_width(self.title.font(), self.name))
        self.title.setMinimumWidth(theme.text_width(
            self.title.font(), words.usual_name(self.name)))
        self.kind = TextLine(self)
        self.kind.setMinimumWidth(1)
        self.sign = Sign(self)
        self.link = self._fixed_line(numbers, 'waiting')
        self.recording = Pill(self)
        self.recording.set_words((RECORDING,))
        self.age = self._fixed_line(numbers, '000 ms', Qt.AlignRight)
        self.linear = self._fixed_line(numbers, 'back 0.00 m/s')
        self.turn = self._fixed_line(numbers, 'right 0.00 rad/s')
        # In a narrow drawer the age goes, and the turn drops its unit; beside a sentence the speed
        # takes only the room of its present text.
        for line in (self.age, self.linear, self.turn):
            line.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        self.age.setMinimumWidth(1)
        self.turn.setMinimumWidth(1)
        self._least_linear = theme.text_width(numbers, '0.00 m/s')
        self.linear.setMinimumWidth(self._least_linear)
        self.trouble_sign = Sign(self)
        self.trouble = TextLine(self)
        self.filler = TextLine(self)
        self.filler.setMinimumWidth(1)
        self.pill = Pill(self)
        self.pill.set_words((DRIVING, MOVING))
        self.task_pill = Pill(self)
        self.task_pill.set_words((ON_TASK,))
        self.task_pill.show_word(ON_TASK, theme.TASK)
        self.task_pill.hide()
        self.carry_on_button = self._button('carry_on_', CARRY_ON)
        self.ask_button = self._button('ask_', '')
        self.battery = self._fixed_line(numbers, '100 %', Qt.AlignRight, BatteryLine)
        self._lay_out()

    def _button(self, prefix, text):
        """Make a button of touch size that is not always visible."""
        button = theme.for_fingers(Button(text, self), prefix + self.name)
        button.hide()
        return button

    def _fixed_line(self, font, sample, align=Qt.AlignLeft, kind=TextLine):
        """Make a line for a number, as wide as the sample."""
        line = kind(self)
        line.setFont(font)
        line.fix_width(sample)
        line.setAlignment(align | Qt.AlignVCenter)
        return line

    def _lay_out(self):
        """Place the parts on two lines."""
        unit = self.fontMetrics().height()
        grid = QGridLayout(self)
        grid.setContentsMargins(_EDGE_PX + 2, unit // 4, unit // 2, unit // 4)
        grid.setHorizontalSpacing(unit // 3)
        grid.setVerticalSpacing(0)
        first = in_row(self.title, self.task_pill, (self.kind, 1), self.recording, self.sign,
                       self.link, self.age, gap=unit // 3)
        second = in_row(self.linear, self.trouble_sign, (self.trouble, 1), self.turn,
                        (self.filler, 1), self.pill, self.battery, gap=unit // 3)
        grid.addWidget(self.number, 0, 0, 2, 1)
        grid.addWidget(self.box, 0, 1, 2, 1)
        grid.addLayout(first, 0, 2)
        grid.addLayout(second, 1, 2)
        grid.addWidget(self.carry_on_button, 0, 3, 2, 1)
        grid.addWidget(self.ask_button, 0, 4, 2, 1)
        grid.setColumnStretch(2, 1)
        self._show_trouble(None, '')
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        self.setFixedHeight(max(theme.touch_size(self) + unit // 2, round(unit * 3.1)))

    def _connect(self):
        """Wire the check box; only clicks count, not what the view sets."""
        self.box.clicked.connect(self._on_box)
        self.carry_on_button.clicked.connect(self._on_carry_on)
        self.ask_button.clicked.connect(self._on_ask)
        LongPress(self).held.connect(self._on_long_press)

    # Methods, no lambdas that hold the row: those crash PyQt when it is destroyed.

    def _on_box(self, on):
        self.checked.emit(self.name, on)

    def _on_carry_on(self):
        self.carry_on_requested.emit(self.name)

    def _on_ask(self):
        self.ask_requested.emit(self.name)

    def _on_long_press(self, place):
        self.menu_requested.emit(self.name, self.mapToGlobal(place))

    def contextMenuEvent(self, event):  # noqa: N802
        """Ask for the menu of the robot."""
        self.menu_requested.emit(self.name, event.globalPos())

    def show_view(self, view, checked, numbers=True):
        """Show a robot.

        :param view: :class:`mhri.base.views.RobotView`
        :param checked: whether the box is ticked
        :param numbers: whether numbers may change now; a changed state always shows at once
        """
        numbers = numbers or view.changed_with != self._changed_with
        self._changed_with = view.changed_with
        self.number.show_number(view.number)
        self.box.setChecked(checked)
        self.kind.show_text(words.type_text(view), theme.MUTED, (view.type_label, ''))
        self.sign.show_sign(theme.LINK_SIGNS[view.link])
        self.link.show_text(words.LINK_WORDS[view.link])
        if numbers:
            self._show_numbers(view)
        self._show_second_line(view)
        self.recording.show_word(RECORDING if view.recording else '', filled=False)
        self.recording.setVisible(view.recording)
        self._offer_to_carry_on(view.carry_on)
        self._offer_control(view.ask)
        # A waiting robot stands still: use the room for the reason.
        self.linear.setVisible(not (view.ask or view.carry_on or view.on_task and view.task
                                    and view.task.waits))
        tone = theme.TASK if view.on_task else theme.DRIVE if view.driven else None
        if tone != self._tone:
            self._tone = tone
            self.update()

    def _offer_to_carry_on(self, label):
        """Offer to continue a task; '' hides the button."""
        self.carry_on_button.setVisible(bool(label))
        if label:
            text = '{} {} of {}'.format(CARRY_ON, label.lower(), self.name)
            self.carry_on_button.setAccessibleName(text)
            self.carry_on_button.setToolTip(plain_tip(text))

    def _offer_control(self, text):
        """Offer to ask for control, or to take it; '' hides the button."""
        self.ask_button.setVisible(bool(text))
        # The button takes the room of values that the tile shows, too.
        for part in (self.age, self.battery):
            part.setVisible(not text)
        if text != self.ask_button.text():
            self.ask_button.setText(text)
            self.ask_button.setAccessibleName('{} of {}'.format(text, self.name))
            self.ask_button.setToolTip(plain_tip(_CONTROL_TIPS.get(text, '')))

    def _show_numbers(self, view):
        """Show the values that change all the time."""
        self.age.show_text(words.link_age(view), theme.MUTED, ('',))
        self.setToolTip('\n'.join(filter(None, (
            words.figures_text(view.figures), brake_words(view.brake),
            guard_words(view.brake)))))
        old = view.link != views.LIVE
        tone = theme.MUTED if old else theme.TEXT
        linear, turn = words.motion_texts(view)
        self.linear.show_text(linear, tone, (linear.rpartition(' ')[0] or linear,))
        self.turn.show_text(turn, tone, words.turn_shorter(turn))
        self.battery.show_charge(view.battery, old)

    def _show_second_line(self, view):
        """Show the proof of a stop, a problem of the link, or how the robot moves."""
        self.task_pill.setVisible(view.on_task)
        if view.driven and not view.on_task:
            self.pill.show_word(DRIVING)
        else:
            self.pill.show_word(MOVING if view.moving and not view.on_task else '', theme.ATTENTION,
                                filled=False)
        if view.proof is not None:
            shorter = words.endings(view.proof.text) \
                if view.proof.state == views.PROOF_STOPPED else words.proof_shorter(view.proof)
            self._show_trouble(theme.PROOF_SIGNS[view.proof.state], view.proof.text, *shorter,
                               loud=view.proof.state == views.PROOF_NOT_CONFIRMED)
        elif view.link != views.LIVE:
            self._show_trouble(None, view.note or words.LINK_WORDS[view.link])
        elif view.task is not None:
            self._show_trouble(theme.TASK_WAITS if view.task.waits or view.slow else theme.ON_TASK,
                               *task_lines(view.task))
        elif view.carry_on and not view.note:
            self._show_trouble(None, interrupted_line(view.carry_on))
        else:
            sign = theme.WARNING if view.slow else None
            self._show_trouble(sign, view.note, with_state=True)

    def _show_trouble(self, sign, text, *shorter, loud=False, with_state=False):
        """Show a sentence in place of the turn; '' brings the turn back.

        :param shorter: the same in fewer and fewer words, by default its beginnings
        :param with_state: leave the robot's state beside the sentence
        """
        speaking = bool(text)
        state = with_state or not speaking
        self.trouble_sign.show_sign(sign)
        font = self.trouble.font()
        if font.bold() != loud:
            font.setBold(loud)
            self.trouble.setFont(font)
        # If hardly a letter fits beside a pill, the sign alone is enough.
        self.trouble.show_text(text, shorter=shorter or (
            *words.beginnings(text, most=3), *(('',) if with_state and self.pill.word else ())))
        # A sentence takes the room of an empty pill.
        state = state and bool(self.pill.word or not speaking)
        if (speaking, state, sign is None) == self._trouble_shown:
            return
        self._trouble_shown = (speaking, state, sign is None)
        self.linear.setMinimumWidth(0 if speaking else self._least_linear)
        for widget, visible in ((self.trouble_sign, sign is not None), (self.trouble, speaking),
                                (self.turn, not speaking), (self.filler, not speaking),
                                (self.pill, state)):
            widget.setVisible(visible)

    def show_current(self, current):
        """Show whether this is the highlighted row."""
        if current != self._current:
            self._current = current
            self.update()

    def mousePressEvent(self, event):  # noqa: N802
        """Highlight."""
        name = first_press.of(self.name, event) if event.button() == Qt.LeftButton else ''
        if name:
            self.clicked.emit(name)

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """Open; the list may have scrolled since the first press."""
        name = first_press.of_double_click(event) if event.button() == Qt.LeftButton else ''
        if name:
            self.opened.emit(name)

    def paintEvent(self, event):  # noqa: N802
        """Paint ground, edge and divider."""
        painter = QPainter(self)
        palette = self.palette()
        rect = self.rect()
        base = palette.color(QPalette.Base)
        if self._current:
            painter.fillRect(rect, theme.blend(base, palette.color(QPalette.WindowText), 0.12))
        if self._tone:
            ink = theme.colour(self._tone, palette)
            painter.fillRect(rect, theme.blend(base, ink, 0.30 if self._current else 0.16))
            painter.fillRect(0, 0, _EDGE_PX, rect.height(), ink)
        painter.setPen(theme.line_colour(palette))
        painter.drawLine(rect.bottomLeft(), rect.bottomRight())
