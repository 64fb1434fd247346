# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot with a master of its own on another computer: deployed, linked over ssh, and by a router.

As test/e2e/utils/test_two_machines.py: namespaces, sshd, stand-ins. bot2 is the router's computer.
"""
import signal
import subprocess
import sys

import pytest

from support import machines
from support.lab import await_quiet, left, LONG_S, running_lab, START_S
from support.ros_system import wait_for

WHY_NOT = machines.why_not()
pytestmark = [pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))]

ROUTER = 'tcp/10.77.0.12:7448'


@pytest.fixture(scope='module')
def lab(request, tmp_path_factory):
    yield from running_lab(request, tmp_path_factory.mktemp('lab'), True)


@pytest.fixture(scope='module')
def operator(lab):
    """Return (stick, witness of bot1): mux and an operator on the host."""
    import rospy
    from support.linked import Operator
    from support.robots import Witness
    rospy.init_node('lab', disable_signals=True)
    lab.system.node('mux', '__name:=mux')
    yield Operator().stick, Witness('bot1')
    rospy.signal_shutdown('done')


@pytest.fixture(scope='module')
def deployed(lab):
    """Have the files on both robots; return what was said to the first with the link."""
    said = lab.deploy('bot1', '--link')
    status, output = lab.deploy('bot2')
    assert status == 0, output
    return said


@pytest.fixture(scope='module')
def started(lab, operator, deployed):
    """Start bot1 on a master of its own; return its terminal."""
    terminal = lab.connect('bot1', '--type', 'turtlebot2', '--link', '--keys', 'off')
    wait_for(lambda: operator[1].live() or terminal.process.poll() is not None, START_S,
             terminal.text, poll_s=0.1)
    assert terminal.process.poll() is None, terminal.text()
    return terminal


def drive(operator):
    """Turn bot1 on the spot, and let it stand again; the mux asks for neutral first."""
    stick, witness = operator
    wait_for(witness.live, START_S, 'word of bot1', poll_s=0.05)
    stick.drive(0.0, 0.5, witness.moving, START_S, 'bot1 to be driven')
    stick.hold(0.0, 0.0)
    wait_for(witness.at_rest, LONG_S, 'bot1 to rest', poll_s=0.05)


def test_link_is_sent_to_the_robot_once(lab, deployed):
    status, output = deployed
    assert status == 0 and 'mhri_link.tar.gz' in output, output
    status, output = lab.deploy('bot1', '--link')
    assert status == 0 and 'nothing to send' in output, 'the same archive for the same files'


def test_robot_without_a_key_listens_to_nobody_unless_that_is_said(lab, deployed):
    terminal = lab.connect('bot1', '--type', 'turtlebot2', '--link')
    assert terminal.process.wait(LONG_S) == 1
    wait_for(lambda: '--keys off' in terminal.text(), 10, 'the remedy')
    assert left(lab.robots['bot1']) == []
    lab.terminals.remove(terminal)


def test_robot_on_its_own_master_is_driven(operator, started):
    import rosgraph
    drive(operator)
    nodes = {node for kind in rosgraph.Master('/lab').getSystemState() for _, users in kind
             for node in users if node.startswith('/bot1/')}
    assert nodes == {'/bot1/mhri_link'}, 'the rest is on the master of the robot'
    assert 'ROS_IP=127.0.0.1' in started.text()


def test_link_that_is_killed_on_the_robot_is_back(lab, operator, started):
    robot = lab.robots['bot1']
    robot.run('sh', '-c', 'kill -KILL $(pgrep -f "scripts/mhri_lin[k] --side robot")')
    wait_for(lambda: 'mhri_link was killed' in started.text(), LONG_S, 'the word')
    drive(operator)


def test_second_robot_of_the_name_is_refused_here(lab, started):
    """Before anybody logs in to it."""
    logins = lab.robots['bot1'].logins()
    terminal = lab.connect('bot1', '--type', 'turtlebot2', '--link')
    assert terminal.process.wait(LONG_S) == 1
    wait_for(lambda: 'bot1 already runs' in terminal.text(), 10, 'the word')
    assert lab.robots['bot1'].logins() == logins
    lab.terminals.remove(terminal)


def test_ctrl_c_ends_both_sides(lab, started):
    import rosgraph
    started.press(b'\x03')
    assert started.process.wait(LONG_S) == 130, started.text()
    await_quiet(lab.robots['bot1'])
    nodes = {node for kind in rosgraph.Master('/lab').getSystemState() for _, users in kind
             for node in users}
    assert '/bot1/mhri_link' not in nodes
    assert 'had ended here' not in started.text()


def test_router_between_two_that_do_not_reach_each_other(lab, operator, deployed):
    witness = operator[1]
    robot, between = lab.robots['bot1'], lab.robots['bot2']
    robot.run('ip', 'route', 'add', 'unreachable', machines.HOST_IP)
    router = start_router(lab, between)
    here = lab.system.launch('link.launch', 'side:=host', 'name:=bot1', 'router:=' + ROUTER,
                             'keys:=off')
    there = subprocess.Popen(
        robot.command('env', '-i', 'HOME={}'.format(robot.home), 'PATH=/usr/bin:/bin:/usr/sbin',
                      str(robot.home / 'mhri' / 'turtle_remote.sh'), '--link', 'bot1', '--type',
                      'turtlebot2', '--router', ROUTER, '--keys', 'off'),
        stdin=subprocess.DEVNULL, stdout=(lab.folder / 'there').open('w'), stderr=subprocess.STDOUT)
    try:
        wait_for(lambda: witness.live() or there.poll() is not None, START_S, 'bot1', poll_s=0.1)
        assert there.poll() is None, (lab.folder / 'there').read_text()
        drive(operator)
    finally:
        # Not the process here: what enters the machine does not pass a signal on.
        robot.run('pkill', '-TERM', '-f', 'turtle_remote.sh')
        there.wait(LONG_S)
        here.send_signal(signal.SIGTERM)
        lab.system.kill(router)
    await_quiet(robot)


def start_router(lab, machine):
    """Start a router on a machine; return its process once it routes."""
    log = lab.folder / 'router'
    process = subprocess.Popen(
        machine.command(sys.executable, '-c', 'from mhri.nodes.mhri_link import main; main()',
                        '--side', 'router', '--listen', ROUTER, '--keys', 'off'),
        env=lab.system.env, stdin=subprocess.DEVNULL, stdout=log.open('w'),
        stderr=subprocess.STDOUT)
    wait_for(lambda: 'routing on' in log.read_text() or process.poll() is not None, LONG_S,
             log.read_text, poll_s=0.05)
    assert process.poll() is None, log.read_text()
    return process
