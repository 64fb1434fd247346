#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_doctor in environments that are wrong, with a large system, and trying watchdogs."""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
from xmlrpc.server import SimpleXMLRPCServer

import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from support.ros_system import free_port, wait_for  # noqa: E402
from support.surgery import BlackHole, Clinic, wrong  # noqa: E402

TWIST, ODOMETRY = 'geometry_msgs/Twist', 'nav_msgs/Odometry'
ROBOTS = 12


class EnvironmentTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.clinic = Clinic()
        cls.addClassCleanup(cls.clinic.system.close)
        cls.clinic.start_light()

    def found(self, *checks, remedy=None, **options):
        """Examine; these checks are wrong, and the remedy of the first says this."""
        status, report = self.clinic.examine(**options)
        findings = wrong(report)
        self.assertEqual(set(findings), set(checks), findings)
        self.assertEqual(status, 1)
        for item in findings.values():
            print('FOUND {check}: {about}: {problem} | {shows} | {remedy}'.format(**item))
        self.assertIn(remedy or '', findings[checks[0]]['remedy'])

    def server(self):
        """Return the URI of an XML-RPC server that is no ROS node."""
        server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        return 'http://127.0.0.1:{}'.format(server.server_address[1])

    def test_address_of_another_computer(self):
        self.found('address_foreign', remedy='export ROS_IP=', env={'ROS_IP': '203.0.113.9'})

    def test_host_name_that_does_not_resolve(self):
        self.found('address_unresolved', remedy='unset ROS_HOSTNAME', unset=['ROS_IP'],
                   env={'ROS_HOSTNAME': 'no-such-name.invalid'})

    def test_address_that_is_none(self):
        self.found('address_bad', remedy='export ROS_IP=', env={'ROS_IP': 'http://127.0.0.1'})

    def test_two_addresses_that_differ(self):
        self.found('address_both', remedy='export ROS_IP=',
                   env={'ROS_HOSTNAME': 'localhost', 'ROS_IP': '203.0.113.9'})

    def test_master_uri_without_scheme(self):
        self.found('master_uri_bad', remedy='export ROS_MASTER_URI=http://',
                   env={'ROS_MASTER_URI': '127.0.0.1'})

    def test_master_uri_unset(self):
        # Port 11311 of this machine may have a master or not: that is not what is asked here.
        _, report = self.clinic.examine(unset=['ROS_MASTER_URI'])
        self.assertIn('export ROS_MASTER_URI=', wrong(report)['master_uri_unset']['remedy'])

    def master(self, uri, check, remedy):
        """Examine with this master, of which this is said, or that one is elsewhere."""
        _, report = self.clinic.examine(env={'ROS_MASTER_URI': uri})
        findings = wrong(report)
        if 'master_elsewhere' in findings:
            self.assertIn(':11311', findings['master_elsewhere']['remedy'])
        else:
            self.assertEqual(set(findings), {check})
            self.assertIn(remedy, findings[check]['remedy'])

    def test_master_that_is_not_running(self):
        self.master('http://127.0.0.1:{}'.format(free_port()), 'master_refused',
                    'roslaunch mhri mhri.launch')

    def test_master_that_is_out_of_reach(self):
        hole = BlackHole()
        self.addCleanup(hole.close)
        self.master(hole.uri, 'master_silent', 'ping -c 3')

    def test_master_whose_name_is_unknown(self):
        self.master('http://no-such-name.invalid:11311', 'master_unresolved', '/etc/hosts')

    def test_master_that_is_something_else(self):
        self.master(self.server(), 'master_stranger', 'export ROS_MASTER_URI=')

    def test_master_that_is_a_node(self):
        self.master(self.clinic.master.lookupNode('/mhri_mux'), 'master_stranger',
                    'export ROS_MASTER_URI=')

    def test_folder_that_cannot_be_made(self):
        with tempfile.NamedTemporaryFile() as file:
            self.found('folder_unwritable', remedy='ROS_HOME',
                       env={'ROS_HOME': os.path.join(file.name, 'ros')})

    def test_disk_that_is_full(self):
        folder = tempfile.mkdtemp(prefix='mhri_test_')
        self.addCleanup(shutil.rmtree, folder)
        mount = 'mount -t tmpfs -o size=1m none "$0" && exec "$@"'
        own = ['unshare', '--mount', 'sh', '-c', mount, folder]
        if not shutil.which('unshare') or subprocess.run(
                own + ['true'], stderr=subprocess.DEVNULL).returncode:
            self.skipTest('a small disk needs root and mount namespaces')
        self.found('disk_full', remedy='rosclean purge', prefix=own, env={'ROS_HOME': folder})

    def test_workspace_that_is_not_sourced(self):
        self.found('workspace_missing', remedy='devel/setup.bash', unset=['ROS_PACKAGE_PATH'])

    def test_no_mux(self):
        self.clinic.stop('/mhri_mux')
        self.addCleanup(self.clinic.start_light)
        self.found('mux_missing', remedy='rosrun mhri mux')

    def test_wrong_use(self):
        for arguments in (['bot1; reboot'], ['--nonsense'], ['--watchdog'], ['--yes'],
                          ['bot1', '--watchdog']):
            done = self.clinic.run(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn('mhri_doctor: error:', done.stderr)


class LargeTest(unittest.TestCase):

    def test_twelve_robots_of_which_two_are_out_of_reach(self):
        clinic = Clinic()
        self.addCleanup(clinic.system.close)
        clinic.start_light()
        holes = [BlackHole(), BlackHole('127.0.0.98')]
        for number in range(1, ROBOTS + 1):
            name = 'bot{}'.format(number)
            clinic.set('/{}/robot_type'.format(name), 'generic')
            if number > ROBOTS - len(holes):
                hole = holes.pop()
                self.addCleanup(hole.close)
                for node in ('base', 'camera', 'scan', 'diagnostics'):
                    clinic.register('/{}/{}'.format(name, node), '/{}/odom'.format(name), hole.uri,
                                    ODOMETRY)
            else:
                clinic.patient('/{}/base'.format(name), '--odometry', 'odom', '--subscribe',
                               'cmd_vel', TWIST, wait=False)
        clinic.wait_ready()
        for _ in range(3):
            status, report = clinic.examine()
            print('MEASURED examination of {} robots, 2 out of reach: {:.2f} s (promised: 3 '
                  's)'.format(ROBOTS, report['took_s']))
            silent = [item['about'] for item in report['findings']
                      if item['severity'] != 'fine']
            self.assertEqual(sorted(silent), ['bot11', 'bot12'])
            self.assertEqual(status, 1)
            self.assertLess(report['took_s'], 10.0)


class WatchdogTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.clinic = Clinic()
        cls.addClassCleanup(cls.clinic.system.close)
        cls.clinic.start_light()

    def setUp(self):
        self.addCleanup(self.clinic.heal)
        self.clinic.set('/bot1/robot_type', 'generic')

    def robot(self, *arguments):
        """Start a robot whose odometry follows its velocity."""
        return self.clinic.patient('/bot1/base', '--odometry', 'odom', '--obey', 'cmd_vel',
                                   *arguments)

    def test_robot_that_stops_by_itself(self):
        self.robot('--watchdog', '0.5')
        status, report = self.clinic.examine('bot1', '--watchdog', '--yes')
        first = report['findings'][0]
        self.assertEqual((status, first['check'], first['severity']), (0, 'watchdog', 'fine'))
        print('MEASURED', first['problem'])

    def test_robot_without_a_watchdog_is_found_and_left_at_rest(self):
        process = self.robot()
        _, report = self.clinic.examine('bot1', '--watchdog', '--yes')
        item = wrong(report)['watchdog_none']
        self.assertIn('mhri_guard', item['remedy'])
        with open(process.log, encoding='utf-8') as log:
            told = [float(line.split()[1]) for line in log if line.startswith('told')]
        self.assertIn(0.3, told)
        self.assertEqual(told[-5:], [0.0] * 5)
        self.assertNotIn('/mhri_doctor', str(self.clinic.nodes()))

    def test_interrupted_trial_ends_with_zeros(self):
        process = self.robot()
        doctor = self.clinic.begin('bot1', '--watchdog', '--yes')
        wait_for(lambda: 'told 0.3' in open(process.log).read(), 30.0, 'the robot to turn')
        doctor.send_signal(signal.SIGTERM)
        self.assertNotEqual(doctor.wait(30.0), 0)
        wait_for(lambda: open(process.log).read().rstrip().endswith('told 0.0'), 30.0, 'zeros')

    def test_robot_that_is_selected_is_not_touched(self):
        process = self.robot()
        self.clinic.patient('/mhri_panel', '--select', 'bot1')
        _, report = self.clinic.examine('bot1', '--watchdog', '--yes')
        self.assertIn('selected', wrong(report)['watchdog_unknown']['problem'])
        self.assertNotIn('told', open(process.log).read())

    def test_robot_that_says_nothing_is_not_touched(self):
        process = self.clinic.patient('/bot1/base', '--publish', 'odom', ODOMETRY, '--obey',
                                      'cmd_vel')
        _, report = self.clinic.examine('bot1', '--watchdog', '--yes')
        self.assertIn('odometry says nothing', wrong(report)['watchdog_unknown']['problem'])
        self.assertNotIn('told 0.3', open(process.log).read())


if __name__ == '__main__':
    rostest.rosrun('mhri', 'doctor_host', 'doctor_host_test')
