# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots behind a bad radio, by one ROS master for all and by the link, and an operator of them.

The robots (simulated, each with its guard) are in a network namespace of their own; mux, a
master and the calling process as the operator are in another; between them is the radio of
``bad_radio``. The robots of a way are driven and looked at together, those of the others are left
alone: then next to nothing of theirs goes over the radio.
"""
import json
import math
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import graph  # noqa: E402
from support.authority import Authority  # noqa: E402
from support.bad_radio import BadRadio, FAR_IP, NEAR_IP, Place  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

HERE = os.path.abspath(__file__)
GUARD = os.path.join(os.path.dirname(HERE), '..', '..', 'utils', 'remote', 'mhri_guard')
TCPROS = 'TCPROS'
# What the names of a way's robots begin with; all but TCPROS are protocols of the link.
WAYS = {TCPROS: 'ros', 'tcp': 'tcp', 'tls': 'tls', 'router_near': 'near', 'router_far': 'far'}
# By a router, on which side of the radio.
ROUTED = {'router_near': NEAR_IP, 'router_far': FAR_IP}
# Of these, those that need keys.
SECRET = ('tls',) + tuple(ROUTED)
FIRST_PORT, FAR_MASTER = 7447, 11411
COMMAND, ODOMETRY = 'teleop/input', 'odom'
PICTURE = 'camera/rgb/image_raw/compressed'
IMU, SCAN = 'mobile_base/sensors/imu_data', 'scan'
PLACES = ((6.0, 2.1), (2.0, 1.5), (4.0, 2.1), (2.0, 3.0))
STICK_S, SHOW_S = 0.05, 1.0 / 30.0
# Of the stick while it is held: each event has a value of its own, by which it is known again. A
# group of robots behind a slow link drives slower, but on the same curve.
LEAST, STEP, VALUES, TURN = 0.2, 0.0005, 1000, 0.6
TIMEOUT_S = 120.0
# The operator's limits are 0.5 m/s and 1.5 rad/s: of a command, so much times the curvature is the
# part of the stick that goes forward.
CURVE = TURN * 1.5 / 0.5
# Waits for the master and tells it the type of each robot.
TYPES = '''
import os, sys, time, xmlrpc.client
master = xmlrpc.client.ServerProxy(os.environ['ROS_MASTER_URI'])
while True:
    try:
        for name in sys.argv[1:]:
            master.setParam('/bench', '/{}/robot_type'.format(name), 'turtlebot2')
        break
    except OSError:
        time.sleep(0.1)
'''


def ear(names):
    """Be beside the robots: for each line read, print what each was told and where it was since."""
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    rospy.init_node('ear_' + names[0], disable_signals=True)
    told, been = {name: [] for name in names}, {name: [] for name in names}

    def hear(name):
        """Listen to one robot."""
        rospy.Subscriber('/{}/{}'.format(name, COMMAND), Twist, lambda message: told[name].append(
            (time.monotonic(), message.linear.x, message.angular.z)), tcp_nodelay=True)
        rospy.Subscriber('/{}/{}'.format(name, ODOMETRY), Odometry, lambda message: been[
            name].append((time.monotonic(), message.pose.pose.position.x,
                          message.pose.pose.position.y)), tcp_nodelay=True)
    for name in names:
        hear(name)
    for _ in sys.stdin:
        found = {name: (told[name][:], been[name][:]) for name in names}
        for name in names:
            del told[name][:len(found[name][0])], been[name][:len(found[name][1])]
        print(json.dumps(found), flush=True)
    os._exit(0)


class Shown:
    """What comes of one robot to the operator's computer: pose, pictures, and other sensors."""

    def __init__(self, name):
        self._name = name
        self._subscribers = []
        self._pose_s = None
        self.poses, self.pictures = [], []

    def look(self):
        """Begin to look."""
        import rospy
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import CompressedImage, Imu, LaserScan
        keep = {'queue_size': 1, 'buff_size': 2 ** 22, 'tcp_nodelay': True}
        self._subscribers = [
            rospy.Subscriber('/{}/{}'.format(self._name, topic), kind, hear, **keep)
            for topic, kind, hear in (
                (ODOMETRY, Odometry, self._on_pose), (PICTURE, CompressedImage, self._on_picture),
                (IMU, Imu, lambda message: None), (SCAN, LaserScan, lambda message: None))]

    def look_away(self):
        """Look no more."""
        for subscriber in self._subscribers:
            subscriber.unregister()
        self._subscribers, self._pose_s = [], None

    def _on_pose(self, message):
        self._pose_s = message.header.stamp.to_sec()

    def _on_picture(self, message):
        self.pictures.append((time.monotonic(), time.time() - message.header.stamp.to_sec(),
                              len(message.data)))

    def pose_age_s(self):
        """Return how old the pose is; infinite before the first."""
        return math.inf if self._pose_s is None else time.time() - self._pose_s

    def show(self):
        """Note the age of the pose, as a screen that is drawn now."""
        self.poses.append(self.pose_age_s())

    def live(self):
        """Return whether everything comes in time."""
        return self.pose_age_s() < 0.5 and self.pictures and self.pictures[-1][1] < 1.0

    def forget(self):
        """Count from now on."""
        self.poses, self.pictures = [], []


class Operator:
    """Holds the stick at 20 Hz, and centres it while the screen would ask for that."""

    def __init__(self):
        import rospy
        from mhri.msg import ControlMode, DriveState, RobotSelect
        from sensor_msgs.msg import Joy
        self._joy_class = Joy
        self._joy = rospy.Publisher(graph.PEDAL, Joy, queue_size=1, tcp_nodelay=True)
        self._select = rospy.Publisher(graph.SELECT, RobotSelect, queue_size=1,
                                       latch=True)
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._mode.publish('pedal')
        self.robots = []
        self._drives = {}
        rospy.Subscriber(graph.DRIVE_STATE, DriveState, self._on_state)
        self.holding = False
        # {value: when it was sent}, and how often the stick was held
        self.sent = {}
        self._lock = threading.Lock()
        threading.Thread(target=self._run, daemon=True).start()

    def _on_state(self, message):
        self._drives = {drive.name: drive for drive in message.robots}

    def ready(self):
        """Return whether the robots would move."""
        drives = [self._drives.get(name) for name in self.robots]
        return all(drive is not None and drive.guarded and not drive.stands for drive in drives)

    def stopped(self, name):
        """Return whether the guard of a robot holds a stop."""
        drive = self._drives.get(name)
        return drive is not None and drive.stop_confirmed

    def _run(self):
        import rospy
        try:
            self._drive()
        except rospy.ROSException:  # the topics are closed at the end
            pass

    def _drive(self):
        number, due = 0, time.monotonic()
        while True:
            if number % 10 == 0:
                self._select.publish(robots=self.robots)
            number += 1
            with self._lock:
                stick = (0.0, 0.0)
                if self.holding and self.ready():
                    stick = (TURN, LEAST + STEP * (number % VALUES))
                    self.sent[round(stick[1], 4)] = time.monotonic()
                self._joy.publish(self._joy_class(axes=stick))
            due = max(due + STICK_S, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))

    def hold(self):
        """Hold the stick from now on."""
        with self._lock:
            self.sent, self.holding = {}, True

    def let_go(self):
        """Let go; return when."""
        with self._lock:
            self.holding = False
            return time.monotonic()


class World:
    """The whole of it; use it as a context manager.

    :param ways: of :data:`WAYS`
    :param robots: how many there are of each
    :param guard: options of their guards
    """

    def __init__(self, ways, robots, guard=()):
        self._guard = list(guard)
        self.names = {way: [WAYS[way] + str(number) for number in range(1, robots + 1)]
                      for way in ways}
        self.shown = {name: Shown(name) for names in self.names.values() for name in names}
        self._ears = {}
        #: folders with the keys of all, also of a host ``gallery`` that only watches
        self.keys = {}
        self._folder = tempfile.TemporaryDirectory()
        self.far = Place()
        self.radio = BadRadio(self.far)
        self.system = System()
        os.environ.update(ROS_MASTER_URI='http://{}:{}'.format(NEAR_IP, self.system.port),
                          ROS_IP=NEAR_IP)
        self.system.env.update(ROS_MASTER_URI=os.environ['ROS_MASTER_URI'], ROS_IP=NEAR_IP)

    def __enter__(self):
        return self

    def __exit__(self, failure, *_):
        import rospy
        rospy.signal_shutdown('measured')
        self.system.__exit__(failure)
        self.radio.close()
        self.far.close()
        self._folder.cleanup()

    def _words(self, way, *words):
        """Return the command line of a process beside the robots of a way."""
        master = [] if way == TCPROS else [
            'ROS_MASTER_URI=http://{}:{}'.format(FAR_IP, FAR_MASTER)]
        return self.far.command('env', 'ROS_IP=' + FAR_IP, *master, *words)

    def start(self):
        """Start everything."""
        import rospy
        self.system.start_master()
        rospy.init_node('bench_radio', disable_signals=True)
        if set(self.names) - {TCPROS}:
            self.system.start(*self.far.command('env', 'ROS_IP=' + FAR_IP, 'rosmaster', '--core',
                                                '-p', str(FAR_MASTER)))
        self.system.node('mux')
        self._make_keys([name for way in SECRET for name in self.names.get(way, [])])
        port = FIRST_PORT
        for way, names in self.names.items():
            subprocess.run(self._words(way, sys.executable, '-c', TYPES, *names), check=True,
                           timeout=TIMEOUT_S, env=self.system.env)
            for name, (x_m, y_m) in zip(names, PLACES):
                self._start_robot(way, name, x_m, y_m)
                if way != TCPROS:
                    self._link(way, name, port)
                    port += 1
            self._ears[way] = subprocess.Popen(
                self._words(way, sys.executable, HERE, *names), env=self.system.env,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, universal_newlines=True)
        self.operator = Operator()
        threading.Thread(target=self._show, daemon=True).start()

    def _start_robot(self, way, name, x_m, y_m):
        self.system.start(*self._words(
            way, 'ROS_NAMESPACE=' + name, sys.executable, '-c',
            'from mhri.nodes.sim_robot import main; main()', '__name:=base',
            '_x:={}'.format(x_m), '_y:={}'.format(y_m)))
        self.system.start(*self._words(way, 'ROS_NAMESPACE=' + name, sys.executable, GUARD,
                                       '_command:=' + COMMAND, *self._guard))

    def _make_keys(self, robots):
        """Make keys for the host and for robots, if there are any."""
        if robots:
            authority = Authority(Path(self._folder.name))
            for words in [('host', 'lab'), ('host', 'gallery', '--watch'), ('router', 'hub')] + [
                    ('robot', name) for name in robots]:
                authority.run(*words)
            self.keys = {name: authority.put(name) for name in ['lab', 'gallery', 'hub'] + robots}

    def _link(self, way, name, port):
        endpoint = '{}/{}:{}'.format('tls' if way in ROUTED else way,
                                     ROUTED.get(way, FAR_IP), port)
        listens, calls = ('--router', '--router') if way in ROUTED else ('--listen', '--connect')
        keys = [str(self.keys[who]) if way in SECRET else 'off' for who in (name, 'lab')]
        link = [sys.executable, '-c', 'from mhri.nodes.mhri_link import main; main()', '--side']
        if way in ROUTED:
            hub = link + ['router', '--listen', endpoint, '--keys', str(self.keys['hub'])]
            self.system.start(*hub if way == 'router_near' else self._words(way, *hub))
        self.system.start(*self._words(way, *link, 'robot', '--name', name, listens, endpoint,
                                       '--keys', keys[0], '__ns:=/' + name))
        self.system.node('mhri_link', '--side', 'host', '--name', name, calls, endpoint,
                         '--keys', keys[1], '__ns:=/' + name)

    def _show(self):
        while True:
            for shown in self.shown.values():
                shown.show()
            time.sleep(SHOW_S)

    def at_the_robots(self, way):
        """Return {robot: ([(when, m/s, rad/s)], [(when, x, y)])} since the last call."""
        ears = self._ears[way]
        ears.stdin.write('\n')
        ears.stdin.flush()
        return json.loads(ears.stdout.readline())

    def look(self, way):
        """Select the robots of a way, and look at them."""
        self.operator.robots = self.names[way]
        for name in self.names[way]:
            self.shown[name].look()

    def look_away(self, way):
        """Leave them alone."""
        self.operator.robots = []
        for name in self.names[way]:
            self.shown[name].look_away()

    def settle(self, way):
        """Wait on a clean cable until all is well."""
        self.radio.follow([{'at_s': 0}])
        looked = [self.shown[name] for name in self.names[way]]
        wait_for(lambda: self.operator.ready() and all(shown.live() for shown in looked)
                 and all(been for _, been in self.at_the_robots(way).values()),
                 TIMEOUT_S, 'the robots by ' + way, poll_s=0.1)

    def measure(self, way, row, outage_s, drive_s):
        """Return (figures of one case, what the radio did).

        The radio stays as it is for the next case: :meth:`settle` cleans the cable.
        """
        table = [dict(row, at_s=0)]
        if outage_s:
            table += [{'at_s': drive_s, 'down': True}, {'at_s': drive_s + outage_s, 'down': False}]
        self.radio.follow(table)
        begun = time.monotonic()
        # What is on its way under the new conditions has come, as far as they let it.
        time.sleep(0.5 if not outage_s else 0.0)
        looked_at = [self.shown[name] for name in self.names[way]]
        for shown in looked_at:
            shown.forget()
        self.at_the_robots(way)
        looked = time.monotonic()
        self.operator.hold()
        time.sleep(max(0.0, begun + drive_s + (0.1 if outage_s else 0.0) - time.monotonic()))
        gone = self.operator.let_go()
        back = begun + drive_s + outage_s
        # After an outage TCP waits for up to as long again.
        time.sleep(1.5 + (2.0 * outage_s if outage_s < 10.0 else 15.0 + outage_s))
        ended = time.monotonic()
        report = self.radio.follow([dict(row, at_s=0)])
        at = self.at_the_robots(way)
        figures = self._of_commands([told for told, _ in at.values()], gone - looked)
        pictures = [shown.pictures for shown in looked_at]
        figures.update(
            poses=[age for shown in looked_at for age in shown.poses],
            pictures=[age for found in pictures for _, age, _ in found],
            rate_hz=sum(map(len, pictures)) / len(pictures) / (ended - looked),
            gap_s=max(longest_gap(found, looked, ended) for found in pictures),
            picture_bytes=sorted(size for found in pictures for _, _, size in found),
            motion_m=max(path_m(been, gone) for _, been in at.values()),
            back_m=max(path_m(been, back) for _, been in at.values()) if outage_s else None)
        return figures, report

    def _of_commands(self, robots, held_s):
        """Return ages of commands obeyed, and the share of the time in which robots drove."""
        ages, drove_s, sent = [], 0.0, self.operator.sent
        for told in robots:
            first = {}
            for when, linear, angular in told:
                if linear and angular:
                    first.setdefault(round(CURVE * linear / angular, 4), when)
            ages += [when - sent[value] for value, when in first.items() if value in sent]
            drove_s += sum(after[0] - before[0] for before, after in zip(told, told[1:])
                           if before[1])
        return {'ages': ages,
                'drove_percent': min(100.0, 100.0 * drove_s / len(robots) / held_s)}


def longest_gap(pictures, since, until):
    """Return the longest time without a picture [s]."""
    times = [since] + [when for when, _, _ in pictures] + [until]
    return max(after - before for before, after in zip(times, times[1:]))


def path_m(been, since):
    """Return how far a robot went after a time."""
    places = [place[1:] for place in been if place[0] >= since]
    return sum(math.hypot(after[0] - before[0], after[1] - before[1])
               for before, after in zip(places, places[1:]))


if __name__ == '__main__':
    ear(sys.argv[1:])
