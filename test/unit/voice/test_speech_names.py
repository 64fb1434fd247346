# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How robots are called: names into phrases, numbers into words, and names that cannot be used."""
import pytest

from mhri.voice.names import (
    call_robots, in_places, MAX_ROBOTS, number_words, numbered, spoken_names)

WORDS = set('bot rover turtle turtlebot robot big blue t b r x one tb left stop'.split())


def knows(word):
    return word in WORDS


NUMBERS = {0: 'zero', 1: 'one', 10: 'ten', 12: 'twelve', 19: 'nineteen', 20: 'twenty',
           21: 'twenty one', 30: 'thirty', 99: 'ninety nine'}


@pytest.mark.parametrize('number', sorted(NUMBERS))
def test_numbers(number):
    assert number_words(number) == NUMBERS[number]


@pytest.mark.parametrize('number', (-1, 100))
def test_numbers_outside(number):
    with pytest.raises(ValueError, match='from 0 to 99'):
        number_words(number)


NAMES = {
    'bot1': ('bot one',),
    'rover': ('rover',),
    'BigRover': ('big rover',),
    'big_rover_2': ('big rover two',),
    'turtlebot2': ('turtlebot two',),
    'bluebot': ('blue bot',),
    'tb3': ('t b three',),
    'bot12': ('bot twelve', 'bot one two'),
    'bot07': ('bot zero seven',),
    'bot123': ('bot one two three',),
    # Half a name would be another robot's.
    'xqzw7': (),
    'qqqqqqqq': ()}


@pytest.mark.parametrize('name', sorted(NAMES))
def test_names(name):
    assert spoken_names(name, knows) == NAMES[name]


def test_robots_are_called_by_name():
    called, notes = call_robots(['bot1', 'rover'], knows, {'left', 'stop'}, ('robot',))
    assert called == {'bot1': ('bot one',), 'rover': ('rover',)}
    assert notes == []


BY_NUMBER = {
    'left': 'means something else',
    'stop1': 'means something else',
    'robot': 'sounds like the wake word',
    'qqqqqqqq': 'no words'}


@pytest.mark.parametrize('name', sorted(BY_NUMBER))
def test_robots_that_go_by_their_number_alone(name):
    """Each with a note that says why, and what to say instead."""
    called, notes = call_robots(['rover', name], knows, {'left', 'stop'}, ('robot',))
    assert called[name] == ()
    assert called['rover'] == ('rover',)
    assert BY_NUMBER[name] in notes[0] and notes[0].endswith('"two"')


def test_robots_that_sound_alike_go_by_their_number():
    called, notes = call_robots(['bot1', 'bot_1'], knows, set())
    assert called == {'bot1': (), 'bot_1': ()}
    assert len(notes) == 2 and 'bot_1' in notes[0]


def test_what_is_no_robot_is_left_out():
    called, _ = call_robots(['rover', 'no name', 7, None, '', 'rover'], knows, set())
    assert list(called) == ['rover']


@pytest.mark.parametrize('numbers, spoken', [
    ({'bot2': 2, 'rover': 4, 'gone': 1}, {'bot2': 2, 'rover': 4}),
    ({'bot2': 1, 'rover': 2}, {'bot2': 1, 'rover': 2}), ({'rover': 1}, {'rover': 1}),
    ({}, {'bot2': 1, 'rover': 2}), ('rubbish', {'bot2': 1, 'rover': 2}),
    ({'bot2': [7], 'rover': True}, {}), ({'bot2': 0, 'rover': 100}, {}),
    ({'bot2': 3, 'rover': 99}, {'bot2': 3, 'rover': 99})])
def test_a_number_that_is_said_is_the_robots_own(numbers, spoken):
    places = in_places(['bot2', 'rover'], numbers)
    assert numbered(places) == spoken
    assert all(isinstance(name, str) for name in places) and len(places) < 100


def test_no_more_robots_than_can_be_told_apart():
    called, _ = call_robots(['bot{}'.format(number) for number in range(99)], knows, set())
    assert len(called) == MAX_ROBOTS
