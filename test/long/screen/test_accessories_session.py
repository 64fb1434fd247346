# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories of a simulated robot: from its tile or a voice to its topic, and back again.

The session is recorded: at its end it has what was used and reported, and so has its report.
"""
import contextlib
import glob
import itertools
import os
import subprocess
import sys

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton

from mhri.recording.folder import bags_of, read_events, read_info, robots_of
from support import graph
from support.panel_session import PanelSession
from support.room import Room
from support.ros_system import insist

LONG_S = 120.0
# Its lamp is that of the simulator; more would not fit in its tile.
ROWS = {'lamp': {'kind': 'toggle', 'topic': 'lamp', 'state': 'lamp_state', 'on_stop': 'keep'},
        'flipper': {'kind': 'hold', 'topic': 'flipper', 'type': 'std_msgs/Float64',
                    'on_stop': 'stop'}}
# To load the model on a busy computer, and to recognise a sentence [s].
HEAR_S = 60.0
MOTOR = """
import rospy
from std_msgs.msg import Float64
rospy.init_node('motor')
rospy.Subscriber('flipper', Float64, lambda message: None)
rospy.spin()
"""


class Session(PanelSession):
    """A screen with a robot that says itself what it has: a lamp and a flipper."""

    def bring(self):
        """Start the robot with its parameters, before anybody reads them."""
        import xmlrpc.client
        master = xmlrpc.client.ServerProxy(self.system.env['ROS_MASTER_URI'])
        master.setParam('/test', '/bot1/mhri/accessories', ROWS)
        self.system.launch('sim.launch', 'n:=1', 'types:=turtlebot3')
        # A screen that listens is no accessory.
        self.system.start(sys.executable, '-c', MOTOR, '__ns:=/bot1')
        self.system.node('mhri_session', '_record:=true', '_stop_free_mb:=1', '_warn_free_mb:=1',
                         '_folder:=' + self.recordings)

    @property
    def recordings(self):
        """The folder of the sessions."""
        return os.path.join(self.system.home, 'recordings')

    def recorded(self, what):
        """Return what the recorded session has of an event by now: pairs (robot, data)."""
        path, = glob.glob(os.path.join(self.recordings, '*', 'events.jsonl'))
        with open(path, encoding='utf-8') as file:
            return [(event.robot, event.data) for event in read_events(file.read())
                    if event.data.get('code') == what]

    def attach(self):
        """Listen to lamp and flipper."""
        import rospy
        from mhri.msg import PanelRequest
        from std_msgs.msg import Bool, Float64
        self.lit, self.turned = [], []
        self.ears = [rospy.Subscriber('/bot1/lamp', Bool,
                                      lambda message: self.lit.append(message.data)),
                     rospy.Subscriber('/bot1/flipper', Float64,
                                      lambda message: self.turned.append(message.data))]
        self.request = rospy.Publisher(graph.PANEL_REQUEST, PanelRequest, queue_size=10)
        self.until(self.request.get_num_connections, what='the panel to subscribe')

    def buttons(self, key):
        """Return the buttons of an accessory, once they obey."""
        tile = self.presenter.windows['bot1']

        def found():
            made = tile.bar.findChildren(QAbstractButton, 'accessory_' + key) if tile.bar else []
            return made if made and all(one.isVisible() and one.isEnabled() for one in made) \
                else None
        return self.until(found, what=key + ' to obey')

    def told(self, kind):
        """Return what the event list says of a kind."""
        return [event.text for event in self.presenter.parts['events'].log.events
                if event.kind == kind]


@pytest.fixture(scope='module')
def session():
    session = Session([], ['bot1'])
    try:
        session.attach()
        session.open('bot1').views_button.setChecked(False)
        yield session
    finally:
        session.close()


def test_a_click_lights_the_lamp_and_the_button_shows_what_the_robot_says(session):
    lamp, = session.buttons('lamp')
    session.until(lambda: 'off' in lamp.text(), what='its first report')
    QTest.mouseClick(lamp, Qt.LeftButton)
    session.until(lambda: session.lit[-1:] == [True] and lamp.isChecked(), what='the light')
    session.until(lambda: session.told('accessory.reported'), what='the event')
    assert session.told('accessory.used')


def test_a_request_switches_it_off_or_is_refused(session):
    session.buttons('lamp')
    session.request.publish(action='accessory', robots=['bot1'], key='lamp', choice='off')
    session.until(lambda: session.lit[-1:] == [False], what='the dark')
    session.request.publish(action='accessory', robots=['bot1'], key='lamp', choice='blue')
    session.until(lambda: session.told('request.refused'), what='the refusal')
    assert session.lit[-1:] == [False]


def test_what_is_said_reaches_the_lamp_and_is_shown(session):
    """It may not be understood, and it is not before the robot's words are known."""
    import rospy
    from mhri.msg import Heard
    from mhri.srv import SetSuspended
    from support.voice_case import require_speech, VOICES
    require_speech()
    session.buttons('lamp')
    lit, heard = len(session.lit), []
    ear = rospy.Subscriber(graph.HEARD, Heard, heard.append)
    resume = rospy.ServiceProxy('/mhri_voice/set_suspended', SetSuspended)

    def listens():
        with contextlib.suppress(rospy.ServiceException):
            answer = resume(False)
            return answer.success and 'reading the sound stream' in answer.message
        return False
    room = Room()
    node = session.system.node('mhri_voice', '__name:=mhri_voice', '_source:=' + room.path)
    try:
        session.until(listens, HEAR_S, 'the voice to listen')
        voices = itertools.cycle(VOICES)

        def taken():
            before = len(heard)
            room.say('robot, lamp on', next(voices))
            session.until(lambda: len(heard) > before, HEAR_S, 'an utterance')
            return any(item.command == 'lamp on' and item.accepted for item in heard)
        insist(taken, 'the words to be taken', HEAR_S)
        session.until(lambda: True in session.lit[lit:], HEAR_S,
                      'the light; heard {}'.format(heard))
    finally:
        session.system.kill(node)
        room.end()
        ear.unregister()


def test_the_flipper_turns_while_its_button_is_held_and_a_stop_ends_it(session):
    _, up = session.buttons('flipper')

    def turns():
        # After a pause of this process the drive asks for a new press.
        if up.isEnabled() and not up.isDown():
            QTest.mousePress(up, Qt.LeftButton)
        return 1.0 in session.turned

    for end in (lambda: QTest.mouseRelease(up, Qt.LeftButton),
                lambda: session.hands.click('stop_button')):
        session.buttons('flipper')
        session.turned.clear()
        session.until(turns, what='the flipper to turn')
        end()
        session.until(lambda: session.turned[-1] == 0.0, what='the flipper to stand')
    session.until(lambda: not up.isEnabled() and up.toolTip(), what='the reason')
    assert not up.isDown()


def test_the_recorded_session_has_what_was_used_and_reported(session):
    """By itself, whatever the tests before have done; a replay reads the same folder."""
    from mhri.graph.ros.resources import robot_types
    from mhri.nodes.mhri_replay import commands_of
    import rosbag
    import rospy
    from std_srvs.srv import SetBool
    session.operator.release()
    lamp, = session.buttons('lamp')
    session.until(lambda: 'lamp o' in lamp.text(), what='its state')
    for on in (not lamp.isChecked(), lamp.isChecked()):
        QTest.mouseClick(session.buttons('lamp')[0], Qt.LeftButton)
        session.until(lambda on=on: lamp.isChecked() == on, what='the report')
    for code in ('accessory.used', 'accessory.reported'):
        session.until(lambda code=code: ('bot1', 'lamp') in [
            (robot, data.get('key')) for robot, data in session.recorded(code)], what=code)
    rospy.wait_for_service('/mhri_session/record', LONG_S)
    assert rospy.ServiceProxy('/mhri_session/record', SetBool)(False).success
    folder, = glob.glob(os.path.join(session.recordings, '*'))
    session.until(lambda: not glob.glob(os.path.join(folder, '*.active')), what='the end')
    said = set()
    for name in bags_of(os.listdir(folder)):
        with rosbag.Bag(os.path.join(folder, name)) as bag:
            said |= {message.data for _, message, _ in bag.read_messages(
                topics=['/bot1/lamp_state'])}
    assert said == {True, False}
    with open(os.path.join(folder, 'session.yaml'), encoding='utf-8') as info, open(
            os.path.join(folder, 'events.jsonl'), encoding='utf-8') as events:
        robots = robots_of(read_info(info.read()), read_events(events.read()))
    assert commands_of(robots, robot_types()[0]) >= {'/bot1/lamp', '/bot1/flipper'}
    page = os.path.join(session.system.home, 'report')
    subprocess.run([sys.executable, '-c', 'from mhri.nodes.mhri_report import main; main()',
                    folder, '--output', page], check=True, timeout=LONG_S)
    with open(os.path.join(page, 'report.html'), encoding='utf-8') as file:
        assert 'lamp' in file.read()
