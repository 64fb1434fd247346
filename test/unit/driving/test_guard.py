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
from mhri.base.geometry import Pose
from mhri.robots.pose_track import PoseTrack
from mhri.sensors import brake, readings
from mhri.sensors.laser_scan import laser_scan

HERE = Path(__file__).resolve().parent
PATH = HERE.parents[2] / 'utils' / 'remote' / 'mhri_guard'
ROS = {'rospy', 'geometry_msgs.msg', 'std_msgs.msg'}
# For its brake and the way back, where they are asked for.
ROS_TO_LOOK = {'sensor_msgs.msg', 'nav_msgs.msg'}

GUARD = load(str(PATH))
NAN, INF = math.nan, math.inf


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


def test_it_brakes_as_the_host_does():
    """Random points and commands: the same velocity, to the last digits."""
    dice = random.Random(0)
    for _ in range(600):
        points = [(dice.uniform(-2.0, 2.0), dice.uniform(-2.0, 2.0))
                  for _ in range(dice.choice((0, 1, 3, 40)))]
        wanted = (dice.choice((0.0009, 0.001, 0.0012, *[dice.uniform(-1.0, 1.0)] * 9)),
                  dice.choice((0.0, dice.uniform(-2.0, 2.0))),
                  dice.choice((0.0, 0.0, dice.uniform(-1.0, 1.0))))
        age = dice.choice((None, 0.0, 0.1, 0.29, 0.31))
        told = GUARD['braked'](wanted, points, 0.2, age)
        expected = brake.braked(Velocity(*wanted), np.array(points).reshape(-1, 2), 0.2, age)
        assert told == pytest.approx(tuple(expected), abs=1e-9)


@pytest.mark.parametrize('point, velocity', [
    ((0.0, 0.125), (0.5, 0.0)), ((1.0, 0.25), (0.5, 0.0)), ((1.25, 1.0), (0.5, 0.5)),
    ((0.75, 1.0), (0.5, 0.5)), ((0.0, 2.0), (0.5, 0.5)), ((-0.1, 0.0), (0.5, 0.5)),
    ((-0.125, 0.0), (0.5, 0.5))])
def test_what_is_beside_or_grazed_or_half_a_turn_away_is_not_in_the_way(point, velocity):
    assert GUARD['free_way']([point], 0.25, velocity + (0.0,)) == brake.free_way(
        np.array([point]), 0.25, Velocity(*velocity)) == INF


def test_what_it_turns_about_is_in_the_way_of_a_robot_that_touches_it():
    assert GUARD['free_way']([(0.0, 0.1)], 0.25, (0.1, 1.0, 0.0)) == brake.free_way(
        np.array([(0.0, 0.1)]), 0.25, Velocity(0.1, 1.0)) == 0.0


def test_it_looks_where_the_host_looks():
    """Slow and very fast: at as many places, up to where it can stand."""
    dice = random.Random(4)
    for _ in range(300):
        speed, delay_s = dice.choice((0.5, 2.0, 9.0)), dice.choice((0.2, 0.5))
        wanted = (dice.uniform(-speed, speed), dice.choice((0.0, dice.uniform(-2.0, 2.0))),
                  dice.choice((0.0, dice.uniform(-1.0, 1.0))))
        for mine, host in zip(GUARD['fronts'](wanted, 0.25, delay_s),
                              brake.fronts(Velocity(*wanted), 0.25, delay_s)):
            assert np.array(mine) == pytest.approx(host)


def test_its_figures_are_those_of_the_host():
    for name in ('SCAN_OLD_S', 'MARGIN_M', 'BRAKES_MPS2', 'REACTION_S', 'CRAWL_MPS', 'KEEP_M'):
        assert GUARD[name] == getattr(brake, name)


VALUES = (), (INF,), (NAN, INF), (0.0, INF), (0.0, NAN, INF), (5.6,), (-INF,)


def test_it_reads_beams_as_the_host_does():
    """Random ranges, at the limits, too: what each says, and up to where it says nothing."""
    dice = random.Random(1)
    for _ in range(1500):
        least, most = dice.choice((0.0, 0.125, 0.5)), dice.choice((0.0, 0.8, 3.5, 10.0))
        some = (NAN, INF, -INF, 0.0, 0.9e-9, 1.2e-9, -1.0, least, most, most + 0.1, 5.61,
                float(np.float32(5.6)), 5.6 * (1.0 + 0.9e-6), 5.6 * (1.0 + 1.2e-6))
        shares = dice.choice(((1, 0, 0), (1, 9, 1), (0, 1, 3)))
        kinds = some, (dice.uniform(0.1, 2.0), dice.uniform(1.0, 4.0)), (0.0, NAN)
        ranges = [dice.choice(dice.choices(kinds, shares)[0])
                  for _ in range(dice.choice((1, 2, 7, 40)))]
        values = dice.choice(VALUES)
        beams = GUARD['read_ranges'](ranges, least, most, values)
        host = readings.read_ranges(ranges, least, most, values)
        assert [NAN if far is None else far for far, _, _ in beams] == pytest.approx(
            list(host.ranges), nan_ok=True, abs=0.0)
        assert [sure for _, sure, _ in beams] == list(np.isfinite(host.ranges) | host.free)
        assert [free for _, _, free in beams] == list(
            host.free | host.unsure | (np.isnan(ranges) & any(map(math.isnan, values))))
        near_m = dice.choice((0.0, 0.25, 0.5, 1.0, INF))
        step = dice.choice((0.0, 0.1, -0.1, 0.5, 2 * math.pi / len(ranges),
                            2 * math.pi / (len(ranges) + 1), 2 * math.pi / (len(ranges) + 1.5)))
        half_m = dice.choice((0.125, 0.25, 0.5))
        assert GUARD['blind_distances'](beams, step, near_m, half_m) == list(
            readings.blind_distances(host, step, near_m, half_m))


@pytest.mark.parametrize('reach_m, most, found', [
    (3.5, 3.5, (0.0,)), (3.5, 3.5009, (0.0,)), (3.5, 3.498, (NAN,)), (0.001, 0.0, (NAN,))])
def test_what_says_that_nothing_is_there_is_that_of_the_laser(reach_m, most, found):
    values = {None: (NAN,), reach_m: (0.0,)}
    for of in (GUARD['no_return_of'], readings.no_return_of):
        assert of(values, most) == pytest.approx(found, nan_ok=True)
        assert of({3.5: (0.0,)}, 9.0) == (INF,)


def test_a_laser_is_dead_when_the_host_takes_it_for_dead():
    """Random shares of beams, in steps of up to a second."""
    dice, field = random.Random(2), 2.0
    for _ in range(1500):
        mine, host = GUARD['LaserLife'](), readings.LaserLife()
        now = turned = 0.0
        for _ in range(8):
            now += dice.choice((0.0, 0.25, 0.5, 1.0, 1.25))
            turned += dice.choice((0.0, 0.0, 0.25, -0.5, 0.5, 3.0))
            share = dice.choice((0.0, 0.0, 0.2, 1.0 / 3.0, 1.0))
            assert mine.look(share, (0.0, 0.0, turned), now, field) == host.look(
                share, Pose(0.0, 0.0, turned), now, field)


def test_odometry_leaps_where_the_host_says_so():
    """And then the scan, of before, counts for nothing."""
    dice, leaps = random.Random(3), []
    for _ in range(1500):
        sight, track = GUARD['Sight'](0.2), PoseTrack()
        begin = dice.uniform(-1.0, 1.0), dice.uniform(-1.0, 1.0), dice.uniform(-3.0, 3.0)
        gone_m, turned = dice.choice(((dice.uniform(0.0, 4.0), 0.0),
                                      (0.0, dice.uniform(-3.1, 3.1))))
        end = begin[0] + 0.6 * gone_m, begin[1] - 0.8 * gone_m, begin[2] + turned
        heard_s, stamp_s = 5.0 + dice.choice((0.0, 0.1, 0.25)), dice.choice((7.0, 7.3, 8.0, 10.0))
        sight.move(begin, 5.0, 7.0)
        sight.see([1.0] * 8, 0.0, 0.75, 0.1, 10.0, 5.0)
        sight.move(end, heard_s, stamp_s)
        track.follow(Pose(*begin), 5.0, None, 7.0)
        leaps.append(track.follow(Pose(*end), heard_s, None, stamp_s))
        assert sight.fresh(heard_s) is not leaps[-1]
    assert any(leaps) and not all(leaps)


# One laser; one before the middle; two that see half a turn each, as robots have them at corners.
NO_RETURNS = {}, {None: (NAN, INF)}, {10.0: (0.0, INF)}
MOUNTS = (((0.0, 0.0, 0.0),), ((-0.06, 0.0, 0.0),), ((0.2, 0.1, 0.4), (-0.2, -0.1, -2.9)))


@pytest.mark.parametrize('seed', range(40))
def test_it_sees_and_remembers_what_the_host_does(monkeypatch, seed):
    """Random scans from random places; of what is in one cell, both keep one, not the same."""
    monkeypatch.setattr(brake, '_GRID_M', 1e-7)
    monkeypatch.setitem(GUARD, 'GRID_M', 1e-7)
    dice, mounts, no_return = random.Random(seed), MOUNTS[seed % 3], NO_RETURNS[seed // 3 % 3]
    mine, host = GUARD['Sight'](0.2, mounts, no_return), brake.Surroundings(0.2)
    turned, scan_s, count = 0.0, None, dice.choice((60, 240, 480))
    limits = [(dice.choice((0.1, 0.45)), 10.0) for _ in mounts]
    step = dice.choice((1, -1)) * 2 * math.pi / dice.choice((count, 1.5 * count, 4 * count))
    for number in range(8):
        # Now and then one of them says nothing for so long that its place is taken.
        at_s, laser = 0.2 * number, dice.randrange(len(mounts))
        turned += dice.uniform(-1.6, 1.6)
        pose = dice.uniform(-0.2, 0.2), dice.uniform(-0.2, 0.2), turned
        ranges = [dice.choice((NAN, 0.0, dice.uniform(0.1, 3.0), dice.uniform(0.1, 1.0)))
                  for _ in range(count)]
        if number % 4 == 2:
            ranges = [dice.choice((INF, 10.0, 11.0, -INF, NAN))] * count
        first = dice.uniform(-3.0, 0.0)
        mine.move(pose, at_s)
        mine.see(ranges, first, step, *limits[laser], at_s, laser)
        looked = host.see(laser_scan(ranges, (first, step), limits[laser], no_return, 0.2,
                                     (Pose(*mounts[laser]), False)),
                          Pose(*pose), at_s, str(laser))
        scan_s = at_s if looked else scan_s
        for part in range(16):
            # Slowly to each side, and fast in bends.
            wanted = (0.06 * math.cos(0.6 * part), 0.0, 0.06 * math.sin(0.6 * part))
            if part > 10:
                wanted = (dice.uniform(-0.6, 0.6), dice.choice((0.0, dice.uniform(-1.0, 1.0))),
                          dice.choice((0.0, dice.uniform(-0.6, 0.6))))
            expected = brake.braked(Velocity(*wanted), host.around(Pose(*pose)), 0.2,
                                    None if scan_s is None else at_s - scan_s,
                                    host.looks(Pose(*pose)))
            assert mine.allow(wanted, at_s) == pytest.approx(tuple(expected), abs=1e-6)


@pytest.mark.parametrize('row', GUARD['PARAMETERS'], ids=lambda row: row[0])
def test_no_parameter_switches_its_protection_off(monkeypatch, row):
    """Beyond these figures nothing would be protected: a lease of 2.1 s, say."""
    name, *figures = row
    assert figures == {
        'lease_s': [0.3, 0.05, 2.0], 'answer_s': [1.0, 0.1, 10.0], 'radius_m': [0.25, 0.02, 10.0],
        'laser_x_m': [0.0, -10.0, 10.0], 'back_after_s': [0.0, 0.0, 3600.0],
        'back_m': [5.0, 0.1, 50.0], 'back_speed': [0.1, 0.02, 0.3]}.get(name, [0.0, 0.0, 100.0])
    _, *bounds = figures
    said = []
    monkeypatch.setattr(GUARD['rospy'], 'get_param', lambda *_: said[-1], raising=False)
    for value in figures:
        said.append(value)
        assert GUARD['number'](*row) == value
    for value in (bounds[0] - 0.01, bounds[1] + 0.1, True, '0.3', NAN):
        said.append(value)
        with pytest.raises(ValueError, match=name):
            GUARD['number'](*row)


def test_where_one_laser_does_not_look_another_does():
    """Two of half a turn each: with one of them it crawls back, with both it drives."""
    one, both = (GUARD['Sight'](0.2, mounts) for mounts in (
        ((0.1, 0.0, 0.0),), ((0.1, 0.0, 0.0), (-0.1, 0.0, math.pi))))
    for sight, lasers in ((one, 1), (both, 2)):
        sight.move((0.0, 0.0, 0.0), 0.0)
        for laser in range(lasers):
            sight.see([9.0] * 181, -math.pi / 2, math.pi / 180, 0.1, 10.0, 0.0, laser)
    assert one.allow((-0.3, 0.0, 0.0), 0.0) == (-brake.CRAWL_MPS, 0.0, 0.0)
    assert one.words(0.0) == 'brake:unseen'
    assert both.allow((-0.3, 0.0, 0.0), 0.0) == (-0.3, 0.0, 0.0) and both.words(0.0) == 'brake:on'


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
