# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drop-down of the mode and the sliders of the speed limits."""
import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent, QWheelEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QLabel

from mhri.base.views import DeviceView
from mhri.driving.gui import mode_combo
from mhri.driving.gui.mode_combo import ModeCombo
from mhri.driving.gui.speed_limits import SpeedLimits

SOURCES = (('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller'), ('voice', 'Voice'))


@pytest.fixture
def combo(operator, monkeypatch):
    # However long this process stands still, a wish is not old.
    monkeypatch.setattr(mode_combo, 'ANSWER_WITHIN_S', 600.0)
    widget = ModeCombo()
    widget.show_mode(SOURCES, 'joy')
    return operator.show(widget)


def choose(combo, row, operator):
    """Choose a row of the list as a person does."""
    combo.showPopup()
    view = combo.view()
    operator.wait_until(view.isVisible)
    operator.click(view.viewport(), view.visualRect(view.model().index(row, 0)).center())
    operator.wait_until(lambda: not view.isVisible())


@pytest.mark.parametrize('sources, mode, text, index', [
    ((), None, 'not known yet', -1),
    (SOURCES, None, 'not known yet', -1),
    (SOURCES, 'ps3joy', 'PS3 Controller', 1),
    (SOURCES, 'pedal', 'pedal', -1),
])
def test_it_shows_the_mode_in_force(operator, sources, mode, text, index):
    combo = ModeCombo()
    combo.show_mode(sources, mode)
    assert (combo.shown_text, combo.currentIndex(), combo.count()) == (text, index, len(sources))


def test_a_choice_is_shown_as_a_wish_until_granted(combo, operator, heard):
    asked = heard(combo.mode_requested)
    choose(combo, 1, operator)
    assert asked == ['ps3joy']
    for _ in range(3):
        combo.show_mode(SOURCES, 'joy')
        assert 'PS3 Controller' in combo.shown_text
        assert combo.currentData() == 'joy'
    combo.show_mode(SOURCES, 'ps3joy')
    assert (combo.shown_text, combo.currentData()) == ('PS3 Controller', 'ps3joy')


def test_one_of_two_pads_is_chosen_by_its_name(combo, operator, heard):
    """The list has both; the choice goes to the node, and the mode is asked for where needed."""
    f710, ps3 = 'Logitech F710', 'PLAYSTATION(R)3 Controller'
    sources = SOURCES[:1] + (('ps3joy', f710),) + SOURCES[2:]
    pads = [DeviceView('ps3joy', f710, '', 'pad', (f710, ps3))]
    modes, devices = heard(combo.mode_requested), []
    combo.device_requested.connect(lambda *names: devices.append(names))
    combo.show_mode(sources, 'joy', pads)
    assert [combo.itemText(row) for row in range(combo.count())] == [
        'Virtual joystick', f710, ps3, 'Voice']
    choose(combo, 2, operator)
    assert devices == [('ps3joy', ps3)] and modes == ['ps3joy']
    assert ps3 in combo.shown_text
    sources = SOURCES[:1] + (('ps3joy', ps3),) + SOURCES[2:]
    combo.show_mode(sources, 'ps3joy', [DeviceView('ps3joy', ps3, '', 'pad', (f710, ps3))])
    assert combo.shown_text == ps3 and combo.currentIndex() == 1
    choose(combo, 2, operator)
    assert devices[1:] == [('ps3joy', f710)] and modes == ['ps3joy']


def scroll(widget):
    """Turn the wheel over a widget."""
    QApplication.sendEvent(widget, QWheelEvent(
        QPointF(5, 5), QPointF(5, 5), QPoint(), QPoint(0, -120), Qt.NoButton, Qt.NoModifier,
        Qt.NoScrollPhase, False))


@pytest.fixture
def limits(operator):
    widget = SpeedLimits()
    widget.resize(430, 90)
    return operator.show(widget)


def test_the_wheel_changes_nothing(combo, limits, heard):
    asked = [heard(combo.mode_requested), heard(limits.limits_requested)]
    for widget in (combo, limits.linear_slider, limits.angular_slider):
        scroll(widget)
    assert asked == [[], []]


def move(slider, x):
    """Move the pointer with the button held."""
    QApplication.sendEvent(slider, QMouseEvent(
        QEvent.MouseMove, QPointF(x, 10), Qt.NoButton, Qt.LeftButton, Qt.NoModifier))


@pytest.mark.parametrize('shown, values, texts', [
    ((0.5, 1.5), (50, 150), ('0.50 m/s', '1.50 rad/s')),
    ((2.0, 0.0), (100, 10), ('2.00 m/s', '0.00 rad/s')),
])
def test_the_sliders_follow_the_limits_in_force(limits, heard, shown, values, texts):
    asked = heard(limits.limits_requested)
    limits.show_limits(shown)
    assert (limits.linear_slider.value(), limits.angular_slider.value()) == values
    assert set(texts) <= {label.text() for label in limits.findChildren(QLabel)}
    assert asked == []


@pytest.mark.parametrize('name, key, expected', [
    ('linear_slider', Qt.Key_Right, (0.55, 1.5)),
    ('linear_slider', Qt.Key_PageUp, (0.7, 1.5)),
    ('angular_slider', Qt.Key_Home, (0.5, 0.1)),
])
def test_keyboard_steps(limits, operator, heard, name, key, expected):
    asked = heard(limits.limits_requested)
    operator.hit(getattr(limits, name), key)
    assert asked == [pytest.approx(expected)]


def test_a_drag_is_told_at_most_twenty_times_a_second_and_at_its_end(limits, operator, heard):
    slider = limits.linear_slider
    asked = heard(limits.limits_requested)
    QTest.mousePress(slider, Qt.LeftButton, Qt.NoModifier, QPoint(20, 10))
    for x in range(20, slider.width() - 5, 3):
        move(slider, x)
    assert len(asked) == 1, 'all of this took less than a twentieth of a second'
    limits.show_limits((0.05, 1.5))
    assert slider.value() > 80, 'nobody takes the slider out of the hand'
    QTest.mouseRelease(slider, Qt.LeftButton, Qt.NoModifier, QPoint(slider.width() - 5, 10))
    assert asked[-1] == (1.0, 1.5)
    asked.clear()
    limits.show_limits((1.0, 1.5))
    QTest.mousePress(slider, Qt.LeftButton, Qt.NoModifier, QPoint(slider.width() // 2, 10))
    operator.wait_until(lambda: len(asked) == 1)
