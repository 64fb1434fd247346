# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keyboard as a stick and as switches, in every window of the program.

One object watches the key events of the whole application, because drive keys have to work
whatever widget has the focus, and stop-all from anywhere at all. It acts in the *drive areas*
alone: widgets marked by :func:`mark_drive_area` (panel, bot windows) and what is in them; another
rqt plugin beside the panel keeps its keys, and so does another panel. Stop-all knows no such
bounds.
"""
from python_qt_binding.QtCore import QEvent, QObject, Qt, QTimer, Signal
from python_qt_binding.QtWidgets import (
    QAbstractButton, QAbstractItemView, QAbstractSlider, QAbstractSpinBox, QApplication, QComboBox,
    QLineEdit, QPlainTextEdit, QTextEdit, QWidget)

from mhri.base.gui.arrows import keeps_arrows
from mhri.driving.gui.hold_limit import HoldLimit
from mhri.driving.gui.key_state import KeyState
from mhri.driving.gui.stop_bar import CUT_AFTER_S
from mhri.driving.gui.stop_clear import keep_clear, press_beneath

_AHEAD, _BACK, _LEFT, _RIGHT = (1, 0), (-1, 0), (0, 1), (0, -1)

_ARROWS = {int(Qt.Key_Up): _AHEAD, int(Qt.Key_Down): _BACK, int(Qt.Key_Left): _LEFT,
           int(Qt.Key_Right): _RIGHT}
_LETTERS = {int(Qt.Key_W): _AHEAD, int(Qt.Key_S): _BACK, int(Qt.Key_A): _LEFT,
            int(Qt.Key_D): _RIGHT}
# Where W, A, S, D are on a keyboard of any language: evdev key code + 8, as X11 and Wayland count.
_POSITIONS = {25: _AHEAD, 39: _BACK, 38: _LEFT, 40: _RIGHT}
_DIGIT_POSITIONS = {code: (code - 9) % 10 for code in range(10, 20)}
# With Shift its keys mean arrows or digits as Num Lock says: neither is what a hand means that
# reaches for Shift and a digit.
_NUMBER_PAD = frozenset(range(79, 92))
_DIGITS = {int(Qt.Key_0) + digit: digit for digit in range(10)}
_ENTER = (int(Qt.Key_Return), int(Qt.Key_Enter))
_SPACE = int(Qt.Key_Space)
_TALK = int(Qt.Key_T)
_TABS = {int(Qt.Key_Tab): 1, int(Qt.Key_Backtab): -1}
# Keys of the screen, and what they are for.
COMMANDS = {int(Qt.Key_F1): 'keys', int(Qt.Key_F2): 'drawer', int(Qt.Key_F6): 'focus',
            int(Qt.Key_F11): 'full_screen',
            int(Qt.Key_C): 'carry_on', int(Qt.Key_M): 'map', int(Qt.Key_H): 'numbers',
            int(Qt.Key_P): 'stills', int(Qt.Key_R): 'record', int(Qt.Key_N): 'mark'}
# Keys of the map; the first of them without Shift.
ZOOMS = {int(Qt.Key_Equal): 'closer', int(Qt.Key_Plus): 'closer', int(Qt.Key_Minus): 'wider'}

_KEYS = frozenset((QEvent.KeyPress, QEvent.KeyRelease, QEvent.ShortcutOverride))
# After one of these the releases of held keys may go to somebody else.
_LOSSES = frozenset((QEvent.WindowDeactivate, QEvent.WindowBlocked, QEvent.ApplicationDeactivate))
# Before one of these somebody else may have had the releases of keys that were held.
_ARRIVALS = frozenset((QEvent.WindowActivate, QEvent.WindowUnblocked, QEvent.ApplicationActivate,
                       QEvent.FocusIn))

# What lies over other windows comes, or changes its place.
_PLACED = frozenset((QEvent.Show, QEvent.Move, QEvent.Resize))

_TEXT_FIELDS = (QLineEdit, QAbstractSpinBox, QTextEdit, QPlainTextEdit)
_ARROW_USERS = (QAbstractSlider, QComboBox, QAbstractItemView)
# How often the X server is asked whether a key that is held here is down in truth: whoever grabs
# the keyboard (a shortcut of the desktop) keeps its release, and tells nobody.
_LOOK_MS = 40
_AREA = 'mhri_drive_area'


def mark_drive_area(widget, owner=None):
    """Let the drive keys work in a widget and everything in it.

    :param owner: a widget of the panel that a window of its own belongs to
    """
    widget.setProperty(_AREA, True)
    widget.drive_owner = owner


def _direction(event):
    """Return the (forward, turn) that a key stands for, or None."""
    arrow = _ARROWS.get(event.key())
    if arrow is not None:
        return arrow
    code = event.nativeScanCode()
    return _POSITIONS.get(code) if code else _LETTERS.get(event.key())


def _digit(event):
    """Return the digit that a key stands for, by its place or on the number pad, or None."""
    code = event.nativeScanCode()
    if code in _DIGIT_POSITIONS:
        return _DIGIT_POSITIONS[code]
    if code and not event.modifiers() & Qt.KeypadModifier:
        return None
    return _DIGITS.get(event.key())


def _is_shifted_number_pad(event):
    """Tell whether a key is on the number pad, and pressed with Shift."""
    return bool(event.modifiers() & Qt.ShiftModifier) and bool(
        event.modifiers() & Qt.KeypadModifier or event.nativeScanCode() in _NUMBER_PAD)


def _identity(event):
    """Return what a press and its release have in common, even if a modifier changed between."""
    return event.nativeScanCode() or event.key()


def _is_text_field(widget):
    """Tell whether typing into a widget is writing."""
    return isinstance(widget, _TEXT_FIELDS) or (
        isinstance(widget, QComboBox) and widget.isEditable())


class DriveKeys(QObject):
    """Event filter for the application: ``QApplication.instance().installEventFilter(keys)``.

    Arrows, and W A S D by their place, hold the stick; several at once add up. Space centres it:
    the keys held then are dead until released. T held is push-to-talk. Digits are the switches of
    the robots. Return activates the focused button, since space never does. Without effect while a
    text field has the focus or a list is open, and with Ctrl, Alt or Meta; but Shift+Space stops
    everything, always, and held for 2 s cuts the power. With Shift the number pad does nothing. A
    key acts once, however long it is held, and counts as let go when it is
    (:mod:`mhri.driving.gui.key_state`); on a remote display also when no key has been pressed or
    repeated for a second. It then has to be pressed again.

    :param panel: the panel; a key that no widget has the focus for is its own
    :param keys: :class:`mhri.driving.gui.key_state.KeyState`
    """

    #: forward and turn, each -1, 0 or 1; on every change, at once
    moved = Signal(float, float)
    #: space: the stick has to be centred, whoever holds it
    centre_pressed = Signal()
    #: Shift+Space
    stop_pressed = Signal()
    #: both are held since then, for as long as the stop button has to be to cut the power
    stop_held = Signal()
    #: a digit 1..9
    robot_pressed = Signal(int)
    #: the digit 0
    all_pressed = Signal()
    #: Ctrl and a digit: the robot of that number and no other
    alone_pressed = Signal(int)
    #: Tab between the pictures: 1, or -1 with Shift
    next_pressed = Signal(int)
    #: Return where no button has the focus: drive the robot that is looked at
    drive_pressed = Signal()
    #: one of the keys of the screen: a value of ``COMMANDS``
    command_pressed = Signal(str)
    #: T was pressed or let go (push-to-talk)
    talk_changed = Signal(bool)
    #: keys that were held count as let go: nothing came from the remote display
    ran_out = Signal()

    # Of all in this program the one whose panel had the keyboard last.
    _latest = None

    def __init__(self, panel, keys=None):
        super().__init__(panel)
        self._latest_one()
        self._panel = panel
        self._keys = keys or KeyState()
        # Identities of the keys that are down, as far as they are known here.
        self._down = set()
        self._held = {}
        self._dead = set()
        self._deflection = (0.0, 0.0)
        self._talk = None
        # The key that was pressed in a text field last, while it is down. One that is of no use
        # there (Return) goes on to what is around it, which may have the focus by then.
        self._typed = None
        # Of the keys that are down those that the X server knows of: not what a program made up.
        self._real = set()
        self._stop_key = 0
        self._stop_timer = QTimer(self)
        self._stop_timer.setSingleShot(True)
        self._stop_timer.setInterval(round(CUT_AFTER_S * 1000))
        self._stop_timer.timeout.connect(self._on_stop_held)
        self._look_timer = QTimer(self)
        self._look_timer.setInterval(_LOOK_MS)
        self._look_timer.timeout.connect(self._look)
        self.limit = HoldLimit(self)
        self.limit.remote = self._keys.remote
        self.limit.ran_out.connect(self._run_out)

    @property
    def talking(self):
        """Whether T is held."""
        return self._talk is not None

    @property
    def holding(self):
        """Whether keys hold the stick, also where they cancel each other."""
        return bool(self._held)

    def deflection(self):
        """Return (forward, turn) as held by the keys now."""
        return self._deflection

    def release(self):
        """Count every key as released; one that is still down has to be pressed again."""
        self._stop_timer.stop()
        self._typed = None
        self._held.clear()
        self._dead.clear()
        self._down = set(self._keys.down() or ())
        self._set_talk(None)
        self._update()

    def centre(self):
        """Count every held key as released until it has been."""
        self._dead.update(self._held)
        self._held.clear()
        self._update()

    def _run_out(self):
        """Let go what nobody has shown to be held still."""
        if self._held or self._talk is not None:
            self.centre()
            self._set_talk(None)
            self.ran_out.emit()

    def close(self):
        """Let every key go, and the X server, too."""
        self.release()
        self._look_timer.stop()
        self._keys.close()
        if DriveKeys._latest is self:
            DriveKeys._latest = None

    def _look(self):
        """Let go the keys that are up in truth, though nobody has said so."""
        held = self._real & (set(self._held) | {self._talk})
        down = self._keys.down()
        if not held or down is None:
            self._look_timer.stop()
            return
        for identity in held - down:
            self._let_go(identity)
            # Its release may still come, and is not for anybody else.
            self._dead.add(identity)

    def _let_go(self, identity):
        """Count a key of ours as released."""
        self._down.discard(identity)
        self._real.discard(identity)
        if identity == self._talk:
            self._set_talk(None)
        self._held.pop(identity, None)
        self._dead.discard(identity)
        self._update()

    def eventFilter(self, watched, event):  # noqa: N802
        """Take the keys that drive; everything else goes its way."""
        kind = event.type()
        if kind in _LOSSES:
            self.release()
        elif kind in _ARRIVALS:
            self._down.intersection_update(self._keys.down() or ())
            if kind == QEvent.FocusIn:
                self._note_focus(watched)
        elif kind in _KEYS and isinstance(watched, QWidget):
            return self._on_key(watched, event, kind)
        elif kind == QEvent.MouseButtonPress and isinstance(watched, QWidget):
            return press_beneath(event)
        elif kind in _PLACED and isinstance(watched, QWidget) and watched.isWindow():
            keep_clear(watched)
        return False

    def _on_key(self, watched, event, kind):
        """Return whether a key event is used up."""
        stops = event.key() == _SPACE and event.modifiers() & Qt.ShiftModifier
        if kind == QEvent.KeyRelease:
            return self._on_release(event) or bool(stops)
        if stops:
            return self._on_stop(event, kind)
        self._note_life()
        focus = QApplication.focusWidget() or watched
        if kind == QEvent.KeyPress and _is_text_field(watched):
            if _identity(event) in self._down:
                # The repeat of a key that was pressed before the field had the keyboard.
                return True
            self._typed = _identity(event)
        if self._typed == _identity(event) or not self._listens(watched, focus) \
                or event.modifiers() & (Qt.AltModifier | Qt.MetaModifier):
            return False
        action = self._action(event, focus)
        if action is None:
            return False
        if kind == QEvent.ShortcutOverride:
            event.accept()
        elif self._is_new(event):
            action()
        return True

    def _note_life(self):
        """Take in that a key comes, or its repeat: what was let go before has been told before.

        Of several keys that are held only the last one repeats.
        """
        if self._real & (set(self._held) | {self._talk}):
            self.limit.renew()
        else:
            self.limit.end()

    def _is_new(self, event):
        """Tell whether a press is one, and not the repeat of one."""
        identity = _identity(event)
        if event.isAutoRepeat() or identity in self._down:
            return False
        self._down.add(identity)
        if event.spontaneous() and event.nativeScanCode():
            self._real.add(identity)
            if not self._look_timer.isActive():
                self._look_timer.start()
        return True

    def _on_stop(self, event, kind):
        """Stop everything; accepted as override, the key is not taken by a shortcut of the host."""
        if kind == QEvent.ShortcutOverride:
            event.accept()
        elif not event.isAutoRepeat():
            # Whatever else was pressed: to stop once more than needed does no harm.
            self.centre()
            self._stop_key = event.nativeScanCode() if event.spontaneous() else 0
            if not self._stop_timer.isActive():
                # A repeat that Qt reads late looks like a press; its release was seen through.
                self._stop_timer.start()
            self.stop_pressed.emit()
        return True

    def _on_stop_held(self):
        """Tell, unless the key is up in truth: its release may wait behind a slow view."""
        down = self._keys.down()
        if not self._stop_key or down is None or self._stop_key in down:
            self.stop_held.emit()

    def _on_release(self, event):
        """Take a release wherever it arrives, so that no key is held for ever."""
        identity = _identity(event)
        ours = identity == self._talk or identity in self._held or identity in self._dead
        if event.isAutoRepeat() or event.nativeScanCode() in (self._keys.down() or ()):
            return ours
        if event.key() in (_SPACE, int(Qt.Key_Shift)):
            self._stop_timer.stop()
        self._down.discard(identity)
        if identity == self._typed:
            self._typed = None
        if ours:
            self._let_go(identity)
        return ours

    def _listens(self, watched, focus):
        """Tell whether keys drive, going by where they are typed."""
        if QApplication.activePopupWidget() is not None:
            return False
        if _is_text_field(focus) or _is_text_field(watched):
            return False
        in_area, panel = self._place_of(focus)
        if panel is not None:
            return panel is self._panel
        # Nobody's: of several panels in one program the one that had the keyboard last.
        return (in_area or focus.isAncestorOf(self._panel)) and self._latest_one() is self

    def _latest_one(self):
        """Return the one whose panel had the keyboard last, this one where that is gone."""
        try:
            if DriveKeys._latest.parent() is not None:
                return DriveKeys._latest
        except (AttributeError, RuntimeError):  # none yet, or Qt has deleted it
            pass
        DriveKeys._latest = self
        return self

    @staticmethod
    def _place_of(widget):
        """Return (whether a widget is in a drive area, the panel that it belongs to or None)."""
        in_area = False
        while widget is not None:
            if hasattr(widget, 'drive_keys'):
                return True, widget
            in_area = in_area or bool(widget.property(_AREA))
            widget = getattr(widget, 'drive_owner', None) or widget.parentWidget()
        return in_area, None

    def _note_focus(self, watched):
        """Take note of the panel that has the keyboard."""
        if isinstance(watched, QWidget) and self._place_of(watched)[1] is self._panel:
            DriveKeys._latest = self

    def _action(self, event, focus):
        """Return what a press has to do, or None where the key is not ours."""
        if _is_shifted_number_pad(event):
            return None if self._keeps_arrows(focus) else lambda: None
        if event.modifiers() & Qt.ControlModifier:
            return self._action_with_ctrl(event)
        return self._action_alone(event, focus)

    def _action_alone(self, event, focus):
        """Return what a press without Ctrl has to do, or None."""
        key = event.key()
        if key == _SPACE:
            return self.centre_pressed.emit
        if key in _ENTER:
            return self._enter_action(focus)
        if key == _TALK:
            return lambda: self._set_talk(_identity(event))
        direction = _direction(event)
        if direction is not None:
            if key in _ARROWS and self._keeps_arrows(focus):
                return None
            return lambda: self._press(_identity(event), direction)
        command = COMMANDS.get(key) or ZOOMS.get(key)
        if command:
            return lambda: self.command_pressed.emit(command)
        if key in _TABS:
            return (lambda: self.next_pressed.emit(_TABS[key])) if self._tabs_pictures(focus) \
                else None
        digit = _digit(event)
        if digit is None:
            return None
        return self.all_pressed.emit if digit == 0 else lambda: self.robot_pressed.emit(digit)

    @staticmethod
    def _keeps_arrows(focus):
        """Tell whether a widget needs the arrow keys itself."""
        return isinstance(focus, _ARROW_USERS) or keeps_arrows(focus)

    def _action_with_ctrl(self, event):
        """Return what a press with Ctrl has to do, or None."""
        digit = _digit(event)
        return (lambda: self.alone_pressed.emit(digit)) if digit else None

    @staticmethod
    def _tabs_pictures(focus):
        """Tell whether Tab goes from picture to picture, and not through what can be clicked."""
        return bool(focus.property(_AREA))

    def _enter_action(self, focus):
        """Return what Return does: to the focused widget, or to the robot that is looked at."""
        if isinstance(focus, QAbstractButton):
            return focus.click if focus.isEnabled() else None
        if isinstance(focus, QComboBox):
            return focus.showPopup
        return self.drive_pressed.emit if focus.property(_AREA) else None

    def _set_talk(self, identity):
        """Hold the key of push-to-talk, or let it go (None)."""
        changed = (identity is None) != (self._talk is None)
        self._talk = identity
        self._note_life()
        if changed:
            self.talk_changed.emit(identity is not None)

    def _press(self, identity, direction):
        """Hold a key."""
        self._dead.discard(identity)
        self._held[identity] = direction
        self._note_life()
        self._update()

    def _update(self):
        """Tell of a changed deflection."""
        held = set(self._held.values())
        deflection = tuple(float(sum(part[axis] for part in held)) for axis in (0, 1))
        if deflection != self._deflection:
            self._deflection = deflection
            self.moved.emit(*deflection)
