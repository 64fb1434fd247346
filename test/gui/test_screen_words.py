# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a replay is compared with the screen that was live: what is found, and what passes."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.robots.link import Motion  # noqa: E402
from support.screen_words import (  # noqa: E402
    differences, event_differences, framed, words_of_motion)

SPEEDS = 'bot1 hud 0'


@pytest.mark.parametrize('then, now', [
    (['LIVE'], 'LIVE'), (['a', 'b'], 'b'), (['0.20 m/s', '0.30 m/s'], '0.25 m/s'),
    (['heading 359'], 'heading 000'), (['-0.02 rad/s', '+0.02 rad/s'], '+0.01 rad/s'),
    (['1.70 m to the nearest thing, ahead'], '1.71 m to the nearest thing, left')])
def test_what_was_there_or_between_is_the_same(then, now):
    assert differences([], [{'place': words} for words in then], [], {}, {'place': now}) == []


@pytest.mark.parametrize('then, now', [
    (['STOPPED'], ''), ([''], 'lost'), (['stopped in 11 ms'], 'stopped in 80 ms'),
    (['1 of 4 robots'], '4 of 4 robots'), (['nothing for 3.4 s'], 'nothing for 61.5 s'),
    (['heading 340'], 'heading 020'), (['DRIVING', ''], 'MOVING')])
def test_what_was_not_is_told(then, now):
    found, = differences([], [{'place': words} for words in then], [], {}, {'place': now})
    assert repr(now) in found and repr(then[0]) in found


def test_numbers_may_lie_between_those_beside_the_moment_and_what_the_robot_said():
    then, now = [{SPEEDS: '0.00 m/s   0.00 rad/s'}], {SPEEDS: '0.20 m/s   0.00 rad/s'}
    after = [{SPEEDS: '0.30 m/s   0.00 rad/s'}]
    assert differences([], then, [], {}, now)
    assert differences([], then, after, {}, now) == []
    moved = {SPEEDS: [words_of_motion('bot1', Motion(0.21, 0.0))[SPEEDS]]}
    assert differences([], then, [], moved, now) == []


def test_a_header_may_leave_words_out_and_no_others():
    then = [{'bot1 header.type_label': 'TurtleBot2', 'bot1 header.pill': 'DRIVING'}]
    found, = differences([], then, [], {}, {})
    assert found.startswith('bot1 header.pill')


def test_words_without_numbers_tell_whether_they_change():
    assert framed({'a': '0.1 m'}) == framed({'a': '0.2 m'}) != framed({'a': 'back 0.2 m'})


def test_an_event_that_is_not_there_is_told():
    told = [(1.0, 'bot1', 'found'), (2.0, '', 'saved')]
    assert event_differences(told, [('bot1', 'found')]) == ["no event 'saved' of all"]
