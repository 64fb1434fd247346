# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that nobody knows the place of, placed by hand and fitted: clicks on the real screen,
the real mhri_tasks, simulated robots that stand where it says here.
"""
import math
import os
import sys

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.gui.pending import Pace  # noqa: E402
from mhri.screen.gui.stage import MAP_LARGE  # noqa: E402
from support.maps import drag  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402

PATIENCE_S = 120.0
# What was refused, since somebody was not heard for a moment, is asked for again.
AGAIN_S = 10.0
# Where they stand (x, y, heading) [m, rad]; bot2 is placed by tf, bot1 by nobody.
BOT1, BOT2 = (1.5, 3.2, 0.4), (3.0, 1.0, 0.6)
# By so much the hand is off: ahead, to the left [m], turned [rad].
ROUGH = [(0.3, -0.2, 0.2), (-0.25, 0.3, -0.25), (0.1, 0.35, 0.3)]
WITHIN_M, WITHIN_RAD = 0.05, math.radians(2.0)


def start_of(name, place, *more):
    """Return the words that launch a simulated TurtleBot2 at a place."""
    return ('turtlebot.launch', 'name:=' + name, 'x:={}'.format(place[0]),
            'y:={}'.format(place[1]), 'yaw:={}'.format(place[2])) + more


@pytest.fixture(scope='module')
def session():
    running = PanelSession([start_of('bot1', BOT1), start_of(
        'bot2', BOT2, 'placed:=true', 'map:=true')], ['bot1', 'bot2'])
    running.system.node('tasks', '__name:=mhri_tasks')
    yield running
    running.close()


def placed(session, name):
    """Return where a robot is on the map, None where it is not."""
    robot = session.host.map.pane.view.scene.robot(name)
    return robot.pose if robot is not None else None


def off(pose, truth):
    """Return how far a pose is off (x, y, heading): metres, radians."""
    return (math.hypot(pose.x_m - truth[0], pose.y_m - truth[1]),
            abs(math.remainder(pose.heading_rad - truth[2], 2.0 * math.pi)))


def place_by_hand(session, rough):
    """Click the robot that is not placed, or take Place again, and drag where it is about."""
    pane, again = session.host.map.pane, Pace(AGAIN_S)
    x, y, heading = (truth + error for truth, error in zip(BOT1, rough))

    def there():
        pose = placed(session, 'bot1')
        if pose is not None and off(pose, (x, y, heading))[0] < 0.1 \
                and off(pose, (x, y, heading))[1] < 0.1:
            return True
        if again.due():
            button = pane.strip.findChild(object, 'unplaced_bot1')
            session.hands.click('tool_place') if button is None else button.click()
            drag(pane, (x, y), (x + math.cos(heading), y + math.sin(heading)))
        return False
    session.until(there, PATIENCE_S, lambda: 'bot1 where the hand put it: ' + pane.line.text())


def fit(session, words):
    """Choose a row of the menu below Fit, and wait for the answer; return it."""
    pane, again, asked = session.host.map.pane, Pace(AGAIN_S), []

    def answered():
        if again.due():
            pane.show_answer('')
            session.hands.click('fit_button')
            menu = QApplication.activePopupWidget()
            action, = (action for action in menu.actions() if action.text() == words)
            QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier,
                             menu.actionGeometry(action).center())
            asked.append(True)
        return asked and 'of what its laser sees fits' in pane.line.text()
    session.until(answered, PATIENCE_S, lambda: 'the answer: ' + pane.line.text())
    return pane.line.text()


@pytest.mark.parametrize('rough', ROUGH)
def test_placed_roughly_by_hand_and_fitted_to_the_map(session, rough):
    pane = session.host.map.pane
    session.host.screen.stage.show_map(MAP_LARGE)
    session.until(lambda: placed(session, 'bot2') is not None, PATIENCE_S, 'bot2 on the map')
    session.host.screen.look_at('bot1')
    session.until(lambda: pane.view.scene.targets() == ('bot1',), PATIENCE_S, 'bot1 looked at')
    place_by_hand(session, rough)
    answer = fit(session, 'Fit bot1 to the map')
    session.until(lambda: off(placed(session, 'bot1'), BOT1)[0] <= WITHIN_M, PATIENCE_S,
                  lambda: '{}: {}'.format(answer, placed(session, 'bot1')))
    far_m, turned_rad = off(placed(session, 'bot1'), BOT1)
    print('{}; off by {:.3f} m, {:.2f} degrees'.format(answer, far_m, math.degrees(turned_rad)))
    assert far_m <= WITHIN_M and turned_rad <= WITHIN_RAD
    assert off(placed(session, 'bot2'), BOT2)[0] <= WITHIN_M
