# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one command, for real: nothing stands in for anything but the robots, which are simulated."""
import os
import re
import signal
import subprocess
import time
import xmlrpc.client

import cv2
import pytest

from support import graph
from support.ros_system import free_port, wait_for
from support.whole_run import in_new_terminal, new_checkout, Run, SCRIPT

START_S = 180.0
# A network of its own with nothing in it but itself.
NO_NETWORK = ['unshare', '--map-root-user', '--net', 'sh', '-c',
              'ip link set lo up && exec "$0" "$@"']


def has_own_network():
    """Return whether this machine lets us make a network with nothing in it."""
    return subprocess.run(NO_NETWORK + ['true'], stderr=subprocess.DEVNULL).returncode == 0


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
        wait_for(lambda: publishers(proxy, graph.COMMAND), START_S, 'the first mux')
        assert 'Xvfb' not in run.output
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
    assert '{}/launch/mhri.launch'.format(checkout) in run.output
    usage = in_new_terminal('rosrun mhri mhri_doctor --help', checkout / 'build' / '.ws' / 'devel')
    assert usage[:6] == 'usage:'
    picture = cv2.imread(str(tmp_path / 'drive.png'))
    assert picture is not None and picture.shape[0] >= 400 and picture.shape[1] >= 600
    assert picture.std() > 5
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
    wait_for(lambda: node_uri(proxy, '/mux') and node_uri(proxy, '/mhri_panel'), START_S,
             'mux and panel')
    wait_for(lambda: publishers(proxy, '/bot1/odom'), START_S, 'the robot')
    assert 'Xvfb' in run.output
    run.process.send_signal(signal.SIGINT)
    assert run.wait(120) == 130, run.output
    assert 'leftover process' not in run.output


def test_end_of_the_panel_ends_everything(start, master):
    uri, proxy = master
    run = start('--master', uri)
    panel = xmlrpc.client.ServerProxy(
        wait_for(lambda: node_uri(proxy, '/mhri_panel'), START_S, 'the panel'))
    os.kill(panel.getPid('/test')[2], signal.SIGTERM)
    assert run.wait(120) == 0, run.output
    assert 'died' not in run.output


def test_second_host_on_one_master_is_refused(start, running):
    uri, proxy = running
    first = wait_for(lambda: node_uri(proxy, '/mux'), START_S, 'the mux')
    second = start('--sim', '1', '--master', uri)
    assert second.wait(120) == 1, second.output
    assert '{}: /mux'.format(uri) in second.output
    assert wait_for(lambda: node_uri(proxy, '/mux'), START_S, 'the mux') == first
    assert publishers(proxy, '/bot1/odom') == []


def test_two_hosts_on_one_master_do_not_fight(start, running):
    """Started past the script, the newer mux takes over, and the older one stays away."""
    uri, proxy = running
    first = wait_for(lambda: node_uri(proxy, '/mux'), START_S, 'the first mux')
    start('mhri', 'mhri.launch', 'gui:=none', script='roslaunch',
          before=['env', 'ROS_MASTER_URI=' + uri])
    second = wait_for(lambda: {node_uri(proxy, '/mux')} - {None, first}, START_S, 'the second mux')
    # Longer than it takes to start a mux again.
    seen, end = set(), time.monotonic() + 4.0
    while time.monotonic() < end:
        seen.add(node_uri(proxy, '/mux'))
        time.sleep(0.05)
    # None: this call came while the master was busy with another.
    assert seen - {None} == second
    wait_for(lambda: len(publishers(proxy, graph.COMMAND)) == 1, START_S, 'one mux alone')
