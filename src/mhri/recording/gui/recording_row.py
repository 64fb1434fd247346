# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Save IMU Data: switch, path, extra topics, and the state of the recording."""
import os

from python_qt_binding.QtCore import QEvent, Qt, Signal
from python_qt_binding.QtWidgets import QApplication, QFileDialog, QMenu, QWidget

from mhri.base.gui import theme
from mhri.base.gui.controls import Button, LineField
from mhri.base.gui.flow import FlowLayout, let_height_follow
from mhri.base.gui.labels import Sign, TextLine
from mhri.base.gui.layouts import add_parts, in_column, in_row, TIGHT
from mhri.base.gui.pending import Pace, Pending
from mhri.base.gui.switches import SwitchBox
from mhri.recording.recording import (
    CHOICES, duration_text, ENDED, FAILED, RECORDING, size_text)

_ANSWER_WITHIN_S = 3.0


def recording_text(status):
    """Return a :class:`RecordingStatus` as a line; '' if nothing is recorded."""
    if status.state == RECORDING:
        figures = 'recording {}   {:,} messages   {}   {:.0f} Hz'.format(
            duration_text(status.duration_s), status.messages, size_text(status.bytes),
            status.rate_hz)
        return '   '.join(filter(None, (figures, status.words)))
    return status.words


def shorter_text(status):
    """Return a shorter :func:`recording_text`: a saved file without its folder."""
    text = recording_text(status)
    if status.state != ENDED:
        return ()
    return (text.replace(os.path.dirname(status.path) + '/', ''), text.rpartition(': ')[0])


class StayingMenu(QMenu):
    """A menu that stays open while entries are ticked, until Escape or a click outside it."""

    def mouseReleaseEvent(self, event):  # noqa: N802
        """Tick the entry under the pointer."""
        if not self._tick(self.actionAt(event.pos())):
            super().mouseReleaseEvent(event)

    def keyPressEvent(self, event):  # noqa: N802
        """Tick the selected entry."""
        ticks = event.key() in (Qt.Key_Space, Qt.Key_Return, Qt.Key_Enter)
        if not (ticks and self._tick(self.activeAction())):
            super().keyPressEvent(event)

    @staticmethod
    def _tick(action):
        """Tick or untick an entry; return whether it could be ticked."""
        if action is None or not (action.isCheckable() and action.isEnabled()):
            return False
        action.trigger()
        return True


class RecordingRow(QWidget):
    """Requests recordings and shows the present one; opens and writes no file itself.

    Child widgets: ``record_check``, ``path_edit``, ``browse_button``, ``extras_button``,
    ``recording_label``.
    """

    #: path ('' for the default) and a tuple of keys of CHOICES
    record_requested = Signal(str, object)
    stop_record_requested = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._recording = False
        self._state = None
        self._typed = ''
        self._default_path = ''
        self._dialog = None
        self._asked = Pending(_ANSWER_WITHIN_S, self._show_checked)
        self._numbers = Pace()
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the widgets."""
        self.record_check = SwitchBox('Save IMU Data', self)
        self.path_edit = LineField(self)
        self.path_edit.installEventFilter(self)
        self.browse_button = Button('Browse', self)
        self.extras_button = Button(self)
        self.extras_menu = StayingMenu(self.extras_button)
        self.extras = {}
        for key, label in CHOICES:
            self.extras[key] = self.extras_menu.addAction(label)
            self.extras[key].setCheckable(True)
        self.extras_button.setMenu(self.extras_menu)
        self.recording_sign = Sign(self)
        self.recording_label = TextLine(self)
        self.recording_label.setFont(theme.number_font(self.font()))
        for name, spoken in (('record_check', 'save IMU data'),
                             ('path_edit', 'file to save to; empty: the default'),
                             ('browse_button', 'choose the file to save to'),
                             ('extras_button', 'what to save besides the IMU'),
                             ('recording_label', 'recording')):
            part = getattr(self, name)
            part.setObjectName(name)
            part.setAccessibleName(spoken)
            part.setMinimumHeight(0 if part is self.recording_label else theme.touch_size(self))
        for button in (self.browse_button, self.extras_button):
            button.setFocusPolicy(Qt.TabFocus)
        self.extras_button.setMinimumWidth(
            theme.text_width(self.font(), 'IMU + 5') + 2 * self.fontMetrics().height())
        self._lay_out()

    def _lay_out(self):
        """Place the parts on two lines."""
        first, second = FlowLayout(), in_row(self.recording_sign, (self.recording_label, 1), gap=8)
        add_parts(first, self.record_check, self.path_edit, self.browse_button, self.extras_button)
        in_column(first, second, of=self, margins=TIGHT, gap=4)
        let_height_follow(self)

    def _connect(self):
        """Connect the controls."""
        self.record_check.clicked.connect(self._on_click)
        self.path_edit.returnPressed.connect(self._leave_path)
        self.browse_button.clicked.connect(self._browse)
        self.extras_menu.triggered.connect(self._show_extras)

    def _restore(self):
        """Set the initial state, without a recording."""
        self.set_default_path('')
        self._show_extras()
        self._show_checked()

    @property
    def path(self):
        """The requested path, '' for the default."""
        return self._typed if self._recording else self.path_edit.text().strip()

    def chosen_extras(self):
        """Return the keys of the extras to record besides the IMU, in the order of CHOICES."""
        return tuple(key for key, action in self.extras.items()
                     if action.isChecked() and action.isVisible())

    def offer_extras(self, keys):
        """Offer only these extras; others are neither shown nor recorded."""
        for key, action in self.extras.items():
            action.setVisible(key in keys)
        self._show_extras()

    def set_default_path(self, path):
        """Show the default path in an empty field, e.g. "~/.ros/bot1_<date-time>.bag"."""
        self._default_path = path or '~/.ros/'
        self.path_edit.setPlaceholderText(path or 'a new file in ~/.ros')

    def show_recording(self, status):
        """Show a :class:`RecordingStatus`; states at once, numbers at 4 Hz."""
        recording = status.state == RECORDING
        changed = status.state != self._state
        self._state = status.state
        if recording != self._recording:
            self._recording = recording
            self._lock_path(recording)
        if recording and status.path != self.path_edit.text():
            self.path_edit.setText(status.path)
        self._show_checked()
        if self._numbers.due() or changed:
            self._show_line(status)

    def _lock_path(self, locked):
        """Keep the typed text while a recording shows its own path, and restore it afterwards."""
        if locked:
            self._typed = self.path_edit.text().strip()
        else:
            self.path_edit.setText(self._typed)
        self.path_edit.setReadOnly(locked)
        for widget in (self.browse_button, self.extras_button):
            widget.setEnabled(not locked)

    def _show_line(self, status):
        """Show state, figures and note."""
        signs = {RECORDING: (theme.DISC, theme.DRIVE), ENDED: (theme.TICK, theme.LIVE),
                 FAILED: theme.WARNING}
        # A file saved elsewhere than requested counts as a fault.
        fault = status.attention or status.elsewhere
        self.recording_sign.show_sign(theme.WARNING if fault
                                      else signs.get(status.state))
        self.recording_label.show_text(recording_text(status), shorter=shorter_text(status))

    def _show_checked(self):
        """Show the requested state in the box, then the actual one."""
        self.record_check.setChecked(self._asked.settle(self._recording))

    def _on_click(self, checked):
        """Request to start or stop a recording."""
        self._asked.ask(checked)
        if checked:
            self._leave_path()
            self.record_requested.emit(self.path, self.chosen_extras())
        else:
            self.stop_record_requested.emit()

    def _show_extras(self, *_):
        """Show the number of chosen extras on the button."""
        extras = self.chosen_extras()
        self.extras_button.setText('IMU + {}'.format(len(extras)) if extras else 'IMU only')
        self.extras_button.setToolTip('saved: IMU' + ''.join(
            ', ' + self.extras[key].text().lower() for key in extras))

    def _leave_path(self):
        """Release the keyboard focus, so that the keys drive again."""
        if self.path_edit.hasFocus():
            self.window().setFocus()

    def eventFilter(self, watched, event):  # noqa: N802
        """Leave the path with Escape."""
        if watched is self.path_edit and event.type() == QEvent.KeyPress \
                and event.key() == Qt.Key_Escape:
            self._leave_path()
            return True
        return super().eventFilter(watched, event)

    def _browse(self):
        """Open a non-modal file dialog; a second click brings it to the front."""
        if self._dialog is None:
            # Not a child of this window, whose letters and arrows drive: its lists need those keys.
            folder = os.path.dirname(os.path.expanduser(self._default_path))
            self._dialog = QFileDialog(None, 'Save IMU data', folder, 'Bags (*.bag)')
            self._dialog.setFont(self.font())
            self._dialog.setOption(QFileDialog.DontUseNativeDialog)
            self._dialog.setOption(QFileDialog.DontConfirmOverwrite)
            self._dialog.setAcceptMode(QFileDialog.AcceptSave)
            self._dialog.setDefaultSuffix('bag')
            self._dialog.setModal(False)
            self._dialog.fileSelected.connect(self.path_edit.setText)
            self._dialog.destroyed.connect(self._forget_dialog)
            self.destroyed.connect(self._dialog.deleteLater)
        if self.path:
            self._dialog.selectFile(self.path)
        self._place_dialog()
        self._dialog.show()
        self._dialog.raise_()
        self._dialog.activateWindow()

    def _forget_dialog(self, *_):
        """Drop the reference to a deleted dialog, e.g. at the end of the program."""
        self._dialog = None

    def _place_dialog(self):
        """Place the dialog above this row, so that the stop button below stays visible."""
        self._dialog.winId()
        handle = self.window().windowHandle()
        if handle is not None:
            self._dialog.windowHandle().setTransientParent(handle)
        row_top = self.mapToGlobal(self.rect().topLeft())
        screen = QApplication.desktop().availableGeometry(self)
        size = self._dialog.sizeHint()
        height = max(self._dialog.minimumSizeHint().height(),
                     min(size.height(), row_top.y() - screen.top() - 40))
        left = max(screen.left(), min(row_top.x(), screen.right() - size.width()))
        self._dialog.resize(size.width(), height)
        self._dialog.move(left, max(screen.top(), row_top.y() - height - 40))

    def hideEvent(self, event):  # noqa: N802
        """Hide the dialog, too."""
        super().hideEvent(event)
        if self._dialog is not None:
            self._dialog.hide()

    def save_settings(self):
        """Return the extras as a plain dict; a path is valid for one recording only."""
        return {'extras': [key for key, action in self.extras.items() if action.isChecked()]}

    def restore_settings(self, settings):
        """Restore a dict of :meth:`save_settings`."""
        for key, action in self.extras.items():
            action.setChecked(key in settings.get('extras', ()))
        self._show_extras()
