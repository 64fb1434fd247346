# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Nothing of the program ever lies over STOP ALL: menus, lists, tips, dialogs."""
import pytest
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QDialog, QMenu, QToolTip
from support.keyboard import xdotool
from support.maps import BOT1, BOT2, pixel

from mhri.base.gui import theme
from mhri.base.geometry import Pose
from mhri.base.views import RobotView
from mhri.driving.gui import robot_menu
from mhri.map.gui.map_pane import MapPane
from mhri.map.scene import MapMark, Scene
from mhri.screen.gui.stage import MAP_LARGE
from mhri.screen.gui.windows import TurtleBotWindow

SCENE = Scene(robots=(BOT1, BOT2), marks=(MapMark('dock', Pose(0.5, 1.0, 0.0)),),
              fence=((-1.0, -1.0), (3.0, -1.0), (3.0, 2.0)))


@pytest.fixture
def on_map(application, operator, ui_dir):
    """Return a maker of screens that show the map large, on a monitor of the screen's size."""
    from mhri.screen.gui.screen import ScreenWidget
    before, made = application.font(), []

    def make(size, font):
        application.setFont(theme.larger(before, font))
        screen = ScreenWidget(ui_dir)
        made.append(screen)
        application.installEventFilter(screen.drive_keys)
        # At the lower end of the monitor: there is no room below STOP ALL.
        desktop = application.primaryScreen().geometry()
        screen.setGeometry(QRect(QPoint(0, desktop.height() - size[1]), screen.size()))
        screen.resize(*size)
        operator.show(screen)
        tile = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2', screen.stage)
        screen.stage.show_tiles({'bot1': tile})
        pane = MapPane(screen.stage)
        screen.stage.set_map(pane)
        pane.robot_menu_requested.connect(screen.robot_menu.open)
        # As many rows as a robot has with three others on the map, and one on a task.
        screen.robot_menu.offer(robot_menu.PLACE, lambda *_: [
            ('row {}'.format(number), print) for number in range(10)])
        screen.robot_menu.show_robots((RobotView('bot1'), RobotView('bot2')))
        screen.stage.show_map(MAP_LARGE)
        operator.settle()
        pane.show_scene(SCENE)
        pane.view.fit()
        operator.settle()
        return screen, pane
    yield make
    for screen in made:
        application.removeEventFilter(screen.drive_keys)
    application.setFont(before)


def stop_area(screen):
    """Return where STOP ALL is on the desktop."""
    button = screen.stop_bar.stop_button
    assert button.isVisible()
    return QRect(button.mapToGlobal(QPoint(0, 0)), button.size())


@pytest.mark.parametrize('size, font', [((1280, 720), 1.0), ((1024, 600), 2.0)])
def test_no_menu_of_the_map_covers_stop_all(on_map, operator, size, font):
    screen, pane = on_map(size, font)
    view = pane.view
    places = [QPoint(x, y) for x in (4, view.width() // 2, view.width() - 4)
              for y in (view.height() - 3, view.height() // 2)]
    for place in [*places, pixel(pane, 2.0, 1.0), pixel(pane, 0.5, 1.0)]:
        QTest.mousePress(view, Qt.RightButton, Qt.NoModifier, place)
        operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
        menu = QApplication.activePopupWidget()
        operator.settle()
        assert not menu.geometry().intersects(stop_area(screen))
        assert menu.actionGeometry(menu.actions()[-1]).bottom() <= menu.height(), 'all rows'
        menu.close()
        operator.settle()
    operator.click(pane.fit_button)
    operator.settle()
    menu = QApplication.activePopupWidget()
    if menu is not None:
        assert not menu.geometry().intersects(stop_area(screen))
        menu.close()


def test_nothing_else_of_the_program_covers_it(on_map, operator):
    screen, pane = on_map((1024, 600), 1.0)
    area = stop_area(screen)
    # The tip first: it goes where the window is inactive for a moment, as when a menu closes.
    QToolTip.showText(area.center() - QPoint(0, 30), 'a tip\nof some\nlines', screen)
    operator.settle()
    tips = [widget for widget in QApplication.topLevelWidgets()
            if widget.windowType() == Qt.ToolTip and widget.isVisible()]
    assert tips and not any(tip.geometry().intersects(area) for tip in tips)
    QToolTip.hideText()
    menu, dialog = QMenu(screen), QDialog(screen)
    for number in range(4):
        menu.addAction('row {}'.format(number))
    menu.popup(area.center())
    operator.settle()
    assert not menu.geometry().intersects(area)
    menu.close()
    dialog.resize(300, 200)
    dialog.move(area.topLeft())
    dialog.show()
    operator.settle()
    assert not dialog.geometry().intersects(area)
    dialog.close()
    screen.mode_combo.showPopup()
    operator.settle()
    popup = QApplication.activePopupWidget()
    assert popup is None or not popup.geometry().intersects(area)
    screen.mode_combo.hidePopup()


def test_a_press_on_it_stops_while_a_menu_is_open(on_map, operator, heard):
    screen, pane = on_map((1280, 720), 1.0)
    stopped = heard(screen.stop_requested)
    QTest.mousePress(pane.view, Qt.RightButton, Qt.NoModifier, pixel(pane, 1.0, -0.5))
    operator.wait_until(lambda: QApplication.activePopupWidget() is not None)
    place = stop_area(screen).center()
    xdotool('mousemove', place.x(), place.y(), 'click', 1)
    operator.wait_until(lambda: stopped)
