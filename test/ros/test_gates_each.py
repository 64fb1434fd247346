# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A gate that fails keeps the zero from no other robot."""
from types import SimpleNamespace

import pytest
import rospy

from mhri.base.limits import ZERO
from mhri.base.robot_types import Limits
from mhri.driving.gate import GateRule
from mhri.driving.ros import gates as module
from mhri.driving.settings import Settings
from mhri.graph.ros.stand_by import Memory


class Broken:
    """A gate of which every word fails to leave."""

    def __init__(self, name, robot_type, *_):
        self.name, self.said = name, []
        self.rule = GateRule(Limits(0.5, 1.0), ZERO)
        self.round_trip_s = float('nan')
        self.fails = name == 'bot1'

    def hold_to(self, limits):
        """Have limits that nobody lowers."""

    def ask_brake(self, asked):
        """Have no brake."""

    def leave(self):
        """Fail, or not."""
        self.send(None)

    def send(self, velocity):
        """Take note, or fail."""
        if self.fails and velocity is not None:
            raise AttributeError('no such connection')
        if velocity is not None:
            self.said.append(velocity)


@pytest.fixture(name='robots')
def _robots(monkeypatch):
    """Gates of three robots, the first of which fails."""
    made = []

    def make(*args):
        made.append(Broken(*args))
        return made[-1]

    # What is logged asks for the time, which a node has.
    monkeypatch.setattr(rospy.rostime, '_rostime_initialized', True)
    monkeypatch.setattr(module, 'RobotGate', make)
    gates = module.Gates({}, Memory(), Settings(0.5, 1.5))
    for name in ('bot1', 'bot2', 'bot3'):
        gates._open(name, SimpleNamespace(limits=Limits(0.5, 1.0)))
    return gates, made


def test_the_end_of_the_program_reaches_the_others(robots):
    gates, made = robots
    gates.close()
    assert [gate.said for gate in made[1:]] == [[ZERO], [ZERO]]


def test_a_stop_reaches_the_others(robots):
    gates, made = robots
    gates._on_foreign_stop('bot3')
    assert [gate.said for gate in made[1:]] == [[ZERO], [ZERO]]
