# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The referee of a drill, moment by moment; and what is told of its result."""
from dataclasses import replace
import math

import numpy as np
import pytest

from mhri.base.config import ConfigError
from mhri.base.io.pages import page
from mhri.drill.page import TEMPLATE, values_of
from mhri.drill.referee import ALL_FOUND, Doing, Referee, TIME_UP, TruePose
from mhri.drill.results import as_yaml, compared, lines_of, result_of
from mhri.drill.scenario import Scenario, Target
from mhri.session.drill_results import read_result

from support.paths import RESOURCE

WALLS = np.array([[2.0, -1.0, 2.0, 1.0]])
DRIVES = Doing(('bot1',), True)
RESTS = Doing(('bot1',))
AHEAD = Target('can', 1.5, 0.0, 1.0, math.radians(60.0))
BEHIND_WALL = Target('hidden', 2.5, 0.0, 5.0, 2.0 * math.pi)
SMALL = Scenario('small', 'Small', 'Go.', 'small.yaml', ('turtlebot2', 'turtlebot2'), (AHEAD,),
                 False, (), 60.0, {})


class Game:
    """A referee, its clock, and two robots of 0.2 m radius, the second far away."""

    def __init__(self, scenario=SMALL, distance=lambda x, y: 9.0):
        self.referee = Referee(scenario, {'bot1': 0.2, 'bot2': 0.2}, distance, WALLS)
        self.now = 100.0
        self.others = []
        self.referee.begin(self.now)

    def go(self, x, doing=RESTS, yaw=0.0, dt=0.1):
        self.now += dt
        self.referee.update(self.now, {'bot1': TruePose(x, 0.0, yaw),
                                       'bot2': TruePose(9.0, 9.0, 0.0)}, self.others, doing)

    def result(self):
        return result_of(SMALL, self.referee, 1e9, 'person')


def test_a_target_counts_in_range_and_in_view():
    game = Game()
    game.go(0.0)
    game.go(0.6, yaw=math.radians(31.0))
    assert game.referee.found == [] and game.referee.over() == ''
    game.go(0.6, yaw=math.radians(29.0))
    found, = game.referee.found
    assert (found.target, found.robot) == ('can', 'bot1')
    assert found.at_s == pytest.approx(0.3)
    assert game.referee.over() == ALL_FOUND


def test_a_wall_hides_a_target():
    game = Game(replace(SMALL, targets=(BEHIND_WALL,)))
    game.go(0.0)
    assert game.referee.over() == ''
    game.go(2.1)
    assert game.referee.over() == ALL_FOUND


def test_targets_in_order_and_of_one_robot():
    first = Target('first', 5.0, 0.0, 0.5, 2.0 * math.pi)
    second = Target('second', 0.0, 0.0, 0.5, 2.0 * math.pi)
    game = Game(replace(SMALL, targets=(first, second), in_order=True))
    game.go(0.0)
    assert game.referee.found == []
    game.go(5.0)
    game.go(0.0)
    assert [found.target for found in game.referee.found] == ['first', 'second']
    of_other = Game(replace(SMALL, targets=(replace(second, robot='bot2'),)))
    of_other.go(0.0)
    assert of_other.referee.found == []


def test_time_is_up():
    game = Game()
    game.go(0.0, dt=59.9)
    assert game.referee.over() == ''
    game.go(0.0, dt=0.2)
    assert game.referee.over() == TIME_UP


def test_a_contact_counts_once_until_it_is_clear():
    game = Game()
    for gap in (0.5, 0.005, 0.02, 0.005, 0.05, 0.0):
        game.others = [(1.0, 0.0, 0.25)]
        game.go(1.0 - 0.25 - 0.2 - gap)
    tally = game.referee.tally('bot1')
    assert tally.contacts == 2 and tally.least_gap_m == pytest.approx(0.0)
    assert game.referee.tally('bot2').contacts == 0


def test_robots_touch_each_other():
    game = Game()
    game.now += 0.1
    game.referee.update(game.now, {'bot1': TruePose(0.0, 0.0, 0.0),
                                   'bot2': TruePose(0.4, 0.0, 0.0)}, [], RESTS)
    assert game.result()['contacts'] == 2


def test_time_driven_time_neglected_fan_out_and_tolerance():
    game = Game()
    for tick in range(10):
        game.go(0.02 * tick, DRIVES)
    for tick in range(10):
        # For half of the time it goes on by itself.
        game.go(0.2 + 0.02 * min(tick, 4), Doing())
    result = game.result()
    bot1 = result['robots']['bot1']
    assert bot1['driven_s'] == pytest.approx(1.0) and bot1['neglected_s'] == pytest.approx(1.0)
    assert result['robots']['bot2']['neglected_s'] == pytest.approx(2.0)
    assert result['attention'] == pytest.approx(1.0 / 4.0)
    assert result['neglect_tolerance_s'] == pytest.approx(0.5, abs=0.01)
    # Moving counts for a moment longer than it lasts: 0.2 s.
    assert result['fan_out'] == pytest.approx(1.6, abs=0.11)
    assert result['distance_m'] == pytest.approx(0.28)


def test_nobody_drives_under_stop_all():
    game = Game()
    game.go(0.0, Doing(('bot1',), True, True))
    assert game.result()['driven_s'] == 0.0 and game.result()['stops'] == 1


@pytest.mark.parametrize('doing, how', [
    (RESTS, 'stick'), (Doing((), True), 'selection'), (Doing(('bot1',), True, True), 'stop')])
def test_the_first_reaction_to_a_fault(doing, how):
    game = Game()
    game.go(0.0, DRIVES)
    game.referee.on_fault('bot1', 'delay')
    game.go(0.0, DRIVES, dt=0.5)
    game.go(0.0, doing)
    game.go(0.0, DRIVES)
    game.go(0.0, RESTS)
    reaction, = game.referee.reactions
    assert (reaction.how, reaction.after_s) == (how, pytest.approx(0.6))
    assert game.result()['reaction_s'] == 0.6


def test_what_is_written_can_be_read_and_compared():
    game = Game()
    game.go(0.0, DRIVES)
    game.referee.on_fault('bot1', 'delay each way 0.4 s')
    game.go(0.6, DRIVES)
    result = game.result()
    # At noon it is the same day nearly everywhere.
    result['begun'] = 1e9 + 36840.0
    read = read_result(as_yaml(result), 'drill.yaml')
    assert read['found'] == 1 and read['fan_out'] == result['fan_out']
    lines = compared([read, read], ['a', 'b'])
    assert lines[0].split() == ['a', 'b']
    assert any(line.split()[-6:] == '1 of 1 1 of 1'.split() for line in lines)
    heads, *rows = lines_of(result, [dict(read, time_s=61.0), dict(read, begun=0.0)])[1:]
    assert heads.split()[:5] == ['this', 'run', '(person)', 'person', '2001-09-09']
    assert heads.endswith('person rehearsed') and '61.0 s' in rows[0]
    told = '\n'.join(lines_of(result))
    assert 'bot1' in told and 'delay each way 0.4 s' in told
    nothing = Game().result()
    assert nothing['fan_out'] is None and nothing['ended'] == 'left'
    assert read_result(as_yaml(nothing), 'drill.yaml')['fan_out'] is None
    text = page(str(RESOURCE / 'pages'), TEMPLATE, values_of(
        dict(result, title='<Small>'), WALLS.tolist(), [AHEAD], [result]))
    assert '&lt;Small&gt;' in text and '<svg' in text and 'src=' not in text and 'href=' not in text


@pytest.mark.parametrize('text', ['format: 2', 'time_s: 3', '['])
def test_what_is_no_result_is_refused(text):
    with pytest.raises(ConfigError, match='drill.yaml'):
        read_result(text, 'drill.yaml')
