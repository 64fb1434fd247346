# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session without a mouse: keys of the X server's own keyboard, with simulated robots.

First the robots are found, driven and stopped; then R, N and P record and mark the session.
"""
import glob
import os
import time

import pytest
from python_qt_binding.QtWidgets import QApplication, QWidget

from mhri.base.reasons import Reason, STOPPED
from mhri.driving.gui.hands import Errand
from mhri.events.events import MARKED
from mhri.recording.folder import marks_of, read_events
from mhri.robots.gui.remove_steps import SETTLED_S
from support.graph import STICK
from support.keyboard import Keyboard, xdotool
from support.ros_system import System, wait_for

ROBOTS = ('bot1', 'bot2')
MAX_TABS = 60
# The places of 1, 2, 3 and Enter there.
NUMBER_PAD = '87', '88', '89', '104'


class Session:
    """A person at the keyboard of the program, with two simulated robots."""

    def __init__(self):
        from mhri.standalone import Standalone
        self.system = System()
        self.system.screen()
        self.system.start_master()
        self.system.node('mux', '__name:=mux')
        self.recorder = self.start_recorder()
        self.system.launch('sim.launch', 'n:=2')
        self.app = QApplication.instance() or QApplication(['panel', '-style', 'Fusion'])
        self.program = Standalone(['panel'], os.path.join(self.system.home, 'panel.json'))
        self.presenter, self.screen = self.program.presenter, self.program.presenter.screen
        self.program.window.resize(1280, 900)
        self.program.window.show()
        self.presenter.start()
        self.operator = self.presenter.operator
        self.until(lambda: self.operator.view().mode, 'the mux')
        from support.robots import Witness
        self.witnesses = {name: Witness(name) for name in ROBOTS}
        self.until(lambda: all(one.live() for one in self.witnesses.values()), 'the robots')
        window = str(int(self.program.window.winId()))
        self.until(lambda: (xdotool('windowfocus', window),
                            self.program.window.isActiveWindow())[-1], 'the keyboard')
        self.keyboard = Keyboard(self.until)

    def start_recorder(self):
        return self.system.node('mhri_session', '_stop_free_mb:=1', '_warn_free_mb:=1')

    @property
    def part(self):
        return self.presenter.parts['session']

    @property
    def button(self):
        return self.part.button

    @property
    def note(self):
        return self.part.note_bar

    @property
    def folder(self):
        path, = glob.glob(os.path.join(self.system.home, 'mhri', 'sessions', '*'))
        return path

    def events(self):
        with open(os.path.join(self.folder, 'events.jsonl'), encoding='utf-8') as file:
            return read_events(file.read())

    def until(self, condition, what, timeout_s=60.0):
        """Let Qt work until a condition comes true."""
        return wait_for(condition, timeout_s, what, turn=self.app.processEvents)

    def hold(self, key, condition, what):
        """Hold a key until a condition comes true; let go and hold it again now and then."""
        def press():
            if pressing.times > 1:
                self.keyboard.release(key)
            xdotool('keydown', key)
        pressing = Errand(press, condition, 4.0)
        try:
            self.until(pressing, what)
        finally:
            self.keyboard.release(key)
        self.until(lambda: not any(self.screen.stick()), 'the stick to be centred')

    def tab_to(self, name, key='Tab'):
        """Go to a control by Tab, or by Shift+Tab."""
        wanted = self.screen.findChild(QWidget, name)
        for _ in range(MAX_TABS):
            if self.app.focusWidget() is wanted:
                return
            before = self.app.focusWidget()
            self.keyboard.press(key)
            self.until(lambda: self.app.focusWidget() is not before, 'the focus to go on')
        raise AssertionError('no way by Tab to ' + name)

    def to_the_panel(self):
        """Take the keyboard to the list."""
        self.to_the_pictures()
        self.keyboard.press('F6')
        self.until(self.screen.robot_list.hasFocus, 'the list to have the keyboard')

    def to_the_foot(self):
        """Take the keyboard to the foot."""
        self.to_the_panel()
        self.keyboard.press('F6')
        self.until(lambda: self.screen.foot.isAncestorOf(self.app.focusWidget()), 'the foot')

    def to_the_pictures(self):
        """Take the keyboard to the pictures."""
        for _ in range(3):
            if self.screen.stage.hasFocus():
                return
            before = self.app.focusWidget()
            self.keyboard.press('F6')
            self.until(lambda: self.app.focusWidget() is not before, 'the keyboard to go on')
        assert self.screen.stage.hasFocus()

    @property
    def selected(self):
        return self.operator.selection.selected

    def rests(self):
        self.until(lambda: all(one.at_rest() for one in self.witnesses.values()), 'standstill')

    def close(self):
        import rospy
        self.keyboard.close()
        self.program.window.close_now()
        self.program.delete_window()
        rospy.signal_shutdown('done')
        self.system.close()


@pytest.fixture(scope='module')
def session():
    running = Session()
    yield running
    running.close()


@pytest.fixture(autouse=True)
def at_start(session):
    """Look for robots, unless they were found, and select none, whatever ran before."""
    if session.operator.selection.robots == ():
        session.to_the_panel()
        session.tab_to('look_button')
        session.keyboard.press('Return')
        session.until(lambda: session.operator.selection.robots == ROBOTS, 'what was found')
    session.to_the_pictures()
    # It selects all, and none where all are.
    session.until(Errand(lambda: session.keyboard.press('0'), lambda: session.selected in (
        (), ROBOTS), ready=lambda: session.selected not in ((), ROBOTS)), 'all or none')
    if session.selected:
        session.keyboard.press('0')
        session.until(lambda: session.selected == (), 'none')


@pytest.fixture
def recorded(session, at_start):
    """Record the session, as R does."""
    if not session.button.isChecked():
        session.keyboard.press('r')
    session.until(session.button.isChecked, 'the button to say so')
    session.until(lambda: 'start' in [event.kind for event in session.events()], 'the first line')


def test_look(session):
    session.until(lambda: all(session.operator.robot_view(name).link == 'live'
                              for name in ROBOTS), 'two live robots')
    session.until(lambda: set(session.presenter.windows) == set(ROBOTS), 'the tiles')


def remove(session, name):
    """Take the last robot off the list."""
    session.to_the_panel()
    session.until(lambda: session.screen.robot_list.current is None, 'no highlight')
    for _ in range(3):
        session.keyboard.press('Down')
    session.until(lambda: session.screen.robot_list.current == name, 'the highlight')
    session.tab_to('remove_button', 'shift+Tab')
    session.keyboard.press('Return')
    session.until(lambda: session.operator.selection.robots == ROBOTS, name + ' to go')


def test_add_remove_and_undo(session):
    session.to_the_panel()
    session.tab_to('name_edit')
    session.keyboard.type('bot9')
    session.until(lambda: session.screen.name_edit.text() == 'bot9', 'the typing')
    session.keyboard.press('Return')
    session.until(lambda: session.operator.selection.robots == (*ROBOTS, 'bot9'), 'bot9')
    remove(session, 'bot9')
    session.until(session.screen.remove_steps.undo_button.hasFocus, 'Undo to have the keyboard')
    shown_at = time.monotonic()
    session.until(lambda: time.monotonic() - shown_at > SETTLED_S, 'the buttons to be seen')
    session.keyboard.press('Return', 'Return')
    session.until(lambda: session.operator.selection.robots == (*ROBOTS, 'bot9'), 'bot9 back')
    session.until(session.screen.robot_list.hasFocus, 'the list to have the keyboard')
    remove(session, 'bot9')
    assert session.selected == ()


def test_select_and_drive(session):
    session.to_the_pictures()
    session.keyboard.press('1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.hold('w', session.witnesses['bot1'].moving, 'bot1 to drive')
    session.rests()
    session.keyboard.press('0')
    session.until(lambda: session.selected == ROBOTS, 'all')
    session.keyboard.press('0')
    session.until(lambda: session.selected == (), 'none')
    session.keyboard.press('ctrl+2')
    session.until(lambda: session.selected == ('bot2',), 'bot2 alone')
    assert session.screen.stage.looked_at == 'bot2' and session.screen.stage.large == ('bot2',)
    session.hold('Left', session.witnesses['bot2'].moving, 'bot2 to turn')
    session.rests()


def test_tab_looks_and_enter_drives_the_one_looked_at(session):
    session.to_the_pictures()
    session.keyboard.press('ctrl+1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.keyboard.press('Tab')
    session.until(lambda: session.screen.stage.looked_at == 'bot2', 'bot2 to be looked at')
    assert session.selected == ('bot1',), 'to look is not to drive'
    session.keyboard.press('Return')
    session.until(lambda: session.selected == ('bot2',), 'bot2 alone')
    session.keyboard.press('shift+Tab')
    session.until(lambda: session.screen.stage.looked_at == 'bot1', 'bot1 to be looked at')
    session.keyboard.press('Escape')
    session.until(lambda: session.screen.stage.looked_at == '', 'nobody to be looked at')
    assert session.screen.stage.large == ('bot2',), 'the one that is driven'


def test_with_shift_the_key_stops_the_robot_of_that_number_alone(session):
    """By its place; never the number pad, whatever Num Lock makes of it."""
    session.to_the_pictures()
    session.keyboard.press('ctrl+2')
    session.until(lambda: session.selected == ('bot2',), 'bot2 alone')
    stopped = []
    session.screen.stop_robot_requested.connect(stopped.append)
    for place in NUMBER_PAD:
        session.keyboard.press('shift+' + place)
    session.keyboard.press('shift+0')
    assert stopped == [] and session.selected == ('bot2',)
    session.keyboard.press('shift+2')
    session.until(lambda: session.operator.robot_view('bot2').proof, 'the stop')
    session.keyboard.press('shift+2')
    assert stopped == ['bot2', 'bot2'] and session.selected == (), 'no toggle'
    assert not session.operator.view().stop_all
    session.screen.stop_robot_requested.disconnect(stopped.append)


def test_record(session):
    session.to_the_pictures()
    recordings = session.operator.recordings
    session.keyboard.press('ctrl+1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.to_the_panel()
    session.tab_to('record_button', 'shift+Tab')
    session.keyboard.press('Return')
    session.until(lambda: recordings.status('bot1').messages > 20, 'a recording')
    session.program.window.close()
    bar = session.screen.leave_bar
    assert 'bot1' in bar.question
    session.until(bar.stay_button.hasFocus, 'the answer to have the keyboard')
    session.keyboard.press('Return')
    session.until(lambda: not bar.isVisible(), 'the screen to stay')
    session.to_the_panel()
    session.tab_to('record_button', 'shift+Tab')
    session.keyboard.press('Return')
    session.until(lambda: recordings.status('bot1').state == 'ended', 'its end')
    assert os.path.exists(recordings.status('bot1').path)


def test_stop_all_and_release(session):
    session.to_the_pictures()
    session.keyboard.press('ctrl+1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.keyboard.press('shift+space')
    session.until(lambda: all(robot.proof and robot.proof.state == 'stopped'
                              for robot in session.operator.view().robots), 'the proofs')
    session.hold('w', lambda: Reason(STOPPED).what in
                 session.presenter.windows['bot1'].hud.sentence, 'bot1 to say why it stands')
    session.rests()

    bar = session.screen.stop_bar
    session.to_the_foot()
    assert bar.release_button.hasFocus()
    session.keyboard.press('Return')
    session.until(bar.confirm_button.isVisible, 'the second step')
    assert bar.cancel_button.hasFocus(), 'a second Return releases nothing'
    session.tab_to('confirm_button', 'shift+Tab')
    session.keyboard.press('Return')
    session.until(lambda: not session.operator.view().stop_all, 'the release')


def test_r_records(session):
    session.to_the_pictures()
    assert not session.button.isChecked()
    session.keyboard.press('r')
    session.until(session.button.isChecked, 'the button to say so')
    labels = [tile.header.rec_label for tile in session.presenter.windows.values()]
    session.until(lambda: all(label.isVisible() for label in labels), 'every tile to say so')
    session.until(lambda: [event.kind for event in session.events()].count('start') == 1,
                  'the first line')


def test_n_marks_and_asks_what_is_here(session, recorded):
    session.to_the_pictures()
    # Nothing is checked: keys do not drive, and the note has the keyboard at once.
    stop = session.screen.stop_bar.stop_button
    before = stop.mapToGlobal(stop.rect().topLeft()), stop.size()
    session.keyboard.press('n')
    session.until(lambda: session.note.isVisible() and session.note.edit.hasFocus(), 'the note')
    assert (stop.mapToGlobal(stop.rect().topLeft()), stop.size()) == before, 'STOP ALL has moved'
    session.keyboard.type('a red door, seen from W')
    session.until(lambda: session.note.edit.text().endswith('W'), 'the typing')
    session.keyboard.press('Return')
    session.until(lambda: not session.note.isVisible(), 'the note to go')
    assert session.screen.stage.hasFocus(), 'the keys drive again'
    session.until(lambda: [mark.text for mark in marks_of(session.events())]
                  == ['a red door, seen from W'], 'the note at its mark')
    rows = session.presenter.parts['events'].log
    session.until(lambda: [event.text for event in rows.events if event.kind == MARKED]
                  == ['mark 1: a red door, seen from W'], 'the mark and its note in one line')


def words_typed(session, words):
    """Press N and type words at once; return what has become of them."""
    session.keyboard.press('n')
    session.keyboard.type(words)
    session.until(lambda: session.note.edit.text() == words, 'the words')
    session.keyboard.press('Return')
    session.until(lambda: marks_of(session.events())[-1].text == words, 'the note at its mark')
    session.until(lambda: not session.note.isVisible(), 'the note to go')


def test_words_typed_after_n_command_nothing(session, recorded):
    import rospy
    from sensor_msgs.msg import Joy
    session.to_the_pictures()
    session.keyboard.press('0')
    session.until(lambda: session.selected == ROBOTS, 'all')
    session.until(lambda: session.operator.view().status.endswith('ready'), 'ready')
    heard = []
    subscriber = rospy.Subscriber(STICK, Joy, lambda message: heard.append(tuple(message.axes)),
                                  queue_size=50)
    session.until(lambda: heard, 'the stick')
    for words in ('wall with water', 'red barrel', 'door 12, mapped'):
        words_typed(session, words)
    assert not any(any(axes) for axes in heard)
    assert session.selected == ROBOTS and session.button.isChecked()
    subscriber.unregister()


def test_while_keys_drive_only_n_again_opens_the_note(session, recorded):
    session.to_the_pictures()
    session.keyboard.press('1')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.until(lambda: session.operator.view().status.endswith('ready'), 'ready')
    marks = len(marks_of(session.events()))
    xdotool('keydown', 'd')
    try:
        session.until(lambda: session.screen.stick() == (0.0, -1.0, 0.0), 'the key to drive')
        session.keyboard.press('n')
        session.until(session.note.isVisible, 'the note')
        assert session.screen.stage.hasFocus() and session.screen.stick() == (0.0, -1.0, 0.0)
        session.keyboard.press('n')
        session.until(lambda: session.note.edit.hasFocus(), 'the note to have the keyboard')
        assert session.screen.stick() == (0.0, 0.0, 0.0), 'who types does not drive'
        session.rests()
    finally:
        session.keyboard.release('d')
    session.keyboard.type('sand')
    session.until(lambda: session.note.edit.text() == 'sand', 'the typing, without the held key')
    session.keyboard.press('Return')
    session.until(lambda: not session.note.isVisible(), 'the note to go')
    session.until(lambda: marks_of(session.events())[-1].text == 'sand', 'the note at its mark')
    assert len(marks_of(session.events())) == marks + 1, 'N again is no other mark'


def test_p_and_a_mark_keep_what_the_cameras_show(session, recorded):
    session.to_the_pictures()

    def stills():
        """Mark once more, without a note; return what it has."""
        before = len(marks_of(session.events()))
        session.keyboard.press('n')
        session.until(lambda: len(marks_of(session.events())) > before, 'the mark')
        session.until(lambda: session.note.isVisible() and session.note.edit.hasFocus(), 'the note')
        session.keyboard.press('Escape')
        session.until(lambda: not session.note.isVisible(), 'the note to go')
        return marks_of(session.events())[-1].stills
    session.until(stills, 'a mark with stills')
    assert session.screen.stage.hasFocus()
    session.keyboard.press('p')
    session.until(lambda: any(event.kind == 'still' for event in session.events()), 'a still')
    names = [name for event in session.events() for name in event.data.get('stills', ())]
    assert names and all(os.path.getsize(os.path.join(session.folder, name)) > 500
                         for name in names)


def test_a_drill_is_on_the_screen_while_it_runs(session, recorded):
    from mhri.msg import DrillState
    import rospy
    referee = rospy.Publisher('/mhri_drill/state', DrillState, queue_size=1, latch=True)
    line = session.presenter.parts['drill'].line
    assert not line.isVisible(), 'without a drill nothing speaks of one'

    def say(words, **fields):
        """Let the referee say it, until it can be read."""
        state = DrillState(title='Maze', about='Find the plant.', limit_s=300.0, **fields)

        def shown():
            state.header.stamp = rospy.Time.now()
            referee.publish(state)
            session.until(line.isVisible, 'the line')
            return words in line.text()
        session.until(shown, words)
    say('Find the plant.', left=['plant'])
    say('4:17', left=['plant'], phase=1, elapsed_s=43.0)
    say('/a/drill.html', found=['plant'], phase=2, elapsed_s=63.0, ended='all found',
        page='/a/drill.html')
    session.until(lambda: [event.data['code'] for event in session.events()
                           if 'Maze' in event.text] == [
        'drill.waits', 'drill.begun', 'drill.found', 'drill.ended'], 'the events')
    referee.publish(DrillState(title='Maze'))
    session.until(lambda: not line.isVisible(), 'what was said long ago to go')
    referee.unregister()


def test_a_recorder_that_is_killed_is_said(session, recorded):
    session.system.kill(session.recorder)
    session.until(lambda: any(event.kind == 'session.trouble'
                              for event in session.presenter.parts['events'].log.events),
                  'the event')
    recorded = [event.kind for event in session.events()].count('record')
    session.recorder = session.start_recorder()
    session.until(lambda: session.part.recorded_s is not None and [
        event.kind for event in session.events()].count('record') > recorded,
        'the recorder to go on')


def test_r_ends_it(session, recorded):
    session.to_the_pictures()
    session.keyboard.press('r')
    session.until(lambda: not session.button.isChecked(), 'the button to say so')
    session.until(lambda: not glob.glob(os.path.join(session.folder, '*1.bag.active')),
                  'the bag to be closed')
    session.until(lambda: session.events()[-1].kind == 'end', 'the last line')
