# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The virtual joystick: a round pad with a knob that springs back."""
from python_qt_binding.QtCore import QSize, Qt, Signal
from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import QSizePolicy, QToolButton

from mhri.base.gui import theme, words
from mhri.base.names import listed
from mhri.driving.gui.spring_pad import CAPTION_LINES, deflection_of, SpringPad, TRAVEL_SHARE

#: text and accessible name of the button that maps the pad's left and right to sideways motion
SIDEWAYS = '\u21c4'
SIDEWAYS_TIP = 'left and right go sideways instead of turning'

_REST = (0.0, 0.0, 0.0)
# Width that is enough for a finger, however large the text [px].
_ENOUGH_PX = 126


class VirtualJoystick(SpringPad):
    """Rotation and translation at once, by mouse or touch.

    Above the pad it names the robots that it drives. For holonomic robots a button beside
    the pad maps its left and right to sideways motion.
    """

    USUAL_UNITS, MIN_UNITS = (9.0, 9.0 + CAPTION_LINES), (7.0, 7.0 + CAPTION_LINES)

    #: forward (ahead +), turn and sideways (left +), each in [-1, 1]; on every change, at once
    moved = Signal(float, float, float)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._deflection = _REST
        #: the robots that it drives, in order
        self.names = ()
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        # A click must not take the focus: the widget that loses it would release the stick.
        self.sideways_button = QToolButton(self, text=SIDEWAYS, checkable=True, visible=False,
                                           focusPolicy=Qt.NoFocus, toolTip=SIDEWAYS_TIP)
        self.sideways_button.setAccessibleName('sideways')
        self.sideways_button.toggled.connect(self._on_sideways)

    def least_size(self, room):
        """Return the minimum size: where a room [px] is too small, a finger's at any text size."""
        size = self.minimumSizeHint()
        spare = max(0, size.width() - room.width(), size.height() - room.height())
        spare = min(spare, max(0, size.width() - _ENOUGH_PX))
        return size - QSize(spare, spare)

    def deflection(self):
        """Return the (forward, turn, sideways) held by the pointer; zeros if it is not held."""
        return self._deflection

    def centre(self):
        """Release the knob, wherever the pointer is; it has to be grabbed again."""
        super().centre()
        self.show_keys(*_REST)

    def show_keys(self, forward, turn, sideways):
        """Show a deflection held by keys; the pointer has priority while it holds the knob."""
        if not self._dragging:
            self._place_knob(-turn or -sideways, forward)

    def show_names(self, names):
        """Show the names of the robots that it drives."""
        if tuple(names) != self.names:
            self.names = tuple(names)
            self.setAccessibleName('virtual joystick of ' + ', '.join(names))
            self.update()

    def offer_sideways(self, offered):
        """Show the button for sideways motion, or hide it and end sideways motion."""
        if offered == self.sideways_button.isHidden():
            self.sideways_button.setVisible(offered)
            self.sideways_button.setChecked(False)

    def _on_sideways(self, sideways):
        """Switch the meaning of left and right; release the knob, since a held one must not change.

        Also show the new meaning.
        """
        self.centre()
        palette = QPalette(self.palette())
        if sideways:
            ground = theme.colour(theme.DRIVE, palette)
            palette.setColor(QPalette.Button, ground)
            palette.setColor(QPalette.ButtonText, theme.readable_on(ground))
        self.sideways_button.setPalette(palette)
        self.update()

    def resizeEvent(self, event):  # noqa: N802
        """Keep the button at the lower right of the round pad."""
        super().resizeEvent(event)
        side, pad = theme.touch_size(self), self.travel() / TRAVEL_SHARE
        middle = self.pad().center().toPoint()
        self.sideways_button.setGeometry(
            min(self.width() - side, middle.x() + round(0.8 * pad)),
            min(self.height(), middle.y() + round(pad)) - side, side, side)

    def _hold(self, across, along):
        """Emit the deflection of a place of the knob."""
        forward, left = deflection_of(across, along)
        self._set_deflection((forward, 0.0, left) if self.sideways_button.isChecked()
                             else (forward, left, 0.0))

    def _is_strong(self, quarter):
        """Return whether an arrow is one of sideways motion, which replaces turning."""
        return bool(quarter % 2) and self.sideways_button.isChecked()

    def _set_deflection(self, deflection):
        """Emit a changed deflection."""
        if deflection != self._deflection:
            self._deflection = deflection
            self.moved.emit(*deflection)

    def paintEvent(self, event):  # noqa: N802
        """Paint the names, the pad and the knob."""
        painter = theme.smooth_painter(self)
        self._paint_caption(painter, self._caption())
        self._paint_all(painter)

    def _caption(self):
        """Return the names of the robots that it drives, as far as they fit."""
        metrics = self.fontMetrics()
        room = self.width() - metrics.height()
        many = '{} robots'.format(len(self.names))
        return theme.fitting_text(metrics, (
            *(listed(self.names, most) for most in (3, 2, 1)),
            *((many,) if len(self.names) > 1 else words.name_ends(self.names[0]))),
            room) if self.names else ''
