# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Buttons act once, and not because they were held when a device came."""
from mhri.driving.buttons import ButtonEdges

STOP, NEXT, ALL = 'stop_all', 'next_robot', 'select_all'


def test_a_button_acts_once_until_it_is_pressed_again():
    edges = ButtonEdges()
    assert edges.newly('pad', 'a', ()) == set()
    assert edges.newly('pad', 'a', {NEXT}) == {NEXT}
    assert edges.newly('pad', 'a', {NEXT}) == set()
    assert edges.newly('pad', 'a', {NEXT, ALL}) == {ALL}
    assert edges.newly('pad', 'a', ()) == set()
    assert edges.newly('pad', 'a', {NEXT}) == {NEXT}


def test_what_is_held_in_the_first_message_does_nothing_but_stop():
    edges = ButtonEdges()
    assert edges.newly('pad', 'a', {NEXT, STOP}) == {STOP}
    assert edges.newly('pad', 'a', {NEXT, STOP}) == set()
    assert edges.newly('pad', 'b', {NEXT, STOP}) == {STOP}, 'another device'


def test_sources_do_not_mix():
    edges = ButtonEdges()
    edges.newly('pad', 'a', ())
    edges.newly('pedal', 'a', ())
    assert edges.newly('pad', 'a', {NEXT}) == {NEXT}
    assert edges.newly('pedal', 'a', {NEXT}) == {NEXT}
