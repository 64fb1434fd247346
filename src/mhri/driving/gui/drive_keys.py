# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keyboard as a stick and as switches, in every window of the program.

One object filters the key events of the whole application, because drive keys have to work
whichever widget has the focus, and stop-all from anywhere at all. Drive keys work only in the
*drive areas*: widgets marked by :func:`mark_drive_area` (panel, tiles) and their children; another
rqt plugin beside the panel keeps its keys, as does another panel. Stop-all works everywhere.
"""
from functools import partial

from python_qt_binding.QtCore import QEvent, QObject, Qt, QTimer, Signal
from python_qt_binding.QtWidgets import (
    QAbstractButton, QAbstractItemView, QAbstractSlider, QAbstractSpinBox, QApplication, QComboBox,
    QLineEdit, QPlainTextEdit, QTextEdit, QWidget)

from mhri.base.gui.arrows import keeps_arrows
from mhri.driving.gui.hold_limit import HoldLimit
from mhri.driving.gui.key_state import KeyState
from mhri.driving.gui.stop_bar import CUT_AFTER_S
from mhri.driving.gui.stop_clear import keep_clear, press_beneath

_AHEAD, _BACK, _LEFT, _RIGHT = (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)
_ASIDE_LEFT, _ASIDE_RIGHT = (0, 0, 1), (0, 0, -1)

_ARROWS = {int(Qt.Key_Up): _AHEAD, int(Qt.Key_Down): _BACK, int(Qt.Key_Left): _LEFT,
           int(Qt.Key_Right): _RIGHT}
_LETTERS = {int(Qt.Key_W): _AHEAD, int(Qt.Key_S): _BACK, int(Qt.Key_A): _LEFT,
            int(Qt.Key_D): _RIGHT, int(Qt.Key_Q): _ASIDE_LEFT, int(Qt.Key_E): _ASIDE_RIGHT}
# Where these letters are on a keyboard of any language: evdev key code + 8, as X11 and Wayland
# count.
_POSITIONS = {25: _AHEAD, 39: _BACK, 38: _LEFT, 40: _RIGHT, 24: _ASIDE_LEFT, 26: _ASIDE_RIGHT}
_DIGIT_POSITIONS = {code: (code - 9) % 10 for code in range(10, 20)}
# With Shift its keys are arrows or digits depending on Num Lock; an operator who presses Shift and
# a digit means neither.
_NUMBER_PAD = frozenset(range(79, 92))
_DIGITS = {int(Qt.Key_0) + digit: digit for digit in range(10)}
_ENTER = (int(Qt.Key_Return), int(Qt.Key_Enter))
_SPACE = int(Qt.Key_Space)
# The keys of the second page besides the digits.
_PAGE_ARROWS = {int(Qt.Key_Up): 'Up', int(Qt.Key_Down): 'Down', int(Qt.Key_Left): 'Left',
                int(Qt.Key_Right): 'Right'}
_TALK = int(Qt.Key_T)
_TABS = {int(Qt.Key_Tab): 1, int(Qt.Key_Backtab): -1}
# Keys of the screen, and their commands.
COMMANDS = {int(Qt.Key_F1): 'keys', int(Qt.Key_F2): 'drawer', int(Qt.Key_F6): 'focus',
            int(Qt.Key_F11): 'full_screen',
            int(Qt.Key_C): 'carry_on', int(Qt.Key_M): 'map', int(Qt.Key_H): 'numbers',
            int(Qt.Key_P): 'stills', int(Qt.Key_R): 'record', int(Qt.Key_N): 'mark'}
# Keys of the map; the first one is "+" without Shift.
ZOOMS = {int(Qt.Key_Equal): 'closer', int(Qt.Key_Plus): 'closer', int(Qt.Key_Minus): 'wider'}

_KEYS = frozenset((QEvent.KeyPress, QEvent.KeyRelease, QEvent.ShortcutOverride))
# After one of these events the releases of held keys may go to another program.
_LOSSES = frozenset((QEvent.WindowDeactivate, QEvent.WindowBlocked, QEvent.ApplicationDeactivate))
# Before one of these events another program may have received the releases of held keys.
_ARRIVALS = frozenset((QEvent.WindowActivate, QEvent.WindowUnblocked, QEvent.ApplicationActivate,
                       QEvent.FocusIn))

# Events of windows that appear or change their place.
_PLACED = frozenset((QEvent.Show, QEvent.Move, QEvent.Resize))

_TEXT_FIELDS = (QLineEdit, QAbstractSpinBox, QTextEdit, QPlainTextEdit)
_ARROW_USERS = (QAbstractSlider, QComboBox, QAbstractItemView)
# How often to ask the X server whether a held key is really down [ms]: a program that grabs the
# keyboard (a shortcut of the desktop) receives its release instead.
_LOOK_MS = 40
_AREA = 'mhri_drive_area'


def mark_drive_area(widget, owner=None):
    """Enable the drive keys in a widget and its children.

    :param owner: the widget of the panel that a separate window belongs to
    """
    widget.setProperty(_AREA, True)
    widget.drive_owner = owner


def _direction(event):
    """Return the (forward, turn, sideways) of a key, or None."""
    arrow = _ARROWS.get(event.key())
    if arrow is not None:
        return arrow
    code = event.nativeScanCode()
    return _POSITIONS.get(code) if code else _LETTERS.get(event.key())


def _digit(event):
    """Return the digit of a key, by its position or on the number pad, or None."""
    code = event.nativeScanCode()
    if code in _DIGIT_POSITIONS:
        return _DIGIT_POSITIONS[code]
    if code and not event.modifiers() & Qt.KeypadModifier:
        return None
    return _DIGITS.get(event.key())


def _is_shifted_number_pad(event):
    """Return whether a key is on the number pad and pressed with Shift."""
    return bool(event.modifiers() & Qt.ShiftModifier) and bool(
        event.modifiers() & Qt.KeypadModifier or event.nativeScanCode() in _NUMBER_PAD)


def _identity(event):
    """Return an id common to a press and its release, even if a modifier changed in between."""
    return event.nativeScanCode() or event.key()


def _is_text_field(widget):
    """Return whether a widget is a field for typing text."""
    return isinstance(widget, _TEXT_FIELDS) or (
        isinstance(widget, QComboBox) and widget.isEditable())


class DriveKeys(QObject):
    """Event filter for the application: ``QApplication.instance().installEventFilter(keys)``.

    Arrows, and W A S D by their position, hold the stick; Q and E, by their position, hold it
    sideways for holonomic robots; several keys add up. Space centres it: keys held then have no
    effect until released. T held is push-to-talk. Digits are the switches of the robots. Return
    activates the focused button, since space never does. Keys have no effect while a text field has
    the focus or a list is open, nor with Ctrl, Alt or Meta, but for the second page: digits and
    arrows while Alt is held. And Shift+Space always stops
    everything, and held for 2 s cuts the power. Shift and a digit, by its position, stops that
    robot, Shift+Return the one in view, also while a menu is open. With Shift the number pad has no
    effect. A key acts once, however long it is held, and counts as released when it really is
    (:mod:`mhri.driving.gui.key_state`); on a remote display also when no key has been pressed or
    repeated for a second. It then has to be pressed again.

    :param panel: the panel; it gets the keys while no widget has the focus
    :param keys: :class:`mhri.driving.gui.key_state.KeyState`
    """

    #: forward, turn and sideways (left +), each -1, 0 or 1; on every change, at once
    moved = Signal(float, float, float)
    #: space: centre the stick, whether keys or pointer hold it
    centre_pressed = Signal()
    #: Shift+Space
    stop_pressed = Signal()
    #: Shift or Space was released, or the keys went elsewhere
    stop_let_go = Signal()
    #: Shift+Space was held as long as the stop button for cutting the power
    stop_held = Signal()
    #: a digit 1..9
    robot_pressed = Signal(int)
    #: the digit 0
    all_pressed = Signal()
    #: Shift and a digit 1..9: stop the robot of that number
    robot_stop_pressed = Signal(int)
    #: Shift+Return: stop the robot in view
    stop_looked_at_pressed = Signal()
    #: Ctrl and a digit: the robot of that number and no other
    alone_pressed = Signal(int)
    #: Tab between the pictures: 1, or -1 with Shift
    next_pressed = Signal(int)
    #: Return while no button has the focus: drive the robot in view
    drive_pressed = Signal()
    #: one of the keys of the screen: a value of ``COMMANDS``
    command_pressed = Signal(str)
    #: the keys of the second page that are held: a frozenset of '0' to '9', 'Up', 'Down', ...
    page_changed = Signal(object)
    #: T was pressed or released (push-to-talk)
    talk_changed = Signal(bool)
    #: held keys count as released: no events came from the remote display
    ran_out = Signal()

    # The instance in this program whose panel had the keyboard last.
    _latest = None

    def __init__(self, panel, keys=None):
        super().__init__(panel)
        self._latest_one()
        self._panel = panel
        self._keys = keys or KeyState()
        # Identities of the keys known to be down.
        self._down = set()
        self._held, self._page = {}, {}
        self._dead = set()
        self._deflection = (0.0, 0.0, 0.0)
        self._talk = None
        # The last key pressed in a text field, while it is down. A key not used there (Return) is
        # passed on to the parent, which may have the focus by then.
        self._typed = None
        # The keys that are down for the X server, too: no synthetic events.
        self._real = set()
        self._stop_key = 0
        self._stop_timer = QTimer(self, singleShot=True, interval=round(CUT_AFTER_S * 1000))
        self._stop_timer.timeout.connect(self._on_stop_held)
        self._look_timer = QTimer(self, interval=_LOOK_MS)
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
        """Whether keys hold the stick, even if they cancel each other."""
        return bool(self._held)

    def deflection(self):
        """Return the (forward, turn, sideways) of the held keys."""
        return self._deflection

    def release(self):
        """Treat every key as released; a key still down has to be pressed again."""
        self._end_stop()
        self._typed = None
        self._held.clear()
        self._dead.clear()
        self._set_page({})
        self._down = set(self._keys.down() or ())
        self._set_talk(None)
        self._update()

    def centre(self):
        """Ignore every held key until it has been released."""
        self._dead.update(self._held, self._page)
        self._held.clear()
        self._set_page({})
        self._update()

    def end_page(self):
        """Ignore every held key of the second page until it has been released."""
        self._dead.update(self._page)
        self._set_page({})

    def _run_out(self):
        """Release the held keys after a time without events from the remote display."""
        if self._held or self._page or self._talk is not None:
            self.centre()
            self._set_talk(None)
            self.ran_out.emit()

    def close(self):
        """Release every key, and close the connection to the X server."""
        self.release()
        self._look_timer.stop()
        self._keys.close()
        if DriveKeys._latest is self:
            DriveKeys._latest = None

    def _look(self):
        """Release the keys that are up although no release event has come."""
        held = self._real & self._in_use()
        down = self._keys.down()
        if not held or down is None:
            self._look_timer.stop()
            return
        for identity in held - down:
            self._let_go(identity)
            # Its release may still come, and must not reach another widget.
            self._dead.add(identity)

    def _in_use(self):
        """Return the identities of the held keys that act."""
        return {*self._held, *self._page, self._talk}

    def _let_go(self, identity):
        """Treat a drive key as released."""
        self._down.discard(identity)
        self._real.discard(identity)
        if identity == self._talk:
            self._set_talk(None)
        self._held.pop(identity, None)
        self._set_page({key: name for key, name in self._page.items() if key != identity})
        self._dead.discard(identity)
        self._update()

    def eventFilter(self, watched, event):  # noqa: N802
        """Consume the keys that drive; pass on all other events."""
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
        """Handle a key event; return whether it is consumed."""
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
        stop = self._single_stop(event)
        if self._typed == _identity(event) or not self._listens(watched, focus, stop is not None):
            return False
        action = self._page_action(event, focus) if event.modifiers() & (
            Qt.AltModifier | Qt.MetaModifier) else stop or self._action(event, focus)
        if action is None:
            return False
        if kind == QEvent.ShortcutOverride:
            event.accept()
        # Of a stop every press counts, also if the release of an earlier one was lost.
        elif self._is_new(event) or stop and not event.isAutoRepeat():
            action()
        return True

    def _single_stop(self, event):
        """Return the action of a press that stops a single robot, or None."""
        if not event.modifiers() & Qt.ShiftModifier or _is_shifted_number_pad(event):
            return None
        if event.key() in _ENTER:
            return self.stop_looked_at_pressed.emit
        digit = _digit(event)
        # No robot has the number 0; with Shift it must not select all, either.
        return None if digit is None else partial(self._stop_number, digit)

    def _stop_number(self, digit):
        """Emit the stop of the robot with a number."""
        if digit:
            self.robot_stop_pressed.emit(digit)

    def _note_life(self):
        """Handle the sign of life of a key or its repeat: earlier releases have arrived by now.

        Of several held keys only the last one repeats.
        """
        if self._real & self._in_use():
            self.limit.renew()
        else:
            self.limit.end()

    def _is_new(self, event):
        """Return whether a press is new, not a repeat."""
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
        """Stop everything; accept the override, so that no shortcut of rqt consumes the key."""
        if kind == QEvent.ShortcutOverride:
            event.accept()
        elif not event.isAutoRepeat():
            # Whatever else is pressed: a redundant stop does no harm.
            self.centre()
            self._stop_key = event.nativeScanCode() if event.spontaneous() else 0
            if not self._stop_timer.isActive():
                # A repeat that Qt reads late looks like a press; its release was ignored.
                self._stop_timer.start()
            self.stop_pressed.emit()
        return True

    def _end_stop(self):
        """Handle the end of holding Shift+Space."""
        if self._stop_timer.isActive():
            self._stop_timer.stop()
            self.stop_let_go.emit()

    def _on_stop_held(self):
        """Emit the signal unless the key is up: its release may be delayed by a slow view."""
        down = self._keys.down()
        if not self._stop_key or down is None or self._stop_key in down:
            self.stop_held.emit()

    def _on_release(self, event):
        """Handle a release wherever it arrives, so that no key is held for ever."""
        identity = _identity(event)
        ours = identity in self._in_use() or identity in self._dead
        if event.isAutoRepeat() or event.nativeScanCode() in (self._keys.down() or ()):
            return ours
        if event.key() in (_SPACE, int(Qt.Key_Shift)):
            self._end_stop()
        elif event.key() == int(Qt.Key_Alt):
            self.end_page()
        self._down.discard(identity)
        if identity == self._typed:
            self._typed = None
        if ours:
            self._let_go(identity)
        return ours

    def _listens(self, watched, focus, stops=False):
        """Return whether keys drive, judged by the widget that receives them.

        :param stops: whether the key stops a robot, as it may with a menu open
        """
        if QApplication.activePopupWidget() is not None and not stops:
            return False
        if _is_text_field(focus) or _is_text_field(watched):
            return False
        in_area, panel = self._place_of(focus)
        if panel is not None:
            return panel is self._panel
        # No panel has the focus: use the panel of this program that had the keyboard last.
        return (in_area or focus.isAncestorOf(self._panel)) and self._latest_one() is self

    def _latest_one(self):
        """Return the instance whose panel had the keyboard last, this one if that is gone."""
        try:
            if DriveKeys._latest.parent() is not None:
                return DriveKeys._latest
        except (AttributeError, RuntimeError):  # none yet, or Qt has deleted it
            pass
        DriveKeys._latest = self
        return self

    @staticmethod
    def _place_of(widget):
        """Return (whether a widget is in a drive area, its panel or None)."""
        in_area = False
        while widget is not None:
            if hasattr(widget, 'drive_keys'):
                return True, widget
            in_area = in_area or bool(widget.property(_AREA))
            widget = getattr(widget, 'drive_owner', None) or widget.parentWidget()
        return in_area, None

    def _note_focus(self, watched):
        """Store the panel that has the keyboard."""
        if isinstance(watched, QWidget) and self._place_of(watched)[1] is self._panel:
            DriveKeys._latest = self

    def _action(self, event, focus):
        """Return the action of a press, None for a key that is not a drive key."""
        if _is_shifted_number_pad(event):
            return None if self._keeps_arrows(focus) else lambda: None
        if event.modifiers() & Qt.ControlModifier:
            return self._action_with_ctrl(event)
        return self._action_alone(event, focus)

    def _action_alone(self, event, focus):
        """Return the action of a press without Ctrl, or None."""
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

    def _page_action(self, event, focus):
        """Return the action of a press with Alt alone, or None."""
        if event.modifiers() & ~Qt.KeypadModifier != Qt.AltModifier:
            return None
        digit, arrow = _digit(event), _PAGE_ARROWS.get(event.key())
        name = str(digit) if digit is not None else arrow
        if name is None or arrow and self._keeps_arrows(focus):
            return None
        return lambda: self._set_page({**self._page, _identity(event): name})

    def _set_page(self, page):
        """Hold keys of the second page: {identity: name}."""
        changed = set(page.values()) != set(self._page.values())
        self._page = page
        if page:
            self._note_life()
        if changed:
            self.page_changed.emit(frozenset(page.values()))

    @staticmethod
    def _keeps_arrows(focus):
        """Return whether a widget needs the arrow keys itself."""
        return isinstance(focus, _ARROW_USERS) or keeps_arrows(focus)

    def _action_with_ctrl(self, event):
        """Return the action of a press with Ctrl, or None."""
        digit = _digit(event)
        return (lambda: self.alone_pressed.emit(digit)) if digit else None

    @staticmethod
    def _tabs_pictures(focus):
        """Return whether Tab moves between the pictures, not between the controls."""
        return bool(focus.property(_AREA))

    def _enter_action(self, focus):
        """Return the action of Return: on the focused widget, or on the robot in view."""
        if isinstance(focus, QAbstractButton):
            return focus.click if focus.isEnabled() else None
        if isinstance(focus, QComboBox):
            return focus.showPopup
        return self.drive_pressed.emit if focus.property(_AREA) else None

    def _set_talk(self, identity):
        """Hold the push-to-talk key, or release it (None)."""
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
        """Emit a changed deflection."""
        held = set(self._held.values())
        deflection = tuple(float(sum(part[axis] for part in held)) for axis in range(3))
        if deflection != self._deflection:
            self._deflection = deflection
            self.moved.emit(*deflection)
