# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot may say to the host over its link: link/robot_claims.py."""
from dataclasses import replace
import pathlib

import pytest
from test_mhri_link import headed, text, tf_message

from mhri.base.robot_types import Limits, parse_robot_type, resolve_robot_type
from mhri.link.renaming import first_text, transforms
from mhri.link.robot_claims import (
    accepted_claims, fits, is_offer, MAX_OFFERED_BYTES, MAX_PIECE_BYTES, MAX_TOPICS_EACH,
    offer_problem, OwnFrames, recorded_name)

TYPES = {kind.name: kind for kind in (
    parse_robot_type(path.read_text(), path.name)
    for path in pathlib.Path(__file__, '..', '..', '..', '..', 'resource', 'robots').resolve()
    .glob('*.yaml'))}
# A lab's own type, for a robot without a namespace on the host's master.
TYPES['arm'] = parse_robot_type('''
name: arm
window: lab.window.Arm
limits: {linear_mps: 0.3, angular_rad_s: 1.0}
command: [/base/cmd_vel]
odometry: [/base/odom]
motor_power: {service: /base/power}
hardware_stop: {topic: /base/stopped}
''', 'arm.yaml')
ODOMETRY = 'nav_msgs/Odometry'


def seen_by_host(said, robot='bot1'):
    """Return the robot type that nodes of the host work with, after the link."""
    found, _ = accepted_claims(robot, said, TYPES)
    kind, errors = resolve_robot_type(TYPES, robot, found)
    return kind, errors


def names(kind):
    """Return all names on the graph that a robot type leads to."""
    found = [topic for key in ('command', 'imu', 'odometry', 'rgb', 'depth', 'cloud', 'scan',
                               'battery') for topic in getattr(kind, key)]
    return found + [part.name for part in (kind.motor_power, kind.hardware_stop) if part]


@pytest.mark.parametrize('said', [
    {'mhri': {'command': ['/bot2/cmd_vel']}},
    {'mhri': {'command': '/bot2/cmd_vel', 'odometry': ['/bot2/odom', '//bot2/odom2'][:1]}},
    {'robot_type': 'turtlebot3', 'mhri': {'motor_power': {'topic': '/bot2/motor_power'}}},
    {'robot_type': 'turtlebot3', 'mhri': {'motor_power': {'service': '/mux/set_stop_all'}}},
    {'mhri': {'hardware_stop': {'topic': '/bot2/stopped'}}},
    {'mhri': {key: ['/bot2/x'] for key in ('imu', 'rgb', 'depth', 'cloud', 'scan', 'battery')}},
    {'robot_type': 'arm'},
    {'robot_type': 'arm', 'mhri': {'limits': {'linear_mps': 0.1}}}])
def test_no_name_of_a_linked_robot_is_outside_its_own(said):
    kind, errors = seen_by_host(said)
    assert not errors
    assert names(kind) and not [name for name in names(kind) if name.startswith('/')]


@pytest.mark.parametrize('said, linear, angular', [
    ({'linear_mps': 0.1}, 0.1, 1.82), ({'linear_mps': 5.0}, 0.22, 1.82),
    ({'linear_mps': 5.0, 'angular_rad_s': 1.0}, 0.22, 1.0), ({'angular_rad_s': 50.0}, 0.22, 1.82)])
def test_limits_only_fall(said, linear, angular):
    kind, _ = seen_by_host({'robot_type': 'turtlebot3', 'mhri': {'limits': said}})
    assert (kind.limits.linear_mps, kind.limits.angular_rad_s) == (linear, angular)


def test_a_robot_goes_sideways_only_if_its_type_on_the_host_does():
    assert not seen_by_host({'mhri': {'holonomic': True}})[0].limits.holonomic
    types = dict(TYPES, generic=replace(TYPES['generic'], limits=Limits(0.5, 1.0, True)))
    for said in ({}, {'mhri': {'holonomic': False}}):
        found, _ = accepted_claims('bot1', said, types)
        assert resolve_robot_type(types, 'bot1', found)[0].limits.holonomic == (not said)


def test_what_is_its_own_affair_stays():
    overrides = {'odometry': ['odometry/filtered'], 'silent_after_s': 3.0, 'radius_m': 0.4,
                 'laser_x_m': 0.1, 'lasers': [[0.1, 0, 0]], 'label': 'Crawler',
                 'hardware_stop': {'topic': 'estop', 'stopped': [True]},
                 'motor_power': {'topic': 'power', 'type': 'std_msgs/Int8', 'powered': 1,
                                 'cut': 0}}
    plain, errors = resolve_robot_type(TYPES, 'bot1', {'mhri': overrides})
    assert not errors and seen_by_host({'mhri': overrides})[0] == plain


@pytest.mark.parametrize('said', [
    {'robot_type': 7}, {'robot_type': 'x' * 65}, {'robot_type': 'a\nb'}, {'robot_type': ['arm']},
    {'mhri': 7}, {'mhri': [1]}, {'mhri': {'command': []}}, {'mhri': {'command': ['../x']}},
    {'mhri': {'limits': {'linear_mps': -1.0}}}, {'mhri': {'nonsense': 1}},
    {'mhri': {'radius_m': 1e9}}, {'window': 'os'}, {'mhri_motor_power_cut': True}])
def test_nonsense_sets_nothing(said):
    assert accepted_claims('bot1', said, TYPES)[0] == {}


@pytest.mark.parametrize('window, taken', [
    ('antigravity.Window', 'turtlebot'), ('os', 'turtlebot'), ('lab.window.Arm', 'lab.window.Arm')])
def test_a_window_is_one_of_an_installed_type(window, taken):
    assert seen_by_host({'mhri': {'window': window}})[0].window == taken


def test_no_module_is_loaded_that_a_robot_names():
    """A message's class is found by importing its package."""
    for key in ('motor_power', 'hardware_stop'):
        kind, _ = seen_by_host({'robot_type': 'turtlebot3', 'mhri': {
            key: {'topic': 'x', 'type': 'antigravity/Bool'}}})
        assert getattr(kind, key) == getattr(TYPES['turtlebot3'], key)


def test_it_has_few_topics_of_each_kind_and_a_short_label():
    kind, _ = seen_by_host({'mhri': {'odometry': ['odom{}'.format(n) for n in range(6000)],
                                     'label': 'a\x1b[2J' + 'b' * 500}})
    assert len(kind.odometry) == MAX_TOPICS_EACH
    assert kind.label.isprintable() and len(kind.label) <= 40


@pytest.mark.parametrize('topic, kind, may', [
    ('odom', ODOMETRY, True), ('camera/rgb/image_raw', 'sensor_msgs/Image', True),
    ('/tf', 'tf2_msgs/TFMessage', True), ('/tf_static', 'tf2_msgs/TFMessage', True),
    ('mhri_guard/echo', 'geometry_msgs/TwistStamped', True),
    ('mhri_guard/state', 'std_msgs/String', True), ('turtle1/pose', 'turtlesim/Pose', True),
    ('mhri_guard/echo', 'std_msgs/String', False), ('/tf', ODOMETRY, False),
    ('mhri_guard/command', 'geometry_msgs/TwistStamped', False),
    ('mhri_guard/heard', 'std_msgs/String', False),
    ('mhri_link/state', 'mhri/LinkControl', False), ('mhri_link/figures', 'std_msgs/String', False),
    ('cmd_vel', 'geometry_msgs/Twist', False), ('/cmd_vel', 'geometry_msgs/Twist', False),
    ('/bot2/odom', ODOMETRY, False), ('../x', ODOMETRY, False), ('a//b', ODOMETRY, False),
    ('', ODOMETRY, False), ('a' * 300, ODOMETRY, False), (7, ODOMETRY, False),
    (None, ODOMETRY, False), ('_beat', ODOMETRY, False), ('odom\n', ODOMETRY, False),
    ('odom', 'antigravity/Odometry', False), ('odom', '*', False), ('odom', 3, False)])
def test_topics_that_a_robot_may_have_on_the_host(topic, kind, may):
    assert is_offer(topic, kind) is may


@pytest.mark.parametrize('kind, size, may', [
    (ODOMETRY, 1 << 22, True), (ODOMETRY, (1 << 22) + 1, False),
    ('sensor_msgs/PointCloud2', 640 * 480 * 32, True), ('sensor_msgs/Image', 1 << 26, False)])
def test_sizes(kind, size, may):
    assert fits(kind, bytes(size)) is may


# --- frames

@pytest.mark.parametrize('topic', ['/tf', '/tf_static'])
def test_a_robot_says_where_its_own_frames_are_and_no_others(topic):
    said = tf_message(('bot1/odom', 'bot1/base_link'), ('map', 'bot1/odom'), ('world', 'map'),
                      ('bot2/odom', 'bot2/base_link'), ('map', '/bot2/odom'))
    children = [child for child, _ in transforms(
        OwnFrames('bot1').of(topic, 'tf2_msgs/TFMessage', said), lambda name: name)]
    assert children == [b'bot1/base_link', b'bot1/odom', b'bot1/bot2/base_link', b'bot1/bot2/odom']


@pytest.mark.parametrize('said, frame', [
    ('bot1/odom', 'bot1/odom'), ('bot2/odom', 'bot1/bot2/odom'), ('map', 'map'),
    ('/bot2/odom', 'bot1/bot2/odom')])
def test_a_message_is_in_one_of_its_own_frames(said, frame):
    data = OwnFrames('bot1').of('/bot1/odom', ODOMETRY, headed(said, text('bot2/base'), b'rest'))
    assert first_text(data) == frame and b'bot1/bot2/base' in data and data.endswith(b'rest')


@pytest.mark.parametrize('topic, kind', [
    ('/tf', 'tf2_msgs/TFMessage'), ('/bot1/odom', ODOMETRY)])
def test_bytes_that_are_no_message(topic, kind):
    with pytest.raises(ValueError):
        OwnFrames('bot1').of(topic, kind, b'\xff' * 9)


@pytest.mark.parametrize('place, number, word', [
    (0, 10 ** 10, 'number'), (1, 10 ** 15, 'begin'), (2, 10 ** 9, 'length'),
    (3, MAX_PIECE_BYTES + 1, 'size'), (3, 10 ** 18, 'size'), (3, 10 ** 4000, 'size'),
    (4, 1 << 32, 'checksum')])
def test_a_recording_that_is_too_large_is_not_fetched(place, number, word):
    row = [1700000000, 1700000000123, 10000, 50000000, 77]
    assert offer_problem([row]) == ''
    problem = offer_problem([row, row[:place] + [number] + row[place + 1:]])
    assert word in problem and len(problem) < 200


def test_nor_are_many_that_are_too_large_together():
    row = [1, 1, 1, MAX_PIECE_BYTES, 1]
    most = MAX_OFFERED_BYTES // MAX_PIECE_BYTES
    assert offer_problem([row] * most) == ''
    assert str(MAX_OFFERED_BYTES) in offer_problem([row] * (most + 1))


@pytest.mark.parametrize('topic, kind, name', [
    ('/bot1/odom', ODOMETRY, '/bot1/odom'), ('/turtle/odom', ODOMETRY, '/bot1/odom'),
    ('/odom', ODOMETRY, '/bot1/odom'), ('/bot2/odom', ODOMETRY, '/bot1/odom'),
    ('/bot1/later/scan', 'sensor_msgs/LaserScan', '/bot1/later/scan'),
    ('/bot1/mhri_guard/command', 'geometry_msgs/TwistStamped', '/bot1/mhri_guard/command'),
    ('/tf', 'tf2_msgs/TFMessage', '/tf'), ('/tf', 'std_msgs/String', ''),
    ('/bot2/scan', 'sensor_msgs/LaserScan', ''), ('/mux/state', 'mhri/DriveState', ''),
    ('/bot1/cmd_vel', 'geometry_msgs/Twist', ''), ('/bot1/odom', 'std_msgs/String', ''),
    ('/bot1/mhri_guard/heard', 'std_msgs/String', ''), ('/bot1/a\nb', ODOMETRY, ''),
    ('/bot1/mhri_link/state', 'mhri/LinkControl', ''), ('/bot1/../bot2/imu', 'sensor_msgs/Imu', ''),
    ('/bot1//imu', 'sensor_msgs/Imu', ''), ('/bot1/' + 300 * 'x', ODOMETRY, ''), ('', '', '')])
def test_names_in_what_a_robot_recorded_are_its_own(topic, kind, name):
    assert recorded_name('bot1', topic, kind, ['odom', 'mhri_guard/command']) == name
