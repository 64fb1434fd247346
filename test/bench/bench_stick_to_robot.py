# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Latency from a stick event to the command at the robot, beside a chain of existing nodes.

mhri: Joy -> mux -> Twist at the robot, selected in the real panel. Beside it, on the same
machine and with rounds taken in turn: Twist -> topic_tools mux -> a topic_tools relay for each
robot -> Twist, the same two hops made of C++ nodes from the distribution (without limits, watch on
freshness, selection or stop). Every figure is in milliseconds, over all robots and events.

Then the same with the obstacle brake on, and scans and odometry played to it by another process.

Last the case of the contract: four robots, each with its window on the screen in which its camera
(RGB, 640x480, 30 Hz) and the graph of its motion run. First they are simulated on this machine,
where drawing what the cameras see takes a core; then what they sent is played from a bag (rosbag
play, C++), which comes near to robots with computers of their own. "machine" is the CPU of all
processes: near its limit even the C++ chain is late.
"""
import argparse
import json
import os
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import graph  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402


class Receiver:
    """Stands for all robots: notes when a value of ``linear.x`` first arrives at each of them."""

    def __init__(self, topics):
        import rospy
        from geometry_msgs.msg import Twist
        self._lock = threading.Condition()
        self._target = None
        self.arrivals = {}
        self.subscribers = [rospy.Subscriber(topic, Twist, self._on_twist, callback_args=topic,
                                             queue_size=10, tcp_nodelay=True) for topic in topics]
        self.count = len(topics)

    def connected(self):
        """Return whether every topic has its publisher."""
        return all(subscriber.get_num_connections() for subscriber in self.subscribers)

    def _on_twist(self, message, topic):
        now = time.monotonic()
        with self._lock:
            if self._target is not None and abs(message.linear.x - self._target) < 1e-6:
                self.arrivals.setdefault(topic, now)
                if len(self.arrivals) == self.count:
                    self._lock.notify()

    def expect(self, value):
        """Forget what arrived and wait for another value."""
        with self._lock:
            self._target = value
            self.arrivals = {}

    def wait(self, timeout_s=2.0):
        """Return the arrival times; fewer than robots where some did not come."""
        with self._lock:
            self._lock.wait_for(lambda: len(self.arrivals) == self.count, timeout_s)
            return list(self.arrivals.values())


def percentile(values, share):
    """Return the value below which a share of the sorted values lies."""
    return values[min(len(values) - 1, int(share * len(values)))]


def row(name, robots, values):
    """Return one line of the table."""
    values = sorted(values)
    return '{:<26} {:>3} {:>7} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f}'.format(
        name, robots, len(values), percentile(values, 0.5), percentile(values, 0.9),
        percentile(values, 0.99), values[-1])


class Mhri:
    """The mux and the real panel, with the robots selected.

    :param streaming: simulated robots with cameras, else none but who receives their commands
    :param brake: whether the obstacle brake is on; then their lasers and odometry are played
    """

    def __init__(self, system, names, streaming, brake):
        import rospy
        from sensor_msgs.msg import Joy
        from mhri.msg import ControlMode
        self._joy_class = Joy
        system.node('mux')
        if streaming:
            robots = system.launch('sim.launch', 'n:={}'.format(len(names)), 'types:=turtlebot2')
        for name in names:
            rospy.set_param('/{}/robot_type'.format(name), 'turtlebot2' if streaming else 'generic')
        if brake:
            ask_for_brakes(system)
        settings = os.path.join(system.home, 'screen.json')
        with open(settings, 'w', encoding='utf-8') as stream:
            looks = {name: {'views': ['imu', 'rgb']} for name in names}
            json.dump({'state': {'looks': looks}}, stream)
        self.receiver = Receiver(['/{}/{}'.format(
            name, 'teleop/input' if streaming else 'cmd_vel') for name in names])
        self._joy = rospy.Publisher(graph.PEDAL, Joy, queue_size=1, tcp_nodelay=True)
        mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1)
        wait_for(lambda: self._joy.get_num_connections() and mode.get_num_connections(), 15,
                 'the mux')
        # While nobody is in control anybody may choose the mode.
        mode.publish('pedal')
        panel = system.node('panel', '--settings', settings, '--select', ' '.join(names))
        wait_for(self.receiver.connected, 60, 'the mux')
        if brake:
            system.start(sys.executable, os.path.abspath(__file__), '--play', *names)
            wait_for_brakes(names)
        wait_for(lambda: comes_through(self), 60, 'the first command at every robot')
        if streaming:
            self.streams = Streams(system, names, panel, robots)

    def rest(self):
        """Centre the stick: in the other way's turn the source has gone stale."""
        self.receiver.expect(0.0)
        self.send(0.0)
        self.receiver.wait(0.3)

    def send(self, value):
        """Deflect the stick forward; the operator's limit makes it half as many m/s."""
        self._joy.publish(self._joy_class(axes=[0.0, value]))


def comes_through(way):
    """Centre the stick and deflect it; return whether every robot hears that."""
    way.rest()
    way.receiver.expect(0.05)
    way.send(0.1)
    return len(way.receiver.wait(0.2)) == way.receiver.count


def ask_for_brakes(system):
    """Switch the obstacle brake on as an operator who then goes: the settings in force stay."""
    import rospy
    from mhri.msg import DriveState
    said = []
    ear = rospy.Subscriber(graph.DRIVE_STATE, DriveState, said.append)
    wish = system.start('rostopic', 'pub', '-r', '5', graph.SELECT,
                        'mhri/RobotSelect', '{settings: [{linear_mps: 0.5, angular_rad_s: 1.5, '
                        'brake: true}]}')
    wait_for(lambda: said and said[-1].settings.brake, 60, 'the brake')
    system.kill(wish)
    wait_for(lambda: not said[-1].operator, 60, 'an empty seat')
    ear.unregister()


def wait_for_brakes(names):
    """Wait until the mux says of every robot that its brake is on."""
    import rospy
    from mhri.msg import DriveState
    said = []
    ear = rospy.Subscriber(graph.DRIVE_STATE, DriveState, lambda message: said.append(
        {robot.name for robot in message.robots if robot.brake == robot.BRAKE_ON}))
    wait_for(lambda: said and said[-1] == set(names), 30, 'the brakes')
    ear.unregister()


def play(names):
    """Play laser (10 Hz) and odometry (50 Hz) of robots in a room 8 m wide, until ended."""
    import rospy
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import LaserScan
    rospy.init_node('players')
    scans = [rospy.Publisher('/{}/scan'.format(name), LaserScan, queue_size=1) for name in names]
    places = [rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1) for name in names]
    scan = LaserScan(angle_increment=0.0174533, range_min=0.1, range_max=10.0, ranges=[4.0] * 360)
    place = Odometry()
    place.pose.pose.orientation.w = 1.0
    tick, rate = 0, rospy.Rate(50)
    while not rospy.is_shutdown():
        tick += 1
        for publisher in places:
            publisher.publish(place)
        # Each at another moment, as robots do.
        for publisher in scans[tick % 5::5]:
            publisher.publish(scan)
        rate.sleep()


class Streams:
    """The pictures and motions that the panel shows, and what that costs."""

    TOPICS = ('camera/rgb/image_raw/compressed', 'mobile_base/sensors/imu_data', 'odom')
    INFO = 'camera/rgb/camera_info'

    def __init__(self, system, names, panel, robots):
        import psutil
        import rosgraph
        self._system = system
        self._names = names
        self._robots = robots
        self._panel = psutil.Process(panel.pid)
        self._machine = psutil.cpu_times
        master = rosgraph.Master('/bench')

        def shown():
            heard = dict(master.getSystemState()[1])
            return all('/mhri_panel' in heard.get(topic, ())
                       for topic in self._all_topics() if not topic.endswith(self.INFO))
        wait_for(shown, 60, 'graph and picture in every window', poll_s=0.1)

    def _all_topics(self):
        return ['/{}/{}'.format(name, topic) for name in self._names
                for topic in self.TOPICS + (self.INFO,)]

    def used(self):
        """Return by now: the time, the CPU of the panel, that of all processes [s]."""
        times, machine = self._panel.cpu_times(), self._machine()
        return (time.monotonic(), times.user + times.system,
                sum(machine) - machine.idle - machine.iowait - machine.guest - machine.guest_nice)

    def from_a_bag(self, how_much):
        """End the simulated robots and play what they sent, over and over, in their place.

        :param how_much: an option of ``rosbag record``
        """
        path = os.path.join(self._system.home, 'robots.bag')
        recorder = self._system.start('rosbag', 'record', '--quiet', how_much, '--output-name',
                                      path, *self._all_topics())
        if recorder.wait(60):
            raise RuntimeError('rosbag record ended with {}'.format(recorder.returncode))
        self._robots.terminate()
        self._robots.wait(60)
        self._system.start('rosbag', 'play', '--quiet', '--loop', path)
        self.rates(0.0)

    def rates(self, seconds):
        """Return how many pictures a second the camera of each robot makes."""
        import rospy
        counts = dict.fromkeys(self._names, 0)

        def count(_, name):
            counts[name] += 1
        subscribers = [rospy.Subscriber('/{}/{}'.format(name, self.INFO), rospy.AnyMsg, count,
                                        callback_args=name, tcp_nodelay=True)
                       for name in self._names]
        wait_for(lambda: all(counts.values()), 20, 'the cameras')
        before, begun = dict(counts), time.monotonic()
        time.sleep(seconds)
        took = time.monotonic() - begun
        found = [(counts[name] - before[name]) / took for name in self._names]
        for subscriber in subscribers:
            subscriber.unregister()
        return found


class Chain:
    """topic_tools mux and one relay for each robot."""

    def __init__(self, system, names):
        import rospy
        from geometry_msgs.msg import Twist
        self._twist_class = Twist
        tools = [path for path in ('/opt/ros/noetic/lib/topic_tools', '/usr/lib/topic_tools')
                 if os.path.exists(os.path.join(path, 'relay'))][0]
        system.start(os.path.join(tools, 'mux'), '/chain/out', '/chain/in', '__name:=chain_mux',
                     '_tcp_nodelay:=true')
        topics = ['/chain/{}/cmd_vel'.format(name) for name in names]
        for name, topic in zip(names, topics):
            system.start(os.path.join(tools, 'relay'), '/chain/out', topic,
                         '__name:=relay_' + name, '_tcp_nodelay:=true', '_unreliable:=false')
        self.receiver = Receiver(topics)
        self._twist = rospy.Publisher('/chain/in', Twist, queue_size=1, tcp_nodelay=True)
        wait_for(lambda: comes_through(self), 20, 'the chain')

    def rest(self):
        """Do nothing: the chain forwards whatever comes."""

    def send(self, value):
        """Send the command as the stick would."""
        message = self._twist_class()
        message.linear.x = value * 0.5
        self._twist.publish(message)


def measure(way, events, pace_s, start):
    """Return latencies [ms] of a number of events.

    A robot that is not heard for a second, on a machine that is too busy, is held and waits for a
    centred stick: that is no latency. It is said, and the event comes again.
    """
    found = []
    way.rest()
    while len(found) < events * way.receiver.count:
        value = 0.2 + 0.001 * ((start + len(found)) % 500)
        way.receiver.expect(value * 0.5)
        begun = time.monotonic()
        way.send(value)
        arrivals = way.receiver.wait()
        if len(arrivals) < way.receiver.count:
            print('a command did not arrive at every robot: the stick is centred once', flush=True)
            wait_for(lambda: comes_through(way), 60, 'a command at every robot')
            continue
        found += [(when - begun) * 1000.0 for when in arrivals]
        time.sleep(max(0.0, pace_s - (time.monotonic() - begun)))
    return found


def verdict(values):
    """Return how the case of the contract compares with its limits."""
    values = sorted(values)
    p50, p99 = percentile(values, 0.5), percentile(values, 0.99)
    return '{:<26}       goal p99 <= 5 ms: {}; contract p50 <= 1, p99 <= 10 ms: {}'.format(
        '', 'met' if p99 <= 5.0 else 'NOT met', 'met' if p50 <= 1.0 and p99 <= 10.0 else 'NOT met')


def compare(ways, robots, events, table):
    """Measure both ways, in rounds taken in turn; return the values of the first one."""
    found = {name: [] for name in ways}
    rounds = 5
    for turn in range(rounds):
        for name, way in ways.items():
            found[name] += measure(way, events // rounds, 0.013, turn * 97)
    for name, values in found.items():
        table.append(row(name, robots, values))
    ours, other = (sorted(values) for values in found.values())
    table.append('{:<26} {:>3}   ratio of the medians {:.2f} (goal {}), of p99 {:.2f} (1.0)'.format(
        '', robots, percentile(ours, 0.5) / percentile(other, 0.5), 1.2 if robots < 12 else 1.0,
        percentile(ours, 0.99) / percentile(other, 0.99)))
    return ours


def compare_streaming(mhri, chain, robots, events, table, short):
    """Measure both ways while every window shows pictures; see the top."""
    for title in ('mhri, simulated here', 'mhri, played from a bag'):
        if title.endswith('bag'):
            mhri.streams.from_a_bag('--limit=30' if short else '--duration=20')
        time.sleep(0.0 if short else 2.0)  # the first drawing is not what is measured here
        begun = mhri.streams.used()
        values = compare({title: mhri, 'topic_tools (mux, relay)': chain}, robots, events, table)
        took_s, panel_s, machine_s = (now - then for now, then in zip(mhri.streams.used(), begun))
        table.append(verdict(values))
        table.append('{:<26}       CPU: panel {:.0f}, machine {:.0f} of {} %; cameras {} Hz'.format(
            '', 100.0 * panel_s / took_s, 100.0 * machine_s / took_s, 100 * os.cpu_count(),
            ', '.join('{:.1f}'.format(rate) for rate in mhri.streams.rates(0.5 if short else 2.0))))


def run(robots, table, streaming, brake, short):
    """Measure both ways with a number of robots."""
    import rospy
    events = 20 if short else 1000
    names = ['bot{}'.format(number + 1) for number in range(robots)]
    with System(adopt=False) as system:
        os.environ.update({key: system.env[key] for key in ('ROS_MASTER_URI', 'ROS_IP', 'ROS_HOME',
                                                            'ROS_LOG_DIR')})
        system.screen()
        system.start_master()
        rospy.init_node('bench', disable_signals=True)
        mhri, chain = Mhri(system, names, streaming, brake), Chain(system, names)
        if streaming:
            compare_streaming(mhri, chain, robots, events, table, short)
        else:
            title = 'mhri, obstacle brake on' if brake else 'mhri'
            compare({title: mhri, 'topic_tools (mux, relay)': chain}, robots, events, table)
        rospy.signal_shutdown('measured')


def main():
    """Print one table; each number of robots in a process of its own, rospy knows only one life."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='one robot only, fewer events')
    parser.add_argument('--robots', type=int, help='only this many')
    parser.add_argument('--brake', action='store_true', help='with the obstacle brake on')
    parser.add_argument('--play', nargs='+', metavar='ROBOT', help='play their sensors, no more')
    parser.add_argument('--streaming', action='store_true', help='windows with pictures')
    options = parser.parse_args()
    if options.play:
        play(options.play)
        return
    if options.robots is None:
        print('stick to robot [ms]        bots  values      p50      p90      p99      max',
              flush=True)
        robots = '1' if options.short else '4'
        for words in ([] if options.short else [['1'], ['4'], ['12']]) + [
                [robots, '--brake'], [robots, '--streaming']]:
            arguments = [sys.executable, os.path.abspath(__file__), '--robots'] + words
            status = os.spawnv(os.P_WAIT, sys.executable,
                               arguments + (['--short'] if options.short else []))
            if status:
                sys.exit(status)
        return
    table = []
    run(options.robots, table, options.streaming, options.brake, options.short)
    print('\n'.join(table), flush=True)


if __name__ == '__main__':
    main()
