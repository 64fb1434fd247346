# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot put on a task, taken over, and sent on, by clicks on the real screen with real nodes."""
import os
import sys

import pytest
from python_qt_binding.QtWidgets import QPushButton

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.gui.pending import Pace  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402

PATIENCE_S = 120.0
# What was refused, since somebody was not heard for a moment, is asked for again.
AGAIN_S = 5.0
# Says of bot2 what is not so, time and again.
IMPOSTER = """
import rospy
from mhri.msg import TaskList, TaskRun, TaskState
rospy.init_node('imposter')
out = rospy.Publisher('/mhri_tasks/list', TaskList, queue_size=1, latch=True)
run = TaskRun('false', 'square', '', [TaskState(robot='bot2', state='running')])
while not rospy.is_shutdown():
    out.publish(TaskList(runs=[run]))
    rospy.sleep(0.2)
"""


@pytest.fixture(scope='module')
def session():
    running = PanelSession([('sim.launch', 'n:=2')], ['bot1', 'bot2'])
    running.runner = running.system.node('tasks', '__name:=mhri_tasks')
    yield running
    running.close()


def view(session, name):
    """Return the newest view of a robot, as the screen shows it."""
    return next(robot for robot in session.host.tasks.view.robots if robot.name == name)


def told(session, kind, robot):
    """Return the events of a kind of a robot, each as often as it was."""
    return [event.text for event in session.host.events.log.events for _ in range(event.count)
            if (event.kind, event.robot) == (kind, robot)]


def start(session, key, robot, **values):
    """Start a task for whom the page says, once a robot is looked at."""
    page = session.host.tasks.page
    session.host.screen.arrangement.show_page(page)
    session.until(lambda: key in page.keys, PATIENCE_S, 'the tasks')
    session.host.screen.look_at(robot)
    page.choose(key)
    for name, value in values.items():
        session.hands.widget('task_field_' + name, page).setValue(value)
    before, again = len(told(session, 'task.begun', robot)), Pace(AGAIN_S)

    def begun():
        if robot in page.who_label.text() and page.start_button.isEnabled() and again.due():
            session.hands.click('task_start_button', page)
        return len(told(session, 'task.begun', robot)) > before
    session.until(begun, PATIENCE_S, 'the start')


def under_way(session, robot):
    """Wait until a robot is driven by its task, and its row and tile say so.

    A computer that stalls for a moment loses the task: it is sent on, as an operator would.
    """
    row, tile = session.host.screen.robot_list.row(robot), session.host.windows[robot]
    again = Pace(AGAIN_S)

    def goes():
        if view(session, robot).task is None and view(session, robot).carry_on and again.due():
            session.host.tasks.carry_on(robot)
        return (view(session, robot).obeys == 'task' and view(session, robot).driven
                and row.task_pill.isVisibleTo(row) and tile.pill.word == 'ON TASK'
                and row.trouble.text().startswith('square'))
    session.until(goes, PATIENCE_S, robot + ' on its task, and row and tile to say so')


def end(session, robot, act, kind, undo=lambda: None):
    """Do what ends a task, once more where it was lost before; return what was told of its end."""
    for _ in range(5):
        under_way(session, robot)
        lost, ended = len(told(session, 'task.lost', robot)), len(told(session, kind, robot))
        act()
        session.until(lambda: len(told(session, kind, robot)) > ended
                      or len(told(session, 'task.lost', robot)) > lost, PATIENCE_S, 'its end')
        if len(told(session, kind, robot)) > ended:
            return told(session, kind, robot)[-1]
        undo()
    raise AssertionError('its task was lost again and again')


def check(session, robot, on):
    """Check a robot, or uncheck it, by the box of its row."""
    session.host.screen.arrangement.show_page(session.host.screen.robots_page)
    session.hands.click('check_' + robot)
    session.until(lambda: (robot in session.operator.selection.selected) == on, PATIENCE_S, 'it')


def carry_on(session, robot):
    """Press "Continue" of a row once it is offered."""
    button = session.host.screen.robot_list.row(robot).carry_on_button
    session.until(lambda: button.isVisibleTo(session.host.screen), PATIENCE_S, 'the offer')
    session.hands.click('carry_on_' + robot)


def test_1_a_square_is_started_from_the_page(session):
    session.until(lambda: len(session.host.windows) == 2, PATIENCE_S, 'the tiles')
    start(session, 'square', 'bot1', side=1.0)
    under_way(session, 'bot1')
    session.until(lambda: 'square: corner ' in session.host.windows['bot1'].hud.sentence,
                  PATIENCE_S, 'the tile to say how it is getting on')
    assert set(told(session, 'task.begun', 'bot1')) == {'square started'}
    assert view(session, 'bot2').task is None


def test_2_checking_it_takes_it_over(session):
    words = end(session, 'bot1', lambda: check(session, 'bot1', True), 'task.taken_over',
                lambda: check(session, 'bot1', False))
    assert words.startswith('square taken over: it is checked')
    session.until(lambda: view(session, 'bot1').task is None, PATIENCE_S, 'the end of its task')
    assert view(session, 'bot1').carry_on == ''


def test_3_unchecked_it_stands_and_is_sent_on_by_one_click(session):
    check(session, 'bot1', False)
    session.until(lambda: view(session, 'bot1').carry_on == 'Square', PATIENCE_S, 'the offer')
    session.until(lambda: session.host.windows['bot1'].header.carry_on_button.text()
                  == 'Continue square', PATIENCE_S, 'the offer in its tile')
    assert view(session, 'bot1').task is None
    carry_on(session, 'bot1')
    under_way(session, 'bot1')
    assert len(told(session, 'task.begun', 'bot1')) >= 1


def test_4_stop_all_ends_it_and_nothing_resumes_by_itself(session):
    end(session, 'bot1', lambda: session.hands.click('stop_button'), 'task.stopped',
        session.operator.release)
    page = session.host.tasks.page
    session.host.tasks.start('hold', ['bot2'], {})
    assert 'release it first' in page.problem_label.text()
    session.operator.release()
    session.until(lambda: not session.operator.view().stop_all, PATIENCE_S, 'the release')
    session.until(lambda: view(session, 'bot1').carry_on == 'Square', PATIENCE_S, 'the offer')
    assert view(session, 'bot1').task is None and not view(session, 'bot1').driven


def test_5_a_checked_robot_is_unchecked_by_starting_a_task(session):
    check(session, 'bot1', True)
    start(session, 'square', 'bot1', side=0.5)
    under_way(session, 'bot1')
    assert 'bot1' not in session.operator.selection.selected


def test_6_the_page_ends_it_and_what_is_ended_so_is_not_offered(session):
    page = session.host.tasks.page
    session.host.screen.arrangement.show_page(page)

    def stop():
        # A page that was hidden shows the task with its next turn.
        for button in session.until(lambda: page.findChildren(QPushButton, 'task_stop_button'),
                                    PATIENCE_S, 'its button'):
            button.click()
    end(session, 'bot1', stop, 'task.stopped')
    session.until(lambda: view(session, 'bot1').task is None, PATIENCE_S, 'no task')
    assert view(session, 'bot1').carry_on == ''


def test_7_a_task_that_cannot_be_is_refused_in_place(session):
    session.host.tasks.start('square', ['bot2'], {'side': -1.0})
    session.until(lambda: any('side' in text for text in told(session, 'task.refused', 'bot2')),
                  PATIENCE_S, 'the refusal')
    assert view(session, 'bot2').task is None


def test_7_one_of_a_team_is_stopped_alone(session):
    page, both = session.host.tasks.page, ('bot1', 'bot2')
    session.host.screen.arrangement.show_page(page)
    before = {name: len(told(session, 'task.stopped', name)) for name in both}
    again = Pace(AGAIN_S)

    def stopped():
        if again.due():
            single = [part for part in page.findChildren(QPushButton, 'task_stop_one_button')
                      if part.isVisible() and part.accessibleName() == 'stop Hold of bot1']
            if single:
                single[0].click()
            else:
                session.host.tasks.start('hold', list(both), {})
        return len(told(session, 'task.stopped', 'bot1')) > before['bot1']
    session.until(stopped, PATIENCE_S, 'the end of one part')
    session.until(lambda: view(session, 'bot1').task is None, PATIENCE_S, 'no task')
    assert view(session, 'bot1').carry_on == ''
    assert len(told(session, 'task.stopped', 'bot2')) == before['bot2'], 'the other goes on'
    session.host.tasks.stop(both)
    session.until(lambda: view(session, 'bot2').task is None, PATIENCE_S, 'the end of the other')


def test_8_killed_the_program_of_the_tasks_is_missed_and_its_robots_are_lost(session):
    session.host.tasks.start('square', ['bot2'], {'side': 1.0})
    under_way(session, 'bot2')
    lost = len(told(session, 'task.lost', 'bot2'))
    session.system.kill(session.runner)
    session.until(lambda: len(told(session, 'task.lost', 'bot2')) > lost, PATIENCE_S, 'the event')
    page = session.host.tasks.page
    session.until(lambda: 'is not running' in page.problem_label.text(), PATIENCE_S, 'the page')
    session.until(lambda: not page.start_button.isEnabled(), PATIENCE_S, 'the button')
    session.system.node('tasks', '__name:=mhri_tasks')
    session.until(lambda: page.start_button.isEnabled(), PATIENCE_S, 'the tasks to be back')
    assert view(session, 'bot2').task is None


def test_9_who_poses_as_the_tasks_is_not_believed_but_named(session):
    session.system.start(sys.executable, '-c', IMPOSTER)

    def named():
        assert view(session, 'bot2').task is None
        return any('/imposter' in text for text in told(session, 'tasks.stranger', ''))
    session.until(named, PATIENCE_S, 'the event')
    assert session.host.tasks.page.start_button.isEnabled()
