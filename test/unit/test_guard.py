# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rule of the guard on the robot, under Python 3 and, where it is to be had, Python 2.7."""
import ast
import json
import math
import os
from pathlib import Path
import random
import subprocess
import sys

from guard_scripts import SCRIPTS
import numpy as np
from play_guard import load
import pytest

from mhri.base.limits import Velocity
from mhri.base.mocap import Pose
from mhri.sensors import brake
from mhri.sensors.laser_scan import laser_scan

HERE = Path(__file__).resolve().parent
PATH = HERE.parents[1] / 'utils' / 'remote' / 'mhri_guard'
ROS = {'rospy', 'geometry_msgs.msg', 'std_msgs.msg'}
# For its brake and the way back, where they are asked for.
ROS_TO_LOOK = {'sensor_msgs.msg', 'nav_msgs.msg'}

GUARD = load(str(PATH))


def lines_of(name):
    """Return the lines of a script, and the answers that it expects."""
    rows = [line.strip() for line in SCRIPTS[name].strip().splitlines()]
    said = [row.split(' = ') for row in rows]
    return [row[0] for row in said], [row[1] for row in said if len(row) > 1]


def python_2():
    """Return (command, environment) of a Python 2.7, or None."""
    for extra in ({}, {'PYENV_VERSION': '2.7.18'}):
        environment = dict(os.environ, PYTHONIOENCODING='utf-8', **extra)
        try:
            asked = subprocess.run(['python2.7', '-c', 'print(1)'], env=environment, timeout=30,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
        except FileNotFoundError:
            return None
        if asked.returncode == 0:
            return ['python2.7'], environment
    return None


@pytest.fixture(scope='module', params=['python 2.7', 'python 3'])
def answers(request):
    """What the guard answers to each script."""
    found = ([sys.executable], dict(os.environ)) if request.param == 'python 3' else python_2()
    if found is None:
        pytest.skip('there is no python2.7')
    command, environment = found
    done = subprocess.run(
        command + [str(HERE / 'play_guard.py'), str(PATH)], env=environment, timeout=60,
        input=json.dumps([lines_of(name)[0] for name in SCRIPTS]).encode(),
        stdout=subprocess.PIPE, check=True)
    return dict(zip(SCRIPTS, json.loads(done.stdout.decode())))


@pytest.mark.parametrize('name', SCRIPTS)
def test_the_rule(answers, name):
    lines, expected = lines_of(name)
    told = [line for line in lines
            if line.split()[0] != 'with' and line.split()[1] not in ('move', 'see')]
    assert list(zip(told, answers[name])) == list(zip(told, expected))
    assert len(told) == len(expected)


def imported(nodes):
    """Return the names of all modules that are imported."""
    names = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module)
    return names


def test_it_needs_nothing_else_of_ros_and_nothing_of_mhri():
    tree = ast.parse(PATH.read_text())
    names = imported(ast.walk(tree))
    assert imported(tree.body) == names - ROS_TO_LOOK != names
    assert names - ROS_TO_LOOK - {'__future__', 'binascii', 'collections', 'ctypes', 'math', 'os',
                                  're', 'signal', 'socket', 'sys', 'threading', 'time'} == ROS


@pytest.mark.parametrize('seed', range(300))
def test_it_brakes_as_the_host_does(seed):
    """Random points and commands: the same velocity, to the last digits."""
    dice = random.Random(seed)
    points = [(dice.uniform(-2.0, 2.0), dice.uniform(-2.0, 2.0))
              for _ in range(dice.choice((0, 1, 3, 40)))]
    wanted = dice.uniform(-1.0, 1.0), dice.choice((0.0, dice.uniform(-2.0, 2.0)))
    age = dice.choice((None, 0.0, 0.1, 0.29, 0.31))
    told = GUARD['braked'](wanted, points, 0.2, age)
    expected = brake.braked(Velocity(*wanted), np.array(points).reshape(-1, 2), 0.2, age)
    assert told == pytest.approx((expected.linear_mps, expected.angular_rad_s), abs=1e-9)


def test_its_figures_are_those_of_the_host():
    for name in ('SCAN_OLD_S', 'MARGIN_M', 'BRAKES_MPS2', 'REACTION_S', 'CRAWL_MPS', 'KEEP_M'):
        assert GUARD[name] == getattr(brake, name)


# One laser; one before the middle; two that see half a turn each, as robots have them at corners.
NO_RETURNS = {}, {None: (math.nan, math.inf)}, {10.0: (0.0, math.inf)}
MOUNTS = (((0.0, 0.0, 0.0),), ((-0.06, 0.0, 0.0),), ((0.2, 0.1, 0.4), (-0.2, -0.1, -2.9)))


@pytest.mark.parametrize('step', [2 * math.pi / 360, -2 * math.pi / 360])
@pytest.mark.parametrize('seed', range(21))
def test_it_sees_and_remembers_what_the_host_does(monkeypatch, seed, step):
    """Random scans from random places; of what is in one cell, both keep one, not the same."""
    monkeypatch.setattr(brake, '_GRID_M', 1e-7)
    monkeypatch.setitem(GUARD, 'GRID_M', 1e-7)
    dice, mounts, no_return = random.Random(seed), MOUNTS[seed % 3], NO_RETURNS[seed // 3 % 3]
    mine, host = GUARD['Sight'](0.2, mounts, no_return), brake.Surroundings(0.2)
    turned, scan_s = 0.0, None
    for number in range(8):
        # Now and then one of them says nothing for so long that its place is taken.
        at_s, laser = 0.2 * number, dice.randrange(len(mounts))
        turned += dice.uniform(-1.6, 1.6)
        pose = dice.uniform(-0.2, 0.2), dice.uniform(-0.2, 0.2), turned
        ranges = [dice.choice((float('nan'), 0.0, dice.uniform(0.3, 3.0))) for _ in range(240)]
        if number % 4 == 2:
            ranges = [dice.choice((math.inf, 10.0, 11.0, -math.inf, float('nan')))] * 240
        first = dice.uniform(-3.0, 0.0)
        mine.move(pose, at_s)
        mine.see(ranges, first, step, 0.45, 10.0, at_s, laser)
        looked = host.see(laser_scan(ranges, (first, step), (0.45, 10.0), no_return, 0.2,
                                     (Pose(*mounts[laser]), False)),
                          Pose(*pose), at_s, str(laser))
        scan_s = at_s if looked else scan_s
        wanted = dice.uniform(-0.6, 0.6), dice.uniform(-1.0, 1.0)
        expected = brake.braked(Velocity(*wanted), host.around(Pose(*pose)), 0.2,
                                None if scan_s is None else at_s - scan_s,
                                host.looks(Pose(*pose)))
        assert mine.allow(wanted, at_s) == pytest.approx(
            (expected.linear_mps, expected.angular_rad_s), abs=1e-6)


def test_where_one_laser_does_not_look_another_does():
    """Two of half a turn each: with one of them it crawls back, with both it drives."""
    one, both = (GUARD['Sight'](0.2, mounts) for mounts in (
        ((0.1, 0.0, 0.0),), ((0.1, 0.0, 0.0), (-0.1, 0.0, math.pi))))
    for sight, lasers in ((one, 1), (both, 2)):
        sight.move((0.0, 0.0, 0.0), 0.0)
        for laser in range(lasers):
            sight.see([9.0] * 181, -math.pi / 2, math.pi / 180, 0.1, 10.0, 0.0, laser)
    assert one.allow((-0.3, 0.0), 0.0) == (-brake.CRAWL_MPS, 0.0)
    assert one.words(0.0) == 'brake:unseen'
    assert both.allow((-0.3, 0.0), 0.0) == (-0.3, 0.0) and both.words(0.0) == 'brake:on'


@pytest.mark.parametrize('value, found', [
    ('scan', [('scan', (0.1, 0.0, 0.0))]),
    ('front@0.2 /bot1/rear@-0.2,0,180', [('front', (0.2, 0.0, 0.0)),
                                         ('/bot1/rear', (-0.2, 0.0, math.pi))]),
    ('a@0.1 b@1,-2.5', [('a', (0.1, 0.0, 0.0)), ('b', (1.0, -2.5, 0.0))]),
    ('a b@1,-2.5', None), ('front rear', None),
    ('', None), ('a,b', None), ('a@', None), ('a@1,2,3,4', None), ('a@1.2.3', None), (7, None),
    (' '.join('abcdefghi'), None)])
def test_its_lasers_are_read(monkeypatch, value, found):
    monkeypatch.setattr(GUARD['rospy'], 'get_param', lambda name, default: value, raising=False)
    if found is None:
        with pytest.raises(ValueError, match='give a topic, or up to 8'):
            GUARD['lasers'](0.1)
    else:
        assert GUARD['lasers'](0.1) == [(name, pytest.approx(where)) for name, where in found]


@pytest.mark.parametrize('value, found', [
    ('', {}), ('nan,inf', {None: (math.nan, math.inf)}), (0.0, {None: (0.0,)}),
    ([math.nan, '.inf'], {None: (math.nan, math.inf)}),
    ('0,inf@3.5 0,nan,inf@100',
     {3.5: (0.0, math.inf), 100.0: (0.0, math.nan, math.inf)}),
    ('x', None), ('0,@3', None), ('0@a', None), (True, None)])
def test_what_says_that_nothing_is_there_is_read(monkeypatch, value, found):
    monkeypatch.setattr(GUARD['rospy'], 'get_param', lambda name, default: value, raising=False)
    if found is None:
        with pytest.raises(ValueError, match='no_return.*such as'):
            GUARD['returns']()
    else:
        assert repr(GUARD['returns']()) == repr(found)
