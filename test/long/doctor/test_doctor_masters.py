# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which masters programs on this computer use, as the kernel tells; when this one was started."""
import contextlib
import os
import subprocess
import sys
import time

import pytest

from mhri.doctor.facts import Computer
from mhri.doctor.ros.masters import look_elsewhere, MOST, parse_uri, uris_in_use
from mhri.graph.ros.process_start import MAX_AGE_S, started_s
from support.ros_system import insist

COMPUTER = Computer(name='desk', addresses=('127.0.0.1', '192.0.2.1'),
                    resolved={'localhost': ('127.0.0.1',), 'desk': ('192.0.2.1',)})
URI = 'http://127.0.0.1:{}'


@pytest.fixture
def programs():
    """Start programs by other names, each of which ends with the test."""
    with contextlib.ExitStack() as ends:
        def start(*words, **variables):
            program = ends.enter_context(subprocess.Popen(
                [words[0], '-c', 'print(flush=True); input()', *words[1:]],
                executable=sys.executable, env=dict(os.environ, **variables),
                stdin=subprocess.PIPE, stdout=subprocess.PIPE))
            ends.callback(program.kill)
            program.stdout.readline()
        yield start


def test_masters_that_programs_use(programs):
    programs('a', ROS_MASTER_URI='http://desk:11322')
    programs('b', ROS_MASTER_URI='http://desk:11322')
    programs('c', ROS_MASTER_URI='http://caf\udce9:1', XROS_MASTER_URI='http://no:1')
    programs('/opt/ros/bin/rosmaster', '--core', '-p', '11333')
    programs('cp', '-p', '11334')
    programs('roscore', '-p')
    found = uris_in_use()
    assert {'http://desk:11322', 'http://caf?:1', 'http://localhost:11333'} <= found
    assert not {'http://no:1', 'http://localhost:11334'} & found


def asked(monkeypatch, uri, uris):
    """Return the URIs that are asked."""
    calls = []

    def api(_, __, other):
        calls.append(other)
        raise ValueError('none there')
    monkeypatch.setattr('mhri.doctor.ros.masters.MasterApi', api)
    assert look_elsewhere(parse_uri(uri), COMPUTER, '/x', uris=uris) == ()
    return sorted(calls)


def test_each_other_master_is_asked_once(monkeypatch):
    assert asked(monkeypatch, URI.format(11311), [
        'http://localhost:11311/', 'http://192.0.2.1:11311', URI.format(11322),
        'http://localhost:11322', 'http://192.0.2.7:11311', 'nonsense', 'http://desk', '']) == [
            URI.format(11322), 'http://192.0.2.7:11311']
    assert asked(monkeypatch, 'http://192.0.2.7:11322', []) == [
        'http://192.0.2.7:11311', 'http://localhost:11311']
    many = ['http://192.0.2.7:{}'.format(port) for port in range(1, 99)]
    assert len(asked(monkeypatch, URI.format(11311), many)) == MOST


def master(muxes):
    """Return what stands for the API of a master with these muxes."""
    class Api:
        def __init__(self, caller_id, timeout_s, uri):
            self.uri = uri

        def publisher_uris(self, topic):
            assert topic == '/mux/mode'
            return muxes.get(self.uri, [])
    return Api


def test_those_with_a_mux_that_runs_come_first(monkeypatch):
    one, two, three = (URI.format(port) for port in (1, 2, 3))
    monkeypatch.setattr('mhri.doctor.ros.masters.MasterApi',
                        master({two: ['dead'], three: ['/mux']}))
    monkeypatch.setattr('mhri.doctor.ros.masters.connectable', lambda uris, _: {'/mux'} & set(uris))
    wrong = parse_uri(URI.format(11311))
    assert look_elsewhere(wrong, COMPUTER, '/x', uris=[one, two, three]) == (three, one, two)
    assert look_elsewhere(wrong, COMPUTER, '/x', True, [one, two, three]) == (three,)


@pytest.mark.parametrize('uri, words', [
    ('127.0.0.1', 'http://<address>'), ('http://x', 'no port'), ('http://x:y', 'y'),
    (' http://x:1', 'http://<address>'), ('http://x:1', '')])
def test_parse_uri(uri, words):
    assert words in parse_uri(uri).uri_problem
    assert bool(words) == bool(parse_uri(uri).uri_problem)


TELL = ('import time; from mhri.graph.ros.process_start import started_s; '
        'print(time.monotonic() - started_s())')


def test_time_counts_from_the_start_of_the_program():
    def told():
        begun = time.monotonic()
        said = subprocess.run(
            ['sh', '-c', 'sleep 0.5; exec "$@"', 'sh', sys.executable, '-c', TELL],
            env=os.environ, stdout=subprocess.PIPE, check=True)
        took_s = time.monotonic() - begun
        # A start that took longer is not believed.
        return took_s < MAX_AGE_S and (float(said.stdout), took_s)
    said_s, took_s = insist(told, 'a quick start')
    assert 0.5 <= said_s <= took_s + 0.02


def test_age_of_a_shell_that_became_the_program_is_not_believed(monkeypatch):
    now = time.clock_gettime(time.CLOCK_BOOTTIME)
    for age_s in (MAX_AGE_S + 60.0, -60.0):
        monkeypatch.setattr(time, 'clock_gettime', lambda _, age=age_s: now + age)
        assert time.monotonic() - started_s() < 5.0
    monkeypatch.undo()
    monkeypatch.setattr('builtins.open', lambda *_: (_ for _ in ()).throw(OSError()))
    assert time.monotonic() - started_s() < 5.0
