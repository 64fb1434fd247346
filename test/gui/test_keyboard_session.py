# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session without a mouse: keys of the X server's own keyboard, with simulated robots."""
import glob
import os
import subprocess
import sys
import time

import pytest
from python_qt_binding.QtWidgets import QApplication, QWidget

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.robots.gui.remove_steps import SETTLED_S  # noqa: E402
from support.graph import STICK  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

ROBOTS = ('bot1', 'bot2')
MOST_TABS = 60


class Session:
    """A person at the keyboard of the program, with two simulated robots."""

    def __init__(self):
        from mhri.standalone import Standalone
        self.system = System()
        self.system.screen()
        self.system.start_master()
        self.system.node('mux', '__name:=mux')
        self.system.node('gates')
        self.system.launch('sim.launch', 'n:=2')
        self.app = QApplication.instance() or QApplication(['panel', '-style', 'Fusion'])
        self.program = Standalone(['panel'], os.path.join(self.system.home, 'panel.json'))
        self.host, self.screen = self.program.host, self.program.host.screen
        self.program.window.resize(1280, 900)
        self.program.window.show()
        self.host.start()
        self.operator = self.host.operator
        self.until(lambda: self.operator.view().mode, 'the mux')
        from support.robots import Witness
        self.witnesses = {name: Witness(name) for name in ROBOTS}
        self.until(lambda: all(one.live() for one in self.witnesses.values()), 'the robots')
        window = str(int(self.program.window.winId()))
        self.until(lambda: (self.xdotool('windowfocus', window),
                            self.program.window.isActiveWindow())[-1], 'the keyboard')

    @staticmethod
    def xdotool(*words):
        subprocess.run(('xdotool',) + words, check=True, timeout=30)

    def until(self, condition, what, timeout_s=60.0):
        """Let Qt work until a condition comes true."""
        return wait_for(lambda: (self.app.processEvents(), condition())[-1], timeout_s, what)

    def key(self, *keys):
        """Press keys and let them go, one after the other."""
        for key in keys:
            self.xdotool('key', key)

    def hold(self, key, condition, what):
        """Hold a key until a condition comes true; let go and hold it again now and then."""
        pressed_at = [0.0]

        def turn():
            if time.monotonic() - pressed_at[0] > 4.0:
                self.xdotool('keyup', key)
                self.until(lambda: self.screen.stick() == (0.0, 0.0), 'the key to be up')
                self.xdotool('keydown', key)
                pressed_at[0] = time.monotonic()
            return condition()
        try:
            self.until(turn, what)
        finally:
            self.xdotool('keyup', key)
        self.until(lambda: self.screen.stick() == (0.0, 0.0), 'the key to be up')

    def tab_to(self, name, key='Tab'):
        """Go to a control by Tab, or by Shift+Tab."""
        wanted = self.screen.findChild(QWidget, name)
        for _ in range(MOST_TABS):
            if self.app.focusWidget() is wanted:
                return
            before = self.app.focusWidget()
            self.key(key)
            self.until(lambda: self.app.focusWidget() is not before, 'the focus to go on')
        raise AssertionError('no way by Tab to ' + name)

    def to_the_panel(self):
        """Take the keyboard to the list."""
        self.to_the_pictures()
        self.key('F6')
        self.until(self.screen.robot_list.hasFocus, 'the list to have the keyboard')

    def to_the_foot(self):
        """Take the keyboard to the foot."""
        self.to_the_panel()
        self.key('F6')
        self.until(lambda: self.screen.foot.isAncestorOf(self.app.focusWidget()), 'the foot')

    def to_the_pictures(self):
        """Take the keyboard to the pictures."""
        for _ in range(3):
            if self.screen.stage.hasFocus():
                return
            before = self.app.focusWidget()
            self.key('F6')
            self.until(lambda: self.app.focusWidget() is not before, 'the keyboard to go on')
        assert self.screen.stage.hasFocus()

    @property
    def selected(self):
        return self.operator.selection.selected

    def rests(self):
        self.until(lambda: all(one.at_rest() for one in self.witnesses.values()), 'standstill')

    def close(self):
        import rospy
        self.program.window.close_now()
        self.program.delete_window()
        rospy.signal_shutdown('done')
        self.system.close()


@pytest.fixture(scope='module')
def session():
    running = Session()
    yield running
    running.close()


def test_1_look(session):
    session.to_the_panel()
    session.tab_to('look_button', 'shift+Tab')
    session.key('Return')
    session.until(lambda: session.operator.selection.robots == ROBOTS, 'what was found')
    session.until(lambda: all(session.operator.robot_view(name).link == 'live'
                              for name in ROBOTS), 'two live robots')
    session.until(lambda: set(session.host.windows) == set(ROBOTS), 'the tiles')


def test_2_add_remove_and_undo(session):
    session.to_the_panel()
    session.tab_to('name_edit', 'shift+Tab')
    session.xdotool('type', 'bot9')
    session.until(lambda: session.screen.name_edit.text() == 'bot9', 'the typing')
    session.key('Return')
    session.until(lambda: session.operator.selection.robots == (*ROBOTS, 'bot9'), 'bot9')
    session.to_the_panel()
    for _ in range(3):
        session.key('Down')
    session.until(lambda: session.screen.robot_list.current == 'bot9', 'the highlight')
    session.tab_to('remove_button')
    session.key('Return')
    session.until(lambda: session.operator.selection.robots == ROBOTS, 'bot9 to go')
    undo = session.screen.remove_steps.undo_button
    session.until(undo.hasFocus, 'Undo to have the keyboard')

    shown_at = time.monotonic()
    session.until(lambda: time.monotonic() - shown_at > SETTLED_S, 'the buttons to be seen')
    session.key('Return', 'Return')
    session.until(lambda: session.operator.selection.robots == (*ROBOTS, 'bot9'), 'bot9 back')
    session.until(session.screen.robot_list.hasFocus, 'the list to have the keyboard')
    session.to_the_panel()
    session.until(lambda: session.screen.robot_list.current is None, 'no highlight')
    for _ in range(3):
        session.key('Down')
    session.until(lambda: session.screen.robot_list.current == 'bot9', 'the highlight')
    session.tab_to('remove_button')
    session.key('Return')
    session.until(lambda: session.operator.selection.robots == ROBOTS, 'bot9 to go')
    assert session.selected == ()


def test_3_select_and_drive(session):
    session.to_the_pictures()
    session.key('1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.hold('w', session.witnesses['bot1'].moving, 'bot1 to drive')
    session.rests()
    session.key('0')
    session.until(lambda: session.selected == ROBOTS, 'all')
    session.key('0')
    session.until(lambda: session.selected == (), 'none')
    session.key('ctrl+2')
    session.until(lambda: session.selected == ('bot2',), 'bot2 alone')
    assert session.screen.stage.looked_at == 'bot2' and session.screen.stage.large == ('bot2',)
    session.hold('Left', session.witnesses['bot2'].moving, 'bot2 to turn')
    session.rests()


def test_3_shift_and_the_number_pad_drive_nothing(session):
    import rospy
    from sensor_msgs.msg import Joy
    session.to_the_pictures()
    heard = []
    subscriber = rospy.Subscriber(STICK, Joy, lambda message: heard.append(tuple(message.axes)),
                                  queue_size=50)
    # What X11 makes of Shift and a digit depends on Num Lock.
    for _ in range(2):
        for place in ('80', '83', '85', '88'):
            session.xdotool('keydown', 'shift', 'keydown', place)
            del heard[:]
            session.until(lambda: len(heard) > 3, 'the stick to be told')
            session.xdotool('keyup', place, 'keyup', 'shift')
            assert not any(any(axes) for axes in heard)
        session.key('Num_Lock')
    assert session.selected == ('bot2',) and session.witnesses['bot2'].at_rest()
    subscriber.unregister()


def test_4_tab_looks_and_enter_drives_the_one_looked_at(session):
    session.to_the_pictures()
    session.key('ctrl+1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.key('Tab')
    session.until(lambda: session.screen.stage.looked_at == 'bot2', 'bot2 to be looked at')
    assert session.selected == ('bot1',), 'to look is not to drive'
    session.key('Return')
    session.until(lambda: session.selected == ('bot2',), 'bot2 alone')
    session.key('shift+Tab')
    session.until(lambda: session.screen.stage.looked_at == 'bot1', 'bot1 to be looked at')
    session.key('Escape')
    session.until(lambda: session.screen.stage.looked_at == '', 'nobody to be looked at')
    assert session.screen.stage.large == ('bot2',), 'the one that is driven'


def test_5_why_it_stands_and_what_was_asked(session):
    session.to_the_pictures()
    tiles = session.host.windows
    session.key('ctrl+1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.hold('w', lambda: 'not selected: press 2' in tiles['bot2'].hud.sentence,
                 'bot2 to say why it stands')
    session.until(lambda: not tiles['bot2'].hud.sentence, 'nothing to be said')
    session.until(lambda: any('to the nearest thing' in line for line in tiles['bot1'].hud.lines),
                  'the nearest thing')
    assert not tiles['bot1'].view('scan').isVisible(), 'without its view'
    session.rests()


def test_6_keys_of_the_screen(session):
    session.to_the_pictures()
    screen = session.screen
    for key, state in (('h', lambda: not screen.stage.numbers_shown),
                       ('F2', lambda: not screen.drawer.isVisible()),
                       ('F1', screen.key_help.isVisible)):
        session.key(key)
        session.until(state, key)
        session.key(key)
        session.until(lambda: not state(), key + ' again')
    session.key('F1')
    session.until(screen.key_help.isVisible, 'the keys')
    session.key('Escape')
    session.until(lambda: not screen.key_help.isVisible(), 'no keys')
    session.until(lambda: session.host.windows['bot1'].view('rgb').picture.frame is not None,
                  'a picture')
    session.key('p')
    session.until(lambda: glob.glob(os.path.join(session.system.home, 'bot1*.png')), 'a still')


def test_7_record(session):
    session.to_the_pictures()
    recordings = session.operator.recordings
    session.key('ctrl+1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.to_the_panel()
    session.tab_to('record_button')
    session.key('Return')
    session.until(lambda: recordings.status('bot1').messages > 20, 'a recording')
    session.program.window.close()
    bar = session.screen.leave_bar
    assert bar.question == 'bot1 is being recorded: close anyway?'
    session.until(bar.stay_button.hasFocus, 'the answer to have the keyboard')
    session.key('Return')
    session.until(lambda: not bar.isVisible(), 'the screen to stay')
    session.to_the_panel()
    session.tab_to('record_button')
    session.key('Return')
    session.until(lambda: recordings.status('bot1').state == 'ended', 'its end')
    assert os.path.exists(recordings.status('bot1').path)


def test_8_stop_all_and_release(session):
    session.to_the_pictures()
    session.key('shift+space')
    session.until(lambda: all(robot.proof and robot.proof.state == 'stopped'
                              for robot in session.operator.view().robots), 'the proofs')
    session.hold('w', lambda: 'STOP ALL is in force' in session.host.windows['bot1'].hud.sentence,
                 'bot1 to say why it stands')
    session.rests()

    bar = session.screen.stop_bar
    session.to_the_foot()
    assert bar.release_button.hasFocus()
    session.key('Return')
    session.until(bar.confirm_button.isVisible, 'the second step')
    assert bar.cancel_button.hasFocus(), 'a second Return releases nothing'
    session.tab_to('confirm_button', 'shift+Tab')
    session.key('Return')
    session.until(lambda: not session.operator.view().stop_all, 'the release')
