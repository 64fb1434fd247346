# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one command, for real: in a new checkout, and where another one runs."""
import os
import signal
import subprocess
import time
import xmlrpc.client

import pytest

from support import graph
from support.ros_system import wait_for
from support.whole_run import (
    in_new_terminal, new_checkout, new_master, node_uri, publishers, Run, START_S)

BUILD_S = 1200.0
# A network of its own with nothing in it but itself.
NO_NETWORK = ['unshare', '--map-root-user', '--net', 'sh', '-c',
              'ip link set lo up && exec "$0" "$@"']


def has_own_network():
    """Return whether this machine lets us make a network with nothing in it."""
    return subprocess.run(NO_NETWORK + ['true'], stderr=subprocess.DEVNULL).returncode == 0


@pytest.fixture(scope='module')
def running(tmp_path_factory):
    """Return (address, proxy) of a master on which the script runs, without a panel and robots."""
    uri, proxy = new_master()
    with Run(tmp_path_factory.mktemp('running'), ['gui:=none', '--master', uri]) as run:
        wait_for(lambda: publishers(proxy, graph.COMMAND), START_S, 'the first mux')
        assert 'Xvfb' not in run.output
        yield uri, proxy


def test_a_new_checkout_is_built_and_runs(tmp_path):
    """In a path with a space, without a network."""
    checkout = tmp_path / 'my robots'
    with Run(tmp_path, ['--sim', '1', 'gui:=none', '--master', new_master()[0]],
             script=new_checkout(checkout),
             before=NO_NETWORK if has_own_network() else ()) as run:
        wait_for(lambda: run.process.poll() is not None or 'process[bot1' in run.output, BUILD_S,
                 'the last of its nodes', poll_s=0.1)
        run.process.send_signal(signal.SIGINT)
        assert run.wait(START_S) == 130, run.output
    assert '{}/launch/mhri.launch'.format(checkout) in run.output
    usage = in_new_terminal('rosrun mhri mhri_doctor --help', checkout / 'build' / '.ws' / 'devel')
    assert usage[:6] == 'usage:'


def test_end_of_the_panel_ends_everything(tmp_path):
    uri, proxy = new_master()
    with Run(tmp_path, ['--master', uri]) as run:
        panel = xmlrpc.client.ServerProxy(
            wait_for(lambda: node_uri(proxy, '/mhri_panel'), START_S, 'the panel'))
        os.kill(panel.getPid('/test')[2], signal.SIGTERM)
        assert run.wait(120) == 0, run.output
    assert 'died' not in run.output


def test_second_host_on_one_master_is_refused(running, tmp_path):
    uri, proxy = running
    first = wait_for(lambda: node_uri(proxy, '/mux'), START_S, 'the mux')
    with Run(tmp_path, ['--sim', '1', '--master', uri]) as second:
        assert second.wait(120) == 1, second.output
    assert '{}: /mux'.format(uri) in second.output
    assert wait_for(lambda: node_uri(proxy, '/mux'), START_S, 'the mux') == first
    assert publishers(proxy, '/bot1/odom') == []


def test_two_hosts_on_one_master_do_not_fight(running, tmp_path):
    """Started past the script, the newer mux takes over, and the older one stays away."""
    uri, proxy = running
    first = wait_for(lambda: node_uri(proxy, '/mux'), START_S, 'the first mux')
    with Run(tmp_path, ['mhri', 'mhri.launch', 'gui:=none'], script='roslaunch',
             before=['env', 'ROS_MASTER_URI=' + uri]):
        second = wait_for(lambda: {node_uri(proxy, '/mux')} - {None, first}, START_S,
                          'the second mux')
        # Longer than it takes to start a mux again.
        seen, end = set(), time.monotonic() + 4.0
        while time.monotonic() < end:
            seen.add(node_uri(proxy, '/mux'))
            time.sleep(0.05)
        # None: this call came while the master was busy with another.
        assert seen - {None} == second
        wait_for(lambda: len(publishers(proxy, graph.COMMAND)) == 1, START_S, 'one mux alone')
