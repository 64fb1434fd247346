# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two computers that are one robot: seen, and taken for it in no other case."""
import pytest

from mhri.robots.twins import GuardTurns, listed, twins, twins_on_graph

A, B, HOST = '10.0.0.1', '10.0.0.2', '10.0.0.9'


@pytest.mark.parametrize('odometry, listeners, found', [
    ([], {}, set()),
    ([{'/b/base': A}], {'/b/base': A}, set()),
    ([{'/b/base': A, '/b/base2': B}], {'/b/base': A, '/b/base2': B}, {'/b/base', '/b/base2'}),
    ([{'/b/base': A, '/b/base2': A}], {'/b/base': A, '/b/base2': A}, {'/b/base', '/b/base2'}),
    # Odometry and velocity in nodes of their own: by the computer.
    ([{'/b/odo1': A, '/b/odo2': B}], {'/b/drive1': A, '/b/drive2': B}, {A, B}),
    # A bag that is played beside the robot; a recorder; a robot's second computer.
    ([{'/b/base': A, '/play_1': HOST}], {'/b/base': A}, set()),
    ([{'/b/base': A}], {'/b/base': A, '/record_1': HOST}, set()),
    ([{'/b/base': A}, {'/b/filter': B}], {'/b/base': A, '/b/navigation': B}, set()),
    ([{'/b/base': A}, {'/b/base': A}], {'/b/base': A}, set())])
def test_twins(odometry, listeners, found):
    assert twins(odometry, listeners) == found


@pytest.mark.parametrize('topic, kind, publishers, found', [
    ('/b/imu', 'sensor_msgs/Imu', ['/b/base', '/b/base2'], True),
    ('/b/imu', 'sensor_msgs/Imu', ['/b/base', '/b/recorder'], False),
    ('/c/imu', 'sensor_msgs/Imu', ['/b/base', '/b/base2'], False),
    ('/b/joint_states', 'sensor_msgs/JointState', ['/b/base', '/b/base2'], False),
    ('/b/diagnostics', 'diagnostic_msgs/DiagnosticArray', ['/b/base', '/b/base2'], False)])
def test_twins_without_odometry_publish_the_same_measurement(topic, kind, publishers, found):
    graph = [(topic, publishers), ('/b/scan', ['/b/laser'])]
    assert twins_on_graph('b', graph, {topic: kind}, ['/b/base', '/b/base2']) == (
        {'/b/base', '/b/base2'} if found else set())


def test_some_names_stand_for_all():
    assert (listed({'b', 'a'}), listed('abcdef')) == ('a and b', 'a and b and c and d')


def turns(*echoes):
    """Return what is made of echoes: (run, time)."""
    guards = GuardTurns()
    for number, (run, now) in enumerate(echoes):
        guards.on_token('{}-{:x}'.format(run, number), now)
    return guards


def test_two_guards_echo_in_turn():
    guards = turns(('a', 0.0), ('b', 0.05), ('a', 0.1), ('b', 0.15))
    assert guards.two(0.2) and guards.two(2.0)
    assert not guards.two(2.2), 'one has gone'


def test_a_guard_that_is_started_anew_is_one():
    assert not turns(('a', 0.0), ('a', 0.1), ('b', 0.5), ('b', 0.6)).two(0.6)
    assert not turns(('a', 0.0), ('b', 1.0), ('a', 9.0)).two(9.0)
