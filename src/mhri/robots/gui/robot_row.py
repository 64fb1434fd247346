# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot in the list: who it is, how its link is, what it does."""
from python_qt_binding.QtCore import QRectF, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import (
    QCheckBox, QGridLayout, QHBoxLayout, QPushButton, QSizePolicy, QWidget)

from mhri.base import views
from mhri.base.brake_view import brake_words, guard_words
from mhri.base.gui import theme, words
from mhri.base.gui.first_press import first_press
from mhri.base.gui.labels import BatteryLine, Pill, plain_tip, Sign, TextLine
from mhri.base.numbers import LAST_KEY
from mhri.base.task_words import interrupted_line, task_lines
from mhri.robots.owners import ASK_FOR, TAKE_IT

DRIVING, ON_TASK = 'DRIVING', 'ON TASK'
CARRY_ON = 'Continue'
MOVING = 'moving'
RECORDING = 'rec'
# What a name asks for before it gives way, in average characters; longer ones end in "...".
_NAME_CHARACTERS = 8
_EDGE_PX = 6

_CONTROL_TIPS = {ASK_FOR: 'its screen is told that you ask; then you can take control',
                 TAKE_IT: 'the robot stops, and moves for you once your stick is centred'}


class BigCheckBox(QCheckBox):
    """A check box for fingers; the whole square of it is the target."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizePolicy(QSizePolicy.Fixed, QSizePolicy.Fixed)

    def sizeHint(self):  # noqa: N802
        """Return the least square that a finger hits."""
        side = theme.touch_size(self)
        return QSize(side, side)

    def hitButton(self, pos):  # noqa: N802
        """Tell whether a place is on the box: everywhere is."""
        return self.rect().contains(pos)

    def paintEvent(self, event):  # noqa: N802
        """Paint box and tick."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        palette = self.palette()
        side = self.fontMetrics().height() * 1.35
        box = QRectF((self.width() - side) / 2.0, (self.height() - side) / 2.0, side, side)
        ink = theme.colour(theme.DRIVE if self.isEnabled() else theme.MUTED, palette)
        checked = self.isChecked()
        border = ink if checked or self.underMouse() else theme.colour(theme.MUTED, palette)
        painter.setPen(QPen(border, 2))
        painter.setBrush(ink if checked else palette.color(QPalette.Base))
        painter.drawRoundedRect(box, 4, 4)
        if checked:
            inner = box.adjusted(3, 3, -3, -3)
            theme.paint_sign(painter, inner, theme.TICK, theme.readable_on(ink), ink)
        if self.hasFocus():
            painter.setPen(QPen(palette.color(QPalette.WindowText), 1, Qt.DotLine))
            painter.setBrush(Qt.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))


class RobotRow(QWidget):
    """Two lines of fixed height: identity and link; below it speed, then turn or what is wrong.

    The speed gives way only to why a task waits; what is old is dimmed.
    """

    #: the check box was clicked: name, checked
    checked = Signal(str, bool)
    #: a click: the robot that is meant
    clicked = Signal(str)
    #: a double click: the robot that had the first press
    opened = Signal(str)
    #: it shall go on with the task that it was taken from
    carry_on_requested = Signal(str)
    #: another host has control of it, and this one asks
    ask_requested = Signal(str)

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
        self.number = TextLine(self)
        self.number.setFont(theme.larger(numbers, 1.15))
        self.number.fix_width('88')
        self.number.setAlignment(Qt.AlignRight | Qt.AlignVCenter)
        self.box = BigCheckBox(self)
        self.box.setObjectName('check_' + self.name)
        self.box.setAccessibleName('drive {}'.format(self.name))
        self.title = TextLine(self)
        self.title.setFont(theme.larger(font, 1.25, bold=True))
        self.title.show_text(self.name, shorter=words.name_ends(self.name))
        # The name is the last to give way in a narrow dock: the type goes first, then the age.
        metrics = self.title.fontMetrics()
        natural = theme.text_width(self.title.font(), self.name)
        self.title.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
        self.title.setMaximumWidth(natural)
        self.title.setMinimumWidth(min(natural, _NAME_CHARACTERS * metrics.averageCharWidth()))
        self.kind = TextLine(self)
        self.kind.setMinimumWidth(1)
        self.sign = Sign(self)
        self.link = self._fixed_line(numbers, 'waiting')
        self.recording = Pill(self)
        self.recording.set_words((RECORDING,))
        self.age = self._fixed_line(numbers, '000 ms', Qt.AlignRight)
        self.linear = self._fixed_line(numbers, 'back 0.00 m/s')
        self.turn = self._fixed_line(numbers, 'right 0.00 rad/s')
        # In a narrow drawer the turn does without its unit; beside a sentence the speed takes the
        # room that it needs now.
        for line in (self.linear, self.turn):
            line.setSizePolicy(QSizePolicy.Preferred, QSizePolicy.Fixed)
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
        self.task_pill.say(ON_TASK, theme.TASK)
        self.task_pill.hide()
        self.carry_on_button = self._button('carry_on_', CARRY_ON)
        self.ask_button = self._button('ask_', '')
        self.battery = self._fixed_line(numbers, '100 %', Qt.AlignRight, BatteryLine)
        self._lay_out()

    def _button(self, prefix, text):
        """Make a button for fingers that is not always there."""
        button = QPushButton(text, self)
        button.setObjectName(prefix + self.name)
        button.setFocusPolicy(Qt.TabFocus)
        button.setMinimumHeight(theme.touch_size(self))
        button.hide()
        return button

    def _fixed_line(self, font, sample, align=Qt.AlignLeft, kind=TextLine):
        """Make a line for a number: its width is that of the sample."""
        line = kind(self)
        line.setFont(font)
        line.fix_width(sample)
        line.setAlignment(align | Qt.AlignVCenter)
        return line

    def _lay_out(self):
        """Place the parts on two lines."""
        unit = self.fontMetrics().height()
        grid = QGridLayout(self)
        grid.setContentsMargins(_EDGE_PX + 4, unit // 4, unit // 2, unit // 4)
        grid.setHorizontalSpacing(unit // 3)
        grid.setVerticalSpacing(0)
        first, second = QHBoxLayout(), QHBoxLayout()
        for widget, stretch in ((self.title, 0), (self.task_pill, 0), (self.kind, 1),
                                (self.recording, 0),
                                (self.sign, 0), (self.link, 0), (self.age, 0)):
            first.addWidget(widget, stretch)
        for widget, stretch in ((self.linear, 0), (self.trouble_sign, 0), (self.trouble, 1),
                                (self.turn, 0), (self.filler, 1), (self.pill, 0),
                                (self.battery, 0)):
            second.addWidget(widget, stretch)
        for line in (first, second):
            line.setSpacing(unit // 3)
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

    def _on_carry_on(self):
        """Tell of a click on "Continue"."""
        self.carry_on_requested.emit(self.name)

    def _on_ask(self):
        """Tell of a click on "Ask for control"."""
        self.ask_requested.emit(self.name)

    def _on_box(self, on):
        """Tell of a click on the box."""
        self.checked.emit(self.name, on)

    def show_view(self, view, checked, numbers=True):
        """Show a robot.

        :param view: :class:`mhri.base.views.RobotView`
        :param checked: whether the box is ticked
        :param numbers: whether numbers may change now; a changed state always shows at once
        """
        numbers = numbers or view.changed_with != self._changed_with
        self._changed_with = view.changed_with
        self._show_number(view.number)
        self.box.setChecked(checked)
        self.kind.show_text(words.type_text(view), theme.MUTED, (view.type_label, ''))
        self.sign.show_sign(theme.LINK_SIGNS[view.link])
        self.link.show_text(words.LINK_WORDS[view.link])
        if numbers:
            self._show_numbers(view)
        self._show_second_line(view)
        self.recording.say(RECORDING if view.recording else '', filled=False)
        self.recording.setVisible(view.recording)
        self._offer_to_carry_on(view.carry_on)
        self._offer_control(view.ask)
        # Who waits stands: the room is for the reason.
        self.linear.setVisible(not (view.ask or view.carry_on or view.on_task and view.task
                                    and view.task.waits))
        tone = theme.TASK if view.on_task else theme.DRIVE if view.driven else None
        if tone != self._tone:
            self._tone = tone
            self.update()

    def _offer_to_carry_on(self, label):
        """Offer to continue a task, '' for none."""
        self.carry_on_button.setVisible(bool(label))
        if label:
            text = '{} {} of {}'.format(CARRY_ON, label.lower(), self.name)
            self.carry_on_button.setAccessibleName(text)
            self.carry_on_button.setToolTip(plain_tip(text))

    def _offer_control(self, text):
        """Offer to ask for control, or to take it; '' where there is nobody to ask."""
        self.ask_button.setVisible(bool(text))
        # The button has the room of what is in the tile as well.
        for part in (self.age, self.battery):
            part.setVisible(not text)
        if text != self.ask_button.text():
            self.ask_button.setText(text)
            self.ask_button.setAccessibleName('{} of {}'.format(text, self.name))
            self.ask_button.setToolTip(plain_tip(_CONTROL_TIPS.get(text, '')))

    def _show_numbers(self, view):
        """Show what changes all the time."""
        self.age.show_text(words.link_age(view), theme.MUTED)
        self.setToolTip('\n'.join(filter(None, (
            words.figures_text(view.figures), brake_words(view.brake),
            guard_words(view.brake)))))
        old = view.link != views.LIVE
        tone = theme.MUTED if old else theme.TEXT
        linear = words.linear_text(view.linear_mps)
        self.linear.show_text(linear, tone, (linear.rpartition(' ')[0] or linear,))
        turn = words.turn_text(view.angular_rad_s)
        self.turn.show_text(turn, tone, shorter=(turn.rpartition(' ')[0] or turn, ''))
        self.battery.show_charge(view.battery, old)

    def _show_second_line(self, view):
        """Show the proof of a stop, or what is wrong with the link, or how the robot moves."""
        self.task_pill.setVisible(view.on_task)
        if view.driven and not view.on_task:
            self.pill.say(DRIVING)
        else:
            self.pill.say(MOVING if view.moving and not view.on_task else '', theme.ATTENTION,
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
            sign = (theme.TRIANGLE, theme.ATTENTION) if view.slow else None
            self._show_trouble(sign, view.note, with_state=True)

    def _show_number(self, number):
        """Show the robot's number; one that no key drives is dimmed."""
        text = str(number) if number else ''
        if len(text) > max(len(self.number.text()), 2):
            self.number.fix_width('8' * len(text))
        self.number.show_text(text, theme.TEXT if number <= LAST_KEY else theme.MUTED)

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
        # Where hardly a letter has room, beside a pill, the sign says enough.
        self.trouble.show_text(text, shorter=shorter or (
            *words.beginnings(text, most=3), *(('',) if with_state and self.pill.word else ())))
        # A sentence takes the room of a state that there is none of.
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
