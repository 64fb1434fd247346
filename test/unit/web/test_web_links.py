# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Links: what is given, what opens, what is kept, and how often an address may guess."""
import itertools
import json

import pytest

from mhri.web.links import DRIVE, LinkBook, LinkError, MAX_LINKS, TRIES, TRIES_S, WATCH, WrongTokens
from support.clock import Clock


def book(rows=()):
    return LinkBook(map('token{}'.format, itertools.count()).__next__, rows)


def test_a_token_opens_its_link_until_it_expires_or_is_taken_back():
    links = book()
    link, token = links.give('Visitor', WATCH, True, False, 1.0, 1000.0)
    other, other_token = links.give('Driver', DRIVE, False, True, 1.0, 1000.0)
    assert links.find(token, 4599.0) is link and links.find(token, 4600.0) is None
    assert links.find('', 1000.0) is None and links.find(link.id, 1000.0) is None
    assert links.take(other.id) and not links.take(other.id)
    assert links.find(other_token, 1000.0) is None and links.find(token, 1000.0) is link


def test_a_restarted_server_knows_its_links_and_no_file_has_a_token():
    links = book()
    _, token = links.give('Visitor', WATCH, False, False, 1.0, 0.0)
    text = json.dumps(links.rows())
    assert token not in text
    again = book(json.loads(text))
    assert again.find(token, 0.0) == links.find(token, 0.0)


@pytest.mark.parametrize('row', [
    None, 1, [], {}, {'id': 'a'}, {'may_stop': 1}, {'role': 'own'}, {'expires_s': float('nan')},
    {'expires_s': '9'}, {'more': 1}], ids=repr)
def test_rows_that_are_not_links_open_nothing(row):
    links = book()
    _, token = links.give('Visitor', WATCH, False, False, 1.0, 0.0)
    if isinstance(row, dict) and row and 'id' not in row:
        row = dict(links.rows()[0], **row)
    assert book([row]).find(token, 0.0) is None


@pytest.mark.parametrize('words', [
    ('a', 'own', False, False, 1.0), ('a', WATCH, False, True, 1.0),
    ('a', WATCH, False, False, 0.0),
    ('a', WATCH, False, False, -1.0), ('a', WATCH, False, False, float('nan')),
    ('a', WATCH, False, False, 1e6)], ids=repr)
def test_what_is_not_given(words):
    with pytest.raises(LinkError):
        book().give(*words, 0.0)


def test_there_are_no_more_than_some_and_expired_ones_make_room():
    links = book()
    for _ in range(MAX_LINKS):
        links.give('', WATCH, False, False, 1.0, 0.0)
    with pytest.raises(LinkError):
        links.give('', WATCH, False, False, 1.0, 0.0)
    links.give('', WATCH, False, False, 1.0, 3600.0)
    assert len(links.alive(3600.0)) == 1


def test_an_address_guesses_five_times_a_minute_and_hinders_no_other():
    clock = Clock()
    wrong = WrongTokens(clock)
    for _ in range(TRIES):
        assert wrong.may_try('a')
        wrong.add('a')
    assert not wrong.may_try('a') and wrong.may_try('b')
    clock.now += TRIES_S + 1.0
    assert wrong.may_try('a')
    for number in range(5000):
        wrong.add(str(number))
    assert wrong.may_try('0') and wrong.may_try('a')
