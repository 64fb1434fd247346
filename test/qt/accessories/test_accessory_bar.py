# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories in the tile: real clicks and drags, states as reported, and every way to let go."""

import pytest
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton, QApplication, QMenu, QWidget

from mhri.accessories.gui.held import AxisPad
from mhri.accessories.presenters.accessory_presenter import AccessoryPresenter
from support import scenes
from support.tools import robot, screen_of, specs

SPECS = specs()
STATES = {'lamp': 'on', 'arm': 'rest', 'head': (0.75, 0.0)}


class Desk:
    """A screen with a robot that has an accessory of every kind, and what it asked for."""

    def __init__(self, scene, stands='', **states):
        self.scene, self.sent, self.notes = scene, [], []
        self.part = AccessoryPresenter(
            scene.screen, lambda *act: self.sent.append(act), scene.tiles,
            lambda *news: self.notes.append(news[0]))
        self.show(stands, **{**STATES, **states})
        scene.show()
        self.settle()

    def show(self, stands='', **states):
        """Show what the drive says."""
        bots = [robot(SPECS, name, stands, **states) for name in self.scene.tiles]
        self.view = screen_of(*bots)
        self.settle()

    def settle(self):
        """Show the view until the tile is laid out."""
        for _ in range(3):
            self.part.show_view(self.view)
            self.scene.application.processEvents()

    @property
    def bar(self):
        """The bar of the large tile."""
        return self.scene.tiles['bot1'].bar

    def buttons(self, key):
        """Return the visible buttons of an accessory."""
        return [one for one in self.bar.findChildren(QAbstractButton, 'accessory_' + key)
                if one.isVisible()]

    def pad(self, label):
        """Return the pad of an axis."""
        return next(pad for pad in self.bar.findChildren(AxisPad)
                    if pad.accessibleName() == label and pad.isVisible())


@pytest.fixture
def desk(application, operator, ui_dir):
    made = []

    def make(size=scenes.LARGE, count=1, **more):
        made.append(Desk(scenes.Scene(application, ui_dir, size, count), **more))
        return made[-1]
    yield make
    for one in made:
        one.part.close()


def choose(operator, text):
    """Click a row of the menu that opens."""
    operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
    menu = QApplication.activePopupWidget()
    action = next(action for action in menu.actions() if action.text() == text)
    QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier, menu.actionGeometry(action).center())


def test_a_click_acts_once_on_the_robot_of_the_tile(desk, operator):
    found = desk()
    for key in ('horn', 'siren', 'gripper'):
        for button in found.buttons(key):
            operator.click(button)
    assert found.sent == [(('bot1',), *act) for act in (
        ('horn', '', ()), ('siren', 'on', ()), ('siren', 'off', ()), ('gripper', 'open', ()),
        ('gripper', 'close', ()))]
    assert set(found.notes) == {'accessory.used'}


@pytest.mark.parametrize('state, after', [('on', 'off'), ('off', 'on')])
def test_a_switch_shows_what_is_reported_not_what_was_clicked(desk, operator, state, after):
    found = desk(lamp=state)
    button, = found.buttons('lamp')
    assert button.isChecked() == (state == 'on')
    operator.click(button)
    assert found.sent == [(('bot1',), 'lamp', after, ())]
    assert button.isChecked() == (state == 'on')
    found.show(lamp=after)
    assert button.isChecked() == (after == 'on')


def test_a_switch_that_has_not_reported_asks_which(desk, operator):
    found = desk(lamp=None)
    button, = found.buttons('lamp')
    assert not button.isChecked()
    operator.click(button)
    assert found.sent == []
    choose(operator, 'off')
    assert found.sent == [(('bot1',), 'lamp', 'off', ())]


def _mouse_up(widget, found):
    QTest.mouseRelease(widget, Qt.LeftButton)


def _other_robot(widget, found):
    found.view = screen_of()
    found.settle()


WAYS = {
    'release': _mouse_up,
    'the window loses the keyboard': lambda widget, _: QApplication.sendEvent(
        widget, QEvent(QEvent.WindowDeactivate)),
    'grab lost': lambda widget, _: QApplication.sendEvent(widget, QEvent(QEvent.UngrabMouse)),
    'a dialog': lambda widget, _: QApplication.sendEvent(widget, QEvent(QEvent.WindowBlocked)),
    'the tile becomes small': lambda _, found: found.scene.tiles['bot1'].show_large(False),
    'the tile is hidden': lambda _, found: found.scene.tiles['bot1'].hide(),
    'the robot is removed': _other_robot,
    'a stop': lambda _, found: found.show('stopped', **STATES),
    'the screen closes': lambda _, found: found.part.close(),
}


@pytest.mark.parametrize('way', sorted(WAYS))
@pytest.mark.parametrize('key, value', [('flipper', (1.0,)), ('head', (0.0, 1.0))])
def test_what_is_held_is_repeated_until_it_is_released(desk, operator, drag, way, key, value):
    found = desk()
    if key == 'flipper':
        widget = found.buttons(key)[-1]
        QTest.mousePress(widget, Qt.LeftButton)
    else:
        widget = found.pad(key)
        drag(widget, 0.0, 1.0)
    held, at_rest = (('bot1',), key, '', value), (('bot1',), key, '', (0.0,) * len(value))
    # A process that stands still for long releases it by itself.
    operator.wait_until(lambda: found.sent.count(held) > 2 or at_rest in found.sent)
    assert found.sent[0] in (held, (('bot1',), key, '', pytest.approx(value)))
    WAYS[way](widget, found)
    operator.wait_until(lambda: at_rest in found.sent)
    assert found.sent[-1] == at_rest and found.sent.count(at_rest) == 1


def test_a_disabled_one_says_why(desk, operator):
    found = desk(stands='stopped')
    for key in ('lamp', 'flipper', 'arm'):
        button = found.buttons(key)[0]
        assert not button.isEnabled() and button.toolTip()
        QTest.mouseClick(button, Qt.LeftButton)
    assert found.sent == [] and found.notes == ['accessory.refused'] * 3
    assert found.scene.screen.look_label.text()


def test_an_answer_of_the_drive_to_what_was_used_is_said_once(desk, operator):
    found = desk()
    found.show(stands='not delivered')
    assert found.notes == [], 'nothing was used'
    found.show()
    operator.click(found.buttons('horn')[0])
    found.show(stands='stopped')
    assert found.notes == ['accessory.used'], 'a stop is no answer'
    found.show(stands='not delivered')
    assert found.notes == ['accessory.used', 'accessory.refused']
    assert 'not delivered' in found.scene.screen.look_label.text()


def test_a_replay_shows_states_and_acts_on_nothing(desk, operator):
    found = desk()
    found.part.disable()
    found.settle()
    lamp, = found.buttons('lamp')
    assert lamp.isChecked() and not lamp.isEnabled()
    operator.click(lamp)
    assert found.sent == []


@pytest.mark.parametrize('size', [scenes.TINY, scenes.SMALL, scenes.LARGE, (3840, 2160)])
@pytest.mark.parametrize('count', [1, 3])
def test_it_covers_neither_stop_nor_stick_and_misses_nothing(desk, size, count):
    found = desk(size, count)
    screen, bar = found.scene.screen, found.bar
    assert bar.isVisible()
    place = scenes.place_in(screen, bar)
    for other in (screen.stop_bar, screen.joystick, found.scene.tiles['bot1'].header,
                  found.scene.tiles['bot1'].robot_stop):
        assert other.isVisible() and not place.intersects(scenes.place_in(screen, other))
    kept = [one for one in bar.children() if isinstance(one, QWidget) and one.isVisible()]
    assert all(bar.rect().contains(one.geometry()) for one in kept)
    all_of_them = [one for key in SPECS for one in bar.findChildren(QWidget, 'accessory_' + key)]
    more = bar.findChild(QAbstractButton, 'accessories_more').isVisible()
    assert more or all(one.isVisible() for one in all_of_them)


def test_a_menu_has_those_of_a_small_tile(desk, operator):
    found = desk(scenes.SMALL, 3)
    small = next(name for name, tile in found.scene.tiles.items() if not tile.header.large)
    assert not found.scene.tiles[small].bar.isVisible()
    found.scene.screen.robot_menu.show_robots(found.view.robots)
    text, act = next(row for row in found.scene.screen.robot_menu.rows(small)
                     if row and row[0].startswith('Accessories'))
    act()
    operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
    menu = QApplication.activePopupWidget()
    assert isinstance(menu, QMenu) and len(menu.actions()) == len(SPECS) - 1
    choose(operator, next(action.text() for action in menu.actions() if 'horn' in action.text()))
    assert found.sent == [((small,), 'horn', '', ())]


def test_the_second_press_of_a_click_on_another_robot_is_none(desk, operator):
    """The first one may bring a button under the pointer."""
    found = desk(scenes.LARGE, 3)
    button, = found.buttons('horn')
    place = button.mapTo(found.scene.screen, button.rect().center())
    tile = found.scene.tiles['bot2']
    for widget in (tile, button):
        QApplication.sendEvent(widget, QMouseEvent(
            QEvent.MouseButtonPress, QPointF(1, 1), QPointF(place),
            QPointF(found.scene.screen.mapToGlobal(place)), Qt.LeftButton, Qt.LeftButton,
            Qt.NoModifier))
    assert not button.isDown()


ALT = Qt.AltModifier
# The places of the digits on a keyboard: evdev key code + 8.
PLACES = {str(digit): 9 + digit for digit in range(1, 10)}


@pytest.fixture
def keys(desk, application, operator):
    """A desk with the keyboard, whose robot is in view."""
    found = desk()
    screen = found.scene.screen
    application.installEventFilter(screen.drive_keys)
    screen.stage.setFocus()
    yield found
    application.removeEventFilter(screen.drive_keys)


def test_keys_of_the_second_page_use_the_robot_in_view(keys, operator):
    stage = keys.scene.screen.stage
    for digit in ('1', '3', '5'):
        operator.hit(stage, Qt.Key_0 + int(digit), PLACES[digit], ALT)
    # The next choice, on all selected robots, as its row says team.
    operator.hit(stage, Qt.Key_7, PLACES['7'], ALT)
    assert keys.sent == [
        (('bot1',), 'lamp', 'off', ()), (('bot1',), 'siren', 'off', ()),
        (('bot1',), 'gripper', 'open', ()), ((), 'arm', 'carry_high', ())]
    assert keys.scene.screen.stick() == (0.0, 0.0, 0.0)


def test_nor_without_alt_nor_with_more_than_that(keys, operator):
    stage = keys.scene.screen.stage
    for modifiers in (Qt.NoModifier, ALT | Qt.ControlModifier, ALT | Qt.MetaModifier,
                      ALT | Qt.ShiftModifier):
        operator.hit(stage, Qt.Key_4, PLACES['4'], modifiers)
    assert keys.sent == []


LET_GO = {
    'the key': lambda stage, operator: operator.release(stage, Qt.Key_9, PLACES['9'], ALT),
    'alt': lambda stage, operator: operator.release(stage, Qt.Key_Alt, 64),
    'space': lambda stage, operator: operator.hit(stage, Qt.Key_Space, 65),
    'stop all': lambda stage, operator: operator.hit(stage, Qt.Key_Space, 65, Qt.ShiftModifier),
    'the window': lambda stage, _: QApplication.sendEvent(
        stage.window(), QEvent(QEvent.WindowDeactivate)),
}


@pytest.mark.parametrize('way', sorted(LET_GO))
def test_a_held_one_acts_while_its_key_is_down(keys, operator, way):
    stage = keys.scene.screen.stage
    operator.press(stage, Qt.Key_9, PLACES['9'], ALT)
    held, at_rest = (('bot1',), 'flipper', '', (1.0,)), (('bot1',), 'flipper', '', (0.0,))
    assert keys.sent == [held]
    for _ in range(3):
        operator.release(stage, Qt.Key_9, PLACES['9'], ALT, repeat=True)
        operator.press(stage, Qt.Key_9, PLACES['9'], ALT, repeat=True)
    operator.wait_until(lambda: keys.sent.count(held) > 2 or at_rest in keys.sent)
    LET_GO[way](stage, operator)
    assert keys.sent[-1] == at_rest and keys.sent.count(at_rest) == 1
    operator.press(stage, Qt.Key_9, PLACES['9'], ALT, repeat=True)
    assert keys.sent[-1] == at_rest


def test_a_stop_that_ends_it_asks_for_a_new_press(keys, operator):
    stage = keys.scene.screen.stage
    operator.press(stage, Qt.Key_9, PLACES['9'], ALT)
    keys.show('stopped')
    keys.show()
    operator.press(stage, Qt.Key_Up, 111, ALT)
    assert not [act for act in keys.sent[keys.sent.index((('bot1',), 'flipper', '', (0.0,))):]
                if act[1] == 'flipper' and any(act[3])]


def test_arrows_of_the_page_combine(keys, operator):
    stage = keys.scene.screen.stage
    operator.press(stage, Qt.Key_Up, 111, ALT)
    operator.press(stage, Qt.Key_Left, 113, ALT)
    assert keys.sent[-1] == (('bot1',), 'head', '', (1.0, 1.0))
    operator.release(stage, Qt.Key_Up, 111, ALT)
    assert keys.sent[-1] == (('bot1',), 'head', '', (1.0, 0.0))
    operator.release(stage, Qt.Key_Left, 113, ALT)
    assert keys.sent[-1] == (('bot1',), 'head', '', (0.0, 0.0))


def middle(tile, kind, x, y, buttons=Qt.MiddleButton):
    """Send an event of the middle button to the picture of a tile."""
    place = tile.picture_area().center() + QPoint(x, y)
    QApplication.sendEvent(tile, QMouseEvent(
        kind, QPointF(place), QPointF(tile.mapToGlobal(place)),
        Qt.NoButton if kind == QEvent.MouseMove else Qt.MiddleButton, buttons, Qt.NoModifier))


@pytest.mark.parametrize('way', ['release', 'hidden', 'a stop'])
def test_a_drag_with_the_middle_button_turns_the_head(desk, operator, way):
    found = desk()
    tile = found.scene.tiles['bot1']
    wide, at_rest = tile.picture_area().width(), (('bot1',), 'head', '', (0.0, 0.0))
    middle(tile, QEvent.MouseButtonPress, 0, 0)
    middle(tile, QEvent.MouseMove, wide // 8, 0)
    assert found.sent[0] == (('bot1',), 'head', '', pytest.approx((0.25, 0.0), abs=0.01))
    if way == 'hidden':
        tile.hide()
    elif way == 'a stop':
        found.show('stopped', **STATES)
    else:
        middle(tile, QEvent.MouseButtonRelease, 0, 0, Qt.NoButton)
    assert found.sent[-1] == at_rest and found.sent.count(at_rest) == 1
    middle(tile, QEvent.MouseMove, wide // 8, 0)
    assert found.sent[-1] == at_rest
