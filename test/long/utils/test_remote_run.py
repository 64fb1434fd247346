# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""turtle_remote.sh in real runs on one machine: stand-in packages, simulated robots, a master."""
import contextlib
import os
import signal
import subprocess
import xmlrpc.client

from support.checkout import children_with, REPO
import pytest

from support.ros_system import free_port, System, wait_for
from support.stand_ins import workspace

SCRIPT = REPO / 'utils' / 'remote' / 'turtle_remote.sh'
PACKAGES = REPO / 'test' / 'support' / 'robot_packages'
OLDER = REPO / 'test' / 'support' / 'older_robot_packages'
HOST = '127.0.0.1'
START_S = LONG_S = 120.0


class Remote:
    """Runs of the script on a robot whose packages are stand-ins."""

    def __init__(self, system, folder):
        self.system = system
        self.folder = folder
        self.mark = 'MHRI_TEST_REMOTE={}'.format(folder)
        name, value = self.mark.split('=')
        self.env = dict(
            system.env, HOME=str(folder), TURTLEBOT_BASE='kobuki', TURTLEBOT_3D_SENSOR='kinect',
            TURTLEBOT_SIMULATION='false', LDS_MODEL='LDS-01', ROS_NAMESPACE='TurtleBot7',
            ROS_MASTER_URI='http://elsewhere:1', ROS_IP='203.0.113.9', **{name: value},
            **workspace(folder, PACKAGES))
        for name in ('TURTLEBOT3_MODEL', 'ROS_HOSTNAME'):
            self.env.pop(name, None)
        self.processes = []

    def start(self, *arguments, **environment):
        log = self.folder / 'log{}'.format(len(self.processes))
        with log.open('w') as file:
            process = subprocess.Popen(
                [str(SCRIPT), HOST, '--port', str(self.system.port)] + list(arguments),
                env=dict(self.env, **environment), cwd=str(self.folder), stdin=subprocess.DEVNULL,
                stdout=file, stderr=subprocess.STDOUT,
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
        process.output = log.read_text
        self.processes.append(process)
        return process

    def run(self, *arguments, **environment):
        """Return (exit status, output) of a run that ends by itself."""
        process = self.start(*arguments, **environment)
        status = process.wait(timeout=LONG_S)
        return status, process.output()

    def close(self):
        for process in self.processes:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                process.wait(timeout=LONG_S)
        self.kill()

    def kill(self):
        """Kill what still runs; the end of one may end others."""
        for pid in self.running():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    def running(self):
        """Return the ids of what still runs of all that was started."""
        return children_with(self.mark)


@pytest.fixture
def remote(tmp_path):
    with System(adopt=False) as system:
        system.start_master()
        built = Remote(system, tmp_path)
        yield built
        built.close()


@pytest.fixture
def master(remote):
    return xmlrpc.client.ServerProxy(remote.system.env['ROS_MASTER_URI'])


def publishers(master, topic):
    return dict(master.getSystemState('/test')[2][0]).get(topic, [])


def subscribers(master, topic):
    return dict(master.getSystemState('/test')[2][1]).get(topic, [])


def await_subscribers(master, expected):
    """Wait until topics have just these subscribers: {topic: sorted nodes}."""
    wait_for(lambda: expected == {topic: sorted(subscribers(master, topic)) for topic in expected},
             START_S, lambda: '{}, not {}'.format(expected, {
                 topic: subscribers(master, topic) for topic in expected}), 0.1)


def pid_of(master, node):
    """Return the process of a node that answers."""
    return xmlrpc.client.ServerProxy(master.lookupNode('/test', node)[2]).getPid('/test')[2]


def parameter(master, name):
    code, _, value = master.getParam('/test', name)
    return value if code == 1 else None


def await_topics(process, master, *topics):
    """Wait until these are published; say what the script said where it ended instead."""
    def there():
        assert process.poll() is None, process.output()
        return all(publishers(master, topic) for topic in topics)
    wait_for(there, START_S, ', '.join(topics), poll_s=0.1)


def test_turtlebot2_with_all_that_belongs_to_it(remote, master):
    master.setParam('/test', '/bot1/label', 'of the host')
    process = remote.start('bot1', '--type', 'turtlebot2', '--brake', '--back-after', '10')
    await_topics(process, master, '/bot1/odom', '/bot1/camera/rgb/image_raw',
                 '/bot1/cmd_vel_mux/input/teleop', '/bot1/mobile_base/commands/velocity')
    wait_for(lambda: publishers(master, '/bot1/teleop/input') == ['/bot1/mhri_guard'], START_S,
             'the guard before the smoother', poll_s=0.1)
    # The guard also subscribes to where others publish.
    await_subscribers(master, {
        '/bot1/teleop/input': ['/bot1/mhri_guard', '/bot1/teleop_velocity_smoother'],
        '/bot1/cmd_vel_mux/input/teleop': ['/bot1/cmd_vel_mux'],
        '/bot1/mobile_base/commands/velocity': ['/bot1/mobile_base'],
        '/bot1/scan': ['/bot1/mhri_guard']})
    wait_for(lambda: '/bot1/mhri_guard' in subscribers(master, '/bot1/cmd_vel_mux/input/navi'),
             START_S, 'the guard to watch the other input', poll_s=0.1)
    assert parameter(master, '/bot1/robot_type') == 'turtlebot2'
    assert parameter(master, '/bot1/mobile_base/odom_frame') == 'bot1/odom'
    asked = {'max_linear_mps': 0.65, 'radius_m': 0.18, 'laser_x_m': -0.087, 'brake': True,
             'no_return': 'nan,inf',
             'back_after_s': 10}
    assert {key: parameter(master, '/bot1/mhri_guard/' + key) for key in asked} == asked
    assert parameter(master, '/bot1/camera/driver/rgb_frame_id') == 'bot1/camera_rgb_optical_frame'
    assert 'ROS_MASTER_URI=http://127.0.0.1:{}'.format(remote.system.port) in process.output()
    assert 'TurtleBot7' not in str(master.getSystemState('/test')), 'ROS_NAMESPACE is taken away'
    # Without its camera it can be driven on.
    os.kill(pid_of(master, '/bot1/camera/driver'), signal.SIGTERM)
    wait_for(lambda: "the camera's launch has ended" in process.output(), START_S, 'word of it',
             poll_s=0.1)
    assert process.poll() is None and pid_of(master, '/bot1/mobile_base')
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=LONG_S) == 130, process.output()
    assert remote.running() == []
    assert 'leftover process' not in process.output()
    assert [name for name in master.getParamNames('/test')[2] if name.startswith('/bot1/')] == [
        '/bot1/label'], 'what the robot brought goes with it'


def test_turtlebot3_listens_to_its_guard_alone(remote, master):
    (remote.folder / '.bashrc').write_text('export TURTLEBOT3_MODEL=waffle_pi  # as guides say\n')
    process = remote.start('bot3', '--type', 'turtlebot3')
    await_topics(process, master, '/bot3/odom', '/bot3/mhri_guard/velocity')
    # The guard also subscribes to its own output, to notice other publishers.
    await_subscribers(master, {
        '/bot3/cmd_vel': ['/bot3/mhri_guard'],
        '/bot3/mhri_guard/velocity': ['/bot3/mhri_guard', '/bot3/turtlebot3_core']})
    assert parameter(master, '/bot3/robot_model') == 'waffle_pi'
    assert parameter(master, '/bot3/turtlebot3_core/tf_prefix') == 'bot3'
    process.send_signal(signal.SIGHUP)
    assert process.wait(timeout=LONG_S) == 129, process.output()
    assert remote.running() == []


def test_turtlebot3_of_an_older_release(remote, master):
    """Its launch file knows no model, and its camera has a launch file of its own."""
    process = remote.start('bot3', '--type', 'turtlebot3_waffle_pi', '--no-guard',
                           **workspace(remote.folder, OLDER, PACKAGES))
    await_topics(process, master, '/bot3/odom', '/bot3/raspicam_node/image/compressed')
    assert parameter(master, '/bot3/robot_model') == 'waffle_pi'
    assert parameter(master, '/bot3/turtlebot3_core/tf_prefix') == 'bot3'
    assert parameter(master, '/bot3/raspicam_node/camera_frame_id') == 'bot3/camera'
    assert not publishers(master, '/bot3/mhri_guard/echo')
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=LONG_S) == 143, process.output()
    assert remote.running() == []


def test_robot_with_a_launch_file_of_its_own(remote, master):
    (remote.folder / 'own.launch').write_text(
        '<launch><node pkg="mhri" type="sim_robot" name="own_base"/></launch>')
    process = remote.start('r1', '--type', 'turtlesim', '--launch', 'own.launch')
    # turtlesim has no simulated body: this robot's launch file starts nothing that lives.
    assert process.wait(timeout=LONG_S) == 1
    assert "the robot's launch has ended" in process.output()
    (remote.folder / 'launches').mkdir()
    (remote.folder / 'launches' / 'own.launch').write_text(
        '<launch><param name="robot_type" value="turtlebot2"/>'
        '<node pkg="mhri" type="sim_robot" name="own_base"/></launch>')
    process = remote.start('r1', '--launch', 'launches/own.launch')
    await_topics(process, master, '/r1/odom')
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=LONG_S) == 130


def test_robot_joins_again_when_mhri_is_started_anew_and_keeps_its_name(remote, master):
    process = remote.start('bot1', '--type', 'turtlebot2', '--no-camera')
    await_topics(process, master, '/bot1/odom')
    wait_for(lambda: parameter(master, '/bot1/mhri_remote'), 30, 'the note', poll_s=0.1)
    remote.system.kill(remote.system.master)
    wait_for(lambda: 'no longer answers' in process.output(), LONG_S, 'word of the silence',
             poll_s=0.1)
    remote.system.start_master()
    await_topics(process, master, '/bot1/odom', '/bot1/cmd_vel_mux/input/teleop')
    wait_for(lambda: parameter(master, '/bot1/robot_type') == 'turtlebot2', START_S, 'its type',
             poll_s=0.1)
    # Its name is taken, until it is killed: what it leaves on the master does not count.
    status, output = remote.run('bot1', '--type', 'turtlebot2')
    assert status == 1 and 'bot1' in output
    assert process.poll() is None and publishers(master, '/bot1/odom')
    remote.kill()
    process.wait(timeout=LONG_S)
    assert publishers(master, '/bot1/odom')
    again = remote.start('bot1', '--type', 'turtlebot2', '--no-camera')
    wait_for(lambda: 'the name bot1 is free' in again.output(), START_S, 'the check', poll_s=0.1)
    again.kill()
    wait_for(lambda: remote.running() == [], LONG_S, 'the nodes to end', poll_s=0.2)


MISSING = (
    (['--type', 'turtlebot3'], {}, 'TURTLEBOT3_MODEL'),
    (['--type', 'turtlebot3'], {'TURTLEBOT3_MODEL': 'tank'}, "'tank'"),
    (['--type', 'turtlebot3_burger'], {'LDS_MODEL': ''}, 'LDS_MODEL'),
    (['--type', 'turtlebot2'], {'ROS_PACKAGE_PATH': '/nowhere'}, 'turtlebot_bringup'),
    ([], {'ROS_PACKAGE_PATH': '/nowhere'}, 'turtlebot3_bringup'),
    ([], {}, 'turtlebot_bringup and turtlebot3_bringup'),
    (['--model', 'burger'], {'ONLY': 'turtlebot_bringup'}, '--model'),
    (['--launch', 'no_such_package/x.launch'], {}, 'no_such_package'),
    (['--launch', './none.launch'], {}, './none.launch'),
    (['--launch', '/no/where/none.launch'], {}, '/no/where/none.launch'),
    (['--launch', 'turtlebot_bringup/none.launch'], {}, 'none.launch'),
    (['--type', 'turtlebot2', '--ip', '203.0.113.9'], {}, '203.0.113.9'),
)


def test_what_is_missing_on_the_robot_is_said(remote):
    for arguments, environment, named in MISSING:
        if 'ONLY' in environment:
            environment = {'ROS_PACKAGE_PATH': str(PACKAGES / environment['ONLY'])}
        status, output = remote.run('bot1', *arguments, **environment)
        assert status == 1 and named in output, output
        assert 'process[' not in output and remote.running() == []


def test_a_robot_that_cannot_run_the_guard_is_told_how_to_do_without(remote):
    (remote.folder / 'rospy.py').write_text('raise ImportError("there is none here")')
    paths = '{}:{}'.format(remote.folder, remote.env.get('PYTHONPATH', ''))
    status, output = remote.run('bot1', '--type', 'turtlebot2', PYTHONPATH=paths)
    assert status == 1 and 'rospy' in output and '--no-guard' in output
    status, output = remote.run('bot1', '--type', 'turtlebot2', '--no-guard', '--port',
                                str(free_port()), PYTHONPATH=paths)
    assert status == 1 and 'mhri_run.sh' in output


def test_setup_file_is_named_or_found(remote, master):
    setup = 'export ROS_PACKAGE_PATH="{}"\n'.format(remote.env['ROS_PACKAGE_PATH'])
    bare = {'ROS_PACKAGE_PATH': remote.system.env.get('ROS_PACKAGE_PATH', '')}
    (remote.folder / 'my.bash').write_text(setup)
    status, output = remote.run('bot1', '--setup', 'my.bash', **bare)
    assert status == 1 and 'turtlebot3_bringup' in output
    found = remote.folder / 'catkin_ws' / 'devel' / 'setup.bash'
    found.parent.mkdir(parents=True)
    found.write_text(setup)
    status, output = remote.run('bot1', **bare)
    assert status == 1 and str(found) in output and 'turtlebot3_bringup' in output
