# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A real Qt on a real X server for every GUI test: the one at hand, else an Xvfb of our own.

With ``MHRI_OWN_SCREEN`` it is always one of our own, so that files may run at the same time.
"""
import atexit
import os

import pytest

from support.paths import RESOURCE
from support.xvfb import start_xvfb

# Before the first import of Qt by a test module.
if not os.environ.get('DISPLAY') or os.environ.get('MHRI_OWN_SCREEN'):
    _server, os.environ['DISPLAY'] = start_xvfb()
    atexit.register(_server.terminate)
os.environ['QT_QPA_PLATFORM'] = 'xcb'

from python_qt_binding.QtCore import (  # noqa: E402
    QElapsedTimer, QEvent, QEventLoop, QPointF, Qt, QTimer)
from python_qt_binding.QtGui import QKeyEvent, QMouseEvent  # noqa: E402
from python_qt_binding.QtTest import QTest  # noqa: E402
from python_qt_binding.QtWidgets import QApplication  # noqa: E402

from mhri.base import views  # noqa: E402

SOURCES = (('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller'), ('voice', 'Voice'))


class Operator:
    """Hands and eyes: clicks, keys, and waiting for what they lead to."""

    def __init__(self, application):
        self.application = application

    def wait_until(self, condition, within_s=60.0):
        """Run the event loop until a condition holds; fail after a deadline."""
        timer, watch = QTimer(), QElapsedTimer()
        timer.start(5)
        watch.start()
        while not condition():
            assert watch.elapsed() < within_s * 1000, 'waited in vain'
            self.application.processEvents(QEventLoop.WaitForMoreEvents)

    def settle(self):
        """Deliver every event there is."""
        for _ in range(5):
            self.application.processEvents()

    def show(self, widget):
        """Show a window and give it the keyboard, whether or not there is a window manager."""
        widget.show()
        widget.activateWindow()
        self.wait_until(widget.isActiveWindow)
        return widget

    @staticmethod
    def key(widget, kind, key, scan=0, modifiers=Qt.NoModifier, repeat=False):
        """Send one key event, with a native scan code as a keyboard has it."""
        event = QKeyEvent(kind, int(key), modifiers, scan, 0, 0, '', repeat)
        QApplication.sendEvent(widget, event)

    def press(self, widget, key, scan=0, modifiers=Qt.NoModifier, repeat=False):
        """Press a key."""
        self.key(widget, QKeyEvent.KeyPress, key, scan, modifiers, repeat)

    def release(self, widget, key, scan=0, modifiers=Qt.NoModifier, repeat=False):
        """Let a key go."""
        self.key(widget, QKeyEvent.KeyRelease, key, scan, modifiers, repeat)

    def hit(self, widget, key, scan=0, modifiers=Qt.NoModifier):
        """Press a key and let it go."""
        self.press(widget, key, scan, modifiers)
        self.release(widget, key, scan, modifiers)

    @staticmethod
    def click(widget, pos=None):
        """Click with the left button."""
        QTest.mouseClick(widget, Qt.LeftButton, Qt.NoModifier, pos or widget.rect().center())


class Finger:
    """A touch event and its one point: PyQt can make neither, and Xvfb has no touch screen."""

    def __init__(self, kind, state, x, y, identity):
        self._kind, self._state, self._pos, self._identity = kind, state, QPointF(x, y), identity
        self.accepted = False

    def type(self):
        """Return the type of the event."""
        return self._kind

    def accept(self):
        """Note that the event was taken."""
        self.accepted = True

    def touchPoints(self):  # noqa: N802
        """Return the points of the event."""
        return [self]

    def id(self):
        """Return the identity of the point."""
        return self._identity

    def pos(self):
        """Return the place of the point in its widget."""
        return self._pos

    def state(self):
        """Return the state of the point."""
        return self._state


def touch(widget, kind, state, x, y, identity=1):
    """Hand a touch to the event handler of a widget; it has to take it."""
    finger = Finger(kind, state, x, y, identity)
    assert widget.event(finger) and finger.accepted


class Heard(list):
    """What a signal said: a list of the tuples (or of the value where there is one)."""

    def __init__(self, signal):
        super().__init__()
        signal.connect(lambda *args: self.append(args if len(args) != 1 else args[0]))


@pytest.fixture(scope='session')
def application():
    """Return the one QApplication, in the style that needs no desktop."""
    made = QApplication.instance() or QApplication(['mhri-test', '-style', 'Fusion'])
    yield made
    made.processEvents()


@pytest.fixture
def operator(application):
    """Return the operator; closes and deletes every window afterwards."""
    yield Operator(application)
    for widget in application.topLevelWidgets():
        widget.close()
        widget.deleteLater()
    application.sendPostedEvents(None, QEvent.DeferredDelete)
    application.processEvents()


@pytest.fixture(scope='session')
def ui_dir():
    """Return the folder of the forms."""
    return str(RESOURCE)


@pytest.fixture
def heard():
    """Return the recorder of signals."""
    return Heard


@pytest.fixture
def four_robots():
    """Return a view of four robots, one in each link state."""
    return views.ScreenView(
        ros=views.ROS_CONNECTED, sources=SOURCES, mode='joy', status='driving bot1',
        robots=(
            views.RobotView('bot1', 'TurtleBot2', link=views.LIVE, age_s=0.012, linear_mps=0.31,
                            angular_rad_s=0.2, battery=0.82, selected=True, driven=True, number=1),
            views.RobotView('bot2', 'TurtleBot3', link=views.WAITING, number=2),
            views.RobotView('bot3', 'TurtleBot2', link=views.SILENT, age_s=3.2,
                            note='nothing for 3.2 s', number=3),
            views.RobotView('bot4', 'generic', link=views.GONE, note='master lost it', number=4)))


@pytest.fixture
def panel(operator, ui_dir, application):
    """Return a panel on the screen with the keyboard, its keys installed as the host does."""
    from mhri.screen.gui.screen import ScreenWidget
    widget = ScreenWidget(ui_dir)
    widget.resize(1280, 960)
    application.installEventFilter(widget.drive_keys)
    operator.show(widget)
    yield widget
    application.removeEventFilter(widget.drive_keys)


@pytest.fixture(name='touch')
def touch_fixture():
    """Return the function that touches a widget."""
    return touch


@pytest.fixture
def drag():
    """Return a function that drags a joystick's knob: to the right and ahead, in radii."""
    def drag_to(joystick, across, along, press=True):
        middle, travel = joystick.pad().center().toPoint(), joystick.travel()
        target = QPointF(middle.x() + across * travel, middle.y() - along * travel)
        if press:
            QTest.mousePress(joystick, Qt.LeftButton, Qt.NoModifier, middle)
        # QTest.mouseMove moves the real pointer, whose button nobody holds.
        QApplication.sendEvent(joystick, QMouseEvent(
            QEvent.MouseMove, target, Qt.NoButton, Qt.LeftButton, Qt.NoModifier))
    return drag_to


@pytest.fixture
def scene(application, operator, ui_dir):
    """Return a maker of scenes."""
    # Not before it is wanted: it loads the whole screen.
    from mhri.base.gui import theme
    from support.scenes import Scene
    before = application.font()

    def make(size, count, font=1.0, **more):
        application.setFont(theme.larger(before, font))
        return Scene(application, ui_dir, size, count, **more)
    yield make
    application.setFont(before)
