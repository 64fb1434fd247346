# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a restarted master is told of the nodes that it has forgotten."""
import pytest

from mhri.link.lost_registrations import MasterState, registrations

GUARD, BASE, LINK = '/bot1/mhri_guard', '/bot1/base', '/bot1/mhri_link'
URIS = {GUARD: 'http://r:1/', BASE: 'http://r:2/', LINK: 'http://r:3/', '/reset': 'rosrpc://r:4'}
STATE = [[('/odom', [BASE]), ('/echo', [GUARD])], [('/cmd', [BASE]), ('/echo', [LINK])],
         [('/reset', [BASE])]]
OF_BASE = [('registerSubscriber', '/cmd', 'Twist', 'http://r:2/'),
           ('registerPublisher', '/odom', '*', 'http://r:2/'),
           ('registerService', '/reset', 'rosrpc://r:4', 'http://r:2/')]
OF_GUARD = [('registerPublisher', '/echo', '*', 'http://r:1/')]


def known(run, state, uris):
    return MasterState(run, state, {'/cmd': 'Twist'}, uris)


@pytest.mark.parametrize('now, alive, calls', [
    ([[], [], []], URIS.values(), {BASE: OF_BASE, GUARD: OF_GUARD}),
    # Who has registered by itself, if only in part, speaks for itself.
    ([[('/odom', [BASE])], [], []], URIS.values(), {GUARD: OF_GUARD}),
    # Who died with the master is not brought back as a ghost.
    ([[], [], []], ['http://r:1/'], {GUARD: OF_GUARD}),
    ([[], [], []], [], {})])
def test_the_living_are_registered_again(now, alive, calls):
    assert registrations(known(1, STATE, URIS), known(2, now, {}), set(alive), LINK) == calls


def test_a_node_whose_address_was_never_known_is_left_alone():
    assert registrations(known(1, STATE, {}), known(2, [[], [], []], {}), {''}, LINK) == {}
