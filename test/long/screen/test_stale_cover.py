# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen that is not drawn any more says so, over everything, and stops robots all the same."""
import sys
import time
import traceback

import pytest
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtWidgets import QApplication, QPushButton, QVBoxLayout, QWidget

from mhri.base.gui import theme
from mhri.screen.gui.stale_cover import (
    LOOK_MS, OLD_AFTER_S, SLIP_SHOWN_S, StaleCover)
from mhri.screen.presenters.draw_guard import DrawGuard
from mhri.screen.presenters.screen_presenter import ScreenPresenter
from mhri.screen.ros.backend import ScreenBackend
from support.clock import Clock


@pytest.fixture
def window(operator):
    made = QWidget()
    made.setObjectName('window')
    made.button = QPushButton('STOP ALL', made)
    QVBoxLayout(made).addWidget(made.button)
    made.resize(500, 300)
    return operator.show(made)


class PyqtgraphsHook:
    """As pyqtgraph's own, which it sets when it is imported: known by its module alone."""

    __module__ = 'pyqtgraph.exceptionHandling'

    def __call__(self, kind, value, trace):
        traceback.print_exception(kind, value, trace)


class Told(list):
    """Somebody else's hook for exceptions."""

    def __call__(self, *what):
        self.append(what)


@pytest.fixture(params=['Python', 'pyqtgraph', 'another'])
def hook(request):
    """Begin with each of the hooks that may be there, and leave the one that was."""
    before = sys.excepthook
    sys.excepthook = {'Python': sys.__excepthook__, 'another': Told(),
                      'pyqtgraph': PyqtgraphsHook()}[request.param]
    yield sys.excepthook
    sys.excepthook = before


@pytest.mark.parametrize('events, seen', [
    ((), False), ((('drawn', 0.0),), False), ((('drawn', OLD_AFTER_S - 0.01),), False),
    ((('drawn', OLD_AFTER_S + 0.01),), True), ((('failed', 0.01),), True),
    ((('drawn', 0.4), ('failed', 0.1)), False), ((('drawn', 0.4), ('failed', 0.2)), True),
    ((('drawn', 5.0), ('drawn', 0.1)), False), ((('drawn', 0.1), ('slipped', 0.1)), True),
    ((('slipped', SLIP_SHOWN_S), ('drawn', 0.1)), False)])
def test_when_it_is_seen(window, events, seen):
    """Events: what happened, and how long ago the next did."""
    clock = Clock()
    cover = StaleCover(window, clock)
    for event, later_s in events:
        getattr(cover, event)(*([] if event == 'drawn' else ['KeyError: x']))
        clock.now += later_s
    cover.refresh()
    assert cover.isVisible() == seen
    cover.end()
    assert not cover.isVisible()


def test_it_lies_over_everything_and_lets_clicks_through(window, operator, heard):
    pressed, clock = heard(window.button.pressed), Clock()
    cover = StaleCover(window, clock, window.button)
    cover.drawn()
    plain = window.grab().toImage()
    clock.now += 3.2
    cover.refresh()
    operator.settle()
    assert cover.geometry() == window.rect() and '3.2 s' in cover.texts()[1]
    image, ink = window.grab().toImage(), theme.colour(theme.STOP, window.palette()).rgb()
    changed = [(x, y) for x in range(0, 500, 2) for y in range(0, 300, 2)
               if image.pixel(x, y) == ink != plain.pixel(x, y)]
    for corner in ((0, 0), (250, 0), (0, 150), (250, 150)):
        assert any(corner[0] <= x < corner[0] + 250 and corner[1] <= y < corner[1] + 150
                   for x, y in changed), 'in every quarter of the window'
    where = QRect(window.button.mapTo(window, QPoint()), window.button.size())
    assert image.copy(where) == plain.copy(where), 'it leaves out what works'
    place = where.center()
    assert window.childAt(place) is window.button
    operator.click(window.childAt(place))
    assert len(pressed) == 1
    window.resize(700, 400)
    operator.settle()
    assert cover.geometry() == window.rect()
    cover.drawn()
    assert not cover.isVisible(), 'at once: it would say what is not so'


def test_one_banner_says_it_for_all_that_is_inside(window, operator):
    clock, tile = Clock(), QWidget(window)
    tile.setGeometry(50, 100, 300, 150)
    tile.show()
    whole, part = StaleCover(window, clock), StaleCover(tile, clock)
    whole.drawn()
    part.drawn()
    clock.now += OLD_AFTER_S + 0.1
    # Whichever looks first: no banner comes for a moment.
    part.refresh()
    whole.refresh()
    assert whole.isVisible() and not part.isVisible()
    whole.drawn()
    part.refresh()
    assert not whole.isVisible() and part.isVisible(), 'the tile alone is old'
    whole.slipped('KeyError: x')
    part.refresh()
    whole.refresh()
    assert whole.isVisible() and not part.isVisible()
    tile.setParent(None)
    tile.show()
    part.refresh()
    assert part.isVisible(), 'torn off it is a window of its own'
    tile.deleteLater()


class Failing(QWidget):
    """Cannot be painted."""

    def paintEvent(self, event):  # noqa: N802
        raise KeyError('colour')


def test_a_painting_that_fails_ends_nothing_and_is_said(window, operator, hook, capfd):
    guard = DrawGuard(window)
    guard.run(lambda: None)
    failing = Failing(window)
    failing.setGeometry(10, 10, 50, 50)
    failing.show()
    operator.wait_until(lambda: failing.update() or guard.cover.isVisible())
    assert 'KeyError' in guard.cover.texts()[-1]
    assert capfd.readouterr().err.count('Traceback') <= 1
    assert not isinstance(hook, Told) or hook
    failing.hide()
    guard.run(lambda: None)
    timer_end = time.monotonic() + SLIP_SHOWN_S + 30.0
    while guard.cover.isVisible() and time.monotonic() < timer_end:
        guard.run(lambda: None)
        QApplication.processEvents()
    assert not guard.cover.isVisible()
    guard.end()


@pytest.fixture
def presenter(operator):
    made = ScreenPresenter(ScreenBackend())
    made.operator.start = lambda: None
    made.screen.resize(1024, 600)
    made.start(('bot1',))
    operator.show(made.screen)
    made.tiles.make('bot1')
    yield made
    made.close()


def cover_of(widget):
    """Return the cover of a widget, not those of its parts."""
    return widget.findChild(StaleCover, options=Qt.FindDirectChildrenOnly)


def test_a_panel_whose_drawing_fails_says_so_within_a_second(presenter, operator, monkeypatch):
    cover, drawn, stops = cover_of(presenter.screen), [], []
    view = presenter.operator.view
    monkeypatch.setattr(presenter.operator, 'view', lambda: drawn.append(1) or view())
    operator.wait_until(lambda: len(drawn) > 2 and not cover.isVisible())
    monkeypatch.setattr(presenter.operator, 'stop_all', lambda: stops.append(1))
    presenter.screen.stop_requested.connect(presenter.operator.stop_all)
    begun = time.monotonic()
    monkeypatch.setattr(presenter.operator, 'view', lambda: 1 / 0)
    operator.wait_until(cover.isVisible)
    took = time.monotonic() - begun
    print('MEASURED said after {:.0f} ms'.format(took * 1000.0))
    assert OLD_AFTER_S + LOOK_MS / 1000.0 < 1.0
    assert 'ZeroDivisionError' in cover.texts()[-1]
    operator.click(presenter.screen.stop_bar.stop_button)
    assert stops == [1]
    monkeypatch.undo()
    operator.wait_until(lambda: not cover.isVisible())


def test_a_window_whose_drawing_fails_says_so_alone(presenter, operator, monkeypatch):
    guard, tile = presenter.tiles.presenters['bot1'].guard, presenter.windows['bot1']
    monkeypatch.setattr(tile, 'show_view', lambda *_: 1 / 0)
    operator.wait_until(lambda: guard.cover.isVisible()
                        and not cover_of(presenter.screen).isVisible())
    tile.show_large(not tile.header.large)
    operator.settle()
    assert [part for part in tile.children() if part.isWidgetType()][-1] is guard.cover, 'on top'
    monkeypatch.undo()
    operator.wait_until(lambda: not guard.cover.isVisible())
