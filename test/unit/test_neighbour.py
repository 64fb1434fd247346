# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mux and gates know of each other whether they are heard."""
from mhri.base.pulse import Neighbour


def looks(watched, since, until):
    """Look ten times a second; return {time: line} of what is to be logged."""
    times = [round(tenth / 10.0, 1) for tenth in range(round(since * 10), round(until * 10) + 1)]
    return {at: line for at, line in ((at, watched.look(at)) for at in times) if line}


def test_one_that_was_never_heard_is_not_silent():
    watched = Neighbour('the gates')
    assert looks(watched, 0.0, 60.0) == {} and not watched.silent
    assert watched.words(60.0) == 'not heard yet'


def test_silence_is_said_once_and_its_end_as_well():
    watched = Neighbour('the gates')
    watched.beat('/mhri_gates', 10.05)
    assert looks(watched, 10.1, 10.9) == {} and not watched.silent
    assert watched.words(10.9) == '/mhri_gates is heard'
    assert looks(watched, 11.0, 13.0) == {11.0: 'the gates (/mhri_gates): silent for 0.9 s'}
    assert watched.silent
    assert watched.words(13.05) == '/mhri_gates has been silent for 3 s'
    assert watched.words(16.05) == \
        '/mhri_gates has been silent for 6 s: end it and start it again'
    watched.beat('/mhri_gates', 16.05)
    assert looks(watched, 16.1, 16.9) == {16.1: 'the gates (/mhri_gates): heard again'}
    assert not watched.silent


def test_who_was_held_up_itself_blames_nobody():
    """Its own sleep looks like the silence of the other node."""
    watched = Neighbour('the mux')
    watched.beat('/mux', 10.0)
    assert looks(watched, 10.0, 10.2) == {}
    assert watched.look(30.0) == '' and not watched.silent
    assert looks(watched, 30.1, 31.5) == {31.0: 'the mux (/mux): silent for 1.0 s'}
