# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted drive without hands, with the real panel, buttons, keys and stick.

Looks for robots, selects two of three, drives both, changes the selection while they move, and
stops all. It waits for what the robots' own odometry shows, never for a fixed time, and ends at the
first step that fails.
"""
from concurrent.futures import ThreadPoolExecutor
import math
import os
import time

from python_qt_binding.QtCore import QEvent, QObject, QPoint, QPointF, Qt, QTimer
from python_qt_binding.QtGui import QKeyEvent, QMouseEvent
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.core.screen.views import LIVE, PROOF_STOPPED
from mhri.gui.screen.stale_cover import StaleCover

POLL_MS = 50
# Endings of the bottom line.
CENTRE, READY = 'centre the stick to drive', 'ready'
PATIENCE_S = 20.0


class DemoFailed(Exception):
    """A step did not succeed in time; the text says which."""


class Hands:
    """A simulated mouse and keyboard: events as the window system sends them.

    :param panel: :class:`mhri.gui.screen.screen.ScreenWidget`
    """

    def __init__(self, panel):
        self._panel = panel

    def widget(self, name, window=None):
        """Return a widget of the panel, or of another window, by its object name.

        :raises DemoFailed: there is none
        """
        found = (window or self._panel).findChild(QWidget, name)
        if found is None:
            raise DemoFailed('there is no visible {}'.format(name))
        return found

    def click(self, name, window=None):
        """Press and release the left button in the middle of a widget."""
        widget = self.widget(name, window)
        point = widget.rect().center()
        self._mouse(widget, QEvent.MouseButtonPress, point, Qt.LeftButton)
        self._mouse(widget, QEvent.MouseButtonRelease, point, Qt.NoButton)

    def hold_stick(self, forward, turn):
        """Take the virtual joystick and hold it at fractions in [-1, 1]."""
        stick = self.widget('joystick')
        centre = stick.rect().center()
        travel = stick.travel()
        target = centre + QPoint(round(-turn * travel), round(-forward * travel))
        self._mouse(stick, QEvent.MouseButtonPress, centre, Qt.LeftButton)
        self._mouse(stick, QEvent.MouseMove, target, Qt.LeftButton)

    def let_go(self):
        """Release the virtual joystick."""
        stick = self.widget('joystick')
        self._mouse(stick, QEvent.MouseButtonRelease, stick.rect().center(), Qt.NoButton)

    def press_stop_keys(self):
        """Press Shift and the space bar."""
        for kind in (QEvent.KeyPress, QEvent.KeyRelease):
            event = QKeyEvent(kind, Qt.Key_Space, Qt.ShiftModifier, ' ')
            QApplication.sendEvent(self._panel, event)

    @staticmethod
    def _mouse(widget, kind, point, buttons):
        button = Qt.NoButton if kind == QEvent.MouseMove else Qt.LeftButton
        where = QPointF(point)
        QApplication.sendEvent(widget, QMouseEvent(
            kind, where, QPointF(widget.mapToGlobal(point)), button, buttons, Qt.NoModifier))


class Grip:
    """Holds something (stick or key) until a condition is true.

    If the mux asks for a centred stick meanwhile (a computer that stalled for half a second looks
    like a silent source), it does what an operator does: it lets go and takes hold again.

    :param take: function that takes it
    :param let_go: function that lets it go
    :param status: function that returns the panel's bottom line
    :param condition: what to wait for
    """

    def __init__(self, take, let_go, status, condition):
        self._take = take
        self._let_go = let_go
        self._status = status
        self._condition = condition
        self._held = None

    def __call__(self):
        """Look, and return whether the condition is true."""
        if self._held is None:
            self._held = True
            self._take()
        if self._condition():
            return True
        status = self._status()
        if self._held and status.endswith(CENTRE):
            self._held = False
            self._let_go()
        elif not self._held and status.endswith(READY):
            self._held = True
            self._take()
        return False


class Diary:
    """What each robot did, from its own odometry: path [m], turning [rad], fastest [m/s]."""

    def __init__(self):
        self._last = {}
        self.robots = {}

    def note(self, views):
        """Take in the :class:`RobotView` of all robots."""
        for view in views:
            if view.x_m is None:
                continue
            entry = self.robots.setdefault(view.name, {'path': 0.0, 'turned': 0.0, 'top': 0.0,
                                                       'type': view.type_label, 'stop': ''})
            before = self._last.get(view.name, view)
            entry['path'] += math.hypot(view.x_m - before.x_m, view.y_m - before.y_m)
            turn = view.heading_rad - before.heading_rad
            entry['turned'] += abs(math.atan2(math.sin(turn), math.cos(turn)))
            entry['top'] = max(entry['top'], abs(view.linear_mps))
            if view.proof:
                entry['stop'] = view.proof.text
            self._last[view.name] = view

    def lines(self):
        """Return one sentence for each robot."""
        return ['{} ({}): drove {:.2f} m, turned {:.0f} deg, at most {:.2f} m/s; {}'.format(
            name, entry['type'], entry['path'], math.degrees(entry['turned']), entry['top'],
            entry['stop'] or 'no stop') for name, entry in sorted(self.robots.items())]


class Demo(QObject):
    """Plays the script on the GUI thread, one step whenever its condition is true.

    :param program: :class:`mhri.standalone.Standalone`
    :param screenshot: where to write a picture of the screen while the robots move, and those of
        parts of it (``<screenshot>_panel.png``, ...); None for none
    :param result: where to write ``ok`` or the reason why not, or None
    """

    def __init__(self, program, screenshot=None, result=None):
        super().__init__()
        self._program = program
        self._operator = program.host.operator
        self._hands = Hands(program.host.screen)
        self._screenshot = screenshot
        self._result = result
        self._diary = Diary()
        self._script = self._steps()
        self._waiting = None
        # Writing a picture takes longer than the stick may be silent.
        self._writer = ThreadPoolExecutor(max_workers=1)
        self._written = []
        self.exit_status = 1
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._poll)

    def start(self):
        """Begin, on all of the screen; the program ends by itself."""
        window = self._program.window
        window.setGeometry(window.screen().availableGeometry())
        self._timer.start(POLL_MS)

    def _robot(self, name):
        return self._operator.robot_view(name)

    def _moves(self, *names):
        return lambda: all(self._robot(name).moving for name in names)

    def _rests(self, *names):
        return lambda: all(self._robot(name).link == LIVE and not self._robot(name).moving
                           for name in names)

    def _reads(self, words):
        """Return a condition: the bottom line ends with these words."""
        return lambda: self._operator.view().status.endswith(words)

    @staticmethod
    def _both(one, other):
        return lambda: one() and other()

    def _hold(self, forward, turn, condition):
        """Return a condition that drives until another condition is true."""
        return Grip(lambda: self._hands.hold_stick(forward, turn), self._hands.let_go,
                    lambda: self._operator.view().status, condition)

    def _found_three(self):
        """Return a condition: three robots are live; it looks again every second until then."""
        looked_at = [-math.inf]

        def found():
            if sum(robot.link == LIVE for robot in self._operator.view().robots) >= 3:
                return True
            if time.monotonic() - looked_at[0] > 1.0:
                looked_at[0] = time.monotonic()
                self._hands.click('look_button')
            return False

        return found

    @staticmethod
    def _views_open(tile):
        """Return a condition: a tile's switches are below its header, and the tile is drawn."""
        return lambda: tile.switches.mapTo(tile, QPoint(0, 0)).y() >= tile.header.height() \
            and not any(cover.isVisible() for cover in tile.findChildren(StaleCover))

    def _all_drawn(self):
        """Return a condition: no part of the screen stands still."""
        return lambda: not any(cover.isVisible() for cover in
                               self._program.host.screen.findChildren(StaleCover))

    def _travelled(self, name, metres):
        """Return a condition: the robot has driven this far from here."""
        begun = self._diary.robots[name]['path']
        return lambda: self._diary.robots[name]['path'] - begun >= metres

    def _steps(self):
        """Yield (what to wait for, condition)."""
        hands, operator = self._hands, self._operator
        yield 'the mux to be there', lambda: operator.view().mode is not None
        yield 'three robots to be found and live', self._found_three()
        one, two, three = operator.selection.robots[:3]
        self._say('found {}'.format(', '.join(operator.selection.robots)))
        hands.click('check_' + one)
        hands.click('check_' + two)
        yield 'the windows of both to open', lambda: {one, two} <= set(self._program.host.windows)
        host = self._program.host
        hands.click('camera_depth', host.windows[one])
        hands.click('camera_rgb', host.windows[two])
        self._say('selected {} and {}: driving both'.format(one, two))
        yield 'the panel to be ready', self._reads(READY)
        yield '{} and {} to move'.format(one, two), self._hold(
            0.4, 0.0, self._both(self._travelled(one, 0.25), self._moves(one, two)))
        yield '{} to drive a bend'.format(two), self._hold(0.4, 0.35, self._travelled(two, 0.2))
        self._take_pictures(depth=host.windows[one])
        self._say('deselecting {} and selecting {} while they move'.format(one, three))
        hands.click('check_' + one)
        hands.click('check_' + three)
        yield 'the panel to ask for a centred stick', self._reads(CENTRE)
        yield '{} to stand still'.format(one), self._rests(one)
        self._say('{} does not leap: the stick must be centred first'.format(three))
        hands.let_go()
        yield 'the panel to be ready', self._reads(READY)
        yield '{} and {} to move'.format(two, three), self._hold(
            0.4, -0.35, self._both(self._travelled(three, 0.3), self._moves(two, three)))
        yield 'every tile to be drawn', self._all_drawn()
        self._take_screenshot()
        self._take_pictures(panel=host.screen)
        hands.click('views_button', host.windows[two])
        yield 'the views to open', self._views_open(host.windows[two])
        self._take_pictures(bot_window=host.windows[two])
        hands.click('views_button', host.windows[two])
        self._say('stop all')
        hands.press_stop_keys()
        yield 'every robot to be proven stopped', lambda: all(
            robot.proof and robot.proof.state == PROOF_STOPPED for robot in operator.view().robots)
        hands.let_go()
        yield 'every tile to say so', lambda: all(
            tile.hud.sentence.startswith('stopped') for tile in host.windows.values()) \
            and self._all_drawn()()
        self._take_pictures(stopped=host.screen)
        yield 'the pictures to be written', lambda: all(one.done() for _, one in self._written)
        for path, written in self._written:
            if not written.result():
                raise DemoFailed('cannot write the picture {}'.format(path))
            self._say('wrote {}'.format(path))

    def _poll(self):
        """Go on if the present condition is true."""
        self._diary.note(self._operator.view().robots)
        try:
            if self._waiting is not None:
                what, condition, deadline = self._waiting
                if not condition():
                    if time.monotonic() > deadline:
                        raise DemoFailed('waited {:.0f} s for {}'.format(PATIENCE_S, what))
                    return
            what, condition = next(self._script)
            self._waiting = (what, condition, time.monotonic() + PATIENCE_S)
        except StopIteration:
            self._end('ok')
        except DemoFailed as failure:
            self._end(str(failure))

    def _take_pictures(self, **widgets):
        """Write a picture of each widget beside the screenshot: ``<screenshot>_<name>.png``."""
        if not self._screenshot:
            return
        stem = os.path.splitext(self._screenshot)[0]
        for name, widget in widgets.items():
            self._save(widget.grab(), '{}_{}.png'.format(stem, name))

    def _take_screenshot(self):
        """Write the whole window to the file asked for, as it is now: not what was painted last."""
        if self._screenshot:
            self._save(self._program.window.grab(), self._screenshot)

    def _save(self, picture, path):
        self._written.append((path, self._writer.submit(picture.toImage().save, path, 'PNG')))

    def _end(self, result):
        """Print what happened, write the result, and close the program."""
        self._timer.stop()
        for line in self._diary.lines():
            self._say(line)
        self._say('demo: {}'.format(result))
        self.exit_status = 0 if result == 'ok' else 1
        if self._result:
            with open(self._result, 'w', encoding='utf-8') as stream:
                stream.write(result + '\n')
        self._program.window.close_now()

    @staticmethod
    def _say(text):
        print(text, flush=True)
