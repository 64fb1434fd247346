# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map by clicks on the real screen, with the real mhri_tasks and simulated robots.

One of them is placed by hand and fitted; marks and a fence are drawn; the other drives.
"""
import math

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication
import rosgraph

from mhri.driving.gui.hands import Errand, Grip
from mhri.map import gesture
from mhri.screen.gui.stage import MAP_CLOSED, MAP_LARGE
from support.maps import click, drag
from support.panel_session import PanelSession

TIMEOUT_S = 120.0
# What was refused, since a node was silent for a moment, is asked for again.
AGAIN_S = 10.0
# Where they stand (x, y, heading) [m, rad]; bot2 is placed by tf, bot1 by nobody.
BOT1, BOT2 = (1.5, 3.2, 0.4), (3.0, 1.0, 0.6)
# By so much the hand is off: ahead, to the left [m], turned [rad].
ROUGH = (-0.25, 0.3, -0.25)
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
    robot = session.presenter.parts['map'].pane.view.scene.robot(name)
    return robot.pose if robot is not None else None


def off(pose, truth):
    """Return how far a pose is off (x, y, heading): metres, radians."""
    return (math.hypot(pose.x_m - truth[0], pose.y_m - truth[1]),
            abs(math.remainder(pose.heading_rad - truth[2], 2.0 * math.pi)))


def place_by_hand(session, rough):
    """Click the robot that is not placed, or take Place again, and drag where it is about."""
    pane = session.presenter.parts['map'].pane
    x, y, heading = (truth + error for truth, error in zip(BOT1, rough))

    def place():
        button = pane.strip.findChild(object, 'unplaced_bot1')
        session.hands.click('tool_place') if button is None else button.click()
        drag(pane, (x, y), (x + math.cos(heading), y + math.sin(heading)))

    def there():
        pose = placed(session, 'bot1')
        return pose is not None and max(off(pose, (x, y, heading))) < 0.1
    session.until(Errand(place, there, AGAIN_S), TIMEOUT_S,
                  lambda: 'bot1 where the hand put it: ' + pane.line.text())


def fit(session, words):
    """Choose a row of the menu below Fit, and wait for the answer; return it."""
    pane = session.presenter.parts['map'].pane
    pane.show_answer('')

    def ask():
        session.hands.click('fit_button')
        menu = QApplication.activePopupWidget()
        action, = (action for action in menu.actions() if action.text() == words)
        QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier, menu.actionGeometry(action).center())
    session.until(Errand(ask, lambda: 'of its laser points match' in pane.line.text(), AGAIN_S),
                  TIMEOUT_S, lambda: 'the answer: ' + pane.line.text())
    return pane.line.text()


@pytest.fixture(autouse=True)
def large(session):
    """Have the map large, with bot2 on it, and bot1 looked at."""
    session.presenter.screen.stage.show_map(MAP_LARGE)
    session.until(lambda: placed(session, 'bot2') is not None, TIMEOUT_S, 'bot2 on the map')
    session.presenter.screen.look_at('bot1')
    session.until(lambda: session.presenter.parts['map'].pane.view.scene.targets() == ('bot1',),
                  TIMEOUT_S, 'bot1 looked at')


def test_placed_roughly_by_hand_and_fitted_to_the_map(session):
    place_by_hand(session, ROUGH)
    answer = fit(session, 'Fit bot1 to the map')
    session.until(lambda: off(placed(session, 'bot1'), BOT1)[0] <= WITHIN_M, TIMEOUT_S,
                  lambda: '{}: {}'.format(answer, placed(session, 'bot1')))
    far_m, turned_rad = off(placed(session, 'bot1'), BOT1)
    print('{}; off by {:.3f} m, {:.2f} degrees'.format(answer, far_m, math.degrees(turned_rad)))
    assert far_m <= WITHIN_M and turned_rad <= WITHIN_RAD
    assert off(placed(session, 'bot2'), BOT2)[0] <= WITHIN_M


def test_marks_and_fence_are_drawn_and_taken_away(session):
    pane, scene = session.presenter.parts['map'].pane, \
        lambda: session.presenter.parts['map'].pane.view.scene

    def fence():
        pane.choose_tool(gesture.FENCE)
        for corner in ((0.5, 0.5), (6.0, 0.5), (6.0, 5.0)):
            click(pane, *corner)
        QTest.keyClick(pane.view, Qt.Key_Return)

    def mark():
        pane.choose_tool(gesture.MARK)
        click(pane, 4.5, 2.5)
        QTest.keyClick(pane.name_field.edit, Qt.Key_Return)

    def clear():
        for one in scene().marks:
            pane.mark_set.emit(one.name, None)
        pane.fence_drawn.emit([])
    for act, done in ((fence, lambda: len(scene().fence) == 3), (mark, lambda: scene().marks)):
        session.until(Errand(act, done, AGAIN_S), TIMEOUT_S, pane.line.text)
    assert scene().marks[0].pose.x_m == pytest.approx(4.5, abs=0.05)
    session.until(Errand(clear, lambda: not scene().marks and not scene().fence, AGAIN_S),
                  TIMEOUT_S, 'both to go')


def panel_reads(topic):
    """Return whether the screen subscribes a topic."""
    subscribers = rosgraph.Master('/test').getSystemState()[1]
    return '/mhri_panel' in dict(subscribers).get(topic, ())


def test_a_map_that_is_closed_costs_nothing(session):
    session.until(lambda: panel_reads('/bot2/scan') and panel_reads('/map'),
                  what='the subscriptions')
    session.presenter.screen.stage.show_map(MAP_CLOSED)
    session.until(lambda: not panel_reads('/bot2/scan') and not panel_reads('/map'),
                  what='their end')


def test_a_robot_drives_on_the_map(session):
    def robot():
        return session.presenter.parts['map'].pane.view.scene.robot('bot2')
    session.until(lambda: robot().points is not None, what='a scan')
    first = robot().pose
    session.hands.click('check_bot2')
    session.until(Grip(lambda: session.hands.hold_stick(0.6, 0.0), session.hands.let_go,
                       lambda: session.operator.view().status,
                       lambda: off(robot().pose, (first.x_m, first.y_m, 0.0))[0] > 0.3
                       and len(robot().trail) > 3), what='it to drive, and its trail')
    session.hands.let_go()
