#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the screen at every size into PNG files, to be looked at: ``layout_pictures.py <folder>``.

The robots are those of ``scenes.py``, their pictures those of the simulator.
"""
from dataclasses import replace
import itertools
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..'))
os.environ['QT_QPA_PLATFORM'] = 'xcb'

from python_qt_binding.QtCore import QEvent  # noqa: E402
from python_qt_binding.QtTest import QTest  # noqa: E402
from python_qt_binding.QtWidgets import QApplication  # noqa: E402

from mhri.base.gui import theme  # noqa: E402
from mhri.base.task_views import TaskView  # noqa: E402
from mhri.camera.images import Frame  # noqa: E402
from mhri.graph.ros.resources import read_text, resource_path  # noqa: E402
from mhri.map.gui.map_pane import MapPane  # noqa: E402
from mhri.screen.gui.stale_cover import StaleCover  # noqa: E402
from mhri.sim.camera import Camera  # noqa: E402
from mhri.sim.plan import parse_plan  # noqa: E402
from support import scenes  # noqa: E402

# Everything larger on the largest one, as the screen begins there.
SIZES = (794, 700), (1024, 600), (1280, 720), (1366, 768), (1920, 1080), (3840, 2160)
COUNTS = 1, 3, 6, 12
ON_TASK = {'obeys': 'task', 'driven': True, 'moving': True, 'linear_mps': 0.0,
           'task': TaskView('Square', 'corner 2 of 4', left_m=1.3)}


def wishes():
    """Yield (size, robots, theme, font, kind, drawer, mode) of each picture."""
    for size, count, name, font in itertools.product(
            SIZES, COUNTS, (theme.DARK, theme.LIGHT, theme.CONTRAST), (1.0, 2.0)):
        yield size, count, name, font, 'plain', False, 'joy'
        if name == theme.DARK:
            yield size, count, name, font, 'plain', True, 'joy'
            yield size, count, name, font, 'long', False, 'ps3joy'
            yield size, count, name, font, 'group', True, 'ps3joy'
    for size, kind in itertools.product(SIZES, ('stopped', 'held', 'frozen')):
        yield size, 3, theme.LIGHT, 1.0, kind, kind == 'stopped', 'joy'
    for size in SIZES:
        yield size, 0, theme.DARK, 1.0, 'plain', True, 'joy'


class Scene(scenes.Scene):
    """A scene whose robots stand in the simulated building."""

    frames = {}

    def frame(self, number):
        """Return what this robot's camera sees."""
        return self.frames[number]


def frames():
    """Return a frame of each of twelve robots."""
    path = resource_path('sim', 'plan.yaml')
    camera = Camera(parse_plan(read_text(path), path))
    nobody = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                          ('colour', 'u1', 3)])
    found = {}
    for number in range(1, max(COUNTS) + 1):
        rgb = camera.rgb(camera.look(1.0 + 0.75 * number, 1.4, 0.5 * number - 0.6, nobody))
        found[number] = Frame('rgb', np.ascontiguousarray(rgb), full_size=(640, 480))
    return found


def complete(scene, kind):
    """Add the map, a robot on a task, and what one cannot see of a view alone."""
    scene.screen.stage.set_map(MapPane(scene.screen.stage))
    scene.robots = tuple(replace(
        robot, offers_power=True, **(ON_TASK if robot.number == 2 and not robot.selected else {}))
        for robot in scene.robots)
    scene.view = replace(scene.view, robots=scene.robots)
    screen = scene.show()
    if kind == 'held':
        screen.stop_bar.begin_hold()
        QTest.qWait(1200)
    if kind == 'frozen':
        times = iter((0.0, *[7.3] * 9))
        cover = StaleCover(screen, lambda: next(times), screen.stop_bar.stop_button)
        cover.drawn()
        cover.refresh()


def main(folder):
    """Draw all of them."""
    application = QApplication(sys.argv)
    usual = application.font()
    Scene.frames = frames()
    for size, count, name, font, kind, is_open, mode in wishes():
        application.setFont(theme.larger(usual, font * (1.5 if size[0] == 3840 else 1.0)))
        scene = Scene(application, resource_path(), size, count, mode, **scenes.KINDS.get(kind, {}))
        scene.screen.arrangement.choose_theme(name)
        scene.screen.drawer_button.setChecked(is_open)
        complete(scene, kind)
        scene.screen.grab().save(os.path.join(folder, '{}x{}-{:02}-{}-{:g}-{}-{}-{}.png'.format(
            *size, count, name, font, kind, 'drawer' if is_open else 'closed', mode)))
        scene.screen.close()
        scene.screen.deleteLater()
        application.sendPostedEvents(None, QEvent.DeferredDelete)


if __name__ == '__main__':
    main(sys.argv[1])
