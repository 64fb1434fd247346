# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Kept settings: all that can be used comes back, and nothing else does."""
import json

import pytest

from mhri.screen.saved_state import usable_state

GOOD = {
    'robots': ['bot2', 'rover_7'], 'numbers': {'bot2': 2, 'rover_7': 1, 'bot10': 12},
    'mode': 'ps3joy',
    'windows': {'bot2': [10, -20, 800, 560, False]},
    'looks': {'bot2': {'views': ['imu', 'rgb'], 'graph': {'quantity': 'gyro', 'window_s': 5},
                       'recording': {'extras': ['scan']}, 'splitter': [300, 200, 100],
                       'arm': {'pose': [1.5, None, 'up']}}},
    'panel': {'splitter': [400, 600], 'geometry': [0, 0, 1024, 600, True]},
    'events': {'sounds': False}, 'map': {'shown': 'large', 'follow': True}}
NAN = float('nan')
DEEP = []
for _ in range(900):
    DEEP = [DEEP]


def test_what_was_kept_comes_back_whole():
    assert usable_state(json.loads(json.dumps(GOOD))) == (GOOD, ())
    assert usable_state({}) == ({}, ())


def test_how_fast_a_panel_drove_does_not_come_back():
    """Kept by panels before: what is in force is the operator's own act of today."""
    assert usable_state({'limits': [2.0, 3.0], 'together': True, 'brake': True}) == ({}, ())


@pytest.mark.parametrize('key, value', [
    ('robots', 5), ('robots', ['bot 1']), ('robots', ['bot'] * 100_000),
    ('numbers', {'bot 1': 1}), ('numbers', {'bot1': 0}),
    ('numbers', {'bot1': True}), ('numbers', {'bot1': 10 ** 6}),
    ('numbers', {'bot1': 2, 'bot2': 2}), ('numbers', {'a%d' % n: n + 1 for n in range(5000)}),
    ('mode', 5), ('mode', 'x' * 1_000_000), ('mode', 'a\x00b'), ('mode', ['joy']),
    ('windows', []), ('looks', 'x'), ('panel', [1]), ('events', True), ('map', 5)])
def test_a_part_that_cannot_be_used_is_left_out_and_named(key, value):
    state, problems = usable_state({**GOOD, key: value})
    assert state == {other: kept for other, kept in GOOD.items() if other != key}
    assert len(problems) == 1 and problems[0].startswith(key) and len(problems[0]) < 200


def test_a_switch_that_is_none_is_left_out_and_named():
    state, problems = usable_state({'events': {'sounds': 'off', 'colour': 1}})
    assert state == {'events': {}} and [problem.split(':')[0] for problem in problems] == [
        'events.sounds']


@pytest.mark.parametrize('key, value', [
    ('splitter', [1e300, 5]), ('splitter', [1, 10 ** 9]), ('splitter', 'ff' * 1000),
    ('splitter', [None, 1]), ('splitter', [1] * 1000), ('geometry', [0, 0, 10 ** 9, 5, False]),
    ('geometry', [0, 0, NAN, 5, False]), ('geometry', 'AdnQywAD'), ('geometry', [0, 0, 0, 0, True]),
    ('geometry', [0, 0, 5, 5, 1])])
def test_of_the_panel_the_rest_stays(key, value):
    state, problems = usable_state({'panel': {**GOOD['panel'], key: value}})
    assert state['panel'] == {other: kept for other, kept in GOOD['panel'].items() if other != key}
    assert len(problems) == 1 and problems[0].startswith('panel.' + key)


@pytest.mark.parametrize('look', [
    5, {'views': 'imu'}, {'views': [['imu']]}, {'of_views': 5}, {'recording': {'extras': 'scan'}},
    {'arm': DEEP}, {'arm': list(range(10_000))}, {'arm': 'x' * 100_000}])
def test_a_look_that_cannot_be_used_costs_that_window_alone(look):
    state, problems = usable_state({'looks': {'bot1': look, **GOOD['looks']}})
    assert state['looks'] == GOOD['looks'] and 'bot1' in problems[0]


@pytest.mark.parametrize('key, value', [
    ('windows', {'bot1': [1, 2, 3, 4, False], 'a b': [1, 2, 3, 4, False]}),
    ('windows', {'bot1': [1, 2, 3, 4, False], 'bot2': 'ff'})])
def test_a_window_that_cannot_be_placed(key, value):
    state, problems = usable_state({key: value})
    assert list(state[key]) == ['bot1'] and len(problems) == 1


@pytest.mark.parametrize('state', [None, 5, [], 'x', [GOOD]])
def test_no_state_at_all(state):
    usable, problems = usable_state(state)
    assert usable == {} and len(problems) == 1
