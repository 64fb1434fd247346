# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""F1: the list of keys, over the pictures, never over STOP ALL; all keys work while it is shown."""
from python_qt_binding.QtCore import QEvent, QRect, Qt
from python_qt_binding.QtGui import QFontMetrics, QKeySequence, QPainter
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui import theme
from mhri.base.remote_display import HELD_S
from mhri.driving.gui.drive_keys import COMMANDS

# Descriptions of the keys of the screen: one line for each value of COMMANDS.
COMMAND_WORDS = {
    'keys': 'show or hide these keys',
    'drawer': 'open or close the panel at the left',
    'focus': 'go on to the panel, to the buttons below, and back to the pictures',
    'full_screen': 'toggle full screen',
    'map': 'map and picture change places',
    'numbers': 'show or hide the numbers over the pictures',
    'stills': 'save a still of every picture',
    'carry_on': 'continue the task that the robot you look at was taken from',
    'record': 'record the whole session, or end the recording',
    'mark': 'mark this moment, with a note if you like; while keys drive, N again for the note',
}
DRIVE_KEYS = 'arrows or W A S D'
# (keys, description), in the order shown.
KEY_ROWS = (
    ('Shift+Space', 'STOP ALL; held for 2 s, also cut the power of the motors'),
    ('Shift+1 to Shift+9', 'stop the robot of that number, until it is selected anew'),
    ('Shift+Enter', 'stop the robot you look at'),
    (DRIVE_KEYS, 'drive while they are held; two at once combine'),
    ('Q, E', 'sideways to the left, to the right, with robots that can'),
    ('Space', 'centre the stick'),
    ('1 to 9', 'add the robot of that number to those driven, or take it out'),
    ('Ctrl+1 to Ctrl+9', 'drive the robot of that number and no other'),
    ('0', 'select all robots, or none'),
    ('Tab, Shift+Tab', 'look at the next picture, or the one before'),
    ('Enter', 'drive the robot you look at and no other; press the button in the frame'),
    ('Esc', 'hide these keys; then look at the robots that are driven'),
    ('T, held', 'talk, while the voice drives'),
    ('+, -', 'zoom the map'),
) + tuple((QKeySequence(key).toString(), COMMAND_WORDS[command])
          for key, command in COMMANDS.items())
TITLE = 'Keys'
_SCALES = (1.3, 1.15, 1.0, 0.9, 0.8, 0.7, 0.6, 0.5)
_GROUND = theme.OVER_PICTURE


class KeyHelp(QWidget):
    """An overlay on a screen; it uses no key but Escape, and never has the focus. A click hides it.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, with its form loaded
    """

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._rows, self._page = KEY_ROWS, ()
        self._build()
        self._connect()

    def _build(self):
        """Set the constant properties."""
        self.setObjectName('key_help')
        self.setFocusPolicy(Qt.NoFocus)
        self.setPalette(theme.over_picture(self.palette()))
        self.setAccessibleName(TITLE)
        self.hide()
        self.show_rows(KEY_ROWS)

    def _connect(self):
        """Follow the size of the screen's parts."""
        for part in (self._screen.splitter, self._screen.stage):
            part.installEventFilter(self)

    def show_rows(self, rows):
        """Show a list of (keys, description)."""
        self._rows = tuple(rows)
        self.setAccessibleDescription('; '.join(
            '{}: {}'.format(*row) for row in (*self._rows, *self._page)))
        self.update()

    def show_page(self, rows):
        """Show the second page below: (keys, description) of the robot in view."""
        if tuple(rows) != self._page:
            self._page = tuple(rows)
            self.show_rows(self._rows)

    def show_remote(self, remote):
        """Describe how the keys drive on a remote display; '' for a local one."""
        if remote:
            self.show_rows((keys, 'drive while they repeat: without, for {:.0f} s'.format(HELD_S)
                            if keys == DRIVE_KEYS else text) for keys, text in self._rows)

    def toggle(self):
        """Show or hide the list."""
        if self.isVisible():
            self.hide()
            return
        self._place()
        self.show()
        self.raise_()

    def _place(self):
        """Cover the area above the foot."""
        screen = self._screen
        part = screen.splitter
        self.setGeometry(QRect(part.mapTo(screen, part.rect().topLeft()), part.size()))

    def showEvent(self, event):  # noqa: N802
        """Listen for Escape."""
        super().showEvent(event)
        QApplication.instance().installEventFilter(self)

    def hideEvent(self, event):  # noqa: N802
        """Stop listening for Escape."""
        super().hideEvent(event)
        QApplication.instance().removeEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802
        """Hide on Escape, whichever widget has the focus; follow a change of size."""
        kind = event.type()
        if kind in (QEvent.KeyPress, QEvent.ShortcutOverride) and self.isVisible() \
                and event.key() == Qt.Key_Escape:
            if kind == QEvent.KeyPress:
                self.hide()
            event.accept()
            return True
        if kind in (QEvent.Resize, QEvent.Move) and self.isVisible() \
                and watched in (self._screen.splitter, self._screen.stage):
            self._place()
        return False

    def mousePressEvent(self, event):  # noqa: N802
        """Hide the list."""
        self.hide()

    def places(self):
        """Return (font, [(rectangle, text, whether it is a key)]), as large as everything fits."""
        found = None
        for scale in _SCALES:
            for columns in (1, 2, 3):
                font = theme.larger(theme.base_font(self._screen.font()), scale)
                found = font, self._columns(font, columns)
                if all(self.rect().contains(box) for box, _, _ in found[1]):
                    return found
        return found

    def _columns(self, font, columns):
        """Return the rectangles for a number of columns."""
        rows = (*self._rows, *self._page)
        bold = theme.larger(font, theme.BODY, bold=True)
        unit, metrics = QFontMetrics(font).height(), QFontMetrics(font)
        keys_px = theme.text_width(bold, *(keys for keys, _ in rows))
        each = (self.width() - unit) // columns
        words_px = each - keys_px - 2 * unit
        places = [(QRect(unit, unit // 2, theme.text_width(bold, TITLE), unit), TITLE, True)]
        in_each = -(-len(rows) // columns)
        for column in range(columns):
            left, y = unit + column * each, 2 * unit
            for keys, text in rows[column * in_each:(column + 1) * in_each]:
                room = QRect(left + keys_px + unit, y, max(1, words_px), 100 * unit)
                room.setHeight(metrics.boundingRect(room, int(Qt.TextWordWrap), text).height())
                places += [(QRect(left, y, keys_px, unit), keys, True), (room, text, False)]
                y += room.height() + unit // 3
        return places

    def paintEvent(self, event):  # noqa: N802
        """Paint the background and the table."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), _GROUND)
        painter.fillRect(self.rect(), _GROUND)
        font, places = self.places()
        bold = theme.larger(font, theme.BODY, bold=True)
        for box, text, is_key in places:
            painter.setFont(bold if is_key else font)
            painter.setPen(theme.colour(theme.TEXT if is_key else theme.MUTED, self.palette()))
            painter.drawText(box, int(Qt.AlignLeft | Qt.AlignTop | Qt.TextWordWrap), text)
