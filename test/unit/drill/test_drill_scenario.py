# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of drills: what is shipped can be used, what is wrong is refused by file and key."""
import math

import pytest

from mhri.base.config import ConfigError
from mhri.drill.scenario import on_links, parse_scenario
from support.drills import drill, NAMES

GOOD = """
title: Small
about: Go there.
plan: small.yaml
robots: [turtlebot2, turtlebot3_burger]
targets:
  - {name: there, x: 1, y: 2, range: 0.5, view_deg: 90, robot: bot2}
faults:
  - {robot: bot1, fault: delay, at: 3, for: 4}
limit_s: 60
routes: {bot1: [[1, 2]], bot2: []}
"""


def test_the_shipped_drills():
    assert NAMES == ['figure_of_eight', 'lost_link', 'maze', 'search', 'stop_in_time',
                     'two_corridors']
    assert len(drill('search')[0].targets) == 8
    assert len(drill('two_corridors')[0].robots) == 2


def test_delays_add_to_that_of_the_link_and_give_way_to_it():
    faults = drill('lost_link')[0].faults
    assert on_links(faults, 0.0) == list(faults)
    slow, own, lost, _ = on_links(faults, 0.4)
    assert (slow.value, slow.at_s, slow.for_s) == (pytest.approx(0.7), 3.0, 4.0)
    assert (own.value, own.at_s, own.for_s) == (0.4, 7.0, 0.0)
    assert lost == faults[1]


@pytest.mark.parametrize('name', NAMES)
def test_robots_and_targets_are_where_they_can_be(name):
    scenario, plan, bodies = drill(name)
    for robot, start in zip(scenario.robots, plan.starts):
        assert plan.distance(*start[:2]) > bodies[robot][0].radius_m + 0.1
        for x, y in scenario.routes[robot]:
            assert plan.distance(x, y) > bodies[robot][0].radius_m + 0.1
    assert scenario.about.endswith('.') and len(plan.starts) >= len(scenario.types)


def test_a_small_drill():
    small = parse_scenario(GOOD, 'small.yaml', 'small')
    assert small.robots == ('bot1', 'bot2') and small.routes == {'bot1': ((1.0, 2.0),), 'bot2': ()}
    assert small.targets[0].view_rad == pytest.approx(math.pi / 2.0)
    fault = small.faults[0]
    assert (fault.fault.key, fault.value, fault.at_s, fault.for_s) == ('delay', 0.4, 3.0, 4.0)


@pytest.mark.parametrize('old, new, key, words', [
    ('limit_s: 60', 'limit: 60', 'limit_s', 'is missing'),
    ('view_deg: 90', 'view: 90', 'targets[0].view', 'unknown key'),
    ('fault: delay', 'fault: delay, value: 99', 'faults[0].fault', 'from 0.01 to 5 s'),
    ('[turtlebot2, turtlebot3_burger]', '[]', 'robots', 'expected 1 to 12 types'),
    ('plan: small.yaml', 'plan: ../small.yaml', 'plan', 'the name of a file in plans/'),
    ('[[1, 2]]', '[[1, .nan]]', 'routes.bot1', 'expected a place [x, y]'),
])
def test_wrong_files_are_refused_by_file_and_key(old, new, key, words):
    assert old in GOOD
    with pytest.raises(ConfigError) as refused:
        parse_scenario(GOOD.replace(old, new), 'small.yaml', 'small')
    assert str(refused.value).startswith('small.yaml: ' + key + ': ')
    assert words in str(refused.value)
