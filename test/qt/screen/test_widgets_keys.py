# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The keyboard: by place, together, and gone with the focus; stop-all from anywhere."""
import pytest
from python_qt_binding.QtCore import QEvent, Qt, QTimer
from python_qt_binding.QtGui import QKeyEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import (
    QApplication, QLineEdit, QSpinBox, QSplitter, QTextEdit, QWidget)

from mhri.driving.gui.drive_keys import DriveKeys, mark_drive_area
from mhri.screen.gui.screen import ScreenWidget
from mhri.screen.gui.torn_off import TornOff
from mhri.screen.gui.windows import window_class

Q, E, W, A, S, D, UP, LEFT, RIGHT, DOWN, SPACE, ONE, NINE, ZERO, SHIFT = (
    24, 26, 25, 38, 39, 40, 111, 113, 114, 116, 65, 10, 18, 19, 50)

AHEAD, BACK, TO_LEFT, TO_RIGHT, ASIDE_LEFT, ASIDE_RIGHT = (
    (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0))
REST = (0.0, 0.0, 0.0)


@pytest.mark.parametrize('key, scan, stick', [
    (Qt.Key_W, W, AHEAD), (Qt.Key_S, S, BACK), (Qt.Key_A, A, TO_LEFT), (Qt.Key_D, D, TO_RIGHT),
    (Qt.Key_Up, UP, AHEAD), (Qt.Key_Down, DOWN, BACK), (Qt.Key_Left, LEFT, TO_LEFT),
    (Qt.Key_Right, RIGHT, TO_RIGHT), (Qt.Key_Q, Q, ASIDE_LEFT), (Qt.Key_E, E, ASIDE_RIGHT),
    # The same places on a French keyboard and on a Russian one.
    (Qt.Key_Q, A, TO_LEFT), (0x426, W, AHEAD),
    # Letters at other places drive nothing.
    (Qt.Key_W, 52, None),
    # Events made by programs have no place.
    (Qt.Key_W, 0, AHEAD),
])
def test_one_key(panel, operator, heard, key, scan, stick):
    moved = heard(panel.stick_moved)
    operator.press(panel, key, scan)
    assert moved == ([stick] if stick else [])
    operator.release(panel, key, scan)
    assert panel.stick() == REST
    assert moved == ([stick, REST] if stick else [])


@pytest.mark.parametrize('keys, stick', [
    (((Qt.Key_W, W), (Qt.Key_A, A)), (1.0, 1.0, 0.0)),
    (((Qt.Key_W, W), (Qt.Key_Q, Q)), (1.0, 0.0, 1.0)),
    (((Qt.Key_W, W), (Qt.Key_S, S)), REST),
    (((Qt.Key_W, W), (Qt.Key_Up, UP)), (1.0, 0.0, 0.0)),
])
def test_keys_together(panel, operator, keys, stick):
    for key, scan in keys:
        operator.press(panel, key, scan)
    assert panel.stick() == stick
    operator.release(panel, *keys[0])
    operator.release(panel, *keys[1])
    assert panel.stick() == REST


def test_auto_repeat_is_not_a_press_nor_a_release(panel, operator, heard):
    moved = heard(panel.stick_moved)
    operator.press(panel, Qt.Key_W, W, repeat=True)
    assert moved == []
    operator.press(panel, Qt.Key_W, W)
    for _ in range(3):
        operator.release(panel, Qt.Key_W, W, repeat=True)
        operator.press(panel, Qt.Key_W, W, repeat=True)
    assert moved == [AHEAD]


class Keyboard:
    """As a :class:`mhri.driving.gui.key_state.KeyState`: the codes of the keys that are down."""

    remote = ''

    def __init__(self):
        self.codes = set()

    def down(self):
        return frozenset(self.codes)

    def close(self):
        self.codes.clear()


@pytest.fixture
def area(operator, application):
    """A window with drive keys of its own, which read a :class:`Keyboard`."""
    made = QWidget()
    mark_drive_area(made)
    made.keyboard = Keyboard()
    made.keys = DriveKeys(made, made.keyboard)
    application.installEventFilter(made.keys)
    yield operator.show(made)
    application.removeEventFilter(made.keys)


def test_a_repeat_that_is_not_marked_as_one_is_known(area, operator, heard):
    """Qt takes some repeats of a held key for a release and a press (X11, Qt 5)."""
    area.keyboard.codes = {W, ONE}
    moved, switched = heard(area.keys.moved), heard(area.keys.robot_pressed)
    for key, code in ((Qt.Key_W, W), (Qt.Key_1, ONE)):
        operator.press(area, key, code)
        for _ in range(5):
            operator.release(area, key, code)
            operator.press(area, key, code)
    assert (moved, switched) == ([AHEAD], [1])
    operator.press(area, Qt.Key_Space, SPACE)
    area.keys.centre()
    operator.release(area, Qt.Key_W, W)
    operator.press(area, Qt.Key_W, W)
    assert area.keys.deflection() == REST, 'a dead key stays dead while it is held'
    area.keyboard.codes.clear()
    operator.release(area, Qt.Key_W, W)
    operator.press(area, Qt.Key_W, W)
    assert area.keys.deflection() == AHEAD
    operator.release(area, Qt.Key_W, W)
    assert area.keys.deflection() == REST


def test_a_key_that_is_held_while_the_window_is_left_has_to_be_pressed_again(area, operator):
    area.keyboard.codes = {W}
    operator.press(area, Qt.Key_W, W)
    QApplication.sendEvent(area, QEvent(QEvent.WindowDeactivate))
    QApplication.sendEvent(area, QEvent(QEvent.WindowActivate))
    operator.press(area, Qt.Key_W, W)
    assert area.keys.deflection() == REST
    # Let go while somebody else has the keyboard.
    QApplication.sendEvent(area, QEvent(QEvent.WindowDeactivate))
    area.keyboard.codes.clear()
    QApplication.sendEvent(area, QEvent(QEvent.WindowActivate))
    operator.press(area, Qt.Key_W, W)
    assert area.keys.deflection() == AHEAD


def test_a_release_counts_even_if_a_modifier_changed_the_key(panel, operator):
    operator.press(panel, Qt.Key_Up, 80, Qt.KeypadModifier)
    assert panel.stick() == AHEAD
    operator.release(panel, Qt.Key_8, 80, Qt.KeypadModifier)
    assert panel.stick() == REST


@pytest.mark.parametrize('key, scan, more', [
    # Num Lock on: X11 reports what is below the digit; off: the digit.
    (Qt.Key_Left, 83, Qt.NoModifier), (Qt.Key_4, 83, Qt.NoModifier),
    (Qt.Key_Down, 0, Qt.NoModifier), (Qt.Key_0, 90, Qt.ControlModifier)])
def test_the_number_pad_with_shift_does_nothing(panel, operator, heard, key, scan, more):
    moved, switched = heard(panel.stick_moved), [heard(signal) for signal in (
        panel.drive_keys.robot_pressed, panel.drive_keys.all_pressed,
        panel.drive_keys.alone_pressed)]
    modifiers = Qt.KeypadModifier | Qt.ShiftModifier | more
    operator.hit(panel, key, scan, modifiers)
    # Shift is let go first: what repeats then is a digit, and no press.
    operator.press(panel, key, scan, modifiers)
    operator.press(panel, Qt.Key_4, scan, Qt.KeypadModifier, repeat=True)
    assert moved == [] and switched == [[], [], []]


@pytest.mark.parametrize('modifier', [Qt.ControlModifier, Qt.AltModifier, Qt.MetaModifier])
def test_with_a_command_modifier_nothing_drives(panel, operator, heard, modifier):
    moved, selected = heard(panel.stick_moved), heard(panel.robot_list.selection_requested)
    operator.hit(panel, Qt.Key_W, W, modifier)
    operator.hit(panel, Qt.Key_1, ONE, modifier)
    assert moved == [] and selected == []


@pytest.mark.parametrize('kind', [QEvent.WindowDeactivate, QEvent.WindowBlocked])
def test_losing_the_keyboard_releases(panel, operator, heard, kind):
    operator.press(panel, Qt.Key_W, W)
    moved = heard(panel.stick_moved)
    QApplication.sendEvent(panel, QEvent(kind))
    assert moved == [REST]
    operator.press(panel, Qt.Key_W, W, repeat=True)
    assert panel.stick() == REST, 'still down, but it has to be pressed again'


def test_space_centres_and_held_keys_are_dead_until_released(panel, operator, drag):
    drag(panel.joystick, 0.0, 0.9)
    operator.hit(panel, Qt.Key_Space, SPACE)
    assert panel.stick() == REST and not panel.joystick.dragging
    operator.press(panel, Qt.Key_W, W)
    operator.hit(panel, Qt.Key_Space, SPACE)
    assert panel.stick() == REST
    operator.press(panel, Qt.Key_A, A)
    assert panel.stick() == TO_LEFT, 'another key is a new wish'
    operator.release(panel, Qt.Key_W, W)
    operator.press(panel, Qt.Key_W, W)
    assert panel.stick() == (1.0, 1.0, 0.0)


def test_the_pointer_wins_over_the_keys_while_it_holds_the_knob(panel, operator, drag):
    operator.press(panel, Qt.Key_W, W)
    drag(panel.joystick, -0.9, 0.0)
    forward, turn, _ = panel.stick()
    assert forward == 0.0 and turn > 0.8
    panel.joystick.centre()
    assert panel.stick() == AHEAD


@pytest.mark.parametrize('name', ['look_button', 'stop_button', 'check_bot2'])
def test_return_works_a_focused_button_and_space_never_does(panel, operator, heard, four_robots,
                                                            name):
    panel.show_view(four_robots)
    signals = {'look_button': panel.look_requested, 'stop_button': panel.stop_requested,
               'check_bot2': panel.robot_list.selection_requested}
    button = panel.findChild(QWidget, name)
    button.setFocus(Qt.TabFocusReason)
    said = heard(signals[name])
    operator.hit(button, Qt.Key_Space, SPACE)
    operator.settle()
    assert said == []
    operator.hit(button, Qt.Key_Return, 36)
    assert len(said) == 1


@pytest.mark.parametrize('make', [lambda panel: panel.name_edit, QSpinBox, QTextEdit])
def test_typing_is_typing_but_for_stop_all(panel, operator, heard, four_robots, make):
    panel.show_view(four_robots)
    field = make(panel)
    field.show()
    field.setFocus()
    operator.wait_until(field.hasFocus)
    moved, selected = heard(panel.stick_moved), heard(panel.robot_list.selection_requested)
    stopped = heard(panel.stop_requested)
    single = heard(panel.stop_robot_requested)
    for key, scan in ((Qt.Key_W, W), (Qt.Key_Up, UP), (Qt.Key_1, ONE), (Qt.Key_Space, SPACE)):
        operator.hit(field, key, scan)
    shift(operator, field, Qt.Key_Exclam, ONE)
    assert moved == [] and selected == [] and stopped == [] and single == []
    operator.hit(field, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    assert stopped == [()]


def test_return_in_the_name_field_drives_nobody(panel, operator, heard, four_robots):
    """The field leaves Return to what is around it, and has lost the focus to it by then."""
    panel.show_view(four_robots)
    panel.stage.look_at('bot2')
    added, driven = heard(panel.add_requested), heard(panel.drive_requested)
    panel.add_requested.connect(lambda _: panel.clear_name())
    panel.name_edit.setFocus()
    operator.wait_until(panel.name_edit.hasFocus)
    panel.name_edit.setText('bot9')
    QTest.keyClick(panel.name_edit, Qt.Key_Return)
    assert added == ['bot9'] and driven == [] and not panel.name_edit.hasFocus()
    QTest.keyClick(panel, Qt.Key_Return)
    assert driven == ['bot2'], 'the next press is meant'


@pytest.mark.parametrize('name, arrows_stay', [
    ('linear_slider', True), ('mode_combo', True), ('robot_list', True), ('look_button', False),
    ('check_bot1', False)])
def test_who_keeps_the_arrows_after_tab(panel, operator, four_robots, name, arrows_stay):
    panel.show_view(four_robots)
    widget = panel.findChild(QWidget, name)
    assert not widget.focusPolicy() & Qt.ClickFocus, 'a click never takes the drive keys away'
    widget.setFocus(Qt.TabFocusReason)
    operator.wait_until(widget.hasFocus)
    operator.press(widget, Qt.Key_Up, UP)
    assert panel.stick() == (REST if arrows_stay else AHEAD)
    operator.release(widget, Qt.Key_Up, UP)
    operator.press(widget, Qt.Key_W, W)
    assert panel.stick() == AHEAD, 'W A S D drive even then'


@pytest.mark.parametrize('key, scan, expected', [
    (Qt.Key_1, ONE, []),
    (Qt.Key_4, 13, ['bot1', 'bot4']),
    (Qt.Key_Ampersand, ONE, []),
    (Qt.Key_3, 0, ['bot1', 'bot3']),
    (Qt.Key_0, ZERO, ['bot1', 'bot2', 'bot3', 'bot4']),
    (Qt.Key_9, NINE, None),
])
def test_digits_are_the_switches(panel, operator, heard, four_robots, key, scan, expected):
    panel.show_view(four_robots)
    selected = heard(panel.robot_list.selection_requested)
    operator.hit(panel, key, scan)
    assert selected == ([] if expected is None else [expected])


def shift(operator, widget, key, scan=0, more=Qt.NoModifier):
    """Press a key with Shift, and let it go."""
    operator.hit(widget, key, scan, Qt.ShiftModifier | more)


@pytest.mark.parametrize('key, scan, more, expected', [
    (Qt.Key_Exclam, ONE, Qt.NoModifier, ['bot1']),
    # The same place on a French keyboard; a robot that is not selected, one that is gone.
    (Qt.Key_1, ONE, Qt.NoModifier, ['bot1']),
    (Qt.Key_At, ONE + 1, Qt.NoModifier, ['bot2']),
    (Qt.Key_Dollar, ONE + 3, Qt.NoModifier, ['bot4']),
    # Never to drive it alone, nor to select all.
    (Qt.Key_Exclam, ONE, Qt.ControlModifier, ['bot1']),
    (Qt.Key_ParenRight, ZERO, Qt.NoModifier, []), (Qt.Key_ParenLeft, NINE, Qt.NoModifier, []),
    # Events made by programs have no place.
    (Qt.Key_3, 0, Qt.NoModifier, ['bot3']),
    # The number pad, with Num Lock and without.
    (Qt.Key_End, 87, Qt.NoModifier, []), (Qt.Key_1, 87, Qt.KeypadModifier, []),
    (Qt.Key_1, 0, Qt.KeypadModifier, []), (Qt.Key_Enter, 104, Qt.KeypadModifier, []),
    (Qt.Key_Return, 36, Qt.NoModifier, ['bot2']),
])
def test_shift_stops_one_robot_and_selects_none(panel, operator, heard, four_robots, key, scan,
                                                more, expected):
    panel.show_view(four_robots)
    panel.look_at('bot2')
    stopped, *others = (heard(signal) for signal in (
        panel.stop_robot_requested, panel.robot_list.selection_requested, panel.drive_requested,
        panel.stop_requested))
    operator.press(panel, Qt.Key_W, W)
    shift(operator, panel, key, scan, more)
    assert stopped == expected and others == [[], [], []]
    assert panel.stick() == AHEAD, 'the others go on'


def test_stopping_one_robot_is_no_toggle_and_no_press_is_lost(panel, operator, heard, four_robots):
    panel.show_view(four_robots)
    stopped, selected = heard(panel.stop_robot_requested), heard(
        panel.robot_list.selection_requested)
    for _ in range(2):
        # Its release went elsewhere.
        operator.press(panel, Qt.Key_Exclam, ONE, Qt.ShiftModifier)
        operator.press(panel, Qt.Key_Exclam, ONE, Qt.ShiftModifier, repeat=True)
    assert stopped == ['bot1', 'bot1']
    # Shift is let go first: what Qt takes for a press then is a repeat of the digit.
    operator.press(panel, Qt.Key_1, ONE)
    assert selected == []


@pytest.mark.parametrize('name', ['look_button', 'check_bot2', 'robot_list'])
def test_shift_and_return_stop_wherever_the_focus_is(panel, operator, heard, four_robots, name):
    panel.show_view(four_robots)
    panel.look_at('bot3')
    widget = panel.findChild(QWidget, name)
    widget.setFocus(Qt.TabFocusReason)
    stopped, looked = heard(panel.stop_robot_requested), heard(panel.look_requested)
    shift(operator, widget, Qt.Key_Return, 36)
    assert stopped == ['bot3'] and looked == []


def test_without_a_robot_in_view_shift_and_return_stop_those_shown_large(
        panel, operator, heard, four_robots, ui_dir):
    panel.show_view(four_robots)
    panel.stage.show_tiles({name: window_class('turtlebot')(ui_dir, name, 'TurtleBot2', panel.stage)
                            for name in ('bot1', 'bot2')})
    panel.stage.show_driven(['bot1', 'bot2'])
    stopped = heard(panel.stop_robot_requested)
    shift(operator, panel.stage, Qt.Key_Return, 36)
    assert stopped == list(panel.stage.large) == ['bot1', 'bot2']


def test_in_an_open_list_keys_choose_but_stop_all_stops(panel, operator, heard, four_robots):
    panel.show_view(four_robots)
    panel.mode_combo.showPopup()
    popup = QApplication.activePopupWidget()
    moved, stopped = heard(panel.stick_moved), heard(panel.stop_requested)
    operator.hit(panel.mode_combo.view(), Qt.Key_W, W)
    operator.hit(panel.mode_combo.view(), Qt.Key_Space, SPACE, Qt.ShiftModifier)
    single = heard(panel.stop_robot_requested)
    shift(operator, panel.mode_combo.view(), Qt.Key_Exclam, ONE)
    assert popup is not None and moved == [] and stopped == [()] and single == ['bot1']
    panel.mode_combo.hidePopup()


def test_a_foreign_window_keeps_its_keys_but_not_stop_all(panel, operator, heard):
    foreign = operator.show(QLineEdit())
    moved, stopped = heard(panel.stick_moved), heard(panel.stop_requested)
    other = QWidget(foreign)
    operator.hit(other, Qt.Key_W, W)
    operator.hit(foreign, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    assert moved == [] and stopped == [()]


def test_stop_all_centres_the_stick_and_repeats_are_one(panel, operator, heard):
    operator.press(panel, Qt.Key_W, W)
    stopped = heard(panel.stop_requested)
    operator.press(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    operator.press(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier, repeat=True)
    assert stopped == [()] and panel.stick() == REST


@pytest.mark.parametrize('key, scan, modifiers, ours', [
    (Qt.Key_W, W, Qt.NoModifier, True),
    (Qt.Key_Space, SPACE, Qt.ShiftModifier, True),
    (Qt.Key_Exclam, ONE, Qt.ShiftModifier, True),
    (Qt.Key_W, W, Qt.ControlModifier, False),
    (Qt.Key_B, 56, Qt.NoModifier, False),
])
def test_no_shortcut_of_the_host_takes_a_key_of_ours(panel, key, scan, modifiers, ours):
    event = QKeyEvent(QEvent.ShortcutOverride, int(key), modifiers, scan, 0, 0)
    event.ignore()
    QApplication.sendEvent(panel, event)
    assert event.isAccepted() == ours
    assert panel.stick() == REST, 'an override is a question, not a press'


@pytest.fixture
def cut(monkeypatch, request, heard):
    """What cuts the power of the motors, where Shift+Space has to be held for 0.2 s alone."""
    monkeypatch.setattr('mhri.driving.gui.drive_keys.CUT_AFTER_S', 0.2)
    return heard(request.getfixturevalue('panel').stop_bar.power_cut_requested)


def cuts_nothing(operator, cut):
    """Fail if the power is cut within twice the time for which the keys have to be held."""
    waited = []
    QTimer.singleShot(400, Qt.PreciseTimer, lambda: waited.append(True))
    operator.wait_until(lambda: waited)
    assert cut == []


def test_shift_and_space_held_cut_the_power_once(cut, panel, operator, heard):
    stopped = heard(panel.stop_requested)
    operator.press(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    for _ in range(3):
        operator.release(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier, repeat=True)
        operator.press(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier, repeat=True)
    operator.wait_until(lambda: cut)
    assert stopped == [()] and cut == [()]


@pytest.mark.parametrize('key, scan, modifiers', [
    (Qt.Key_Space, SPACE, Qt.ShiftModifier), (Qt.Key_Shift, SHIFT, Qt.NoModifier)])
def test_shift_or_space_let_go_before_cuts_nothing(cut, panel, operator, key, scan, modifiers):
    operator.press(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    operator.release(panel, key, scan, modifiers)
    cuts_nothing(operator, cut)


def test_another_window_that_takes_the_keys_cuts_nothing(cut, panel, operator):
    operator.press(panel, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    QApplication.sendEvent(panel, QEvent(QEvent.WindowDeactivate))
    cuts_nothing(operator, cut)


def test_of_two_panels_keys_act_for_the_one_that_has_the_keyboard(
        application, operator, ui_dir, heard):
    """As in one rqt: the newest of two filters had every key, whoever had the focus."""
    window = QSplitter()
    window.resize(1400, 800)
    operator.show(window)
    panels = [ScreenWidget(ui_dir) for _ in range(2)]
    tiles = []
    for panel in panels:
        window.addWidget(panel)
        application.installEventFilter(panel.drive_keys)
        tile = window_class('turtlebot')(ui_dir, 'bot1', 'TurtleBot2', panel.stage)
        panel.stage.show_tiles({'bot1': tile})
        tiles.append(tile)
    operator.settle()
    moved, stopped, switched = ([heard(signal(panel)) for panel in panels] for signal in (
        lambda panel: panel.stick_moved, lambda panel: panel.stop_requested,
        lambda panel: panel.drive_keys.robot_pressed))
    # Before any of them had the keyboard: the first, and never both.
    QTest.keyClick(window, Qt.Key_Left)
    assert moved == [[TO_LEFT, REST], []]
    for turn in (0, 1, 0):
        panels[turn].stage.setFocus()
        operator.wait_until(panels[turn].stage.hasFocus)
        for part in (*moved, *stopped, *switched):
            del part[:]
        operator.hit(panels[turn].stage, Qt.Key_W, W)
        operator.hit(panels[turn].stage, Qt.Key_1, ONE)
        assert moved[turn] == [AHEAD, REST] and switched[turn] == [1]
        assert moved[1 - turn] == [] and switched[1 - turn] == []
        # Where nobody has it, the one that had it last.
        operator.hit(window, Qt.Key_Left, LEFT)
        assert moved[turn][2:] == [TO_LEFT, REST] and moved[1 - turn] == []
        operator.hit(panels[turn].stage, Qt.Key_Space, SPACE, Qt.ShiftModifier)
        assert stopped[0] + stopped[1]
    torn = TornOff(tiles[0])
    torn.show()
    del moved[0][:]
    operator.hit(torn, Qt.Key_W, W)
    assert moved == [[AHEAD, REST], []]
    for panel in panels:
        application.removeEventFilter(panel.drive_keys)
        panel.drive_keys.close()
