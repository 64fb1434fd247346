# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The foot of the screen: where it leaves most to the pictures, STOP ALL always in one corner."""
from dataclasses import replace
import os
import sys

import pytest
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QPushButton

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base import views  # noqa: E402
from mhri.base.gui.labels import TextLine  # noqa: E402
from mhri.screen.gui.foot import BELOW, COLUMN, IN_DRAWER  # noqa: E402
from support.scenes import frame_of, MAGENTA  # noqa: E402

TINY, SMALL, LARGE = (1024, 600), (1280, 720), (1920, 1080)


def place_in(screen, widget):
    """Return the rectangle of a widget on the screen."""
    return QRect(widget.mapTo(screen, QPoint(0, 0)), widget.size())


def closed(scene, size, count=1, **more):
    """Return a scene whose drawer is closed, shown."""
    made = scene(size, count, **more)
    made.screen.drawer_button.setChecked(False)
    made.show()
    return made


def assert_whole(screen):
    """All of the foot can be seen and read."""
    for kind in (QPushButton, TextLine):
        for widget in screen.foot.findChildren(kind):
            if not widget.isVisible():
                continue
            assert screen.rect().contains(place_in(screen, widget)), widget.objectName()
            assert widget.visibleRegion().boundingRect() == widget.rect(), widget.objectName()
            if hasattr(widget, 'texts'):
                assert widget.shown_text() in widget.texts, widget.text()
            elif not hasattr(widget, 'shown_text'):
                assert widget.fontMetrics().horizontalAdvance(widget.text()) <= \
                    widget.width() - 4, widget.text()


@pytest.mark.parametrize('size, count, drawer, place', [
    (TINY, 1, False, COLUMN), (SMALL, 1, False, COLUMN), ((1366, 768), 1, False, COLUMN),
    (LARGE, 1, False, COLUMN), (LARGE, 1, True, IN_DRAWER), (LARGE, 3, False, BELOW),
    (LARGE, 12, False, BELOW), ((794, 700), 1, False, BELOW), (SMALL, 0, False, BELOW)])
def test_the_foot_is_where_it_takes_least(scene, size, count, drawer, place):
    made = scene(size, count)
    made.screen.drawer_button.setChecked(drawer)
    screen = made.show()
    assert screen.arrangement.foot.place == place
    assert not place_in(screen, screen.foot).intersects(place_in(screen, screen.stage))
    assert_whole(screen)


def test_a_wide_picture_has_the_foot_below(scene):
    made = scene(LARGE, 1)
    made.frame = lambda number: frame_of(MAGENTA, (640, 360))
    made.screen.drawer_button.setChecked(False)
    assert made.show().arrangement.foot.place == BELOW
    made.frame = lambda number: frame_of(MAGENTA)
    assert made.show().arrangement.foot.place == COLUMN
    made.frame = lambda number: frame_of(MAGENTA, (640, 360))
    assert made.show().arrangement.foot.place == BELOW


@pytest.mark.parametrize('size', [TINY, SMALL, LARGE])
def test_stop_is_in_one_corner_wherever_the_foot_is(scene, size):
    common = None
    for count, drawer in ((1, False), (1, True), (3, False), (12, True)):
        made = scene(size, count)
        made.screen.drawer_button.setChecked(drawer)
        screen = made.show()
        place = place_in(screen, screen.stop_bar.stop_button)
        common = place if common is None else common.intersected(place)
    unit = screen.fontMetrics().height()
    assert common.width() >= 10 * unit and common.height() >= 3 * unit
    assert common.left() <= unit and common.bottom() >= size[1] - unit


@pytest.mark.parametrize('size, font', [(TINY, 1.0), (SMALL, 1.0), (LARGE, 2.0)])
def test_releasing_in_the_column_moves_nothing(scene, heard, size, font):
    made = closed(scene, size, font=font, stop=True)
    made.view = replace(made.view, robots=tuple(
        replace(robot, offers_power=True) for robot in made.view.robots))
    screen = made.show()
    assert screen.arrangement.foot.place == COLUMN
    released, bar = heard(screen.release_requested), screen.stop_bar
    before, picture = place_in(screen, bar.release_button), place_in(screen, screen.stage)
    assert bar.power_button.isVisible()
    assert_whole(screen)
    QTest.mouseClick(bar.release_button, Qt.LeftButton)
    made.show()
    assert place_in(screen, bar.cancel_button).topLeft() == before.topLeft()
    assert place_in(screen, screen.stage) == picture
    assert_whole(screen)
    QTest.mouseClick(bar.confirm_button, Qt.LeftButton)
    assert released == [()]


@pytest.mark.parametrize('size', [TINY, SMALL, LARGE])
def test_questions_have_room_in_the_foot(scene, size):
    made = closed(scene, size)
    made.view = replace(made.view, control=views.ControlView(
        False, 'mhri_screen on inspection-van-2 since 14:03:22'))
    screen = made.show()
    screen.leave_bar.ask('bot1 is driven, and bot2 records: close anyway?')
    QTest.mouseClick(screen.control_bar.take_button, Qt.LeftButton)
    made.show()
    assert screen.control_bar.confirm_button.isVisible()
    assert screen.leave_bar.stay_button.isVisible()
    assert_whole(screen)


@pytest.mark.parametrize('size', [SMALL, LARGE])
def test_beside_the_picture_the_stick_covers_nothing(scene, size):
    made = closed(scene, size)
    screen = made.screen
    stick = place_in(screen, screen.joystick)
    assert screen.foot.isAncestorOf(screen.joystick)
    assert not stick.intersects(place_in(screen, screen.stage))
    assert not stick.intersects(place_in(screen, screen.stop_bar))
    assert screen.joystick.travel() >= 3 * screen.fontMetrics().height()
    screen.drawer_button.setChecked(True)
    made.show()
    assert not screen.foot.isAncestorOf(screen.joystick)
    assert screen.joystick.visibleRegion().boundingRect() == screen.joystick.rect()
    screen.drawer_button.setChecked(False)
    made.view = replace(made.view, mode='ps3joy')
    made.show()
    assert not screen.joystick.isVisible()


def test_the_keys_lie_over_the_picture_and_not_over_the_foot(scene):
    made = closed(scene, LARGE)
    made.screen.key_help.toggle()
    screen = made.show()
    assert place_in(screen, screen.key_help) == place_in(screen, screen.stage)
