# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Screens with robots that nobody drives, to be looked at pixel by pixel."""
import numpy as np
from python_qt_binding.QtCore import QPoint, QRect, Qt
from python_qt_binding.QtGui import QImage

from mhri.base import views
from mhri.camera.images import Frame
from mhri.screen.gui.screen import ScreenWidget
from mhri.screen.gui.windows import TurtleBotWindow

TINY, SMALL, LARGE = (1024, 600), (1280, 720), (1920, 1080)
# A colour that nothing else on the screen has, also where the header darkens it.
MAGENTA = (220, 0, 220)
KINDS = {
    'plain': {}, 'long': {'long_names': True}, 'group': {'group': True}, 'stopped': {'stop': True}}


def place_in(window, widget):
    """Return the rectangle of a widget in its window."""
    return QRect(widget.mapTo(window, QPoint(0, 0)), widget.size())


def frame_of(colour, size=(640, 480)):
    """Return a picture of one colour."""
    rgb = np.zeros((size[1], size[0], 3), np.uint8)
    rgb[:] = colour
    return Frame(kind='rgb', rgb=rgb, depth_m=None, depth_range_m=None, full_size=size)


def robots_of(count, long_names=False, group=False, stop=False):
    """Return so many robots: the first driven, the third lost, the fifth with a flat battery."""
    robots = []
    for number in range(1, count + 1):
        more = {'selected': number == 1 or group and number <= 3, 'driven': number == 1}
        if number == 3:
            more.update(link=views.GONE,
                        note='nothing heard for 12 s: switched off, or out of reach')
        if number == 5:
            more.update(battery=0.12)
        if stop:
            more.update(driven=False,
                        proof=views.ProofView(views.PROOF_STOPPED, 'stopped in 20 ms'))
        robots.append(views.RobotView(**{**dict(
            name='{}{}'.format('inspection_crawler_' if long_names else 'bot', number),
            type_label='TurtleBot2', number=number, link=views.LIVE, age_s=0.012, linear_mps=0.38,
            angular_rad_s=-0.8, heading_rad=0.8, battery=0.82, x_m=1.0, y_m=2.0,
            max_linear_mps=0.65, max_angular_rad_s=3.14), **more}))
    return tuple(robots)


class Scene:
    """A screen with robots that nobody drives."""

    def __init__(self, application, ui_dir, size, count, mode='joy', **kind):
        self.application = application
        self.screen = ScreenWidget(ui_dir)
        self.screen.setAttribute(Qt.WA_DontShowOnScreen)
        self.screen.resize(*size)
        self.robots = robots_of(count, **kind)
        self.stop = kind.get('stop', False)
        self.view = views.ScreenView(
            ros=views.ROS_CONNECTED, sources=(('joy', 'Virtual joystick'), ('ps3joy', 'Pad')),
            mode=mode, status='driving bot1', robots=self.robots, camera_bits_per_s=12e6,
            stop_all=self.stop)
        self.tiles = {}
        for robot in self.robots:
            tile = TurtleBotWindow(ui_dir, robot.name, robot.type_label, self.screen.stage)
            tile.offer({'rgb', 'scan', 'record'})
            self.tiles[robot.name] = tile

    def show(self):
        """Show it until nothing moves any more, and return the screen."""
        self.screen.show()
        self.screen.show_view(self.view)
        self.screen.stage.show_tiles(self.tiles)
        for _ in range(3):
            self.application.processEvents()
            self.screen.show_view(self.view)
            for robot in self.robots:
                tile = self.tiles[robot.name]
                tile.show_view(robot, self.stop)
                tile.view('rgb').show_frame(self.frame(robot.number))
        self.application.processEvents()
        return self.screen

    def frame(self, number):
        """Return what a robot's camera sees."""
        return frame_of(MAGENTA)

    def pixels(self):
        """Return what is to be seen as an array (row, column, RGB)."""
        return pixels_of(self.screen)


def pixels_of(widget):
    """Return a picture of a widget as an array (row, column, RGB)."""
    image = widget.grab().toImage().convertToFormat(QImage.Format_RGB888)
    bits = image.constBits()
    bits.setsize(image.byteCount())
    rows = np.frombuffer(bits, np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, :3 * image.width()].reshape(image.height(), image.width(), 3).copy()


def colour_at(pixels, widget, window, x, y):
    """Return the colour at a place in a widget as an (R, G, B)."""
    corner = widget.mapTo(window, QPoint(0, 0))
    return tuple(int(part) for part in pixels[corner.y() + y, corner.x() + x])
