# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The whole panel is killed (SIGKILL) while it records a robot: what is in the file then.

The panel is a program of its own on a screen of its own, and is asked to record as a pad's button
asks. What the robot published is known from another node.
"""
from glob import glob
import os
import subprocess
import threading
import time

import pytest
import rosbag

from support import graph
from support.own_node import own_node
from support.ros_system import wait_for
from support.node_tools import measured

system = own_node('recording_killed')

IMU = '/bot1/mobile_base/sensors/imu_data'
START_S = 120.0


class Listener:
    """Another node's knowledge of a topic: (number, time of receipt [s]) of every message."""

    def __init__(self, topic):
        import rospy
        from sensor_msgs.msg import Imu
        self._lock = threading.Lock()
        self._heard = []
        self._subscriber = rospy.Subscriber(topic, Imu, self._hear, tcp_nodelay=True)

    def _hear(self, message):
        with self._lock:
            self._heard.append((message.header.seq, time.time()))

    def heard(self):
        with self._lock:
            return list(self._heard)


@pytest.fixture(scope='module')
def robot(system):
    """A screen, the mux and one simulated robot; the listener to its IMU."""
    system.screen()
    system.node('mux', '__name:=mux')
    system.launch('turtlebot.launch', 'name:=bot1', 'type:=turtlebot2')
    listener = Listener(IMU)
    wait_for(lambda: len(listener.heard()) > 20, START_S, 'the IMU of the robot')
    return listener


def recordings(system):
    return glob(os.path.join(system.home, 'bot1_*.bag.active'))


def begin_recording(system):
    """Ask until a file is there: the panel hears nothing before it has started."""
    import rospy
    from mhri.msg import PanelRequest
    requests = rospy.Publisher(graph.PANEL_REQUEST, PanelRequest, queue_size=1)

    def begun():
        if requests.get_num_connections():
            requests.publish(PanelRequest(action=PanelRequest.RECORD, robots=['bot1']))
        return recordings(system)
    wait_for(begun, START_S, 'the recording', poll_s=0.5)
    requests.unregister()


def bag_size(system):
    paths = recordings(system)
    return os.path.getsize(paths[0]) if paths else 0


def test_at_most_a_second_is_missing(system, robot, messages=330):
    panel = system.node('panel', '--fresh', '--select', 'bot1')
    begin_recording(system)
    wait_for(lambda: bag_size(system) > 20000, START_S, 'the first chunks of the recording')
    before = len(robot.heard())
    wait_for(lambda: len(robot.heard()) - before >= messages, START_S, 'some seconds of it')
    killed_at = time.time()
    system.kill(panel, family=False)
    wait_for(lambda: robot.heard()[-1][1] > killed_at, START_S, 'the robot to go on')
    path, = recordings(system)
    found = reindexed(path)
    published = [number for number, when in robot.heard() if when <= killed_at]
    print('MEASURED SIGKILL of the panel while it records: {} messages saved; {} of those '
          'published since are missing'.format(len(found), published[-1] - found[-1][0]))
    numbers = [number for number, _ in found]
    assert numbers == list(range(numbers[0], numbers[-1] + 1)), 'a hole in the middle'
    assert len(found) >= messages - 100
    measured('the last message saved was received before the end', killed_at - found[-1][1], 1.0)


def reindexed(path):
    """Mend a file as its owner would; return (number, time of receipt [s]) of what is in it."""
    done = subprocess.run(['rosbag', 'reindex', path], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout.decode()
    with rosbag.Bag(path) as bag:
        return [(message.header.seq, when.to_sec()) for topic, message, when in bag.read_messages()
                if topic == IMU]
