# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot on a master of its own, linked to the host: driven, looked at, and whatever dies."""
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.linked import Linked, LONG_S, Operator  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

# The lease is 0.3 s, and the robot brakes; the rest is for a busy computer.
STANDS_S = 3.0
# Asks on another master.
ASK = '''
import sys, rospy
from std_srvs.srv import Trigger
rospy.init_node('asks', disable_signals=True)
rospy.wait_for_service('/bot1/mhri_link/take_control', 20)
print(rospy.ServiceProxy('/bot1/mhri_link/take_control', Trigger)().message)
'''
# Counts on another master how often the gates end on purpose.
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


@pytest.fixture(scope='module')
def lab():
    import rospy
    from mhri.graph.ros.master_watch import MasterWatch
    from mhri.link.ros.carrier import load_library
    from support.robots import Witness
    # Without it, this says the remedy.
    load_library()
    built = Linked()
    try:
        rospy.init_node('link_test', disable_signals=True)
        MasterWatch().start()
        built.watch_gates()
        built.operator = Operator()
        built.witness = Witness('bot1')
        wait_for(built.witness.live, LONG_S, 'the odometry of bot1 on the host')
        yield built
    finally:
        built.close()
        rospy.signal_shutdown('done')


def listeners_of_camera(lab):
    """Return how many nodes listen to the robot's camera on the robot's own master."""
    from mhri.graph.ros.master_api import MasterApi
    state = MasterApi('/link_test', 2.0, lab.robot.env['ROS_MASTER_URI']).call('getSystemState')
    return sum(len(nodes) for topic, nodes in state[1]
               if topic.startswith('/bot1/camera/rgb'))


def test_it_looks_like_any_robot(lab):
    import rospy
    from mhri.robots.ros.look import look_for_robots, shipped_ignore_list
    assert wait_for(lambda: rospy.has_param('/bot1/robot_type'), LONG_S)
    assert rospy.get_param('/bot1/robot_type') == 'turtlebot3'
    found = look_for_robots('/link_test', shipped_ignore_list())
    assert [robot.name for robot in found.live] == ['bot1']
    assert dict(rospy.get_published_topics())['/bot1/scan'] == 'sensor_msgs/LaserScan'


def test_the_host_side_subscribes_commands_alone(lab):
    from mhri.graph.ros.master_api import MasterApi
    api = MasterApi('/link_test', 2.0)

    def heard():
        return {topic for topic, nodes in api.call('getSystemState')[1]
                if '/bot1/mhri_link' in nodes}
    wait_for(lambda: heard() == {'/bot1/mhri_guard/command', '/bot1/mhri_guard/heard',
                                 '/mhri_session/state'}, LONG_S,
             lambda: 'its topics: {}'.format(heard()))


def test_that_the_gates_end_on_purpose_is_said_again(lab):
    """A radio may lose it, and a robot that goes back alone would go."""
    import rospy
    from std_msgs.msg import String
    with subprocess.Popen([sys.executable, '-c', ENDINGS], env=lab.robot.env,
                          stdout=subprocess.PIPE) as listener:
        assert listener.stdout.readline() == b'listens\n'
        gates = rospy.Publisher('/bot1/mhri_guard/heard', String, queue_size=1)
        wait_for(gates.get_num_connections, LONG_S, 'the link')
        gates.publish('')
        wait_for(lambda: listener.poll() is not None, LONG_S, 'it to be heard three times')
        gates.unregister()


def test_it_is_driven_through_its_guard(lab):
    lab.drive(lab.operator)
    wait_for(lab.witness.moving, LONG_S, 'the host to see it move')
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')


def test_another_host_of_the_same_name_has_to_ask(lab):
    """Without keys, and with the name of this one: it is another computer."""
    other = System(adopt=False)
    try:
        other.start_master()
        other.node('mhri_link', '--side', 'host', '--name', 'bot1', '--connect', lab.endpoint,
                   '--keys', 'off', '--host', 'host:lab', '__ns:=/bot1')
        lab.drive(lab.operator)
        asked = [sys.executable, '-c', ASK]
        said = wait_for(lambda: [text for text in [subprocess.run(
            asked, env=other.env, stdout=subprocess.PIPE, universal_newlines=True).stdout]
            if 'is it linked' not in text and text], LONG_S, 'an answer', 0.2)[0]
        assert 'has control and is told that you ask' in said, said
        # Nobody has taken it: it is still driven from here.
        lab.drive(lab.operator)
        since = time.monotonic()
        lab.host.kill(lab.link_of_host)
        wait_for(lambda: lab.stood_at(since), LONG_S, 'it to stand')
        lab.start_host_side()
        # The same computer as before: it goes on without asking.
        lab.drive(lab.operator)
        lab.operator.stick.hold(0.0, 0.0)
    finally:
        other.close()


def test_hosts_with_names_that_are_made_up_lock_nobody_out_for_good(lab):
    first = Hosts(lab, ['host:made_up_{}'.format(number) for number in range(20)])
    wait_for(lambda: len(first.answered) >= 10, LONG_S, 'the robot to take them for hosts')
    first.close()
    other = Hosts(lab, ['host:newcomer'])
    try:
        wait_for(lambda: other.answered, LONG_S, 'a host that is new to be heard')
    finally:
        other.close()
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')


class Hosts:
    """Beats by several names; notes who is answered."""

    def __init__(self, lab, names):
        from mhri.link.carried import COMMAND
        from mhri.link.ros.carrier import Carrier
        self.answered = set()
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
        number = 0
        while not self._ended.wait(0.2):
            number += 1
            for session, send in enumerate(self._senders):
                send(pack(session, number, boot_clock(), pack_beat(Beat())))

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


def test_pictures_that_were_missed_are_fetched(lab):
    """Where that is asked for."""
    import rosbag
    lab.host.kill(lab.link_of_host)
    lab.start_host_side('--keep', 'pictures')
    folder = os.path.join(lab.robot.home, 'mhri', 'link', 'bot1', 'kept', 'open')
    camera = '/bot1/camera/rgb/image_raw/compressed'

    def has_picture():
        try:
            return any(camera[5:].encode() in open(os.path.join(folder, name), 'rb').read()
                       for name in os.listdir(folder))
        except FileNotFoundError:
            return False  # not begun, or just ended
    wait_for(has_picture, LONG_S, 'the robot to record a picture', 0.1)
    lab.host.kill(lab.link_of_host)
    begun = time.time()
    time.sleep(1.0)
    ended = time.time()
    lab.start_host_side()

    def fetched():
        for name in os.listdir(lab.host.home):
            if name.startswith('bot1_missed_') and name.endswith('.bag'):
                try:
                    with rosbag.Bag(os.path.join(lab.host.home, name)) as bag:
                        return [(message.header.frame_id, when.to_sec())
                                for _, message, when in bag.read_messages([camera])]
                except rosbag.ROSBagException:
                    pass  # it is being written
        return None
    rows = [frame for frame, when in wait_for(fetched, LONG_S, 'what was missed', 0.2)
            if begun < when < ended]
    assert len(rows) > 1 and all(frame.startswith('bot1/') for frame in rows)
    wait_for(lambda: listeners_of_camera(lab) == 0, LONG_S, 'the camera to be left alone')


@pytest.mark.parametrize('side', ['host', 'robot'])
def test_what_a_side_that_hung_has_kept_is_not_obeyed(lab, side):
    lab.drive(lab.operator)
    process = lab.link_of_host if side == 'host' else lab.node_of_robot()
    since = time.monotonic()
    os.kill(process.pid, signal.SIGSTOP)
    try:
        at = wait_for(lambda: lab.stood_at(since), LONG_S, 'it to stand')
        # From now on the gates send zeros alone; what they said before is older than 0.3 s then.
        wait_for(lambda: lab.gate().stands, LONG_S, 'the gates to keep it standing')
        time.sleep(0.4)
    finally:
        os.kill(process.pid, signal.SIGCONT)
    wait_for(lab.witness.live, LONG_S, 'the odometry to be back')
    # The stick was never let go.
    time.sleep(1.0)
    assert [row for row in lab.rows() if row[0] > at and abs(row[2]) > 0.02] == []
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)


def test_the_robots_side_is_killed_and_comes_back(lab):
    lab.drive(lab.operator)
    since = time.monotonic()
    lab.node_of_robot().kill()
    at = wait_for(lambda: lab.stood_at(since), LONG_S, 'it to stand')
    print('MEASURED robot side of the link killed: the robot stands after {:.2f} s'.format(
        at - since))
    assert at - since < STANDS_S
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)


def test_a_stop_holds_on_the_robot_until_it_is_released(lab):
    import rospy
    from std_srvs.srv import SetBool
    set_stop = rospy.ServiceProxy('/mux/set_stop_all', SetBool)
    lab.drive(lab.operator)
    assert set_stop(True).success
    wait_for(lambda: lab.gate().stop_confirmed, LONG_S, 'the guard to confirm the stop')
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: set_stop(False).success, LONG_S, 'the stop to be released', 0.1)
    wait_for(lambda: not lab.gate().stop_confirmed, LONG_S, 'the guard to let go')
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)


def test_the_link_says_how_good_it_is(lab):
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray
    from mhri.robots.figures import read_figures
    from std_msgs.msg import String
    found = {}

    def on_diagnostics(message):
        for status in message.status:
            if 'link to bot1' in status.name:
                found.update((row.key, row.value) for row in status.values)
                found['message'] = status.message
    listener = rospy.Subscriber('/diagnostics', DiagnosticArray, on_diagnostics)
    wait_for(lambda: found.get('message') == 'linked' and 'age of state [ms]' in found, LONG_S,
             lambda: 'the figures of the link: {}'.format(found))
    listener.unregister()
    figures = rospy.wait_for_message('/bot1/mhri_link/figures', String, LONG_S)
    assert 0.0 <= read_figures(figures.data).round_trip < 1.0
    print('MEASURED link on this computer:', found)
    assert 0.0 <= float(found['round trip [ms]']) < 1000.0


def test_the_robots_master_is_restarted(lab):
    from mhri.graph.ros.master_api import MasterApi
    lab.robot.kill(lab.robot.master)
    lab.robot.start_master()
    api = MasterApi('/link_test', 2.0, lab.robot.env['ROS_MASTER_URI'])
    wait_for(lambda: api.node_uri('/bot1/mhri_link'), LONG_S, 'the link to register again')
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')
