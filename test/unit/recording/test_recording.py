# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is recorded under which name, and what is said about it."""
from datetime import datetime

import pytest

from mhri.base.robot_types import parse_robot_type
from mhri.recording.recording import (
    default_name, MB, PathRefused, RateMeter, RecordingLimits, ros_home, size_text,
    split_path, system_folder, topics_of, warning_of)

ENV = {'HOME': '/home/op', 'ROS_HOME': '/ros', 'LAB': '/data/lab 1', 'EMPTY': ''}
FOLDERS = {'/data', '/data/old.bag', '/ros', '/home/op', '/home/op/bags', '/'}


def test_default_name():
    when = datetime(2026, 11, 21, 14, 2, 9)
    assert default_name('bot1', when) == 'bot1_2026-11-21-14-02-09.bag'


@pytest.mark.parametrize('env, home', [
    (ENV, '/ros'),
    ({'HOME': '/home/op'}, '/home/op/.ros'),
    ({'HOME': '/home/op', 'ROS_HOME': ''}, '/home/op/.ros'),
    ({'HOME': '/'}, '/.ros'),
])
def test_ros_home(env, home):
    assert ros_home(env) == home


@pytest.mark.parametrize('text, folder, name', [
    ('', '/ros', ''),
    ('/data', '/data', ''),
    ('/', '/', ''),
    ('~', '/home/op', ''),
    ('/data/new/', '/data/new', ''),
    ('/data/run.bag', '/data', 'run.bag'),
    ('/data/run.bag.active', '/data', 'run.bag.active.bag'),
    ('$LAB/run', '/data/lab 1', 'run.bag'),
    ('${LAB}x/run', '/data/lab 1x', 'run.bag'),
    ('$EMPTY/data/run', '/data', 'run.bag'),
    ('new/run', '/ros/new', 'run.bag'),
    ('/data/\u00e9\u4e2d \U0001f916;"\'*?.bag', '/data', '\u00e9\u4e2d \U0001f916;"\'*?.bag'),
    ('/data/../up/x', '/data/../up', 'x.bag'),
])
def test_split_path(text, folder, name):
    assert split_path(text, ENV, FOLDERS.__contains__) == (folder, name)


@pytest.mark.parametrize('text, said', [
    ('/data/a\0b', 'character'),
    ('$NOWHERE/run', '$NOWHERE is not set'),
    ('~other/run', '~name'),
    ('/data/old.bag', 'old.bag is a folder'),
    ('/data/old', 'old.bag is a folder'),
    ('/nowhere/..', 'a folder'),
])
def test_refused_path(text, said):
    with pytest.raises(PathRefused) as caught:
        split_path(text, ENV, FOLDERS.__contains__)
    assert said in str(caught.value)


@pytest.mark.parametrize('folder, top', [
    ('/dev/shm/x', '/dev'), ('/proc/self', '/proc'), ('/sys', '/sys'), ('/device', None),
    ('/home/dev', None), ('/', None)])
def test_system_folder(folder, top):
    assert system_folder(folder) == top


@pytest.mark.parametrize('count, text', [
    (0, '0 kB'), (4321, '4 kB'), (99499, '99 kB'), (99500, '0.1 MB'), (800000, '0.8 MB'),
    (999 * MB, '999.0 MB'), (2500 * MB, '2.5 GB')])
def test_size_text(count, text):
    assert size_text(count) == text


@pytest.mark.parametrize('free, queue, said, stop', [
    (None, 0, '', False),
    (1000 * MB, 0, '', False),
    (999 * MB, 0, 'nearly full: 999.0 MB free', False),
    (255 * MB, 0, 'disk is full', True),
    (5000 * MB, 31 * MB, '', False),
    (5000 * MB, 32 * MB, 'slow: 32.0 MB wait', False),
    (5000 * MB, 512 * MB, 'too slow', True),
    (0, 512 * MB, 'too slow', True),
])
def test_warning(free, queue, said, stop):
    words, stops = warning_of(RecordingLimits(), free, queue)
    assert stops == stop and (said in words if said else words == '')


def test_rate():
    meter = RateMeter()
    assert meter.rate_hz(0.0, 0) == 0.0
    assert meter.rate_hz(0.1, 20) == 0.0, 'too short a time to tell'
    rates = [meter.rate_hz(0.05 * tick, 10 * tick) for tick in range(3, 100)]
    assert rates[-1] == pytest.approx(200.0)
    silent = [meter.rate_hz(5.0 + 0.05 * tick, 990) for tick in range(60)]
    assert silent[-1] == 0.0


ROBOT = parse_robot_type(
    'name: r\nlimits: {linear_mps: 1, angular_rad_s: 1}\ncommand: [cmd_vel]\nimu: [imu, imu/data]\n'
    'odometry: [odom]\nrgb: [camera/rgb/image_raw]\ndepth: [camera/rgb/depth]\nscan: [scan]\n', 'r')


@pytest.mark.parametrize('choices, topics', [
    ((), ['/b/imu', '/b/imu/data']),
    (('odometry',), ['/b/imu', '/b/imu/data', '/b/odom']),
    (('rgb', 'depth'), ['/b/imu', '/b/imu/data', '/b/camera/rgb/image_raw/compressed',
                        '/b/camera/rgb/camera_info', '/b/camera/rgb/depth/compressedDepth']),
    (('scan', 'commands'), ['/b/imu', '/b/imu/data', '/b/scan', '/b/cmd_vel',
                            '/b/mhri_guard/command', '/robot_controller/twist',
                            '/robot_controller/robot_select', '/robot_controller/stop_all',
                            '/mux/mode']),
])
def test_topics(choices, topics):
    assert list(topics_of('b', ROBOT, choices)) == topics
