# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the doctor share: a small healthy system, ailments for it, the examination."""
import json
import os
import socket
import subprocess
import sys
import time
import xmlrpc.client

import rosgraph

from mhri.graph.ros.resources import read_text
from support import graph
from support.ros_system import insist, NotYet, System, wait_for

PATIENT = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'patient.py')
SCRIPT = os.path.join(os.path.dirname(PATIENT), '..', '..', 'scripts', 'mhri_doctor')
START_S = 90.0
# An examination ends after two seconds, whatever the load; it is repeated for so long.
EXAMINE_S = 180.0


class BlackHole:
    """An address that takes connections in and says nothing: a computer that is out of reach.

    Its queue of waiting connections is full, so that the kernel drops what else comes. The address
    is loopback too, but one at which nothing else answers.
    """

    def __init__(self, address='127.0.0.99'):
        self._server = socket.socket()
        self._server.bind((address, 0))
        self._server.listen(0)
        self.port = self._server.getsockname()[1]
        self.uri = 'http://{}:{}/'.format(address, self.port)
        self._filling = []
        for _ in range(4):
            filler = socket.socket()
            filler.setblocking(False)
            filler.connect_ex((address, self.port))
            self._filling.append(filler)

    def close(self):
        for item in self._filling + [self._server]:
            item.close()


def forget(master, node):
    """Take a dead node off a master."""
    uri = master.lookupNode(node)
    publishers, subscribers, services = master.getSystemState()
    for topic in [name for name, nodes in publishers if node in nodes]:
        master.handle.unregisterPublisher(node, topic, uri)
    for topic in [name for name, nodes in subscribers if node in nodes]:
        master.handle.unregisterSubscriber(node, topic, uri)
    for name in [name for name, nodes in services if node in nodes]:
        master.handle.unregisterService(node, name, master.lookupService(name))


class Clinic:
    """A master with what a test starts around it; ``seeded`` is forgotten after each test."""

    def __init__(self):
        self.system = System()
        self.system.start_master()
        self.uri = self.system.env['ROS_MASTER_URI']
        self.master = rosgraph.Master('/clinic')
        self.base = set()
        self._patients = []
        self._others = []
        self._registered = []
        self._parameters = []

    def start_healthy(self):
        """Start a mux and two simulated robots, and wait until they are there."""
        self.system.node('mux', '__name:=mux')
        for name, kind in (('bot1', 'turtlebot2'), ('bot2', 'turtlebot3_burger')):
            self.system.launch('turtlebot.launch', 'name:=' + name, 'type:=' + kind)
        wait_for(lambda: self.topics() >= {
            graph.DRIVE_STATE, '/bot1/odom', '/bot2/odom', '/bot1/camera/rgb/camera_info',
            '/bot2/camera/rgb/camera_info', '/bot2/battery_state'}, START_S, 'the healthy system')
        self.base = self.nodes()

    def topics(self):
        """Return what is published."""
        return {name for name, _ in self.master.getSystemState()[0]}

    def nodes(self):
        """Return the names of all nodes."""
        return {node for group in self.master.getSystemState() for _, nodes in group
                for node in nodes}

    def start_light(self):
        """Start a stand-in for the mux, which is all that a host needs to look healthy."""
        self.base = set()
        process = self.patient('/mhri_mux', '--mux')
        self._patients.remove(process)
        self._mux = process
        self.base = self.nodes()

    def stop(self, node):
        """End the stand-in for the mux."""
        self._mux.terminate()
        self._mux.wait(START_S)
        wait_for(lambda: node not in self.nodes(), START_S, 'the end of ' + node)

    def patient(self, name, *arguments, wait=True):
        """Start a patient as a node of this absolute name; wait until it has registered all."""
        space, _, base = name.rpartition('/')
        process = self.system.start('env', 'ROS_NAMESPACE=' + (space or '/'), sys.executable,
                                    PATIENT, *arguments, '__name:=' + base)
        self._patients.append(process)
        if wait:
            self.wait_ready()
        return process

    def start(self, *command):
        """Start another program until the end of the test; return the process."""
        process = self.system.start(*command)
        self._others.append(process)
        return process

    def uri_of(self, node):
        """Return where a node is registered, '' where it is not."""
        try:
            return self.master.lookupNode(node)
        except rosgraph.MasterError:
            return ''

    def wait_ready(self):
        """Wait until all patients have registered all they have."""
        wait_for(lambda: all('ready' in read_text(process.log) for process in self._patients),
                 2.0 * START_S, 'the patients', poll_s=0.02)

    def wait_connected(self, node, topic):
        """Wait until a node has a connection on a topic: forgotten before, it has none to find."""
        handle = xmlrpc.client.ServerProxy(self.master.lookupNode(node))
        wait_for(lambda: any(link[4] == topic for link in handle.getBusInfo('/clinic')[2]),
                 START_S, 'a connection of {} on {}'.format(node, topic), poll_s=0.02)

    def register(self, node, topic, uri, kind='std_msgs/Bool'):
        """Register a publisher in the name of a node that may not exist."""
        self.master.handle.registerPublisher(node, topic, kind, uri)
        self._registered.append((node, topic, uri))

    def set(self, name, value):
        """Set a parameter until the end of the test."""
        self.master.setParam(name, value)
        self._parameters.append(name)

    def heal(self):
        """Undo whatever a test did; wait until only the healthy system is left."""
        # To end by itself takes a node half a second; its registrations are taken off below.
        for process in self._patients + self._others:
            self.system.kill(process)
        for node, topic, uri in self._registered:
            self.master.handle.unregisterPublisher(node, topic, uri)
        for name in self._parameters:
            if self.master.hasParam(name):
                self.master.deleteParam(name)
        self._patients, self._others = [], []
        self._registered, self._parameters = [], []
        if not self.base <= self.nodes():
            raise AssertionError('the test has ended {}'.format(self.base - self.nodes()))
        wait_for(self._is_healthy, START_S, lambda: 'the healthy system {}, not {}'.format(
            sorted(self.base), sorted(self.nodes())))

    def _is_healthy(self):
        """Take all that has ended off the master; tell whether only the healthy system is left."""
        for node in self.nodes() - self.base:
            self.forget(node)
        return self.nodes() == self.base

    def forget(self, node):
        """Take a dead node off the master."""
        forget(self.master, node)

    def begin(self, *arguments):
        """Start the real mhri_doctor; return the process."""
        return self.system.start(sys.executable, SCRIPT, *arguments)

    def run(self, *arguments, env=None, prefix=(), unset=()):
        """Run the real mhri_doctor; return the finished process."""
        environ = dict(self.system.env, **(env or {}))
        for key in unset:
            environ.pop(key, None)
        return subprocess.run([*prefix, sys.executable, SCRIPT, *arguments], env=environ,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              stdin=subprocess.DEVNULL, universal_newlines=True, timeout=60)

    def examine(self, *arguments, **options):
        """Return (exit status, report as a dict, with ``wall_s``: how long the command took).

        One that had no time to listen says so, which is no ailment.
        """
        def in_time():
            begun = time.monotonic()
            done = self.run('--json', *arguments, **options)
            wall_s = time.monotonic() - begun
            if not done.stdout:
                raise AssertionError(done.stderr)
            report = dict(json.loads(done.stdout), wall_s=wall_s)
            if 'time_short' in wrong(report):
                raise NotYet('{:.2f} s, {}'.format(wall_s, sorted(wrong(report))))
            return done.returncode, report
        return insist(in_time, 'an examination in time')

    def examine_until(self, checks, *arguments, **options):
        """Examine until just these checks are wrong; return (exit status, report).

        On a busy computer a node may not answer in time, or not be connected yet.
        """
        found = []

        def there():
            found[:] = self.examine(*arguments, **options)
            return set(wrong(found[1])) == set(checks)
        wait_for(there, EXAMINE_S, lambda: '{}, not {}'.format(
            sorted(checks), [dict(item) for item in wrong(found[1]).values()]), 0.2)
        return found


def wrong(report):
    """Return {check: finding} of what is not fine."""
    return {item['check']: item for item in report['findings'] if item['severity'] != 'fine'}
