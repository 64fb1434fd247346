# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot put on a task, taken over, and sent on, by clicks on the real screen with real nodes."""
import os
import sys

import pytest
from python_qt_binding.QtCore import Qt

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.panel_session import PanelSession  # noqa: E402

PATIENCE_S = 120.0


@pytest.fixture(scope='module')
def session():
    running = PanelSession([('sim.launch', 'n:=2')], ['bot1', 'bot2'])
    running.system.node('tasks', '__name:=mhri_tasks')
    yield running
    running.close()


def view(session, name):
    """Return the newest view of a robot, as the screen shows it."""
    return next(robot for robot in session.host.tasks._view.robots if robot.name == name)


def told(session, kind, robot):
    return [event for event in session.host.events.log.events
            if (event.kind, event.robot) == (kind, robot)]


def start(session, key, robot, **values):
    """Start a task of a robot that is looked at, by the page."""
    page = session.host.tasks.page
    session.host.screen.arrangement.show_page(page)
    session.until(lambda: any(kind.key == key for kind in page._kinds), PATIENCE_S, 'the tasks')
    session.host.screen.look_at(robot)
    page.choose(key)
    for name, value in values.items():
        session.hands.widget('task_field_' + name, page).setValue(value)
    session.until(lambda: page.start_button.isEnabled(), PATIENCE_S, 'whom to start it for')
    session.hands.click('task_start_button', page)


def test_1_a_square_is_started_from_the_page(session):
    page = session.host.tasks.page
    start(session, 'square', 'bot2', side=1.0)
    session.until(lambda: view(session, 'bot2').task is not None
                  and view(session, 'bot2').obeys == 'task', PATIENCE_S, 'bot2 on its task')
    session.until(lambda: session.host.screen.robot_list.row('bot2').pill.word == 'ON TASK',
                  PATIENCE_S, 'its row to say so')
