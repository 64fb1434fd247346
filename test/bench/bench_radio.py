# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot behind a bad radio: how old is what it obeys, and what the operator is shown of it.

The robot (simulated, with its guard) is in a network namespace of its own; mux, gates, the master
and this process as the operator are in another; between them is the radio of ``support``. What
goes over it: the commands (20 Hz) and what guard and gates tell each other, odometry (50 Hz), IMU
(100 Hz), laser (10 Hz), and the pictures of a camera (jpeg, 30 Hz). Delays are those of one way.

- command: age of a command when the robot first obeyed it, from the stick on; and in what share of
  the time in which the stick was held the robot drove
- pose: age of the newest pose, as often as a screen is drawn (30 Hz)
- pictures: how many came a second, and their age
- motion: how far the robot went after the operator had let go, and after an outage was over; in the
  rows with an outage the operator lets go within it

Below each row is what the radio says that it did. Needs root and /dev/net/tun.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import radio_traffic  # noqa: E402
from support.bad_radio import BadRadio, FAR_IP, NEAR_IP, Place, why_not  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

HERE = os.path.abspath(__file__)
GUARD = os.path.join(os.path.dirname(HERE), '..', '..', 'utils', 'remote', 'mhri_guard')
ROBOT = 'bot1'
COMMAND = '/bot1/teleop/input'
BASE = '/bot1/'
PICTURE = BASE + 'camera/rgb/image_raw/compressed'
IMU, SCAN, ODOMETRY = BASE + 'mobile_base/sensors/imu_data', BASE + 'scan', BASE + 'odom'
STICK_S, SHOW_S = 0.05, 1.0 / 30.0
# Of the stick while it is held: each event has a value of its own, by which it is known again.
LEAST, STEP, VALUES, TURN = 0.2, 0.0005, 1000, 0.6
# The operator's limit makes it so many m/s.
LIMIT_MPS = 0.5
PATIENCE_S = 120.0
CORES_GOAL = 0.3
# (title, radio, length of the outage [s])
GOOD = {'delay_ms': 20, 'jitter_ms': 5, 'rate_mbit': 20}
CASES = (('clean', {}, 0.0),
         ('50 ms, 1 %, 10 Mbit/s', {'delay_ms': 50, 'loss_percent': 1, 'rate_mbit': 10}, 0.0),
         ('200 ms, 5 %, 2 Mbit/s', {'delay_ms': 200, 'loss_percent': 5, 'rate_mbit': 2}, 0.0),
         ('20 ms, outage 0.5 s', GOOD, 0.5), ('20 ms, outage 2 s', GOOD, 2.0))
FULL_CASES = (('200 ms, 20 %, 1 Mbit/s', {'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1},
               0.0), ('20 ms, outage 0.2 s', GOOD, 0.2), ('20 ms, outage 30 s', GOOD, 30.0))


def ear():
    """Be beside the robot: for each line read, print what it was told and where it was since."""
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    rospy.init_node('ear', disable_signals=True)
    told, been = [], []
    rospy.Subscriber(COMMAND, Twist, lambda message: told.append(
        (time.monotonic(), message.linear.x)), tcp_nodelay=True)
    rospy.Subscriber(ODOMETRY, Odometry, lambda message: been.append(
        (time.monotonic(), message.pose.pose.position.x, message.pose.pose.position.y)),
        tcp_nodelay=True)
    for _ in sys.stdin:
        found = told[:], been[:]
        del told[:len(found[0])], been[:len(found[1])]
        print(json.dumps(found), flush=True)
    os._exit(0)


class Shown:
    """What comes to the operator's computer: the newest pose, pictures, and other sensors."""

    def __init__(self):
        import rospy
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import CompressedImage, Imu, LaserScan
        self._pose_s = None
        self.poses, self.pictures = [], []
        keep = {'queue_size': 1, 'buff_size': 2 ** 22, 'tcp_nodelay': True}
        rospy.Subscriber(ODOMETRY, Odometry, self._on_pose, **keep)
        rospy.Subscriber(PICTURE, CompressedImage, self._on_picture, **keep)
        for topic, kind in ((IMU, Imu), (SCAN, LaserScan)):
            rospy.Subscriber(topic, kind, lambda message: None, **keep)
        threading.Thread(target=self._show, daemon=True).start()

    def _on_pose(self, message):
        self._pose_s = message.header.stamp.to_sec()

    def _on_picture(self, message):
        self.pictures.append(time.time() - message.header.stamp.to_sec())

    def pose_age_s(self):
        """Return how old the pose is; infinite before the first."""
        return math.inf if self._pose_s is None else time.time() - self._pose_s

    def _show(self):
        while True:
            self.poses.append(self.pose_age_s())
            time.sleep(SHOW_S)

    def forget(self):
        """Count from now on."""
        self.poses, self.pictures = [], []


class Operator:
    """Holds the stick at 20 Hz, and centres it while the screen would ask for that."""

    def __init__(self):
        import rospy
        from mhri.msg import ControlMode, GatesState, RobotSelect
        from sensor_msgs.msg import Joy
        self._joy_class = Joy
        self._joy = rospy.Publisher('/mux_in/pedal', Joy, queue_size=1, tcp_nodelay=True)
        self._select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1,
                                       latch=True)
        self._mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=1, latch=True)
        self._mode.publish('pedal')
        self.gate = None
        rospy.Subscriber('/gates/state', GatesState, self._on_state)
        self.holding = False
        # {value: when it was sent}, and how often the stick was held
        self.sent = {}
        self.events = 0
        self._lock = threading.Lock()
        threading.Thread(target=self._run, daemon=True).start()

    def _on_state(self, message):
        self.gate = next((gate for gate in message.robots if gate.name == ROBOT), None)

    def ready(self):
        """Tell whether the robot would move."""
        return self.gate is not None and self.gate.guarded and not self.gate.stands

    def _run(self):
        number, due = 0, time.monotonic()
        while True:
            if number % 10 == 0:
                self._select.publish([ROBOT])
            number += 1
            with self._lock:
                stick = (0.0, 0.0)
                if self.holding:
                    self.events += 1
                    if self.ready():
                        stick = (TURN, LEAST + STEP * (number % VALUES))
                        self.sent[round(LIMIT_MPS * stick[1], 6)] = time.monotonic()
                self._joy.publish(self._joy_class(axes=stick))
            due = max(due + STICK_S, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))

    def hold(self):
        """Hold the stick from now on."""
        with self._lock:
            self.sent, self.events, self.holding = {}, 0, True

    def let_go(self):
        """Let go; return when."""
        with self._lock:
            self.holding = False
            return time.monotonic()


class World:
    """The whole of it; use it as a context manager."""

    def __init__(self):
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

    def there(self, *words):
        """Start a process beside the robot."""
        return self.system.start(*self.far.command(
            'env', 'ROS_IP=' + FAR_IP, 'ROS_NAMESPACE=' + ROBOT, *words))

    def start(self):
        """Start everything and wait until the robot can be driven."""
        import rospy
        self.system.start_master()
        rospy.init_node('bench_radio', disable_signals=True)
        rospy.set_param('/{}/robot_type'.format(ROBOT), 'turtlebot2')
        for key, value in (('x', '6.0'), ('y', '2.1')):
            rospy.set_param('/{}/base/{}'.format(ROBOT, key), value)
        self.system.node('mux')
        self.system.node('gates')
        self.there(sys.executable, '-c', 'from mhri.nodes.sim_robot import main; main()',
                   '__name:=base')
        self.there(sys.executable, GUARD, '_command:=teleop/input')
        self._ear = subprocess.Popen(
            self.far.command('env', 'ROS_IP=' + FAR_IP, sys.executable, HERE, '--ear'),
            env=self.system.env, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            universal_newlines=True)
        self.shown, self.operator = Shown(), Operator()
        self.settle()

    def at_the_robot(self):
        """Return ([(when, m/s)], [(when, x, y)]) of the robot since the last call."""
        self._ear.stdin.write('\n')
        self._ear.stdin.flush()
        return json.loads(self._ear.stdout.readline())

    def settle(self):
        """Wait on a clean cable until all is well."""
        self.radio.follow([{'at_s': 0}])
        wait_for(lambda: self.operator.ready() and self.shown.pose_age_s() < 0.5
                 and self.shown.pictures and self.shown.pictures[-1] < 1.0
                 and self.at_the_robot()[1], PATIENCE_S, 'the robot', poll_s=0.1)
        self.shown.forget()

    def measure(self, row, outage_s, drive_s):
        """Return the figures of one case, and what the radio did."""
        table = [dict(row, at_s=0)]
        if outage_s:
            table += [{'at_s': drive_s, 'down': True}, {'at_s': drive_s + outage_s, 'down': False}]
        self.radio.follow(table)
        begun = time.monotonic()
        # What is on its way under the new conditions has come, as far as they let it.
        time.sleep(0.5 if not outage_s else 0.0)
        self.shown.forget()
        self.at_the_robot()
        looked = time.monotonic()
        self.operator.hold()
        time.sleep(max(0.0, begun + drive_s + (0.1 if outage_s else 0.0) - time.monotonic()))
        gone = self.operator.let_go()
        back = begun + drive_s + outage_s
        # After an outage TCP waits for up to as long again.
        time.sleep(1.5 + (2.0 * outage_s if outage_s < 10.0 else 15.0 + outage_s))
        took_s = time.monotonic() - looked
        report = self.radio.follow([{'at_s': 0}])
        told, been = self.at_the_robot()
        figures = self._of_commands(told, gone - looked)
        figures.update(poses=self.shown.poses, pictures=self.shown.pictures, took_s=took_s,
                       motion_m=path_m(been, gone),
                       back_m=path_m(been, back) if outage_s else None)
        return figures, report

    def _of_commands(self, told, held_s):
        """Return ages of commands obeyed, and the share of the time in which the robot drove."""
        first = {}
        for when, value in told:
            first.setdefault(round(value, 6), when)
        sent = self.operator.sent
        ages = [when - sent[value] for value, when in first.items() if value in sent]
        drove_s = sum(after[0] - before[0] for before, after in zip(told, told[1:]) if before[1])
        return {'ages': ages, 'drove_percent': min(100.0, 100.0 * drove_s / held_s)}


def path_m(been, since):
    """Return how far a robot went after a time."""
    places = [place[1:] for place in been if place[0] >= since]
    return sum(math.hypot(after[0] - before[0], after[1] - before[1])
               for before, after in zip(places, places[1:]))


def triple(values):
    """Return median, p95 and worst of times [s] as they are printed [ms]."""
    if not values:
        return '{:>6} {:>6} {:>6}'.format('-', '-', '-')
    values = sorted(values)
    return '{:>6.0f} {:>6.0f} {:>6.0f}'.format(*(1000.0 * value for value in (
        values[len(values) // 2], values[min(len(values) - 1, int(0.95 * len(values)))],
        values[-1])))


def lines(title, figures, report):
    """Return the lines of one case."""
    back = '-' if figures['back_m'] is None else '{:.3f}'.format(figures['back_m'])
    found = ['{:<24}{:<7} {:>4.0f}%{} |{} |{:>5.1f}{} | {:>6.3f} {:>6}'.format(
        title, 'TCPROS', figures['drove_percent'], triple(figures['ages']),
        triple(figures['poses']), len(figures['pictures']) / figures['took_s'],
        triple(figures['pictures']), figures['motion_m'], back),
        '{:<24}{:<7} not measured'.format('', 'link')]
    for row in report['rows']:
        for name, did in row['did'].items():
            if not row['told']['down'] and did['passed']:
                found.append(
                    '    {}: {packets} packets, lost {lost_percent:.1f} %, queue full {queue_full},'
                    ' down {down}, delay {delay_p50_ms:.1f}, {delay_p95_ms:.1f} ms (p50, p95), '
                    '{bytes_per_s:.0f} bytes/s'.format(name, **did))
    return found


def throughput(world, seconds):
    """Return a line: what the radio itself needs at 30 Mbit/s."""
    answers = subprocess.Popen(
        world.far.command(sys.executable, radio_traffic.__file__, 'answer', FAR_IP),
        stdout=subprocess.PIPE, universal_newlines=True)
    answers.stdout.readline()
    world.radio.follow([{'at_s': 0, 'rate_mbit': 30, 'delay_ms': 5}])
    subprocess.run([sys.executable, radio_traffic.__file__, 'tcp', FAR_IP, '--count',
                    str(int(seconds * 30e6 / 8))], stdout=subprocess.PIPE, check=True)
    report = world.radio.follow([{'at_s': 0}])
    answers.kill()
    answers.wait(20)
    answers.stdout.close()
    return 'the radio itself, one TCP stream: {:.1f} Mbit/s, {:.2f} cores (goal at 30: {}, {})'\
        .format(report['rows'][0]['did']['to far']['bytes_per_s'] * 8e-6, report['cores'],
                CORES_GOAL, 'met' if report['cores'] <= CORES_GOAL else 'NOT met')


def main():
    """Run the benchmark, or be a part of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer cases, less time for each')
    parser.add_argument('--ear', action='store_true', help=argparse.SUPPRESS)
    parser.add_argument('--inside', action='store_true', help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.ear:
        ear()
    if not options.inside:
        reason = why_not()
        if reason:
            print('not measured: ' + reason)
            return
        # A network of our own, so that the radio's addresses meet nobody else's.
        os.execvp('unshare', ['unshare', '--net', sys.executable, HERE, '--inside'] + sys.argv[1:])
    subprocess.run(['ip', 'link', 'set', 'lo', 'up'], check=True)
    with World() as world:
        print(throughput(world, 2.0 if options.short else 10.0), flush=True)
        world.start()
        print('{:<31} {:^25} |{:^21} |{:^26} | {}'.format(
            '', 'command obeyed [ms]', 'pose shown [ms]', 'pictures [1/s, ms]', 'motion [m]'))
        print('{:<31} drove{:>6} {:>6} {:>6} |{:>6} {:>6} {:>6} |{:>5}{:>6} {:>6} {:>6} | {:>6} '
              '{:>6}'.format('', *('p50', 'p95', 'max') * 2, '', 'p50', 'p95', 'max', 'let go',
                             'back'))
        for number, (title, row, outage_s) in enumerate(
                CASES + (() if options.short else FULL_CASES)):
            if number:
                world.settle()
            print('\n'.join(lines(title, *world.measure(
                row, outage_s, 2.0 if options.short else 20.0))), flush=True)


if __name__ == '__main__':
    main()
