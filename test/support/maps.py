# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots on a map, and a hand that clicks and drags at places of it."""
from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt
from python_qt_binding.QtGui import QMouseEvent
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

from mhri.base.gui import theme
from mhri.base.geometry import Pose
from mhri.map.gui.map_pane import MapPane
from mhri.map.scene import MapRobot, Scene

BOT1 = MapRobot('bot1', 1, Pose(0.0, 0.0, 0.0), looked_at=True, state='standing',
                text='placed by hand')
BOT2 = MapRobot('bot2', 2, Pose(2.0, 1.0, 1.0), state='patrol', text='placed by tf',
                task='Patrol')
LOOSE = MapRobot('bot3', 3, None, state='standing', text='not placed: place it by hand')
SCENE = Scene('map', (BOT1, BOT2, LOOSE))


def map_pane(operator):
    """Return a map on the screen with two robots on it, and one that is not."""
    widget = MapPane()
    theme.apply(widget, theme.DARK)
    widget.resize(900, 700)
    operator.show(widget)
    widget.show_scene(SCENE)
    return widget


def pixel(pane, x_m, y_m):
    """Return the pixel of a place."""
    return QPoint(*map(round, pane.view.canvas.pixel(x_m, y_m)))


def move(view, where, buttons=Qt.LeftButton):
    """Move the pointer; the one of Qt's tests moves the real one, whose button nobody holds."""
    QApplication.sendEvent(view, QMouseEvent(QEvent.MouseMove, QPointF(where), Qt.NoButton, buttons,
                                             Qt.NoModifier))


def drag(pane, start, end):
    """Drag with the left button from a place [m] to another."""
    view = pane.view
    QTest.mousePress(view, Qt.LeftButton, Qt.NoModifier, pixel(pane, *start))
    move(view, pixel(pane, *end))
    QTest.mouseRelease(view, Qt.LeftButton, Qt.NoModifier, pixel(pane, *end))


def click(pane, x_m, y_m):
    """Click at a place."""
    QTest.mouseClick(pane.view, Qt.LeftButton, Qt.NoModifier, pixel(pane, x_m, y_m))


def open_menu(operator):
    """Wait until a menu is open; return {words: action} of it."""
    operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
    return {action.text(): action for action in QApplication.activePopupWidget().actions()
            if not action.isSeparator()}


def choose(operator, action):
    """Click a row of the open menu."""
    menu = QApplication.activePopupWidget()
    QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier, menu.actionGeometry(action).center())
    operator.wait_until(lambda: QApplication.activePopupWidget() is None)
