# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot put on a task, taken over, and sent on, by clicks on the real screen with real nodes."""
import pytest

from mhri.driving.gui.hands import Errand
from support.panel_session import PanelSession
from support.ros_system import insist, NotYet

TIMEOUT_S = 120.0
# What was refused, since a node was silent for a moment, is asked for again.
AGAIN_S = 5.0


@pytest.fixture(scope='module')
def session():
    running = PanelSession([('sim.launch', 'n:=2')], ['bot1', 'bot2'])
    running.runner = running.system.node('tasks', '__name:=mhri_tasks')
    yield running
    running.close()


def view(session, name):
    """Return the newest view of a robot, as the screen shows it."""
    return next(robot for robot in session.presenter.parts['tasks'].view.robots
                if robot.name == name)


def texts(session, kind, robot):
    """Return the texts of the events of a kind of a robot, each as often as it occurred."""
    return [event.text for event in session.presenter.parts['events'].log.events
            for _ in range(event.count) if (event.kind, event.robot) == (kind, robot)]


def start(session, key, robot, **values):
    """Start a task for whom the page says, once a robot is looked at."""
    page = session.presenter.parts['tasks'].page
    session.presenter.screen.arrangement.show_page(page)
    session.until(lambda: key in page.keys, TIMEOUT_S, 'the tasks')
    session.presenter.screen.look_at(robot)
    page.choose(key)
    for name, value in values.items():
        session.hands.widget('task_field_' + name, page).set_value(value)
    before = len(texts(session, 'task.begun', robot))
    session.until(Errand(
        lambda: session.hands.click('task_start_button', page),
        lambda: len(texts(session, 'task.begun', robot)) > before, AGAIN_S,
        lambda: robot in page.who_label.text() and page.start_button.isEnabled()),
        TIMEOUT_S, 'the start')


def under_way(session, robot):
    """Wait until a robot is driven by its task, and its row and tile say so.

    A computer that stalls for a moment loses the task: it is sent on, as an operator would.
    """
    row, tile = session.presenter.screen.robot_list.row(robot), session.presenter.windows[robot]

    def goes():
        return (view(session, robot).obeys == 'task' and view(session, robot).driven
                and row.task_pill.isVisibleTo(row) and tile.pill.word == 'ON TASK'
                and row.trouble.text().startswith('square'))
    session.until(Errand(
        lambda: session.presenter.parts['tasks'].carry_on(robot), goes, AGAIN_S,
        lambda: view(session, robot).task is None and view(session, robot).carry_on),
        TIMEOUT_S, robot + ' on its task, and row and tile to say so')


def end(session, robot, act, kind, undo=lambda: None):
    """Do what ends a task; return the text of its end. Where the task was lost before, undo it."""
    def ended_so():
        under_way(session, robot)
        lost, ended = len(texts(session, 'task.lost', robot)), len(texts(session, kind, robot))
        act()
        session.until(lambda: len(texts(session, kind, robot)) > ended
                      or len(texts(session, 'task.lost', robot)) > lost, TIMEOUT_S, 'its end')
        if len(texts(session, kind, robot)) > ended:
            return texts(session, kind, robot)[-1]
        undo()
        raise NotYet('its task was lost')
    return insist(ended_so, kind)


def check(session, robot, on):
    """Check a robot, or uncheck it, by the box of its row."""
    session.presenter.screen.arrangement.show_page(session.presenter.screen.robots_side)
    session.hands.click('check_' + robot)
    session.until(lambda: (robot in session.operator.selection.selected) == on, TIMEOUT_S, 'it')


def carry_on(session, robot):
    """Press "Continue" of a row once it is offered."""
    button = session.presenter.screen.robot_list.row(robot).carry_on_button
    session.until(lambda: button.isVisibleTo(session.presenter.screen), TIMEOUT_S, 'the offer')
    session.hands.click('carry_on_' + robot)


@pytest.fixture
def on_a_square(session):
    """Have bot1 on a square, unchecked and with nothing stopped, whatever ran before."""
    session.until(lambda: len(session.presenter.windows) == 2, TIMEOUT_S, 'the tiles')
    if session.operator.view().stop_all:
        session.operator.release()
        session.until(lambda: not session.operator.view().stop_all, TIMEOUT_S, 'the release')
    if 'bot1' in session.operator.selection.selected:
        check(session, 'bot1', False)
    if view(session, 'bot1').task is None:
        start(session, 'square', 'bot1', side=1.0)
    under_way(session, 'bot1')


def test_a_square_is_started_from_the_page(session, on_a_square):
    session.until(lambda: 'square: corner ' in session.presenter.windows['bot1'].hud.sentence,
                  TIMEOUT_S, 'the tile to say how it is getting on')
    assert set(texts(session, 'task.begun', 'bot1')) == {'square started'}
    assert view(session, 'bot2').task is None


def test_checking_it_takes_it_over(session, on_a_square):
    words = end(session, 'bot1', lambda: check(session, 'bot1', True), 'task.taken_over',
                lambda: check(session, 'bot1', False))
    assert words
    session.until(lambda: view(session, 'bot1').task is None, TIMEOUT_S, 'the end of its task')
    assert view(session, 'bot1').carry_on == ''


def test_unchecked_it_stands_and_is_sent_on_by_one_click(session, on_a_square):
    check(session, 'bot1', True)
    session.until(lambda: view(session, 'bot1').task is None, TIMEOUT_S, 'the end of its task')
    check(session, 'bot1', False)
    session.until(lambda: view(session, 'bot1').carry_on == 'Square', TIMEOUT_S, 'the offer')
    session.until(lambda: session.presenter.windows['bot1'].header.carry_on_button.text()
                  == 'Continue square', TIMEOUT_S, 'the offer in its tile')
    assert view(session, 'bot1').task is None
    carry_on(session, 'bot1')
    under_way(session, 'bot1')
    assert len(texts(session, 'task.begun', 'bot1')) >= 1


def test_stop_all_ends_it_and_nothing_resumes_by_itself(session, on_a_square):
    end(session, 'bot1', lambda: session.hands.click('stop_button'), 'task.stopped',
        session.operator.release)
    page = session.presenter.parts['tasks'].page
    session.presenter.parts['tasks'].start_task('hold', ['bot2'], {})
    assert page.problem.text()
    session.operator.release()
    session.until(lambda: not session.operator.view().stop_all, TIMEOUT_S, 'the release')
    session.until(lambda: view(session, 'bot1').carry_on == 'Square', TIMEOUT_S, 'the offer')
    assert view(session, 'bot1').task is None and not view(session, 'bot1').driven


def test_killed_the_program_of_the_tasks_is_missed_and_its_robots_are_lost(session):
    start(session, 'square', 'bot2', side=1.0)
    under_way(session, 'bot2')
    lost = len(texts(session, 'task.lost', 'bot2'))
    session.system.kill(session.runner)
    session.until(lambda: len(texts(session, 'task.lost', 'bot2')) > lost, TIMEOUT_S, 'the event')
    page = session.presenter.parts['tasks'].page
    session.until(lambda: 'is not running' in page.problem.text(), TIMEOUT_S, 'the page')
    session.until(lambda: not page.start_button.isEnabled(), TIMEOUT_S, 'the button')
    session.system.node('tasks', '__name:=mhri_tasks')
    session.until(lambda: page.start_button.isEnabled(), TIMEOUT_S, 'the tasks to be back')
    assert view(session, 'bot2').task is None
