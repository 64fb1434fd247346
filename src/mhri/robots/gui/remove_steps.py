# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Takes a robot off the list: at once, or in two steps where it is in use; and back again."""
from python_qt_binding.QtCore import QElapsedTimer, QObject, Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QPushButton

from mhri.base.gui import theme, words
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.robots.busy import remove_question

CONFIRM_WITHIN_S = 5.0
UNDO_WITHIN_S = 20.0
# A second click where "Remove" was means nothing.
SETTLED_S = 0.5
REMOVE, KEEP, UNDO = 'Remove', 'Keep', 'Undo'


class RemoveSteps(QObject):
    """The buttons below the list while a robot is removed.

    One that is selected or recorded is asked for in place: the question and "Remove it" are beside
    where "Remove" was, and there is "Keep" then, so that a double click removes nothing. For 20 s
    after that "Undo" is there instead, unless another robot is highlighted.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    #: name of the robot
    remove_requested = Signal(str)
    #: name of the robot that is to be back
    undo_requested = Signal(str)

    def __init__(self, screen):
        super().__init__(screen)
        self._button = screen.remove_button
        self._list = screen.robot_list
        self._others = (screen.all_button, screen.none_button, screen.record_button)
        self._robots = ()
        self._asked = self._removed = ''
        self._build(screen.list_buttons)
        self._connect()

    def _build(self, row):
        """Make the parts, and place them in the row of "Remove"."""
        parent = self._button.parentWidget()
        self._line = TextLine(parent)
        self._line.setObjectName('remove_label')
        self.confirm_button, self.undo_button = (
            QPushButton(text, parent) for text in ('Remove it', UNDO))
        self.confirm_button.setObjectName('remove_confirm_button')
        self.undo_button.setObjectName('undo_button')
        row.insertWidget(0, self._line, 1)
        for button in (self.confirm_button, self.undo_button):
            side = theme.touch_size(button)
            button.setFocusPolicy(Qt.TabFocus)
            button.setMinimumSize(theme.text_width(button.font(), button.text()) + side, side)
            row.addWidget(button)
        row.removeWidget(self._button)
        row.addWidget(self._button)
        for part in (self._line, self.confirm_button, self.undo_button):
            part.hide()
        self._countdown, self._undo_timer = QTimer(self), QTimer(self)
        for timer, within_s in ((self._countdown, CONFIRM_WITHIN_S),
                                (self._undo_timer, UNDO_WITHIN_S)):
            timer.setSingleShot(True)
            timer.setInterval(round(1000 * within_s))
        self._offered = QElapsedTimer()

    def _connect(self):
        """Wire buttons and timers."""
        self._button.clicked.connect(self._on_button)
        self.confirm_button.clicked.connect(self._confirm)
        self.undo_button.clicked.connect(self._undo)
        self._countdown.timeout.connect(self._keep)
        self._undo_timer.timeout.connect(self._show)

    def show_robots(self, robots):
        """Follow the robots: values of :class:`mhri.base.views.RobotView`."""
        self._robots = robots
        if self._asked and self._asked != self._list.current:
            self._keep()
        self._show()

    def offer_undo(self, name):
        """Offer to put a robot back that was just removed."""
        self._removed = name
        self.undo_button.setToolTip(plain_tip('Put {} back'.format(name)))
        self._undo_timer.start()
        self._offered.start()
        focus = self._button.hasFocus()
        self._show()
        if focus:
            self.undo_button.setFocus(Qt.OtherFocusReason)

    def _on_button(self):
        """Remove, ask, or keep it after all."""
        name = self._list.current
        if self._asked:
            self._keep()
        elif name is not None:
            question = next((remove_question(robot) for robot in self._robots
                             if robot.name == name), '')
            if question:
                self._ask(name, question)
            else:
                self.remove_requested.emit(name)

    def _ask(self, name, question):
        """First step."""
        self._asked = name
        self._line.show_text(question, shorter=(*words.beginnings(question), name + '?'))
        self._countdown.start()
        self._show()

    def _keep(self):
        """Back from the first step."""
        self._asked = ''
        self._countdown.stop()
        self._show()

    def _confirm(self):
        """Second step."""
        name, had_focus = self._asked, self.confirm_button.hasFocus()
        self._keep()
        if had_focus:
            self._button.setFocus(Qt.OtherFocusReason)
        if name:
            self.remove_requested.emit(name)

    def _undo(self):
        """Put the robot back."""
        if self._offered.elapsed() >= 1000 * SETTLED_S:
            self._undo_timer.stop()
            self._show()
            self.undo_requested.emit(self._removed)

    def _show(self):
        """Show the step it is at."""
        asking = bool(self._asked)
        undo = self._undo_timer.isActive() and self._list.current is None and not asking
        for part in (self._line, self.confirm_button):
            part.setVisible(asking)
        for part in self._others:
            part.setVisible(not asking)
        if not undo and self.undo_button.hasFocus():
            # Else Return would press whatever is next.
            self._list.setFocus(Qt.OtherFocusReason)
        self.undo_button.setVisible(undo)
        self._button.setVisible(not undo)
        self._button.setText(KEEP if asking else REMOVE)
        self._button.setEnabled(self._list.current is not None)
