# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen: pictures of all robots, STOP ALL, and the panel in a drawer at the left."""
from functools import partial
import os

from python_qt_binding.QtCore import QSize, Qt, QTimer, Signal
from python_qt_binding.QtGui import QContextMenuEvent
from python_qt_binding.QtWidgets import QPushButton, QWidget

from mhri.base.gui import icons, theme, words
from mhri.base.gui.forms import load_form
from mhri.base.gui.geometry import fitting, geometry_of, restore_geometry
from mhri.base.gui.pending import Pace
from mhri.base.views import GONE, ROS_CUT_OFF, ScreenView, SILENT, VIRTUAL_JOYSTICK
from mhri.driving.gui import robot_menu
from mhri.driving.gui.drive_keys import DriveKeys, mark_drive_area
from mhri.driving.gui.key_help import KeyHelp
from mhri.driving.gui.leave_bar import LeaveBar
from mhri.driving.gui.virtual_joystick import VirtualJoystick
from mhri.driving.stop_words import stop_words
from mhri.robots.busy import remove_question
from mhri.robots.gui.remove_steps import RemoveSteps
from mhri.screen.gui.screen_layout import ScreenLayout

VOICE = 'voice'
RECORD = 'Record selected'
STOP_RECORDING = 'Stop recording ({})'
# Time for which the result of a search or a recording is shown.
RESULT_MS = 20000


class ScreenWidget(QWidget):
    """The operator's screen, one widget for rqt and the standalone window.

    Values in (:meth:`show_view`), signals out; it makes no decisions and does not use ROS. The
    presenter installs :attr:`drive_keys` as an event filter of the application.

    :param ui_dir: folder of ``screen.ui``
    """

    #: "Look for Connected Bots"
    look_requested = Signal()
    #: "Doctor": check network, master and robots
    doctor_requested = Signal()
    #: text of the name field
    add_requested = Signal(str)
    #: robots whose recording to start or stop: names in list order
    record_requested = Signal(list)
    stop_record_requested = Signal(list)
    #: a request to drive only this robot, and to show it large
    drive_requested = Signal(str)
    #: another robot is in view: its name
    looked_at = Signal(str)
    #: forward (ahead +), turn and sideways (left +), each in [-1, 1]; at once on every change
    stick_moved = Signal(float, float, float)
    #: push-to-talk: pressed or released
    talk_requested = Signal(bool)
    stop_requested = Signal()
    #: a request to stop only this robot: its name
    stop_robot_requested = Signal(str)
    #: the stick was centred because the remote display fell silent
    stick_ran_out = Signal()

    def __init__(self, ui_dir, parent=None):
        super().__init__(parent)
        self._view = ScreenView()
        self._stick = (0.0, 0.0, 0.0)
        self._talk_pressed = False
        self._numbers = Pace()
        self._build(ui_dir)
        self._connect()
        self._restore()

    def _build(self, ui_dir):
        """Load the form, and set properties that a form cannot contain."""
        self.setFont(theme.base_font(self.font()))
        icons.use_folder(os.path.join(ui_dir, 'icons'))
        load_form(ui_dir, 'screen.ui', self)
        self.joystick = VirtualJoystick(self.stage)
        self.joystick.setObjectName('joystick')
        self.stage.set_stick(self.joystick)
        self.leave_bar = LeaveBar(self)
        self.arrangement = ScreenLayout(self)
        self.drive_keys, self.key_help = DriveKeys(self), KeyHelp(self)
        self.joystick.limit.remote = self.drive_keys.limit.remote
        self.key_help.show_remote(self.remote)
        self.remove_steps = RemoveSteps(self)
        self.robot_menu = robot_menu.RobotMenu(self)
        mark_drive_area(self)
        # A click beside a text field ends typing, so that the keys drive again.
        self.setFocusPolicy(Qt.ClickFocus)
        touch = theme.touch_size(self)
        for button in (self.look_button, self.doctor_button, self.add_button, self.all_button,
                       self.none_button, self.record_button, self.remove_button, self.name_edit,
                       self.mode_combo, self.talk_button):
            button.setMinimumHeight(touch)
            if isinstance(button, QPushButton):
                button.setFocusPolicy(Qt.TabFocus)
                button.setMinimumWidth(theme.text_width(button.font(), button.text()) + touch // 2)
        for button, icon in ((self.look_button, 'search'), (self.doctor_button, 'stethoscope'),
                             (self.add_button, 'plus')):
            button.set_icon(icon)
        for label, side in ((self.linear_label, Qt.AlignRight), (self.turn_label, Qt.AlignLeft)):
            label.setFont(theme.number_font(theme.larger(self.font(), theme.HEAD)))
            label.setAlignment(side | Qt.AlignVCenter)
        self.drive_note.setAlignment(Qt.AlignCenter)
        self.drawer_button.show_texts('Drawer (F2)', 'F2')
        self.record_button.setMinimumWidth(touch // 2 + max(
            theme.text_width(self.font(), text) for text in (RECORD, STOP_RECORDING.format(88))))
        self.cameras_label.setFont(theme.number_font(self.font()))
        self.cameras_label.setAlignment(Qt.AlignCenter)
        self._result_timer = QTimer(self, singleShot=True, interval=RESULT_MS)

    def _connect(self):
        """Connect widgets to signals."""
        self.look_button.clicked.connect(self.look_requested)
        self.stage.invitation.look_button.clicked.connect(self.look_requested)
        self._result_timer.timeout.connect(self.look_label.clear)
        self.doctor_button.clicked.connect(self.doctor_requested)
        for asked in (self.add_button.clicked, self.name_edit.returnPressed):
            asked.connect(lambda *_: self.add_requested.emit(self.name_edit.text()))
        # A problem refers to the previous name.
        self.name_edit.textEdited.connect(lambda _: self.show_name_problem(''))
        self.record_button.clicked.connect(self._record)
        self.all_button.clicked.connect(self.robot_list.select_all)
        self.none_button.clicked.connect(self.robot_list.select_none)
        self.robot_list.open_requested.connect(self.drive_requested)
        self.robot_list.activated.connect(self._on_highlight)
        self.robot_list.cleared.connect(lambda: self._on_highlight(''))
        self.robot_list.menu_requested.connect(self.robot_menu.open)
        for group, rows in ((robot_menu.DRIVE, self._drive_rows),
                            (robot_menu.STOP, self._stop_rows),
                            (robot_menu.REMOVE, self._remove_rows)):
            self.robot_menu.offer(group, rows)
        self.stop_bar.stop_requested.connect(self._on_stop)
        self.talk_button.pressed.connect(lambda: self._talk(True))
        self.talk_button.released.connect(lambda: self._talk(False))
        self.drive_keys.talk_changed.connect(self._emit_talk)
        self.joystick.moved.connect(self._on_stick)
        self.drive_keys.moved.connect(self._on_stick)
        for part in (self.joystick, self.drive_keys):
            part.ran_out.connect(self.stick_ran_out)
        self.drive_keys.centre_pressed.connect(self.centre_stick)
        self.drive_keys.stop_pressed.connect(self.stop_bar.request_stop)
        self.drive_keys.stop_pressed.connect(self.stop_bar.begin_hold)
        self.drive_keys.stop_let_go.connect(self.stop_bar.end_hold)
        self.drive_keys.stop_held.connect(self.stop_bar.power_cut_requested)
        self.drive_keys.robot_stop_pressed.connect(self._stop_number)
        self.drive_keys.stop_looked_at_pressed.connect(self._stop_looked_at)
        self.drive_keys.robot_pressed.connect(self.robot_list.toggle)
        self.drive_keys.all_pressed.connect(self.robot_list.toggle_all)
        self.drive_keys.alone_pressed.connect(self._drive_number)
        self.drive_keys.next_pressed.connect(lambda steps: self.look_at(
            self.stage.next_name(steps)))
        self.drive_keys.drive_pressed.connect(self._drive_looked_at)
        self.drive_keys.command_pressed.connect(self._on_command)

    def _restore(self):
        """Start with an empty view and no texts."""
        self.show_name_problem('')
        self.show_look_result('')
        self.show_view(self._view)

    def show_view(self, view):
        """Show a :class:`mhri.base.views.ScreenView`; cheap enough for 20 times a second.

        States are shown at once, numbers at most four times a second.
        """
        self._view = view
        numbers = self._numbers.due()
        self.robot_list.show_in_force(view.control.ours)
        self.robot_list.show_robots(view.robots, numbers)
        self.robot_menu.show_robots(view.robots)
        self.control_bar.show_control(view.control)
        self.mode_combo.show_mode(view.sources, view.mode, view.devices)
        self.speed_limits.show_limits(view.limits)
        self.speed_limits.show_pace(view.together, view.pace, view.slowed, view.brake)
        self.stop_bar.show_cut_off(view.ros == ROS_CUT_OFF)
        self.stop_bar.show_power(any(robot.offers_power for robot in view.robots))
        self.stop_bar.show_stop(view.stop_all, view.stop_note, stop_words(
            view.robots, view.stop_taken, view.answers))
        self.status_line.show_status(view.status, view.status_level)
        self.status_line.setVisible(not self.control_bar.asking)
        self._show_buttons()
        self._show_stick(numbers)
        self.stage.show_driven([robot.name for robot in view.robots if robot.selected])
        self.stage.watch_shapes()
        self.stage.show_stick(view.mode == VIRTUAL_JOYSTICK and view.control.ours)
        if numbers:
            cameras = words.bandwidth_text(view.camera_bits_per_s)
            self.cameras_label.show_text(cameras, theme.MUTED, (cameras.partition(' ')[2], ''))

    def show_name_problem(self, text):
        """Show the reason for refusing a name below the name field; '' clears it."""
        self.name_problem_label.show_text(text)
        self.name_problem_sign.show_sign(theme.WARNING if text else None)
        for part, shown in ((self.name_problem_label, text), (self.look_label, not text)):
            part.setVisible(bool(shown))

    def show_look_result(self, text, busy=False, shorter=()):
        """Show the result of a search below the name field for a while; ``busy`` during the search.

        :param shorter: alternatives if the text does not fit, the longest first
        """
        self.look_label.show_text(text, theme.MUTED, shorter)
        self.look_button.setEnabled(not busy)
        self.stage.invitation.show_result(text, busy)
        if busy:
            self._result_timer.stop()
        else:
            self._result_timer.start()

    def clear_name(self):
        """Clear the name field after adding its robot, so that the keys drive again."""
        self.name_edit.clear()
        if self.name_edit.hasFocus():
            self.setFocus()
        self.show_name_problem('')

    def look_at(self, name):
        """Show this robot large; '' shows the driven robots large."""
        if name:
            self.robot_list.activate(name)
        else:
            self.robot_list.clear()

    def _on_highlight(self, name):
        """Show the robot of the highlighted row large."""
        self.stage.look_at(name)
        self._show_buttons()
        self.looked_at.emit(name)

    def _drive_rows(self, robot, others):
        """Return the row of a robot's menu that drives it and no other."""
        if not self._view.control.ours or robot.selected and not others:
            return [('Drive {}{}'.format(robot.name, ' (driven)' if robot.selected else ''), None)]
        return [('Drive {}'.format(robot.name), partial(self.drive_requested.emit, robot.name))]

    def _stop_rows(self, robot, _):
        """Return the row that stops a robot."""
        return [('Stop {}'.format(robot.name),
                 partial(self.stop_robot_requested.emit, robot.name))]

    def _remove_rows(self, robot, _):
        """Return the row that removes a lost robot; one in use is removed below the list."""
        if robot.link not in (SILENT, GONE):
            return []
        return [('Remove {} from the list'.format(robot.name), None if remove_question(robot)
                 else partial(self.remove_steps.remove_requested.emit, robot.name))]

    def _drive_number(self, number):
        """Drive only the robot with a number."""
        for robot in self._view.robots:
            if robot.number == number > 0:
                self.drive_requested.emit(robot.name)

    def robot_in_view(self):
        """Return the robot in view, '' without one."""
        return self.stage.looked_at or next(iter(self.stage.large), '')

    def _drive_looked_at(self):
        """Drive only the robot in view."""
        name = self.robot_in_view()
        if name:
            self.drive_requested.emit(name)

    def contextMenuEvent(self, event):  # noqa: N802
        """Open the menu of the robot in view by the menu key."""
        if event.reason() == QContextMenuEvent.Keyboard:
            self.robot_menu.open(self.robot_in_view(), event.globalPos())

    def _stop_number(self, number):
        """Stop only the robot with a number."""
        for robot in self._view.robots:
            if robot.number == number > 0:
                self.stop_robot_requested.emit(robot.name)

    def _stop_looked_at(self):
        """Stop only the robot in view; without one, each of those shown large."""
        for name in [self.stage.looked_at] if self.stage.looked_at else list(self.stage.large):
            self.stop_robot_requested.emit(name)

    def _on_command(self, command):
        """Handle a key command of the screen."""
        act = {'keys': self.key_help.toggle, 'drawer': self.drawer_button.toggle,
               'focus': self.arrangement.change_focus,
               'numbers': lambda: self.arrangement.show_numbers(not self.stage.numbers_shown),
               'full_screen': self.arrangement.change_full_screen}.get(command)
        if act is not None:
            act()

    def minimumSizeHint(self):  # noqa: N802
        """Return the minimum usable size, at which large parts are shrunk.

        With any font size it fits on the monitor, including STOP ALL.
        """
        unit = self.fontMetrics().height()
        return fitting(QSize(38 * unit, 26 * unit))

    @property
    def remote(self):
        """The kind of remote display ('VNC', 'forwarded X'), '' if local."""
        return self.drive_keys.limit.remote

    def stick(self):
        """Return the deflection by pointer or keys: (forward, turn, sideways), each in [-1, 1]."""
        return self._stick

    def centre_stick(self):
        """Centre the stick; pointer and keys must grab it again."""
        self.drive_keys.centre()
        self.joystick.centre()

    def keyPressEvent(self, event):  # noqa: N802
        """Clear the highlight on Escape, as a click on a row leaves the keyboard focus here."""
        if event.key() == Qt.Key_Escape and self.robot_list.current is not None:
            self.robot_list.clear()
        else:
            super().keyPressEvent(event)

    def hideEvent(self, event):  # noqa: N802
        """Centre the stick, because a hidden panel must not drive."""
        self.centre_stick()
        super().hideEvent(event)

    def save_settings(self):
        """Return the appearance as a plain dict of JSON values."""
        settings = self.arrangement.save_settings()
        if self.isWindow():
            settings['geometry'] = geometry_of(self)
        return settings

    def restore_settings(self, settings):
        """Apply a dict of :meth:`save_settings`, validated by :func:`usable_state`."""
        self.arrangement.restore_settings(settings)
        if 'geometry' in settings and self.isWindow():
            restore_geometry(self, settings['geometry'])

    def _record(self):
        """Request to record all selected robots, or to end every recording."""
        running = [robot.name for robot in self._view.robots if robot.recording]
        if running:
            self.stop_record_requested.emit(running)
        else:
            self.record_requested.emit(
                [robot.name for robot in self._view.robots if robot.selected])

    def _talk(self, pressed):
        """Start or stop push-to-talk by the button."""
        self._talk_pressed = pressed
        self._emit_talk()

    def _emit_talk(self, *_):
        """Emit whether button or key is held; show a held key as a pressed button."""
        talking = self._talk_pressed or self.drive_keys.talking
        self.talk_button.setDown(talking)
        self.talk_requested.emit(talking and self._view.mode == VOICE)

    def _on_stop(self):
        """Stop: centre the stick first, then emit the request."""
        self.centre_stick()
        self.stop_requested.emit()

    def _on_stick(self):
        """Combine pointer and keys; the pointer has priority while it drags the knob."""
        keys = self.drive_keys.deflection()
        self.joystick.show_keys(*keys)
        stick = self.joystick.deflection() if self.joystick.dragging else keys
        if stick != self._stick:
            neutral = not any(stick)
            self._stick = stick
            self.stick_moved.emit(*stick)
            self._show_stick(neutral or self._numbers.due())

    def _show_buttons(self):
        """Enable the buttons that apply."""
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
        """Show the command of the stick, and whether it has an effect."""
        view = self._view
        in_force = view.mode == VIRTUAL_JOYSTICK and not view.stop_all and view.control.ours
        self.joystick.show_active(in_force)
        sideways = any(robot.selected and robot.holonomic for robot in view.robots)
        self.joystick.offer_sideways(sideways)
        self.talk_button.setVisible(view.mode == VOICE)
        shorter = ()
        if not view.control.ours:
            note = 'no effect: {} drives'.format(view.control.who)
        elif view.stop_all:
            note = 'no effect: stop all is in force'
        elif view.mode is None:
            note = 'no effect: mode still unknown'
        elif view.mode == VOICE:
            note, shorter = words.voice_texts(view.heard, next(
                (device for device in view.devices if device.source == VOICE), None))
        elif not in_force:
            note = 'no effect: {} drives'.format(self.mode_combo.label_of(view.mode))
        elif self.remote:
            note, shorter = words.remote_stick_texts(self.remote)
        else:
            note = 'drag, arrow keys or W A S D; space centres'
            shorter = ('drag, arrows or W A S D', 'drag, arrows, W A S D')
            if sideways:
                note, shorter = note.replace(';', ', Q E sideways;'), (
                    'drag, arrows or W A S D, Q E sideways',)
        self.drive_note.show_text(note, theme.MUTED, shorter)
        if numbers:
            tone = theme.TEXT if in_force else theme.MUTED
            linear, turn = words.command_texts(*self._stick, limits=view.limits)
            self.linear_label.show_text(linear, tone)
            self.turn_label.show_text(turn, tone)
