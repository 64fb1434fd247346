# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""F1: the keys, over the pictures and never over STOP ALL; every key works while they are shown."""
from python_qt_binding.QtCore import QEvent, QRect, Qt
from python_qt_binding.QtGui import QFontMetrics, QKeySequence, QPainter
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.gui import theme
from mhri.base.remote_display import HELD_S
from mhri.driving.gui.drive_keys import COMMANDS

# What the keys of the screen do: one line for each value of COMMANDS.
COMMAND_WORDS = {
    'keys': 'show or hide these keys',
    'drawer': 'open or close the panel at the left',
    'focus': 'go on to the panel, to the buttons below, and back to the pictures',
    'full_screen': 'fill the whole screen, or be a window again',
    'map': 'map and picture change places',
    'numbers': 'show or hide the numbers over the pictures',
    'stills': 'save a still of every picture',
    'carry_on': 'continue the task that the robot you look at was taken from',
    'record': 'record the whole session, or end the recording',
    'mark': 'mark this moment, with a note if you like; while keys drive, N again for the note',
}
DRIVE_KEYS = 'arrows or W A S D'
# (keys, what they do), in the order on show.
KEY_ROWS = (
    ('Shift+Space', 'STOP ALL; held for 2 s, also cut the power of the motors'),
    (DRIVE_KEYS, 'drive while they are held; two at once combine'),
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
    """Lies over a screen; takes neither the keyboard nor a key but Escape. A click hides it.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`, its form loaded
    """

    def __init__(self, screen):
        super().__init__(screen)
        self._screen = screen
        self._rows = KEY_ROWS
        self._build()
        self._connect()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('key_help')
        self.setFocusPolicy(Qt.NoFocus)
        self.setPalette(theme.over_picture(self.palette()))
        self.setAccessibleName(TITLE)
        self.hide()
        self.show_rows(KEY_ROWS)

    def _connect(self):
        """Follow the room there is."""
        for part in (self._screen.splitter, self._screen.stage):
            part.installEventFilter(self)

    def show_rows(self, rows):
        """Show these keys: (keys, what they do)."""
        self._rows = tuple(rows)
        self.setAccessibleDescription('; '.join('{}: {}'.format(*row) for row in self._rows))

    def show_remote(self, remote):
        """Say how the keys drive on a remote display; '' is one of this computer."""
        if remote:
            self.show_rows((keys, 'drive while they repeat: without, for {:.0f} s'.format(HELD_S)
                            if keys == DRIVE_KEYS else text) for keys, text in self._rows)

    def toggle(self):
        """Show it, or hide it."""
        if self.isVisible():
            self.hide()
            return
        self._place()
        self.show()
        self.raise_()

    def _place(self):
        """Cover what is above the foot; only the pictures where the foot is beside them."""
        screen = self._screen
        part = screen.stage if screen.splitter.isAncestorOf(screen.foot) else screen.splitter
        self.setGeometry(QRect(part.mapTo(screen, part.rect().topLeft()), part.size()))

    def showEvent(self, event):  # noqa: N802
        """Listen for Escape."""
        super().showEvent(event)
        QApplication.instance().installEventFilter(self)

    def hideEvent(self, event):  # noqa: N802
        """Listen no more."""
        super().hideEvent(event)
        QApplication.instance().removeEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802
        """Hide at Escape, wherever the keyboard is; fit the room there is."""
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
        """Hide."""
        self.hide()

    def places(self):
        """Return (font, [(rectangle, text, whether it is a key)]): as large as all of it fits."""
        found = None
        for scale in _SCALES:
            for columns in (1, 2, 3):
                font = theme.larger(theme.base_font(self._screen.font()), scale)
                found = font, self._columns(font, columns)
                if all(self.rect().contains(box) for box, _, _ in found[1]):
                    return found
        return found

    def _columns(self, font, columns):
        """Return the places in so many columns."""
        bold = theme.larger(font, 1.0, bold=True)
        unit, metrics = QFontMetrics(font).height(), QFontMetrics(font)
        keys_px = theme.text_width(bold, *(keys for keys, _ in self._rows))
        each = (self.width() - unit) // columns
        words_px = each - keys_px - 2 * unit
        places = [(QRect(unit, unit // 2, theme.text_width(bold, TITLE), unit), TITLE, True)]
        in_each = -(-len(self._rows) // columns)
        for column in range(columns):
            left, y = unit + column * each, 2 * unit
            for keys, text in self._rows[column * in_each:(column + 1) * in_each]:
                room = QRect(left + keys_px + unit, y, max(1, words_px), 100 * unit)
                room.setHeight(metrics.boundingRect(room, int(Qt.TextWordWrap), text).height())
                places += [(QRect(left, y, keys_px, unit), keys, True), (room, text, False)]
                y += room.height() + unit // 3
        return places

    def paintEvent(self, event):  # noqa: N802
        """Paint the ground and the table."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), _GROUND)
        painter.fillRect(self.rect(), _GROUND)
        font, places = self.places()
        bold = theme.larger(font, 1.0, bold=True)
        for box, text, is_key in places:
            painter.setFont(bold if is_key else font)
            painter.setPen(theme.colour(theme.TEXT if is_key else theme.MUTED, self.palette()))
            painter.drawText(box, int(Qt.AlignLeft | Qt.AlignTop | Qt.TextWordWrap), text)
