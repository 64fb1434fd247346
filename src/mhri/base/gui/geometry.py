# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The geometry of a window as plain numbers: [x, y, width, height, maximised], in pixels."""
from python_qt_binding.QtCore import QRect, Qt
from python_qt_binding.QtGui import QGuiApplication


# Maximum share of the smallest monitor for a window: its frame has to fit as well.
_DEMANDED = 0.9


def fitting(size):
    """Return a :class:`QSize` reduced to fit every monitor, including the window's frame."""
    for screen in QGuiApplication.screens():
        size = size.boundedTo(screen.availableGeometry().size() * _DEMANDED)
    return size


def geometry_of(window):
    """Return the geometry of a window; if it is maximised, the one before that."""
    maximised = window.isMaximized()
    usual = window.normalGeometry()
    rect = usual if maximised and usual.isValid() else window.geometry()
    return [rect.x(), rect.y(), rect.width(), rect.height(), maximised]


def restore_geometry(window, geometry):
    """Restore the position of a window; return False if its screen no longer exists.

    The window is reduced to fit the screen, and moved into it.

    :param geometry: result of :func:`geometry_of`, checked by
        :func:`mhri.screen.saved_state.read_geometry`
    """
    *numbers, maximised = geometry
    rect = QRect(*numbers)
    areas = [screen.availableGeometry() for screen in QGuiApplication.screens()]
    area = max(areas, key=lambda area: _shared(area, rect), default=None)
    if area is None or not _shared(area, rect):
        return False
    rect.setSize(rect.size().boundedTo(area.size()))
    rect.moveLeft(max(area.left(), min(rect.left(), area.right() - rect.width() + 1)))
    rect.moveTop(max(area.top(), min(rect.top(), area.bottom() - rect.height() + 1)))
    window.setGeometry(rect)
    if maximised:
        window.setWindowState(window.windowState() | Qt.WindowMaximized)
    return True


def in_sight(geometry):
    """Return whether the centre of a window is on an existing screen.

    :param geometry: result of :func:`geometry_of`
    """
    middle = QRect(*geometry[:4]).center()
    return any(screen.geometry().contains(middle) for screen in QGuiApplication.screens())


def place_on_another_screen(window, main):
    """Move a new window to a screen without the main window, if there is one.

    :param main: the other window
    """
    middle = main.geometry().center()
    others = [screen.availableGeometry() for screen in QGuiApplication.screens()
              if not screen.geometry().contains(middle)]
    if others:
        rect = QRect(others[0].topLeft(), window.size().boundedTo(others[0].size()))
        rect.moveCenter(others[0].center())
        window.setGeometry(rect)


def _shared(area, rect):
    """Return the area of the intersection of two rectangles [px]."""
    common = area.intersected(rect)
    return common.width() * common.height() if common.isValid() else 0
