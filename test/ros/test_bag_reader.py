# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag is what a stranger wrote: nothing in it runs, and what is not known here is named."""
import os
import subprocess
import sys

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import pytest
import rosbag
import rospy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.graph.ros.messages import message_class, MessageMissing  # noqa: E402
from mhri.link.ros.host_record import join  # noqa: E402
from mhri.msg import LinkControl  # noqa: E402
from mhri.recording.folder import NotASession  # noqa: E402
from mhri.recording.ros.bag_set import open_session  # noqa: E402
from mhri.tasks.ros.drives import DriveError, read_drive  # noqa: E402
from support import evil_bag, made_session as made  # noqa: E402


def nobody(topics, _):
    return {name.split('/')[1]: {} for name in topics}, ''


@pytest.fixture(params=[evil_bag.write, evil_bag.write_lying])
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
    for wanted in (lambda one: True, lambda one: one.topic == evil_bag.ODOM):
        read += kept.bags.newest(kept.bags.end_ns, wanted)
        try:
            read += kept.bags.after(0, wanted)
        except rosbag.ROSBagException:
            pass  # an index that lies
    kept.bags.close()
    assert not target.exists()
    assert {one.connection.topic for one in read} <= {evil_bag.ODOM + '_good'}
    assert any(evil_bag.ODOM + ' ' in problem for problem in kept.bags.problems)


def test_a_drive_to_replay_runs_nothing(evil):
    path, target = evil
    with pytest.raises(DriveError, match=evil_bag.ODOM):
        read_drive(str(path), [evil_bag.ODOM])
    assert not target.exists()


def test_what_a_robot_kept_runs_nothing(evil, tmp_path):
    path, target = evil
    joined = str(tmp_path / 'joined.bag')
    left_out = join('bot1', [str(path)], joined, ['odom', 'odom_good'])
    assert not target.exists() and any(evil_bag.ODOM in sentence for sentence in left_out)
    with rosbag.Bag(joined) as bag:
        assert {info.msg_def for info in bag._connections.values()} <= {Odometry._full_text}
        assert {topic for topic, _, _ in bag.read_messages()} <= {evil_bag.ODOM + '_good'}


def test_a_report_runs_nothing(tmp_path):
    folder = made.write_session(tmp_path / 'session')
    target = tmp_path / 'ran'
    evil_bag.write(folder / '0000.bag', target)
    done = subprocess.run(
        [sys.executable, '-c', 'from mhri.nodes.mhri_report import main; main()', str(folder)],
        env=dict(os.environ, ROS_HOME=str(tmp_path / 'home')), timeout=120,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 0, done.stdout
    assert not target.exists()


def test_what_is_of_another_robot_is_not_fetched_from_this_one(tmp_path):
    path, joined = str(tmp_path / 'piece.bag'), str(tmp_path / 'joined.bag')
    with rosbag.Bag(path, 'w') as bag:
        for topic in ('/bot2/odom', '/bot2/scan', '/gates/state', '/bot1/odom'):
            bag.write(topic, Odometry(), rospy.Time(1))
    left_out = join('bot1', [path], joined, ['odom'])
    with rosbag.Bag(joined) as bag:
        assert {topic for topic, _, _ in bag.read_messages()} == {'/bot1/odom'}
    assert len(left_out) == 1 and '/gates/state' in left_out[0] and '/bot2/scan' in left_out[0]


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
    assert '/bot1/cmd_vel' in left_out[0] and '/bot1/mhri_link/state' in left_out[0]


def test_types_of_another_version_are_left_out_and_named(tmp_path):
    """A session of an older mhri."""
    path = tmp_path / 'old.bag'
    old = evil_bag.evil_kind(tmp_path / 'ran')
    with rosbag.Bag(str(path), 'w') as bag:
        bag.write('/gates/state', ('mhri/GatesState', bytes(8), old._md5sum, old), rospy.Time(1),
                  raw=True)
        bag.write('/bot1/odom', Odometry(), rospy.Time(2))
    kept = open_session(str(path), nobody)
    assert [one.connection.topic for one in kept.bags.after(0)] == ['/bot1/odom']
    problem, = kept.bags.problems
    assert '/gates/state' in problem and 'mhri/GatesState' in problem
    kept.bags.close()


def test_a_bag_with_nothing_that_is_known_names_what_it_has(tmp_path):
    path = tmp_path / 'x.bag'
    evil_bag.write(path, tmp_path / 'ran')

    def none(topics, _):
        raise NotASession('none')
    with pytest.raises(NotASession, match=evil_bag.ODOM):
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
