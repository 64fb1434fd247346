# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to the panel: every action from every kind of selection."""
import pytest

from mhri.screen.requests import check_request, RequestRefused, selection_after

ROBOTS = ('bot1', 'bot2', 'bot3')
AFTER = [
    ('select', ('bot3',), ('bot1',), ('bot1', 'bot3')),
    ('select', ('bot1',), ('bot1',), ('bot1',)),
    ('deselect', ('bot1',), ('bot1', 'bot2'), ('bot2',)),
    ('deselect', ('bot3',), ('bot1',), ('bot1',)),
    ('only', ('bot3', 'bot2'), ('bot1',), ('bot2', 'bot3')),
    ('select_all', (), (), ROBOTS),
    ('select_none', (), ROBOTS, ()),
    ('next', (), (), ('bot1',)), ('next', (), ('bot1',), ('bot2',)),
    ('next', (), ('bot3',), ('bot1',)), ('next', (), ('bot1', 'bot2'), ('bot3',)),
    ('previous', (), (), ('bot3',)), ('previous', (), ('bot1',), ('bot3',)),
    ('previous', (), ('bot2', 'bot3'), ('bot1',)),
]


@pytest.mark.parametrize('action, names, selected, after', AFTER)
def test_selection_after(action, names, selected, after):
    assert selection_after(action, names, ROBOTS, selected) == after


@pytest.mark.parametrize('action, names, word', [
    ('drive', (), 'drive'), ('', (), 'one of'), ('select', (), 'needs the name'),
    ('select', ('bot9',), 'bot9'), ('record', ('bot1', 'no such robot'), 'no such robot')])
def test_refused(action, names, word):
    with pytest.raises(RequestRefused, match=word):
        check_request(action, names, ROBOTS)


def test_next_of_nothing():
    for action in ('next', 'previous'):
        with pytest.raises(RequestRefused, match='no robot'):
            selection_after(action, (), (), ())
    assert selection_after('select_all', (), (), ()) == ()
