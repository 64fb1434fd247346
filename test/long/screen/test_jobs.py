# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""In how few actions an operator does a job: real keys and clicks, simulated robots."""
from functools import partial

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest

from mhri.base.views import PROOF_STOPPED
from mhri.driving.gui.hands import Errand, Grip
from mhri.events.events import MARKED
from mhri.screen.gui.stage import MAP_BESIDE
from support import maps
from support.keyboard import Keyboard, xdotool
from support.panel_session import PanelSession

ROBOTS = ('bot1', 'bot2', 'bot3', 'bot7')
TIMEOUT_S = 120.0
AGAIN_S = 10.0


class Operator:
    """The operator's hands: each key, click and drag counts as an action, typing a text as none."""

    def __init__(self, session):
        self.session = session
        self.screen, self.backend = session.presenter.screen, session.operator
        self.pane = session.presenter.parts['map'].pane
        self.keyboard = Keyboard(lambda condition, what: session.until(condition, what=what))
        self.actions = 0

    def until(self, condition, what):
        return self.session.until(condition, TIMEOUT_S, what)

    def key(self, key):
        """Press a key and release it."""
        self.actions += 1
        self.keyboard.press(key)

    def click(self, widget):
        """Click a widget."""
        self.actions += 1
        self.until(widget.isVisible, 'it to be there')
        QTest.mouseClick(widget, Qt.LeftButton)

    def hold(self, key, condition, what):
        """Hold a drive key until a condition comes true."""
        self.actions += 1
        try:
            self.until(Grip(lambda: xdotool('keydown', key), lambda: self.keyboard.release(key),
                            lambda: self.backend.view().status, condition), what)
        finally:
            self.keyboard.release(key)
        self.until(lambda: not any(self.screen.stick()), 'the stick to be centred')

    @property
    def selected(self):
        return self.backend.selection.selected

    def robot(self, name):
        """Return the newest view of a robot, as the screen shows it."""
        return next(robot for robot in self.session.presenter.parts['tasks'].view.robots
                    if robot.name == name)

    def place(self, name):
        """Return where a robot is on the map (x, y) [m], None where it is not."""
        robot = self.pane.view.scene.robot(name)
        return (robot.pose.x_m, robot.pose.y_m) if robot is not None and robot.pose else None


@pytest.fixture(scope='module')
def running():
    session = PanelSession([
        ('sim.launch', 'n:=3'),
        ('turtlebot.launch', 'name:=bot7', 'placed:=true')], ROBOTS)
    session.system.node('tasks', '__name:=mhri_tasks')
    session.system.node('mhri_session', '_stop_free_mb:=1', '_warn_free_mb:=1')
    screen = session.presenter.screen
    session.until(lambda: (xdotool('windowfocus', str(int(screen.winId()))),
                           screen.isActiveWindow())[-1], TIMEOUT_S, 'the keyboard')
    made = Operator(session)
    screen.stage.show_map(MAP_BESIDE)
    made.until(lambda: len(session.presenter.windows) == len(ROBOTS)
               and all(map(made.place, ROBOTS)),
               'the robots on the map')
    yield made
    made.keyboard.close()
    session.close()


@pytest.fixture
def operator(running):
    """At rest, bot1 selected and looked at, the keyboard at the pictures."""
    running.backend.release()
    running.until(lambda: not running.backend.view().stop_all, 'no stop')
    running.backend.select(['bot1'])
    running.screen.look_at('bot1')
    running.screen.stage.setFocus()
    running.until(lambda: running.selected == ('bot1',) and not running.backend.view().waits_for
                  and not any(running.robot(name).moving for name in ROBOTS), 'rest')
    running.actions = 0
    return running


def test_from_nothing_to_driving_all(operator):
    operator.backend.select([])
    operator.until(lambda: operator.selected == (), 'nobody')
    operator.key('0')
    operator.hold('Up', lambda: all(operator.robot(name).moving for name in ROBOTS), 'all to drive')
    assert operator.actions <= 3


def test_from_one_robot_to_another(operator):
    operator.key('ctrl+7')
    operator.until(lambda: operator.selected == ('bot7',), 'bot7 alone')
    assert operator.actions == 1


def test_one_robot_is_stopped(operator):
    operator.key('shift+1')
    operator.until(lambda: operator.robot('bot1').proof is not None
                   and operator.robot('bot1').proof.state == PROOF_STOPPED, 'the proof')
    assert operator.actions == 1 and not operator.backend.view().stop_all


def test_three_are_sent_to_a_place_while_one_is_driven(operator):
    def drag(name):
        """Send a robot; once more only where a busy computer has lost the task."""
        x_m, y_m = operator.place(name)
        maps.drag(operator.pane, (x_m, y_m), (x_m + 1.5, y_m))
    for name in ROBOTS[1:]:
        operator.actions += 1
        operator.until(Errand(partial(drag, name), lambda: operator.robot(name).on_task, AGAIN_S),
                       name + ' on its way')
    assert operator.selected == ('bot1',) and operator.actions == 3


def test_one_is_driven_by_hand_after_a_task(operator):
    def start():
        operator.session.presenter.parts['tasks'].start_task('hold', ['bot3'], {})
    operator.until(Errand(start, lambda: operator.robot('bot3').on_task, AGAIN_S), 'its task')
    operator.key('ctrl+3')
    operator.until(lambda: operator.selected == ('bot3',) and not operator.robot('bot3').on_task,
                   'it to be driven by hand')
    assert operator.actions == 1


def test_why_a_robot_does_not_move(operator):
    operator.key('Tab')
    operator.until(lambda: operator.screen.stage.looked_at == 'bot2', 'bot2 to be looked at')
    hud = operator.session.presenter.windows['bot2'].hud
    operator.hold('Up', lambda: hud.sentence, 'the reason in its tile')
    assert operator.actions <= 2


def test_a_mark_with_a_note(operator):
    operator.key('n')
    operator.keyboard.type('a red door')
    note = operator.session.presenter.parts['session'].note_bar
    operator.until(lambda: note.edit.text() == 'a red door', 'the typing')
    operator.keyboard.press('Return')
    log = operator.session.presenter.parts['events'].log
    operator.until(lambda: any(event.kind == MARKED and 'a red door' in event.text
                               for event in log.events), 'the mark with its note')
    assert operator.actions == 1


def test_a_stop_is_released(operator):
    operator.backend.stop_all()
    operator.until(lambda: operator.backend.view().stop_all, 'the stop')
    bar = operator.screen.stop_bar
    operator.click(bar.release_button)
    operator.click(bar.confirm_button)
    operator.until(lambda: not operator.backend.view().stop_all, 'the release')
    assert operator.actions == 2
