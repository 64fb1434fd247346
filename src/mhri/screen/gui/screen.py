# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen: the pictures of all robots, STOP ALL, and the panel in a drawer at the left."""
from python_qt_binding.QtCore import QSize, Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QPushButton, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.forms import load_form
from mhri.base.gui.geometry import fitting, geometry_of, restore_geometry
from mhri.base.gui.labels import Sign, TextLine
from mhri.base.gui.pending import Pace
from mhri.base.views import PanelView, ROS_CUT_OFF, VIRTUAL_JOYSTICK
from mhri.driving.gui.control_bar import ControlBar
from mhri.driving.gui.drive_keys import DriveKeys, mark_drive_area
from mhri.driving.gui.key_help import KeyHelp
from mhri.driving.gui.leave_bar import LeaveBar
from mhri.driving.gui.mode_combo import ModeCombo
from mhri.driving.gui.speed_limits import SpeedLimits
from mhri.driving.gui.stop_bar import StopBar
from mhri.driving.gui.virtual_joystick import VirtualJoystick
from mhri.driving.stop_words import stop_words
from mhri.events.gui.event_button import EventButton
from mhri.robots.gui.remove_steps import RemoveSteps
from mhri.robots.gui.robot_list import RobotList
from mhri.screen.gui.page_tabs import PageTabs
from mhri.screen.gui.screen_layout import ScreenLayout
from mhri.screen.gui.stage import Stage
from mhri.screen.gui.status_line import StatusLine

VOICE = 'voice'
NUMBERS_PERIOD_S = 0.25
RECORD = 'Record selected'
STOP_RECORDING = 'Stop recording ({})'
# What came of looking or recording is news for so long.
RESULT_MS = 20000

_WIDGETS = (ControlBar, EventButton, ModeCombo, PageTabs, RobotList, Sign, SpeedLimits, Stage,
            StatusLine, StopBar, TextLine, VirtualJoystick)


class ScreenWidget(QWidget):
    """Everything an operator needs, in one widget for rqt and for a window of its own.

    Values in (:meth:`show_view`), signals out; it decides nothing and knows no ROS. The host
    installs :attr:`drive_keys` as an event filter of the application.

    :param ui_dir: folder of ``screen.ui``
    """

    #: "Look for Connected Bots"
    look_requested = Signal()
    #: "Doctor": examine network, master and robots
    doctor_requested = Signal()
    #: text of the name field
    add_requested = Signal(str)
    #: the robots to record, or to stop recording: names in list order
    record_requested = Signal(list)
    stop_record_requested = Signal(list)
    #: robot to take off the list
    remove_requested = Signal(str)
    #: every name that should be selected now, in list order
    selection_requested = Signal(list)
    #: this robot and no other is to be driven, and looked at
    drive_requested = Signal(str)
    #: the robot that is looked at has changed
    looked_at = Signal(str)
    #: name of a source
    mode_requested = Signal(str)
    #: forward (ahead +) and turn (left +), each in [-1, 1]; at once on every change
    stick_moved = Signal(float, float)
    #: push-to-talk: held or let go
    talk_requested = Signal(bool)
    #: m/s, rad/s
    limits_requested = Signal(float, float)
    #: whether all selected robots are to keep to the slowest
    together_requested = Signal(bool)
    stop_requested = Signal()
    release_requested = Signal()
    #: the power of the motors is to be cut
    power_cut_requested = Signal()
    #: this screen is to be the one that drives
    control_requested = Signal()
    #: the stick counts as let go, since nothing came from a remote display
    stick_ran_out = Signal()

    def __init__(self, ui_dir, parent=None):
        super().__init__(parent)
        self._view = PanelView()
        self._stick = (0.0, 0.0)
        self._talk_pressed = False
        self._numbers = Pace(NUMBERS_PERIOD_S)
        self._build(ui_dir)
        self._connect()
        self._restore()

    def _build(self, ui_dir):
        """Load the form and set what a form cannot say."""
        self.setFont(theme.base_font(self.font()))
        load_form(ui_dir, 'screen.ui', self, _WIDGETS)
        self.leave_bar = LeaveBar(self.foot)
        self.foot_column.insertWidget(1, self.leave_bar)
        self.arrangement = ScreenLayout(self)
        self.drive_keys, self.key_help = DriveKeys(self), KeyHelp(self)
        self.joystick.limit.remote = self.drive_keys.limit.remote
        self.key_help.show_remote(self.remote)
        self.remove_steps = RemoveSteps(self)
        mark_drive_area(self)
        # A click beside a text field ends the typing, so that the keys drive again.
        self.setFocusPolicy(Qt.ClickFocus)
        touch = theme.touch_size(self)
        for button in (self.look_button, self.doctor_button, self.add_button, self.all_button,
                       self.none_button, self.record_button, self.remove_button, self.name_edit,
                       self.mode_combo, self.talk_button):
            button.setMinimumHeight(touch)
            if isinstance(button, QPushButton):
                button.setFocusPolicy(Qt.TabFocus)
                button.setMinimumWidth(theme.text_width(button.font(), button.text()) + touch // 2)
        for label, side in ((self.linear_label, Qt.AlignRight), (self.turn_label, Qt.AlignLeft)):
            label.setFont(theme.number_font(theme.larger(self.font(), 1.1)))
            label.setAlignment(side | Qt.AlignVCenter)
        self.drive_note.setAlignment(Qt.AlignCenter)
        self.drawer_button.setMinimumWidth(
            theme.text_width(self.font(), self.drawer_button.text()) + touch)
        self.record_button.setMinimumWidth(touch // 2 + max(
            theme.text_width(self.font(), text) for text in (RECORD, STOP_RECORDING.format(88))))
        self.cameras_label.setFont(theme.number_font(self.font()))
        self.cameras_label.fix_width('cameras 000.0 Mbit/s')
        self.cameras_label.setMinimumWidth(1)
        self.cameras_label.setAlignment(Qt.AlignRight | Qt.AlignVCenter)
        self.name_edit.setTextMargins(touch // 6, 0, touch // 6, 0)
        self._result_timer = QTimer(self)
        self._result_timer.setSingleShot(True)
        self._result_timer.setInterval(RESULT_MS)

    def _connect(self):
        """Wire widgets to signals."""
        self.look_button.clicked.connect(self.look_requested)
        self.stage.look_requested.connect(self.look_requested)
        self._result_timer.timeout.connect(self.look_label.clear)
        self.doctor_button.clicked.connect(self.doctor_requested)
        self.add_button.clicked.connect(self._add)
        self.name_edit.returnPressed.connect(self._add)
        self.name_edit.textEdited.connect(self._on_name_edited)
        self.remove_steps.remove_requested.connect(self.remove_requested)
        self.record_button.clicked.connect(self._record)
        self.all_button.clicked.connect(self.robot_list.select_all)
        self.none_button.clicked.connect(self.robot_list.select_none)
        self.robot_list.selection_requested.connect(self.selection_requested)
        self.robot_list.open_requested.connect(self.drive_requested)
        self.robot_list.activated.connect(self._on_highlight)
        self.robot_list.cleared.connect(lambda: self._on_highlight(''))
        self.mode_combo.mode_requested.connect(self.mode_requested)
        self.speed_limits.limits_requested.connect(self.limits_requested)
        self.speed_limits.together_requested.connect(self.together_requested)
        self.stop_bar.stop_requested.connect(self._on_stop)
        self.stop_bar.release_requested.connect(self.release_requested)
        self.stop_bar.power_cut_requested.connect(self.power_cut_requested)
        self.control_bar.take_requested.connect(self.control_requested)
        self.talk_button.pressed.connect(self._press_talk)
        self.talk_button.released.connect(self._let_talk_go)
        self.drive_keys.talk_changed.connect(self._tell_talk)
        self.joystick.moved.connect(self._on_stick)
        self.drive_keys.moved.connect(self._on_stick)
        for part in (self.joystick, self.drive_keys):
            part.ran_out.connect(self.stick_ran_out)
        self.drive_keys.centre_pressed.connect(self.centre_stick)
        self.drive_keys.stop_pressed.connect(self.stop_bar.request_stop)
        self.drive_keys.stop_held.connect(self.stop_bar.power_cut_requested)
        self.drive_keys.robot_pressed.connect(self.robot_list.toggle)
        self.drive_keys.all_pressed.connect(self.robot_list.toggle_all)
        self.drive_keys.alone_pressed.connect(self._drive_number)
        self.drive_keys.next_pressed.connect(lambda steps: self.look_at(
            self.stage.next_name(steps)))
        self.drive_keys.drive_pressed.connect(self._drive_looked_at)
        self.drive_keys.command_pressed.connect(self._on_command)

    def _restore(self):
        """Begin with an empty view, and with nothing said."""
        self.show_name_problem('')
        self.show_look_result('')
        self.show_view(self._view)

    def show_view(self, view):
        """Show a :class:`mhri.base.views.PanelView`; cheap enough for 20 times a second.

        States show at once, numbers at most four times a second.
        """
        self._view = view
        numbers = self._numbers.due()
        self.robot_list.show_in_force(view.control.ours)
        self.robot_list.show_robots(view.robots, numbers)
        self.control_bar.show_control(view.control)
        self.mode_combo.show_mode(view.sources, view.mode, view.devices)
        self.speed_limits.show_limits(view.limits)
        self.speed_limits.show_pace(view.together, view.pace, view.slowed, view.brake)
        self.stop_bar.show_cut_off(view.ros == ROS_CUT_OFF)
        self.stop_bar.show_power(any(robot.offers_power for robot in view.robots))
        self.stop_bar.show_stop(view.stop_all, view.stop_note, stop_words(
            view.robots, view.stop_taken, view.answers))
        self.status_line.show_status(view.status, view.status_level)
        self._show_buttons()
        self._show_stick(numbers)
        self.stage.show_driven([robot.name for robot in view.robots if robot.selected])
        self.stage.watch_shapes()
        self.arrangement.show_stick(view.mode == VIRTUAL_JOYSTICK)
        if numbers:
            cameras = words.bandwidth_text(view.camera_bits_per_s)
            self.cameras_label.show_text(cameras, theme.MUTED, (cameras.partition(' ')[2], ''))
            self.cameras_label.setVisible(bool(cameras))

    def show_name_problem(self, text):
        """Say below the name field why a name was refused; '' clears it."""
        self.name_problem_label.show_text(text)
        self.name_problem_sign.show_sign((theme.TRIANGLE, theme.ATTENTION) if text else None)
        for part, shown in ((self.name_problem_label, text), (self.look_label, not text)):
            part.setVisible(bool(shown))

    def show_look_result(self, text, busy=False, shorter=()):
        """Say below the name field for a while what came of looking; ``busy`` while it looks.

        :param shorter: what to say where there is no room, the longest first
        """
        self.look_label.show_text(text, theme.MUTED, shorter)
        self.look_button.setEnabled(not busy)
        self.stage.show_look_result(text, busy)
        if busy:
            self._result_timer.stop()
        else:
            self._result_timer.start()

    def clear_name(self):
        """Empty the name field, after its robot was added, and let the keys drive again."""
        self.name_edit.clear()
        if self.name_edit.hasFocus():
            self.setFocus()
        self.show_name_problem('')

    def look_at(self, name):
        """Show this robot large; '' leaves it to those that are driven."""
        if name:
            self.robot_list.activate(name)
        else:
            self.robot_list.clear()

    def _on_highlight(self, name):
        """Look at the robot whose row is highlighted."""
        self.stage.look_at(name)
        self._show_buttons()
        self.looked_at.emit(name)

    def _drive_number(self, number):
        """Drive the robot of a number and no other."""
        for robot in self._view.robots:
            if robot.number == number > 0:
                self.drive_requested.emit(robot.name)

    def _drive_looked_at(self):
        """Drive the robot that is looked at and no other."""
        name = self.stage.looked_at or next(iter(self.stage.large), '')
        if name:
            self.drive_requested.emit(name)

    def _on_command(self, command):
        """Do what a key of the screen says."""
        if command == 'keys':
            self.key_help.toggle()
        elif command == 'drawer':
            self.drawer_button.toggle()
        elif command == 'focus':
            self.arrangement.change_focus()
        elif command == 'numbers':
            self.arrangement.show_numbers(not self.stage.numbers_shown)
        elif command == 'full_screen':
            self.arrangement.change_full_screen()

    def minimumSizeHint(self):  # noqa: N802
        """Return the least at which it can be used; parts that are too large then give way.

        However large the letters are, it fits on the monitor, with STOP ALL.
        """
        unit = self.fontMetrics().height()
        return fitting(QSize(38 * unit, 26 * unit))

    @property
    def remote(self):
        """How the display is shown on another computer ('VNC', 'forwarded X'), '' if it is not."""
        return self.drive_keys.limit.remote

    def stick(self):
        """Return (forward, turn), each in [-1, 1], as held by pointer or keys now."""
        return self._stick

    def centre_stick(self):
        """Let the stick go: pointer and keys have to take it again."""
        self.drive_keys.centre()
        self.joystick.centre()

    def keyPressEvent(self, event):  # noqa: N802
        """Take the highlight away with Escape: a click on a row leaves the keyboard here."""
        if event.key() == Qt.Key_Escape and self.robot_list.current is not None:
            self.robot_list.clear()
        else:
            super().keyPressEvent(event)

    def hideEvent(self, event):  # noqa: N802
        """Let the stick go: nobody drives by a panel that cannot be seen."""
        self.centre_stick()
        super().hideEvent(event)

    def save_settings(self):
        """Return what only concerns the looks as a plain dict of JSON values."""
        settings = self.arrangement.save_settings()
        if self.isWindow():
            settings['geometry'] = geometry_of(self)
        return settings

    def restore_settings(self, settings):
        """Take back what :meth:`save_settings` returned; :func:`usable_state` has looked at it."""
        self.arrangement.restore_settings(settings)
        if 'geometry' in settings and self.isWindow():
            restore_geometry(self, settings['geometry'])

    def _on_name_edited(self, text):
        """Take back what was said about another name."""
        self.show_name_problem('')

    def _add(self):
        """Ask for the robot in the name field."""
        self.add_requested.emit(self.name_edit.text())

    def _record(self):
        """Ask for recordings of all selected robots, or for the end of every recording."""
        running = [robot.name for robot in self._view.robots if robot.recording]
        if running:
            self.stop_record_requested.emit(running)
        else:
            self.record_requested.emit(
                [robot.name for robot in self._view.robots if robot.selected])

    def _press_talk(self):
        """Begin to talk by the button."""
        self._talk_pressed = True
        self._tell_talk()

    def _let_talk_go(self):
        """End talking by the button."""
        self._talk_pressed = False
        self._tell_talk()

    def _tell_talk(self, *_):
        """Tell whether button or key are held; the key shows as a pressed button."""
        talking = self._talk_pressed or self.drive_keys.talking
        self.talk_button.setDown(talking)
        self.talk_requested.emit(talking and self.talk_button.isVisible())

    def _on_stop(self):
        """Stop: the stick goes to neutral first, then everything else is told."""
        self.centre_stick()
        self.stop_requested.emit()

    def _on_stick(self):
        """Put pointer and keys together: the pointer wins while it holds the knob."""
        keys = self.drive_keys.deflection()
        self.joystick.show_keys(*keys)
        stick = self.joystick.deflection() if self.joystick.dragging else keys
        if stick != self._stick:
            neutral = stick == (0.0, 0.0)
            self._stick = stick
            self.stick_moved.emit(*stick)
            self._show_stick(neutral or self._numbers.due())

    def _show_buttons(self):
        """Enable what has something to act on."""
        self.remove_steps.show_robots(self._view.robots)
        running = sum(robot.recording for robot in self._view.robots)
        text = STOP_RECORDING.format(running) if running else RECORD
        if text != self.record_button.text():
            self.record_button.setText(text)
        self.record_button.setEnabled(
            bool(running) or any(robot.selected for robot in self._view.robots))
        for button in (self.all_button, self.none_button):
            button.setEnabled(bool(self._view.robots) and self._view.control.ours)

    def _show_stick(self, numbers):
        """Show what the stick asks for, and whether anybody listens to it."""
        view = self._view
        in_force = view.mode == VIRTUAL_JOYSTICK and not view.stop_all and view.control.ours
        self.joystick.show_active(in_force)
        self.talk_button.setVisible(view.mode == VOICE)
        shorter = ()
        if not view.control.ours:
            note = 'no effect: {} drives'.format(view.control.who.partition(' since ')[0])
        elif view.stop_all:
            note = 'no effect: stop all is in force'
        elif view.mode is None:
            note = 'no effect: the mode is not known yet'
        elif view.mode == VOICE:
            note, shorter = words.voice_texts(view.heard, next(
                (device for device in view.devices if device.source == VOICE), None))
        elif not in_force:
            note = 'no effect: {} drives'.format(self.mode_combo.label_of(view.mode))
        elif self.remote:
            note, shorter = words.remote_stick_texts(self.remote)
        else:
            note = 'drag, arrow keys or W A S D; space centres'
        self.drive_note.show_text(note, theme.MUTED, shorter)
        if numbers:
            tone = theme.TEXT if in_force else theme.MUTED
            linear, turn = words.command_texts(*self._stick, limits=view.limits)
            self.linear_label.show_text(linear, tone)
            self.turn_label.show_text(turn, tone)
