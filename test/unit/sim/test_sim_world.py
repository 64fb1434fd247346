# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The building that the processes of all simulated robots share."""
import multiprocessing
import os
from pathlib import Path
import stat
import time

import numpy as np
import pytest

from mhri.sim import world as world_module
from mhri.sim.body import parse_bodies
from mhri.sim.world import GHOST_S, look_in, World, world_path, WorldRefused
from support.clock import Clock

BODY = parse_bodies((Path(__file__).resolve().parents[3] / 'resource' / 'sim'
                     / 'bodies.yaml').read_text(), 'bodies.yaml')['turtlebot2']
# They need nothing but what is loaded here.
PROCESSES = multiprocessing.get_context('fork')
TIMEOUT_S = 60.0


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def enter(tmp_path, clock):
    """Return a function that lets a robot in at a place."""
    def _enter(name, x=0.0, y=0.0, key='one building'):
        world = World(world_path(key, str(tmp_path)), name, BODY, clock)
        world.publish(x, y, 0.5)
        return world
    return _enter


def seen(world):
    return sorted(map(tuple, world.discs().tolist()))


def test_each_sees_the_others_but_not_itself(enter):
    one = enter('bot1', 1.0, 2.0)
    assert seen(one) == []
    two, three = enter('bot2', 3.0, 4.0), enter('bot3', 5.0, 6.0)
    radius = BODY.radius_m
    assert seen(one) == [(3.0, 4.0, radius), (5.0, 6.0, radius)]
    assert seen(two) == [(1.0, 2.0, radius), (5.0, 6.0, radius)]
    three.publish(5.5, 6.5, 0.0)
    assert seen(one)[1] == (5.5, 6.5, radius)


def test_a_robot_that_has_not_said_where_it_is_is_out_of_sight(enter, tmp_path, clock):
    one = enter('bot1')
    path = world_path('one building', str(tmp_path))
    two = World(path, 'bot2', BODY, clock)
    assert seen(one) == [] and [row['name'] for row in look_in(path, clock)] == [b'bot1']
    two.publish(3.0, 4.0, 0.0)
    assert seen(one) == [(3.0, 4.0, BODY.radius_m)]


def race(path, name, done):
    """Say a place whose parts belong together, as fast as can be, and come back now and then."""
    number = 0
    while not done.is_set():
        world = World(path, name, BODY, time.monotonic)
        for _ in range(500):
            number = number % 1000 + 1
            world.publish(float(number), -float(number), 0.001 * number)


def test_nobody_is_seen_where_it_never_was(tmp_path):
    """Neither between two places, nor at none, by another robot or by the referee of a drill."""
    path, done = world_path('fast', str(tmp_path)), PROCESSES.Event()
    watcher = World(path, 'watcher', BODY, time.monotonic)
    robots = [PROCESSES.Process(target=race, args=(path, 'bot{}'.format(number), done), daemon=True)
              for number in range(2)]
    for robot in robots:
        robot.start()
    looks, begun = 0, time.monotonic()
    while looks < 100 or time.monotonic() - begun < 2.0:
        assert all(robot.is_alive() for robot in robots)
        for rows in (watcher.others(), look_in(path, time.monotonic)):
            for row in rows:
                looks += 1
                place = float(row['x']), float(row['y']), float(row['yaw'])
                assert 1.0 <= place[0] <= 1000.0, place
                assert place == (place[0], -place[0], 0.001 * place[0])
                assert tuple(row['colour']) == BODY.colour and row['radius'] == BODY.radius_m
    done.set()
    for robot in robots:
        robot.join(TIMEOUT_S)
        assert robot.exitcode == 0


def test_buildings_are_apart(enter, tmp_path):
    one = enter('bot1')
    enter('bot2', key='another')
    assert seen(one) == []
    assert world_path('one building') != world_path('another')
    path = tmp_path / Path(world_path('one building')).name
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_who_leaves_is_gone_and_the_last_removes_the_file(enter, tmp_path):
    one, two = enter('bot1'), enter('bot2')
    two.leave()
    assert seen(one) == [] and os.listdir(str(tmp_path))
    one.leave()
    assert os.listdir(str(tmp_path)) == []
    one.leave()
    assert seen(enter('bot3')) == []


def test_killed_robot_stays_as_a_body_until_its_ghost_fades(enter, clock):
    one = enter('bot1')
    enter('bot2', 3.0, 4.0)
    clock.now += GHOST_S - 0.1
    one.publish(0.0, 0.0, 0.0)
    assert len(seen(one)) == 1
    clock.now += 0.2
    assert seen(one) == []


def test_restarted_robot_takes_its_body_back(enter):
    one = enter('bot1')
    enter('bot2', 3.0, 4.0)
    again = enter('bot2', 7.0, 8.0)
    assert seen(one) == [(7.0, 8.0, BODY.radius_m)]
    assert len(seen(again)) == 1


def test_sleeper_whose_place_was_given_away_takes_another(enter, clock):
    sleeper = enter('sleeper', 1.0, 1.0)
    clock.now += GHOST_S + 1.0
    one, two = enter('bot1', 3.0, 3.0), enter('bot2', 5.0, 5.0)
    assert seen(one) == [(5.0, 5.0, BODY.radius_m)]
    sleeper.publish(2.0, 2.0, 0.0)
    assert [place[0] for place in seen(one)] == [2.0, 5.0]
    assert [place[0] for place in seen(two)] == [2.0, 3.0]
    assert [place[0] for place in seen(sleeper)] == [3.0, 5.0]


def test_leftovers_of_a_crash(tmp_path, clock):
    """A short file, a file of noise, stamps of another boot: none keeps a robot out."""
    path = Path(world_path('crashed', str(tmp_path)))
    World(str(path), 'bot1', BODY, clock)
    size = path.stat().st_size
    noise = np.random.default_rng(1).bytes(size)
    for content in (b'', b'x' * 100, b'\xff' * size, noise):
        path.write_bytes(content)
        path.chmod(0o600)
        world = World(str(path), 'bot1', BODY, clock)
        world.publish(1.0, 2.0, 0.0)
        assert seen(world) == []
        other = World(str(path), 'bot2', BODY, clock)
        assert seen(other) == [(1.0, 2.0, BODY.radius_m)]
    path.unlink()
    World(str(path), 'bot1', BODY, lambda: clock.now + 1e6).publish(0.0, 0.0, 0.0)
    assert seen(World(str(path), 'bot2', BODY, clock)) == [], 'written before the clock began anew'


def link_to_a_file(path, aside):
    aside.write_bytes(b'precious')
    os.symlink(str(aside), path)


def second_name(path, aside):
    aside.write_bytes(b'precious')
    aside.chmod(0o600)
    os.link(str(aside), path)


def file_for_all(path, aside):
    aside.write_bytes(b'precious')
    aside.rename(path)
    os.chmod(path, 0o666)


@pytest.mark.parametrize('lay, reason', [
    (link_to_a_file, 'symbolic links'), (second_name, 'another name'), (file_for_all, 'mode 666'),
    (lambda path, aside: os.mkfifo(path, 0o600), 'not an ordinary file'),
    (lambda path, aside: os.mkdir(path), 'directory')])
def test_what_is_no_file_of_this_user_alone_is_refused(tmp_path, clock, lay, reason):
    path, aside = world_path('trap', str(tmp_path)), tmp_path / 'aside'
    lay(path, aside)
    handles = len(os.listdir('/proc/self/fd'))
    with pytest.raises(WorldRefused, match=reason) as refused:
        World(path, 'bot1', BODY, clock)
    assert path in str(refused.value) and 'remove it' in str(refused.value)
    assert len(os.listdir('/proc/self/fd')) == handles
    for left in (aside, Path(path)):
        assert not left.is_file() or left.read_bytes() == b'precious', 'neither written nor cut'


def test_the_file_of_another_user_is_refused(tmp_path, clock, monkeypatch):
    path = world_path('theirs', str(tmp_path))
    Path(path).write_bytes(b'precious')
    os.chmod(path, 0o600)
    monkeypatch.setattr(world_module.os, 'getuid', lambda mine=os.getuid(): mine + 1)
    with pytest.raises(WorldRefused, match='another user'):
        World(path, 'bot1', BODY, clock)
    assert Path(path).read_bytes() == b'precious'
