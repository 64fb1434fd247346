# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The real panel in this process, on a screen and a master of its own, with simulated robots."""
import subprocess
import sys

import numpy as np
from python_qt_binding.QtCore import QEvent
from python_qt_binding.QtGui import QImage
from python_qt_binding.QtWidgets import QApplication

from support.ros_system import System, wait_for

START_S = 60.0


class PanelSession:
    """An operator at the panel; every process and the screen belong to it alone.

    :param launches: the words of one roslaunch each, e.g. ``('sim.launch', 'n:=2')``
    :param robots: the names of the robots that these bring
    """

    #: "localhost": the screen is reached over the network
    display_host = ''

    def __init__(self, launches, robots):
        self.system = System()
        self.presenter = None
        try:
            self._start(launches, robots)
        except BaseException:
            self.close(*sys.exc_info())
            raise

    def _start(self, launches, robots):
        from mhri.screen.presenters.demo import Hands
        from mhri.screen.presenters.screen_presenter import ScreenPresenter
        from mhri.screen.ros.backend import ScreenBackend
        # Before there is an application: it takes the screen that is named then.
        self.system.screen(host=self.display_host)
        self.system.start_master()
        self.system.node('mux', '__name:=mux', *self.mux_words())
        for words in launches:
            self.system.launch(*words)
        self.bring()
        self.app = QApplication.instance() or QApplication(['panel'])
        self.presenter = ScreenPresenter(ScreenBackend(['panel']))
        self.operator = self.presenter.operator
        self.presenter.screen.resize(1500, 1050)
        self.presenter.screen.show()
        self.hands = Hands(self.presenter.screen)
        self.presenter.start(robots)
        self.until(lambda: all(self._is_known(name) for name in robots), START_S, 'live robots')
        self.until(lambda: self.operator.view().mode, START_S, 'the mux')

    def mux_words(self):
        """Return what else the mux is started with."""
        return ()

    def bring(self):
        """Start what else there shall be, once there is a master."""

    def _is_known(self, name):
        """Return whether a robot is live, as what it is: its type may be known later."""
        view = self.operator.robot_view(name)
        return view.link == 'live' and view.type_label not in ('', 'generic')

    def until(self, condition, timeout_s=START_S, what='the condition'):
        """Let Qt work until a condition comes true; return what is true."""
        return wait_for(condition, timeout_s, what, turn=self.app.processEvents)

    def open(self, name):
        """Look at a robot alone, open its switches, and return its tile."""
        self.until(lambda: name in self.presenter.windows, what='the tile of ' + name)
        if name not in self.operator.selection.selected:
            self.hands.click('check_' + name)
        self.presenter.screen.stage.set_style('one')
        self.presenter.screen.look_at(name)
        tile = self.presenter.windows[name]
        self.until(lambda: tile.isVisible() and tile.header.large, what='the tile to be large')
        tile.views_button.setChecked(True)
        self.until(lambda: self.operator.feeds(name) is not None, what='the feeds of ' + name)
        return tile

    def switch(self, window, name, on=True):
        """Click one of a window's switches where it is not as it shall be."""
        if self.hands.widget(name, window).isChecked() != on:
            self.hands.click(name, window)
        assert self.hands.widget(name, window).isChecked() == on

    def picture(self, window, kind):
        """Show a camera's picture by its switch, close the switches over it, await a live one."""
        self.switch(window, 'camera_' + kind)
        window.views_button.setChecked(False)
        camera = window.view('rgb')
        self.until(lambda: camera.picture.frame is not None and camera.picture.frame.kind == kind
                   and not camera.picture.warning, what='the {} picture'.format(kind))
        return camera.picture

    def point_at(self, widget, x, y):
        """Move the pointer of the X server to a place of a widget [px]."""
        place = widget.mapToGlobal(widget.rect().topLeft())
        subprocess.run(['xdotool', 'mousemove', '--sync', str(place.x() + round(x)),
                        str(place.y() + round(y))], check=True, timeout=START_S)

    def seen(self, widget):
        """Return what the screen shows where a widget is: uint8 (h, w, 3), red, green, blue.

        It is read from the X server: what another window covers is not the widget's.
        """
        self.app.processEvents()
        place = widget.mapToGlobal(widget.rect().topLeft())
        image = self.app.primaryScreen().grabWindow(
            0, place.x(), place.y(), widget.width(), widget.height()).toImage()
        return pixels(image)

    def close(self, *failure):
        """End everything that was started."""
        import rospy
        if self.presenter is not None:
            self.presenter.close()
            # Before the application, which goes with this object.
            self.presenter.screen.deleteLater()
            self.app.sendPostedEvents(None, QEvent.DeferredDelete)
        rospy.signal_shutdown('done')
        self.system.__exit__(*(failure or (None, None, None)))


def pixels(image):
    """Return the pixels of a ``QImage`` as uint8 (h, w, 3), red, green, blue."""
    image = image.convertToFormat(QImage.Format_RGB888)
    data = image.constBits().asstring(image.byteCount())
    rows = np.frombuffer(data, np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, :3 * image.width()].reshape(image.height(), image.width(), 3).copy()
