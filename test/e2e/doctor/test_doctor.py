# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_doctor on a real master with real nodes: each ailment is seeded, found, and nothing else."""
import signal
import subprocess
import threading
import unittest
import xmlrpc.client
from xmlrpc.server import SimpleXMLRPCServer

from support.ros_system import freeze, wait_for
from support.surgery import BlackHole, Clinic, wrong

TWIST, ODOMETRY, BOOL = 'geometry_msgs/Twist', 'nav_msgs/Odometry', 'std_msgs/Bool'
ROBOT = ('--odometry', 'odom', '--subscribe', 'cmd_vel', TWIST)
# An examination ends after two seconds, whatever the load: on a busy computer few see everything.
TRIES_S = 180.0


class DoctorTest(unittest.TestCase):

    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.clinic = Clinic()
        cls.addClassCleanup(cls.clinic.system.close)
        cls.clinic.start_healthy()

    def setUp(self):
        self.addCleanup(self.clinic.heal)

    def found(self, *checks, about=None, remedy=None, robots=(), **options):
        """Examine; exactly these checks are wrong; the first is about this, with this remedy."""
        status, self.report = self.clinic.examine_until(checks, '--quick', *robots, **options)
        findings = wrong(self.report)
        self.assertEqual(status, 1)
        for item in findings.values():
            print('FOUND {check}: {about}: {problem} | {symptom} | {remedy}'.format(**item))
            self.assertTrue(item['problem'] and item['symptom'] and item['remedy'], item)
        first = findings[checks[0]]
        if about:
            self.assertEqual(first['about'], about)
        if remedy:
            self.assertIn(remedy, first['remedy'])
        return findings

    def robot(self, name, *arguments, kind='generic', wait=True):
        """Start a light robot that lacks nothing."""
        if kind:
            self.clinic.set('/{}/robot_type'.format(name), kind)
        return self.clinic.patient('/{}/base'.format(name), *ROBOT, *arguments, wait=wait)

    def test_healthy_has_nothing_and_nothing_is_left_behind(self):
        status, report = self.clinic.examine_until(())
        self.assertEqual(status, 0)
        for left in (self.clinic.master.getSystemState(), self.clinic.master.getParam('/')):
            self.assertNotIn('mhri_doctor', str(left))
        fine = [item['check'] for item in report['findings']]
        for check in ('variables', 'disk', 'workspace', 'packages', 'master', 'system', 'nodes',
                      'definitions', 'clock', 'robot'):
            self.assertIn(check, fine)
        print('MEASURED examination of a healthy system: {:.2f} s'.format(report['took_s']))

    def test_healthy_robot_alone_in_words(self):
        done = wait_for(lambda: next((one for one in [self.clinic.run('bot2')]
                                      if one.returncode == 0), None), TRIES_S, 'nothing wrong')
        self.assertIn('(o) fine  bot2: TurtleBot3 Burger', done.stdout)
        self.assertNotIn('  bot1: ', done.stdout)
        self.assertIn('0 faults, 0 warnings', done.stdout)

    def test_each_robot_is_wrong_in_another_way(self):
        """What nodes answer and publish; what the master alone shows is in test/unit/doctor."""
        hole = BlackHole()
        self.addCleanup(hole.close)
        server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        dead, hung = self.robot('dead', wait=False), self.robot('hung', wait=False)
        self.clinic.set('/far/robot_type', 'generic')
        self.clinic.register('/far/base', '/far/odom', hole.uri, ODOMETRY)
        self.clinic.register('/mistaken', '/mistaken/topic', self.clinic.master.lookupNode('/mux'))
        self.clinic.register('/web', '/web/topic', 'http://127.0.0.1:{}/'.format(
            server.server_address[1]))
        self.clinic.patient('/helper', '--publish', '/helper/real', BOOL, wait=False)
        self.clinic.patient('/one', '--publish', '/shared', BOOL, wait=False)
        self.clinic.patient('/two', '--subscribe', '/shared', TWIST, wait=False)
        self.robot('late', '--offset', '-3.5', wait=False)
        self.robot('changed', '--changed', wait=False)
        self.clinic.patient('/viewer', '--subscribe', '/changed/odom', ODOMETRY,
                            '--subscribe', '/bot1/odom', ODOMETRY, wait=False)
        self.clinic.set('/mute/robot_type', 'generic')
        self.clinic.patient('/mute/base', '--publish', 'odom', ODOMETRY, '--publish', 'imu', BOOL,
                            '--publish', 'scan', 'sensor_msgs/LaserScan', '--subscribe', 'cmd_vel',
                            TWIST, wait=False)
        for name in ('twin1', 'twin2'):
            self.robot(name, '--frames', 'odom', 'base_footprint', wait=False)
        self.clinic.patient('/ghost', '--publish', '/bot1/teleop/input', TWIST, wait=False)
        self.clinic.patient('/listener', '--subscribe', '/bot1/odom', ODOMETRY)
        self.clinic.wait_connected('/listener', '/bot1/odom')
        self.clinic.wait_connected('/ghost', '/bot1/teleop/input')
        for name in ('/listener', '/ghost'):
            self.clinic.forget(name)
        self.clinic.register('/helper', '/helper/gone', self.clinic.master.lookupNode('/helper'))
        dead.kill()
        dead.wait()
        freeze(hung.pid)
        self.found_of({
            ('node_dead', 'dead'): 'rosnode cleanup',
            ('node_silent', 'hung'): 'rosnode kill /hung/base',
            ('host_silent', 'far'): 'ping -c 3',
            ('node_stranger', '/mistaken'): 'not "rosnode kill',
            ('node_stranger', '/web'): 'rosnode cleanup',
            ('registration_stale', '/helper'): '/helper',
            ('node_forgotten', '/listener'): 'start /listener again',
            ('velocity_hidden', 'bot1'): 'ss -tlnp',
            ('clock_offset', 'late'): 'chrony',
            ('md5_differs', 'changed'): 'rosmsg md5 nav_msgs/Odometry',
            ('definition_differs', '/changed/base'): 'rosmsg md5',
            ('type_differs', '/one'): 'rostopic info /shared',
            ('odometry_silent', 'mute'): 'rostopic hz /mute/odom',
            ('scan_silent', 'mute'): 'rostopic hz /mute/scan',
            ('topic_type', 'mute'): '/mute/mhri/imu',
            ('frames_same', 'twin1'): 'tf_prefix'})

        def offset_told():
            item = wrong(self.clinic.examine('--quick')[1]).get('clock_offset')
            return item and abs(float(item['problem'].split()[3]) - 3.5) < 0.3
        wait_for(offset_told, TRIES_S, 'the offset of a clock')

    def found_of(self, expected):
        """Examine until just these are wrong: {(check, about): a part of the remedy}."""
        last = {}

        def there():
            self.report = self.clinic.examine('--quick')[1]
            last.clear()
            last.update({(item['check'], item['about']): item for item in self.report['findings']
                         if item['severity'] != 'fine'})
            return set(last) == set(expected)
        wait_for(there, TRIES_S, lambda: 'missing {}, not expected {}'.format(
            set(expected) - set(last), set(last) - set(expected)), 0.2)
        for key, remedy in expected.items():
            item = last[key]
            print('FOUND {check}: {about}: {problem} | {symptom} | {remedy}'.format(**item))
            self.assertTrue(item['problem'] and item['symptom'])
            self.assertIn(remedy, item['remedy'])

    def test_two_programs_of_one_name(self):
        """One that hangs cannot be sent away by the master when the next one takes its name."""
        wanted = '/bot1/odom_again'
        relay = self.clinic.start('rosrun', 'topic_tools', 'relay', '/bot1/odom', wanted,
                                  '__name:=relay')
        wait_for(lambda: wanted in self.clinic.topics(), 30.0, 'the relay')
        first = self.clinic.patient('/viewer', '--subscribe', wanted, ODOMETRY)
        self.found_links('/relay', ['/viewer'])
        freeze(first.pid)
        self.clinic.patient('/viewer', '--subscribe', wanted, ODOMETRY)
        self.found_links('/relay', ['/viewer'] * 2)
        item = self.found('name_twice', about='/viewer', remedy='__name:=')['name_twice']
        self.assertIn(wanted, item['problem'])
        self.assertIsNone(relay.poll())

    def found_links(self, node, peers):
        """Wait until a publisher is connected to these nodes."""
        proxy = xmlrpc.client.ServerProxy(self.clinic.master.lookupNode(node))
        wait_for(lambda: [link[1] for link in proxy.getBusInfo('/test')[2] if link[2] == 'o']
                 == peers, 30.0, 'the connections of ' + node, poll_s=0.05)

    def hang(self, check, *arguments):
        """Let a stand-in hang; do what the remedy says, as the one who reads it: it has ended."""
        process = self.clinic.patient('/stand_in', *arguments)
        freeze(process.pid)
        item = self.found(check, remedy='pkill -KILL')[check]
        command = item['remedy'].partition(': ')[2].partition('#')[0]
        # What respawns a node has its name among its arguments, too, and must live.
        respawner = self.clinic.start('bash', '-c', 'sleep 600; true', 'x', '__name:=stand_in', '')
        subprocess.run(['sh', '-c', command], check=True)
        self.assertEqual(process.wait(60.0), -signal.SIGKILL)
        self.assertIsNone(respawner.poll())

    def test_mux_that_hangs(self):
        self.hang('mux_silent', '--mux')

    def test_mux_that_refuses_somebody(self):
        self.clinic.patient('/rogue', '--select', 'bot1')
        self.clinic.patient('/other', '--select', 'bot2')
        wait_for(lambda: 'mux_refused' in wrong(self.clinic.examine('--quick')[1]), 180.0,
                 'the refusal')
        found = self.found('mux_refused', 'panel_several', remedy='rosnode info /')
        self.assertRegex(found['mux_refused']['problem'], '/(rogue|other): robot_select, ')

    def test_lasers_that_measure_nothing(self):
        """What says "nothing there" is a matter of the type; beyond its reach none measures."""
        for name, kind, said in (('bot3', 'generic', 'nan'), ('bot4', 'generic', '4.0'),
                                 ('bot5', 'turtlebot3', '0.0'), ('bot6', 'generic', 'inf'),
                                 ('bot7', 'turtlebot3', '1.0')):
            self.robot(name, '--scan', said, kind=kind, wait=False)
        self.clinic.wait_ready()
        self.found_of({('scan_blind', name): 'rostopic echo -n1 /' + name
                       for name in ('bot3', 'bot4', 'bot5')})
        self.assertEqual({item['about'] for item in self.report['findings']
                          if item['check'] == 'scan_blind' and item['confidence']}, {'bot5'})
