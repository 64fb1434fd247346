# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A lab on one computer: a host and two robots (``machines.py``), their ssh, and an operator."""
import fcntl
import math
import os
from pathlib import Path
import pty
import signal
import subprocess
import sys
import termios
import threading

import cv2

from support import graph
from support import machines
from support.paths import SUPPORT
from support.ros_system import System, wait_for

HOST_SCRIPTS = Path(__file__).resolve().parents[2] / 'utils' / 'host'
START_S = LONG_S = 300.0
KINDS = {'bot1': ('--type', 'turtlebot2'), 'bot2': ('--type', 'turtlebot3', '--no-guard')}
COMMANDS = {'bot1': 'teleop/input', 'bot2': 'cmd_vel'}
GUARDED = ('bot1',)
# Two or three commands were on their way, and a guard obeys what is less than a second old; the
# zero is right behind them. Without a guard it may come with a later try of TCP, where the answer
# to the first is lost as the link comes up; by then the watchdog ends it (0.5 s at 0.22 m/s) [m].
STRAYED_M = {'bot1': 0.06, 'bot2': 0.12}
# What of turtle_remote.sh's runs on a robot.
RUNNING = ('turtle_remote', 'roslaunch', 'roscore', 'rosmaster', 'sim_robot', 'nodelet',
           'mhri_guard', 'mhri_link', 'colour_camera')


class Terminal:
    """A command in a terminal of its own, as an operator has it."""

    def __init__(self, command, env, log):
        self.log = log
        self._master, slave = pty.openpty()
        self.process = subprocess.Popen(
            command, env=env, stdin=slave, stdout=slave, stderr=slave, start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        os.close(slave)
        self._thread = threading.Thread(target=self._copy, daemon=True)
        self._thread.start()

    def _copy(self):
        with self.log.open('ab', buffering=0) as file:
            while True:
                try:
                    data = os.read(self._master, 4096)
                except OSError:
                    return  # the terminal is closed, from one side or the other
                if not data:
                    return
                file.write(data)

    def text(self):
        return self.log.read_text(errors='replace')

    def press(self, key):
        os.write(self._master, key)

    def close(self):
        """Close the window, as it were; nobody asks the command."""
        if self._master is not None:
            self.process.send_signal(signal.SIGHUP)
            self._thread.join(20)
            os.close(self._master)
            self._master = None


class Lab:
    """The host with its master and panel, two robots, and an operator's ssh."""

    def __init__(self, lan, system, folder):
        self.lan, self.system, self.folder = lan, system, folder
        self.robots = {'bot1': lan.robot('bot1'), 'bot2': lan.robot('bot2')}
        self.terminals = []
        self._observers = {}
        self.known_hosts = folder / 'known_hosts'
        self.asked = folder / 'asked'
        self._make_ssh()
        for robot in self.robots.values():
            robot.start_sshd(folder / 'id.pub')

    def _make_ssh(self):
        """Give the operator an ssh of his own: its files are here, and nowhere else."""
        machines.run('ssh-keygen', '-q', '-t', 'ed25519', '-N', '', '-f', str(self.folder / 'id'))
        self.known_hosts.touch()
        self.asked.touch()
        (self.folder / 'config').write_text(
            'Host *\nUserKnownHostsFile {0}/known_hosts\nGlobalKnownHostsFile none\n'
            'IdentityFile {0}/id\nIdentitiesOnly yes\nIdentityAgent none\n'.format(self.folder))
        tools = self.folder / 'bin'
        tools.mkdir()
        for name, text in (
                ('ssh', 'exec /usr/bin/ssh -F "{}/config" "$@"'),
                ('askpass', 'echo "$1" >>"{}/asked"; echo "' + machines.PASSWORD + '"')):
            (tools / name).write_text('#!/bin/sh\n' + text.format(self.folder) + '\n')
            (tools / name).chmod(0o755)
        self.env = dict(self.system.env, PATH='{}:/usr/bin:/bin:/usr/sbin:/sbin'.format(tools),
                        TMPDIR=str(self.folder))

    def trust(self, robot, key=None):
        """Have the operator know a robot's key (or take another for it)."""
        public = (key or robot.folder / 'host_key').with_suffix('.pub').read_text().split()
        with self.known_hosts.open('a') as file:
            file.write('{} {} {}\n'.format(robot.ip, public[0], public[1]))

    def deploy(self, name, *arguments, password=False):
        """Return (exit status, output) of the deployment to a robot."""
        env = dict(self.env)
        if password:
            env.update(SSH_ASKPASS=str(self.folder / 'bin' / 'askpass'), DISPLAY=':none',
                       SSH_ASKPASS_REQUIRE='force')
        done = subprocess.run(
            [str(HOST_SCRIPTS / 'turtlebot_deploy.sh'),
             '{}@{}'.format(machines.USER, self.robots[name].ip), *arguments],
            env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            universal_newlines=True, start_new_session=True, timeout=120)
        return done.returncode, done.stdout

    def deploy_to_all(self):
        """Have the files on the robots that have none yet."""
        for name, robot in self.robots.items():
            if not (robot.home / 'mhri' / 'turtle_remote.sh').exists():
                status, output = self.deploy(name)
                assert status == 0, output

    def connect(self, name, *arguments):
        """Start a robot from the host, in a terminal."""
        terminal = Terminal(
            [str(HOST_SCRIPTS / 'connect_turtlebot.sh'), machines.USER, self.robots[name].ip, name,
             '--port', str(self.system.port)] + list(arguments),
            self.env, self.folder / 'terminal_{}'.format(len(self.terminals)))
        self.terminals.append(terminal)
        return terminal

    def observer(self, name):
        """Return :meth:`observe` of a robot, of which there is one."""
        if name not in self._observers:
            self._observers[name] = self.observe(name)
        return self._observers[name]

    def observe(self, name):
        """Return a function that returns the rows of a robot's observer, of 5 or of 3 numbers."""
        robot = self.robots[name]
        log = robot.folder / 'observed'
        setup = '. {}/catkin_ws/devel/setup.bash && exec "$0" "$@"'.format(robot.home)
        with log.open('w') as file:
            subprocess.Popen(
                robot.command('env', 'ROS_IP=' + robot.ip, 'bash', '-c', setup, sys.executable,
                              str(SUPPORT / 'observer.py'), name, COMMANDS[name]),
                env=self.system.env, stdin=subprocess.DEVNULL, stdout=file,
                stderr=(robot.folder / 'observer.log').open('w'))

        def rows(width=5):
            lines = [line.split() for line in log.read_text().splitlines(True) if line[-1] == '\n']
            return [tuple(map(float, words)) for words in lines if len(words) == width]
        wait_for(rows, START_S, 'the odometry of ' + name, poll_s=0.1)
        return rows

    def screen(self):
        """Return what is on the operator's screen: red, green, blue, (h, w, 3)."""
        path = str(self.folder / 'screen.png')
        subprocess.run(['import', '-window', 'root', path], env=self.system.env, check=True,
                       timeout=30)
        return cv2.imread(path)[..., ::-1]

    def tell(self):
        """Print the end of what everybody said: to explain a failure far away."""
        for log in sorted(Path(self.system.home).glob('*.log')) + [
                terminal.log for terminal in self.terminals]:
            print('\n--- {}\n{}'.format(log, log.read_text(errors='replace')[-3000:]))

    def close(self):
        for terminal in self.terminals:
            terminal.close()
            if terminal.process.poll() is None:
                terminal.process.kill()
            terminal.process.wait(20)


def running_lab(request, folder, trusted=False):
    """Yield a :class:`Lab`, for a fixture; what everybody said is printed if a test fails.

    :param trusted: whether the operator knows the robots' keys
    """
    with machines.Lan(folder) as lan, System(ip=machines.HOST_IP) as system:
        system.start_master()
        built = Lab(lan, system, folder)
        for robot in built.robots.values() if trusted else ():
            built.trust(robot)
        failed = request.session.testsfailed
        yield built
        if request.session.testsfailed > failed:
            built.tell()
        built.close()


class Operator:
    """Mux and panel on the host, both robots selected, and a stick."""

    def __init__(self, lab):
        import rospy
        from mhri.msg import ControlMode
        from support.fake_mux import StateEar
        from support.robots import Stick, Witness
        self.lab, self.system = lab, lab.system
        self.system.screen()
        # As the node of the pedal: it may choose the mode.
        rospy.init_node('mhri_pedal', disable_signals=True)
        self.system.node('mux', '__name:=mux')
        self.system.node('panel', '--fresh', '--select', 'bot1 bot2', '__name:=mhri_panel')
        self.witnesses = {name: Witness(name) for name in ('bot1', 'bot2')}
        self.stick, self.state = Stick(), StateEar()
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._mode.publish('pedal')

    def start_robots(self):
        """Start both robots, with their files; return {name: terminal}."""
        self.lab.deploy_to_all()
        terminals = {name: self.lab.connect(name, *words) for name, words in KINDS.items()}

        def live():
            for terminal in terminals.values():
                assert terminal.process.poll() is None, terminal.text()
            return all(witness.live() for witness in self.witnesses.values())
        wait_for(live, START_S, lambda: str([
            terminal.text() for terminal in terminals.values()]), poll_s=0.1)
        return terminals

    def drive(self, *names):
        """Drive in a circle; return when these robots do."""
        self.stick.drive(0.2, 0.6, lambda: all(self.witnesses[name].moving() for name in names),
                         START_S, '{} to be driven'.format(' and '.join(names)))

    def close(self):
        """Let go of the stick and leave the graph."""
        import rospy
        self.stick.silence()
        rospy.signal_shutdown('done')


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


def left(robot):
    """Return what of turtle_remote.sh's runs on a robot."""
    return [line for text in RUNNING for line in robot.processes(text)]


def await_quiet(robot):
    """Wait until nothing of turtle_remote.sh's runs on a robot any more."""
    wait_for(lambda: not left(robot), LONG_S, lambda: 'the robot to be quiet; left: ' + '\n'.join(
        left(robot)), poll_s=0.2)
