# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag is what a stranger wrote: nothing in it runs, and what is not known here is named."""
import hashlib
import os
import subprocess
import sys
from types import SimpleNamespace

import genpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import pytest
import rosbag
import rospy

from mhri.graph.ros.messages import message_class, MessageMissing
from mhri.link.ros.host_record import join
from mhri.msg import LinkControl
from mhri.recording.folder import NotASession
from mhri.recording.ros.bag_set import open_session
from mhri.session.ros.session_reader import opened, ReportBuilder
from mhri.tasks.ros.drives import DriveError, read_drive
from support import made_session as made

ODOM = '/bot1/odom'
_OP, _MESSAGE, _CONN = b'op=', b'\x02', b'conn='


def definition(target):
    """Return the text of a message that, compiled, makes a file."""
    return 'string open({!r}, {!r});X=1\nfloat64 x\n'.format(str(target), 'w')


def evil_kind(target):
    """Return what stands for a message class of that text; ``rosbag`` compiles a sum only once."""
    return SimpleNamespace(_md5sum=hashlib.md5(str(target).encode()).hexdigest(),
                           _full_text=definition(target))


def write_evil(path, target, topic=ODOM, kind='nav_msgs/Odometry', stamp=genpy.Time(1700000000)):
    """Write a bag whose text makes a file when it is read; some of it is as it should be."""
    evil = evil_kind(target)
    with rosbag.Bag(str(path), 'w') as bag:
        for second in range(3):
            when = stamp + genpy.Duration(second)
            good = Odometry()
            good.pose.pose.orientation.w = 1.0
            bag.write(topic + '_good', good, when)
            bag.write(topic, (kind, bytes(8), evil._md5sum, evil), when, raw=True)


def write_lying(path, target):
    """Write a bag whose index says that its messages are good ones; their records say otherwise."""
    write_evil(path, target)
    data = bytearray(path.read_bytes())
    with rosbag.Bag(str(path)) as bag:
        numbers = {info.topic: number for number, info in bag._connections.items()}
    evil, good = (number.to_bytes(4, 'little') for number in (
        numbers[ODOM], numbers[ODOM + '_good']))
    # Header of a message: its fields in any order, none longer than that of its time.
    place = data.find(_CONN + good)
    while place >= 0:
        if _OP + _MESSAGE in data[place - 40:place + 40]:
            data[place:place + len(_CONN) + 4] = _CONN + evil
        place = data.find(_CONN + good, place + 1)
    path.write_bytes(bytes(data))


def nobody(topics, _):
    return {name.split('/')[1]: {} for name in topics}, ''


@pytest.fixture(params=[write_evil, write_lying])
def evil(request, tmp_path):
    """Return (path of an evil bag, the file that is there once something in it ran)."""
    path, target = tmp_path / 'evil.bag', tmp_path / 'ran'
    request.param(path, target)
    return path, target


def test_the_evil_bag_is_one(evil):
    path, target = evil
    with rosbag.Bag(str(path)) as bag:
        for _ in bag.read_messages(raw=True):
            pass
    assert target.exists()


def test_a_replay_runs_nothing(evil):
    path, target = evil
    kept = open_session(str(path), nobody)
    read = []
    for wanted in (lambda one: True, lambda one: one.topic == ODOM):
        read += kept.bags.newest(kept.bags.end_ns, wanted)
        try:
            read += kept.bags.after(0, wanted)
        except rosbag.ROSBagException:
            pass  # an index that lies
    kept.bags.close()
    assert not target.exists()
    assert {one.connection.topic for one in read} <= {ODOM + '_good'}
    assert any(ODOM + ' ' in problem for problem in kept.bags.problems)


def test_a_drive_to_replay_runs_nothing(evil):
    path, target = evil
    with pytest.raises(DriveError, match=ODOM):
        read_drive(str(path), [ODOM])
    assert not target.exists()


def test_what_a_robot_kept_runs_nothing(evil, tmp_path):
    path, target = evil
    joined = str(tmp_path / 'joined.bag')
    left_out = join('bot1', [str(path)], joined, ['odom', 'odom_good'])
    assert not target.exists() and any(ODOM in sentence for sentence in left_out)
    with rosbag.Bag(joined) as bag:
        assert {info.msg_def for info in bag._connections.values()} <= {Odometry._full_text}
        assert {topic for topic, _, _ in bag.read_messages()} <= {ODOM + '_good'}


def test_a_report_runs_nothing(tmp_path):
    folder = made.write_session(tmp_path / 'session')
    target = tmp_path / 'ran'
    write_evil(folder / '0000.bag', target)
    done = subprocess.run(
        [sys.executable, '-c', 'from mhri.nodes.mhri_report import main; main()', str(folder)],
        env=dict(os.environ, ROS_HOME=str(tmp_path / 'home')), timeout=120,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 0, done.stdout
    assert not target.exists()


def test_what_is_of_another_robot_is_not_fetched_from_this_one(tmp_path):
    path, joined = str(tmp_path / 'piece.bag'), str(tmp_path / 'joined.bag')
    with rosbag.Bag(path, 'w') as bag:
        for topic in ('/bot2/odom', '/bot2/scan', '/mux/state', '/bot1/odom'):
            bag.write(topic, Odometry(), rospy.Time(1))
    left_out = join('bot1', [path], joined, ['odom'])
    with rosbag.Bag(joined) as bag:
        assert {topic for topic, _, _ in bag.read_messages()} == {'/bot1/odom'}
    assert len(left_out) == 1 and '/mux/state' in left_out[0] and '/bot2/scan' in left_out[0]


def test_a_robot_that_kept_what_it_may_not_say_is_not_believed(tmp_path):
    """Below its own name, too: nothing of mhri's own, no command, no name that none can be."""
    path, joined = str(tmp_path / 'piece.bag'), str(tmp_path / 'joined.bag')
    with rosbag.Bag(path, 'w') as bag:
        for topic, message in (
                ('/bot1/odom', Odometry()), ('/bot1/mhri_guard/command', TwistStamped()),
                ('/bot1/cmd_vel', Twist()), ('/bot1/mhri_link/state', LinkControl()),
                ('/bot1/a\x1b[2Jb', Odometry())):
            bag.write(topic, message, rospy.Time(1))
    left_out = join('bot1', [path], joined, ['odom', 'mhri_guard/command'])
    with rosbag.Bag(joined) as bag:
        assert {topic for topic, _, _ in bag.read_messages()} == {
            '/bot1/odom', '/bot1/mhri_guard/command'}
    named = ' '.join(left_out)
    assert '/bot1/cmd_vel' in named and '/bot1/mhri_link/state' in named and '\x1b' not in named


def test_a_session_of_an_older_mhri_replays_its_robots(tmp_path):
    """What mhri said of itself then is left out, of a report, too, and that is said."""
    folder, odometry = made.write_session(tmp_path / 'session'), '/bot1/odom'
    for path in folder.glob('*.bag'):
        path.unlink()
    old = {'/gates/state': 'mhri/GatesState', '/robot_controller/robot_select': 'mhri/RobotSelect'}
    kind = SimpleNamespace(_md5sum='0123456789abcdef0123456789abcdef', _full_text='string mux')
    with rosbag.Bag(str(folder / '0000.bag'), 'w') as bag:
        for topic, name in old.items():
            bag.write(topic, (name, bytes(8), kind._md5sum, kind), made.stamp(0.0), raw=True)
        for second in range(3):
            bag.write(odometry, made.odometry('bot1', second), made.stamp(second))
    kept = open_session(str(folder), nobody)
    assert [one.connection.topic for one in kept.bags.after(0)] == 3 * [odometry]
    kept.bags.close()
    with opened(str(folder)) as session:
        report = ReportBuilder(session).read()
    assert report.robots[0].survey.distance_m > 0.1
    for problems in (kept.bags.problems, report.problems):
        assert any(all(topic in problem for topic in old) for problem in problems)


def test_a_bag_with_nothing_that_is_known_names_what_it_has(tmp_path):
    path = tmp_path / 'x.bag'
    write_evil(path, tmp_path / 'ran')

    def none(topics, _):
        raise NotASession('none')
    with pytest.raises(NotASession, match=ODOM):
        open_session(str(path), none)


def test_the_name_of_a_type_imports_no_module(tmp_path, monkeypatch):
    package = tmp_path / 'innocent'
    package.mkdir()
    (package / '__init__.py').write_text('open({!r}, "w")'.format(str(tmp_path / 'ran')))
    (package / 'msg.py').write_text('X = 1')
    monkeypatch.syspath_prepend(str(tmp_path))
    for kind in ('innocent/X', 'std_msgs/sys', 'std_msgs/__name__', 'os.path/X', '', '/', 'a/b/c'):
        with pytest.raises(MessageMissing):
            message_class(kind)
    assert not (tmp_path / 'ran').exists()
    assert message_class('nav_msgs/Odometry') is Odometry
