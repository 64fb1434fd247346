# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where windows go: beside the panel, never over what stops the robots, never two on one place."""
from itertools import combinations

import pytest
from python_qt_binding.QtCore import QRect, QSize
from python_qt_binding.QtGui import QGuiApplication
from python_qt_binding.QtWidgets import QMainWindow

from mhri.gui.screen.placing import free_place, place_window, Taken
from mhri.gui.screen.windows import TurtleBotWindow

WANTED, LEAST = QSize(940, 564), QSize(622, 483)


def panel_at(x, y, width=942, height=625):
    """Return what a panel takes: its stop bar and bottom line are 115 px high."""
    panel = QRect(x, y, width, height)
    keep = QRect(panel)
    keep.setTop(panel.bottom() - 114)
    return Taken(panel, keep)


def opened(screen, taken, count, wanted=WANTED, least=LEAST):
    """Return the places of so many windows, opened one after the other."""
    places = []
    for _ in range(count):
        places.append(free_place(screen, wanted, least, taken._replace(others=tuple(places))))
    return places


SCREENS = {
    'corner': (QRect(0, 0, 1600, 1000), panel_at(0, 0)),
    'middle': (QRect(0, 0, 1600, 1000), panel_at(329, 188)),
    'full_hd': (QRect(0, 0, 1920, 1080), panel_at(0, 0)),
    'full_hd_middle': (QRect(0, 0, 1920, 1080), panel_at(489, 227)),
    'below_a_bar': (QRect(0, 27, 1600, 973), panel_at(0, 27)),
    'right_screen': (QRect(1600, 0, 1920, 1080), panel_at(2578, 455)),
    'small': (QRect(0, 0, 1024, 600), panel_at(0, 0, 1024, 600)),
    'four_k': (QRect(0, 0, 3840, 2160), panel_at(0, 0)),
}


@pytest.mark.parametrize('case', sorted(SCREENS))
def test_stop_bar_and_bottom_line_stay_free(case):
    screen, taken = SCREENS[case]
    places = opened(screen, taken, 6)
    for place in places:
        assert screen.contains(place) and not place.intersects(taken.keep)
        assert place.width() >= LEAST.width() and place.height() >= LEAST.height()
    assert all(one.topLeft() != other.topLeft() for one, other in combinations(places, 2))


@pytest.mark.parametrize('case, apart', [
    ('corner', 2), ('full_hd', 2), ('below_a_bar', 1), ('right_screen', 2), ('four_k', 8)])
def test_they_tile_beside_the_panel(case, apart):
    """And the panel is not covered even by those that do not fit any more."""
    screen, taken = SCREENS[case]
    places = opened(screen, taken, 8)
    assert not any(place.intersects(taken.panel) for place in places)
    assert not any(one.intersects(other) for one, other in combinations(places[:apart], 2))


def test_without_frames_three_fit_on_full_hd():
    screen, taken = QRect(0, 0, 1920, 1080), panel_at(0, 0, 940, 605)
    places = opened(screen, taken, 3, QSize(930, 540), QSize(617, 465))
    assert not any(one.intersects(other) for one, other in combinations([taken.panel] + places, 2))
    assert places[0] == QRect(940, 0, 930, 540), 'as large as wanted where there is room'


@pytest.mark.parametrize('case', ['full_hd', 'full_hd_middle'])
def test_what_does_not_fit_shows_the_titles_of_what_it_covers(case):
    screen, taken = SCREENS[case]
    places = opened(screen, taken, 4)
    for covered, upper in combinations(places, 2):
        title = QRect(covered.topLeft(), QSize(200, 24))
        assert not upper.intersects(title)


def test_where_it_fits_nowhere_beside_the_panel_little_of_it_is_covered():
    """Windows rather lie on each other than on what drives."""
    screen, taken = QRect(0, 0, 1600, 1000), panel_at(0, 0, 1002)
    for place in opened(screen, taken, 3):
        assert not place.intersects(taken.keep)
        assert place.intersected(taken.panel).width() < 110


def test_a_screen_that_is_too_small_for_anything():
    screen = QRect(0, 0, 500, 400)
    assert free_place(screen, WANTED, LEAST, panel_at(0, 0, 500, 400)) == screen


def test_windows_are_moved_and_made_smaller(panel, operator, ui_dir):
    """On the screen there is, whose size a test does not choose."""
    screen = QGuiApplication.primaryScreen().availableGeometry()
    panel.move(screen.topLeft())
    panel.resize(736, 479)
    operator.settle()
    windows = []
    for number in range(2):
        window = TurtleBotWindow(ui_dir, 'bot{}'.format(number), 'TurtleBot2')
        window.offer(('imu', 'rgb'))
        place_window(window, panel, windows)
        operator.show(window)
        windows.append(window)
    for window in windows:
        assert not window.frameGeometry().intersects(panel.keep_in_sight())
        assert screen.contains(window.frameGeometry())
    assert windows[0].pos() != windows[1].pos()


def test_what_stays_in_sight_is_stop_bar_and_bottom_line(panel, operator):
    window = QMainWindow()
    window.setCentralWidget(panel)
    window.setGeometry(40, 30, 1024, 620)
    operator.show(window)
    keep = panel.keep_in_sight()
    assert keep.bottom() == window.geometry().bottom() and keep.width() == 1024
    assert keep.contains(panel.status_line.mapToGlobal(panel.status_line.rect().center()))
    assert keep.contains(panel.stop_bar.mapToGlobal(panel.stop_bar.rect().topLeft()))
    assert not keep.contains(panel.all_button.mapToGlobal(panel.all_button.rect().bottomLeft()))
    panel.setParent(None)
