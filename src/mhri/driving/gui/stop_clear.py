# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps menus, lists, tips and dialogs of this program off its stop buttons."""
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtWidgets import QApplication

from mhri.driving.gui.stop_button import stop_buttons

_OVER = frozenset((Qt.Popup, Qt.ToolTip, Qt.Dialog, Qt.Sheet))


def stop_areas():
    """Return the area of each stop button on the desktop as a :class:`QRect`."""
    return [_area(button) for button in stop_buttons()]


def _area(button):
    return QRect(button.mapToGlobal(QPoint(0, 0)), button.size())


def press_beneath(event):
    """Press the stop button under a press that an open menu or list received.

    :returns: whether there was a stop button; if so, the menus are closed
    """
    popup = QApplication.activePopupWidget()
    button = None if popup is None else next(
        (button for button in stop_buttons() if _area(button).contains(event.globalPos())), None)
    if button is None:
        return False
    while popup is not None:
        popup.close()
        popup, closed = QApplication.activePopupWidget(), popup
        if popup is closed:
            break
    button.press()
    return True


def desktop_at(place):
    """Return the area of the monitor at a point, as a :class:`QRect`."""
    return (QApplication.screenAt(place) or QApplication.primaryScreen()).availableGeometry()


def room_px(place):
    """Return the maximum height of a menu at a :class:`QPoint` that leaves stop buttons clear."""
    desktop = desktop_at(place)
    return min([area.top() for area in stop_areas() if area.top() > desktop.center().y()
                and desktop.intersects(area)] + [desktop.bottom() + 1]) - desktop.top()


def keep_clear(window):
    """Move a window that would cover a stop button to the nearest free place.

    Without a free place, it is reduced to the height above the button.
    """
    if window.windowType() not in _OVER:
        return
    box, areas = window.geometry(), stop_areas()
    covered = [area for area in areas if area.intersects(box)]
    if not covered:
        return
    desktop = desktop_at(box.center())
    places = [QPoint(box.x(), area.top() - box.height()) for area in areas]
    places += [QPoint(box.x(), area.bottom() + 1) for area in areas]
    places += [QPoint(area.right() + 1, box.y()) for area in areas]
    places += [QPoint(area.left() - box.width(), box.y()) for area in areas]
    free = [place for place in places if _is_free(QRect(place, box.size()), areas, desktop)]
    if free:
        window.move(min(free, key=lambda place: (place - box.topLeft()).manhattanLength()))
        return
    low = min(covered, key=lambda area: area.top())
    window.setFixedHeight(max(1, min(box.height(), low.top() - desktop.top())))
    window.move(box.x(), max(desktop.top(), low.top() - window.height()))


def _is_free(box, areas, desktop):
    """Return whether a rectangle is on the desktop and covers no stop button."""
    return desktop.contains(box) and not any(area.intersects(box) for area in areas)
