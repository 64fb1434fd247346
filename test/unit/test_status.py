# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one line at the bottom: never empty, and the one thing that matters most."""
from dataclasses import replace
from itertools import product

import pytest

from mhri.base.views import (
    ControlView, DeviceView, GONE, LINK_STATES, LIVE, PanelView, PROOF_NOT_CONFIRMED, PROOF_STOPPED,
    ProofView, RobotView, ROS_CONNECTED, ROS_CUT_OFF, ROS_NO_MASTER, ROS_STARTING, SILENT)
from mhri.screen.status import ATTENTION, CALM, status_line, STOPPED

SOURCES = (('joy', 'Virtual joystick'), ('ps3joy', 'PS3 Controller'))


def panel(robots=(), ros=ROS_CONNECTED, mode='joy', **values):
    """Return a view with the given robots."""
    return PanelView(ros=ros, sources=SOURCES, mode=mode, robots=tuple(robots), **values)


def proved(state, name='bot1'):
    """Return a robot with a proof of its stop."""
    return RobotView(name, link=LIVE, age_s=0.01, selected=True, proof=ProofView(state, state))


DRIVEN = RobotView('bot1', link=LIVE, selected=True, driven=True)
READY = RobotView('bot2', link=LIVE, selected=True)
IDLE = RobotView('bot3', link=LIVE)
MUTE = RobotView('bot4', link=SILENT, selected=True, note='nothing for 3.2 s')
LOST = RobotView('bot5', link=GONE, selected=True, note='switched off')

CASES = {
    'starting': (panel(ros=ROS_STARTING, mode=None), None, 'connecting', CALM),
    'no_master': (panel(ros=ROS_NO_MASTER, stop_all=True), '', 'http://host:11311', ATTENTION),
    'stopped': (panel([proved(PROOF_STOPPED)], stop_all=True), 'release', 'everything is stopped',
                STOPPED),
    'not_confirmed': (panel([proved(PROOF_STOPPED), proved(PROOF_NOT_CONFIRMED, 'bot9')],
                            stop_all=True), 'release', 'bot9 NOT CONFIRMED', STOPPED),
    'no_mux': (panel([READY], mode=None), None, 'who drives is not running', ATTENTION),
    'no_gates': (panel([DRIVEN], answers=False), '', 'drive service does not answer', ATTENTION),
    'nobody_there': (panel([READY], mode=None, answers=False), None, 'is not running', ATTENTION),
    'looking_on': (panel([READY], control=ControlView(False, 'panel on lab-pc2 since 14:02')), '',
                   'only looking on: panel on lab-pc2 since 14:02 drives', CALM),
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
                '1 of 2 robots  \u2013  Virtual joystick  \u2013  centre the stick', ATTENTION),
    'back_again': (panel([READY, replace(READY, name='bot7', waits=True)]), '',
                   'joystick  \u2013  bot7: centre the stick to drive', ATTENTION),
    'back_but_not_selected': (panel([READY, replace(READY, name='bot7', waits=True,
                                                    selected=False)]), '', 'ready', CALM),
    'source': (panel([READY], mode='ps3joy'), 'source', 'PS3 Controller  \u2013  nothing is heard',
               ATTENTION),
    'advice': (panel([READY], advice='PS3 Controller: nobody publishes it'), 'source',
               '1 of 1 robots  \u2013  PS3 Controller: nobody publishes it', ATTENTION),
    'absent': (panel([READY], mode='ps3joy', devices=(
        DeviceView('ps3joy', '', 'none is connected; plug one in'),), advice='move the stick'),
               'source', 'PS3 Controller: none is connected; plug one in', ATTENTION),
    'another_absent': (panel([READY], devices=(DeviceView('ps3joy', '', 'none'),)), '', 'ready',
                       CALM),
    'there': (panel([READY], mode='ps3joy', devices=(DeviceView('ps3joy', 'F710', 'wait'),)), '',
              'ready', CALM),
    'no_dead_man': (panel([READY], dead_man=False), '', 'joystick (no dead-man button)', CALM),
    'dead_man': (panel([READY]), 'dead_man', 'hold the dead-man button', CALM),
    'ready': (panel([READY]), '', 'ready', CALM),
    'driving': (panel([DRIVEN, READY]), '',
                '2 of 2 robots  \u2013  Virtual joystick  \u2013  driving', CALM),
    'low_battery': (panel([DRIVEN, replace(IDLE, battery=0.29), replace(READY, battery=0.31)]), '',
                    'driving; bot3 battery 29 %', ATTENTION),
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
    sentence, said = status_line(view, waits_for, 'http://host:11311')
    assert words in sentence and said == level


def test_never_empty_whatever_the_view():
    """Every combination there is."""
    robots = [RobotView('bot', link=link, selected=selected, note='a note')
              for link, selected in product(LINK_STATES, (False, True))]
    for ros, mode, stop, robot, waits in product(
            (ROS_STARTING, ROS_NO_MASTER, ROS_CONNECTED), (None, 'joy'), (False, True),
            [None] + robots, (None, '', 'release', 'source', 'neutral', 'dead_man')):
        view = panel([robot] if robot else [], ros=ros, mode=mode, stop_all=stop)
        sentence, level = status_line(view, waits)
        assert sentence.strip() and level in (CALM, ATTENTION, STOPPED)
