# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is recorded under which name, and what is said about it."""
from datetime import datetime

import pytest

from mhri.base.robot_types import parse_robot_type
from mhri.recording.recording import (
    CHOICES, default_name, expand, fallback_note, MB, numbered, PathRefused, RateMeter,
    read_fallback, RecordingLimits, RecordingStatus, ros_home, size_text, split_path, system_folder,
    topics_of, warning_of)

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
    ('   ', '/ros', ''),
    ('/data', '/data', ''),
    ('/data/', '/data', ''),
    ('/', '/', ''),
    ('~', '/home/op', ''),
    ('~/bags', '/home/op/bags', ''),
    ('/data/new/', '/data/new', ''),
    ('/data/run', '/data', 'run.bag'),
    ('/data/run.bag', '/data', 'run.bag'),
    (' /data/run.bag ', '/data', 'run.bag'),
    ('/run', '/', 'run.bag'),
    ('/data/run.bag.active', '/data', 'run.bag.active.bag'),
    ('/data/.bag', '/data', '.bag'),
    ('~/run 1.bag', '/home/op', 'run 1.bag'),
    ('$LAB/run', '/data/lab 1', 'run.bag'),
    ('${LAB}x/run', '/data/lab 1x', 'run.bag'),
    ('$EMPTY/data/run', '/data', 'run.bag'),
    ('run', '/ros', 'run.bag'),
    ('new/run', '/ros/new', 'run.bag'),
    ('/data/cost$5.bag', '/data', 'cost$5.bag'),
    ('/data/\u00e9\u4e2d \U0001f916;"\'*?.bag', '/data', '\u00e9\u4e2d \U0001f916;"\'*?.bag'),
    ('/data/-rf', '/data', '-rf.bag'),
    ('/data/a\nb', '/data', 'a\nb.bag'),
    ('/data/../up/x', '/data/../up', 'x.bag'),
])
def test_split_path(text, folder, name):
    assert split_path(text, ENV, FOLDERS.__contains__) == (folder, name)


@pytest.mark.parametrize('text, said', [
    ('/data/a\0b', 'character'),
    ('$NOWHERE/run', '$NOWHERE is not set'),
    ('${NOWHERE}', '$NOWHERE is not set'),
    ('~other/run', '~name'),
    ('/data/old.bag', 'old.bag is a folder'),
    ('/data/old.bag/', 'is a folder'),
    ('/data/old', 'old.bag is a folder'),
    ('/nowhere/..', 'a folder'),
    ('/nowhere/.', 'a folder'),
])
def test_refused_path(text, said):
    with pytest.raises(PathRefused) as caught:
        split_path(text, ENV, FOLDERS.__contains__)
    assert said in str(caught.value)


def test_a_tilde_inside_is_a_character():
    assert expand('/data/~/a~', ENV) == '/data/~/a~'


@pytest.mark.parametrize('folder, top', [
    ('/dev', '/dev'), ('/dev/shm/x', '/dev'), ('/proc/self', '/proc'), ('/sys/kernel', '/sys'),
    ('/device', None), ('/home/dev', None), ('/', None)])
def test_system_folder(folder, top):
    assert system_folder(folder) == top


@pytest.mark.parametrize('number, name', [(0, 'a.bag'), (1, 'a-1.bag'), (12, 'a-12.bag')])
def test_numbered(number, name):
    assert numbered('a.bag', number) == name


def test_fallback_note_can_be_shown():
    note = fallback_note('/x\0\n' + 'y' * 300, 'no permission', '/ros/a.bag')
    assert note.startswith('cannot write to "/x??yyy') and note.isprintable()
    assert note.endswith('..": no permission; saving to /ros/a.bag instead') and len(note) < 160


@pytest.mark.parametrize('before, after', [
    ('', ''), ('', 'saved 464 messages, 0.2 MB: /ros/a.bag'), ('the disk is slow', '')])
def test_what_a_fallback_note_says_can_be_read_again(before, after):
    note = '; '.join(filter(None, (
        before, fallback_note('/x/a "b": c.bag', 'no permission', '/ros/a.bag'), after)))
    reason, rest = read_fallback(note)
    assert reason == 'no permission' and rest.strip('; ') == before + after
    assert read_fallback(rest) == ('', rest)


@pytest.mark.parametrize('count, text', [
    (0, '0 kB'), (4321, '4 kB'), (99499, '99 kB'), (99500, '0.1 MB'), (800000, '0.8 MB'),
    (999 * MB, '999.0 MB'), (2500 * MB, '2.5 GB')])
def test_size_text(count, text):
    assert size_text(count) == text


@pytest.mark.parametrize('free, queue, said, stop', [
    (5000 * MB, 0, '', False),
    (None, 0, '', False),
    (1000 * MB, 0, '', False),
    (999 * MB, 0, 'nearly full: 999.0 MB free', False),
    (256 * MB, 0, 'nearly full', False),
    (255 * MB, 0, 'disk is full', True),
    (0, 0, 'disk is full', True),
    (5000 * MB, 31 * MB, '', False),
    (5000 * MB, 32 * MB, 'slow: 32.0 MB wait', False),
    (5000 * MB, 512 * MB, 'too slow', True),
    (0, 512 * MB, 'too slow', True),
    (900 * MB, 40 * MB, 'slow', False),
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


def test_rate_when_asked_seldom():
    meter = RateMeter()
    assert [meter.rate_hz(10.0 * tick, 100 * tick) for tick in range(4)] == [0, 10, 10, 10]


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


def test_a_recording_of_commands_has_what_the_robot_is_sent():
    """To its velocity topics, or to its guard; without the choice neither is listened to."""
    sent = {'/b/cmd_vel', '/b/mhri_guard/command'}
    assert sent <= set(topics_of('b', ROBOT, ['commands']))
    others = [key for key, _ in CHOICES if key != 'commands']
    assert not sent & set(topics_of('b', ROBOT, others))


def test_unknown_choice():
    with pytest.raises(KeyError) as caught:
        topics_of('b', ROBOT, ('sonar',))
    assert 'sonar' in str(caught.value)


def test_a_status_begins_empty():
    status = RecordingStatus()
    assert (status.state, status.messages, status.note) == ('off', 0, '')
