# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Removes a robot from the list, at once or, if it is in use, in two steps; can undo it."""
from python_qt_binding.QtCore import QElapsedTimer, QObject, Qt, QTimer, Signal

from mhri.base.gui import theme, words
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.robots.busy import remove_question

CONFIRM_WITHIN_S = 5.0
UNDO_WITHIN_S = 20.0
# "Undo", which replaces "Remove", ignores clicks for this long: a double click removes for good.
SETTLED_S = 0.5
REMOVE, KEEP, UNDO = 'Remove', 'Keep', 'Undo'


class RemoveSteps(QObject):
    """The buttons below the list while a robot is removed.

    Removing a selected or recorded robot needs a confirmation: the question and "Remove it" appear
    beside "Remove", which becomes "Keep", so that a double click removes nothing. For 20 s after a
    removal "Undo" replaces them, unless another robot is highlighted.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    #: name of the robot
    remove_requested = Signal(str)
    #: name of the robot to put back
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
        """Make the widgets, and place them in the row of "Remove"."""
        parent = self._button.parentWidget()
        self._line = TextLine(parent)
        self._line.setObjectName('remove_label')
        row.insertWidget(0, self._line, 1)
        self.confirm_button = theme.finger_button(parent, 'remove_confirm_button', 'Remove it')
        self.undo_button = theme.finger_button(parent, 'undo_button', UNDO)
        for button in (self.confirm_button, self.undo_button):
            row.addWidget(button)
        row.removeWidget(self._button)
        row.addWidget(self._button)
        for part in (self._line, self.confirm_button, self.undo_button):
            part.hide()
        self._countdown, self._undo_timer = (
            QTimer(self, singleShot=True, interval=round(1000 * within_s))
            for within_s in (CONFIRM_WITHIN_S, UNDO_WITHIN_S))
        self._offered = QElapsedTimer()

    def _connect(self):
        """Wire buttons and timers."""
        self._button.clicked.connect(self._on_button)
        self.confirm_button.clicked.connect(self._confirm)
        self.undo_button.clicked.connect(self._undo)
        self._countdown.timeout.connect(self._keep)
        self._undo_timer.timeout.connect(self._show)

    def show_robots(self, robots):
        """Update the robots: values of :class:`mhri.base.views.RobotView`."""
        self._robots = robots
        if self._asked and self._asked != self._list.current:
            self._keep()
        self._show()

    def offer_undo(self, name):
        """Offer to put back a robot that was just removed."""
        self._removed = name
        self.undo_button.setToolTip(plain_tip('Put {} back'.format(name)))
        self._undo_timer.start()
        self._offered.start()
        focus = self._button.hasFocus()
        self._show()
        if focus:
            self.undo_button.setFocus(Qt.OtherFocusReason)

    def _on_button(self):
        """Remove the highlighted robot, ask first, or cancel."""
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
        """Show the question (first step)."""
        self._asked = name
        self._line.show_text(question, shorter=(*words.beginnings(question), name + '?'))
        self._countdown.start()
        self._show()

    def _keep(self):
        """Cancel the first step."""
        self._asked = ''
        self._countdown.stop()
        self._show()

    def _confirm(self):
        """Remove the robot (second step)."""
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
        """Show the widgets of the current step."""
        asking = bool(self._asked)
        undo = self._undo_timer.isActive() and self._list.current is None and not asking
        for part in (self._line, self.confirm_button):
            part.setVisible(asking)
        for part in self._others:
            part.setVisible(not asking)
        if not undo and self.undo_button.hasFocus():
            # Otherwise Return would press the widget that gets the focus next.
            self._list.setFocus(Qt.OtherFocusReason)
        self.undo_button.setVisible(undo)
        self._button.setVisible(not undo)
        self._button.setText(KEEP if asking else REMOVE)
        self._button.setEnabled(self._list.current is not None)
