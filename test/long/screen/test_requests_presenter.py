# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the panel, recordings, the camera budget: three simulated robots."""
import os

import pytest

from mhri.driving.gui.hands import Errand
from support import graph
from support.panel_session import PanelSession

ROBOTS = ['bot1', 'bot2', 'bot3']
BUDGET = '/mhri/panel/camera_budget_mbit_s'
TIMEOUT_S = 60.0


@pytest.fixture(scope='module')
def session():
    session = PanelSession([('sim.launch', 'n:=3')], ROBOTS)
    yield session
    session.close()


@pytest.fixture(scope='module')
def ask(session):
    import rospy
    from mhri.msg import PanelRequest
    publisher = rospy.Publisher(graph.PANEL_REQUEST, PanelRequest, queue_size=10)
    session.until(publisher.get_num_connections, what='the panel to subscribe')
    return lambda action, *robots: publisher.publish(action=action, robots=robots)


def events(session):
    """Return the lines of the event list: {(robot, kind, text)}."""
    return {(event.robot, event.kind, event.text)
            for event in session.presenter.parts['events'].log.events}


def test_requests_change_the_selection_as_a_click_would(session, ask):
    """The panel stays the one publisher, and says what it does not do."""
    import rospy
    from mhri.msg import RobotSelect
    selections = []
    rospy.Subscriber(graph.SELECT, RobotSelect,
                     lambda message: selections.append(tuple(message.robots)))
    selection = session.operator.selection
    for action, robots, after in (
            ('select', ('bot2',), ('bot2',)), ('next', (), ('bot3',)), ('next', (), ('bot1',)),
            ('previous', (), ('bot3',)), ('select_all', (), tuple(ROBOTS)),
            ('deselect', ('bot1', 'bot2'), ('bot3',)), ('only', ('bot1',), ('bot1',)),
            ('select_none', (), ())):
        ask(action, *robots)
        session.until(lambda: selection.selected == after and selections[-1:] == [after],
                      what='{} {}'.format(action, robots))
    ask('select', 'bot9')
    session.until(lambda: 'bot9' in session.presenter.screen.look_label.text())
    ask('fly')
    session.until(lambda: 'fly' in session.presenter.screen.look_label.text())
    assert selection.selected == ()
    session.until(lambda: ['bot9' in text for _, kind, text in events(session)
                           if kind == 'request.refused'].count(True) == 1, what='the refusal')
    session.until(lambda: {(robot, kind) for robot, kind, _ in events(session)} >= {
        (name, kind) for name in ROBOTS
        for kind in ('link.found', 'drive.checked', 'drive.unchecked')}, what='the events')


def test_record_selected_records_each_and_says_how_it_ended(session, ask):
    recordings = session.operator.recordings
    session.operator.select(['bot1', 'bot3'])
    session.presenter.draw()
    session.hands.click('record_button')
    session.until(lambda: all(recordings.status(name).messages > 50 for name in ('bot1', 'bot3')),
                  what='messages of both')
    row = session.presenter.screen.robot_list.row('bot3')
    session.until(lambda: row.recording.word == 'rec', what='the row')
    session.hands.click('record_button')
    session.until(lambda: all(recordings.status(name).state == 'ended'
                              for name in ('bot1', 'bot3')), what='the ends')
    for name in ('bot1', 'bot3'):
        path = recordings.status(name).path
        assert os.path.dirname(path) == session.system.home and os.path.exists(path)
        # One that ends between the turns of list and line is in the list with the next drawing.
        session.until(lambda: {kind for robot, kind, text in events(session)
                               if robot == name and os.path.basename(path) in text} == {
            'recording.begun', 'recording.ended'}, what='the events')
    ask('record', 'bot2')
    session.until(lambda: recordings.running() == ('bot2',)
                  and recordings.status('bot2').messages > 10)
    # A start while the last file is still being closed is not lost.
    before = recordings.status('bot2').path
    recordings.stop('bot2')
    session.operator.record('bot2', '', ())
    session.until(lambda: recordings.status('bot2').messages > 10
                  and recordings.status('bot2').path not in ('', before))
    session.until(lambda: os.path.exists(before), what='the first file, closed whole')
    ask('stop_recording')
    session.until(lambda: recordings.running() == ())


def test_a_robot_that_is_removed_is_recorded_no_more_and_the_screen_says_so(session):
    recordings = session.operator.recordings
    session.operator.record('bot3', '', ())
    session.until(lambda: recordings.status('bot3').messages > 10)
    session.presenter.screen.robot_list.activate('bot3')
    asked = session.hands.widget('remove_label')
    session.hands.click('remove_button')
    session.until(lambda: asked.isVisible() and 'bot3' in asked.text(), what='the question')
    assert 'bot3' in recordings.running()
    session.hands.click('remove_confirm_button')
    session.until(lambda: recordings.status('bot3').state == 'ended', what='the end')
    assert recordings.running() == ()
    path = recordings.status('bot3').path
    session.until(lambda: path in session.presenter.screen.look_label.text())
    assert os.path.exists(path) and path.endswith('.bag'), 'closed whole'
    undo = session.hands.widget('undo_button')
    session.until(undo.isVisible, what='Undo')

    session.until(Errand(
        lambda: session.hands.click('undo_button'),
        lambda: 'bot3' in session.operator.selection.robots), what='the robot to be back')
    assert session.operator.selection.robots == tuple(ROBOTS), 'in its place'
    assert session.operator.selection.numbers.of('bot3') == 3
    assert 'bot3' not in session.operator.selection.selected
    session.until(lambda: session.operator.robot_view('bot3').link == 'live')


def words(session, name):
    """Return what a robot's tile says over its picture."""
    return session.presenter.windows[name].hud.sentence


def grants(session, name):
    """Return the words of a robot's camera, None while it has none."""
    feeds = session.operator.feeds(name)
    feed = feeds.get('rgb') if feeds else None
    return None if feed is None or feed.age_s() is None else feed.status().thinned


def test_the_driven_robot_keeps_its_picture_and_the_other_says_why_not(session):
    import rospy
    session.until(lambda: grants(session, 'bot1') == '' == grants(session, 'bot2'), TIMEOUT_S,
                  'both pictures')
    session.operator.select(['bot1'])
    # Next to nothing: less than the driven robot alone.
    rospy.set_param(BUDGET, 0.01)
    session.until(lambda: grants(session, 'bot2') and grants(session, 'bot2') in words(
        session, 'bot2'), TIMEOUT_S, 'what the tile says')
    assert grants(session, 'bot1') == ''
    session.until(lambda: session.operator.feeds('bot2').get('rgb').status().bits_per_s == 0.0,
                  TIMEOUT_S, 'nothing on the network')
    # Said once, and by name.
    session.until(lambda: 'camera.budget' in {kind for _, kind, _ in events(session)}, TIMEOUT_S,
                  'the note')
    # It is the other's turn.
    session.operator.select(['bot2'])
    session.until(lambda: grants(session, 'bot1') and grants(session, 'bot2') == '', TIMEOUT_S)
    rospy.set_param(BUDGET, 0)
    session.until(lambda: grants(session, 'bot1') == '', TIMEOUT_S)
    session.until(lambda: session.operator.feeds('bot1').get('rgb').status().age_s < 1.0,
                  TIMEOUT_S, 'a new picture')


def test_a_lost_robot_shakes_the_pad_once_and_push_to_talk_is_repeated(session):
    import rospy
    from std_msgs.msg import Bool, Empty
    shakes, talk = [], []
    subscribers = [rospy.Subscriber('/mhri_joy/rumble', Empty, shakes.append),
                   rospy.Subscriber('/mhri_voice/push_to_talk', Bool,
                                    lambda message: talk.append(message.data))]
    session.until(lambda: all(one.get_num_connections() for one in subscribers))
    session.operator.talk(True)
    session.until(lambda: talk.count(True) >= 3, what='the repetition while it is held')
    session.operator.talk(False)
    session.until(lambda: talk[-1] is False)
    session.operator.select(['bot3'])
    gone = session.system.start('rosnode', 'kill', '/bot3/base')
    session.until(lambda: gone.poll() is not None and shakes, what='the shake')
    session.until(lambda: session.operator.robot_view('bot3').link == 'gone')
    session.presenter.draw()
    assert len(shakes) == 1
