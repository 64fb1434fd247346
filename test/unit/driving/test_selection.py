# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of robots and its check marks."""
from mhri.driving.selection import Selection


def three():
    """Return a list of three robots, none checked."""
    selection = Selection()
    for name in ('b', 'a', 'c'):
        assert selection.add(name)
    return selection


def test_robots_keep_the_order_of_their_numbers():
    """A row does not jump because another robot came or went."""
    selection = three()
    assert (selection.robots, selection.selected) == (('b', 'a', 'c'), ())
    assert not selection.add('a') and selection.robots == ('b', 'a', 'c')
    assert selection.numbered() == {'b': 1, 'a': 2, 'c': 3}


def test_check_returns_what_changed():
    """Newly checked, newly unchecked; unknown names are nobody."""
    selection = three()
    assert selection.check(['c', 'b']) == (('b', 'c'), ())
    assert selection.selected == ('b', 'c')
    assert selection.check(['a', 'c', 'ghost']) == (('a',), ('b',))
    assert selection.check(['a', 'c', 'c']) == ((), ())
    assert selection.check([]) == ((), ('a', 'c'))


def test_adding_again_keeps_the_check_mark_and_removing_forgets_it():
    """A robot that comes back begins unchecked: it does not move by itself."""
    selection = three()
    selection.check(['a'])
    selection.add('a')
    assert selection.selected == ('a',)
    selection.remove('a')
    selection.remove('ghost')
    selection.add('a')
    assert (selection.robots, selection.selected) == (('b', 'a', 'c'), ())
