# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Nothing on the stage moves by what an operator does; the stick lies on the driven picture."""
from dataclasses import replace

import numpy as np
import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QImage, QRegion
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QWidget

from mhri.base.views import ScreenView
from mhri.map.gui.map_pane import MapPane
from mhri.screen.gui.tile_cell import TileCell
from support.scenes import LARGE, place_in, SMALL, TINY

HUGE = (3840, 2160)


def select(made, *names):
    """Let exactly these robots be driven."""
    made.robots = tuple(replace(robot, selected=robot.name in names, driven=robot.name in names)
                        for robot in made.robots)
    made.view = replace(made.view, robots=made.robots)


def with_map(made):
    """Add the map to the stage of a scene."""
    made.screen.stage.set_map(MapPane(made.screen.stage))
    return made


def cells(made):
    """Return {robot: place of its cell}: of its tile while that is there, else of its copy."""
    screen = made.show()
    copies = {cell.tile.name: cell for cell in screen.stage.findChildren(TileCell)
              if cell.isVisible()}
    return {name: copies.get(name, tile).geometry() for name, tile in made.tiles.items()}


ACTIONS = {
    'look at bot2': lambda made: made.screen.look_at('bot2'),
    'look at bot5': lambda made: made.screen.look_at('bot5'),
    'drive bot2 alone': lambda made: select(made, 'bot2'),
    'look at nobody': lambda made: made.screen.look_at(''),
    'drive nobody': lambda made: select(made),
    'drive bot6': lambda made: select(made, 'bot6'),
    'map large': lambda made: made.screen.stage.swap_map(),
    'look at bot3 meanwhile': lambda made: made.screen.look_at('bot3'),
    'map back': lambda made: made.screen.stage.swap_map(),
    'tear bot4 off': lambda made: (made.tiles['bot4'].show_torn_off(True),
                                   made.tiles['bot4'].setParent(None),
                                   made.screen.stage.refresh()),
    'hide the numbers': lambda made: made.screen.arrangement.show_numbers(False),
    'ask': lambda made: made.screen.leave_bar.ask('close anyway?'),
    'a pad drives': lambda made: setattr(made, 'view', replace(made.view, mode='ps3joy')),
    'stop': lambda made: setattr(made, 'view', replace(made.view, stop_all=True)),
}


@pytest.mark.parametrize('size, count', [(TINY, 6), (SMALL, 12), (LARGE, 6), (LARGE, 12)])
def test_each_robot_keeps_its_place_whatever_is_done(scene, size, count):
    made = with_map(scene(size, count))
    made.screen.drawer_button.setChecked(False)
    before, screen = cells(made), made.screen
    foot = place_in(screen, screen.foot)
    for action, act in ACTIONS.items():
        act(made)
        assert cells(made) == before, action
        assert place_in(screen, screen.foot) == foot, action


def test_a_click_on_a_cell_looks_at_its_robot_and_lights_it(scene, heard):
    made = scene(SMALL, 6)
    clicked, driven = heard(made.tiles['bot1'].clicked), heard(made.tiles['bot2'].drive_requested)
    for tile in made.tiles.values():
        tile.clicked.connect(made.screen.look_at)
    cells(made)
    QTest.mouseClick(made.tiles['bot2'], Qt.LeftButton)
    cells(made)
    cell = made.screen.findChild(QWidget, 'cell_bot2')
    assert made.screen.stage.large == ('bot2',) and cell.isVisible()
    QTest.mousePress(cell, Qt.LeftButton)
    QTest.mouseDClick(cell, Qt.LeftButton)
    assert driven == ['bot2']
    select(made)
    cells(made)
    QTest.mouseClick(made.tiles['bot1'], Qt.LeftButton)
    assert clicked == ['bot1']


def assert_on(made, name):
    """The stick is whole, on the picture of a robot, names it, and covers none of its words."""
    screen, tile = made.show(), made.tiles[name]
    stick, hud = screen.joystick, tile.hud
    place = place_in(screen, stick)
    assert stick.isVisible() and stick.visibleRegion() == QRegion(stick.rect())
    assert place_in(screen, tile).contains(place)
    assert not place.intersects(place_in(screen, tile.robot_stop))
    least = stick.minimumSizeHint()
    assert place.width() >= least.width() and place.height() >= least.height()
    image = QImage(hud.size(), QImage.Format_ARGB32_Premultiplied)
    image.fill(0)
    hud.render(image, flags=QWidget.DrawChildren)
    bits = image.constBits()
    bits.setsize(image.byteCount())
    alpha = np.frombuffer(bits, np.uint8).reshape(image.height(), image.width(), 4)[:, :, 3]
    under = place.translated(-place_in(screen, hud).topLeft()).intersected(hud.rect())
    assert alpha.any() and not alpha[under.top():under.bottom() + 1,
                                     under.left():under.right() + 1].any()


@pytest.mark.parametrize('size, count, font', [
    (TINY, 1, 1.0), (TINY, 3, 1.0), (TINY, 12, 1.0), (SMALL, 3, 2.0), (LARGE, 6, 1.0),
    (LARGE, 3, 2.0), (HUGE, 12, 2.0)])
def test_the_stick_is_on_the_driven_picture_wherever_that_is(scene, size, count, font):
    made = with_map(scene(size, count, font))
    made.screen.drawer_button.setChecked(False)
    sentence = 'centre the stick to drive: nothing moves until you have centred it once'
    for tile in made.tiles.values():
        tile.show_view = lambda view, stop=False, tile=tile: tile.hud.show_sentence(sentence)
    screen = made.show()
    for act in (lambda: None, lambda: screen.look_at('bot2'), screen.stage.swap_map,
                screen.stage.swap_map):
        act()
        assert_on(made, 'bot1')
        assert screen.joystick.names == ('bot1',)
    screen.look_at('')
    select(made, *list(made.tiles)[:3])
    made.show()
    group, middle = tuple(made.tiles)[:3], screen.joystick.geometry().center()
    assert_on(made, next(name for name in group
                         if made.tiles[name].geometry().contains(middle)))
    assert screen.joystick.names == group


def test_the_stick_is_gone_while_it_drives_nobody_and_returns_to_neutral(scene, heard, drag):
    made = scene(SMALL, 3)
    screen = made.show()
    moved = heard(screen.stick_moved)
    for change in (dict(mode='ps3joy'), dict(robots=tuple(
            replace(robot, selected=False) for robot in made.robots)), dict(robots=())):
        screen.show_view(made.view)
        assert screen.joystick.isVisible()
        drag(screen.joystick, 0.0, 0.9)
        assert moved[-1][0] > 0.5
        screen.show_view(replace(made.view, **change))
        assert not screen.joystick.isVisible() and not screen.joystick.dragging
        assert moved[-1] == (0.0, 0.0, 0.0)
    screen.show_view(ScreenView())
    assert not screen.joystick.isVisible()
