# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A small real system to be attacked: mux, the panel's backend, two robots and one stick.

All are processes of their own, so that the attacker's work delays nothing but the attacks. The
stick only ever drives straight ahead: whatever else a robot is told, nobody commanded.
"""
import itertools
import os
import subprocess
import sys
import time

import psutil
import rosgraph

from support import graph
from support.robots import RobotLog
from support.ros_system import insist, System, tell, TIMEOUT_S, wait_for

HERE = os.path.dirname(os.path.abspath(__file__))
ROBOTS = ('bot1', 'bot2')
# Of the template "generic", and of float arithmetic.
FASTEST_MPS = 0.5 + 1e-9
STOP_S = 0.05


class Process:
    """One program of the system and what it must not do: die, grow, or write without end."""

    def __init__(self, name, popen):
        self.name, self.popen = name, popen
        self._process = psutil.Process(popen.pid)

    def sizes(self):
        """Return (memory [MB], threads, descriptors): of the drive, not of who stands by for it."""
        drives = self._process.children() if self.name == 'mux' else ()
        process = next(iter(drives), self._process)
        return process.memory_info().rss / 1e6, process.num_threads(), process.num_fds()

    def lines(self):
        """Return how many lines it has written."""
        with open(self.popen.log, 'rb') as log:
            return log.read().count(b'\n')

    def tail(self):
        """Return the end of what it has written."""
        with open(self.popen.log, errors='replace') as log:
            return log.read()[-3000:]

    def check(self):
        """Fail where it has ended."""
        assert self.popen.poll() is None, '{} ended with {}:\n{}'.format(
            self.name, self.popen.returncode, self.tail())


class UnderFire:
    """The system; use it as a context manager."""

    def __init__(self, robots=ROBOTS, stick_hz=50, robot_hz=20):
        self.system = System()
        self.names = list(robots)
        self._stick_hz, self._robot_hz = stick_hz, robot_hz
        self.processes, self.robots = [], {}
        self.stops = []
        self._stop = None

    def __enter__(self):
        import rospy
        from std_srvs.srv import SetBool
        self.system.start_master()
        rospy.init_node('attacker', disable_signals=True)
        self.mux = self.start('mux', self.system.node('mux', '__name:=mux'))
        for name in self.names:
            self.robot(name)
        self.stick = self.speaker(os.path.join(HERE, 'speaker_process.py'),
                                  'joy', graph.PEDAL)
        self.start('stick', self.stick)
        self.start_operator()
        self._stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool, persistent=True)
        self._stop.wait_for_service(TIMEOUT_S)
        return self

    def __exit__(self, failure, *_):
        import rospy
        if failure is not None:
            for process in self.processes:
                print('--- {} ({}):\n{}'.format(process.name, process.popen.poll(),
                                                process.tail()))
        rospy.signal_shutdown('done')
        self.stick.kill()  # it does not end with what it is told by
        for speaker in (self.stick, getattr(self, 'operator', None)):
            if speaker is not None:
                speaker.stdin.close()
        self.system.close()

    def start(self, name, popen):
        """Take a process into the system."""
        process = Process(name, popen)
        self.processes.append(process)
        return process

    def robot(self, name):
        """Start one robot, known to everybody by its template."""
        import rospy
        rospy.set_param('/{}/robot_type'.format(name), 'generic')
        self.robots[name] = log = RobotLog(os.path.join(self.system.home, name))
        return self.start(name, self.system.start(
            sys.executable, os.path.join(HERE, 'logged_robot.py'), name, log.path + '.told',
            str(self._robot_hz), '__ns:=/' + name))

    def speaker(self, *command):
        """Start a program that is told things on its standard input."""
        return self.system.start(sys.executable, *command, stdin=subprocess.PIPE)

    def start_operator(self):
        """Start the panel's backend: the operator."""
        self.operator_log = os.path.join(self.system.home, 'operator.log')
        self.operator = self.speaker(os.path.join(HERE, 'backend_process.py'), self.operator_log)
        self.backend = self.start('backend', self.operator)

    def start_screen(self):
        """Start a second screen, drawn by Xvfb: it looks on and does not drive."""
        self.system.screen()
        self.start('screen', self.system.node(
            'panel', '--settings', os.path.join(self.system.home, 'screen.json'), '--robots',
            ' '.join(self.names), '__name:=onlooker'))
        master = rosgraph.Master('/under_fire')
        # Until then its connections are still being made, which is no growth.
        wait_for(lambda: all('/onlooker' in dict(master.getSystemState()[1]).get(topic, ())
                             for topic in (graph.DRIVE_STATE, '/{}/odom'.format(self.names[-1]))),
                 60, 'the second screen', poll_s=0.2)

    def order(self, *words):
        """Tell the operator's backend to do something."""
        tell(self.operator, ' '.join(words))

    def hold(self, forward):
        """Hold the stick so far ahead from now on."""
        tell(self.stick, '{} 0 0.0 {!r}'.format(self._stick_hz, forward))

    def moving(self, *names):
        """Return whether these robots, by default all, were told to move."""
        return all(self.robots[name].moves() for name in names or self.robots)

    def stands(self):
        """Wait until every robot was told to stand; return when."""
        wait_for(lambda: not any(log.moves() for log in self.robots.values()),
                 what='every robot to be told to stand')
        return time.monotonic()

    def wait_loaded(self):
        """Wait until the backend has loaded what robots need: that is no growth."""
        wait_for(lambda: 'loaded' in self.backend.tail(), what='the backend to be loaded')

    def drive(self, *names, by_panel=True):
        """Drive these robots, by default all, as who wants to: centre, push, and again.

        :param by_panel: the panel asks for stick and speed limit anew, and at times for control
        """
        tries = itertools.count(1)

        def moves():
            if by_panel:
                if next(tries) % 3 == 0:
                    self.order('take')
                self.order('select', *self.names)
                self.order('mode', 'pedal')
                self.order('limits', '0.5', '1.5')
            self.hold(0.0)
            time.sleep(0.2)
            self.call_stop(False)
            time.sleep(0.2)
            self.hold(0.5)
            return wait_for(lambda: self.moving(*names), 1.0, 'all to move')
        if not self.moving(*names):
            insist(moves, lambda: 'all to move: {}'.format(
                {name: log.rows()[-2:] for name, log in self.robots.items()}))

    def call_stop(self, stopped):
        """Engage or release STOP ALL; return the mux's answer."""
        import rospy
        try:
            return self._stop(stopped)
        except (rospy.ServiceException, rospy.ROSException, OSError) as error:
            # The connection was closed; a new one at once.
            self._stop.close()
            from std_srvs.srv import SetBool
            self._stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool, persistent=True)
            print('stop-all called again: {}'.format(error))
            return self._stop(stopped)

    def stop_all(self):
        """Press STOP ALL while everything drives; hold it to its time."""
        self.drive()
        since = time.monotonic()
        self.call_stop(True)
        self.stops.append(self.zeros(since, 'stop-all: last first zero'))
        self.stopped_at = since + self.stops[-1]

    def zeros(self, since, what):
        """Wait until every robot has a zero; return how long after a time the last one had it."""
        from support.node_tools import measured

        def found():
            return [next((word[0] for word in log.after(since) if not any(word[1:])), None)
                    for log in self.robots.values()]
        wait_for(lambda: None not in found(), what='every robot to be told to stand')
        return measured(what, max(found()) - since, STOP_S)

    def check_stands(self, since):
        """Fail where a robot was told to move after a time (and all that was under way)."""
        for name, log in self.robots.items():
            moved = [word for word in log.after(since) if any(word[1:])]
            assert not moved, '{} was moved by nobody: {}'.format(name, moved[:3])

    def check_straight(self):
        """Fail where a robot was ever told what this stick cannot have asked for."""
        for name, log in self.robots.items():
            odd = [word for word in log.rows()
                   if word[2] != 0.0 or not 0.0 <= word[1] <= FASTEST_MPS]
            assert not odd, '{} was told {}'.format(name, odd[:3])

    def check_alive(self):
        """Fail where a program has ended."""
        for process in self.processes:
            process.check()

    def sizes(self):
        """Return {name: (memory [MB], threads, descriptors)} of those under attack."""
        return {process.name: process.sizes() for process in self.processes
                if process.name in ('mux', 'backend', 'screen')}

    def lines(self):
        """Return {name: lines written}."""
        return {process.name: process.lines() for process in self.processes}


def table(before, after):
    """Print memory, threads and descriptors before and after."""
    for name, sizes in after.items():
        print('MEASURED {:8} memory {:6.1f} -> {:6.1f} MB, threads {} -> {}, descriptors {} -> '
              '{}'.format(name, before[name][0], sizes[0], before[name][1], sizes[1],
                          before[name][2], sizes[2]))
