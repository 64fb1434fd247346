# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map from the wire to the screen and back: robots that drive, and who says where they are."""
import math
import os
import sys

import numpy as np
import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.map import gesture  # noqa: E402
from mhri.screen.gui.stage import MAP_CLOSED, MAP_LARGE  # noqa: E402
from support.maps import click, drag  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402

NAMES = ('bot1', 'bot2', 'bot3')
WORLD = os.path.join(os.path.dirname(__file__), '..', 'support', 'map_world.py')


class MapSession(PanelSession):
    """Three robots in a room; bot3 is not placed."""

    def bring(self):
        """Start the robots, and who says where they are."""
        import rospy
        for name in NAMES:
            rospy.set_param('/{}/robot_type'.format(name), 'turtlebot2')
        self.system.start(sys.executable, WORLD, 'bot1', 'bot2', '--', 'bot3')

    @property
    def pane(self):
        """Return the map."""
        return self.host.map.pane

    def robot(self, name):
        """Return a robot as the map shows it, None while it does not."""
        return self.pane.view.scene.robot(name)

    def is_placed(self, name):
        """Tell whether a robot is on the map."""
        robot = self.robot(name)
        return robot is not None and robot.pose is not None


@pytest.fixture(scope='module')
def session():
    running = MapSession((), NAMES)
    yield running
    running.close()


@pytest.fixture(autouse=True)
def large(session):
    """Have the map large, with two robots on it, and the first one looked at."""
    session.host.screen.stage.show_map(MAP_LARGE)
    session.host.screen.look_at('bot1')
    session.until(lambda: session.is_placed('bot2') and session.robot('bot1').looked_at,
                  what='the robots on the map')


def readers(topic):
    """Return how many nodes listen to a topic."""
    import rosgraph
    subscribers = rosgraph.Master('/test').getSystemState()[1]
    return len(dict(subscribers).get(topic, ()))


def test_robots_drive_on_the_map_and_their_lasers_see_its_walls(session):
    first = session.robot('bot1').pose
    session.until(lambda: session.robot('bot1').points is not None, what='a scan')
    points = session.robot('bot1').points
    # A busy machine may hear a scan late, and it turns at 0.3 rad/s.
    assert np.median(abs(abs(points) - (8.0, 6.0)).min(axis=1)) < 1.0
    session.until(lambda: math.hypot(session.robot('bot1').pose.x_m - first.x_m,
                                     session.robot('bot1').pose.y_m - first.y_m) > 0.3,
                  what='it to drive')
    # A busy machine takes in fewer places on the same way.
    session.until(lambda: len(session.robot('bot1').trail) > 3, what='its trail')
    assert session.robot('bot3').pose is None


def test_what_nobody_sees_is_not_listened_to(session):
    session.until(lambda: readers('/bot2/scan') and readers('/map'), what='the subscriptions')
    session.host.screen.stage.show_map(MAP_CLOSED)
    session.until(lambda: not readers('/bot2/scan') and not readers('/map'), what='their end')


def test_a_robot_is_placed_by_hand(session):
    assert not session.is_placed('bot3')
    session.pane.strip.findChild(object, 'unplaced_bot3').click()
    drag(session.pane, (2.0, 2.0), (2.0, 3.0))
    session.until(lambda: session.is_placed('bot3'), what='bot3 on the map')
    assert 'placed' in session.pane.line.text()
    session.pane.robot_placed.emit('bot3', None)
    session.until(lambda: not session.is_placed('bot3'), what='bot3 off the map')


def test_marks_and_fence_are_drawn_and_taken_away(session):
    pane, scene = session.pane, lambda: session.pane.view.scene
    pane.take(gesture.FENCE)
    for corner in ((-3.0, -3.0), (3.0, -3.0), (3.0, 3.0)):
        click(pane, *corner)
    QTest.keyClick(pane.view, Qt.Key_Return)
    session.until(lambda: len(scene().fence) == 3, what='the fence')
    pane.take(gesture.MARK)
    click(pane, 1.0, -1.0)
    QTest.keyClick(pane.name_field.edit, Qt.Key_Return)
    session.until(lambda: len(scene().marks) == 1, what='the mark')
    assert scene().marks[0].pose.x_m == pytest.approx(1.0, abs=0.05)
    pane.mark_set.emit(scene().marks[0].name, None)
    pane.fence_drawn.emit([])
    session.until(lambda: not scene().marks and not scene().fence, what='both to go')


def test_a_refusal_is_said(session):
    session.pane.fit_requested.emit('bot1', '')
    session.until(lambda: session.pane.line.text() == 'bot1: refused: there is no laser',
                  what='the answer')
