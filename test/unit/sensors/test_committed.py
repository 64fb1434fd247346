# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The committed path: exactly the commands that are still on their way, and nothing after them."""
import math

import pytest

from mhri.base.limits import Velocity
from mhri.sensors.committed import FROM_S, MAX_S, SentCommands, STAY_S

AHEAD = Velocity(0.5)


def sent(*commands):
    """Return the book of (time [s], velocity)."""
    book = SentCommands()
    for at, velocity in commands:
        book.add(velocity, at)
    return book


@pytest.mark.parametrize('commands, end', [
    ([(0.0, AHEAD)], (0.4, 0.0, 0.0)),
    ([(0.0, AHEAD), (9.6, Velocity())], (0.2, 0.0, 0.0)),
    ([(0.0, Velocity()), (9.8, AHEAD)], (0.1, 0.0, 0.0)),
    ([(0.0, AHEAD), (5.0, Velocity()), (9.9, Velocity(-0.5))], (-0.05, 0.0, 0.0)),
    ([(0.0, Velocity(0.0, 1.0))], (0.0, 0.0, 0.8)),
    ([(0.0, Velocity(0.0, -1.0, 0.0)), (9.6, Velocity(0.5))],
     (0.2 * math.cos(0.4), -0.2 * math.sin(0.4), -0.4)),
    ([(0.0, Velocity(0.0, 0.0, 0.3))], (0.0, 0.24, 0.0)),
    ([(0.0, Velocity(0.5, 1.0))],
     (0.5 * math.sin(0.8), 0.5 * (1.0 - math.cos(0.8)), 0.8)),
    ([(9.9, AHEAD)], (0.05, 0.0, 0.0)),
])
def test_it_ends_where_the_next_command_finds_the_robot(commands, end):
    path = sent(*commands).path(0.8, 10.0)
    last = path[-1]
    assert path[0] == type(last)(0.0, 0.0, 0.0)
    assert (last.x_m, last.y_m, last.heading_rad) == pytest.approx(end, abs=2e-4)


@pytest.mark.parametrize('commands, round_trip_s', [
    ([(0.0, AHEAD)], None), ([(0.0, AHEAD)], math.nan), ([(0.0, AHEAD)], FROM_S - 0.01),
    ([(0.0, AHEAD)], MAX_S + 0.1), ([(0.0, AHEAD)], math.inf), ([], 0.8),
    ([(0.0, Velocity())], 0.8), ([(0.0, AHEAD), (9.1, Velocity())], 0.8),
    ([(0.0, Velocity(math.nan))], 0.8)])
def test_there_is_none(commands, round_trip_s):
    assert sent(*commands).path(round_trip_s, 10.0) == ()


def test_it_begins_at_0_3_s_and_does_not_flicker_there():
    book = sent((0.0, AHEAD))
    between = FROM_S - 0.5 * STAY_S
    assert not book.path(between, 10.0) and book.path(FROM_S, 10.0)
    assert book.path(between, 10.0) and not book.path(FROM_S - 2.0 * STAY_S, 10.0)
    assert not book.path(between, 10.0)


def test_a_turn_there_and_back_is_a_path_and_what_is_forgotten_is_none():
    book = sent((0.0, Velocity(0.0, 1.0)), (9.6, Velocity(0.0, -1.0)))
    assert max(pose.heading_rad for pose in book.path(0.8, 10.0)) == pytest.approx(0.4)
    book.clear()
    assert book.path(0.8, 10.0) == ()
