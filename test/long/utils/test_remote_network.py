# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Host and two robots on computers of their own, for real: keys, files, pictures, outages, ends.

As test/e2e/utils/test_two_machines.py. The tests are the steps of one day in a lab; each also works
alone.
"""
import os
import subprocess
import time

import numpy as np
import pytest

from support import machines
from support.lab import (
    await_quiet, first_standstill, GUARDED, HOST_SCRIPTS, left, LONG_S, Operator, path_m,
    running_lab, START_S, STRAYED_M)
from support.paths import REPO
from support.ros_system import wait_for

WHY_NOT = machines.why_not()
pytestmark = [pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))]

REMOTE = REPO / 'utils' / 'remote'


@pytest.fixture(scope='module')
def lab(request, tmp_path_factory):
    yield from running_lab(request, tmp_path_factory.mktemp('lab'))


@pytest.fixture(scope='module')
def operator(lab):
    """Return the operator's end: a node in this process, with a stick and an eye on each robot."""
    built = Operator(lab)
    yield built
    built.close()


@pytest.fixture(scope='module')
def trusted(lab):
    """Have the operator know the robots' keys."""
    for robot in lab.robots.values():
        lab.trust(robot)


@pytest.fixture(scope='module')
def deployed(lab, trusted):
    """Have the files on the robots that have none yet."""
    lab.deploy_to_all()


@pytest.fixture(scope='module')
def started(operator, deployed):
    """Start both robots; return {name: terminal}."""
    return operator.start_robots()


def test_robot_with_an_unknown_key_is_not_trusted(lab):
    status, output = lab.deploy('bot1')
    assert status == 1 and 'compare its key' in output
    assert lab.robots['bot1'].logins() == 0


def test_robot_with_another_key_than_before_is_not_trusted(lab):
    machines.run('ssh-keygen', '-q', '-t', 'ed25519', '-N', '', '-f', str(lab.folder / 'other'))
    lab.trust(lab.robots['bot1'], lab.folder / 'other')
    status, output = lab.deploy('bot1')
    assert status == 1 and 'REMOTE HOST IDENTIFICATION HAS CHANGED' in output
    terminal = lab.connect('bot1')
    assert terminal.process.wait(LONG_S) == 255
    assert lab.robots['bot1'].logins() == 0
    lab.known_hosts.write_text('')


def test_connecting_before_deploying_says_what_to_do(lab, trusted):
    terminal = lab.connect('bot1')
    assert terminal.process.wait(LONG_S) == 1
    wait_for(lambda: 'run turtlebot_deploy.sh turtle@10.77.0.11' in terminal.text(), 10, 'the word')


def test_deployment_asks_for_one_password(lab, trusted):
    robot = lab.robots['bot1']
    (lab.folder / 'id').rename(lab.folder / 'put_away')
    before = robot.logins()
    status, output = lab.deploy('bot1', password=True)
    (lab.folder / 'put_away').rename(lab.folder / 'id')
    assert status == 0, output
    assert len(lab.asked.read_text().splitlines()) == 1
    assert robot.logins() - before == 1
    assert 'Accepted password' in robot.log.read_text()
    files = sorted(path.name for path in REMOTE.iterdir() if path.is_file())
    there = {path.name for path in (robot.home / 'mhri').iterdir()}
    # mhri.launch is the name of the 2016 guide, a link.
    assert there == {*files, 'mhri.launch'}
    for name in files:
        assert (robot.home / 'mhri' / name).read_bytes() == (REMOTE / name).read_bytes()
    assert os.access(str(robot.home / 'mhri' / 'turtle_remote.sh'), os.X_OK)


def test_a_robot_that_cannot_take_the_files_is_said(lab, trusted):
    robot = lab.robots['bot2']
    (robot.home / 'mhri').write_text('a file where the folder should be')
    status, output = lab.deploy('bot2')
    assert status == 1 and 'mhri on 10.77.0.12' in output
    (robot.home / 'mhri').unlink()
    # A disk of 8 kB.
    (robot.home / 'mhri').mkdir()
    robot.run('mount', '-t', 'tmpfs', '-o', 'size=8k', 'tmpfs', str(robot.home / 'mhri'))
    status, output = lab.deploy('bot2')
    assert status == 1 and 'disk' in output
    robot.run('umount', str(robot.home / 'mhri'))
    status, output = lab.deploy('bot2')
    assert status == 0, output


def test_camera_is_seen_on_the_host(lab, started):
    import rosgraph
    import rospy
    from sensor_msgs.msg import Image
    picture = rospy.wait_for_message('/bot1/camera/rgb/image_raw', Image, timeout=START_S)
    assert picture.header.frame_id == 'bot1/camera_rgb_optical_frame'
    # The window of a robot that is selected shows its camera: on the screen, and it is alive.
    sides = set()
    deadline = time.monotonic() + START_S
    while sides != {'left', 'right'}:
        assert time.monotonic() < deadline, 'magenta is seen {}'.format(sides or 'nowhere')
        sides |= magenta_sides(lab.screen())
    master = rosgraph.Master('/lab')
    listeners = dict(master.getSystemState()[1])
    assert '/mhri_panel' in listeners['/bot1/camera/rgb/image_raw/compressed']


def magenta_sides(screen):
    """Return {'left'}, {'right'} or neither: where in a camera's picture magenta is beside green.

    :param screen: red, green, blue, (h, w, 3)
    """
    magenta, green = (np.abs(screen.astype(int) - colour).max(2) < 24
                      for colour in ((200, 20, 160), (20, 140, 60)))
    if magenta.sum() < 5000 or green.sum() < 5000:
        return set()
    middles = [np.nonzero(found)[1].mean() for found in (magenta, green)]
    return {'left' if middles[0] < middles[1] else 'right'}


@pytest.mark.parametrize('outage_s', [0.4, 2.0])
def test_what_an_outage_brings_back_moves_nothing(lab, operator, started, outage_s):
    """A stick that is held through it, too: let go where the outage is too short to be noticed.

    Both robots lose their links at once.
    """
    rows = {name: lab.observer(name) for name in lab.robots}
    operator.drive(*rows)
    wait_for(lambda: all(seen(3)[-1][1] > 0.05 for seen in rows.values()), 20, 'commands to both')
    cut, mended = {}, {}
    try:
        for name, robot in lab.robots.items():
            cut[name] = time.monotonic()
            robot.unplug()
        begun = time.monotonic()
        wait_for(lambda: time.monotonic() > begun + min(0.3, 0.5 * outage_s), poll_s=0.005)
        if outage_s < 1.0:
            operator.stick.hold(0.0, 0.0)
        wait_for(lambda: time.monotonic() > begun + outage_s, 20, poll_s=0.005)
    finally:
        for name, robot in lab.robots.items():
            robot.plug()
            mended[name] = time.monotonic()
    for name, seen in rows.items():
        wait_for(lambda: first_standstill(seen(), cut[name]), 20, name + ' to stop', poll_s=0.05)
        wait_for(operator.witnesses[name].live, START_S, 'word of ' + name, poll_s=0.05)
    # TCP tries again after 0.2 s and each time after twice as long: within the outage's own length.
    backlog_s = min(4.0, 1.0 + 1.5 * outage_s)
    wait_for(lambda: time.monotonic() > max(mended.values()) + backlog_s, 20, 'the backlog')
    for name, seen in rows.items():
        stopped = first_standstill(seen(), cut[name])
        strayed = path_m(seen(), stopped)
        print('MEASURED link of {} ({}) cut for {:.2f} s, stick {}: stands still after {:.0f} ms, '
              'moved {:.3f} m by itself after that'.format(
                  name, 'guarded' if name in GUARDED else 'no guard', mended[name] - cut[name],
                  'let go' if outage_s < 1.0 else 'held', 1e3 * (stopped - cut[name]), strayed))
        assert strayed < STRAYED_M[name], 'stale commands moved ' + name
    operator.stick.hold(0.0, 0.0)
    operator.drive(*rows)
    operator.stick.hold(0.0, 0.0)
    for name in rows:
        wait_for(operator.witnesses[name].at_rest, 20, name + ' to rest', poll_s=0.05)


def test_second_robot_of_a_name_is_refused(lab, operator, started):
    terminal = lab.connect('bot2', '--type', 'turtlebot3')
    assert terminal.process.wait(LONG_S) == 1
    wait_for(lambda: 'bot2 already runs' in terminal.text(), 10, 'the word')
    done = subprocess.run(
        [str(HOST_SCRIPTS / 'connect_turtlebot.sh'), machines.USER, lab.robots['bot2'].ip, 'bot1',
         '--port', str(lab.system.port), '--type', 'turtlebot3'], env=lab.env,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        universal_newlines=True, timeout=LONG_S)
    assert done.returncode == 1
    assert '/bot1/' in done.stdout and '10.77.0.11' in done.stdout
    lab.terminals.remove(terminal)
    wait_for(lambda: all(witness.live() for witness in operator.witnesses.values()), LONG_S,
             'the robots to be there still')


def test_end_of_the_hosts_terminal_ends_the_robot(lab, started):
    terminal = started['bot2']
    assert left(lab.robots['bot2'])
    terminal.close()
    await_quiet(lab.robots['bot2'])


def test_address_that_the_host_does_not_reach_is_said(lab, operator, deployed):
    terminal = lab.connect('bot2', '--type', 'turtlebot3', '--ip', '172.30.12.5')
    assert terminal.process.wait(LONG_S) == 1
    wait_for(lambda: ' at 172.30.12.5' in terminal.text(), 10, 'the word')


def test_robot_without_a_link_says_so(lab, operator, deployed):
    robot = lab.robots['bot2']
    robot.unplug()
    done = subprocess.run(
        robot.command('env', '-i', 'HOME={}'.format(robot.home), 'PATH=/usr/bin:/bin:/usr/sbin',
                      str(robot.home / 'mhri' / 'turtle_remote.sh'), machines.HOST_IP, 'bot2',
                      '--type', 'turtlebot3'),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        universal_newlines=True, timeout=LONG_S)
    robot.plug()
    assert done.returncode == 1 and 'Try: ping 10.77.0.1' in done.stdout
