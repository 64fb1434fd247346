# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A host and three robots, each on a computer and a ROS master of its own, joined by mhri_link.

Computers are network namespaces. Every program is a process that can be killed and started again,
alone. What a robot is told, and which commands its guard obeys, it writes down itself.
"""
import os
import sys
import time
import uuid
import xmlrpc.client

import psutil

from support import graph
from support import machines
from support.authority import Authority
from support.fake_mux import FakeOperator, StateEar
from support.random_world import GUARD, HERE
from support.robots import RobotLog
from support.ros_system import free_port, node_words, System, wait_for

# As respawn="true" in a launch file.
RESTARTER = 'trap exit INT TERM; until "$@"; do sleep 0.1; done'
# Slow computers start slowly.
LONG_S = 90.0
# Name on the host: (robot_type, model, velocity topics, namespace on its own master, lane y [m]).
ROBOTS = {'bot1': ('turtlebot2', '', ('teleop/input', 'cmd_vel_mux/input/teleop'), 'bot1', 1.0),
          'bot2': ('turtlebot3', 'waffle', ('cmd_vel',), 'bot2', 2.1),
          # A robot that calls itself by another name.
          'bot3': ('turtlebot3', 'burger', ('cmd_vel',), 'turtle', 3.2)}
LANE_M = 5.0
# This one and the host call a router.
ROUTED = 'bot3'
OF_HOST = ('master', 'mux', 'tasks', 'router') + tuple('link_' + name for name in ROBOTS)
OF_ROBOT = ('master', 'base', 'guard', 'link')
# What a robot needs no restart of: it is the robot.
KEPT = ('base',)


class ToldRobot(RobotLog):
    """And which commands its guard obeyed first when."""

    def told_since(self, since):
        """Return the rows in which it was told to move."""
        return [row for row in self.after(since) if any(row[1:])]

    def obeyed(self):
        """Return {frame_id of a command without its token: when the guard first said so [s]}."""
        found = {}
        with open(self.path + '.echo') as log:
            for line in log:
                if line.endswith('\n'):
                    at, key = line.split()
                    found.setdefault(key, float(at))
        return found


class Masters:
    """The whole of it; use it as a context manager.

    :param lan: :class:`support.machines.Lan`, of which this process is the host
    :param keys: whether they are linked by keys
    """

    def __init__(self, lan, keys=False):
        self.folder = lan.folder
        self.port = free_port()
        self._protocol = 'tls' if keys else 'tcp'
        self._router = ['--router', '{}/{}:{}'.format(self._protocol, machines.HOST_IP,
                                                      free_port())]
        self._keys = self._make_keys() if keys else {}
        self.host = System(ip=machines.HOST_IP)
        self.computers = {name: machines.Computer(11 + number)
                          for number, name in enumerate(ROBOTS)}
        self.logs = {name: ToldRobot(str(self.folder / name)) for name in ROBOTS}
        self.processes = {}
        self.state = None
        self.sent = {}
        self._envs = {place: {'ROS_IP': ip, 'ROS_MASTER_URI': 'http://{}:{}'.format(
            ip, self.host.port)} for place, ip in self.ips()}

    def _make_keys(self):
        """Return {place: the folder with its key}."""
        authority = Authority(self.folder)
        names = {'host': 'lab', 'router': 'hub', **{name: name for name in ROBOTS}}
        for place, name in names.items():
            authority.run(place if place in ('host', 'router') else 'robot', name)
        return {place: authority.put(name) for place, name in names.items()}

    def ips(self):
        """Return [(place, address)] of the host and the robots."""
        return [('host', machines.HOST_IP)] + [(name, computer.ip)
                                               for name, computer in self.computers.items()]

    def __enter__(self):
        for place, _ in self.ips():
            self.start(place, 'master')
        for name, (kind, model, _, space, _) in ROBOTS.items():
            api = self.master_of(name)
            for key, value in (('robot_type', kind), ('robot_model', model)):
                if value:
                    api.setParam('/test', '/{}/{}'.format(space, key), value)
        for place, part in self.parts():
            if part != 'master':
                self.start(place, part)
        return self

    def __exit__(self, *_):
        for key in self.processes:
            self.kill(*key)
        self.host.close()
        for computer in self.computers.values():
            computer.close()

    def tell(self):
        """Print the end of what each program said: to explain a failure far away."""
        for (place, part), process in self.processes.items():
            text = (self.folder / '{}_{}.log'.format(place, part)).read_text(errors='replace')
            print('\n--- {} {}: {}\n{}'.format(place, part, process.poll(), text[-1500:]))
        for place, _ in self.ips():
            state = self.master_of(place).getSystemState('/test')[2] if self._answers(place) else ''
            print('\n--- master of {}: {}'.format(place, state))

    @staticmethod
    def parts():
        """Return [(place, part)] of all programs."""
        return [('host', part) for part in OF_HOST] + [
            (name, part) for name in ROBOTS for part in OF_ROBOT]

    def master_of(self, place):
        """Return a proxy of a place's master."""
        return xmlrpc.client.ServerProxy(self._envs[place]['ROS_MASTER_URI'])

    def _words(self, place, part):
        """Return (command line, what its environment has beside) of a program."""
        if part == 'master':
            return ['rosmaster', '--core', '-p', str(self.host.port)], {}
        link = node_words('mhri_link', '--keys', str(
            self._keys['router' if part == 'router' else place]) if self._keys else 'off')
        if part.startswith('link_'):
            name = part[5:]
            where = ['--connect', '{}/{}:{}'.format(self._protocol, self.computers[name].ip,
                                                    self.port)]
            return link + ['--side', 'host', '--name', name] + (
                self._router if name == ROUTED else where), {'ROS_NAMESPACE': '/' + name}
        if part == 'router':
            return link + ['--side', 'router', '--listen', self._router[1]], {}
        if place == 'host':
            return node_words(part), {}
        _, _, topics, space, y_m = ROBOTS[place]
        words = {
            'base': [sys.executable, str(HERE / 'logged_sim.py'), self.logs[place].path, *topics,
                     '_x:="{}"'.format(LANE_M), '_y:="{}"'.format(y_m), '_yaw:="0.0"',
                     '_placed:=true', '_seed:=1'],
            'guard': [sys.executable, GUARD, '_command:=' + topics[0]],
            'link': link + ['--side', 'robot', '--name', place, '--namespace', space] + (
                self._router if place == ROUTED else
                ['--listen', '{}/0.0.0.0:{}'.format(self._protocol, self.port)])}[part]
        return words, {'ROS_NAMESPACE': '/' + space}

    def start(self, place, part):
        """Start a program; returns when a master answers, else at once."""
        words, more = self._words(place, part)
        if part != 'master':
            # As its launch file does: started before its master, it may end at once.
            words = ['bash', '-c', RESTARTER, 'restarter'] + words
        if place != 'host':
            words = self.computers[place].command(*words)
        self.processes[place, part] = self.host.start(
            *words, log=str(self.folder / '{}_{}.log'.format(place, part)),
            env={**self._envs[place], **more})
        if part == 'master':
            wait_for(lambda: self._answers(place), LONG_S, 'the master of ' + place, 0.05)
            # As roscore does.
            self.master_of(place).setParam('/test', '/run_id', str(uuid.uuid1()))

    def _answers(self, place):
        try:
            return self.master_of(place).getPid('/test')[0] == 1
        except (OSError, xmlrpc.client.Error):
            return False

    def kill(self, place, part):
        """End a program with SIGKILL."""
        self.host.kill(self.processes[place, part])
        if part == 'mux' and self.state is not None:
            # What it said last counts no more.
            self.state.at = None

    def sizes(self):
        """Return {program: (its process, MB, threads, files and sockets, sockets, lines said)}."""
        found = {}
        for (place, part), process in self.processes.items():
            # bash that starts it again, in it the program.
            for one in psutil.Process(process.pid).children(recursive=True)[-1:]:
                files = '/proc/{}/fd/'.format(one.pid)
                links = [os.readlink(files + name) for name in os.listdir(files)
                         if os.path.islink(files + name)]
                text = (self.folder / '{}_{}.log'.format(place, part)).read_bytes()
                found[place + ' ' + part] = (
                    one.pid, one.memory_info().rss * 1e-6, one.num_threads(), len(links),
                    sum(link.startswith('socket:') for link in links), text.count(b'\n'))
        return found

    # The operator.

    def join(self):
        """Make this process the operator of all robots, and an ear beside the mux."""
        import rospy
        from geometry_msgs.msg import TwistStamped
        from mhri.graph.ros.master_watch import MasterWatch
        from mhri.msg import ControlMode
        from std_msgs.msg import String
        from support.robots import Stick, Witness
        # As the node of the pedal: it may choose the mode.
        rospy.init_node('mhri_pedal', disable_signals=True)
        MasterWatch().start()
        self.state = StateEar()
        self.operator = FakeOperator()
        self.stick = Stick()
        self.witnesses = {name: Witness(name) for name in ROBOTS}
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._mode.publish('pedal')
        self._ears = [rospy.Subscriber('/{}/mhri_guard/command'.format(name), TwistStamped,
                                       self._note, name, queue_size=100) for name in ROBOTS]
        self.operator.check(*ROBOTS)
        self.fetching = []
        rospy.Subscriber('/bot2/mhri_link/fetching', String,
                         lambda message: self.fetching.append(message.data))

    def keep(self, name):
        """Have a robot record what the host misses."""
        import rospy
        from std_srvs.srv import SetBool
        service = '/{}/mhri_link/keep'.format(name)
        rospy.wait_for_service(service, LONG_S)
        assert rospy.ServiceProxy(service, SetBool)(True).success

    def keeps(self, name):
        """Return whether a robot records."""
        folder = os.path.join(self.host.home, 'mhri', 'link', name, 'kept', 'open')
        return os.path.isdir(folder) and any(
            os.path.getsize(os.path.join(folder, file)) > 5000 for file in os.listdir(folder))

    def _note(self, message, name):
        """Keep when a command was made."""
        made_s = message.header.stamp.to_sec()
        moves = bool(message.twist.linear.x or message.twist.angular.z)
        self.sent[name, message.header.frame_id.rpartition(':')[0]] = (made_s, moves)

    def row(self, name):
        """Return what the mux says of a robot now, None if it is old."""
        fresh = self.state.at is not None and time.monotonic() - self.state.at < 1.5
        return self.state.robot(name) if fresh else None

    def turns(self, name):
        """Return whether a robot is told to turn, and does."""
        told, moved = (self.logs[name].rows(what)[-1:] for what in ('told', 'moved'))
        return bool(told and moved) and any(told[0][1:]) and abs(moved[0][2]) > 0.05

    def drive(self, names=tuple(ROBOTS)):
        """Turn robots on the spot together; the mux asks for neutral first."""
        self.stick.drive(0.0, 0.4, lambda: all(map(self.turns, names)), LONG_S,
                         lambda: 'all of {} to turn; {}'.format(
                             names, [self.row(name) for name in names]))

    def stands_from(self, name, since):
        """Wait until a robot was told to stand, or its body does; return when."""
        def stands():
            told = self.logs[name].rows('told')
            if told and told[-1][0] >= since and not any(told[-1][1:]):
                return self.logs[name].stands_from(since, 'told')
            # Whoever would have told it may have been killed: then its own watchdog does it.
            moved = [row for row in self.logs[name].rows('moved') if row[0] >= since][-3:]
            return moved[0][0] if len(moved) == 3 and not any(
                abs(part) > 0.02 for row in moved for part in row[1:]) else None
        return wait_for(stands, LONG_S, name + ' to stand', 0.01)

    def let_go(self):
        """Centre the stick, and wait until all stand."""
        since = time.monotonic()
        self.stick.hold(0.0, 0.0)
        for name in ROBOTS:
            self.stands_from(name, since)

    def waits(self, name, since):
        """See that a robot stays where it is until the stick is let go: the mux asks for that.

        :param since: from when on it was told nothing but to stand
        """
        wait_for(lambda: self.row(name) and self.row(name).guarded, LONG_S,
                 lambda: '{} to be reached: {}'.format(name, self.state.robot(name)), 0.01)
        # What is shown is that nothing happens in this time.
        time.sleep(0.7)
        assert self.logs[name].told_since(since) == [], 'the stick was never let go'

    def oldest(self):
        """Return {robot: age [s] of the oldest command to move that its guard has obeyed}."""
        ages = {}
        for name, log in self.logs.items():
            commands = [(at, self.sent.get((name, key))) for key, at in log.obeyed().items()]
            ages[name] = max((at - command[0] for at, command in commands
                              if command and command[1]), default=0.0)
        return ages


__all__ = ['KEPT', 'LONG_S', 'Masters', 'OF_HOST', 'OF_ROBOT', 'ROBOTS', 'ROUTED']
