# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Why a robot stands though the stick is held: one row for each reason, and for each silence."""
from dataclasses import replace

import pytest

from mhri.base import reasons
from mhri.base.brake_view import brake_words, BrakeView, guard_words
from mhri.base.limits import Velocity, ZERO
from mhri.base.reasons import Reason
from mhri.base.task_views import TaskView
from mhri.base.views import (
    ControlView, DeviceView, GONE, LIVE, RobotView, ROS_CONNECTED, ROS_CUT_OFF, ROS_NO_MASTER,
    ScreenView, SILENT, WAITING)
from mhri.screen.why import MOMENT_S, MOTORS_S, why_still, WhyStill

SOURCES = (('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller'))
BOT = RobotView('bot3', link=LIVE, age_s=0.01, selected=True, obeys='operator', number=3,
                linear_mps=0.0, angular_rad_s=0.0, sent=ZERO)
PANEL = ScreenView(ros=ROS_CONNECTED, sources=SOURCES, mode='joy', robots=(BOT,))
AHEAD, LEFT, REST = (1.0, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 0.0)
ASIDE, CAN = (0.0, 0.0, 1.0), {'holonomic': True}
OTHER = RobotView('bot4', selected=True)
PAD = {'mode': 'ps3joy'}
HELD = {'mode': 'ps3joy', 'pushed': True}
PUSHED = {'mode': 'ps3joy', 'asked': Velocity(0.3)}

# Changes of the panel, of the robot, the stick, the reason and its names.
SAID = {
    'no master': ({'ros': ROS_NO_MASTER}, {}, AHEAD, reasons.NO_CONNECTION),
    'cut off': ({'ros': ROS_CUT_OFF}, {}, AHEAD, reasons.NO_CONNECTION),
    'stop all': ({'stop_all': True}, {}, AHEAD, reasons.STOPPED),
    'stop all, not selected': ({'stop_all': True}, {'selected': False}, LEFT, reasons.STOPPED),
    'another operator': ({'control': ControlView(False, 'panel on lab-pc2', '14:02')}, {}, AHEAD,
                         reasons.NOT_OURS, 'panel on lab-pc2'),
    'somebody': ({'control': ControlView(False)}, {}, AHEAD, reasons.NOT_OURS, 'somebody else'),
    'no drive': ({'answers': False}, {}, AHEAD, reasons.DRIVE_SILENT),
    'not selected': ({}, {'selected': False}, AHEAD, reasons.NOT_SELECTED, 'press 3'),
    'not selected, by pad': (HELD, {'selected': False}, REST, reasons.NOT_SELECTED, 'press 3'),
    'no key': ({}, {'selected': False, 'number': 10}, AHEAD, reasons.NOT_SELECTED,
               'check it in the list'),
    'on a task': ({}, {'selected': False, 'obeys': 'task'}, AHEAD, reasons.ON_TASK, 'press 3'),
    'on a known task': ({}, {'selected': False, 'task': TaskView('Square')}, AHEAD,
                        reasons.ON_TASK, 'square; press 3'),
    'another mode': (PAD, {}, AHEAD, reasons.OTHER_SOURCE, 'PS3 Controller', 'Virtual joystick'),
    'no pad': ({**PUSHED, 'devices': (DeviceView('ps3joy', note='not connected: plug it in'),)}, {},
               REST, reasons.DEVICE, 'not connected: plug it in'),
    'pad silent': ({**PUSHED, 'waits_for': 'source',
                    'advice': Reason(reasons.NO_PUBLISHER, ('/joy',))}, {}, REST,
                   reasons.NO_PUBLISHER, '/joy'),
    'pad not heard yet': ({**PUSHED, 'waits_for': 'source'}, {}, REST, reasons.SOURCE,
                          'PS3 Controller'),
    'dead-man': ({**HELD, 'waits_for': 'dead_man'}, {}, REST, reasons.DEAD_MAN),
    'pedal': ({**HELD, 'waits_for': 'enabling'}, {}, REST, reasons.ENABLING),
    'neutral': ({'waits_for': 'neutral'}, {}, AHEAD, reasons.NEUTRAL),
    'stop all, by pad': ({**HELD, 'stop_all': True, 'waits_for': 'release'}, {}, REST,
                         reasons.STOPPED),
    'gone, by pad': (HELD, {'link': GONE}, REST, reasons.LINK_LOST, 'switched off or out of reach'),
    'neutral of a pad': ({**HELD, 'waits_for': 'neutral'}, {}, REST, reasons.NEUTRAL),
    'silent': ({}, {'link': SILENT, 'note': 'nothing for 3.2 s'}, AHEAD, reasons.LINK_SILENT,
               'nothing for 3.2 s'),
    'gone': ({}, {'link': GONE, 'note': 'switched off'}, AHEAD, reasons.LINK_LOST, 'switched off'),
    'waiting': ({}, {'link': WAITING}, AHEAD, reasons.LINK_LOST, 'nothing received from it yet'),
    'held': ({}, {'stands': 'not_heard'}, AHEAD, reasons.NOT_HEARD),
    'no velocity topic': ({}, {'reached': False}, AHEAD, reasons.NOT_REACHED),
    'hardware stop': ({}, {'hardware_stop': True}, AHEAD, reasons.HARDWARE_STOP),
    'hardware stop, by the drive': ({}, {'hardware_stop': True, 'stands': 'hardware_stop'}, AHEAD,
                                    reasons.HARDWARE_STOP),
    'power off': ({}, {'power': 'cut', 'stands': 'power_cut'}, AHEAD, reasons.POWER, 'cut'),
    'stopped alone': ({}, {'stands': 'stopped_alone'}, AHEAD, reasons.STOPPED_ALONE),
    'brake': ({}, {'brake': BrakeView('slows', 0.1)}, AHEAD, reasons.SLOWS),
    'brake without a scan': ({}, {'brake': BrakeView('no_scan')}, AHEAD, reasons.NO_SCAN),
    'brake where it sees nothing': ({}, {'brake': BrakeView('unseen')}, AHEAD, reasons.UNSEEN),
    'joins': ({}, {'waits': True, 'stands': 'joining'}, AHEAD, reasons.JOINING),
    'limits zero': ({'limits': (0.0, 0.0)}, {}, AHEAD, reasons.NO_SPEED),
    'one limit zero': ({'limits': (0.0, 1.0)}, {}, AHEAD, reasons.NO_SPEED),
    'a reason of tomorrow': ({}, {'stands': 'its wheels {} are square'}, AHEAD,
                             'its wheels {} are square'),
    'motors': ({}, {'driven': True, 'sent': Velocity(0.3)}, AHEAD, reasons.NO_ANSWER),
    'motors, turn': ({}, {'driven': True, 'sent': Velocity(0.0, 0.3)}, LEFT, reasons.NO_ANSWER),
    'motors, by pad': (PUSHED, {'driven': True, 'sent': Velocity(0.3)}, REST, reasons.NO_ANSWER),
    'sideways': ({}, {}, ASIDE, reasons.NOT_SIDEWAYS),
    'sideways, though it moves': ({}, {'moving': True}, (1.0, 0.0, 1.0), reasons.NOT_SIDEWAYS),
    'sideways, by pad': ({**PAD, 'asked': Velocity(0.0, 0.0, 0.3)}, {}, REST,
                         reasons.NOT_SIDEWAYS),
    'sideways, stopped': ({'stop_all': True}, {}, ASIDE, reasons.STOPPED),
    'sideways, limit zero': ({'limits': (0.0, 1.0)}, CAN, ASIDE, reasons.NO_SPEED),
}
SILENCE = {
    'sideways, it can': ({}, CAN, ASIDE),
    'sideways, it can and moves': ({}, {**CAN, 'moving': True}, ASIDE),
    'sideways, by another stick': ({**PUSHED}, {'moving': True}, ASIDE),
    'nothing is asked': ({}, {}, REST),
    'nothing is asked, stopped': ({'stop_all': True}, {'selected': False}, REST),
    'it moves': ({}, {'moving': True, 'sent': Velocity(0.3)}, AHEAD),
    'it moves by pad': (PUSHED, {'moving': True, 'sent': Velocity(0.3)}, REST),
    'the pad rests': (PAD, {}, REST),
    'the pad rests, its button, too': ({**PAD, 'waits_for': 'dead_man'}, {}, REST),
    'own stick held, as the mux has it': ({'pushed': True}, {}, REST),
    'on its way': ({}, {}, AHEAD),
    'no odometry': ({}, {'linear_mps': None, 'sent': Velocity(0.3)}, AHEAD),
    'centred': ({'waits_for': 'neutral'}, {}, REST),
    'its limit was raised': ({}, {'stands': 'limit_raised'}, AHEAD),
    'power on': ({}, {'power': 'on'}, AHEAD),
    'the other limit zero': ({'limits': (0.0, 1.0)}, {}, LEFT),
}


def case(changes, of_robot):
    robot = replace(BOT, **of_robot)
    return replace(PANEL, robots=(robot,), **changes), robot


@pytest.mark.parametrize('row', SAID.values(), ids=SAID)
def test_what_is_said(row):
    changes, of_robot, stick, code, *names = row
    reason = why_still(*case(changes, of_robot), stick)
    assert reason == Reason(code, tuple(names))
    assert reason.what and reason.sentence.startswith(reason.what)


@pytest.mark.parametrize('changes, of_robot, stick', SILENCE.values(), ids=SILENCE)
def test_what_is_not_said(changes, of_robot, stick):
    assert why_still(*case(changes, of_robot), stick) is None


@pytest.mark.parametrize('together', [True, False])
def test_a_group_that_stays_together_says_for_whom(together):
    robot = replace(BOT, **CAN)
    view = replace(PANEL, robots=(robot, OTHER), together=together)
    assert why_still(view, robot, ASIDE) == (
        Reason(reasons.TOGETHER, ('bot4',)) if together else None)


def test_it_is_said_once_it_has_been_so_for_a_moment():
    why, (stopped, _) = WhyStill(), case({'stop_all': True}, {})
    moves = case({}, {'moving': True})[0]

    def said(view, now):
        return why.explain(view, AHEAD, now).robots[0].why
    assert said(stopped, 0.0) is said(stopped, MOMENT_S - 0.01) is None
    assert said(stopped, MOMENT_S) == Reason(reasons.STOPPED)
    assert said(moves, 1.0) is None, 'at once'
    assert said(stopped, 1.1) is None, 'a moment anew'
    motors = case({}, {'sent': Velocity(0.3)})[0]
    assert said(motors, 2.0) is None, 'another reason has its own moment'
    assert said(motors, 2.0 + MOTORS_S - 0.01) is None
    assert said(motors, 2.0 + MOTORS_S) == Reason(reasons.NO_ANSWER)


@pytest.mark.parametrize('changes, stick, looked_at, said', [
    ({'selected': False}, AHEAD, 'bot3', reasons.NOT_SELECTED),
    ({'selected': False}, AHEAD, 'bot4', None), ({'selected': False}, AHEAD, '', None),
    ({'selected': False}, REST, 'bot3', None),
    ({'selected': False, 'obeys': 'task'}, AHEAD, '', None),
    ({'selected': False, 'obeys': 'task'}, AHEAD, 'bot3', reasons.ON_TASK),
    ({'waits': True}, AHEAD, 'bot4', reasons.JOINING),
    ({'waits': True}, AHEAD, '', reasons.JOINING),
])
def test_a_robot_that_nobody_means_says_nothing(changes, stick, looked_at, said):
    why, view = WhyStill(), replace(PANEL, robots=(replace(BOT, **changes), OTHER))
    for now in (0.0, MOMENT_S):
        found = why.explain(view, stick, now, looked_at).robots[0].why
    assert (found and found.code) == said


@pytest.mark.parametrize('brake, words', [
    (BrakeView(), ''), (BrakeView('on'), ''),
    (BrakeView('slows', 0.62), 'brake: slows for something 0.6 m ahead'),
    (BrakeView('slows'), 'brake: slows for something ahead'),
    (BrakeView('no_scan'), 'brake: no laser or depth data, no way forward'),
    (BrakeView('unseen'), 'brake: slow, it does not see that way'),
    (BrakeView('no_place'), 'brake: place of a laser unknown, no way that no other sees'),
    (BrakeView('cannot'), 'no brake: it has no laser or depth camera')])
def test_what_the_brake_does_in_words(brake, words):
    assert brake_words(brake) == words
    assert not brake.holds or ': ' in Reason(brake.word).sentence


def test_what_a_guard_does_by_itself_in_words():
    assert guard_words(BrakeView('on')) == ''
    assert '10 s' in guard_words(BrakeView('on', on_robot=True, back_after_s=10.0))
