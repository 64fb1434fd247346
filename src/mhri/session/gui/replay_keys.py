# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keys of a replay: keys that drive, stop or record are disabled or move in time."""
from python_qt_binding.QtCore import QEvent, QObject, Qt
from python_qt_binding.QtGui import QKeySequence
from python_qt_binding.QtWidgets import QAbstractButton, QLineEdit, QWidget

from mhri.driving.gui.drive_keys import COMMANDS
from mhri.driving.gui.key_help import COMMAND_WORDS

# Keys: the method of TimeLineBar to call, and its argument.
_MOVES = {
    Qt.Key_Space: ('toggle',), Qt.Key_K: ('toggle',),
    Qt.Key_Left: ('skip', -5.0), Qt.Key_Right: ('skip', 5.0),
    Qt.Key_Home: ('skip', -1e9), Qt.Key_End: ('skip', 1e9),
    Qt.Key_PageUp: ('go_back',), Qt.Key_PageDown: ('go_on',),
    Qt.Key_Up: ('change_speed', 1), Qt.Key_Down: ('change_speed', -1),
    Qt.Key_Plus: ('change_speed', 1), Qt.Key_Minus: ('change_speed', -1)}
# On the live screen these keys drive, stop, select, talk, record or mark.
_IDLE = frozenset((Qt.Key_W, Qt.Key_A, Qt.Key_S, Qt.Key_D, Qt.Key_T, Qt.Key_C, Qt.Key_R, Qt.Key_N,
                   Qt.Key_Return, Qt.Key_Enter))
_DIGITS = frozenset(range(Qt.Key_0, Qt.Key_9 + 1))
_LIST_KEYS = frozenset((Qt.Key_Up, Qt.Key_Down, Qt.Key_Home, Qt.Key_End, Qt.Key_PageUp,
                        Qt.Key_PageDown))
_KINDS = frozenset((QEvent.KeyPress, QEvent.KeyRelease, QEvent.ShortcutOverride))
#: (keys, description), for the page of keys
REPLAY_ROWS = (
    ('Space', 'play, or pause'),
    ('Left, Right', '5 s back, or on'),
    ('Page Up, Page Down', 'to the mark, stop or event before, or to the next'),
    ('Up, Down', 'faster, or slower'),
    ('Home, End', 'to the start, or to the end'),
    ('Tab, Shift+Tab', 'look at the next picture, or the one before'),
) + tuple((QKeySequence(key).toString(), COMMAND_WORDS[command])
          for key, command in COMMANDS.items() if command not in ('carry_on', 'record', 'mark'))


class ReplayKeys(QObject):
    """Event filter for the application; install it after the drive keys' filter to precede it.

    :param bar: :class:`mhri.session.gui.time_line.TimeLineBar`
    """

    def __init__(self, bar):
        super().__init__(bar)
        self._bar = bar

    def eventFilter(self, watched, event):  # noqa: N802
        """Handle the keys that drive or move in time; pass on everything else."""
        if event.type() not in _KINDS or not isinstance(watched, QWidget) \
                or isinstance(watched, QLineEdit):
            return False
        key = event.key()
        if not self._takes(watched, key, event):
            return False
        event.accept()
        if event.type() == QEvent.KeyPress and key in _MOVES and self._moves(event):
            name, *words = _MOVES[key]
            getattr(self._bar, name)(*words)
        return True

    @staticmethod
    def _takes(watched, key, event):
        """Return whether the replay handles a key."""
        if key in (Qt.Key_Return, Qt.Key_Enter) and isinstance(watched, QAbstractButton):
            return False
        if key in _LIST_KEYS and watched.inherits('QAbstractItemView'):
            return False
        return key in _MOVES or key in _IDLE or key in _DIGITS

    @staticmethod
    def _moves(event):
        """Return whether a press moves in time; Shift+Space (stop) and most held keys do not."""
        if event.isAutoRepeat() and event.key() not in (Qt.Key_Left, Qt.Key_Right):
            return False
        return not event.modifiers() & (Qt.ShiftModifier | Qt.ControlModifier | Qt.AltModifier) \
            or event.key() == Qt.Key_Plus
