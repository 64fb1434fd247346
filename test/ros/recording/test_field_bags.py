# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags as other programs and other clocks write them: names, types and times."""
from types import SimpleNamespace

import genpy
from nav_msgs.msg import Odometry
import pytest
import rosbag
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from mhri.base.robot_types import parse_robot_type
from mhri.recording.folder import event_line, EVENTS_JSONL, SessionEvent
from mhri.recording.ros.bag_set import BagSet, open_session
from mhri.replay.presenters.replay_presenter import read_lines
from mhri.session.foreign import robots_of_topics
from mhri.session.ros.session_reader import opened, ReportBuilder
from support import made_session as made

NOW, YEARS, LENGTH_S = 1700000000, 7 * 365 * 86400, 20
TYPES = {'generic': parse_robot_type(
    'name: generic\nlimits: {linear_mps: 1, angular_rad_s: 1}\ncommand: cmd_vel\nodometry: odom',
    'here')}


def open_bag(path):
    return open_session(str(path), lambda topics, stem: robots_of_topics(topics, TYPES, stem))


def odometry(bag, begin=NOW, seconds=LENGTH_S, topic='/bot1/odom'):
    for number in range(seconds * 10 + 1):
        bag.write(topic, Odometry(), genpy.Time(begin) + genpy.Duration(0, number * 10 ** 8))


def length_s(bags):
    return (bags.end_ns - bags.start_ns) * 1e-9


@pytest.mark.parametrize('strays', [(0.001,) * 3, (NOW + YEARS,), (0.001, NOW + YEARS)])
@pytest.mark.parametrize('chunk', [2000, 10 ** 6])
def test_a_bag_of_20_seconds_with_strays_is_of_20_seconds(tmp_path, strays, chunk):
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'w', chunk_threshold=chunk) as bag:
        for time_s in strays:
            bag.write('/bot1/odom', Odometry(), genpy.Time.from_sec(time_s))
        odometry(bag)
    bags = open_bag(tmp_path / 'run.bag').bags
    told = list(bags.after(bags.start_ns - 1))
    assert length_s(bags) == LENGTH_S and bags.start_ns == NOW * 10 ** 9
    named, = bags.problems
    assert len(told) == LENGTH_S * 10 + 1 and named.count(' of ') == len(set(strays))
    assert len(bags.newest(bags.end_ns)) == 1
    raw = BagSet([str(tmp_path / 'run.bag')])
    assert len(list(raw.after(raw.start_ns - 1))) == len(told) + len(strays), 'in the file they are'


def test_what_was_latched_before_the_clock_was_set_is_there_from_the_start(tmp_path):
    header = {'latching': '1', 'type': String._type, 'md5sum': String._md5sum,
              'message_definition': String._full_text, 'topic': '/bot1/robot_description'}
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'w') as bag:
        bag.write('/bot1/robot_description', String('it'), genpy.Time(0, 1),
                  connection_header=header)
        odometry(bag)
    bags = open_bag(tmp_path / 'run.bag').bags
    assert length_s(bags) == LENGTH_S
    assert {one.connection.topic for one in bags.newest(bags.start_ns)} == {
        '/bot1/odom', '/bot1/robot_description'}


def test_a_session_whose_clock_leapt_is_as_long_as_it_took(tmp_path):
    folder = made.write_session(tmp_path / 'session')
    before = list(made.rows_between(0.0, 20.0))
    with rosbag.Bag(str(folder / '0000.bag'), 'w') as bag:
        for time_s, topic, message, _ in before:
            bag.write(topic, message, made.stamp(time_s) - genpy.Duration(YEARS))
    lines = [SessionEvent(wall, wall, 'note', text) for wall, text in (
        (made.STARTED + 10.0 - YEARS, 'early'), (made.STARTED + 30.0, 'late'))]
    (folder / EVENTS_JSONL).write_text(''.join(map(event_line, lines)))
    with opened(str(folder)) as session:
        builder = ReportBuilder(session)
        report = builder.read()
        assert made.LENGTH_S - 2.0 < report.line.length_s < made.LENGTH_S + 3.0
        at_s = [event.ros - report.line.start for event in report.line.events]
        assert at_s == pytest.approx([10.0, 30.0], abs=2.0)
        # The screen of a replay reads the lines itself, and the player the bags.
        assert [event.ros for event in read_lines(str(folder))] == [
            event.ros for event in report.line.events]
        assert open_bag(folder).bags.start_ns * 1e-9 == pytest.approx(report.line.start)
        assert any('gap' in problem for problem in report.problems)
        assert all(survey.readings for survey in (row.survey for row in report.robots))


@pytest.mark.parametrize('topic', ['bot1/odom', '//bot1//odom', '/bot1/odom/'])
def test_a_recorded_name_is_resolved_as_ros_does(tmp_path, topic):
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'w') as bag:
        odometry(bag, topic=topic)
        for odd in ('/bot1/a b', '~odom', '/bot1/ünder', '/bot1/re-d', '/', '/1/odom'):
            bag.write(odd, Odometry(), genpy.Time(NOW))
    kept = open_bag(tmp_path / 'run.bag')
    assert set(kept.robots) == {'bot1'} and not kept.prefix
    assert [one.topic for one in kept.bags.connections()] == ['/bot1/odom']
    assert '/bot1/re-d' in kept.bags.problems[0]


def test_the_tf_of_old_programs_is_that_of_today(tmp_path):
    old = SimpleNamespace(_md5sum=TFMessage._md5sum, _full_text=TFMessage._full_text)
    with rosbag.Bag(str(tmp_path / 'run.bag'), 'w') as bag:
        odometry(bag)
        bag.write('/tf', ('tf/tfMessage', bytes(4), TFMessage._md5sum, old), genpy.Time(NOW),
                  raw=True)
    bags = open_bag(tmp_path / 'run.bag').bags
    assert not bags.problems
    tf, = bags.newest(bags.end_ns, lambda connection: connection.topic == '/tf')
    assert tf.connection.kind == 'tf2_msgs/TFMessage' and tf.message().transforms == []
