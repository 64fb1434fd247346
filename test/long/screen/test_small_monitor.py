# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""With letters twice as large no window is larger than a small monitor, and STOP ALL is on it."""
import json
import os
import subprocess
import sys

import pytest
from python_qt_binding.QtCore import QRect

from support.paths import SUPPORT
from support.xvfb import start_xvfb

# A process of its own: Qt knows one X server.
PROGRAM = '''
import json, sys, types
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtWidgets import QApplication
from mhri.base.gui import theme
from mhri.screen.gui.torn_off import TornOff
from mhri.standalone import MainWindow
from support.scenes import Scene
application = QApplication(['mhri-test', '-style', 'Fusion'])
application.setFont(theme.larger(application.font(), float(sys.argv[2])))
made = Scene(application, sys.argv[1], (800, 500), 3)
made.screen.setAttribute(Qt.WA_DontShowOnScreen, False)
window = MainWindow(types.SimpleNamespace(screen=made.screen))
window.showMaximized() if sys.argv[3] == 'maximised' else window.show()
made.show()
torn = TornOff(made.tiles['bot3'])
torn.show()
application.processEvents()


def area(widget):
    corner = widget.mapToGlobal(QPoint(0, 0))
    return corner.x(), corner.y(), widget.width(), widget.height()


least = window.minimumSize().expandedTo(window.minimumSizeHint())
print(json.dumps([(least.width(), least.height()), area(window), area(torn),
                  area(made.screen.stop_bar.stop_button),
                  area(torn.tile.stop_button)]), flush=True)
'''


@pytest.mark.parametrize('width, height, font, begun', [
    (1280, 720, 2.0, 'maximised'), (1024, 600, 2.0, 'as it is')])
def test_every_window_fits_on_the_monitor(ui_dir, width, height, font, begun):
    server, display = start_xvfb('{}x{}x24'.format(width, height))
    try:
        said = subprocess.run(
            [sys.executable, '-c', PROGRAM, ui_dir, str(font), begun], timeout=120, check=True,
            stdout=subprocess.PIPE, env={**os.environ, 'DISPLAY': display, 'PYTHONPATH': ':'.join(
                (str(SUPPORT.parent), os.environ.get('PYTHONPATH', '')))})
    finally:
        server.terminate()
        server.wait()
    least, *areas = json.loads(said.stdout.decode().splitlines()[-1])
    # Its frame has to fit as well.
    assert least[0] < width and least[1] < height - 30
    for area in areas:
        assert QRect(0, 0, width, height).contains(QRect(*area)), area
