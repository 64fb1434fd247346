# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What 12 robots on tasks cost, how old what their commands rest on is, and what the stick notices.

Mux and tasks are the real ones; 12 simulated robots drive small squares, seen by motion
capture. Beside them a robot that only receives is driven by a stick, in turns with tasks and
without. CPU is in % of one core. The age of a pose is from its stamp to that of the command of the
same robot that leaves next, of three of the robots, as this process hears them.
"""
import argparse
import os
import sys
import threading
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from bench_stick_to_robot import comes_through, measure, percentile, Receiver, row  # noqa: E402
from support import graph  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

ROBOTS = 3 if '--short' in sys.argv else 12
NODES = ('tasks', 'mux')
DRIVEN = 'driven'


class Ages:
    """The stamps of poses and of the commands that followed them."""

    def __init__(self, names):
        import rospy
        from geometry_msgs.msg import PoseStamped
        from mhri.msg import TeamTwist
        self._lock = threading.Lock()
        self._newest = {}
        self._begin()
        for name in names:
            rospy.Subscriber('/vrpn_client_node/{}/pose'.format(name), PoseStamped, self._on_pose,
                             name, queue_size=1, tcp_nodelay=True)
        rospy.Subscriber('/mux_in/task', TeamTwist, self._on_team, queue_size=10, tcp_nodelay=True)

    def _begin(self):
        self._ages_s, self._at, self._moving = [], [], 0

    def _on_pose(self, message, name):
        with self._lock:
            self._newest[name] = message.header.stamp.to_sec()

    def _on_team(self, message):
        at = message.header.stamp.to_sec()
        with self._lock:
            self._at.append(at)
            self._moving += sum(bool(twist.linear.x or twist.angular.z) for twist in message.twists)
            self._ages_s += [at - stamp for stamp in self._newest.values()]

    def during(self, seconds):
        """Return (ages [s], times of commands [s], how many robots moved) of some seconds."""
        with self._lock:
            self._begin()
        time.sleep(seconds)
        wait_for(lambda: len(self._at) > 1 and self._ages_s, what='velocities and poses')
        with self._lock:
            return sorted(self._ages_s), self._at, self._moving / max(1, len(self._at))


class Tasks:
    """All robots on their squares, or none."""

    def __init__(self, names):
        import actionlib
        import rospy
        from mhri.msg import DriveState, RunTaskAction, TaskList
        self._names, self._goal = names, None
        self._runs = self._drives = ()
        rospy.Subscriber(graph.TASK_LIST, TaskList,
                         lambda message: setattr(self, '_runs', message.runs), queue_size=1)
        rospy.Subscriber(graph.DRIVE_STATE, DriveState,
                         lambda message: setattr(self, '_drives', message.robots), queue_size=1)
        self._client = actionlib.ActionClient(graph.RUN_TASK, RunTaskAction)
        wait_for(lambda: self._client.wait_for_server(rospy.Duration(1.0)), 60, 'the tasks')
        wait_for(lambda: sum(bool(drive.topic) and not drive.stands for drive in self._drives)
                 > len(names), 120, lambda: 'the mux: {}'.format(self._drives), 0.1)

    def begin(self):
        """Start them; return when every robot is under way.

        Again where one is lost on the way: of a busy computer that is to be expected.
        """
        self._goal = None
        wait_for(self._all_run, 60, lambda: 'all to be on a task: {}'.format(self._runs), 0.05)

    def _all_run(self):
        from actionlib import CommState
        from mhri.msg import RunTaskGoal
        states = [robot.state for run in self._runs for robot in run.robots]
        if self._goal is None or self._goal.get_comm_state() == CommState.DONE:
            self._goal = self._client.send_goal(RunTaskGoal(
                'square', self._names, '{side: 0.3, number: 100, timeout: 0, speed: 0.15}'))
        elif set(states) - {'running', 'waiting'}:
            self._goal.cancel()
        return states == ['running'] * len(self._names)

    def end(self):
        """End them."""
        self._client.cancel_all_goals()
        wait_for(lambda: not self._runs, 30, 'the end of the tasks', 0.05)


class Driven:
    """The robot that is driven, for :func:`measure`."""

    def __init__(self):
        import rospy
        from mhri.msg import ControlMode
        from sensor_msgs.msg import Joy
        from support.fake_mux import FakeOperator
        self._class = Joy
        self.receiver = Receiver(['/{}/cmd_vel'.format(DRIVEN)])
        self._joy = rospy.Publisher(graph.PEDAL, Joy, queue_size=1, tcp_nodelay=True)
        mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        mode.publish('pedal')
        FakeOperator().check(DRIVEN)
        wait_for(lambda: comes_through(self), 60, 'the first command at the robot')

    def rest(self):
        """Centre the stick."""
        self.receiver.expect(0.0)
        self.send(0.0)
        self.receiver.wait(0.3)

    def send(self, value):
        """Deflect the stick forward; the operator's limit makes it half as many m/s."""
        self._joy.publish(self._class(axes=[0.0, value]))


def used(processes, seconds, meanwhile=time.sleep):
    """Return (what was done meanwhile, {name: CPU of it [% of a core]})."""
    before = {name: sum(one.cpu_times()[:2]) for name, one in processes.items()}
    begun = time.monotonic()
    done = meanwhile(seconds)
    took = time.monotonic() - begun
    return done, {name: 100.0 * (sum(one.cpu_times()[:2]) - before[name]) / took
                  for name, one in processes.items()}


def start(system, names):
    """Start everything; return {name: psutil.Process} of what is measured."""
    import rospy
    system.start_master()
    rospy.init_node('bench', disable_signals=True)
    rospy.set_param('/mhri/robots', names + [DRIVEN])
    rospy.set_param('/{}/robot_type'.format(DRIVEN), 'generic')
    processes = {name: psutil.Process(system.node(name).pid) for name in NODES}
    system.launch('sim.launch', 'n:={}'.format(len(names)), 'types:=turtlebot3_burger',
                  'mocap:=true')
    return processes


def report(idle, busy, found):
    """Print costs and ages."""
    ages_s, at, moving = found
    print('{:<34} {:>9} {:>9}'.format('CPU [% of a core]', 'no task', '12 tasks'))
    for name in NODES:
        print('{:<34} {:>9.1f} {:>9.1f}'.format(name, idle[name], busy[name]))
    gaps = sorted(after - before for before, after in zip(at, at[1:]))
    print('velocities: {:.1f} Hz, longest gap {:.0f} ms; {:.1f} of {} robots moving'.format(
        len(gaps) / (at[-1] - at[0]), 1000.0 * gaps[-1], moving, ROBOTS))
    print('age of the pose when the command leaves [ms]: p50 {:.1f}, p99 {:.1f}, max {:.1f}'.format(
        *(1000.0 * percentile(ages_s, share) for share in (0.5, 0.99, 1.0))), flush=True)


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer robots, seconds and events')
    short = parser.parse_args().short
    seconds, rounds, events = (1.0, 1, 10) if short else (20.0, 5, 300)
    names = ['bot{}'.format(number + 1) for number in range(ROBOTS)]
    with System() as system:
        processes = start(system, names)
        driven, tasks, ages = Driven(), Tasks(names), Ages(names[::5])
        _, idle = used(processes, seconds)
        tasks.begin()
        found, busy = used(processes, seconds, ages.during)
        report(idle, busy, found)
        tasks.end()
        values = {'stick, no task': [], 'stick, {} robots on tasks'.format(ROBOTS): []}
        for turn in range(rounds):
            for words, some in values.items():
                if words != 'stick, no task':
                    tasks.begin()
                some += measure(driven, events, 0.013, turn * 97)
            tasks.end()
        print('stick to robot [ms]        bots  values      p50      p90      p99      max')
        for words, some in values.items():
            print(row(words, 1, some), flush=True)


if __name__ == '__main__':
    main()
