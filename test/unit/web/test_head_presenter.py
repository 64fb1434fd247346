# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's camera follows a headset while the screen may turn it, and the operator does not."""
from dataclasses import replace
from types import SimpleNamespace

import pytest

from mhri.base.views import ControlView
from mhri.web.presenters.head_presenter import AGAIN_S, HANG_S, HeadPresenter
from support.clock import Clock
from support.tools import robot, screen_of, specs

SPECS = specs()
RATE = {'head': replace(SPECS['head'], mode='rate')}


class Desk:
    """The part of a screen, with one robot whose head has reported where it is."""

    def __init__(self):
        self.used, self.notes, self.held, self.clock = [], [], set(), Clock()
        self.part = HeadPresenter(
            lambda *use: self.used.append(use), lambda kind, *more: self.notes.append(kind),
            lambda *who: who in self.held, self.clock)
        self.show()

    def show(self, spec=SPECS, head=(0.0, 0.0), stands='', **more):
        self.part.show_view(screen_of(robot(spec, head=head, stands=stands), **more))

    def turn(self, left=0.75, up=0.4, name='bot1'):
        """Return what a message of the headset has the drive do."""
        before = len(self.used)
        self.part.on_head(SimpleNamespace(robots=[name], value=[left, up]))
        return self.used[before:]


@pytest.fixture
def desk():
    return Desk()


def test_the_angle_of_the_headset_is_that_of_the_camera_up_to_its_end(desk):
    (robots, key, choice, value), = desk.turn()
    assert (robots, key, choice) == (['bot1'], 'head', '')
    assert SPECS['head'].scaled(value) == pytest.approx((0.75, 0.4))
    assert SPECS['head'].scaled(desk.turn(left=-3.0)[0][-1])[0] == SPECS['head'].ranges[0][0]


def test_straight_ahead_turns_it_back_and_does_not_release_it(desk):
    value = desk.turn(0.0, 0.0)[0][-1]
    assert any(value) and max(map(abs, value)) < 0.01


@pytest.mark.parametrize('shown', [
    {'stands': 'stopped'}, {'head': None}, {'spec': RATE}, {'spec': {}},
    {'control': ControlView(who='another', ours=False)}])
def test_nothing_is_asked_of_a_head_that_may_not_act_or_has_no_position(desk, shown):
    desk.show(**shown)
    assert desk.turn() == []
    desk.show()
    assert desk.turn()


def test_nothing_is_asked_of_another_robot_in_a_replay_or_while_the_screen_hangs(desk):
    assert desk.turn(name='bot2') == []
    desk.clock.now += HANG_S
    assert desk.turn() == []
    desk.show()
    assert desk.turn()
    desk.part.disable()
    assert desk.turn() == []


def test_the_operator_comes_first(desk):
    desk.held.add(('bot1', 'head'))
    assert desk.turn() == []
    desk.held.clear()
    assert desk.turn()


def test_it_is_an_event_once_until_it_has_rested(desk):
    for _ in range(3):
        desk.turn()
        desk.show()
    assert desk.notes == ['accessory.used']
    desk.clock.now += AGAIN_S
    desk.show()
    desk.turn()
    desk.show()
    assert desk.notes == 2 * ['accessory.used']
