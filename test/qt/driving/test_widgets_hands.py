# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The grip of a scripted drive: it grabs the stick again as an operator would."""
import pytest

from mhri.driving.gui.hands import CENTRE, Grip, READY


class Stick:
    """A stick whose robot moves while it is held, and that others may centre."""

    def __init__(self):
        self.now, self.held, self.status, self.said = 0.0, False, READY, []
        self.moves = False
        self.grip = Grip(lambda: self.put(True), lambda: self.put(False), lambda: self.status,
                         lambda: self.moves and self.held, lambda: self.now)

    def put(self, held):
        self.held = held
        self.said.append(held)

    def look(self, status=READY, seconds=0.1):
        """Look once, some time later."""
        self.now += seconds
        self.status = status
        return self.grip()


@pytest.fixture
def stick():
    made = Stick()
    assert not made.look() and made.said == [True]
    return made


def test_one_that_has_to_be_centred_is_grabbed_again(stick):
    for status in (CENTRE, CENTRE, READY):
        stick.look(status)
    assert stick.said == [True, False, True] and stick.grip.times == 2


def test_one_that_others_have_centred_is_grabbed_again(stick):
    for _ in range(30):
        stick.look('the drive service does not answer')
    stick.held = False
    stick.moves = True
    for _ in range(12):
        if stick.look():
            break
    assert stick.said == [True, False, True] and stick.grip.times == 2 and stick.look()


def test_one_whose_robot_begins_to_move_within_a_second_is_held(stick):
    for _ in range(9):
        assert not stick.look()
    stick.moves = True
    assert stick.look() and stick.said == [True]
