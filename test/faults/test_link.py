# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot on a master of its own, linked to the host: driven, looked at, and whatever dies."""
import os
import sys
import time

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.linked import Linked, LONG_S, Operator  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

# The lease is 0.3 s, and the robot brakes; the rest is for a busy computer.
STANDS_S = 3.0


@pytest.fixture(scope='module')
def lab():
    pytest.importorskip('rospy')
    import rospy
    from mhri.ros.graph.master_watch import MasterWatch
    from support.robots import Witness
    built = Linked()
    try:
        rospy.init_node('link_test', disable_signals=True)
        MasterWatch().start()
        built.operator = Operator()
        built.witness = Witness('bot1')
        wait_for(built.witness.live, LONG_S, 'the odometry of bot1 on the host')
        yield built
    finally:
        built.close()
        rospy.signal_shutdown('done')


def listeners_of_camera(lab):
    """Return how many nodes listen to the robot's camera on the robot's own master."""
    from mhri.ros.graph.master_api import MasterApi
    state = MasterApi('/link_test', 2.0, lab.robot.env['ROS_MASTER_URI']).call('getSystemState')
    return sum(len(nodes) for topic, nodes in state[1]
               if topic.startswith('/bot1/camera/rgb'))


def test_it_looks_like_any_robot(lab):
    import rospy
    from mhri.ros.graph.look import look_for_robots, shipped_ignore_list
    assert wait_for(lambda: rospy.has_param('/bot1/robot_type'), LONG_S)
    assert rospy.get_param('/bot1/robot_type') == 'turtlebot3'
    found = look_for_robots('/link_test', shipped_ignore_list())
    assert [robot.name for robot in found.live] == ['bot1']
    assert dict(rospy.get_published_topics())['/bot1/scan'] == 'sensor_msgs/LaserScan'


def test_it_is_driven_through_its_guard(lab):
    lab.drive(lab.operator)
    wait_for(lab.witness.moving, LONG_S, 'the host to see it move')
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')


def test_pictures_only_for_those_who_look(lab):
    import rospy
    from sensor_msgs.msg import CompressedImage
    assert listeners_of_camera(lab) == 0
    frames = []
    view = rospy.Subscriber('/bot1/camera/rgb/image_raw/compressed', CompressedImage,
                            lambda message: frames.append(message), queue_size=1,
                            buff_size=1 << 22)
    wait_for(lambda: len(frames) > 3, LONG_S, 'pictures')
    assert frames[-1].header.frame_id.startswith('bot1/')
    assert listeners_of_camera(lab) == 1
    view.unregister()
    wait_for(lambda: listeners_of_camera(lab) == 0, LONG_S, 'the camera to be left alone')


def test_the_host_side_is_killed_and_comes_back(lab):
    lab.drive(lab.operator)
    since = time.monotonic()
    lab.host.kill(lab.link_of_host)
    at = wait_for(lambda: lab.stood_at(since), LONG_S, 'it to stand')
    print('MEASURED host side of the link killed: the robot stands after {:.2f} s'.format(
        at - since))
    assert at - since < STANDS_S
    lab.operator.stick.hold(0.0, 0.4)
    begun = time.monotonic()
    lab.start_host_side()
    wait_for(lab.witness.live, LONG_S, 'the odometry to be back')
    print('MEASURED host side started: odometry after {:.2f} s'.format(time.monotonic() - begun))
    # The stick was never let go.
    time.sleep(1.0)
    assert not lab.moves()
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)


def test_the_robots_master_is_restarted(lab):
    lab.robot.kill(lab.robot.master)
    lab.robot.start_master()
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')
