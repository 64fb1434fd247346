# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen at every size, read pixel by pixel: pictures large, nothing clipped, all readable."""
from dataclasses import replace
import itertools
import os
import sys

import numpy as np
import pytest
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtGui import QColor, QPalette
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton, QPushButton, QWidget

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.gui import theme  # noqa: E402
from mhri.base.gui.labels import Pill, TextLine  # noqa: E402
from mhri.driving.gui.stop_button import StopButton  # noqa: E402
from mhri.screen.gui.torn_off import TornOff  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.scenes import colour_at, KINDS  # noqa: E402

SMALL, LARGE = (1280, 720), (1920, 1080)
LAYOUTS = [
    # size, robots, theme, font, kind, drawer
    ((1024, 600), 3, 'dark', 1.0, 'plain', True), ((1024, 600), 12, 'light', 1.0, 'plain', False),
    ((1024, 600), 1, 'dark', 1.0, 'stopped', False), (SMALL, 1, 'dark', 2.0, 'long', False),
    (LARGE, 1, 'light', 1.0, 'plain', False), (LARGE, 1, 'contrast', 2.0, 'stopped', False),
    ((1024, 600), 6, 'dark', 1.0, 'long', False),
    (SMALL, 1, 'light', 1.0, 'plain', True), (SMALL, 6, 'dark', 1.0, 'group', True),
    (SMALL, 12, 'dark', 1.0, 'long', False), ((1366, 768), 3, 'contrast', 1.0, 'long', True),
    ((1366, 768), 6, 'dark', 1.0, 'stopped', True), ((1366, 768), 12, 'dark', 1.0, 'plain', False),
    (LARGE, 1, 'dark', 1.0, 'plain', True), (LARGE, 3, 'light', 1.0, 'group', True),
    (LARGE, 6, 'contrast', 1.0, 'stopped', False), (LARGE, 12, 'dark', 1.0, 'plain', True),
    (SMALL, 12, 'dark', 1.0, 'stopped', True), ((1024, 600), 12, 'light', 2.0, 'plain', True),
    (LARGE, 6, 'dark', 2.0, 'long', True), ((3840, 2160), 3, 'dark', 2.0, 'plain', True),
    ((3840, 2160), 12, 'light', 2.0, 'long', True), ((794, 700), 3, 'dark', 1.0, 'long', False),
    ((794, 700), 6, 'light', 1.0, 'plain', True), ((794, 700), 3, 'dark', 1.0, 'stopped', False)]


def share_of_picture(pixels):
    """Return which part of the pixels is picture, under a dark header as well."""
    red, green, blue = (pixels[..., part].astype(int) for part in range(3))
    picture = (red > 36) & (abs(red - blue) < 16) & (2 * green < red)
    return picture.mean()


def place_in(window, widget):
    """Return the rectangle of a widget in its window."""
    return QRect(widget.mapTo(window, QPoint(0, 0)), widget.size())


def visible(window, kind):
    """Return the widgets of a kind that can be seen."""
    return [widget for widget in window.findChildren(kind)
            if widget.isVisible() and not widget.visibleRegion().isEmpty()]


def is_scrolled(screen, widget):
    """Tell whether a widget is in what scrolls."""
    return screen.robot_list.isAncestorOf(widget) or \
        screen.arrangement.looks.isAncestorOf(widget)


def assert_tiles_are_apart(screen):
    tiles = [tile for tile in screen.stage.children() if hasattr(tile, 'header')]
    for tile in tiles:
        assert tile.isVisible() and screen.stage.rect().contains(tile.geometry()), tile.name
    for one, other in itertools.combinations(tiles, 2):
        assert not one.geometry().intersects(other.geometry()), (one.name, other.name)


def assert_nothing_is_outside(screen):
    for widget in visible(screen, QAbstractButton) + visible(screen, TextLine):
        if not is_scrolled(screen, widget) and screen.rect().width() > 800:
            seen = widget.visibleRegion().boundingRect()
            assert seen == widget.rect() or widget.rect().isEmpty(), \
                (widget.objectName(), widget.rect(), seen)


def assert_no_text_is_elided(screen):
    for line in visible(screen, TextLine):
        assert line.shown_text() in line.texts, (line.objectName(), line.text(), line.width())
    for button in visible(screen, QPushButton):
        if not hasattr(button, 'shown_text'):
            words = button.fontMetrics().horizontalAdvance(button.text())
            assert words <= button.width() - 4, (button.objectName(), button.text())


def assert_no_word_of_a_state_is_cut_off(screen):
    for pill in visible(screen, Pill):
        words = theme.text_width(theme.larger(pill.font(), 0.92, bold=True), pill.word)
        assert not pill.word or words <= pill.width(), (pill.word, pill.width())


def assert_text_can_be_read(screen, pixels):
    """Look at the pixels of each line: the ground is what most of them are."""
    for line in visible(screen, TextLine):
        seen = line.visibleRegion().boundingRect()
        box = seen.translated(line.mapTo(screen, QPoint(0, 0)))
        if not line.shown_text().strip() or box.height() < line.height() or not line.isEnabled():
            continue
        crop = pixels[box.top():box.bottom() + 1, box.left():box.right() + 1].reshape(-1, 3)
        colours, counts = np.unique(crop // 2 * 2, axis=0, return_counts=True)
        ground = QColor(*map(int, colours[counts.argmax()]))
        best = max(theme.contrast(QColor(*map(int, colour)), ground) for colour in colours)
        assert best >= 4.5, (line.objectName(), line.text(), best)


@pytest.mark.parametrize('size, count, name, font, kind, drawer', LAYOUTS)
def test_layout(scene, size, count, name, font, kind, drawer):
    made = scene(size, count, font, **KINDS[kind])
    made.screen.arrangement.choose_theme(name)
    made.screen.drawer_button.setChecked(drawer)
    screen = made.show()
    assert (screen.width(), screen.height()) == size
    assert_tiles_are_apart(screen)
    assert_nothing_is_outside(screen)
    assert_no_text_is_elided(screen)
    assert_no_word_of_a_state_is_cut_off(screen)
    assert_text_can_be_read(screen, made.pixels())


@pytest.mark.parametrize('drawer', [True, False])
@pytest.mark.parametrize('size, count, least', [
    (LARGE, 1, 0.70), (LARGE, 3, 0.50), (SMALL, 1, 0.45), (SMALL, 3, 0.45),
    ((1366, 768), 1, 0.45), ((1366, 768), 3, 0.45)])
def test_most_of_the_screen_is_picture(scene, size, count, least, drawer):
    made = scene(size, count, mode='ps3joy')
    made.screen.drawer_button.setChecked(drawer)
    made.show()
    share = share_of_picture(made.pixels())
    print('MEASURED {:.1f} % of {}x{} is picture: {} robots, drawer {}'.format(
        100.0 * share, *size, count, 'open' if drawer else 'closed'))
    assert share >= least


def test_most_of_the_screen_is_picture_while_two_of_three_drive(scene):
    made = scene(LARGE, 3, mode='ps3joy')
    made.robots = tuple(replace(robot, selected=robot.number < 3) for robot in made.robots)
    made.view = replace(made.view, robots=made.robots)
    made.show()
    assert made.screen.stage.large == ('bot1', 'bot2')
    share = share_of_picture(made.pixels())
    print('MEASURED {:.1f} % is picture, two of three driven, drawer open'.format(100.0 * share))
    assert share >= 0.50


def test_stop_is_the_largest_control(scene):
    for size, count, drawer in (((1024, 600), 3, True), (SMALL, 3, True), (LARGE, 3, True),
                                (SMALL, 1, False), (LARGE, 1, False)):
        made = scene(size, count)
        made.screen.drawer_button.setChecked(drawer)
        screen = made.show()
        buttons = visible(screen, QAbstractButton)
        largest = max(buttons, key=lambda button: button.width() * button.height())
        assert isinstance(largest, StopButton)


@pytest.mark.parametrize('name', sorted(set(theme.THEMES) - {theme.SYSTEM}))
def test_colours_of_a_theme_can_be_told_from_their_ground(name):
    palette = theme.palette_of(name)
    for one in (palette, theme.over_picture(palette)):
        grounds = [one.color(role) for role in (QPalette.Window, QPalette.Base, QPalette.Button)]
        for ground in grounds:
            for sign in (theme.LIVE, theme.ATTENTION, theme.STOP, theme.DRIVE):
                assert theme.contrast(theme.colour(sign, one), ground) >= 3.0, (sign, ground.name())
            assert theme.contrast(theme.colour(theme.TEXT, one), ground) >= 4.5
        for ground in grounds[:2]:
            assert theme.contrast(theme.colour(theme.MUTED, one), ground) >= 4.5, ground.name()
        for sign in (theme.LIVE, theme.ATTENTION, theme.STOP, theme.DRIVE):
            ink = theme.colour(sign, one)
            assert theme.contrast(theme.readable_on(ink), ink) >= 4.5, sign
    assert theme.contrast(QColor(Qt.white), theme.STOP_GROUND) >= 4.5


def test_trouble_is_on_the_edge_of_a_tile_and_driving_on_that_of_another(scene):
    made = scene(SMALL, 6)
    screen = made.show()
    pixels = made.pixels()
    inks = [theme.colour(name, theme.over_picture(screen.palette()))
            for name in (theme.DRIVE, theme.STOP, theme.STOP)]
    for name, ink in zip(('bot1', 'bot3', 'bot5'), inks):
        tile = made.tiles[name]
        assert colour_at(pixels, tile, screen, 1, tile.height() // 2) == ink.getRgb()[:3]
    calm = made.tiles['bot2']
    assert colour_at(pixels, calm, screen, 2, calm.height() // 2) == \
        theme.PICTURE_GROUND.getRgb()[:3]


def test_after_a_stop_every_edge_says_so_whatever_else_is_wrong(scene):
    made = scene(SMALL, 6, **KINDS['stopped'])
    made.robots = tuple(replace(robot, slow=True, note='bad link') for robot in made.robots)
    screen = made.show()
    pixels, ink = made.pixels(), theme.colour(theme.STOP, theme.over_picture(screen.palette()))
    for name, tile in made.tiles.items():
        assert colour_at(pixels, tile, screen, 1, tile.height() // 2) == ink.getRgb()[:3], name


@pytest.mark.parametrize('size', [(1024, 600), SMALL, LARGE])
def test_no_switch_of_a_tile_is_clipped(scene, size):
    made = scene(size, 3, **KINDS['group'])
    made.screen.drawer_button.setChecked(size == LARGE)
    made.show()
    tile = made.tiles['bot1']
    tile.offer({'rgb', 'depth', 'scan', 'imu', 'cloud', 'record'})
    tile.views_button.click()
    made.show()
    switches = visible(tile.switches, QAbstractButton)
    assert len(switches) == 6
    for switch in switches:
        assert switch.width() >= switch.sizeHint().width(), switch.text()
        assert switch.visibleRegion().boundingRect() == switch.rect(), switch.text()


def test_the_one_looked_at_is_marked(scene):
    made = scene(SMALL, 3)
    screen = made.show()
    screen.look_at('bot2')
    made.show()
    tile = made.tiles['bot2']
    assert screen.stage.large == ('bot2',)
    assert colour_at(made.pixels(), tile, screen, 1, tile.height() // 2) == (0xf4, 0xf4, 0xf4)


def test_layout_and_colours_are_chosen_by_hand_and_kept(scene):
    made = scene(SMALL, 3)
    screen = made.show()
    looks = screen.arrangement.looks
    screen.arrangement.show_page(looks)
    made.show()
    chosen = []
    screen.arrangement.theme_chosen.connect(chosen.append)
    for name in ('layout_alike', 'theme_light', 'numbers_box'):
        button = looks.findChild(QWidget, name)
        looks.ensureWidgetVisible(button)
        QTest.mouseClick(button, Qt.LeftButton, Qt.NoModifier, QPoint(10, button.height() // 2))
    assert chosen == ['light'] and not theme.is_dark(screen.palette())
    assert screen.stage.large == ('bot1', 'bot2', 'bot3') and not screen.stage.numbers_shown
    kept = screen.save_settings()
    other = scene(SMALL, 3)
    other.screen.restore_settings(kept)
    assert other.screen.save_settings()['layout'] == 'alike'
    assert not theme.is_dark(other.screen.palette())
    other.screen.restore_settings({**kept, 'layout': 'sideways', 'theme': 'pink'})
    assert other.screen.save_settings()['theme'] == 'light'


def test_a_narrow_screen_with_known_robots_begins_with_pictures(scene):
    for size, is_open in (((1024, 600), False), ((794, 700), False), (SMALL, True), (LARGE, True)):
        made = scene(size, 3)
        made.screen.arrangement.begin_with_robots()
        screen = made.show()
        assert screen.drawer_button.isChecked() == is_open, size
        assert 'drawer' not in screen.save_settings()
        screen.drawer_button.click()
        assert screen.save_settings()['drawer'] != is_open
        made.show()
        assert screen.drawer_button.isChecked() != is_open, size


def test_what_grows_in_the_drawer_does_not_close_it(scene):
    made = scene(LARGE, 3)
    made.screen.arrangement.begin_with_robots()
    screen = made.show()
    assert screen.drawer.isVisible()
    screen.robots_side.setMinimumWidth(LARGE[0] // 2)
    wait_for(lambda: made.show().splitter.sizes()[0] >= LARGE[0] // 2, what='a wider drawer')
    assert screen.drawer.isVisible()


@pytest.mark.parametrize('count', [3, 12])
def test_the_stick_floats_over_the_large_picture_alone(scene, count):
    made = scene(SMALL, count)
    made.screen.drawer_button.setChecked(False)
    screen = made.show()
    assert screen.joystick.parentWidget() is screen.stage
    assert made.tiles['bot1'].geometry().contains(screen.joystick.geometry())
    assert screen.joystick.width() < made.tiles['bot1'].height() / 2


def test_with_a_pad_no_stick_covers_the_picture(scene):
    made = scene(SMALL, 1, mode='ps3joy')
    made.screen.drawer_button.setChecked(False)
    screen = made.show()
    assert not screen.joystick.isVisible()


def test_without_robots_it_invites_to_look(scene, heard):
    made = scene(SMALL, 0)
    screen = made.show()
    asked = heard(screen.look_requested)
    button = screen.findChild(QPushButton, 'invitation_look_button')
    assert button.isVisible() and not screen.joystick.geometry().intersects(button.geometry())
    QTest.mouseClick(button, Qt.LeftButton)
    assert len(asked) == 1


def test_the_scan_lies_in_a_corner_and_leaves_the_picture_large(scene):
    made = scene(SMALL, 1)
    screen = made.show()
    tile = made.tiles['bot1']
    before = tile.view('rgb').picture.width()
    tile.switches.choose(['rgb', 'scan'])
    made.show()
    scan = place_in(tile, tile.view('scan'))
    assert tile.view('rgb').picture.width() == before
    assert scan.width() < before / 2 and tile.rect().contains(scan)
    assert scan.top() >= tile.header.geometry().bottom()
    assert not place_in(screen, tile.view('scan')).intersects(place_in(screen, screen.joystick))
    tile.switches.choose(['scan'])
    made.show()
    assert tile.view('scan').parentWidget() is tile.views_splitter
    assert tile.view('scan').width() > before / 2


def test_a_torn_off_tile_has_stop_and_a_way_back(scene, application):
    made = scene(SMALL, 2)
    screen = made.show()
    tile = made.tiles['bot2']
    window = TornOff(tile)
    window.setAttribute(Qt.WA_DontShowOnScreen)
    window.show()
    screen.stage.refresh()
    application.processEvents()
    asked = []
    tile.tear_requested.connect(asked.append)
    assert 'bot2' in window.windowTitle()
    assert tile.stop_button.isVisible() and tile.stop_button.height() >= 44
    assert tile.tear_button.text() == 'Put back'
    QTest.mouseClick(tile.tear_button, Qt.LeftButton)
    assert asked == ['bot2'] and screen.stage.names == ('bot1',)
    window.give_back()
    tile.setParent(screen.stage)
    screen.stage.refresh()
    assert screen.stage.names == ('bot1', 'bot2') and tile.tear_button.text() == 'Tear off'


@pytest.mark.parametrize('style', ['auto', 'one', 'alike'])
def test_tiles_that_come_one_by_one_move_none_that_is_there(scene, style):
    made = scene(LARGE, 12)
    stage, names = made.show().stage, list(made.tiles)
    stage.set_style(style)
    whole = {name: tile.geometry() for name, tile in made.tiles.items()}
    shown = {}
    for name in ['bot4', *(name for name in names if name != 'bot4')]:
        shown[name] = made.tiles[name]
        stage.show_tiles({name: shown[name] for name in names if name in shown}, names)
        assert {name: tile.geometry() for name, tile in shown.items()} == {
            name: whole[name] for name in shown}
    # Those that do not come any more leave no gap.
    stage.show_tiles({name: made.tiles[name] for name in names[:1]}, names[:1])
    assert made.tiles['bot1'].geometry() == stage.rect()
