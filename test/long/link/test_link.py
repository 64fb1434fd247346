# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot on a master of its own, linked to the host: who is heard, and what is carried."""
import subprocess
import sys
import threading

import pytest

from support.linked import LONG_S, running_linked
from support.paths import PLAIN_ROBOT
from support.ros_system import free_port, wait_for

# Counts on another master how often the mux ends on purpose.
ENDINGS = '''
import rospy
from std_msgs.msg import String
rospy.init_node('endings', disable_signals=True)
rest = [None] * 3
def hear(message):
    if not message.data and rest:
        rest.pop()
ears = rospy.Subscriber('/bot1/mhri_guard/heard', String, hear)
while not ears.get_num_connections():
    rospy.rostime.wallsleep(0.05)
print('listens', flush=True)
while rest:
    rospy.rostime.wallsleep(0.05)
'''

# Is a camera on another master whose compressed pictures are only advertised.
CAMERA = '''
import rospy
from sensor_msgs.msg import CompressedImage, Image
rospy.init_node('thermal_camera', disable_signals=True)
empty = rospy.Publisher('/bot1/raspicam_node/image/compressed', CompressedImage, queue_size=1)
raw = rospy.Publisher('/bot1/raspicam_node/image', Image, queue_size=1)
while True:
    empty.publish(CompressedImage(format='jpeg'))
    raw.publish(Image(height=2, width=2, encoding='mono16', step=4, data=bytes(8)))
    rospy.rostime.wallsleep(0.1)
'''


@pytest.fixture(scope='module')
def lab():
    yield from running_linked()


def listeners_of_camera(lab):
    """Return how many nodes listen to the robot's camera on the robot's own master."""
    from mhri.graph.ros.master_api import MasterApi
    state = MasterApi('/link_test', LONG_S, lab.robot.env['ROS_MASTER_URI']).call('getSystemState')
    return sum(len(nodes) for topic, nodes in state[1]
               if topic.startswith('/bot1/camera/rgb'))


def test_that_the_mux_ends_on_purpose_is_said_again(lab):
    """A radio may lose it, and a robot that goes back alone would go."""
    import rospy
    from std_msgs.msg import String
    with subprocess.Popen([sys.executable, '-c', ENDINGS], env=lab.robot.env,
                          stdout=subprocess.PIPE) as listener:
        assert listener.stdout.readline() == b'listens\n'
        mux = rospy.Publisher('/bot1/mhri_guard/heard', String, queue_size=1)
        wait_for(mux.get_num_connections, LONG_S, 'the link')
        mux.publish('')
        wait_for(lambda: listener.poll() is not None, LONG_S, 'it to be heard three times')
        mux.unregister()


def test_presenters_with_names_that_are_made_up_lock_nobody_out_for_good(lab):
    first = Hosts(lab, ['host:made_up_{}'.format(number) for number in range(20)])
    wait_for(lambda: len(first.answered) >= 10, LONG_S, 'the robot to take them for hosts')
    first.close()
    other = Hosts(lab, ['host:newcomer'])
    try:
        wait_for(lambda: other.answered, LONG_S, 'a host that is new to be heard')
    finally:
        other.close()
    lab.drive(lab.operator)
    lab.let_stand(lab.operator)


def test_a_second_computer_of_the_same_name_takes_nothing_over(lab):
    lab.drive(lab.operator)
    second = Hosts(lab, ['host:lab'])
    try:
        wait_for(lambda: second.sent >= 10, LONG_S, 'its beats')
        lab.drive(lab.operator)
        lab.let_stand(lab.operator)
    finally:
        second.close()


class Hosts:
    """Beats by several names; notes who is answered."""

    def __init__(self, lab, names):
        from mhri.link.carried import COMMAND
        from mhri.link.ros.carrier import Carrier
        self.answered, self.sent = set(), 0
        self._carrier = Carrier(connect=[lab.endpoint])
        self._ended = threading.Event()
        self._senders = []
        for name in names:
            between = self._carrier.between('bot1', name)
            between.listen('up', lambda *_, name=name: self.answered.add(name))
            self._senders.append(between.sender('down', '_beat', COMMAND))
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        from mhri.link.frames import Beat, pack, pack_beat
        from mhri.link.ros.clock import boot_clock
        while not self._ended.wait(0.2):
            for session, send in enumerate(self._senders):
                send(pack(session, self.sent + 1, boot_clock(), pack_beat(Beat())))
            self.sent += 1

    def close(self):
        self._ended.set()
        self._thread.join()
        self._carrier.close()


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


def test_a_raw_picture_comes_where_the_compressed_one_is_only_advertised(lab):
    from mhri.camera.ros.camera_feed import CameraFeed
    with subprocess.Popen([sys.executable, '-c', CAMERA], env=lab.robot.env) as camera:
        feed = CameraFeed('bot1', ['raspicam_node/image'], 'rgb')
        feed.open()
        try:
            wait_for(feed.take, LONG_S, lambda: 'a picture: {}'.format(feed.status()))
            assert feed.status().transport == 'raw'
        finally:
            feed.close(LONG_S)
            camera.kill()


def test_sensors_of_other_names_come_over_the_link(lab):
    """The host finds them in its turn."""
    from mhri.graph.ros.resources import robot_types
    from mhri.robots.ros.registry import RobotRegistry
    endpoint = 'tcp/127.0.0.1:{}'.format(free_port())
    names = ['--name', 'bot2', '--keys', 'off', '__ns:=/bot2']
    robot = [lab.robot.start(sys.executable, PLAIN_ROBOT, 'cmd_vel', 'odometry/filtered',
                             '__ns:=/bot2'),
             lab.robot.node('mhri_link', '--side', 'robot', '--listen', endpoint, *names)]
    host = lab.host.node('mhri_link', '--side', 'host', '--connect', endpoint, '--host',
                         'host:lab', *names)
    registry = RobotRegistry(robot_types()[0])
    try:
        wait_for(lambda: registry.look(['bot2'])['bot2'].odometry == ('odom', 'odometry/filtered'),
                 LONG_S, 'its odometry on the host', 0.1)
    finally:
        for process in [host] + robot:
            process.terminate()


def test_the_link_says_how_good_it_is(lab):
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
    from mhri.robots.figures import read_figures
    from std_msgs.msg import String
    found = []

    def on_diagnostics(message):
        found.extend(({row.key: row.value for row in status.values}, status.level)
                     for status in message.status if 'link to bot1' in status.name)
    listener = rospy.Subscriber('/diagnostics', DiagnosticArray, on_diagnostics)
    values, _ = wait_for(lambda: next((row for row in found[:] if row[1] == DiagnosticStatus.OK
                                       and 'age of state [ms]' in row[0]), None), LONG_S,
                         lambda: 'the figures of the link: {}'.format(found[-1:]))
    listener.unregister()
    figures = rospy.wait_for_message('/bot1/mhri_link/figures', String, LONG_S)
    assert 0.0 <= read_figures(figures.data).round_trip
    print('MEASURED link on this computer:', values)
    assert 0.0 <= float(values['round trip [ms]'])
