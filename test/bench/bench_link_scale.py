# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the host's sides of the link cost as robots are added: processor and memory.

Each robot says what a TurtleBot3 does (odometry 50 Hz, IMU 100 Hz, laser 10 Hz, the guard's echo
10 Hz), and each is commanded at 20 Hz. Somebody looks at all of it, or, in the second table of the
long form, at the echoes alone: robots that are reached and not on a screen. The host's sides are
the real ones, a process for each robot. The robots are light stand-ins: one process speaks for all
of them on the wire, each over a connection of its own, with no ROS behind it; so what is measured
is the host's cost alone. It ends where this computer no longer carries all of it.
"""
import argparse
import os
import subprocess
import sys
import threading
import time

import numpy as np
import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import free_port, System, wait_for  # noqa: E402

HERE = os.path.abspath(__file__)
SHORT, FULL = (1, 2, 3), (1, 5, 10, 25, 50)
SHORT_S, FULL_S = 1.5, 8.0
PATIENCE_S = 300.0
# With less than this share of the messages the computer no longer carries all of it.
CARRIED = 0.9
TICK_S = 0.01
# What this computer is called on the link, with a number: without keys a bare name gets a mark.
HOST = 'host:bench.1'
# Topic, type, sent at every so many ticks.
STREAMS = (('odom', 'nav_msgs/Odometry', 2), ('imu', 'sensor_msgs/Imu', 1),
           ('scan', 'sensor_msgs/LaserScan', 10),
           ('mhri_guard/echo', 'geometry_msgs/TwistStamped', 10))
TOPICS = [row[0] for row in STREAMS]


def bodies():
    """Return {topic: the bytes of a message of it}."""
    import io
    from geometry_msgs.msg import TwistStamped
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Imu, LaserScan
    found = {}
    for (topic, _, _), message in zip(STREAMS, (Odometry(), Imu(), LaserScan(ranges=[1.0] * 360,
                                                intensities=[1.0] * 360), TwistStamped())):
        message.header.frame_id = 'bot/base'
        buffer = io.BytesIO()
        message.serialize(buffer)
        found[topic] = buffer.getvalue()
    return found


def due(number, wanted):
    """Return the topics that are sent at a tick, of those that are wanted by their places."""
    return [topic for place, (topic, _, every) in enumerate(STREAMS)
            if number % every == 0 and place in wanted]


def stand_ins(ports):
    """Return a side of the link for each robot."""
    from mhri.link.carried import COMMAND, STATE
    from mhri.link.frames import About, pack_about
    from mhri.link.ros.carrier import Carrier
    from mhri.link.ros.side import Side
    found = bodies()

    class StandIn(Side):
        """What a robot says on the wire."""

        def __init__(self, name, port):
            carrier = Carrier(['tcp/127.0.0.1:{}'.format(port)])
            super().__init__(name, carrier.between(name, HOST), 'up')
            self._about = About({'robot_type': 'turtlebot3', 'robot_model': 'burger'},
                                tuple(row[:2] for row in STREAMS))
            self.wanted = ()

        def said(self):
            return self._about.name, ()

        def on_peer(self, beat, now):
            self.wanted = beat.wanted
            if beat.about != self._about.name:
                self.send_about(pack_about(self._about))

        def on_frame(self, topic, frame, now):
            pass

        def work(self, now):
            pass

        def speak(self, number):
            """Send what is due at a tick and wanted."""
            if not self.peer.heard(self.clock()):
                return
            for topic in due(number, self.wanted):
                self.send(topic, COMMAND if 'echo' in topic else STATE, found[topic])

    return [StandIn('bot{}'.format(number + 1), port).start()
            for number, port in enumerate(ports)]


def robots(ports):
    """Be all robots."""
    sides, number, next_s = stand_ins(ports), 0, time.monotonic()
    print('ready', flush=True)
    while True:
        number += 1
        for side in sides:
            side.speak(number)
        next_s += TICK_S
        time.sleep(max(0.0, next_s - time.monotonic()))


def listen(count, topics):
    """Be whoever looks at topics of the robots and commands them."""
    import rospy
    from geometry_msgs.msg import TwistStamped
    rospy.init_node('looks', disable_signals=True)
    heard = {}

    def note(_, name):
        heard[name] = heard.get(name, 0) + 1
    publishers = []
    for number in range(count):
        name = 'bot{}'.format(number + 1)
        for topic in topics:
            rospy.Subscriber('/{}/{}'.format(name, topic), rospy.AnyMsg, note, name,
                             tcp_nodelay=True)
        publishers.append(rospy.Publisher('/{}/mhri_guard/command'.format(name), TwistStamped,
                                          queue_size=1, tcp_nodelay=True))

    def command():
        while True:
            message = TwistStamped()
            message.header.stamp = rospy.Time.from_sec(time.time())
            message.header.frame_id = 'bench:1:token'
            for publisher in publishers:
                publisher.publish(message)
            time.sleep(0.05)
    threading.Thread(target=command, daemon=True).start()
    for _ in sys.stdin:
        print(' '.join(str(heard.get('bot{}'.format(number + 1), 0)) for number in range(count)),
              flush=True)


class Looker:
    """The process of :func:`listen`."""

    def __init__(self, system, count, topics):
        self._process = subprocess.Popen(
            [sys.executable, HERE, '--listen', str(count), '--topics'] + topics, env=system.env,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, universal_newlines=True)

    def counts(self):
        """Return how many messages came of each robot so far."""
        self._process.stdin.write('\n')
        self._process.stdin.flush()
        return [int(word) for word in self._process.stdout.readline().split()]

    def close(self):
        """End it."""
        self._process.kill()
        self._process.wait(20)


def used(processes):
    """Return (processor time [s], memory of their own [MB]) of processes."""
    time_s = sum(sum(process.cpu_times()[:2]) for process in processes)
    return time_s, sum(process.memory_full_info().uss for process in processes) / 1e6


def line_of(counts, values):
    """Return (value at 0, slope, share of the spread that the line explains)."""
    slope, begin = np.polyfit(counts, values, 1)
    spread = np.sum((np.array(values) - np.mean(values)) ** 2)
    rest = np.sum((np.array(values) - begin - slope * np.array(counts)) ** 2)
    return begin, slope, 1.0 - rest / spread if spread else 1.0


def measure(system, looker, sides, window_s):
    """Return (processor of the links [%], of the master [%], memory [MB], messages/s)."""
    links = [psutil.Process(side.pid) for side in sides]
    master = psutil.Process(system.master.pid)
    before, before_m = used(links)[0], used([master])[0]
    heard, at = sum(looker.counts()), time.monotonic()
    time.sleep(window_s)
    took_s = time.monotonic() - at
    after, memory = used(links)
    share_m = (used([master])[0] - before_m) / took_s
    return (100.0 * (after - before) / took_s, 100.0 * share_m, memory,
            (sum(looker.counts()) - heard) / took_s)


def run(counts, window_s, topics):
    """Measure with so many robots each, somebody looking at topics, and print a table."""
    rows = []
    least = sum(CARRIED / (TICK_S * every) for topic, _, every in STREAMS if topic in topics)
    print('\nsomebody looks at: ' + ', '.join(topics))
    with System() as system:
        system.start_master()
        ports = [free_port() for _ in range(max(counts))]
        stand_ins = system.start(sys.executable, HERE, '--robots', *map(str, ports))
        wait_for(lambda: 'ready' in open(stand_ins.log).read(), PATIENCE_S, 'the stand-ins')
        sides = []
        print('{:>6} {:>12} {:>14} {:>12} {:>14} {:>11} {:>9}'.format(
            'robots', 'links, %', '% each', 'links, MB', 'MB each', 'messages/s', 'master, %'))
        for count in counts:
            while len(sides) < count:
                name = 'bot{}'.format(len(sides) + 1)
                sides.append(system.node('mhri_link', '--side', 'host', '--name', name,
                                         '--connect', 'tcp/127.0.0.1:{}'.format(ports[len(sides)]),
                                         '--host', HOST, '--keys', 'off', '__ns:=/' + name))
            looker = Looker(system, count, topics)
            wait_for(lambda: min(looker.counts()) > 20, PATIENCE_S, 'all to be heard', 0.2)
            share, share_m, memory, rate = measure(system, looker, sides, window_s)
            looker.close()
            print('{:>6} {:>12.1f} {:>14.2f} {:>12.0f} {:>14.1f} {:>11.0f} {:>9.1f}{}'.format(
                count, share, share / count, memory, memory / count, rate, share_m,
                '  not all of it is carried' if rate < least * count else ''), flush=True)
            if rate < least * count and len(rows) > 1:
                break
            rows.append((count, share, memory))
    numbers, shares, memories = zip(*rows)
    for what, unit, values in (('processor', '% of a core', shares), ('memory', 'MB', memories)):
        if len(values) > 1:
            print('{}: {:.1f} + {:.2f} {} for each robot; a line explains {:.1f} % of it'.format(
                what, *line_of(numbers, values)[:2], unit, 100.0 * line_of(numbers, values)[2]))


def main():
    """Measure, or be one of the processes that are measured with."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--short', action='store_true', help='{} robots'.format(max(SHORT)))
    parser.add_argument('--robots', nargs='+', type=int, help=argparse.SUPPRESS)
    parser.add_argument('--topics', nargs='+', help=argparse.SUPPRESS)
    parser.add_argument('--listen', type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.robots:
        robots(options.robots)
    elif options.listen:
        listen(options.listen, options.topics)
    elif options.short:
        run(SHORT, SHORT_S, TOPICS)
    else:
        run(FULL, FULL_S, TOPICS)
        run(FULL, FULL_S, TOPICS[-1:])


if __name__ == '__main__':
    main()
