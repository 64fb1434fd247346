# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``doc/new_accessory.md`` word by word: its files written, its commands typed, its robot used.

The panel that the page starts is the one of this process, so that its buttons can be pressed.
"""
from pathlib import Path
import re
import subprocess
import time

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton
import rosgraph

from mhri.base.accessories import READOUT
from mhri.driving.gui.hands import Errand
from support.newcomer import blocks, last_words
from support.panel_session import PanelSession
from support.ros_system import wait_for

GUIDE = Path(__file__).resolve().parents[3] / 'doc' / 'new_accessory.md'
PANEL = 'roslaunch mhri mhri.launch gui:=standalone\n'

pytestmark = [pytest.mark.filterwarnings('ignore::DeprecationWarning')]


class Rescue(PanelSession):
    """Somebody with the page, at the panel."""

    def __init__(self, home):
        self.home = home
        self.blocks = blocks(GUIDE.read_text())
        super().__init__((), ('rescue1',))

    def bring(self):
        """Do what the page asks for, up to the command that it asks for at the end."""
        self.system.env['HOME'] = str(self.home)
        *first, (_, self.last) = self.blocks
        terminals = []
        for kind, text in first:
            if kind == 'sh terminal':
                terminals.append(text)
            elif kind == 'sh':
                self.type(text)
            else:
                (self.home / 'rescue' / kind).write_text(text)
        panel, robot, tools = terminals
        assert panel == PANEL
        self.system.start('bash', '-c', 'exec ' + robot)
        master = rosgraph.Master('/newcomer')
        wait_for(lambda: master.hasParam('/rescue1/mhri/accessories'), what='the rows')
        self.tools = self.system.start('bash', '-c', 'exec ' + tools)

    def type(self, commands):
        """Type commands."""
        subprocess.run(['bash', '-e', '-c', commands], env=self.system.env, cwd=str(self.home),
                       check=True, timeout=60.0)

    def _is_known(self, name):
        return len(self.operator.robot_view(name).accessories) == 3

    def sensor(self):
        """Return how the row of the gas sensor is shown."""
        return next(view for view in self.operator.robot_view('rescue1').accessories
                    if view.spec.kind == READOUT)

    def found(self, text):
        """Return a button of the tile that can be pressed, or None."""
        return next((button for button in self.presenter.windows['rescue1'].findChildren(
            QAbstractButton) if button.text() == text and button.isVisible()
            and button.isEnabled()), None)

    def switch(self, text, then):
        """Click a button until another is there: what comes too late is not obeyed, and said."""
        self.until(Errand(
            lambda: QTest.mouseClick(self.found(text), Qt.LeftButton), lambda: self.found(then),
            ready=lambda: self.found(text)), what='the button ' + then)

    def button(self, text):
        """Return a button of the tile, once it can be pressed."""
        tile = self.presenter.windows['rescue1']
        return self.until(lambda: self.found(text), what=lambda: 'the button {} of {}'.format(
            text, [(button.text(), button.isVisible(), button.isEnabled())
                   for button in tile.bar.findChildren(QAbstractButton)]))

    def printed(self):
        """Return what the flipper was told, each number."""
        return [float(speed)
                for speed in re.findall('^flipper (.+)$', last_words(self.tools), re.M)]


@pytest.fixture
def rescue(tmp_path):
    running = Rescue(tmp_path)
    yield running
    running.close()


def test_the_guide_word_by_word(rescue):
    tile = rescue.open('rescue1')
    tile.views_button.setChecked(False)
    lamp_off, less, more, gas = re.findall(
        r'\*\*(.+?)\*\*', re.search('Over its picture are (.+)', GUIDE.read_text()).group(1))
    rescue.button(less)
    rescue.until(lambda: rescue.sensor().value == (12.0,), what=gas)
    rescue.switch(lamp_off, 'lamp on')

    flipper = rescue.button(more)
    QTest.mousePress(flipper, Qt.LeftButton)
    rescue.until(lambda: rescue.printed()[-3:] == [1.0] * 3, what='the flipper')
    QTest.mouseRelease(flipper, Qt.LeftButton)
    rescue.until(lambda: rescue.printed()[-1] == 0.0, what='its end')

    flipper = rescue.button(more)
    QTest.mousePress(flipper, Qt.LeftButton)
    rescue.until(lambda: rescue.printed()[-1] == 1.0, what='the flipper')
    rescue.hands.press_stop_keys()
    rescue.until(lambda: rescue.printed()[-1] == 0.0, what='its end by the stop')
    told, at = len(rescue.printed()), time.monotonic()
    rescue.until(lambda: time.monotonic() - at > 0.5, what='a while')
    assert len(rescue.printed()) == told
    QTest.mouseRelease(flipper, Qt.LeftButton)

    assert rescue.operator.view().stop_all
    rescue.switch('lamp on', lamp_off)

    rescue.type(rescue.last)
    events = rescue.presenter.parts['events'].log
    rescue.until(lambda: any(event.kind == 'readout.beyond' for event in events.events),
                 what='the event')
    text, = [event.text for event in events.events if event.kind == 'readout.beyond']
    assert '"{}"'.format(text) in GUIDE.read_text()
