# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one command, for real: nothing stands in for anything but the robots, which are simulated."""
import os
import re
import signal
import subprocess
import sys
import time
import xmlrpc.client

from conftest import children_with
import cv2
import pytest

from whole_run import in_new_terminal, new_checkout, Run, SCRIPT

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import free_port  # noqa: E402

# A network of its own with nothing in it but itself.
NO_NETWORK = ['unshare', '--map-root-user', '--net', 'sh', '-c',
              'ip link set lo up && exec "$0" "$@"']


def has_own_network():
    """Tell whether this machine lets us make a network with nothing in it."""
    return subprocess.run(NO_NETWORK + ['true'], stderr=subprocess.DEVNULL).returncode == 0


def wait_for(truth, what, limit_s=180.0):
    """Wait until something becomes true."""
    end = time.monotonic() + limit_s
    while not truth():
        assert time.monotonic() < end, 'waited {} s in vain for {}'.format(limit_s, what)
        time.sleep(0.05)


@pytest.fixture
def start(tmp_path):
    """Return a function that starts the script; what it started ends with the test."""
    runs = []

    def starter(*arguments, **keywords):
        runs.append(Run(tmp_path, arguments, **keywords))
        return runs[-1]
    yield starter
    for run in runs:
        run.end()


@pytest.fixture
def master():
    """Return (address, proxy) of a master that the script will start."""
    return new_master()


def new_master():
    uri = 'http://127.0.0.1:{}'.format(free_port())
    return uri, xmlrpc.client.ServerProxy(uri)


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    """Return (address, proxy) of a master on which the script runs, without a panel and robots."""
    uri, proxy = new_master()
    run = Run(tmp_path_factory.mktemp('running'), ['gui:=none', '--master', uri])
    try:
        wait_for(lambda: publishers(proxy, '/robot_controller/twist'), 'the first mux')
        yield uri, proxy
    finally:
        run.end()


def node_uri(proxy, node):
    """Return the address of a registered node, or None."""
    try:
        code, _, uri = proxy.lookupNode('/test', node)
    except OSError:
        return None
    return uri if code == 1 else None


def publishers(proxy, topic):
    try:
        return dict(proxy.getSystemState('/test')[2][0]).get(topic, [])
    except OSError:
        return []


def test_a_new_checkout_is_built_and_its_demo_drives_robots_without_hands(start, tmp_path):
    """In a path with a space, without a network."""
    settings = tmp_path / 'config' / 'mhri' / 'panel.json'
    settings.parent.mkdir(parents=True)
    settings.write_text('{"state": {"mode": "joy"}}\n')
    checkout = tmp_path / 'my robots'
    run = start('--demo', '--screenshot', 'drive.png', script=new_checkout(checkout),
                before=NO_NETWORK if has_own_network() else ())
    status = run.wait(1200)
    print('\n' + '\n'.join(line for line in run.output.splitlines() if 'bot' in line))
    assert status == 0, run.output
    for robot in ('bot1', 'bot2', 'bot3', 'bot4'):
        assert re.search(r'\b{}\b'.format(robot), run.output), run.output
    assert 'the demo succeeded' in run.output
    assert '{}/launch/mhri.launch'.format(checkout) in run.output
    usage = in_new_terminal('rosrun mhri mhri_doctor --help', checkout / 'build' / '.ws' / 'devel')
    assert usage[:6] == 'usage:'
    picture = cv2.imread(str(tmp_path / 'drive.png'))
    assert picture is not None and picture.shape[0] >= 400 and picture.shape[1] >= 600
    assert picture.std() > 5, 'the picture shows something'
    pictures = ['drive{}.png'.format(end) for end in (
        '', '_bot_window', '_depth', '_map', '_panel', '_stopped')]
    assert sorted(path.name for path in tmp_path.glob('*.png')) == pictures
    manual = subprocess.run([str(SCRIPT), '--help'], stdout=subprocess.PIPE).stdout.decode()
    assert [name for name in pictures if name[5:-4] not in manual] == []
    assert settings.read_text() == '{"state": {"mode": "joy"}}\n'
    assert list(settings.parent.iterdir()) == [settings]


def test_ctrl_c_takes_everything_down(start, master):
    uri, proxy = master
    run = start('--sim', '1', '--master', uri)
    wait_for(lambda: node_uri(proxy, '/mux') and node_uri(proxy, '/mhri_panel'), 'mux and panel')
    wait_for(lambda: publishers(proxy, '/bot1/odom'), 'the robot')
    assert 'there is no display: the panel runs under Xvfb' in run.output
    run.process.send_signal(signal.SIGINT)
    assert run.wait(120) == 130, run.output
    assert 'leftover process' not in run.output


def test_end_of_the_panel_ends_everything(start, master):
    uri, proxy = master
    run = start('--sim', '1', '--master', uri)
    wait_for(lambda: node_uri(proxy, '/mhri_panel'), 'the panel')
    panel = xmlrpc.client.ServerProxy(node_uri(proxy, '/mhri_panel'))
    os.kill(panel.getPid('/test')[2], signal.SIGTERM)
    assert run.wait(120) == 0, run.output
    assert 'died' not in run.output, 'a panel that is closed is no fault'


def test_panel_that_fails_ends_everything_and_is_told(start, master):
    uri, proxy = master
    run = start('--master', uri)
    wait_for(lambda: node_uri(proxy, '/mhri_panel'), 'the panel')
    panel = xmlrpc.client.ServerProxy(node_uri(proxy, '/mhri_panel'))
    os.kill(panel.getPid('/test')[2], signal.SIGKILL)
    assert run.wait(120) == 1, run.output
    assert 'REQUIRED process' in run.output and 'the panel failed' in run.output


@pytest.mark.skipif(not has_own_network(), reason='no network namespaces for us here')
def test_simulated_robots_need_no_network(start, tmp_path):
    run = start('--sim', '2', 'gui:=none', before=NO_NETWORK)
    wait_for(lambda: 'bot2' in run.output and 'process[mux' in run.output, 'the robots')
    assert 'installing missing' not in run.output
    [pid] = [pid for pid in children_with(run.mark) if is_script(pid)]
    os.kill(pid, signal.SIGINT)
    assert run.wait(120) == 130, run.output


def is_script(pid):
    with open('/proc/{}/cmdline'.format(pid)) as file:
        return str(SCRIPT) in file.read()


def test_second_host_on_one_master_is_refused(start, running):
    uri, proxy = running
    first = node_uri(proxy, '/mux')
    second = start('--sim', '1', '--master', uri)
    assert second.wait(120) == 1, second.output
    assert 'mhri already runs at {}: /mux on this computer'.format(uri) in second.output
    assert node_uri(proxy, '/mux') == first
    assert publishers(proxy, '/bot1/odom') == []


def test_mux_that_was_killed_comes_back(running):
    _, proxy = running
    wait_for(lambda: node_uri(proxy, '/mux'), 'the mux')
    first = node_uri(proxy, '/mux')
    os.kill(xmlrpc.client.ServerProxy(first).getPid('/test')[2], signal.SIGKILL)
    wait_for(lambda: node_uri(proxy, '/mux') not in (None, first), 'the mux to come back')


def test_two_hosts_on_one_master_do_not_fight(start, running):
    """Started past the script, the newer mux takes over, and the older one stays away."""
    uri, proxy = running
    wait_for(lambda: node_uri(proxy, '/mux'), 'the first mux')
    first = node_uri(proxy, '/mux')
    start('mhri', 'mhri.launch', 'gui:=none', script='roslaunch',
          before=['env', 'ROS_MASTER_URI=' + uri])
    wait_for(lambda: node_uri(proxy, '/mux') not in (None, first), 'the second mux')
    second = node_uri(proxy, '/mux')
    # Longer than it takes to start a mux again.
    seen, end = set(), time.monotonic() + 4.0
    while time.monotonic() < end:
        seen.add(node_uri(proxy, '/mux'))
        time.sleep(0.05)
    # None: this call came while the master was busy with another.
    assert seen - {None} == {second}
    assert len(publishers(proxy, '/robot_controller/twist')) == 1
