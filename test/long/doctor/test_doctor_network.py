# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_doctor with a robot on a computer of its own: addresses that are wrong for one side only.

The computers are network namespaces (``support/machines.py``); the nodes are light real ones.
"""
import json
import os
import subprocess
import sys
import time

import pytest

from support import machines
from support.ros_system import System, wait_for
from support.surgery import PATIENT, SCRIPT, wrong

WHY_NOT = machines.why_not()
pytestmark = [pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))]

HOST_IP = machines.HOST_IP
# An address that the host has, and of whose network the robot knows nothing.
INNER_IP = '198.51.100.1'
TWIST, ODOMETRY, BOOL = 'geometry_msgs/Twist', 'nav_msgs/Odometry', 'std_msgs/Bool'
DRIVES = ('--publish', '/bot1/cmd_vel', TWIST, '--subscribe', '/bot1/odom', ODOMETRY)
START_S = 60.0


class Ward:
    """A host with master and mux, a robot, and nodes on either under any address."""

    def __init__(self, lan, system):
        self.robot = lan.robot('bot1')
        self._system = system
        self._patients = {}
        machines.run('ip', 'addr', 'add', INNER_IP + '/24', 'dev', 'lan')
        self.patient('/mhri_mux', HOST_IP, '--mux')
        self.patient('/bot1/base', self.robot.ip, '--odometry', 'odom', '--subscribe', 'cmd_vel',
                     TWIST)
        self.param('set', '/bot1/robot_type', 'generic')

    def param(self, *words):
        subprocess.run(('rosparam',) + words, env=self._system.env, check=True)

    def patient(self, name, ip, *arguments):
        """Start a node that tells others an address; those of bot1 are on the robot."""
        space, _, base = name.rpartition('/')
        words = ['env', 'ROS_IP=' + ip, 'ROS_NAMESPACE=' + (space or '/'), sys.executable, PATIENT,
                 *arguments, '__name:=' + base]
        if space == '/bot1':
            words = self.robot.command(*words)
        process = self._system.start(*words)
        self._patients[name] = process
        wait_for(lambda: 'ready' in open(process.log).read(), START_S, name, poll_s=0.02)

    def end(self, name):
        """End a node; the master forgets it."""
        System.kill(self._patients.pop(name))
        subprocess.run(['rosnode', 'cleanup'], input=b'y', env=self._system.env,
                       stdout=subprocess.DEVNULL, check=False)

    def examine(self, *arguments):
        """Return ({check: finding} of what is wrong, all findings, how long it took [s])."""
        begun = time.monotonic()
        done = subprocess.run([sys.executable, SCRIPT, '--json', *arguments], env=self._system.env,
                              stdout=subprocess.PIPE, universal_newlines=True, timeout=60)
        took_s = time.monotonic() - begun
        report = json.loads(done.stdout)
        for item in wrong(report).values():
            print('FOUND {check}: {about}: {problem} | {remedy} | {confidence}'.format(**item))
        return wrong(report), report['findings'], took_s

    def found(self, check, *arguments):
        """Return the finding of a check, which is the only one once all have connected."""
        found = wait_for(lambda: (lambda item: set(item) == {check} and item)(
            self.examine(*arguments)[0]), START_S, check)
        return found[check]


@pytest.fixture(scope='module')
def ward(tmp_path_factory):
    with machines.Lan(tmp_path_factory.mktemp('ward')) as lan, System(adopt=False) as system:
        system.env.update(ROS_MASTER_URI='http://{}:{}'.format(HOST_IP, system.port),
                          ROS_IP=HOST_IP)
        before = dict(os.environ)
        os.environ.update(ROS_MASTER_URI=system.env['ROS_MASTER_URI'], ROS_IP=HOST_IP)
        system.start_master()
        yield Ward(lan, system)
        os.environ.clear()
        os.environ.update(before)


@pytest.fixture
def seeded(ward, request):
    """Return a function that starts a node until the end of the test."""
    def start(name, ip, *arguments):
        request.addfinalizer(lambda: ward.end(name))
        ward.patient(name, ip, *arguments)
    return start


def test_mux_that_the_robot_cannot_reach_back(ward, seeded):
    """From here it answers; the robot is sent to an address that it has no way to."""
    seeded('/mux', INNER_IP, *DRIVES)
    item = ward.found('one_way')
    assert item['about'] == 'bot1' and '/bot1/cmd_vel of /mux' in item['problem']
    assert 'export ROS_IP=' + HOST_IP in item['remedy'] and item['symptom'] and item['confidence']


def test_robot_that_is_unplugged_is_gone_and_not_wrong(ward, seeded):
    seeded('/mux', HOST_IP, *DRIVES)
    wait_for(lambda: ward.examine()[0] == {}, START_S, 'nothing wrong')
    wait_for(lambda: 'reaches_back' in [item['check'] for item in ward.examine()[1]], START_S,
             'the way back')
    ward.robot.unplug()
    try:
        item = ward.found('host_silent')
    finally:
        ward.robot.plug()
    assert item['about'] == 'bot1' and 'ping -c 3 ' + ward.robot.ip in item['remedy']
    wait_for(lambda: ward.examine()[0] == {}, START_S, 'nothing wrong')
