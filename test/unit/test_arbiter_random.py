# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whatever may come in any order never moves a robot that must rest."""
import random

import pytest
from test_arbiter import HELD, RELEASED, Rig

from mhri.devices.profile import JoyRefused


class Oracle:
    """What an outsider may demand of any sequence of events, kept apart from the arbiter's code."""

    def __init__(self, rig):
        self.rig = rig
        self.stopped = False
        self.neutral_since = {'stick': False, 'other': False}
        self.heard_at = None
        self.device = None
        self.held = True
        self.moving = False

    def cause(self):
        """Something happened after which neutral has to be seen."""
        self.neutral_since = {name: False for name in self.neutral_since}

    def stale(self):
        """Tell whether the active source is too old to drive."""
        return self.heard_at is None or self.rig.now - self.heard_at >= 0.5

    def heard(self, axes, device, held):
        """Note an accepted message of the active source."""
        neutral = max(abs(value) for value in axes) <= 0.02
        if self.stale() or device != self.device or (held and not self.held and not neutral):
            self.cause()
        self.heard_at, self.device, self.held = self.rig.now, device, held
        if neutral and not self.stopped:
            self.neutral_since[self.rig.arbiter.mode] = True

    def check(self, sent, must_rest):
        """Judge what was sent after one event (None: nothing)."""
        arbiter = self.rig.arbiter
        if sent is not None and not sent.is_zero():
            assert not self.stopped and not self.stale()
            assert self.neutral_since[arbiter.mode]
            assert abs(sent.linear_mps) <= arbiter.limits[0] + 1e-9
            assert abs(sent.angular_rad_s) <= arbiter.limits[1] + 1e-9
        if self.moving and must_rest:
            assert sent is not None and sent.is_zero(), 'motion ended without a zero'
        if sent is not None:
            self.moving = not sent.is_zero()


def _random_event(dice, rig, oracle):
    """Do one thing; return (sent, whether the robots must rest after it)."""
    kind = dice.choices(('joy', 'tick', 'mode', 'lost', 'stop', 'release', 'limits', 'hold'),
                        (120, 60, 2, 1, 2, 4, 3, 1))[0]
    arbiter, now = rig.arbiter, rig.now
    if kind == 'joy':
        return _random_joy(dice, rig, oracle)
    if kind == 'mode':
        name = dice.choice(('stick', 'other'))
        changed = name != arbiter.mode
        if changed:
            oracle.cause()
            oracle.heard_at = oracle.device = None
        return arbiter.on_mode(name, now), changed
    if kind == 'lost':
        oracle.cause()
        oracle.heard_at = oracle.device = None
        return arbiter.on_lost(arbiter.mode, 'lost', now), True
    if kind == 'stop':
        oracle.stopped = True
        oracle.cause()
        return arbiter.engage_stop_all(now), True
    if kind == 'release':
        if arbiter.release_stop_all(now) is None:
            oracle.stopped = False
        return None, oracle.stopped and oracle.moving
    if kind == 'limits':
        return arbiter.set_limits(dice.uniform(0, 1), dice.uniform(0, 2), now), False
    if kind == 'hold':
        oracle.cause()
        return arbiter.on_hold('master', now), True
    return arbiter.tick(now), oracle.stale()


def _random_joy(dice, rig, oracle):
    """Send a message of either source: neutral, out, beyond the end, or unusable."""
    name = dice.choice((rig.arbiter.mode, rig.arbiter.mode, 'stick', 'other'))
    axes = dice.choice(((0.0, 0.0), (0.0, 0.0), (dice.uniform(-1.5, 1.5), dice.uniform(-1.5, 1.5)),
                        (0.0, 1.0), (float('nan'), 0.0), (1.0,), ()))
    buttons = dice.choice((HELD, HELD, HELD, RELEASED))
    device = dice.choice(('/pad',) * 19 + ('/pad2',))
    active = name == rig.arbiter.mode
    try:
        sent = rig.joy(axes, buttons, name, device)
    except JoyRefused:
        return None, False
    if active:
        oracle.heard(axes, device, name != 'stick' or buttons == HELD)
    resting = active and (max(abs(value) for value in axes) == 0.0 or (
        name == 'stick' and buttons == RELEASED))
    return sent, resting


@pytest.mark.parametrize('seed', range(40))
def test_no_order_of_events_moves_a_robot_that_must_rest(seed):
    """Random sequences, judged by an oracle of its own."""
    dice = random.Random(seed)
    rig = Rig()
    oracle = Oracle(rig)
    moved = 0
    for _ in range(1500):
        rig.now += dice.choice((0.001, 0.01, 0.05, 0.1, 0.2) if dice.random() < 0.98 else (0.7,))
        sent, must_rest = _random_event(dice, rig, oracle)
        oracle.check(sent, must_rest)
        moved += oracle.moving
    assert moved > 30, 'the sequence says nothing if nothing ever moved'
