# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen at every size, read pixel by pixel: pictures large, nothing clipped, all readable."""
import itertools
import re

import numpy as np
import pytest
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtGui import QColor, QPalette
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton, QPushButton

from mhri.base.gui import theme
from mhri.base.gui.labels import Pill, TextLine
from mhri.driving.gui.stop_button import StopButton
from mhri.map.gui.map_pane import MapPane
from support.paths import REPO, RESOURCE
from support.scenes import colour_at, KINDS, LARGE, SMALL, TINY

LAYOUTS = [
    # size, robots, theme, font, kind, drawer
    (TINY, 3, 'dark', 1.0, 'plain', True),
    (TINY, 12, 'light', 2.0, 'plain', True),
    (SMALL, 1, 'dark', 2.0, 'long', False), (LARGE, 6, 'contrast', 1.0, 'stopped', False),
    ((3840, 2160), 12, 'light', 2.0, 'long', True),
    ((794, 700), 3, 'dark', 1.0, 'stopped', False)]


def visible(window, kind):
    """Return the widgets of a kind that can be seen."""
    return [widget for widget in window.findChildren(kind)
            if widget.isVisible() and not widget.visibleRegion().isEmpty()]


def is_scrolled(screen, widget):
    """Return whether a widget is in what scrolls."""
    page = screen.pages.currentWidget()
    return screen.robot_list.isAncestorOf(widget) or \
        page.verticalScrollBar().maximum() > 0 and page.isAncestorOf(widget)


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
    made.screen.stage.set_map(MapPane(made.screen.stage))
    made.screen.arrangement.choose_theme(name)
    made.screen.drawer_button.setChecked(drawer)
    screen = made.show()
    assert (screen.width(), screen.height()) == size
    assert_tiles_are_apart(screen)
    assert_nothing_is_outside(screen)
    assert_no_text_is_elided(screen)
    assert_no_word_of_a_state_is_cut_off(screen)
    assert_text_can_be_read(screen, made.pixels())


def test_stop_is_the_largest_control(scene):
    for size, count, drawer in ((TINY, 3, True), (SMALL, 1, False), (LARGE, 3, True)):
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


@pytest.mark.parametrize('kind', ['plain', 'stopped'])
def test_the_edge_of_a_tile_has_the_colour_of_its_state(scene, kind):
    made = scene(SMALL, 6, **KINDS[kind])
    screen = made.show()
    if kind == 'plain':
        screen.look_at('bot2')
        made.show()
    pixels = made.pixels()
    drive, stop = (theme.colour(name, theme.over_picture(screen.palette())).getRgb()[:3]
                   for name in (theme.DRIVE, theme.STOP))
    calm = theme.PICTURE_GROUND.getRgb()[:3]
    # The third is lost, the battery of the fifth is flat; the others rightly stand.
    expected = {'bot1': calm, 'bot2': calm} if kind == 'stopped' else {
        'bot1': drive, 'bot2': (0xf4, 0xf4, 0xf4)}
    expected.update(bot3=stop, bot4=calm, bot5=stop)
    assert {name: colour_at(pixels, made.tiles[name], screen, 1, made.tiles[name].height() // 2)
            for name in expected} == expected


def test_layout_and_colours_are_chosen_by_hand_and_kept(scene):
    made = scene(SMALL, 3)
    screen = made.show()
    looks = screen.arrangement.looks
    screen.arrangement.show_page(looks)
    made.show()
    chosen = []
    screen.arrangement.theme_chosen.connect(chosen.append)
    for choice, key in ((looks.layout_choice, Qt.Key_End), (looks.theme_choice, Qt.Key_Down)):
        QTest.keyClick(choice, key)
    QTest.mouseClick(looks.numbers_box, Qt.LeftButton)
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
    for size, is_open in ((TINY, False), (SMALL, True)):
        made = scene(size, 3)
        made.screen.arrangement.begin_with_robots()
        screen = made.show()
        assert screen.drawer_button.isChecked() == is_open, size
        assert 'drawer' not in screen.save_settings()
        screen.drawer_button.click()
        assert screen.save_settings()['drawer'] != is_open
        made.show()
        assert screen.drawer_button.isChecked() != is_open, size


@pytest.mark.parametrize('size, count', [(TINY, 3), (LARGE, 1)])
def test_open_views_are_whole_where_a_tile_is_small(scene, size, count):
    """Where they leave the picture no room they scroll; no words lie over them."""
    made = scene(size, count, group=count > 1)
    for tile in made.tiles.values():
        tile.offer({'rgb', 'depth', 'cloud', 'scan', 'imu', 'record'})
    screen = made.show()
    assert screen.stage.large == tuple(made.tiles)
    for tile in made.tiles.values():
        tile.views_button.setChecked(True)
    made.show()
    for tile in made.tiles.values():
        page, view = tile.tools_page, tile.tools.viewport()
        assert page.width() <= view.width()
        assert not tile.hud.isVisible() or not tile.hud.geometry().intersects(tile.tools.geometry())
        for button in (part for part in page.findChildren(QAbstractButton) if part.isVisible()):
            assert page.rect().contains(QRect(button.mapTo(page, QPoint(0, 0)), button.size()))
            assert button.width() >= button.minimumSizeHint().width(), button.objectName()
            button.setFocus()
            tile.tools.ensureWidgetVisible(button, 0, 0)
            assert button.visibleRegion().boundingRect() == button.rect(), button.objectName()
        tile.views_button.setChecked(False)
    made.show()
    assert all(tile.views_place.isVisible() and tile.hud.isVisible()
               for tile in made.tiles.values())


def test_text_has_the_sizes_of_one_scale_and_distances_lie_on_one_grid():
    """No widget has a size of its own; what shrinks to fit its room computes its factor."""
    numbers = re.compile(r'(?:larger|plain_label)\([^#\n]*[, ]\d+\.\d+[,) ]')
    gaps = re.compile(r'(?:set(?:Horizontal|Vertical)?Spacing\(|gap=)(\d+)(?! \*)')
    found = []
    for path in sorted((REPO / 'src' / 'mhri').glob('*/gui/*.py')):
        text = path.read_text()
        found += [(path.name, match.group()) for match in numbers.finditer(text)]
        found += [(path.name, match.group()) for match in gaps.finditer(text)
                  if int(match.group(1)) % theme.GRID]
    assert found == []
    assert [space for space in re.findall(r'(?:Margin"|"spacing")><number>(\d+)', ''.join(
        (RESOURCE / name).read_text() for name in ('screen.ui', 'bot_window.ui')))
        if int(space) % theme.GRID] == []
