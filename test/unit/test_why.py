# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Why a robot stands though the stick is held: one row for each reason, and for each silence."""
from dataclasses import replace

import pytest

from mhri.base.brake_view import brake_words, BrakeView, guard_words, standing_words
from mhri.base.task_views import TaskView
from mhri.base.views import (
    ControlView, DeviceView, GONE, LIVE, PanelView, RobotView, ROS_CONNECTED, ROS_CUT_OFF,
    ROS_NO_MASTER, SILENT, WAITING)
from mhri.screen.why import CENTRE, MOMENT_S, MOTORS_S, NO_ANSWER, why_still, WhyStill

SOURCES = (('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller'))
BOT = RobotView('bot3', link=LIVE, age_s=0.01, selected=True, obeys='operator', number=3,
                linear_mps=0.0, angular_rad_s=0.0, sent_mps=0.0, sent_rad_s=0.0)
PANEL = PanelView(ros=ROS_CONNECTED, sources=SOURCES, mode='joy', robots=(BOT,))
AHEAD, LEFT, REST = (1.0, 0.0), (0.0, 0.5), (0.0, 0.0)
PAD = {'mode': 'ps3joy'}
HELD = {'mode': 'ps3joy', 'pushed': True}
PUSHED = {'mode': 'ps3joy', 'asked': (0.3, 0.0)}

# Changes of the panel, of the robot, the stick, and what is said.
SAID = {
    'no master': ({'ros': ROS_NO_MASTER}, {}, AHEAD, 'no connection'),
    'cut off': ({'ros': ROS_CUT_OFF}, {}, AHEAD, 'no connection'),
    'stop all': ({'stop_all': True}, {}, AHEAD, 'STOP ALL is in force: release it to drive'),
    'stop all, not selected': ({'stop_all': True}, {'selected': False}, LEFT, 'STOP ALL'),
    'another operator': ({'control': ControlView(False, 'panel on lab-pc2 since 14:02')}, {}, AHEAD,
                         'panel on lab-pc2 drives: take control first'),
    'somebody': ({'control': ControlView(False)}, {}, AHEAD, 'somebody else drives: take control'),
    'no mux': ({'mode': None}, {}, AHEAD, 'what decides who drives is not running'),
    'gates silent': ({'answers': False}, {}, AHEAD, 'the drive service does not answer'),
    'not selected': ({}, {'selected': False}, AHEAD, 'not selected: press 3 to drive it'),
    'not selected, by pad': (HELD, {'selected': False}, REST, 'not selected: press 3 to drive it'),
    'no key': ({}, {'selected': False, 'number': 10}, AHEAD, 'not selected: check it in the list'),
    'on a task': ({}, {'selected': False, 'obeys': 'task'}, AHEAD, 'on a task: press 3 to take it'),
    'on a known task': ({}, {'selected': False, 'task': TaskView('Square')}, AHEAD,
                        'on a task: square; press 3 to take it over'),
    'another mode': (PAD, {}, AHEAD,
                     'PS3 Controller drives, not this stick: choose "Virtual joystick" first'),
    'no pad': ({**PUSHED, 'devices': (DeviceView('ps3joy', note='not connected: plug it in'),)}, {},
               REST, 'not connected: plug it in'),
    'pad silent': ({**PUSHED, 'waits_for': 'source', 'advice': 'PS3 Controller: nobody publishes'},
                   {}, REST, 'PS3 Controller: nobody publishes'),
    'pad not heard yet': ({**PUSHED, 'waits_for': 'source'}, {}, REST,
                          'nothing is heard from PS3 Controller yet'),
    'dead-man': ({**HELD, 'waits_for': 'dead_man'}, {}, REST, 'hold the dead-man button to drive'),
    'pedal': ({**HELD, 'waits_for': 'enabling'}, {}, REST, 'press the enabling pedal to drive'),
    'neutral': ({'waits_for': 'neutral'}, {}, AHEAD, CENTRE),
    'stop all, by pad': ({**HELD, 'stop_all': True, 'waits_for': 'release'}, {}, REST, 'STOP ALL'),
    'gone, by pad': (HELD, {'link': GONE}, REST, 'switched off or out of reach'),
    'neutral of a pad': ({**HELD, 'waits_for': 'neutral'}, {}, REST, CENTRE),
    'silent': ({}, {'link': SILENT, 'note': 'nothing for 3.2 s'}, AHEAD,
               'it has sent nothing for 3.2 s'),
    'gone': ({}, {'link': GONE, 'note': 'switched off or out of reach'}, AHEAD, 'switched off or'),
    'gone without a word': ({}, {'link': GONE}, AHEAD, 'switched off or out of reach'),
    'waiting': ({}, {'link': WAITING}, AHEAD, 'nothing is heard from it yet'),
    'held': ({}, {'stands': 'not_heard'}, AHEAD, 'the drive service does not hear it'),
    'no velocity topic': ({}, {'reached': False}, AHEAD, 'nothing on it takes commands'),
    'hardware stop': ({}, {'hardware_stop': True}, AHEAD, 'its own emergency stop is pressed'),
    'power off': ({}, {'power': 'cut'}, AHEAD, 'motor power cut'),
    'power failed': ({}, {'power': 'failed: no service'}, AHEAD, 'motor power failed: no service'),
    'brake': ({}, {'brake': BrakeView('slows', 0.1)}, AHEAD,
              'brake: something is in the way: back away or turn'),
    'brake without a scan': ({}, {'brake': BrakeView('no_scan')}, AHEAD,
                             'brake: no laser or depth data: back away, or switch the brake off'),
    'brake where it sees nothing': ({}, {'brake': BrakeView('unseen')}, AHEAD,
                                    'brake: it does not see that way: turn less, or turn to it '
                                    'first'),
    'joins': ({}, {'waits': True, 'stands': 'joining'}, AHEAD, CENTRE),
    'limits zero': ({'limits': (0.0, 0.0)}, {}, AHEAD, 'the speed limit is 0: raise it'),
    'one limit zero': ({'limits': (0.0, 1.0)}, {}, AHEAD, 'the speed limit is 0: raise it'),
    'a reason of tomorrow': ({}, {'stands': 'something is in its way'}, AHEAD,
                             'something is in its way'),
    'motors': ({}, {'driven': True, 'sent_mps': 0.3}, AHEAD, NO_ANSWER),
    'motors, turn': ({}, {'driven': True, 'sent_rad_s': 0.3}, LEFT, NO_ANSWER),
    'motors, by pad': (PUSHED, {'driven': True, 'sent_mps': 0.3}, REST, NO_ANSWER),
}
SILENCE = {
    'nothing is asked': ({}, {}, REST),
    'nothing is asked, stopped': ({'stop_all': True}, {'selected': False}, REST),
    'it moves': ({}, {'moving': True, 'sent_mps': 0.3}, AHEAD),
    'it moves by pad': (PUSHED, {'moving': True, 'sent_mps': 0.3}, REST),
    'the pad rests': (PAD, {}, REST),
    'the pad rests, its button, too': ({**PAD, 'waits_for': 'dead_man'}, {}, REST),
    'own stick held, as the mux has it': ({'pushed': True}, {}, REST),
    'on its way': ({}, {}, AHEAD),
    'no odometry': ({}, {'linear_mps': None, 'sent_mps': 0.3}, AHEAD),
    'centred': ({'waits_for': 'neutral'}, {}, REST),
    'the other limit zero': ({'limits': (0.0, 1.0)}, {}, LEFT),
}


def case(changes, of_robot):
    robot = replace(BOT, **of_robot)
    return replace(PANEL, robots=(robot,), **changes), robot


@pytest.mark.parametrize('changes, of_robot, stick, said', SAID.values(), ids=SAID)
def test_what_is_said(changes, of_robot, stick, said):
    words = why_still(*case(changes, of_robot), stick)
    assert words.startswith(said) or said in words, words


@pytest.mark.parametrize('changes, of_robot, stick', SILENCE.values(), ids=SILENCE)
def test_what_is_not_said(changes, of_robot, stick):
    assert why_still(*case(changes, of_robot), stick) == ''


def test_it_is_said_once_it_has_been_so_for_a_moment():
    why, (stopped, _) = WhyStill(), case({'stop_all': True}, {})
    moves = case({}, {'moving': True})[0]

    def said(view, now):
        return why.tell(view, AHEAD, now).robots[0].why
    assert said(stopped, 0.0) == '' and said(stopped, MOMENT_S - 0.01) == ''
    assert said(stopped, MOMENT_S).startswith('STOP ALL')
    assert said(moves, 1.0) == '', 'at once'
    assert said(stopped, 1.1) == '', 'a moment anew'
    motors = case({}, {'sent_mps': 0.3})[0]
    assert said(motors, 2.0) == '', 'another reason has its own moment'
    assert said(motors, 2.0 + MOTORS_S - 0.01) == ''
    assert said(motors, 2.0 + MOTORS_S) == NO_ANSWER


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
    assert bool(standing_words(brake)) == brake.holds


def test_what_a_guard_does_by_itself_in_words():
    assert guard_words(BrakeView('on')) == ''
    assert guard_words(BrakeView('on', on_robot=True, back_after_s=10.0)) == \
        'brakes by itself, goes back alone after 10 s without a link'
