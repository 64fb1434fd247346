# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The scripted operator in every drill: it gets through, the same each time, slower with delay."""
import functools
import math
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.drill.operator import Act, ahead_of, MOST_TURN, ScriptedOperator, Seen  # noqa: E402
from mhri.drill.referee import ALL_FOUND  # noqa: E402
from mhri.drill.rehearsal import Rehearsal  # noqa: E402
from support.drills import drill, NAMES  # noqa: E402

DELAYS_S = (0.0, 0.4)


@functools.lru_cache(None)
def rehearsed(name, delay_s=0.0, seed=1):
    """Return the result of a drill; several tests look at the same."""
    return Rehearsal(*drill(name), delay_s=delay_s, seed=seed).run()


@pytest.mark.parametrize('name', NAMES)
def test_every_drill_is_passed_and_takes_longer_with_delay(name):
    results = [rehearsed(name, delay_s) for delay_s in DELAYS_S]
    times = [result['time_s'] for result in results]
    print('MEASURED', name, *('{:.1f} s'.format(each) for each in times))
    assert [result['ended'] for result in results] == [ALL_FOUND] * 2
    assert times[0] < times[1]
    assert [result['contacts'] for result in results] == [0] * 2


@pytest.mark.parametrize('name', ['lost_link', 'two_corridors'])
def test_it_is_repeatable(name):
    times = [rehearsed(name, seed=seed)['time_s'] for seed in range(3)]
    assert max(times) < 1.05 * min(times)


def test_a_person_is_reacted_to_and_not_touched():
    result = rehearsed('stop_in_time')
    assert [each['how'] for each in result['reactions']] == ['stick', 'stick']
    assert result['robots']['bot1']['least_gap_m'] > 0.1


def test_the_other_robot_is_driven_while_one_is_silent():
    result = rehearsed('two_corridors')
    assert result['reactions'][0]['how'] == 'selection'
    assert all(robot['driven_s'] > 10.0 for robot in result['robots'].values())


def test_it_centres_the_stick_for_another_robot():
    operator = ScriptedOperator({'bot1': [(9.0, 0.0)], 'bot2': [(9.0, 0.0)]}, 1.5)
    here = Seen(0.0, 0.0, 0.0)
    both = {'bot1': here, 'bot2': here}
    assert operator.act({}) == Act()
    assert operator.act(both) == Act('bot1')
    assert operator.act(both) == Act('bot1', 1.0, 0.0)
    lost = {'bot1': Seen(0.0, 0.0, 0.0, age_s=2.0), 'bot2': here}
    assert operator.act(lost) == Act('bot2')
    assert operator.act(lost).forward == 1.0
    assert operator.act({'bot2': Seen(9.0, 0.0, 0.0)}) == Act()
    assert operator.act(both) == Act('bot1') and not operator.done


def test_it_stops_for_what_is_ahead_and_turns_before_it_drives():
    operator = ScriptedOperator({'bot1': [(9.0, 0.0)]}, 1.5)
    operator.act({'bot1': Seen(0.0, 0.0, 0.0)})
    assert operator.act({'bot1': Seen(0.0, 0.0, 0.0, ahead_m=0.4)}) == Act('bot1')
    aside = operator.act({'bot1': Seen(0.0, 0.0, math.pi / 2.0)})
    assert aside.forward == 0.0 and aside.turn == -MOST_TURN


def test_what_is_ahead_in_a_scan():
    ranges = [5.0] * 360
    ranges[350], ranges[90] = 1.2, 0.3
    assert ahead_of(ranges, math.radians(1.0), 0.2, 0.1) == pytest.approx(1.0)
    ranges[0] = 0.0
    assert ahead_of(ranges, math.radians(1.0), 0.2, 0.45) == pytest.approx(0.25)
    assert ahead_of([math.inf] * 360, math.radians(1.0), 0.2, 0.1) == math.inf
