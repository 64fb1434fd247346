# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The virtual joystick: both axes at once, and back to neutral in every way there is."""
import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QFocusEvent, QMouseEvent, QPalette
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.driving.gui.virtual_joystick import deflection_of, VirtualJoystick


@pytest.fixture
def joystick(operator):
    widget = VirtualJoystick()
    widget.resize(300, 300)
    return operator.show(widget)


@pytest.mark.parametrize('across, along, forward, turn', [
    (0.0, 0.0, 0.0, 0.0),
    (0.05, 0.05, 0.0, 0.0),
    (0.0, 1.0, 1.0, 0.0),
    (0.0, -1.0, -1.0, 0.0),
    (-1.0, 0.0, 0.0, 1.0),
    (1.0, 0.0, 0.0, -1.0),
    (0.03, 0.9, 0.884, 0.0),
    (-3.0, 3.0, 0.688, 0.688),
    (0.0, 9.0, 1.0, 0.0),
])
def test_deflection(across, along, forward, turn):
    assert deflection_of(across, along) == pytest.approx((forward, turn), abs=0.002)


def test_deflection_grows_without_a_step():
    values = [deflection_of(0.0, step / 1000.0)[0] for step in range(1001)]
    assert values == sorted(values)
    assert max(b - a for a, b in zip(values, values[1:])) < 0.002


def test_its_pad_is_filled_while_it_drives(joystick):
    """It lies over pictures: unfilled, it could not be told from what is behind it."""
    middle = joystick.pad().center().toPoint()
    inside = middle + QPoint(int(0.5 * joystick.travel()), int(0.2 * joystick.travel()))

    def colour():
        return joystick.grab().toImage().pixelColor(inside)
    base = joystick.palette().color(QPalette.Base)
    assert colour() == base
    joystick.show_active(False)
    assert colour() != base


@pytest.mark.parametrize('across, along, forward_sign, turn_sign', [
    (-0.5, 0.5, 1, 1), (0.5, -0.5, -1, -1)])
def test_a_drag_moves_both_axes_at_once(joystick, drag, heard, across, along, forward_sign,
                                        turn_sign):
    moved = heard(joystick.moved)
    drag(joystick, across, along)
    assert joystick.dragging
    forward, turn, sideways = joystick.deflection()
    assert moved[-1] == (forward, turn, sideways) and sideways == 0.0
    assert forward * forward_sign > 0.3 and turn * turn_sign > 0.3
    assert abs(forward) <= 1.0 and abs(turn) <= 1.0


def _mouse_up(joystick, window):
    QTest.mouseRelease(joystick, Qt.LeftButton)


def _lost_release(joystick, window):
    pos = QPointF(200, 60)
    QApplication.sendEvent(joystick, QMouseEvent(
        QEvent.MouseMove, pos, Qt.NoButton, Qt.NoButton, Qt.NoModifier))


def _other_window(joystick, window):
    window.show()
    window.activateWindow()


WAYS = {
    'release': _mouse_up,
    'a move without a button': _lost_release,
    'another window': _other_window,
    'focus out': lambda joystick, _: QApplication.sendEvent(
        joystick, QFocusEvent(QEvent.FocusOut)),
    'blocked by a dialog': lambda joystick, _: QApplication.sendEvent(
        joystick, QEvent(QEvent.WindowBlocked)),
    'grab lost': lambda joystick, _: QApplication.sendEvent(
        joystick, QEvent(QEvent.UngrabMouse)),
    'hidden': lambda joystick, _: joystick.hide(),
    'disabled': lambda joystick, _: joystick.setEnabled(False),
    'centred by the presenter': lambda joystick, _: joystick.centre(),
}


@pytest.mark.parametrize('way', sorted(WAYS))
def test_springs_back(joystick, operator, drag, heard, way):
    other = QWidget()
    drag(joystick, -0.5, 0.5)
    moved = heard(joystick.moved)
    WAYS[way](joystick, other)
    operator.wait_until(lambda: not joystick.dragging)
    assert joystick.deflection() == (0.0, 0.0, 0.0)
    assert moved == [(0.0, 0.0, 0.0)], 'neutral is said, and said once'
    other.close()


def test_after_centring_the_knob_has_to_be_taken_again(joystick, drag, heard):
    drag(joystick, -0.5, 0.5)
    joystick.centre()
    moved = heard(joystick.moved)
    drag(joystick, 0.5, 0.5, press=False)
    assert moved == [] and not joystick.dragging


def test_other_buttons_do_not_take_the_knob(joystick, heard):
    moved = heard(joystick.moved)
    QTest.mousePress(joystick, Qt.RightButton, Qt.NoModifier, QPoint(60, 60))
    assert moved == [] and not joystick.dragging


def test_a_finger_drives_and_letting_go_centres(joystick, heard, touch):
    moved = heard(joystick.moved)
    touch(joystick, QEvent.TouchBegin, Qt.TouchPointPressed, 150, 150)
    touch(joystick, QEvent.TouchUpdate, Qt.TouchPointMoved, 150, 20)
    assert moved[-1] == (1.0, 0.0, 0.0)
    touch(joystick, QEvent.TouchUpdate, Qt.TouchPointMoved, 20, 150, identity=2)
    assert moved[-1] == (1.0, 0.0, 0.0), 'a second finger is not the stick'
    touch(joystick, QEvent.TouchEnd, Qt.TouchPointReleased, 150, 20)
    assert moved[-1] == (0.0, 0.0, 0.0)


def test_a_cancelled_touch_centres(joystick, heard, touch):
    moved = heard(joystick.moved)
    touch(joystick, QEvent.TouchBegin, Qt.TouchPointPressed, 150, 40)
    QApplication.sendEvent(joystick, QEvent(QEvent.TouchCancel))
    assert moved[-1] == (0.0, 0.0, 0.0)


def test_a_press_on_the_names_above_the_pad_moves_nothing(joystick, heard, touch):
    joystick.show_names(('bot1', 'bot2'))
    moved = heard(joystick.moved)
    QTest.mousePress(joystick, Qt.LeftButton, Qt.NoModifier, QPoint(150, 8))
    assert moved == [] and not joystick.dragging
    touch(joystick, QEvent.TouchBegin, Qt.TouchPointPressed, 150, 8)
    assert moved == [] and not joystick.dragging


def test_inactive_it_still_moves(joystick, drag, heard):
    joystick.show_active(False)
    moved = heard(joystick.moved)
    drag(joystick, 0.0, 0.9)
    assert moved[-1][0] > 0.8


def test_its_button_gives_left_and_right_another_meaning(joystick, drag, heard):
    assert not joystick.sideways_button.isVisible()
    joystick.offer_sideways(True)
    drag(joystick, -0.9, 0.5)
    moved = heard(joystick.moved)
    QTest.mouseClick(joystick.sideways_button, Qt.LeftButton)
    assert moved == [(0.0, 0.0, 0.0)], 'what is held is let go'
    drag(joystick, -0.9, 0.0)
    assert moved[-1][:2] == (0.0, 0.0) and moved[-1][2] > 0.8
    joystick.centre()
    joystick.offer_sideways(True)
    assert joystick.sideways_button.isChecked()
    drag(joystick, 0.9, 0.0)
    joystick.offer_sideways(False)
    assert moved[-1] == (0.0, 0.0, 0.0) and not joystick.sideways_button.isVisible()
    drag(joystick, -0.9, 0.0)
    assert moved[-1][1] > 0.8 and moved[-1][2] == 0.0
