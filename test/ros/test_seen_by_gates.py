# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A row says what the gates say of its robot, and nothing where they say nothing."""
import pytest

from mhri.base.brake_view import WORDS
from mhri.base.views import LIVE, ProofView, RobotView, SILENT, UNANSWERED
from mhri.msg import RobotGate
from mhri.robots.gate_words import STANDS_WORDS
from mhri.robots.ros.convert import is_driven, round_trip_s
from mhri.robots.ros.robot_link import seen_by_gates

TOPIC = '/bot1/cmd_vel'


def gate(linear=0.0, angular=0.0, **values):
    robot = RobotGate(name='bot1', **dict(
        {'topic': TOPIC, 'obeys': RobotGate.OPERATOR, 'odometry_follows': True}, **values))
    robot.sent.linear.x, robot.sent.angular.z = linear, angular
    return robot


def view(**values):
    return RobotView('bot1', **dict({'link': LIVE}, **values))


@pytest.mark.parametrize('before, said, answers, expected', [
    (view(), gate(0.1), True, {'driven': True, 'slow': False, 'note': ''}),
    (view(), gate(0.0, -0.1), True, {'driven': True}),
    (view(), gate(), True, {'driven': False}),
    (view(), gate(0.1, topic=''), True, {'driven': False}),
    (view(), gate(0.1), False, {'driven': False, 'note': UNANSWERED, 'slow': True}),
    (view(note='slow link', slow=True), None, True, {'note': 'slow link', 'driven': False}),
    (view(), gate(stands=RobotGate.JOINING), True,
     {'waits': True, 'note': 'centre the stick to drive', 'slow': True}),
    (view(), gate(stands=RobotGate.NOT_HEARD), True, {'waits': False, 'slow': True}),
    (view(), gate(stands=RobotGate.JOINING, obeys=RobotGate.NOBODY), True, {'note': ''}),
    (view(link=SILENT, note='nothing for 3.2 s'), gate(stands=RobotGate.NOT_HEARD), True,
     {'note': 'nothing for 3.2 s'}),
    (view(), gate(0.1, obeys=RobotGate.TASK), True, {'note': 'on a task', 'slow': False}),
    (view(note='slow link', slow=True), gate(0.1, obeys=RobotGate.TASK), True,
     {'note': 'slow link'}),
    (view(), gate(guarded=True), True, {'guarded': True}),
    (view(), gate(brake=RobotGate.BRAKE_SLOWS, free_way_m=0.6), True,
     {'note': 'brake: slows for something 0.6 m ahead', 'slow': True}),
    (view(), gate(brake=RobotGate.BRAKE_CANNOT), True,
     {'note': 'no brake: it has no laser or depth camera', 'slow': False}),
    (view(note='slow link', slow=True), gate(brake=RobotGate.BRAKE_CANNOT), True,
     {'note': 'slow link'}),
    (view(), gate(back_after_s=10.0), True,
     {'note': 'goes back alone after 10 s without a link', 'slow': False}),
    (view(), gate(0.1, back_after_s=10.0), True, {'note': ''}),
    (view(), gate(power='cut'), True, {'note': 'motor power cut', 'slow': True}),
    (view(hardware_stop=True), gate(), True,
     {'note': 'its own emergency stop is pressed', 'slow': True}),
    (view(hardware_stop=False), gate(), True, {'note': '', 'slow': False}),
    (view(proof=ProofView('stopped', 'stopped in 20 ms')),
     gate(stop_confirmed=True, power='cut', stands=RobotGate.STOPPED), True,
     {'proof': ProofView('stopped', 'stopped in 20 ms, held by its guard, motor power cut')}),
    (view(proof=ProofView('waiting', 'stopping')), gate(stands=RobotGate.STOPPED), True,
     {'proof': ProofView('waiting', 'stopping'), 'note': ''}),
])
def test_a_row(before, said, answers, expected):
    after = seen_by_gates(before, said, answers)
    assert {key: getattr(after, key) for key in expected} == expected


def test_others_who_command_it_are_named():
    for before in (view(), view(proof=ProofView('waiting', 'stopping'))):
        after = seen_by_gates(before, gate(also_commanded_by=['/nav', '/bag']), True)
        assert after.also_commanded_by == ('/nav', '/bag')
        words = after.proof.text if after.proof else after.note
        assert '/nav' in words and '/bag' in words and after.slow


def test_odometry_that_does_not_follow_is_said():
    after = seen_by_gates(view(), gate(0.3, odometry_follows=False), True)
    assert not after.odometry_follows and after.slow and 'odometry' in after.note


def test_every_reason_to_stand_has_words():
    assert set(STANDS_WORDS) == {RobotGate.STOPPED, RobotGate.NOT_HEARD, RobotGate.JOINING,
                                 RobotGate.GUARD_VERSION, RobotGate.TWO_ROBOTS,
                                 RobotGate.UNREACHABLE}
    assert RobotGate.JOINING == 'joining', 'without a comment'


def test_the_words_of_the_brake_are_those_of_its_rule():
    assert WORDS == ('', RobotGate.BRAKE_ON, RobotGate.BRAKE_SLOWS, RobotGate.BRAKE_UNSEEN,
                     RobotGate.BRAKE_NO_SCAN, RobotGate.BRAKE_NO_PLACE, RobotGate.BRAKE_CANNOT)


def test_what_is_not_known_is_none():
    assert round_trip_s(gate(round_trip_s=float('nan'))) is None
    assert round_trip_s(gate(round_trip_s=0.25)) == 0.25
    assert not is_driven(gate())
