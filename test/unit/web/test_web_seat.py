# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stick of the page: one holder, from a centred stick on, while its frames come."""
from mhri.web.seat import CENTRE, Seat, SILENT_S
from support.clock import Clock

AHEAD = [0.0, 1.0, 0.0]


def seat():
    """Return a seat that 'a' holds with a centred stick, and its clock."""
    clock = Clock()
    found = Seat(clock)
    assert found.take('a', '') and found.stick('a', CENTRE) == CENTRE
    return found, clock


def test_the_holder_drives_and_nobody_else():
    one, _ = seat()
    assert one.stick('a', AHEAD) == (0.0, 1.0, 0.0)
    assert not one.take('b', '') and one.stick('b', AHEAD) is None
    assert one.take('a', '') and one.holder == 'a'
    assert not one.leave('b', 'no') and one.leave('a', '')
    assert one.stick('a', AHEAD) is None and not one.leave('a', '') and not one.leave(None, '')
    assert one.take('b', '') and one.stick('a', AHEAD) is None


def test_who_may_not_drive_takes_nothing():
    one = Seat(Clock())
    assert not one.take('a', 'another source drives') and one.holder is None


def test_a_stick_that_is_held_out_as_it_is_taken_moves_nothing_until_it_was_centred():
    one = Seat(Clock())
    one.take('a', '')
    assert [one.stick('a', AHEAD) for _ in range(3)] == [CENTRE] * 3
    one.stick('a', [0.01, -0.01, 0.0])
    assert one.stick('a', AHEAD) == (0.0, 1.0, 0.0)
    one.leave('a', '')
    one.take('a', '')
    assert one.stick('a', AHEAD) == CENTRE


def test_frames_behind_a_pause_are_old_and_the_hold_is_over():
    one, clock = seat()
    clock.now += SILENT_S
    assert one.stick('a', AHEAD) and not one.silent()
    clock.now += SILENT_S + 0.01
    assert one.silent() and [one.stick('a', AHEAD) for _ in range(3)] == [None] * 3
    assert one.leave(None, 'silent') and not one.silent() and one.why == 'silent'
