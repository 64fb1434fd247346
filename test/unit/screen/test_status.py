# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one line at the bottom: never empty, and the one thing that matters most."""
from dataclasses import replace
from itertools import product

import pytest

from mhri.base.reasons import NO_PUBLISHER, Reason
from mhri.base.views import (
    ControlView, DeviceView, GONE, LIVE, PROOF_NOT_CONFIRMED, PROOF_STOPPED, ProofView,
    RobotView, ROS_CONNECTED, ROS_CUT_OFF, ROS_NO_MASTER, ROS_STARTING, ScreenView, SILENT,
    WAITING)
from mhri.screen.status import ATTENTION, CALM, status_line, STOPPED

SOURCES = (('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller'))


def panel(robots=(), ros=ROS_CONNECTED, mode='joy', **values):
    """Return a view with the given robots."""
    return ScreenView(ros=ros, sources=SOURCES, mode=mode, robots=tuple(robots), **values)


def proved(state, name='bot1'):
    """Return a robot with a proof of its stop."""
    return RobotView(name, link=LIVE, age_s=0.01, selected=True, proof=ProofView(state, state))


DRIVEN = RobotView('bot1', link=LIVE, selected=True, driven=True)
READY = RobotView('bot2', link=LIVE, selected=True)
IDLE = RobotView('bot3', link=LIVE)
MUTE = RobotView('bot4', link=SILENT, selected=True, note='nothing for 3.2 s')
UNHEARD = Reason(NO_PUBLISHER, ('/joy',))
LOST = RobotView('bot5', link=GONE, selected=True, note='switched off')

CASES = {
    'starting': (panel(ros=ROS_STARTING, mode=None), '', 'connecting', CALM),
    'no_master': (panel(ros=ROS_NO_MASTER, stop_all=True), '', 'http://host:11311', ATTENTION),
    'stopped': (panel([proved(PROOF_STOPPED)], stop_all=True), 'release', 'everything is stopped',
                STOPPED),
    'not_confirmed': (panel([proved(PROOF_STOPPED), proved(PROOF_NOT_CONFIRMED, 'bot9')],
                            stop_all=True), 'release', 'bot9 NOT CONFIRMED', STOPPED),
    'no_drive': (panel([READY], mode=None, answers=False), '', 'drive service does not answer',
                 ATTENTION),
    'looking_on': (panel([READY], control=ControlView(False, 'panel on lab-pc2', '14:02')), '',
                   'read-only: panel on lab-pc2 since 14:02 is in control', CALM),
    'cut_off': (panel([DRIVEN], ros=ROS_CUT_OFF, stop_all=True), '', 'cut off', STOPPED),
    'stop_asked': (panel([proved(PROOF_STOPPED)], stop_all=True, stop_taken=False), '',
                   'not confirmed yet', STOPPED),
    'stop_unheard': (panel([proved(PROOF_STOPPED)], stop_all=True, stop_taken=False,
                           answers=False), '', 'NOT CONFIRMED', STOPPED),
    'no_robots': (panel(), 'source', 'no robots yet', CALM),
    'none_selected': (panel([IDLE]), '', 'no robot selected', CALM),
    'silent': (panel([DRIVEN, MUTE]), '', 'bot4 has sent nothing for 3.2 s', ATTENTION),
    'gone': (panel([LOST]), '', 'bot5: switched off', ATTENTION),
    'idle_and_silent': (panel([READY, RobotView('x', link=SILENT, note='nothing')]), '', 'ready',
                        CALM),
    'others_on_tasks': (panel([READY, RobotView('x', link=LIVE, driven=True, obeys='task')]), '',
                        'joystick  \u2013  ready', CALM),
    'neutral': (panel([READY, IDLE]), 'neutral',
                'Driving bot2  \u2013  Virtual joystick  \u2013  centre the stick', ATTENTION),
    'back_again': (panel([READY, replace(READY, name='bot7', waits=True)]), '',
                   'joystick  \u2013  bot7: centre the stick to drive', ATTENTION),
    'back_but_not_selected': (panel([READY, replace(READY, name='bot7', waits=True,
                                                    selected=False)]), '', 'ready', CALM),
    'source': (panel([READY], mode='ps3joy'), 'source', 'PS3 Controller  \u2013  nothing is heard',
               ATTENTION),
    'advice': (panel([READY], advice=UNHEARD), 'source',
               'Driving bot2  \u2013  Virtual joystick: nobody publishes /joy', ATTENTION),
    'absent': (panel([READY], mode='ps3joy', devices=(
        DeviceView('ps3joy', '', 'none is connected; plug one in'),), advice=UNHEARD),
               'source', 'PS3 Controller: none is connected; plug one in', ATTENTION),
    'another_absent': (panel([READY], devices=(DeviceView('ps3joy', '', 'none'),)), '', 'ready',
                       CALM),
    'there': (panel([READY], mode='ps3joy', devices=(DeviceView('ps3joy', 'F710', 'wait'),)), '',
              'ready', CALM),
    'no_dead_man': (panel([READY], dead_man=False), '', 'joystick (no dead-man button)', CALM),
    'dead_man': (panel([READY]), 'dead_man', 'hold the dead-man button', CALM),
    'undertaker': (panel([READY]), 'undertaker', 'the stand-by process does not answer', ATTENTION),
    'ready': (panel([READY]), '', 'ready', CALM),
    'driving': (panel([DRIVEN, READY]), '',
                'Driving bot1, bot2  \u2013  Virtual joystick  \u2013  moving', CALM),
    'many': (panel([replace(READY, name='bot{}'.format(number)) for number in range(1, 6)]), '',
             'Driving bot1, bot2 (+3)', CALM),
    'low_battery': (panel([DRIVEN, replace(IDLE, battery=0.29), replace(READY, battery=0.31)]), '',
                    'moving; bot3 battery 29 %', ATTENTION),
    'flat_battery': (panel([replace(IDLE, battery=0.14), replace(READY, battery=0.2)]), '',
                     'ready; bot3 battery 14 %, bot2 battery 20 %', STOPPED),
    'three_low': (panel([replace(IDLE, name=name, battery=0.2) for name in 'abc']), '',
                  'selected: check the ones to drive; a battery 20 %, 2 more', ATTENTION),
    'battery_while_stopped': (panel([replace(IDLE, battery=0.14)], stop_all=True), '',
                              'release it to drive again', STOPPED),
    'unknown_source': (panel([READY], mode='brain'), '', 'brain', CALM),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_status_line(case):
    """The first thing that keeps it all from working, or who drives what."""
    view, waits_for, words, level = CASES[case]
    sentence, said = status_line(replace(view, waits_for=waits_for), 'http://host:11311')
    assert words in sentence and said == level


def test_never_empty_whatever_the_view():
    """Every combination there is."""
    robots = [RobotView('bot', link=link, selected=selected, note='a note')
              for link, selected in product((WAITING, LIVE, SILENT, GONE), (False, True))]
    for ros, answers, stop, robot, waits in product(
            (ROS_STARTING, ROS_NO_MASTER, ROS_CONNECTED), (False, True), (False, True),
            [None] + robots, ('', 'release', 'source', 'neutral', 'dead_man')):
        view = panel([robot] if robot else [], ros=ros, mode='joy' if answers else None,
                     answers=answers, stop_all=stop, waits_for=waits)
        sentence, level = status_line(view)
        assert sentence.strip() and level in (CALM, ATTENTION, STOPPED)
