# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What 12 simulated robots cost, and whether they keep their rates.

All robots drive circles at 20 commands a second, which is the dearest thing they do. First nobody
listens to them; then one process subscribes every topic of every robot and counts. CPU is that of
the robots' processes alone, in % of one core; "of the machine" is their sum over all cores.
"""
import argparse
import json
import os
import subprocess
import sys
import threading
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402

TYPES = (('turtlebot2', None), ('turtlebot3', 'burger'), ('turtlebot3', 'waffle'))
IMU = {'turtlebot2': 'mobile_base/sensors/imu_data', 'turtlebot3': 'imu'}
COMMAND = {'turtlebot2': 'teleop/input', 'turtlebot3': 'cmd_vel'}
WANTED_HZ = {'odom': 50.0, 'imu': 100.0, 'scan': 10.0, 'tf': 50.0}
GOAL_PERCENT = 60.0


def topics_of(robots):
    """Return {(robot, kind): topic} of what is counted; ``/tf`` is one topic for all."""
    topics = {('all', 'tf'): '/tf'}
    for name, kind in robots:
        topics[name, 'odom'] = '/{}/odom'.format(name)
        topics[name, 'imu'] = '/{}/{}'.format(name, IMU[kind])
        topics[name, 'scan'] = '/{}/scan'.format(name)
        if kind == 'turtlebot3':
            topics[name, 'battery'] = '/{}/battery_state'.format(name)
    return topics


def listen(robots, warm_up_s, seconds):
    """Count raw messages on every topic; print {"robot kind": Hz} as JSON."""
    import rospy
    rospy.init_node('bench_listener', disable_signals=True)
    topics = topics_of(robots)
    counts = dict.fromkeys(topics, 0)

    def count(_, key):
        counts[key] += 1
    subscribers = [rospy.Subscriber(topic, rospy.AnyMsg, count, callback_args=key, tcp_nodelay=True)
                   for key, topic in topics.items()]
    wait_for(lambda: all(counts.values()), 30.0, 'every topic')
    wait_for(lambda: len(subscribers[0].impl.connections) == len(robots), 30.0, '/tf of everybody')
    time.sleep(warm_up_s)
    before, begun = dict(counts), time.monotonic()
    time.sleep(seconds)
    took = time.monotonic() - begun
    print(json.dumps({' '.join(key): (counts[key] - before[key]) / took for key in topics}))


class Driver(threading.Thread):
    """Sends every robot its circle at 20 Hz."""

    def __init__(self, robots):
        super().__init__(daemon=True)
        self.done = threading.Event()
        import rospy
        from geometry_msgs.msg import Twist
        self._twist = Twist()
        self._twist.linear.x, self._twist.angular.z = 0.1, 0.5
        self._publishers = [rospy.Publisher('/{}/{}'.format(name, COMMAND[kind]), Twist,
                                            queue_size=1, tcp_nodelay=True)
                            for name, kind in robots]

    def connected(self):
        """Tell whether every robot listens."""
        return all(publisher.get_num_connections() for publisher in self._publishers)

    def run(self):
        """Send until done."""
        while not self.done.wait(0.05):
            for publisher in self._publishers:
                publisher.publish(self._twist)


def start_robot(system, name, kind, model):
    """Start one simulated robot as its launch file does."""
    import rospy
    rospy.set_param('/{}/robot_type'.format(name), kind)
    if model:
        rospy.set_param('/{}/robot_model'.format(name), model)
    return system.node('sim_robot', '__ns:=' + name, '__name:=base')


def cpu_s(process):
    """Return the CPU seconds that a process has used."""
    times = psutil.Process(process.pid).cpu_times()
    return times.user + times.system


def measure_cpu(processes, seconds):
    """Return the CPU of each process over a time [% of one core]."""
    before, begun = [cpu_s(process) for process in processes], time.monotonic()
    time.sleep(seconds)
    took = time.monotonic() - begun
    return [100.0 * (cpu_s(process) - old) / took for process, old in zip(processes, before)]


def row(title, shares, rates=None):
    """Return one line of the table; of the rates the lowest of all robots."""
    line = '{:<22} {:>6.1f} {:>6.1f} {:>8.1f} {:>8.1f}'.format(
        title, sum(shares) / len(shares), max(shares), sum(shares),
        sum(shares) / psutil.cpu_count())
    for kind in WANTED_HZ:
        line += ' {:>6.1f}'.format(rates[kind]) if rates else ' {:>6}'.format('-')
    return line


def lowest(counted, robots):
    """Return {kind: lowest rate of a robot [Hz]}; of ``/tf`` the mean over the robots."""
    rates = {kind: min(value for key, value in counted.items() if key.endswith(' ' + kind))
             for kind in WANTED_HZ}
    rates['tf'] /= robots
    return rates


def run(count, seconds, patient):
    """Measure and print the table.

    :param patient: true: only once the machine is not busy with the robots' start any more
    """
    robots = [('bot{}'.format(number + 1), TYPES[number % 3]) for number in range(count)]
    names = [(name, kind) for name, (kind, _) in robots]
    with System() as system:
        system.start_master()
        import rospy
        rospy.init_node('bench_sim', disable_signals=True)
        driver = Driver(names)
        processes = [start_robot(system, name, *kind) for name, kind in robots]
        wait_for(driver.connected, 60.0, 'the robots')
        driver.start()
        if patient:
            wait_for(lambda: psutil.cpu_percent(1.0) < 90.0, 60.0, 'the start to be over')
        alone = measure_cpu(processes, seconds)
        listener = subprocess.Popen(
            [sys.executable, os.path.abspath(__file__), '--listen', json.dumps(names),
             '--seconds', str(seconds)], env=system.env, stdout=subprocess.PIPE)
        wait_for(lambda: psutil.Process(listener.pid).num_threads() > 2 * count, 60.0,
                 'the listener')
        time.sleep(2.0)
        heard = measure_cpu(processes, seconds)
        counted = json.loads(listener.communicate(timeout=60.0)[0].decode())
        driver.done.set()
        driver.join()
        rospy.signal_shutdown('measured')
    rates = lowest(counted, count)
    print('{:<22} {:>6} {:>6} {:>8} {:>8} {:>27}'.format(
        '{} robots driving'.format(count), 'mean', 'max', 'sum', 'machine', 'lowest rate [Hz]'))
    print('{:<22} {:>30}  {}'.format('', '[% of one core]   [%] ', ' '.join(
        '{:>6}'.format(kind) for kind in WANTED_HZ)))
    print(row('nobody listens', alone))
    print(row('everything subscribed', heard, rates))
    machine = sum(heard) / psutil.cpu_count()
    slow = [kind for kind, hz in WANTED_HZ.items() if rates[kind] < 0.9 * hz]
    print('goal: full rates with at most {:.0f} % of the machine: {}'.format(
        GOAL_PERCENT, 'met' if machine <= GOAL_PERCENT and not slow else 'NOT met'))


def main():
    """Run the benchmark, or be its listener."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer robots and seconds')
    parser.add_argument('--robots', type=int)
    parser.add_argument('--seconds', type=float, help=argparse.SUPPRESS)
    parser.add_argument('--listen', type=json.loads, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.listen:
        listen([tuple(robot) for robot in options.listen], 1.0, options.seconds)
    else:
        run(options.robots or (3 if options.short else 12),
            options.seconds or (1.5 if options.short else 20.0), patient=not options.short)
        sys.stdout.flush()


if __name__ == '__main__':
    main()
