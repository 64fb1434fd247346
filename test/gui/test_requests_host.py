# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the panel, recordings of several robots, motion capture: with simulated robots."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.panel_session import PanelSession  # noqa: E402

ROBOTS = ['bot1', 'bot2', 'bot3']


@pytest.fixture(scope='module')
def session():
    session = PanelSession([('sim.launch', 'n:=3', 'mocap:=true')], ROBOTS)
    yield session
    session.close()


@pytest.fixture(scope='module')
def ask(session):
    import rospy
    from mhri.msg import PanelRequest
    publisher = rospy.Publisher('/panel_in/request', PanelRequest, queue_size=10)
    session.until(publisher.get_num_connections, what='the ear of the panel')
    return lambda action, *robots: publisher.publish(action=action, robots=robots)


def events(session):
    """Return what the event list has told: {(robot, kind, text)}."""
    return {(event.robot, event.kind, event.text) for event in session.host.events.log.events}


def test_requests_change_the_selection_as_a_click_would(session, ask):
    """The panel stays the one publisher, and says what it does not do."""
    import rospy
    from mhri.msg import RobotSelect
    heard = []
    rospy.Subscriber('/robot_controller/robot_select', RobotSelect,
                     lambda message: heard.append(tuple(message.robots)))
    selection = session.operator.selection
    for action, robots, after in (
            ('select', ('bot2',), ('bot2',)), ('next', (), ('bot3',)), ('next', (), ('bot1',)),
            ('previous', (), ('bot3',)), ('select_all', (), tuple(ROBOTS)),
            ('deselect', ('bot1', 'bot2'), ('bot3',)), ('only', ('bot1',), ('bot1',)),
            ('select_none', (), ())):
        ask(action, *robots)
        session.until(lambda: selection.selected == after and heard and heard[-1] == after,
                      what='{} {}'.format(action, robots))
    ask('select', 'bot9')
    session.until(lambda: 'bot9 is not in the list' in session.host.screen.look_label.text())
    ask('fly')
    session.until(lambda: 'fly' in session.host.screen.look_label.text())
    assert selection.selected == ()
    told = events(session)
    assert ('', 'request.refused', 'not done: bot9 is not in the list: add it first') in told
    assert {(name, 'link.found', 'found') for name in ROBOTS} <= told
    assert {(robot, kind) for robot, kind, _ in told} >= {
        (name, kind) for name in ROBOTS for kind in ('drive.checked', 'drive.unchecked')}


def test_record_selected_records_each_and_says_how_it_ended(session, ask):
    recordings = session.operator.recordings
    session.host._select(['bot1', 'bot3'])
    session.host.draw()
    session.hands.click('record_button')
    session.until(lambda: all(recordings.status(name).messages > 50 for name in ('bot1', 'bot3')),
                  what='messages of both')
    session.until(lambda: session.host.screen.record_button.text() == 'Stop recording (2)')
    assert session.host.screen.robot_list.row('bot3').recording.word == 'rec'
    session.hands.click('record_button')
    session.until(lambda: session.host.screen.look_label.text().count('saved') == 2)
    for name in ('bot1', 'bot3'):
        path = recordings.status(name).path
        assert os.path.dirname(path) == session.system.home and os.path.exists(path)
        assert {kind for robot, kind, text in events(session)
                if robot == name and os.path.basename(path) in text} == {
            'recording.begun', 'recording.ended'}
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


def test_commands_of_the_robot_itself_are_recorded_where_asked_for(session):
    """Whoever merely listens to the robot's velocity topic changes nothing."""
    from mhri.screen.presenters.demo import Grip
    from rosbag import Bag
    name = 'bot1'
    session.host._select([name])
    session.operator.record(name, '', ['commands'])
    recordings = session.operator.recordings
    session.until(lambda: recordings.status(name).messages > 5)
    session.until(Grip(lambda: session.hands.hold_stick(0.6, 0.0), session.hands.let_go,
                       lambda: session.operator.view().status,
                       lambda: session.operator.robot_view(name).driven), what='motion')
    session.hands.let_go()
    session.until(lambda: not session.operator.robot_view(name).driven, what='rest')
    recordings.stop(name)
    session.until(lambda: recordings.status(name).state == 'ended')
    with Bag(recordings.status(name).path) as bag:
        sent = [message.linear.x for _, message, _ in bag.read_messages(['/bot1/teleop/input'])]
    assert max(sent) > 0.1 and sent[-1] == 0.0, 'the command and the zero that ended it'


def test_a_robot_that_is_removed_is_recorded_no_more_and_the_screen_says_so(session):
    recordings = session.operator.recordings
    session.operator.record('bot3', '', ())
    session.until(lambda: recordings.status('bot3').messages > 10)
    session.host.screen.robot_list.activate('bot3')
    asked = session.hands.widget('remove_label')
    session.hands.click('remove_button')
    session.until(lambda: asked.isVisible() and asked.text()
                  == 'bot3 is being recorded: remove it?', what='the question')
    assert 'bot3' in recordings.running()
    session.hands.click('remove_confirm_button')
    session.until(lambda: recordings.status('bot3').state == 'ended', what='the end')
    assert recordings.running() == ()
    path = recordings.status('bot3').path
    session.until(lambda: session.host.screen.look_label.text().startswith('bot3: saved'))
    assert os.path.exists(path) and path.endswith('.bag'), 'closed whole'
    undo = session.hands.widget('undo_button')
    session.until(undo.isVisible, what='Undo')

    def is_back():
        session.hands.click('undo_button')
        return 'bot3' in session.operator.selection.robots
    session.until(is_back, what='the robot to be back')
    assert session.operator.selection.robots == tuple(ROBOTS), 'in its place'
    assert session.operator.selection.numbers.of('bot3') == 3
    assert 'bot3' not in session.operator.selection.selected
    session.until(lambda: session.operator.robot_view('bot3').link == 'live')


def test_motion_capture_ages_and_bandwidth_show(session):
    window = session.open('bot2')
    session.switch(window, 'camera_rgb')
    session.switch(window, 'view_imu')
    session.until(lambda: 'captured x' in str(window.state_line.texts()),
                  what='motion capture')
    assert 'odometry off 0.0' in str(window.state_line.texts())
    session.until(lambda: 'RGB' in str(window.state_line.texts())
                  and 'IMU' in str(window.state_line.texts()))
    session.until(lambda: 'Mbit/s' in session.host.screen.cameras_label.text())
    window.hide()
    session.until(lambda: session.operator.feeds('bot2').get('mocap') is None,
                  what='nothing to be heard for a hidden window')


def test_the_camera_budget_follows_its_parameters(session):
    import rospy
    rospy.set_param('/mhri/panel', {'thumbnail_hz': 2.0, 'record_stop_free_mb': 100})
    session.until(lambda: session.operator.settings.thumbnail_hz == 2.0)
    assert session.operator.recordings.limits.stop_free_bytes == 100_000_000
    rospy.set_param('/mhri/panel', {'thumbnail_hz': -1})
    session.until(lambda: session.operator.settings.record_stop_free_mb == 256.0)
    assert session.operator.settings.thumbnail_hz == 2.0, 'what cannot be used stays as it was'


def test_the_list_is_told_to_voice_and_pad(session):
    import rospy
    session.until(lambda: rospy.get_param('/mhri/robots', None) == ROBOTS)
    assert rospy.get_param('/mhri/robot_numbers') == {'bot1': 1, 'bot2': 2, 'bot3': 3}


def test_a_lost_robot_shakes_the_pad_once_and_talking_opens_the_ear(session):
    import rospy
    from std_msgs.msg import Bool, Empty
    shakes, talk = [], []
    ears = [rospy.Subscriber('/mhri_joy/rumble', Empty, shakes.append),
            rospy.Subscriber('/mhri_voice/push_to_talk', Bool,
                             lambda message: talk.append(message.data))]
    session.until(lambda: all(ear.get_num_connections() for ear in ears))
    session.operator.talk(True)
    session.until(lambda: talk.count(True) >= 3, what='to be told again while it is held')
    session.operator.talk(False)
    session.until(lambda: talk[-1] is False)
    session.host._select(['bot3'])
    gone = session.system.start('rosnode', 'kill', '/bot3/base')
    session.until(lambda: gone.poll() is not None and shakes, what='the shake')
    session.until(lambda: session.operator.robot_view('bot3').link == 'gone')
    session.host.draw()
    assert len(shakes) == 1
