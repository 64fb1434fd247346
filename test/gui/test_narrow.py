# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where there is little room: narrow docks, tiles, lines and drawers."""
import os
import sys

import pytest
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import QAbstractButton, QPushButton, QVBoxLayout, QWidget

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.gui import theme  # noqa: E402
from mhri.base.gui.labels import TextLine  # noqa: E402
from mhri.base.views import GONE  # noqa: E402
from mhri.screen.gui.hud import Hud  # noqa: E402
from mhri.screen.gui.status_line import StatusLine  # noqa: E402
from support.scenes import colour_at, pixels_of  # noqa: E402

SMALL, LARGE = (1280, 720), (1920, 1080)


def test_in_a_narrow_dock_of_a_light_desktop_it_can_be_read(scene, application):
    made = scene((684, 440), 0)
    dock = QWidget()
    dock.setPalette(theme.palette_of('light'))
    dock.setAttribute(Qt.WA_DontShowOnScreen)
    QVBoxLayout(dock).addWidget(made.screen)
    dock.resize(700, 470)
    dock.show()
    screen = made.show()
    pixels = made.pixels()
    ground = theme.palette_of('dark').color(QPalette.Window).getRgb()[:3]
    invitation = screen.findChild(QWidget, 'invitation')
    assert colour_at(pixels, invitation, screen, 2, 2) == ground
    assert colour_at(pixels, screen.foot, screen, screen.foot.width() - 2, 2) == ground
    button = screen.findChild(QPushButton, 'invitation_look_button')
    assert invitation.rect().contains(button.geometry())
    assert button.width() > theme.text_width(button.font(), button.text())


@pytest.mark.parametrize('width', [180, 250, 330, 420])
def test_numbers_over_a_narrow_picture_are_whole(scene, width):
    """White is words alone here: none at the right edge, where a line would be cut off."""
    made = scene(SMALL, 1)
    made.show()
    hud = made.tiles['bot1'].hud
    hud.set_extra(('0.98 m to the nearest thing, ahead left',))
    hud.show_view(made.robots[0])
    hud.resize(width, 160)
    seen = pixels_of(hud)
    assert (seen[:, :width // 2] > 240).all(axis=2).any()
    assert not (seen[:, -6:] > 240).all(axis=2).any()


def test_over_a_thumbnail_one_word_stands_for_a_sentence_that_has_no_room(operator):
    hud = Hud()
    operator.show(hud)
    hud.show_large(False)
    hud.resize(130, 60)
    hud.show_sentence('gone', theme.LINK_SIGNS[GONE])
    in_a_word = pixels_of(hud)
    for text in ('nothing heard for 12 s: switched off', 'incomprehensibilities'):
        hud.show_sentence(text, theme.LINK_SIGNS[GONE], ('gone',))
        assert (pixels_of(hud) == in_a_word).all()
    hud.show_sentence('held: look', theme.LINK_SIGNS[GONE], ('gone',))
    assert (pixels_of(hud) != in_a_word).any()


def test_a_narrow_bottom_line_says_what_happens(application, operator):
    line = StatusLine()
    operator.show(line)
    label = line.findChild(TextLine, 'status_label')
    line.show_status('1 of 2 robots  \u2013  Virtual joystick  \u2013  driving', 'calm')
    for text, width in (('driving', 80), ('Virtual joystick  \u2013  driving', 240)):
        label.setFixedWidth(width)
        assert label.shown_text() == text
    line.show_status('no robot selected: check the ones to drive', 'calm')
    label.setFixedWidth(theme.text_width(label.font(), 'no robot selected:'))
    assert label.shown_text() == 'no robot selected'


@pytest.mark.parametrize('size', [(794, 700), (1024, 600), SMALL, LARGE])
def test_every_page_of_the_drawer_has_its_tab_in_sight(scene, size):
    made = scene(size, 3)
    for title in ('Tasks', 'Events', 'Doctor', 'Pad'):
        made.screen.arrangement.add_page(title, QWidget())
    tabs = made.show().tabs
    assert {'Robots', 'Screen', 'Tasks', 'Events', 'Doctor', 'Pad'} <= {
        tabs.tabText(index) for index in range(tabs.count())}
    for index in range(tabs.count()):
        room = tabs.tabRect(index)
        assert tabs.rect().contains(room), tabs.tabText(index)
        assert theme.text_width(tabs.font(), tabs.tabText(index)) <= room.width()


@pytest.mark.parametrize('size, count', [((1024, 600), 3), ((1366, 768), 3), (LARGE, 1)])
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
    assert all(tile.views_splitter.isVisible() and tile.hud.isVisible()
               for tile in made.tiles.values())
