# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where a new window goes: beside the panel and the others, never over what stops the robots.

Rectangles (``QRect``) are those of whole windows, with the frame that a window manager draws.
"""
import math
from typing import NamedTuple, Tuple

from python_qt_binding.QtCore import QMargins, QPoint, QRect, QSize
from python_qt_binding.QtGui import QGuiApplication

# By how much windows that lie on each other are apart: the title of the lower one stays in sight.
CASCADE_PX = 36
# What covers the panel is so much worse than what covers another window.
_PANEL_COUNTS = 20


class Taken(NamedTuple):
    """What is on the screen: the panel's window, of it what has to stay in sight, the others."""

    panel: QRect
    keep: QRect
    others: Tuple[QRect, ...] = ()


def free_place(screen, wanted, least, taken):
    """Return the rectangle for a new window.

    Beside everything where that fits, smaller than wanted if need be; else over other windows but
    never over the panel; else over the panel, but not over what has to stay in sight. It lies
    exactly on no other.

    :param screen: the area there is (``QRect``)
    :param wanted: the size it would like to have (``QSize``)
    :param least: the size it needs
    :param taken: :class:`Taken`
    """
    wanted = QSize(wanted).expandedTo(least)
    fitting = _fitting(screen, (taken.panel, taken.keep) + tuple(taken.others), least)
    if fitting:
        # As large as may be; of equal ones the first in reading order.
        area, size = max(((area, _share(area, wanted, least)) for area in fitting),
                         key=lambda found: (_surface(found[1]), -found[0].y(), -found[0].x()))
        return QRect(area.topLeft(), size)
    for obstacles in ((taken.panel, taken.keep), (taken.keep,), ()):
        areas = _fitting(screen, obstacles, least)
        if areas:
            return _cascaded(areas, wanted, least, taken)
    return QRect(screen.topLeft(), wanted.boundedTo(screen.size()))


def _surface(size):
    return size.width() * size.height()


def _fitting(screen, obstacles, least):
    """Return the largest free rectangles in which a size fits."""
    areas = [QRect(screen)]
    for obstacle in obstacles:
        areas = _without(areas, obstacle)
    return [area for area in areas
            if area.width() >= least.width() and area.height() >= least.height()]


def _without(areas, obstacle):
    """Return the largest rectangles that are left of some when one is taken out."""
    left = []
    for area in areas:
        cut = area.intersected(obstacle)
        if cut.isEmpty():
            left.append(area)
            continue
        left += [piece for piece in (
            QRect(area.topLeft(), QPoint(area.right(), cut.top() - 1)),
            QRect(area.topLeft(), QPoint(cut.left() - 1, area.bottom())),
            QRect(QPoint(cut.right() + 1, area.top()), area.bottomRight()),
            QRect(QPoint(area.left(), cut.bottom() + 1), area.bottomRight()))
            if piece.isValid()]
    return [area for index, area in enumerate(left) if not any(
        other.contains(area) and (other != area or at < index) for at, other in enumerate(left))]


def _share(area, wanted, least):
    """Return the size of a window in an area, so that others of its kind find room beside it."""
    return QSize(_part(area.width(), wanted.width(), least.width()),
                 _part(area.height(), wanted.height(), least.height()))


def _part(room, wanted, least):
    """Return what one of several windows gets of a length."""
    count = min(math.ceil(room / wanted), room // least)
    return max(least, min(wanted, room // max(1, count)))


def _cascaded(areas, wanted, least, taken):
    """Return the place in one of the areas that covers least, and is apart from other windows."""
    corners = [rect.topLeft() for rect in taken.others]
    titles = [QRect(rect.topLeft(), QSize(rect.width() // 2, CASCADE_PX))
              for rect in taken.others]
    places = []
    for area in areas:
        # Over the panel a window is as small as it can be, elsewhere it leaves room to step down.
        size = least if area.intersects(taken.panel) else \
            (_share(area, wanted, least) - QSize(0, CASCADE_PX)).expandedTo(least)
        right, bottom = area.right() - size.width() + 1, area.bottom() - size.height() + 1
        # From both sides, so that a window can go to every corner.
        across = set(range(area.left(), right + 1, CASCADE_PX)) | set(
            range(right, area.left() - 1, -CASCADE_PX))
        for y in [*range(area.top(), bottom + 1, CASCADE_PX), bottom]:
            places += [QRect(QPoint(x, y), size) for x in across]

    def cost(place):
        """Return what a place covers: one on another window comes last.

        A title that is covered counts as much as a strip of the panel.
        """
        near = sum((corner - place.topLeft()).manhattanLength() < CASCADE_PX
                   for corner in corners)
        cuts = [_surface(place.intersected(rect).size()) if place.intersects(rect) else 0
                for rect in (taken.keep, taken.panel) + tuple(taken.others)]
        hidden = sum(place.intersects(title) for title in titles)
        strips = cuts[1] + hidden * CASCADE_PX * place.height()
        return near, cuts[0], _PANEL_COUNTS * strips + sum(cuts[2:]), place.y(), place.x()

    return min(places, key=cost)


def frame_margins(window):
    """Return the frame (``QMargins``) that the window manager draws around a window on show."""
    outer, inner = window.frameGeometry(), window.geometry()
    return QMargins(inner.left() - outer.left(), inner.top() - outer.top(),
                    outer.right() - inner.right(), outer.bottom() - inner.bottom())


def place_window(window, panel, others):
    """Put a window that is not on show yet where :func:`free_place` finds room.

    :param panel: :class:`mhri.gui.screen.panel.PanelWidget`
    :param others: the windows that are there
    """
    host = panel.window()
    screen = QGuiApplication.screenAt(host.geometry().center()) or QGuiApplication.primaryScreen()
    # A window that has just been shown has no frame yet, and one that has not never had: all have
    # that of the panel.
    margins = frame_margins(host)
    beside = QSize(margins.left() + margins.right(), margins.top() + margins.bottom())
    taken = Taken(host.frameGeometry(), panel.keep_in_sight(), tuple(
        other.frameGeometry() if other.frameGeometry() != other.geometry()
        else other.geometry().marginsAdded(margins)
        for other in others if other.isVisible() and not other.isMinimized()))
    place = free_place(screen.availableGeometry(), window.sizeHint() + beside,
                       window.minimumSizeHint() + beside, taken)
    window.resize(place.size() - beside)
    window.move(place.topLeft())
