# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scripted drive with the real panel, buttons, keys and stick.

Finds the robots, selects two of four, drives both, changes the selection while they move, and
stops all. Then two of them patrol, one is driven and one follows it, on the map. Each step waits
for a condition, such as motion by odometry, never for a fixed time; the first failure ends it.
"""
from concurrent.futures import ThreadPoolExecutor
import math
import os
import time

from python_qt_binding.QtCore import QObject, QPoint, Qt, QTimer

from mhri.base.view_rows import CAMERAS, RGB
from mhri.base.views import LIVE, PROOF_STOPPED
from mhri.driving.gui.hands import CENTRE, DemoFailed, Errand, Grip, Hands, READY
from mhri.screen.gui.stale_cover import StaleCover

POLL_MS = 50
TIMEOUT_S = 60.0
# Patrol routes of two robots [m], in the hall of the simulated building.
ROUTES = (((10.0, 0.8), (8.0, 0.8)), ((5.2, 1.0), (3.4, 1.0)))


class MotionStatistics:
    """The motion of each robot, from its odometry: path [m], turning [rad], top speed [m/s]."""

    def __init__(self):
        self._last = {}
        self.robots = {}

    def note(self, views):
        """Handle the :class:`RobotView` of all robots."""
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
        """Return one sentence per robot."""
        return ['{} ({}): drove {:.2f} m, turned {:.0f} deg, at most {:.2f} m/s; {}'.format(
            name, entry['type'], entry['path'], math.degrees(entry['turned']), entry['top'],
            entry['stop'] or 'no stop') for name, entry in sorted(self.robots.items())]


class Demo(QObject):
    """Plays the script on the GUI thread, one step whenever its condition is true.

    :param program: :class:`mhri.standalone.Standalone`
    :param screenshot: path for a picture of the screen while the robots move, also the stem of
        pictures of its parts (``<screenshot>_panel.png``, ...); None for no pictures
    :param result: path for the result, ``ok`` or the reason of the failure, or None
    """

    def __init__(self, program, screenshot=None, result=None):
        super().__init__()
        self._program = program
        self._operator = program.presenter.operator
        self._hands = Hands(program.presenter.screen)
        self._screenshot = screenshot
        self._result = result
        self._statistics = MotionStatistics()
        self._script = self._steps()
        self._waiting = None
        # On a thread: writing a picture takes longer than the timeout of the stick.
        self._writer = ThreadPoolExecutor(max_workers=1)
        self._written = []
        self.exit_status = 1
        self._timer = QTimer(self, timeout=self._poll)

    def start(self):
        """Maximise the window and start; the program ends by itself."""
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
        """Return a condition: the status line ends with these words."""
        return lambda: self._operator.view().status.endswith(words)

    @staticmethod
    def _both(one, other):
        return lambda: one() and other()

    def _hold(self, forward, turn, condition):
        """Return a condition that holds the stick until another condition is true."""
        return Grip(lambda: self._hands.hold_stick(forward, turn), self._hands.let_go,
                    lambda: self._operator.view().status, condition)

    def _found_four(self):
        """Return a condition: four robots are live; the search is repeated every second."""
        return Errand(lambda: self._hands.click('look_button'), lambda: sum(
            robot.link == LIVE for robot in self._operator.view().robots) >= 4, again_s=1.0)

    @staticmethod
    def _views_open(tile):
        """Return a condition: a tile's switches are open below its header, and it is drawn."""
        return lambda: tile.switches.mapTo(tile, QPoint(0, 0)).y() >= tile.header.height() \
            and not any(cover.isVisible() for cover in tile.findChildren(StaleCover))

    def _all_drawn(self):
        """Return a condition: no part of the screen is covered as stale."""
        return lambda: not any(cover.isVisible() for cover in
                               self._program.presenter.screen.findChildren(StaleCover))

    def _pictures_there(self):
        """Return a condition: every tile with a camera view has a picture."""
        return lambda: all(tile.view(RGB).picture.frame is not None
                           for tile in self._program.presenter.windows.values()
                           if tile.shown() & CAMERAS)

    def _travelled(self, name, metres):
        """Return a condition: the robot has driven this distance from now on."""
        begun = self._statistics.robots[name]['path']
        return lambda: self._statistics.robots[name]['path'] - begun >= metres

    def _stopped(self):
        """Return a condition: every robot is proven stopped."""
        return lambda: all(robot.proof and robot.proof.state == PROOF_STOPPED
                           for robot in self._operator.view().robots)

    def _steps(self):
        """Yield (description, condition) of each step."""
        yield 'the mux to be there', lambda: self._operator.view().mode is not None
        yield 'four robots to be found and live', self._found_four()
        robots = self._operator.selection.robots
        self._print('found {}'.format(', '.join(robots)))
        robots = robots[:4]
        yield from self._drive_group(*robots[:3])
        yield from self._work_as_team(*robots)
        yield 'the pictures to be written', lambda: all(one.done() for _, one in self._written)
        for path, written in self._written:
            if not written.result():
                raise DemoFailed('cannot write the picture {}'.format(path))
            self._print('wrote {}'.format(path))

    def _drive_group(self, one, two, three):
        """Drive two of three robots, then another pair of them."""
        hands, presenter = self._hands, self._program.presenter
        hands.click('check_' + one)
        hands.click('check_' + two)
        yield 'the windows of both to open', lambda: {one, two} <= set(presenter.windows)
        hands.click('camera_depth', presenter.windows[one])
        hands.click('camera_rgb', presenter.windows[two])
        self._print('selected {} and {}: driving both'.format(one, two))
        yield 'the pictures to come', self._pictures_there()
        yield 'the panel to be ready', self._reads(READY)
        yield '{} and {} to move'.format(one, two), self._hold(
            0.4, 0.0, self._both(self._travelled(one, 0.25), self._moves(one, two)))
        yield '{} to drive a bend'.format(two), self._hold(0.4, 0.35, self._travelled(two, 0.2))
        self._take_pictures(depth=presenter.windows[one])
        self._print('deselecting {} and selecting {} while they move'.format(one, three))
        hands.click('check_' + one)
        hands.click('check_' + three)
        yield 'the panel to ask for a centred stick', self._reads(CENTRE)
        yield '{} to stand still'.format(one), self._rests(one)
        self._print('{} does not leap: the stick must be centred first'.format(three))
        hands.let_go()
        yield 'the panel to be ready', self._reads(READY)
        yield '{} and {} to move'.format(two, three), self._hold(
            0.4, -0.35, self._both(self._travelled(three, 0.3), self._moves(two, three)))
        yield 'every tile to be drawn', self._all_drawn()
        self._take_screenshot()
        self._take_pictures(panel=presenter.screen)
        hands.click('views_button', presenter.windows[two])
        yield 'the views to open', self._views_open(presenter.windows[two])
        self._take_pictures(bot_window=presenter.windows[two])
        hands.click('views_button', presenter.windows[two])
        self._print('stop all')
        hands.press_stop_keys()
        yield 'every robot to be proven stopped', self._stopped()
        hands.let_go()
        yield 'every tile to say so', lambda: all(
            tile.hud.sentence.startswith('stopped') for tile in presenter.windows.values()) \
            and self._all_drawn()()
        self._take_pictures(stopped=presenter.screen)

    def _work_as_team(self, one, two, three, four):
        """Let two robots patrol, drive one, and have one follow it, all on the map."""
        hands, presenter = self._hands, self._program.presenter
        yield 'the stop to be released', Errand(
            self._release, lambda: not self._operator.view().stop_all, again_s=1.0)
        for name in (two, three):
            hands.click('check_' + name)
        yield 'the map to be large', Errand(
            lambda: hands.press(Qt.Key_M, 'm'), presenter.parts['map'].pane.isVisible)
        scene = lambda: presenter.parts['map'].pane.view.scene  # noqa: E731
        for name in (one, two, three, four):
            yield '{} to be on the map'.format(name), lambda name=name: scene().robot(
                name) is not None and scene().robot(name).pose is not None
        for name, tool, places in ((one, 'route', ROUTES[0]), (four, 'route', ROUTES[1]),
                                   (three, 'leader', None)):
            yield '{} to be looked at'.format(name), Errand(
                lambda name=name: self._tap(name), lambda name=name: scene().targets() == (name,))
            yield '{} to be on its task'.format(name), Errand(
                lambda tool=tool, places=places: self._draw(tool, places, two),
                lambda name=name: self._task(name) is not None)
        self._print('{} and {} patrol, {} follows {}: driving that one'.format(
            one, four, three, two))
        hands.click('check_' + two)
        yield 'the panel to be ready', self._reads(READY)
        # In a circle to the left, to stay clear of the patrols for any length of time.
        yield 'all four to be on their way', self._hold(0.45, 0.25, self._all_go(
            two, {one: 0.3, two: 0.8, three: 0.4, four: 0.3}))
        yield 'every tile to be drawn', self._all_drawn()
        self._take_pictures(map=presenter.screen)
        self._print('stop all')
        hands.press_stop_keys()
        yield 'every robot to be proven stopped', self._stopped()
        hands.let_go()
        yield 'every task to end', lambda: not any(map(self._task, (one, two, three, four)))

    def _release(self):
        """Release the stop: the release button first, then the confirm button."""
        confirm = self._hands.widget('confirm_button')
        self._hands.click('confirm_button' if confirm.isVisible() else 'release_button')

    def _task(self, name):
        """Return the current task of a robot, None if none."""
        return next((robot.task for robot in self._program.presenter.parts['tasks'].view.robots
                     if robot.name == name), None)

    def _tap(self, name):
        """Click a robot on the map."""
        view = self._program.presenter.parts['map'].pane.view
        pose = view.scene.robot(name).pose
        if pose is not None:
            self._hands.tap(view, pose.x_m, pose.y_m)

    def _draw(self, tool, places, leader):
        """Draw a route for the robot in view, or choose its leader."""
        view = self._program.presenter.parts['map'].pane.view
        self._hands.click('tool_' + tool)
        if places is None:
            self._tap(leader)
            return
        for place in places:
            self._hands.tap(view, *place)
        self._hands.click('done_button')

    def _all_go(self, driven, metres):
        """Return a condition: each robot has driven its distance; lost tasks are continued."""
        gone = [self._travelled(name, far_m) for name, far_m in metres.items()]
        on_task = [name for name in metres if name != driven]
        send_on = Errand(lambda: [self._hands.click('carry_on_' + name) for name in on_task
                                  if self._task(name) is None], lambda: False)

        def done():
            if any(self._task(name) is None for name in on_task):
                return send_on()
            return all([condition() for condition in gone])

        return done

    def _poll(self):
        """Go to the next step if the current condition is true."""
        self._statistics.note(self._operator.view().robots)
        try:
            if self._waiting is not None:
                what, condition, deadline = self._waiting
                if not condition():
                    if time.monotonic() > deadline:
                        raise DemoFailed('waited {:.0f} s for {}'.format(TIMEOUT_S, what))
                    return
            what, condition = next(self._script)
            self._waiting = (what, condition, time.monotonic() + TIMEOUT_S)
        except StopIteration:
            self._end('ok')
        except DemoFailed as failure:
            self._end(str(failure))

    def _take_pictures(self, **widgets):
        """Save a picture of each widget as ``<screenshot>_<name>.png``."""
        if not self._screenshot:
            return
        stem = os.path.splitext(self._screenshot)[0]
        for name, widget in widgets.items():
            self._save(widget.grab(), '{}_{}.png'.format(stem, name))

    def _take_screenshot(self):
        """Save a picture of the whole window, rendered anew."""
        if self._screenshot:
            self._save(self._program.window.grab(), self._screenshot)

    def _save(self, picture, path):
        self._written.append((path, self._writer.submit(picture.toImage().save, path, 'PNG')))

    def _end(self, result):
        """Print a summary, write the result, and close the program."""
        self._timer.stop()
        for line in self._statistics.lines():
            self._print(line)
        self._print('demo: {}'.format(result))
        self.exit_status = 0 if result == 'ok' else 1
        if self._result:
            with open(self._result, 'w', encoding='utf-8') as stream:
                stream.write(result + '\n')
        self._program.window.close_now()

    @staticmethod
    def _print(text):
        print(text, flush=True)
