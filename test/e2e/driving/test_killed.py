# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive is killed or hangs while robots move, most without a guard or watchdog: a zero at once.

Robots are subscribers of rospy as it is. ``MHRI_KILLS`` sets how often the drive is killed.
"""
import contextlib
import itertools
import os
import signal
import statistics
import subprocess
import sys
import time
import xmlrpc.client

import pytest

from support import graph
from support.own_node import own_node
from support.paths import GUARD
from support.ros_system import child_processes, freeze, thaw, wait_for

system = own_node('killed_test')

ROBOTS = ['plain1', 'plain2', 'plain3', 'plain4']
KILLS = int(os.environ.get('MHRI_KILLS', '4'))
# Promised: the first zero after a kill, a hang, an orphaned drive; when a hang is said [s].
KILLED_S, HUNG_S, ORPHANED_S, SAID_S = 0.05, 0.6, 0.2, 2.0
# Promised: the next drive, after a kill and after a hang [s].
NEXT_S, NEXT_AFTER_HANG_S = 1.5, 3.0
# The lease of a guard, which looks every 0.05 s [s].
LEASED_S = 0.4


@pytest.fixture(scope='module')
def world(system):
    from support.plain_world import World
    made = World(system, ROBOTS)
    yield made
    made.end()


def told(what, zeros, promised_s=None, nexts=(), next_s=None):
    from support.node_tools import measured
    print()
    measured('{}: median of {} first zeros'.format(what, len(zeros)), statistics.median(zeros))
    measured(what + ': latest first zero', max(zeros), promised_s)
    if nexts:
        measured(what + ': latest next drive', max(nexts), next_s)


def test_every_robot_has_its_zero_within_50_ms_of_a_kill(world):
    zeros, nexts = [], []
    for _ in range(KILLS):
        since, found, next_s = world.hit(lambda drive: os.kill(drive, signal.SIGKILL))
        zeros += found
        nexts.append(next_s)
        world.stays(since, since + 1.0)
    told('drive killed (SIGKILL)', zeros, KILLED_S, nexts, NEXT_S)


def test_every_robot_has_its_zero_within_600_ms_of_a_hang(world):
    zeros, nexts = [], []
    for _ in range(3):
        since, found, next_s = world.hit(freeze)
        zeros += found
        nexts.append(next_s)
        world.stays(since, since + 1.5)
    told('drive hung (SIGSTOP)', zeros, HUNG_S, nexts, NEXT_AFTER_HANG_S)


def test_robots_stand_and_it_is_said_while_the_undertaker_hangs(world):
    from support.node_tools import measured
    world.drive()
    since = freeze(world.mux.pid)
    said = world.state.said(lambda state: state.waits_for == 'undertaker', 'it', since) - since
    zeros = world.zeros(since)
    world.stays(since, since + 2.5)
    world.mux.send_signal(signal.SIGCONT)
    told('undertaker hung (SIGSTOP)', zeros, SAID_S)
    measured('undertaker hung (SIGSTOP): said', said, SAID_S)
    world.drive()


def test_the_drive_stops_everything_and_ends_when_the_undertaker_is_killed(world):
    drive = world.drive()
    since = time.monotonic()
    world.mux.kill()
    zeros = world.zeros(since)
    told('undertaker killed', zeros, ORPHANED_S)
    world.stays(since, since + 1.0)
    wait_for(lambda: not os.path.exists('/proc/{}'.format(drive)), what='its end')
    world.mux.wait()
    world.start()


def stop_all(stopped):
    """Stop everything, or release that; return the answer."""
    import rospy
    from std_srvs.srv import SetBool
    return rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(stopped)


@pytest.fixture
def echoes(world):
    """Return the (time, frame_id) of the echoes of a guard, on a robot that is selected alone."""
    import rospy
    from geometry_msgs.msg import TwistStamped
    heard = []
    subscriber = rospy.Subscriber(
        graph.guard('held', 'echo'), TwistStamped,
        lambda message: heard.append((time.monotonic(), message.header.frame_id)))
    world.system.env['ROS_NAMESPACE'] = 'held'
    guard = world.system.start(sys.executable, GUARD, '_command:=cmd_vel')
    del world.system.env['ROS_NAMESPACE']
    world.select('held')
    # One that nobody has spoken to yet would hold no stop.
    wait_for(lambda: heard and not heard[-1][1].startswith('-'), what='the guard to be spoken to')
    world.state.wait_robot('held', lambda robot: robot.guarded, 'the guard')
    yield heard
    world.forward = 0.0
    wait_for(lambda: stop_all(False).success, what='the release of what a test may have left')
    world.select(*ROBOTS)
    guard.terminate()
    guard.wait()
    world.state.wait_robot('held', lambda robot: not robot.guarded, 'the end of the guard')
    subscriber.unregister()


def test_a_stop_that_was_just_pressed_is_held_by_the_guard_when_the_drive_is_killed(world, echoes):
    drive, run, pressed = world.drive(), world.state.message.run, time.monotonic()
    assert stop_all(True).success
    os.kill(drive, signal.SIGKILL)
    since = time.monotonic()
    world.next(run)
    world.state.wait_robot('held', lambda robot: robot.stop_confirmed, 'the word of the robot')

    def later():
        """Return what the guard has said since it holds the stop."""
        return list(itertools.dropwhile(lambda text: not text.endswith('!'), [
            text for at, text in echoes if at > pressed]))
    wait_for(lambda: time.monotonic() > since + 2.0 and len(later()) > 10, what='a while')
    assert all(text.endswith('!') for text in later()), 'released by a zero'
    world.forward = 0.0
    wait_for(lambda: stop_all(False).success, what='the release')
    wait_for(lambda: not echoes[-1][1].endswith('!'), what='the guard to be released')


def test_one_that_was_ended_by_rosnode_kill_is_followed_by_another(world):
    import rosgraph
    world.drive()
    run, uri = world.state.message.run, rosgraph.Master('/killed_test').lookupNode('/mux')
    since = time.monotonic()
    # It may be gone before it has answered, and the client asks a second time.
    with contextlib.suppress(OSError):
        xmlrpc.client.ServerProxy(uri).shutdown('/rosnode', 'user request')
    zeros = world.zeros(since)
    told('rosnode kill', zeros, KILLED_S)
    world.next(run)
    world.stays(since, time.monotonic() + 0.5)
    world.drive()


def test_where_both_were_asleep_nothing_of_before_moves(world):
    """As a computer that is suspended; robots without guard or watchdog drive on meanwhile."""
    both = world.drive(), world.mux.pid
    since = freeze(*both)
    wait_for(lambda: time.monotonic() > since + 3.0, what='a while')
    woken = thaw(*both)
    told('both asleep for 3 s, woken', world.zeros(woken))
    world.stays(woken, woken + 1.5)
    for robot in world.robots:
        assert not any(robot.after(woken)[0][1:]), 'a word of before'
    world.drive()


def test_where_both_are_killed_roslaunch_starts_both_anew(world, echoes):
    """What stops a robot meanwhile is its guard; a plain one drives on."""
    world.mux.terminate()
    world.mux.wait()
    run = world.state.message.run
    launch = world.system.launch('mhri.launch', 'gui:=none', 'inputs:=none', 'required:=false')
    world.next(run)
    world.mux = wait_for(lambda: child_processes('__name:=mux', launch.pid), what='the mux')[0]
    world.select('held', ROBOTS[0])
    world.state.wait_robot('held', lambda robot: robot.guarded, 'the guard')
    drive, run = world.drive(), world.state.message.run
    since = time.monotonic()
    for number in (world.mux.pid, drive):
        os.kill(number, signal.SIGKILL)
    guarded, plain = world.zeros(since)
    world.next(run)
    told('both killed, without guard', [plain], nexts=[time.monotonic() - since])
    told('both killed, by the guard', [guarded], LEASED_S)
    world.stays(since, time.monotonic() + 0.5)
    world.system.kill(launch, signal.SIGTERM, family=False)
    world.start()


def test_killed_twice_within_two_seconds_nothing_is_forgotten(world):
    """Of a drive that lived for so short a time the next one inherits all the same.

    On a busy computer it may take longer than that.
    """
    import rospy
    from mhri.srv import StopRobots
    zeros, took = [], []
    for _ in range(2):
        world.select(*ROBOTS)
        world.operator.set(0.25, 0.75)
        world.drive()
        world.operator.set(None)
        rospy.ServiceProxy(graph.STOP_ROBOTS, StopRobots)([ROBOTS[3]])
        world.state.wait_robot(ROBOTS[3], lambda robot: robot.stands == 'stopped_alone', 'it')
        first, since = world.child(), time.monotonic()
        os.kill(first, signal.SIGKILL)
        zeros += world.zeros(since)
        wait_for(lambda: world.child() != first, what='the next drive')
        run, again = world.state.message.run, time.monotonic()
        os.kill(world.child(), signal.SIGKILL)
        took.append(again - since)
        world.next(run)
        world.stays(since, time.monotonic() + 0.5)
        state = world.state.wait(lambda state: any(robot.selected for robot in state.robots), 'it')
        assert state.operator == '/killed_test' and state.settings.linear_mps == 0.25
        assert [robot.name for robot in state.robots
                if robot.stands == 'stopped_alone'] == ROBOTS[3:]
        # Selected anew it is free again.
        world.select(*ROBOTS[:3])
        world.state.wait_robot(ROBOTS[3], lambda robot: not robot.selected, 'the selection')
    told('drive killed twice within {:.2f} s'.format(max(took)), zeros, KILLED_S)
    world.operator.set()
    world.select(*ROBOTS)


def test_the_master_need_not_answer(world):
    drive, run = world.drive(), world.state.message.run
    freeze(world.system.master.pid)
    since = time.monotonic()
    try:
        os.kill(drive, signal.SIGKILL)
        zeros = world.zeros(since)
        world.stays(since, since + 2.0)
    finally:
        world.system.master.send_signal(signal.SIGCONT)
    told('master hung, drive killed', zeros, KILLED_S)
    world.next(run)


def test_the_master_need_not_live(world):
    drive = world.drive()
    world.system.kill(world.system.master)
    since = time.monotonic()
    os.kill(drive, signal.SIGKILL)
    zeros = world.zeros(since)
    world.stays(since, since + 4.0)
    told('master dead, drive killed', zeros, KILLED_S)
    with pytest.raises(subprocess.TimeoutExpired):
        world.mux.wait(0.1)


def test_every_velocity_that_left_is_what_the_drive_says(world):
    """Of all drives that were killed above, and of one that was not."""
    if world.system.master.poll() is None:
        world.drive()
    world.journal.conforms()
