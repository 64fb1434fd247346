# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The scripted operator in every drill: it gets through, the same each time, slower with delay."""
import functools
import math

import pytest

from mhri.drill.operator import Act, ahead_of, MAX_TURN, ScriptedOperator, Seen
from mhri.drill.referee import ALL_FOUND
from mhri.drill.rehearsal import Rehearsal
from support.drills import drill, NAMES

DELAYS_S = (0.0, 0.4)


@functools.lru_cache(None)
def rehearsed(name, delay_s=0.0, seed=1, with_path=False):
    """Return the result of a drill; several tests look at the same."""
    return Rehearsal(*drill(name), delay_s=delay_s, seed=seed, with_path=with_path).run()


@pytest.mark.parametrize('name', NAMES)
def test_every_drill_is_passed_and_takes_longer_with_delay(name):
    results = [rehearsed(name, delay_s) for delay_s in DELAYS_S]
    times = [result['time_s'] for result in results]
    print('MEASURED', name, *('{:.1f} s'.format(each) for each in times))
    assert [result['ended'] for result in results] == [ALL_FOUND] * 2
    assert times[0] < times[1]
    assert [result['contacts'] for result in results] == [0] * 2


@pytest.mark.parametrize('name, share', [
    ('figure_of_eight', 0.85), ('maze', 0.9), ('search', 0.9), ('two_corridors', 1.0),
    ('lost_link', 1.1), ('stop_in_time', 1.1)])
def test_the_committed_path_on_the_picture_shortens_a_drill_with_turns(name, share):
    """On a straight way nothing is gained; errors of reading the path cost a little."""
    without, with_path = (rehearsed(name, 0.4, with_path=path) for path in (False, True))
    print('MEASURED', name, '{:.1f} s, with the path {:.1f} s'.format(
        without['time_s'], with_path['time_s']))
    assert (with_path['ended'], with_path['contacts']) == (ALL_FOUND, 0)
    assert with_path['time_s'] < share * without['time_s']


def test_with_the_path_a_person_is_kept_at_more_distance():
    gaps = [rehearsed('stop_in_time', 0.4, with_path=path)['robots']['bot1']['least_gap_m']
            for path in (False, True)]
    print('MEASURED gap to a person {:.2f} m, with the path {:.2f} m'.format(*gaps))
    assert gaps[1] > gaps[0]


def test_there_is_no_path_with_little_delay():
    assert rehearsed('figure_of_eight', 0.1, with_path=True) == rehearsed('figure_of_eight', 0.1)


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
    assert aside.forward == 0.0 and aside.turn == -MAX_TURN


def test_what_is_ahead_in_a_scan():
    ranges = [5.0] * 360
    ranges[350], ranges[90] = 1.2, 0.3
    assert ahead_of(ranges, math.radians(1.0), 0.2, 0.1) == pytest.approx(1.0)
    ranges[0] = 0.0
    assert ahead_of(ranges, math.radians(1.0), 0.2, 0.45) == pytest.approx(0.25)
    assert ahead_of([math.inf] * 360, math.radians(1.0), 0.2, 0.1) == math.inf
