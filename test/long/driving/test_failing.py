# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A thread of the drive fails while plain robots move: a zero, and neutral, whichever it is."""
import os
import sys
import time

import pytest

from support import graph
from support.own_node import own_node
from support.ros_system import children, wait_for
from support.node_tools import measured

system = own_node('failing_test')

ROBOTS = ['plain1', 'plain2']
# The mux, of which one method fails once when a file is there.
FAILS = '''
import os, sys
from mhri.driving.drive import Drive
from mhri.driving.ros.brake_eye import BrakeEye

def fails(kind, method, path):
    real = getattr(kind, method)
    def act(self, *args):
        try:
            os.unlink(path)
        except OSError:
            return real(self, *args)
        raise MemoryError('planted')
    setattr(kind, method, act)

for kind, method in ((Drive, 'tick'), (Drive, 'on_source'), (Drive, 'on_stop'), (Drive, 'on_wish'),
                     (Drive, 'on_stop_robots'), (BrakeEye, 'on_odometry')):
    fails(kind, method, os.path.join(sys.argv[1], method))
del sys.argv[1]
from mhri.nodes.mux import main
main()
'''
# Promised; a loop that fails ends the process, which the kernel clears away first; else its beats
# are missed [s].
AT_ONCE_S, HUNG_S = 0.05, 0.6
# A planted fault of the odometry waits for its next message [s].
BEAT_S = 0.1


@pytest.fixture(scope='module')
def world(system):
    from support.plain_world import World

    class FailingWorld(World):
        """Plain robots, and a mux that fails when it is told to."""

        def start(self):
            """Start the mux."""
            self.mux = self.system.start(sys.executable, '-c', FAILS, self.system.home)
            self.state.message = None

        def fail(self, method):
            """Let that method fail at its next call; return when [s, monotonic]."""
            path, when = os.path.join(self.system.home, method), time.monotonic()
            open(path + '.new', 'w').close()
            os.rename(path + '.new', path)
            return when

    made = FailingWorld(system, ROBOTS)
    yield made
    made.end()


def log_of(world):
    with open(world.mux.log) as log:
        return log.read()


def told(what, zeros, promised_s):
    measured('{} fails: the last first zero'.format(what), max(zeros), promised_s)


def test_a_loop_that_ends_ends_the_drive(world):
    drive, run = world.drive(), world.state.message.run
    since = world.fail('tick')
    zeros = world.zeros(since)
    told('the loop that drives', zeros, HUNG_S)
    world.next(run)
    world.stays(since, time.monotonic() + 0.5)
    assert children(world.mux.pid) != [drive] and 'planted' in log_of(world)


@pytest.mark.parametrize('method', ['on_source', 'on_wish'])
def test_a_message_that_fails_gives_a_zero_and_asks_for_neutral(world, method):
    drive = world.drive()
    since = world.fail(method)
    wait_for(lambda: not os.path.exists(os.path.join(world.system.home, method)), what='it')
    failed = time.monotonic()
    told(method, [max(0.0, zero - (failed - since)) for zero in world.zeros(since)], AT_ONCE_S)
    world.state.said(lambda state: state.waits_for == 'neutral', 'it', since)
    world.stays(since, time.monotonic() + 0.5)
    wait_for(lambda: 'planted' in log_of(world), what='its line in the log')
    assert children(world.mux.pid) == [drive], 'the same goes on'


@pytest.mark.parametrize('method', ['on_stop', 'on_stop_robots'])
def test_a_stop_that_fails_stops_everything(world, method):
    import rospy
    from mhri.srv import StopRobots
    from std_srvs.srv import SetBool
    world.drive()
    world.fail(method)
    since = time.monotonic()
    with pytest.raises(rospy.ServiceException):
        if method == 'on_stop':
            rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(True)
        else:
            rospy.ServiceProxy(graph.STOP_ROBOTS, StopRobots)(ROBOTS)
    told(method, world.zeros(since), AT_ONCE_S)
    world.state.wait(lambda state: state.stop_all, 'the stop')
    world.forward = 0.0
    wait_for(lambda: rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(False).success,
             what='the release')


def test_a_robot_whose_odometry_fails_stands_alone_and_waits_for_neutral(world):
    import rospy
    from nav_msgs.msg import Odometry
    failing, other = world.robots
    # Of both: where one node is two robots and measures one, the other is taken for its input.
    odometry = [rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
                for name in ROBOTS]
    wait_for(lambda: all(one.get_num_connections() for one in odometry),
             what='the drive to listen')
    beats = rospy.Timer(rospy.Duration(0.05), lambda event: odometry[0].publish(Odometry()))
    world.drive()
    since = world.fail('on_odometry')
    world.state.wait_robot(ROBOTS[0], lambda robot: robot.stands == 'joining', 'it')
    zero = wait_for(lambda: [entry[0] for entry in failing.after(since) if not any(entry[1:])],
                    what='its zero')[0]
    told('the odometry of one robot', [zero - since], AT_ONCE_S + BEAT_S)
    assert (0.0, 0.0) not in [entry[1:] for entry in other.after(since)], 'the other drives on'
    beats.shutdown()
    for one in odometry:
        one.unregister()
