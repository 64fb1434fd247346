# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""R, N and P: the session recorded and marked by keys of the X server's own keyboard."""
import glob
import os

import pytest
from test_keyboard_session import ROBOTS, Session

from mhri.recording.folder import marks_of, read_events
from support.graph import STICK


class Recorded(Session):
    """A person at the keyboard, with the recorder of the session."""

    def __init__(self):
        super().__init__()
        self.recorder = self.system.node('mhri_session', '_stop_free_mb:=1', '_warn_free_mb:=1')
        for name in ROBOTS:
            self.operator.add(name)
        self.until(lambda: set(self.host.windows) == set(ROBOTS), 'the tiles')
        self.until(lambda: self.view.there, 'the recorder')

    @property
    def part(self):
        return self.host.parts['session']

    @property
    def view(self):
        return self.part._client.view()

    @property
    def button(self):
        return self.part.button

    @property
    def note(self):
        return self.part.note_bar

    def events(self):
        path, = glob.glob(os.path.join(self.system.home, 'mhri', 'sessions', '*', 'events.jsonl'))
        with open(path, encoding='utf-8') as file:
            return read_events(file.read())


@pytest.fixture(scope='module')
def session():
    running = Recorded()
    yield running
    running.close()


def test_1_r_records(session):
    session.to_the_pictures()
    assert session.button.text() == 'Record'
    session.key('r')
    session.until(lambda: session.button.text().startswith('REC 0'), 'the button to say so')
    assert session.button.isChecked()
    labels = [tile.header.rec_label for tile in session.host.windows.values()]
    session.until(lambda: all(label.isVisible() and label.text().startswith('REC')
                              for label in labels), 'every tile to say so')
    session.until(lambda: [event.kind for event in session.events()].count('start') == 1,
                  'the first line')


def test_2_n_marks_and_asks_what_is_here(session):
    session.to_the_pictures()
    # Nothing is checked: keys do not drive, and the note has the keyboard at once.
    stop = session.screen.stop_bar.stop_button
    before = stop.mapToGlobal(stop.rect().topLeft()), stop.size()
    session.key('n')
    session.until(lambda: session.note.isVisible() and session.note.edit.hasFocus(), 'the note')
    assert (stop.mapToGlobal(stop.rect().topLeft()), stop.size()) == before, 'STOP ALL has moved'
    session.xdotool('type', 'a red door, seen from W')
    session.until(lambda: session.note.edit.text().endswith('W'), 'the typing')
    session.key('Return')
    session.until(lambda: not session.note.isVisible(), 'the note to go')
    assert session.screen.stage.hasFocus(), 'the keys drive again'
    session.until(lambda: [mark.text for mark in marks_of(session.events())]
                  == ['a red door, seen from W'], 'the note at its mark')


def words_typed(session, words):
    """Press N and type words at once; return what has become of them."""
    session.key('n')
    session.xdotool('type', '--delay', '20', words)
    session.until(lambda: session.note.edit.text() == words, 'the words')
    session.key('Return')
    session.until(lambda: marks_of(session.events())[-1].text == words, 'the note at its mark')
    session.until(lambda: not session.note.isVisible(), 'the note to go')


def test_3_words_typed_after_n_command_nothing(session):
    import rospy
    from sensor_msgs.msg import Joy
    session.to_the_pictures()
    session.key('0')
    session.until(lambda: session.selected == ROBOTS, 'all')
    session.until(lambda: session.operator.view().status.endswith('ready'), 'ready')
    heard = []
    subscriber = rospy.Subscriber(STICK, Joy, lambda message: heard.append(tuple(message.axes)),
                                  queue_size=50)
    session.until(lambda: heard, 'the stick')
    for words in ('wall with water', 'red barrel', 'door 12, mapped'):
        words_typed(session, words)
    assert not any(any(axes) for axes in heard)
    assert session.selected == ROBOTS and session.view.on
    subscriber.unregister()


def test_3_while_keys_drive_only_n_again_opens_the_note(session):
    session.to_the_pictures()
    session.key('2')
    session.until(lambda: session.selected == ('bot1',), 'bot1 alone')
    session.until(lambda: session.operator.view().status.endswith('ready'), 'ready')
    marks = len(marks_of(session.events()))
    session.xdotool('keydown', 'd')
    try:
        session.until(lambda: session.screen.stick() == (0.0, -1.0), 'the key to drive')
        session.key('n')
        session.until(session.note.isVisible, 'the note')
        assert session.screen.stage.hasFocus() and session.screen.stick() == (0.0, -1.0)
        session.until(session.witnesses['bot1'].moving, 'bot1 to drive')
        session.key('n')
        session.until(lambda: session.note.edit.hasFocus(), 'the note to have the keyboard')
        assert session.screen.stick() == (0.0, 0.0), 'who types does not drive'
        session.rests()
    finally:
        session.xdotool('keyup', 'd')
    session.xdotool('type', 'sand')
    session.until(lambda: session.note.edit.text() == 'sand', 'the typing, without the held key')
    session.key('Return')
    session.until(lambda: not session.note.isVisible(), 'the note to go')
    session.until(lambda: marks_of(session.events())[-1].text == 'sand', 'the note at its mark')
    assert len(marks_of(session.events())) == marks + 1, 'N again is no other mark'
    session.key('1')
    session.until(lambda: session.selected == (), 'none')


def test_4_p_keeps_what_the_cameras_show(session):
    session.to_the_pictures()

    def still():
        session.key('p')
        session.until(lambda: session.part._client.answers.empty(), 'the answer')
        return any(event.kind == 'still' for event in session.events())
    session.until(still, 'a still')
    names = [name for event in session.events() for name in event.data.get('stills', ())]
    folder = session.view.folder
    assert names and all(os.path.getsize(os.path.join(folder, name)) > 500 for name in names)


def test_5_a_mark_has_the_stills_of_what_is_in_sight(session):
    session.to_the_pictures()

    def stills():
        """Mark once more, without a note; return what it has."""
        before = len(marks_of(session.events()))
        session.key('n')
        session.until(lambda: len(marks_of(session.events())) > before, 'the mark')
        session.until(lambda: session.note.isVisible() and session.note.edit.hasFocus(), 'the note')
        session.key('Escape')
        session.until(lambda: not session.note.isVisible(), 'the note to go')
        return marks_of(session.events())[-1].stills
    session.until(stills, 'a mark with stills')
    assert session.screen.stage.hasFocus()


def test_6_events_of_the_screen_are_kept(session):
    session.host.events.note('battery.low', 'battery 25 %: charge it soon', 'bot1')
    session.until(lambda: [event.robot for event in session.events()
                           if event.kind == 'battery'] == ['bot1'], 'the battery')
    kinds = [event.kind for event in session.events()]
    assert kinds.count('selection') == 3, 'seen on the graph, and not told by the screen as well'


def test_6_a_drill_is_on_the_screen_while_it_runs(session):
    from mhri.msg import DrillState
    import rospy
    referee = rospy.Publisher('/mhri_drill/state', DrillState, queue_size=1, latch=True)
    line = session.host.parts['drill'].line
    assert not line.isVisible(), 'without a drill nothing speaks of one'

    def say(words, **fields):
        """Let the referee say it, until it can be read."""
        state = DrillState(title='Maze', about='Find the plant.', limit_s=300.0, **fields)

        def shown():
            state.header.stamp = rospy.Time.now()
            referee.publish(state)
            session.until(line.isVisible, 'the line')
            return line.text().startswith(words)
        session.until(shown, words)
    say('Drill Maze: Find the plant. The clock', left=['plant'])
    say('Drill Maze: 0 of 1 found, 4:17 left', left=['plant'], phase=1, elapsed_s=43.0)
    say('Drill Maze: found after 1:03; page: /a/drill.html',
        found=['plant'], phase=2, elapsed_s=63.0, ended='all found', page='/a/drill.html')
    session.until(lambda: [event.text for event in session.events() if 'Maze' in event.text] == [
        'drill Maze: Find the plant.', 'drill Maze: begun', 'drill Maze: plant found',
        'drill Maze: found after 1:03; page: /a/drill.html'], 'the events')
    referee.publish(DrillState(title='Maze'))
    session.until(lambda: not line.isVisible(), 'what was said long ago to go')
    referee.unregister()


def test_7_a_recorder_that_is_killed_is_said(session):
    session.system.kill(session.recorder)
    session.until(lambda: session.button.text() == 'not recorded !', 'the button to say so')
    session.until(lambda: any(event.kind == 'session.trouble'
                              for event in session.host.events.log.events), 'the event')
    session.recorder = session.system.node('mhri_session', '_stop_free_mb:=1', '_warn_free_mb:=1')
    session.until(lambda: session.button.text().startswith('REC 0'), 'the recorder to go on')


def test_8_r_ends_it(session):
    session.to_the_pictures()
    session.key('r')
    session.until(lambda: session.button.text() == 'Record', 'the button to say so')
    assert not session.button.isChecked()
    session.until(lambda: not glob.glob(os.path.join(session.view.folder, '*1.bag.active')),
                  'the bag to be closed')
    session.until(lambda: session.events()[-1].kind == 'end', 'the last line')
