# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A row says what the drive says of its robot, and nothing where it says nothing."""
from pathlib import Path
import re

import pytest

from mhri.base.brake_view import WORDS
from mhri.base.accessories import Accessory
from mhri.base.reasons import DRIVE_SILENT, NO_LISTENER, Reason, RELEASE
from mhri.base.views import AccessoryView, LIVE, ProofView, SILENT
from mhri.msg import AccessoryState, RobotDrive
from mhri.robots.robot_view import robot_view
from mhri.robots.ros.convert import round_trip_s

TOPIC = '/bot1/cmd_vel'
MESSAGES = Path(__file__).resolve().parents[3] / 'msg'


def drive(linear=0.0, angular=0.0, **values):
    robot = RobotDrive(name='bot1', **dict(
        {'topic': TOPIC, 'obeys': RobotDrive.OPERATOR, 'odometry_follows': True}, **values))
    robot.sent.linear.x, robot.sent.angular.z = linear, angular
    return robot


def view(**values):
    return dict({'name': 'bot1', 'link': LIVE}, **values)


@pytest.mark.parametrize('before, said, answers, expected', [
    (view(), drive(0.1), True, {'driven': True, 'slow': False, 'note': ''}),
    (view(), drive(0.0, -0.1), True, {'driven': True}),
    (view(), drive(), True, {'driven': False}),
    (view(), drive(0.1, topic=''), True, {'driven': False}),
    (view(), drive(0.1), False, {'driven': False, 'note': Reason(DRIVE_SILENT).what, 'slow': True}),
    (view(note='slow link', slow=True), None, True, {'note': 'slow link', 'driven': False}),
    (view(), drive(stands=RobotDrive.JOINING), True,
     {'waits': True, 'note': 'centre the stick to drive', 'slow': True}),
    (view(), drive(stands=RobotDrive.NOT_HEARD), True, {'waits': False, 'slow': True}),
    (view(), drive(stands=RobotDrive.JOINING, obeys=RobotDrive.NOBODY), True, {'note': ''}),
    (view(link=SILENT, note='nothing for 3.2 s'), drive(stands=RobotDrive.NOT_HEARD), True,
     {'note': 'nothing for 3.2 s'}),
    (view(), drive(0.1, obeys=RobotDrive.TASK), True, {'note': 'on a task', 'slow': False}),
    (view(note='slow link', slow=True), drive(0.1, obeys=RobotDrive.TASK), True,
     {'note': 'slow link'}),
    (view(), drive(guarded=True), True, {'guarded': True}),
    (view(), drive(brake=RobotDrive.BRAKE_SLOWS, free_way_m=0.6), True,
     {'note': 'brake: slows for something 0.6 m ahead', 'slow': True}),
    (view(), drive(brake=RobotDrive.BRAKE_CANNOT), True,
     {'note': 'no brake: it has no laser or depth camera', 'slow': False}),
    (view(note='slow link', slow=True), drive(brake=RobotDrive.BRAKE_CANNOT), True,
     {'note': 'slow link'}),
    (view(), drive(back_after_s=10.0), True,
     {'note': 'goes back alone after 10 s without a link', 'slow': False}),
    (view(), drive(0.1, back_after_s=10.0), True, {'note': ''}),
    (view(), drive(power='cut', stands=RobotDrive.POWER_CUT), True,
     {'note': 'motor power cut', 'slow': True}),
    (view(), drive(power='failed'), True, {'note': 'motor power not changed', 'slow': True}),
    (view(), drive(power='on'), True, {'note': '', 'slow': False}),
    (view(), drive(power='cannot'), True, {'note': '', 'slow': False}),
    (view(), drive(stands=RobotDrive.HARDWARE_STOP), True,
     {'note': 'its own emergency stop is pressed', 'slow': True, 'hardware_stop': True}),
    (view(), drive(stands=RobotDrive.STOPPED_ALONE, obeys=RobotDrive.NOBODY), True,
     {'note': 'stopped alone: deselect and select it to drive it', 'slow': True}),
    (view(), drive(0.1, stands=RobotDrive.LIMIT_RAISED), True,
     {'note': 'limit raised: deselect and select it to use its new speed limit', 'driven': True}),
    (view(hardware_stop=True), drive(), True,
     {'note': 'its own emergency stop is pressed', 'slow': True}),
    (view(hardware_stop=False), drive(), True, {'note': '', 'slow': False}),
    (view(proof=ProofView('stopped', 'stopped in 20 ms')),
     drive(stop_confirmed=True, power='cut', stands=RobotDrive.STOPPED), True,
     {'proof': ProofView('stopped', 'stopped in 20 ms, held by its guard, motor power cut')}),
    (view(proof=ProofView('waiting', 'stopping')), drive(stands=RobotDrive.STOPPED), True,
     {'proof': ProofView('waiting', 'stopping'), 'note': ''}),
    (view(proof=ProofView('stopped', 'stopped in 20 ms')), drive(stands=RobotDrive.STOPPED_ALONE),
     True, {'proof': ProofView('stopped', 'stopped in 20 ms, select it to drive it'),
            'note': '', 'slow': False}),
])
def test_a_row(before, said, answers, expected):
    after = robot_view(before, said, answers)
    assert {key: getattr(after, key) for key in expected} == expected


def test_others_who_command_it_are_named():
    for before in (view(), view(proof=ProofView('waiting', 'stopping'))):
        after = robot_view(before, drive(also_commanded_by=['/nav', '/bag']), True)
        assert after.also_commanded_by == ('/nav', '/bag')
        words = after.proof.text if after.proof else after.note
        assert '/nav' in words and '/bag' in words and after.slow


def test_odometry_that_does_not_follow_is_said():
    found = robot_view(view(), drive(0.3), True, found='filtered')
    assert not found.odometry_follows and found.slow and 'filtered' in found.note
    after = robot_view(view(), drive(0.3, odometry_follows=False), True)
    assert not after.odometry_follows and after.slow and 'odometry' in after.note


@pytest.mark.parametrize('name, first_field', [
    ('RobotDrive', 'bool selected'), ('DriveState', 'Header header')])
def test_every_reason_to_stand_has_words(name, first_field):
    constants = (MESSAGES / (name + '.msg')).read_text().partition('\n' + first_field)[0]
    codes = set(re.findall(r'^string \w+=(\w+)$', constants, re.M)) - {
        RobotDrive.OPERATOR, RobotDrive.TASK, RELEASE}
    assert len(codes) > 4 and not [code for code in codes if Reason(code).what == code]


def test_the_words_of_the_brake_are_those_of_its_rule():
    assert WORDS == ('', RobotDrive.BRAKE_ON, RobotDrive.BRAKE_SLOWS, RobotDrive.BRAKE_UNSEEN,
                     RobotDrive.BRAKE_NO_SCAN, RobotDrive.BRAKE_NO_PLACE, RobotDrive.BRAKE_CANNOT)


def test_what_is_not_known_is_none():
    assert round_trip_s(drive(round_trip_s=float('nan'))) is None
    assert round_trip_s(drive(round_trip_s=0.25)) == 0.25


@pytest.mark.parametrize('optional, stands, shown', [
    (False, NO_LISTENER, True), (True, NO_LISTENER, False), (True, 'not_selected', True),
    (True, None, True)])
def test_what_this_robot_does_not_have_is_not_shown(optional, stands, shown):
    """None: the drive has not said anything of it yet."""
    states = [] if stands is None else [AccessoryState(key='gripper', stands=stands)]
    row = AccessoryView(Accessory('gripper', key='gripper', optional=optional))
    found = robot_view(view(accessories=(row,)), drive(accessories=states)).accessories
    assert [one.stands for one in found] == ([stands or ''] if shown else [])


@pytest.mark.parametrize('link', ['live', 'waiting'])
def test_what_keeps_a_robot_from_ever_being_driven_is_said_also_of_one_not_heard(link):
    said = drive(stands=RobotDrive.UNREACHABLE, obeys=RobotDrive.NOBODY)
    before = dict(view(), link=link, note='' if link == 'live' else 'nothing heard yet')
    assert robot_view(before, said, problem='select husky').note.endswith(': select husky')
    assert 'multiplexer' in robot_view(before, said).note
