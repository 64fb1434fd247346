# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU for each recorded message of a session beside ``rosbag record`` (C++), at the same time.

Four simulated robots with all their sensors (cameras compressed, as ``~cameras_out_of_sight`` has
them) are recorded by ``mhri_session`` and by ``rosbag record`` with the very topics that the
session has in its bags. What is measured is the time of the processor, of user and system, for
each message in the bags. Then the session alone: what it costs while it only keeps its ring, how
long a mark takes from the call to the answer, its stills on the disk, and how long a stick event
to the commands of all robots, with the recorder halted and with it recording, in turn.
Goals: ratio at most 1.5; a mark within 100 ms; the stick as without.
"""
import argparse
import glob
import os
import signal
import sys
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from bench_stick_to_robot import measure, percentile, Receiver  # noqa: E402
from support import graph  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

ROBOTS, MARKS = (2, 2) if '--short' in sys.argv else (4, 20)


def cpu_s(process):
    """Return the processor time of a process and what it has started [s]."""
    times = [one.cpu_times() for one in [psutil.Process(process.pid)]
             + psutil.Process(process.pid).children(recursive=True)]
    return sum(entry.user + entry.system for entry in times)


def bags_of(path):
    """Return (messages, bytes, topics) of the bags that match a pattern."""
    import rosbag
    messages, size, topics = 0, 0, set()
    for name in glob.glob(path):
        with rosbag.Bag(name) as bag:
            messages += bag.get_message_count()
            topics |= set(bag.get_type_and_topic_info().topics)
        size += os.path.getsize(name)
    return messages, size, topics


class Bench:
    """The robots, the session and its services."""

    def __init__(self, system):
        import rospy
        from mhri.msg import SessionState
        from mhri.srv import MarkSession
        from std_srvs.srv import SetBool
        self.system = system
        system.node('mux', '__name:=mux')
        system.node('tasks')
        system.launch('sim.launch', 'n:={}'.format(ROBOTS), 'types:=turtlebot2')
        self.session = system.node('mhri_session', '_cameras_out_of_sight:=true',
                                   '_stop_free_mb:=1', '_warn_free_mb:=1')
        rospy.init_node('bench', anonymous=True, disable_signals=True)
        self.state = SessionState()
        rospy.Subscriber('/mhri_session/state', SessionState, self._hear)
        rospy.wait_for_service('/mhri_session/record', 60.0)
        self.record = rospy.ServiceProxy('/mhri_session/record', SetBool)
        self.mark = rospy.ServiceProxy('/mhri_session/mark', MarkSession)
        wait_for(lambda: len(self.state.robots) == ROBOTS, 60.0, 'the robots')
        # Every camera is heard once a mark has all their stills, colour and depth.
        wait_for(lambda: '{} stills'.format(2 * ROBOTS) in self.mark().message, 60.0, 'cameras',
                 0.5)
        self.record(False)

    def _hear(self, message):
        self.state = message

    def topics(self, seconds):
        """Record for a moment; return the topics that come."""
        self.record(True)
        time.sleep(seconds)
        self.record(False)
        return sorted(bags_of(os.path.join(self.state.folder, '*.bag'))[2])

    def idle(self, seconds):
        """Return what the ring alone costs [share of a core]."""
        begun, since = cpu_s(self.session), time.monotonic()
        time.sleep(seconds)
        return (cpu_s(self.session) - begun) / (time.monotonic() - since)

    def beside(self, topics, seconds):
        """Return {way: (CPU [s], messages, bytes)} of both at the same time."""
        home = self.system.home
        tool = '/opt/ros/noetic/lib/rosbag/record'
        tool = tool if os.path.exists(tool) else '/usr/lib/rosbag/record'
        other = self.system.start(tool, '--buffsize=0', '-O', os.path.join(home, 'beside'), *topics)
        wait_for(lambda: glob.glob(os.path.join(home, 'beside.bag.active')), 30.0, 'rosbag')
        time.sleep(2.0)
        self.record(True)
        first = {'session': cpu_s(self.session), 'rosbag': cpu_s(other)}
        before = self.state.messages
        time.sleep(seconds)
        spent = {'session': cpu_s(self.session) - first['session'],
                 'rosbag': cpu_s(other) - first['rosbag']}
        assert before is not None
        other.send_signal(signal.SIGINT)
        self.record(False)
        other.wait(30)
        return spent, bags_of(os.path.join(self.state.folder, '*.bag')), bags_of(
            os.path.join(home, 'beside.bag'))

    def marks(self):
        """Return how long each of some marks takes [ms]."""
        self.record(True)
        found = []
        for _ in range(MARKS):
            begun = time.monotonic()
            self.mark()
            found.append(1e3 * (time.monotonic() - begun))
            time.sleep(0.1)
        self.record(False)
        return sorted(found)


class Stick:
    """A pedal and a selection, without a screen."""

    def __init__(self):
        import rospy
        from mhri.msg import ControlMode, RobotSelect
        from sensor_msgs.msg import Joy
        self._joy_class = Joy
        names = ['bot{}'.format(number + 1) for number in range(ROBOTS)]
        self._joy = rospy.Publisher(graph.PEDAL, Joy, queue_size=1, tcp_nodelay=True)
        mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        select = rospy.Publisher(graph.SELECT, RobotSelect, queue_size=1,
                                 latch=True)
        self.receiver = Receiver(['/{}/teleop/input'.format(name) for name in names])
        mode.publish('pedal')
        select.publish(robots=names)
        self._lease = rospy.Timer(rospy.Duration(0.4), lambda _: select.publish(robots=names))
        wait_for(lambda: self._joy.get_num_connections(), 60, 'the mux')
        wait_for(self._comes_through, 60, 'a command at every robot')

    def _comes_through(self):
        self.send(0.0)
        time.sleep(0.05)
        self.receiver.expect(0.05)
        self.send(0.1)
        return len(self.receiver.wait(0.2)) == self.receiver.count

    def rest(self):
        """Centre the stick."""
        self.receiver.expect(0.0)
        self.send(0.0)
        self.receiver.wait()

    def send(self, value):
        """Deflect it."""
        self._joy.publish(self._joy_class(axes=[0.0, value]))


def sticks(bench, events):
    """Return {case: latencies [ms]} with the recorder halted, and recording, in turn."""
    stick, found = Stick(), {'recorder halted': [], 'recording': []}
    process = psutil.Process(bench.session.pid)
    for turn in range(4):
        name = 'recording' if turn % 2 else 'recorder halted'
        if turn % 2:
            bench.record(True)
        else:
            process.suspend()
        try:
            found[name] += measure(stick, events // 2, 0.013, turn * 97)
        except RuntimeError as error:
            print('{}: {}'.format(name, error))
        finally:
            process.resume()
        if turn % 2:
            bench.record(False)
    stick.rest()
    return {name: sorted(values) for name, values in found.items()}


def rate_of(path, seconds):
    """Return messages per second of the newest part of a session's bags."""
    import rosbag
    with rosbag.Bag(path) as bag:
        end = bag.get_end_time()
        import rospy
        return sum(1 for _ in bag.read_messages(
            raw=True, start_time=rospy.Time.from_sec(end - seconds))) / seconds


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='two robots, fewer seconds')
    options = parser.parse_args()
    seconds = 1.0 if options.short else 40.0
    with System() as system:
        system.start_master()
        bench = Bench(system)
        topics = bench.topics(1.0)
        idle = bench.idle(seconds / 2)
        spent, session, rosbag = bench.beside(topics, seconds)
        rates = (rate_of(max(glob.glob(os.path.join(bench.state.folder, '*.bag'))), seconds / 2),
                 rate_of(os.path.join(system.home, 'beside.bag'), seconds / 2))
        marks = bench.marks()
        latencies = sticks(bench, 20 if options.short else 2000)
    print('{} robots, {} topics          us/message   messages/s   % of a core'.format(
        ROBOTS, len(topics)))
    each = {}
    for (name, cpu), rate in zip(sorted(spent.items(), reverse=True), rates):
        each[name] = cpu / seconds / rate * 1e6
        print('{:<28} {:>11.1f} {:>12.0f} {:>13.1f}'.format(
            name, each[name], rate, 100 * cpu / seconds))
    print('in the bags: session {} messages, {:.1f} MB (with its ring); rosbag {}, {:.1f} MB'
          .format(session[0], session[1] / 1e6, rosbag[0], rosbag[1] / 1e6))
    # The kernel counts in steps of 10 ms: a short run of rosbag may cost none.
    if each['rosbag']:
        print('ratio session / rosbag record, by message: {:.2f}'.format(
            each['session'] / each['rosbag']))
    for name, values in latencies.items():
        if values:
            print('stick to {} robots, {:<16} p50 {:.2f} p99 {:.2f} ms'.format(
                ROBOTS, name + ':', percentile(values, 0.5), percentile(values, 0.99)))
    print('the ring alone: {:.1f} % of a core'.format(100 * idle))
    print('mark, {} stills each: median {:.0f} ms, longest of {} {:.0f} ms'.format(
        2 * ROBOTS, marks[len(marks) // 2], MARKS, marks[-1]))


if __name__ == '__main__':
    main()
