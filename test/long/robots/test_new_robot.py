# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``doc/new_robot.md`` word by word: its files written, its commands typed, its robot driven.

Nothing is put in between: the panel is the one that the guide starts, and it is used through the X
server, by mouse and keyboard.
"""
import math
from pathlib import Path
import re

import pytest

from support import graph
from support.newcomer import (
    blocks, last_words, Newcomer, TIMEOUT_S, said_with_copy, shown_and_there)
from support.ros_system import insist, wait_for

REPO = Path(__file__).resolve().parents[3]
GUIDE = REPO / 'doc' / 'new_robot.md'
EXAMPLE = REPO / 'test' / 'example_robot_package'
POLL_S = 0.1
# Where "Look for Connected Bots" is in the window [px]: at the foot of the drawer.
LOOK = (110, 556)
# How long a key is held until it is let go and held once more [s].
HELD_S = 9.0


def test_the_guide_shows_the_example_package():
    """So that who copies the one has the other."""
    shown, there = shown_and_there(
        GUIDE, EXAMPLE, ('src/crawler_robot/__init__.py', 'CATKIN_IGNORE'))
    assert shown == there


def test_the_example_package_is_no_second_package_of_this_workspace():
    """Neither for catkin nor for roslaunch and rosrun."""
    from catkin_pkg.packages import find_package_paths
    import rospkg
    assert find_package_paths(str(EXAMPLE)) == []
    assert find_package_paths(str(REPO), exclude_subspaces=True) == ['.']
    assert rospkg.RosPack([str(REPO)]).list() == ['mhri']
    assert rospkg.RosPack([str(EXAMPLE)]).list() == []


def types_with(folder, files=None):
    """Return (exit status, output, errors) of ``mhri_types`` with a copy of the example.

    :param files: {file of the package: (old, new) text}
    """
    return said_with_copy(EXAMPLE, folder / 'crawler_robot', files or {}, 'mhri_types')


def test_mhri_types_lists_a_type_of_another_package(tmp_path):
    status, output, errors = types_with(tmp_path)
    assert (status, errors) == (0, '')
    assert [line.split()[0] for line in output.splitlines()] == [
        'crawler', 'generic', 'holonomic', 'turtlebot2', 'turtlebot3', 'turtlesim']


@pytest.mark.parametrize('file, change, named', [
    ('resource/crawler.yaml', ('linear_mps: 0.2', 'linear_mps: fast'), 'limits.linear_mps'),
    ('package.xml', ('crawler.yaml', 'lost.yaml'), 'resource/lost.yaml')])
def test_mhri_types_names_an_export_that_is_left_out(tmp_path, file, change, named):
    """What else may be wrong with one: test/unit/graph/test_robot_exports.py."""
    status, output, errors = types_with(tmp_path, {file: change})
    assert status == 1 and errors.count('\n') == 1
    assert str(tmp_path / 'crawler_robot') in errors and named in errors
    assert [line.split()[0] for line in output.splitlines()] == [
        'generic', 'holonomic', 'turtlebot2', 'turtlebot3', 'turtlesim']


@pytest.fixture
def newcomer(tmp_path):
    made = Newcomer(tmp_path)
    yield made
    made.system.close()


def test_the_guide_word_by_word(newcomer):
    terminals = []
    for kind, text in blocks(GUIDE.read_text()):
        if kind != 'sh terminal':
            said = newcomer.follow(kind, text)
        else:
            terminals.append(text)
    assert re.search('^crawler .*0.20 m/s .*drive/velocity .*crawler_robot.window.CrawlerWindow$',
                     said, re.M), said
    assert 'left out' not in said
    check_the_window(newcomer)
    panel_terminal = newcomer.follow('sh terminal', terminals[0])
    try:
        drive(newcomer, panel_terminal, terminals[1])
    except BaseException:
        print(last_words(panel_terminal)[-4000:])
        raise


def check_the_window(newcomer):
    """The window of the package is what a robot of the type gets."""
    newcomer.run('''source ~/catkin_ws/devel/setup.bash
python3 - <<'END'
from python_qt_binding.QtWidgets import QApplication
from mhri.base.views import RobotView
from mhri.screen.gui.window_maker import WindowMaker
from mhri.graph.ros.resources import resource_path, robot_types
app = QApplication(['check'])
kind = robot_types()[0]['crawler']
window, problem = WindowMaker().make(kind.window, resource_path(), 'crawler1', kind.label)
assert (type(window).__name__, problem) == ('CrawlerWindow', ''), problem
window.show_view(RobotView('crawler1', x_m=3.0, y_m=4.0))
assert window.distance.text() == '5.00 m from home'
window.offer({'rgb', 'scan', 'imu'})
window.resize(800, 600)
window.show()
for views in ((), ('rgb',), ('rgb', 'scan', 'imu')):
    window.switches.choose(views)
    app.processEvents()
    line = window.distance.geometry().translated(window.motion_place.pos())
    assert window.distance.isVisible() and window.rect().contains(line), views
    assert not line.intersects(window.header.geometry()), views
END''')


def hold_until_moved(newcomer, heard):
    """Hold a key until the robot moves."""
    start = heard[-1]

    def moved():
        newcomer.xdotool('keydown', 'Up')
        try:
            return wait_for(lambda: math.dist(start[:2], heard[-1][:2]) > 0.1, HELD_S,
                            'the robot to move')
        finally:
            newcomer.xdotool('keyup', 'Up')
    insist(moved, 'the key to drive')


def drive(newcomer, panel_terminal, launch_robot):
    """Look, check, drive and let go, with mouse and keyboard."""
    import rospy
    from geometry_msgs.msg import Twist
    from mhri.msg import DriveState
    from nav_msgs.msg import Odometry
    from rosgraph_msgs.msg import Log
    panel = wait_for(lambda: newcomer.window('^mhri$'), TIMEOUT_S, 'the panel', POLL_S)
    newcomer.follow('sh terminal', launch_robot)
    rospy.init_node('newcomer', disable_signals=True)
    heard, told, log, obeyed = [], [], [], []
    rospy.Subscriber('/crawler1/drive/velocity', Twist, lambda message: told.append(
        message.linear.x))
    rospy.Subscriber(graph.DRIVE_STATE, DriveState, lambda message: obeyed.append(
        [(robot.name, robot.obeys, robot.stands) for robot in message.robots]))
    rospy.Subscriber('/crawler1/odom', Odometry, lambda message: heard.append((
        message.pose.pose.position.x, message.pose.pose.position.y, message.twist.twist.linear.x)))
    rospy.Subscriber('/rosout_agg', Log, lambda message: log.append(message.msg))
    wait_for(lambda: heard, TIMEOUT_S, 'the robot to tell its odometry')
    newcomer.xdotool('windowfocus', '--sync', panel)

    def found():
        """Press the button until the panel has come so far as to find the robot."""
        newcomer.xdotool('mousemove', '--window', panel, *map(str, LOOK), 'click', '1')
        return rospy.get_param('/mhri/robots', []) == ['crawler1']
    wait_for(found, TIMEOUT_S, 'the robot to be found', poll_s=2.0)
    newcomer.xdotool('key', '1')
    wait_for(lambda: obeyed and obeyed[-1] == [('crawler1', 'operator', '')], TIMEOUT_S,
             'the robot to be ready')
    hold_until_moved(newcomer, heard)
    wait_for(lambda: abs(heard[-1][2]) < 0.005, TIMEOUT_S, 'the robot to stand still')
    assert max(told) == 0.2, 'its own limit'
    assert max(speed for _, _, speed in heard) > 0.1
    assert rospy.get_param('/crawler1/robot_type') == 'crawler'
    said = last_words(panel_terminal) + '\n'.join(log)
    assert 'standard window' not in said and 'Traceback' not in said, said
    rospy.signal_shutdown('done')
