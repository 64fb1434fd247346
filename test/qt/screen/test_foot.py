# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The foot of the screen: one in every layout, whole, and nothing in it moves."""
from dataclasses import replace
import itertools

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QPushButton

from mhri.base.gui.labels import TextLine
from mhri.driving.gui.stop_bar import STOP_SHARE
from mhri.session.gui.note_bar import note_button
from mhri.session.gui.record_button import RecordButton
from support.scenes import LARGE, place_in, SMALL, TINY


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


def assert_apart(screen):
    """No button lies over another one."""
    places = [place_in(screen, button) for button in screen.foot.findChildren(QPushButton)
              if button.isVisible()]
    assert not any(one.intersects(other) for one, other in itertools.combinations(places, 2))


def foot_of(made):
    """Return the places of the foot and of what is always in it."""
    screen = made.show()
    return [place_in(screen, widget) for widget in (
        screen.foot, screen.drawer_button, screen.events_button)]


def with_power(made):
    """Let the robots of a scene offer to cut their power."""
    made.view = replace(made.view, robots=tuple(
        replace(robot, offers_power=True) for robot in made.view.robots))
    return made


@pytest.mark.parametrize('size, font', [
    (TINY, 1.0), (TINY, 2.0), (SMALL, 2.0), ((794, 700), 1.0), ((794, 700), 2.0), (LARGE, 1.0),
    (LARGE, 2.0)])
def test_it_is_one_in_every_layout(scene, size, font):
    places = []
    for count, drawer, more in ((1, False, {}), (3, True, {}), (12, False, {'group': True}),
                                (0, True, {}), (3, False, {'stop': True})):
        made = with_power(scene(size, count, font, **more))
        for place, button in enumerate((RecordButton, note_button), 1):
            made.screen.small_row.insertWidget(place, button(made.screen.foot))
        made.screen.drawer_button.setChecked(drawer)
        places.append(foot_of(made))
        screen = made.screen
        assert_whole(screen)
        assert_apart(screen)
        assert not places[-1][0].intersects(place_in(screen, screen.stage))
        if not more.get('stop'):
            stop = place_in(screen, screen.stop_bar.stop_button)
            assert abs(stop.width() / screen.stop_bar.width() - STOP_SHARE) <= 0.01
            assert stop.left() <= 8 and stop.bottom() >= size[1] - 8
            assert stop.height() >= places[-1][0].height() - 8
    foot = places[0][0]
    assert (foot.left(), foot.right(), foot.bottom()) == (0, size[0] - 1, size[1] - 1)
    assert [place for place in places if place != places[0]] == [], places[0]


@pytest.mark.parametrize('size, font', [(TINY, 1.0), (TINY, 2.0), (LARGE, 1.0)])
def test_releasing_moves_nothing(scene, heard, size, font):
    made = with_power(scene(size, 3, font, stop=True))
    before, screen = foot_of(made), made.screen
    released, bar = heard(screen.stop_bar.release_requested), screen.stop_bar
    place, picture = place_in(screen, bar.release_button), place_in(screen, screen.stage)
    assert bar.power_button.isVisible()
    QTest.mouseClick(bar.release_button, Qt.LeftButton)
    assert foot_of(made) == before
    assert_whole(screen)
    assert place_in(screen, bar.cancel_button).topLeft() == place.topLeft()
    assert not place_in(screen, bar.confirm_button).intersects(place)
    assert place_in(screen, screen.stage) == picture
    QTest.mouseClick(bar.confirm_button, Qt.LeftButton)
    assert released == [()]
