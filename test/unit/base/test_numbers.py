# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's number is its own for good: keys drive by it."""
import random

import pytest

from mhri.base.numbers import MAX_NUMBERS, natural_key, RobotNumbers
from mhri.driving.selection import Selection
from mhri.screen.saved_state import usable_state


def numbers_of(*batches):
    """Return numbers of robots that appeared, batch by batch."""
    numbers = RobotNumbers()
    for batch in batches:
        numbers.assign(batch)
    return numbers


@pytest.mark.parametrize('names', [
    ['bot1', 'bot2', 'bot10', 'bot11'], ['bot', 'bot1', 'bot1a', 'bot_1'],
    ['a2b3', 'a2b20', 'a10b1'], ['bot1', 'Bot2', 'bot3'], ['bot1', 'bot01'][::-1],
    ['r' + '9' * 62, 'r1' + '0' * 62]])
def test_natural_order(names):
    dice = random.Random(1)
    for _ in range(10):
        mixed = dice.sample(names, len(names))
        assert sorted(mixed, key=natural_key) == names


@pytest.mark.parametrize('batches, kept', [
    ([['r20', 'r', 'q']], {'q': 1, 'r': 2, 'r20': 3}),
    ([['bot9'], ['bot10', 'bot2', 'bot']], {'bot': 1, 'bot2': 2, 'bot9': 9, 'bot10': 10}),
    # Of two with one number the first has it, by name or by time.
    ([['x2', 'b2', 'a']], {'a': 1, 'b2': 2, 'x2': 3}),
    ([['z'], ['bot1', 'bot2']], {'z': 1, 'bot2': 2, 'bot1': 3}),
    ([['r103', 'r13', 'r0', 'r12', 'r2a', 'r04']],
     {'r0': 1, 'r2a': 2, 'r13': 3, 'r04': 4, 'r103': 5, 'r12': 12}),
    ([['bot1', 'bot1']], {'bot1': 1}), ([[]], {})])
def test_numbers_are_given_when_first_seen(batches, kept):
    assert numbers_of(*batches).kept() == kept and list(numbers_of(*batches).kept()) == list(kept)


def test_a_number_is_never_given_to_another_robot():
    numbers = RobotNumbers()
    numbers.restore({'b': 2, 'bot2': 5})
    numbers.assign(['bot5', 'b', 'd', 'e', 'c'])
    assert numbers.kept() == {'bot5': 1, 'b': 2, 'c': 3, 'd': 4, 'bot2': 5, 'e': 6}
    assert (numbers.of('e'), numbers.of('nobody')) == (6, 0)


def test_what_was_given_in_this_run_counts_for_more_than_a_file():
    numbers = numbers_of(['bot1'])
    numbers.restore({'bot1': 4, 'bot2': 1, 'bot3': 7})
    assert numbers.kept() == {'bot1': 1, 'bot3': 7}


def test_more_robots_than_a_file_keeps_have_numbers_still():
    numbers = numbers_of(['r{}'.format(number) for number in range(1, MAX_NUMBERS + 3)])
    assert numbers.of('r{}'.format(MAX_NUMBERS + 2)) == MAX_NUMBERS + 2
    assert usable_state({'numbers': numbers.kept()}) == ({'numbers': numbers.kept()}, ())
    assert len(numbers.kept()) == MAX_NUMBERS


def test_whatever_comes_and_goes_a_number_stays():
    """Random adding, removing, looking and restarting, beside a dict that never forgets."""
    dice, known, selection = random.Random(7), {}, Selection()
    for _ in range(2000):
        name = 'bot{}'.format(dice.randrange(40))
        action = dice.choice(('add', 'remove', 'look', 'restart'))
        if action == 'add':
            selection.add(name)
        elif action == 'remove':
            selection.remove(name)
        elif action == 'look':
            found = ['bot{}'.format(dice.randrange(40)) for _ in range(3)]
            selection.numbers.assign(found)
            for other in found:
                selection.add(other)
        else:
            kept, robots = selection.numbers.kept(), selection.robots
            selection = Selection()
            selection.numbers.restore(kept)
            for other in robots:
                selection.add(other)
        now = selection.numbers.kept()
        assert {name: now[name] for name in known} == known
        assert len(set(now.values())) == len(now) and set(selection.robots) <= set(now)
        assert list(selection.robots) == sorted(selection.robots, key=now.get)
        known = now
    assert sorted(known.values()) == list(range(1, 41))
