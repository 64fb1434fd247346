# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drawer: three pages by the job, sections that fold, every robot in sight, its icons."""

import pytest
from python_qt_binding.QtCore import QRectF, Qt
from python_qt_binding.QtGui import QColor, QImage, QPainter
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QLabel

from mhri.base.gui import icons, theme
from mhri.base.gui.page import Page
from mhri.base.gui.text_size import usual_size
from mhri.base.part import MISSION, ROBOTS
from support.paths import RESOURCE


def part_of(name, lines=1):
    """Return a part of so many lines."""
    part = Page(name)
    part.column.addWidget(QLabel('\n'.join(map(str, range(lines))), part))
    return part


def in_sight(screen, part):
    """Return whether the upper edge of a part can be seen."""
    return part.isVisible() and part.visibleRegion().contains(part.rect().topLeft())


def test_sections_stand_in_their_order_and_one_that_is_asked_for_comes_into_sight(scene, operator):
    screen = scene((1280, 720), 3).show()
    parts = {order: part_of('part{}'.format(order), 40) for order in (30, 10, 20)}
    for order, part in parts.items():
        screen.arrangement.add_section(MISSION, part.objectName(), part, order)
    names = [section.part.objectName() for section in screen.arrangement.drawer.sections]
    assert [name for name in names if name.startswith('part')] == ['part10', 'part20', 'part30']
    for order in (30, 10, 20, 30):
        screen.arrangement.show_page(parts[order])
        operator.wait_until(lambda order=order: in_sight(screen, parts[order]))


def test_a_section_is_folded_by_a_click_and_by_a_key(scene, operator):
    screen = scene((1280, 720), 3).show()
    part = part_of('part')
    section = screen.arrangement.add_section(ROBOTS, 'Part', part, 50)
    operator.settle()
    assert not part.isVisible()
    QTest.mouseClick(section.row, Qt.LeftButton)
    assert part.isVisible()
    QTest.keyClick(section.row, Qt.Key_Space)
    assert not part.isVisible()


@pytest.mark.parametrize('size, count', [((1600, 1000), 4), ((1920, 1080), 12), ((1280, 720), 5)])
def test_all_robots_are_in_sight(scene, size, count):
    made = scene(size, count)
    made.screen.arrangement.begin_with_robots()
    screen = made.show()
    rows = [screen.robot_list.row(name) for name in made.tiles]
    assert [row.name for row in rows if row.visibleRegion().boundingRect() != row.rect()] == []


@pytest.mark.parametrize('path', sorted((RESOURCE / 'icons').glob('*.svg')),
                         ids=lambda path: path.stem)
def test_an_icon_fills_its_square_and_no_more(application, path):
    drawn = icons.path_of(str(path.parent), path.stem)
    box = drawn.boundingRect()
    assert QRectF(0, 0, 24, 24).contains(box) and max(box.width(), box.height()) >= 9.0
    image = QImage(48, 48, QImage.Format_RGB32)
    image.fill(Qt.black)
    icons.use_folder(str(path.parent))
    painter = QPainter(image)
    icons.paint_icon(painter, QRectF(image.rect()), path.stem, QColor(Qt.white))
    painter.end()
    lit = sum(image.pixelColor(x, y).lightness() > 127 for x in range(48) for y in range(48))
    assert 40 < lit < 1200


@pytest.fixture
def as_before():
    """Give what is made afterwards the usual text size again."""
    before = theme.text_scale[0]
    yield
    theme.text_scale[0] = before


@pytest.mark.parametrize('percent', [75, 150, 200])
def test_text_size_is_chosen_while_it_runs_kept_and_undone(scene, operator, as_before, percent):
    made = scene((1920, 1080), 3)
    screen = made.show()
    parts = (screen.robot_list.row('bot1').title, screen.all_button, made.tiles['bot1'],
             screen.robot_list.row('bot1').battery, screen.speed_limits)
    before = [(part.font().pointSizeF(), part.minimumSize()) for part in parts]
    assert 'text' not in screen.save_settings()
    combo = screen.arrangement.looks.text_choice
    while combo.currentData() != percent:
        QTest.keyClick(combo, Qt.Key_Down if combo.currentData() < percent else Qt.Key_Up)
    made.show()
    now = [part.font().pointSizeF() for part in parts]
    assert now == pytest.approx([size * percent / 100.0 for size, _ in before])
    assert min(screen.all_button.height(), screen.all_button.width()) >= 36
    assert screen.save_settings()['text'] == percent
    other = scene((1920, 1080), 1)
    assert other.screen.font().pointSizeF() == pytest.approx(screen.font().pointSizeF())
    screen.arrangement.choose_text_size(100)
    made.show()
    assert [(part.font().pointSizeF(), part.minimumSize()) for part in parts] == [
        (pytest.approx(size), least) for size, least in before]


@pytest.mark.parametrize('monitor_px, line_px, percent', [
    (2160, 18, 150), (2160, 36, 100), (1080, 18, 100), (1600, 20, 100)])
def test_text_begins_larger_on_a_monitor_the_desktop_was_not_set_up_for(
        monitor_px, line_px, percent):
    assert usual_size(monitor_px, line_px) == percent
