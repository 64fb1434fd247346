# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What was asked beside what is done: said where they differ for a while, calm else."""
from dataclasses import replace

import pytest

from mhri.base.limits import Velocity
from mhri.base.views import LIVE, RobotView, SILENT
from mhri.screen.asked import (
    asked_and_done, asked_line, AskedAndDone, differs, MOMENT_S, SAME_MPS, SAME_RAD_S)

DRIVEN = RobotView('crawler1', link=LIVE, age_s=0.01, selected=True, driven=True, obeys='operator',
                   linear_mps=0.2, angular_rad_s=0.0, sent=Velocity(0.22))


@pytest.mark.parametrize('asked, done, least, expected', [
    (0.5, 0.5, SAME_MPS, False), (0.5, 0.46, SAME_MPS, False), (0.5, 0.44, SAME_MPS, True),
    (0.1, 0.08, SAME_MPS, False), (0.1, 0.06, SAME_MPS, True), (0.0, 0.02, SAME_MPS, False),
    (0.0, 0.04, SAME_MPS, True), (-0.5, 0.5, SAME_MPS, True), (1.0, 0.96, SAME_RAD_S, False),
    (0.1, 0.14, SAME_RAD_S, False), (0.1, 0.16, SAME_RAD_S, True),
    (float('nan'), 0.1, SAME_MPS, False)])
def test_differs(asked, done, least, expected):
    assert differs(asked, done, least) is expected


@pytest.mark.parametrize('changes, asked, line, foot', [
    ({}, Velocity(0.5, 0.0), 'asked 0.50, sent 0.22 m/s', 'asked 0.50, crawler1 0.20 m/s'),
    ({'sent': Velocity(0.5)}, Velocity(0.5), 'asked 0.50 m/s', 'asked 0.50, crawler1 0.20 m/s'),
    ({'sent': None}, Velocity(0.5, 0.0), 'asked 0.50 m/s', 'asked 0.50, crawler1 0.20 m/s'),
    ({'sent': Velocity(-0.22), 'linear_mps': -0.2}, Velocity(-0.5, 0.0),
     'asked back 0.50, sent back 0.22 m/s', 'asked back 0.50, crawler1 back 0.20 m/s'),
    ({'sent': Velocity(0.22, 0.8)}, Velocity(0.2, 0.8), 'asked left 0.80 rad/s',
     'asked left 0.80, crawler1 0.00 rad/s'),
    ({'sent': Velocity(0.22, -0.5), 'angular_rad_s': -0.5}, Velocity(0.2, -0.8),
     'asked right 0.80, sent right 0.50 rad/s', 'asked right 0.80, crawler1 right 0.50 rad/s'),
    ({'lateral_mps': 0.1}, Velocity(0.2, 0.0, -0.3), 'asked right 0.30, sent 0.00 m/s',
     'asked right 0.30, crawler1 left 0.10 m/s'),
])
def test_words(changes, asked, line, foot):
    robot = replace(DRIVEN, asked=asked, **changes)
    assert asked_line(robot) == line
    assert asked_and_done([RobotView('bot2'), robot]) == foot


def test_no_words_where_nothing_differs():
    assert asked_line(DRIVEN) == '' and asked_and_done([DRIVEN]) == ''


@pytest.mark.parametrize('changes, asked', [
    ({}, Velocity(0.2, 0.0)), ({}, Velocity(0.21, 0.04)), ({'driven': False}, Velocity(0.5, 0.0)),
    ({'obeys': 'task'}, Velocity(0.5, 0.0)), ({'link': SILENT}, Velocity(0.5, 0.0)),
    ({'linear_mps': None}, Velocity(0.5, 0.0)), ({}, None)])
def test_calm(changes, asked):
    memory, robots = AskedAndDone(), [replace(DRIVEN, **changes)]
    assert [memory.compare(robots, asked, now)[0].asked for now in (0.0, 1.0, 9.0)] == [None] * 3


def test_who_cannot_go_sideways_is_not_compared_with_that():
    asked = Velocity(0.2, 0.0, 0.3)
    for holonomic in (False, True):
        memory, robots = AskedAndDone(), [replace(DRIVEN, holonomic=holonomic)]
        memory.compare(robots, asked, 0.0)
        assert memory.compare(robots, asked, 1.0)[0].asked == (asked if holonomic else None)


def test_it_is_said_after_a_moment_and_not_once_it_is_over():
    memory, asked = AskedAndDone(), Velocity(0.5, 0.0)

    def said(now, *robots):
        return [robot.name for robot in memory.compare(robots, asked, now) if robot.asked]
    slow, quick = DRIVEN, replace(DRIVEN, name='bot2', linear_mps=0.5)
    assert said(0.0, slow, quick) == []
    assert said(MOMENT_S - 0.01, slow, quick) == []
    assert said(MOMENT_S, slow, quick) == ['crawler1']
    assert said(2.0, replace(slow, linear_mps=0.5), replace(quick, linear_mps=0.1)) == []
    assert said(2.1, slow, quick) == [], 'the moment begins anew'
    assert said(2.2 + MOMENT_S, slow, quick) == ['crawler1']
