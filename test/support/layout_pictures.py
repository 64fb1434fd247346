#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the screen at every size into PNG files, to be looked at: ``layout_pictures.py <folder>``.

The robots are those of ``scenes.py``, their pictures those of the simulator.
"""
import itertools
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, '..'))
os.environ['QT_QPA_PLATFORM'] = 'xcb'

from python_qt_binding.QtWidgets import QApplication  # noqa: E402

from mhri.base.gui import theme  # noqa: E402
from mhri.camera.images import Frame  # noqa: E402
from mhri.graph.ros.resources import read_text, resource_path  # noqa: E402
from mhri.sim.camera import Camera  # noqa: E402
from mhri.sim.plan import parse_plan  # noqa: E402
from support import scenes  # noqa: E402

SIZES = (794, 700), (1024, 600), (1280, 720), (1366, 768), (1920, 1080), (3840, 2160)
COUNTS = 1, 3, 6, 12


def wishes():
    """Yield (size, robots, theme, font, kind, drawer, mode) of each picture."""
    for size, count in itertools.product(SIZES, COUNTS):
        font = 2.0 if size[0] == 3840 else 1.0
        for name, is_open in (('dark', True), ('dark', False), ('light', True)):
            yield size, count, name, font, 'plain', is_open, 'joy'
        yield size, count, 'dark', font, 'plain', False, 'ps3joy'
        yield size, count, 'dark', 2.0 * font, 'long', False, 'joy'
        yield size, count, 'dark', font, 'group', True, 'ps3joy'
    for size in SIZES:
        yield size, 3, 'dark', 1.0, 'stopped', True, 'joy'
        yield size, 0, 'dark', 1.0, 'plain', True, 'joy'


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


def main(folder):
    """Draw all of them."""
    application = QApplication(sys.argv)
    usual = application.font()
    Scene.frames = frames()
    for size, count, name, font, kind, is_open, mode in wishes():
        application.setFont(theme.larger(usual, font))
        scene = Scene(application, resource_path(), size, count, mode, **scenes.KINDS[kind])
        scene.screen.arrangement.choose_theme(name)
        scene.screen.drawer_button.setChecked(is_open)
        scene.show().grab().save(os.path.join(folder, '{}x{}-{:02}-{}-{:g}-{}-{}-{}.png'.format(
            *size, count, name, font, kind, 'drawer' if is_open else 'closed', mode)))
        scene.screen.close()
        scene.screen.deleteLater()
        application.processEvents()


if __name__ == '__main__':
    main(sys.argv[1])
