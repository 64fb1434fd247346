# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What all lines to robots do together, with lines that note it."""
import threading

import pytest
import rospy

from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits
from mhri.driving.drive import Drive
from mhri.driving.ros import robot_lines as module
from mhri.driving.ros.mux_file import read_mux_config, shipped_path
from mhri.graph.ros.stand_by import Memory


class Line:
    """A line to a robot; everything that is sent to bot1 fails, and its power was cut."""

    available = True

    def __init__(self, name, *_):
        self.name, self.sent, self.restored = name, [], 0
        self.power, self.is_cut = self, name == 'bot1'

    def send(self, velocity):
        if self.name == 'bot1':
            raise AttributeError('no such connection')
        self.sent.append(velocity)

    def restore(self):
        self.restored += 1

    def end(self):
        self.sent.append('end')

    def close(self):
        self.sent.append('close')


@pytest.fixture
def drive():
    return Drive(read_mux_config(shipped_path()), 0.0)


@pytest.fixture
def lines(monkeypatch, drive):
    # What is logged asks for the time, which a node has.
    monkeypatch.setattr(rospy.rostime, '_rostime_initialized', True)
    return module.RobotLines(drive, threading.RLock(), {}, Memory(), lambda: 1.0, *6 * [None])


@pytest.fixture
def made(drive, lines):
    """The lines to three robots."""
    made = [Line(name) for name in ('bot1', 'bot2', 'bot3')]
    for line in made:
        lines._lines[line.name] = line
        drive.open(line.name, Limits(0.5, 1.0), 0.0)
    return made


@pytest.mark.parametrize('end', [Drive.close, Drive.on_stop])
def test_the_end_of_the_program_and_a_stop_reach_the_others(drive, lines, made, end):
    """A line that fails keeps the zero from no other robot; then nothing moves any more."""
    lines.carry_out([(line.name, Velocity(0.1)) for line in made])
    assert lines.moving == {'bot1', 'bot2', 'bot3'}
    lines.carry_out(end(drive, 1.0))
    assert [line.sent for line in made[1:]] == 2 * [[Velocity(0.1), ZERO]]
    assert not lines.moving


def test_a_release_restores_no_power_but_what_was_cut(lines, made):
    lines.on_stop(True)
    assert [line.restored for line in made] == [0, 0, 0]
    lines.on_stop(False)
    assert [line.restored for line in made] == [1, 0, 0]


def test_a_line_that_is_opened_again_has_a_session_of_its_own(lines):
    """A guard would drop its commands until their numbers are those of the line before."""
    assert len({lines.new_session() for _ in range(100)}) == 100


def test_a_line_that_replaces_another_takes_over_its_connections(monkeypatch, lines, made):
    """A node that is slow to notice the end of a connection would get no other."""
    old, new = made[1], []

    def open_line(name, *_):
        assert old.sent == [ZERO, 'end'], 'nobody else holds the topics'
        new.append(Line(name))
        raise RuntimeError('the master is gone')
    monkeypatch.setattr(module, 'RobotLine', open_line)
    with pytest.raises(RuntimeError):
        lines._open('bot2', None, False)
    assert (len(new), old.sent, old.rule) == (1, [ZERO, 'end', 'close'], None)
