# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Host and two robots on computers of their own, for real: sshd, deployed files, driven, link cut.

The computers are network namespaces (``support/machines.py``); a robot's own packages are stand-ins
that start simulated robots. The tests are the steps of one day in a lab; each also works alone.
"""
import math
import os
import subprocess
import time

from support.checkout import REPO
import numpy as np
import pytest

from support import machines
from support.lab import GUARDED, HOST_SCRIPTS, LONG_S, Operator, running_lab, START_S
from support.ros_system import wait_for

WHY_NOT = machines.why_not()
pytestmark = [pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))]

REMOTE = REPO / 'utils' / 'remote'
KINDS = {'bot1': ('--type', 'turtlebot2'), 'bot2': ('--type', 'turtlebot3', '--no-guard')}
# What a robot needs to stand still, at most: the smoother's 0.5 s of patience and its ramp, or the
# watchdog's 0.5 s; the rest is for a machine under load.
STOP_S = {'bot1': 1.5, 'bot2': 1.0}
# Two or three commands were on their way, and a guard obeys what is less than a second old; the
# zero is right behind them. Without a guard it may come with a later try of TCP, where the answer
# to the first is lost as the link comes up; by then the watchdog ends it (0.5 s at 0.22 m/s) [m].
STRAYED_M = {'bot1': 0.06, 'bot2': 0.12}
# A stick of a process that stood still for longer may be centred before robots drive on.
STALE_S = 0.4


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
    for name, robot in lab.robots.items():
        if not (robot.home / 'mhri' / 'turtle_remote.sh').exists():
            status, output = lab.deploy(name)
            assert status == 0, output


@pytest.fixture(scope='module')
def started(lab, operator, deployed):
    """Start both robots; return {name: terminal}."""
    terminals = {name: lab.connect(name, *words) for name, words in KINDS.items()}
    end = time.monotonic() + START_S
    while not all(witness.live() for witness in operator.witnesses.values()):
        for terminal in terminals.values():
            assert terminal.process.poll() is None, terminal.text()
        assert time.monotonic() < end, [terminal.text() for terminal in terminals.values()]
        time.sleep(0.1)
    return terminals


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


def test_both_robots_are_started_found_and_driven(lab, operator, started):
    from mhri.robots.ros.graph_scan import look_for_robots, shipped_ignore_list
    for name, terminal in started.items():
        assert 'ROS_IP={}'.format(lab.robots[name].ip) in terminal.text(), \
            'not that of its other network'
    assert 'model:=burger' in ' '.join(lab.robots['bot2'].processes('mhri_turtlebot3.launch'))
    found = look_for_robots('/lab', shipped_ignore_list())
    assert {'bot1', 'bot2'} <= {getattr(robot, 'name', robot) for robot in found.live}
    operator.drive('bot1', 'bot2')


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


def first_standstill(rows, since):
    """Return the time of the first of three rows of standstill in a row, or None."""
    rows = [row for row in rows if row[0] >= since]
    for index in range(len(rows) - 2):
        if all(abs(part) < 0.01 for row in rows[index:index + 3] for part in row[1:3]):
            return rows[index][0]
    return None


def path_m(rows, since):
    """Return how far a robot went since a time [m]."""
    rows = [row for row in rows if row[0] >= since]
    return sum(math.hypot(b[3] - a[3], b[4] - a[4]) for a, b in zip(rows, rows[1:]))


def latencies_ms(operator, rows, turns=30):
    """Return how long each of so many changes of the stick took to a robot's command topic [ms].

    A change that is not there when the next one is due counts as of the time until then.
    """
    sent, operator.stick.longest_gap_s = [], 0.0
    for turn in range(turns + 1):
        sent.append(time.monotonic())
        operator.stick.hold(0.2, 0.5 + 0.3 * (turn % 2))
        time.sleep(0.04)
    operator.stick.hold(0.2, 0.6)
    wait_for(lambda: rows(3)[-1][0] > sent[-1] + 0.1 or operator.stick.longest_gap_s > STALE_S, 20,
             'the last change', poll_s=0.05)
    times = []
    for begin, end in zip(sent, sent[1:]):
        before = [row for row in rows(3) if row[0] < begin][-1]
        after = [row[0] for row in rows(3) if begin <= row[0] < end and row[2] != before[2]]
        times.append(1e3 * ((after[0] if after else end) - begin))
    return sorted(times)


def say_latencies(name, when, times):
    print('MEASURED stick to {}, {}: p50 {:.1f} ms, longest {:.1f} ms, {} changes'.format(
        name, when, times[len(times) // 2], times[-1], len(times)))


@pytest.mark.parametrize('name, other', [('bot1', 'bot2'), ('bot2', 'bot1')])
def test_robot_stops_without_its_link_and_is_usable_with_it(lab, operator, started, name, other):
    robot = lab.robots[name]
    rows, others = lab.observer(name), lab.observer(other)
    operator.drive(name, other)
    say_latencies(other, 'all links up', latencies_ms(operator, others))
    cut = time.monotonic()
    robot.unplug()
    try:
        wait_for(lambda: first_standstill(rows(), cut), 20, name + ' to stop', poll_s=0.05)
        stopped = first_standstill(rows(), cut) - cut
        during = latencies_ms(operator, others)
        say_latencies(other, 'link of {} cut'.format(name), during)
        # A robot that is held would wait for a centred stick for ever.
        wait_for(lambda: operator.witnesses[other].moving()
                 or operator.stick.longest_gap_s > STALE_S, 20, other + ' to go on', poll_s=0.02)
        operator.stick.hold(0.0, 0.0)
        wait_for(operator.witnesses[other].at_rest, 20, other + ' to rest', poll_s=0.05)
    finally:
        robot.plug()
    mended = time.monotonic()
    wait_for(operator.witnesses[name].live, START_S, 'word of ' + name, poll_s=0.05)
    back = time.monotonic() - mended
    # What was kept on the way has come by then, or never does.
    wait_for(lambda: time.monotonic() > mended + back + 2.0, 20, 'the rest of the backlog')
    strayed = path_m(rows(), mended)
    operator.drive(name)
    print('MEASURED link of {} ({}) cut for {:.1f} s: stands still after {:.0f} ms; mended: heard '
          'of again after {:.1f} s, moved {:.3f} m by itself, then driven again'.format(
              name, 'guarded' if name in GUARDED else 'no guard', mended - cut, stopped * 1e3,
              back, strayed))
    assert stopped < STOP_S[name]
    assert strayed < STRAYED_M[name], 'a stale command moved it'
    assert during[len(during) // 2] < 50.0, other + ' goes by the stick as before'
    assert all(terminal.process.poll() is None for terminal in started.values())
    operator.stick.hold(0.0, 0.0)
    wait_for(operator.witnesses[name].at_rest, 20, name + ' to rest', poll_s=0.05)


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


def left(robot):
    """Return what of turtle_remote.sh's runs on a robot."""
    return [line for text in ('turtle_remote', 'roslaunch', 'sim_robot', 'nodelet', 'mhri_guard',
                              'colour_camera') for line in robot.processes(text)]


def await_quiet(robot):
    """Wait until nothing of turtle_remote.sh's runs on a robot any more."""
    wait_for(lambda: not left(robot), LONG_S, lambda: 'the robot to be quiet; left: ' + '\n'.join(
        left(robot)), poll_s=0.2)


def test_ctrl_c_on_the_host_ends_the_robot(lab, started):
    terminal = started['bot1']
    assert left(lab.robots['bot1'])
    terminal.press(b'\x03')
    assert terminal.process.wait(LONG_S) == 130, terminal.text()
    await_quiet(lab.robots['bot1'])


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
