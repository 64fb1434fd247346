#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_doctor on a real master with real nodes: each ailment is seeded, found, and nothing else."""
import os
import signal
import subprocess
import sys
import threading
import unittest
import xmlrpc.client
from xmlrpc.server import SimpleXMLRPCServer

import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from support.ros_system import wait_for  # noqa: E402
from support.surgery import BlackHole, Clinic, TRIES, wrong  # noqa: E402

TWIST, ODOMETRY, BOOL = 'geometry_msgs/Twist', 'nav_msgs/Odometry', 'std_msgs/Bool'
ROBOT = ('--odometry', 'odom', '--subscribe', 'cmd_vel', TWIST)
# An examination that took longer had no time for everything, on a busy computer [s].
SHORT_S = 1.8


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
        for _ in range(8):
            status, report = self.clinic.examine('--quick', *robots, **options)
            findings = wrong(report)
            if set(findings) == set(checks) or report['took_s'] < SHORT_S:
                break
            print('again: {:.2f} s, {}'.format(report['took_s'], sorted(findings)))
        self.report = report
        self.assertEqual(set(findings), set(checks), findings)
        self.assertEqual(status, 1)
        for item in findings.values():
            print('FOUND {check}: {about}: {problem} | {shows} | {remedy}'.format(**item))
            self.assertTrue(item['problem'] and item['shows'] and item['remedy'], item)
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
        before = sorted(map(str, self.clinic.master.getSystemState()))
        parameters = self.clinic.master.getParam('/')
        status, report = self.clinic.examine()
        self.assertEqual(wrong(report), {})
        self.assertEqual(status, 0)
        self.assertEqual(sorted(map(str, self.clinic.master.getSystemState())), before)
        self.assertEqual(self.clinic.master.getParam('/'), parameters)
        fine = [item['check'] for item in report['findings']]
        for check in ('variables', 'disk', 'workspace', 'packages', 'master', 'system', 'nodes',
                      'definitions', 'clock', 'robot'):
            self.assertIn(check, fine)
        print('MEASURED examination of a healthy system: {:.2f} s'.format(report['took_s']))

    def test_healthy_robot_alone_in_words(self):
        for _ in range(TRIES):
            done = self.clinic.run('bot2')
            if 'no time to listen' not in done.stdout:
                break
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('(o) fine  bot2: TurtleBot3 Burger', done.stdout)
        self.assertNotIn('  bot1: ', done.stdout)
        self.assertIn('0 faults, 0 warnings', done.stdout)

    def test_dead_node(self):
        process = self.robot('bot3')
        process.kill()
        process.wait()
        self.found('node_dead', about='bot3', remedy='rosnode cleanup')

    def test_node_that_hangs(self):
        process = self.robot('bot3')
        process.send_signal(signal.SIGSTOP)
        self.found('node_silent', about='bot3', remedy='rosnode kill /bot3/base')

    def test_computer_out_of_reach(self):
        hole = BlackHole()
        self.addCleanup(hole.close)
        self.clinic.set('/bot3/robot_type', 'generic')
        self.clinic.register('/bot3/base', '/bot3/odom', hole.uri, ODOMETRY)
        self.found('host_silent', about='bot3', remedy='ping -c 3')

    def test_name_of_a_computer_that_is_unknown(self):
        self.clinic.set('/bot3/robot_type', 'generic')
        self.clinic.register('/bot3/base', '/bot3/odom', 'http://bot3-laptop.invalid:40000/',
                             ODOMETRY)
        # Somebody is on another computer, then: loopback does not do any more.
        self.found('host_unresolved', 'address_loopback', about='bot3', remedy='export ROS_IP=')

    def test_port_of_a_dead_node_taken_by_another(self):
        uri = self.clinic.master.lookupNode('/mux')
        self.clinic.register('/bot3_base', '/old/topic', uri)
        self.found('node_stranger', about='/bot3_base', remedy='not "rosnode kill')

    def test_something_else_at_the_port_of_a_node(self):
        server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.clinic.register('/old', '/old/topic', 'http://127.0.0.1:{}/'.format(
            server.server_address[1]))
        self.found('node_stranger', about='/old', remedy='rosnode cleanup')

    def test_topic_that_its_node_does_not_know(self):
        self.clinic.patient('/helper', '--publish', '/helper/real', BOOL)
        self.clinic.register('/helper', '/helper/gone', self.clinic.master.lookupNode('/helper'))
        self.found('registration_stale', about='/helper', remedy='/helper')

    def test_node_that_the_master_has_forgotten(self):
        self.clinic.patient('/listener', '--subscribe', '/bot1/odom', ODOMETRY)
        self.clinic.wait_connected('/listener', '/bot1/odom')
        self.clinic.forget('/listener')
        self.found('node_forgotten', about='/listener', remedy='start /listener again')

    def test_two_programs_of_one_name(self):
        """One that hangs cannot be sent away by the master when the next one takes its name."""
        wanted = '/bot1/odom_again'
        relay = self.clinic.start('rosrun', 'topic_tools', 'relay', '/bot1/odom', wanted,
                                  '__name:=relay')
        wait_for(lambda: wanted in self.clinic.topics(), 30.0, 'the relay')
        first = self.clinic.patient('/viewer', '--subscribe', wanted, ODOMETRY)
        self.found_links('/relay', ['/viewer'])
        first.send_signal(signal.SIGSTOP)
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

    def test_two_programs_that_take_a_name_from_each_other(self):
        """Two launch files with respawn, of robots that have one name: each ends the other."""
        self.clinic.set('/bot3/robot_type', 'generic')
        for _ in range(2):
            pair = self.clinic.patient('/bot3/base', *ROBOT, '--respawn', wait=False)
            self.addCleanup(os.killpg, pair.pid, signal.SIGKILL)
        addresses = set()
        wait_for(lambda: addresses.add(self.clinic.uri_of('/bot3/base')) or len(addresses) > 4,
                 60.0, 'the two to meet', poll_s=0.02)
        seen = []
        for _ in range(6):
            findings = wrong(self.clinic.examine()[1])
            seen.append('name_fought' in findings and findings['name_fought']['about'])
        print('MEASURED two that fight for a name: found {} times of {}'.format(
            seen.count('/bot3/base'), len(seen)))
        self.assertGreaterEqual(seen.count('/bot3/base'), len(seen) // 2)

    def test_clock_offset(self):
        self.robot('bot3', '--offset', '-3.5')
        item = self.found('clock_offset', about='bot3', remedy='chrony')['clock_offset']
        self.assertIn('behind', item['problem'])
        self.assertIn('stamps of', item['sure'])
        self.assertAlmostEqual(float(item['problem'].split()[3]), 3.5, delta=0.3)
        self.assertEqual(item['severity'], 'fault')

    def test_definition_that_differs(self):
        self.robot('bot3', '--changed')
        self.found('md5_differs', about='bot3', remedy='rosmsg md5 nav_msgs/Odometry')

    def test_definition_that_keeps_two_nodes_apart(self):
        self.robot('bot3', '--changed')
        self.clinic.patient('/viewer', '--subscribe', '/bot3/odom', ODOMETRY,
                            '--subscribe', '/bot1/odom', ODOMETRY)
        self.found('definition_differs', 'md5_differs', about='/bot3/base', remedy='rosmsg md5')

    def test_type_that_two_nodes_disagree_on(self):
        self.clinic.patient('/one', '--publish', '/shared', BOOL)
        self.clinic.patient('/two', '--subscribe', '/shared', TWIST)
        self.found('type_differs', about='/one', remedy='rostopic info /shared')

    def test_publishers_that_disagree(self):
        self.clinic.patient('/one', '--publish', '/shared', BOOL)
        self.clinic.patient('/two', '--publish', '/shared', TWIST)
        self.found('publishers_differ', about='/shared', remedy='rosnode kill')

    def test_several_panels(self):
        for name in ('/mhri_panel', '/mhri_panel_2'):
            self.clinic.patient(name, '--publish', '/robot_controller/robot_select',
                                'mhri/RobotSelect')
        self.found('panel_several', remedy='rosnode kill /mhri_panel_2')

    def hang(self, check, *arguments):
        """Let a stand-in hang; do what the remedy says, as the one who reads it: it has ended."""
        process = self.clinic.patient('/stand_in', *arguments)
        process.send_signal(signal.SIGSTOP)
        item = self.found(check, remedy='pkill -KILL')[check]
        command = item['remedy'].partition(': ')[2].partition('#')[0]
        # What respawns a node has its name among its arguments, too, and must live.
        respawner = self.clinic.start('bash', '-c', 'sleep 600; true', 'x', '__name:=stand_in', '')
        subprocess.run(['sh', '-c', command], check=True)
        self.assertEqual(process.wait(10.0), -signal.SIGKILL)
        self.assertIsNone(respawner.poll())

    def test_gates_that_hang(self):
        self.hang('gates_silent', '--gates')

    def test_mux_that_hangs(self):
        self.hang('mux_silent', '--publish', '/mux/mode', 'mhri/ControlMode')

    def test_several_gates(self):
        self.clinic.patient('/lab_gates', '--gates')
        self.found('gates_several', remedy='rosnode kill /lab_gates')

    def test_gates_that_answer_and_say_nothing(self):
        self.clinic.patient('/lab_gates', '--publish', '/gates/state', 'mhri/GatesState',
                            '--subscribe', '/robot_controller/twist', TWIST)
        self.found('gates_silent', 'gates_several', remedy='rosnode kill /lab_gates')

    def test_gates_that_refuse_somebody(self):
        self.clinic.patient('/rogue', '--select', 'bot1')
        self.clinic.patient('/other', '--select', 'bot2')
        wait_for(lambda: 'gates_refused' in wrong(self.clinic.examine('--quick')[1]), 180.0,
                 'the refusal')
        found = self.found('gates_refused', 'panel_several', remedy='rosnode info /')
        self.assertRegex(found['gates_refused']['problem'], '/(rogue|other): robot_select, ')

    def test_state_of_the_gates_from_somebody_else(self):
        self.clinic.patient('/rogue', '--publish', '/gates/state', 'mhri/GatesState')
        self.found('gates_bypassed', remedy='rosnode kill /rogue')

    def test_velocities_of_tasks_beside_the_mux(self):
        self.clinic.patient('/rogue', '--publish', '/robot_controller/task_twist',
                            'mhri/TeamTwist')
        self.found('mux_bypassed', remedy='rosnode kill /rogue')

    def test_several_sticks(self):
        for name in ('/script_1', '/script_2'):
            self.clinic.patient(name, '--publish', '/mux_in/joy', 'sensor_msgs/Joy')
        self.found('stick_several', remedy='rosnode kill /script_')

    def test_several_muxes(self):
        # A real second mux ends the first one; one of a lab's own, or of an old release, does not.
        self.clinic.patient('/mux_2', '--publish', '/mux/mode', 'mhri/ControlMode')
        self.found('mux_several', remedy='rosnode kill /mux_2')

    def test_velocity_beside_the_mux(self):
        self.clinic.patient('/rogue', '--publish', '/robot_controller/twist', TWIST)
        self.found('mux_bypassed', remedy='rosnode kill /rogue')

    def test_robot_without_type(self):
        self.robot('bot3', kind=None)
        self.found('robot_untyped', about='bot3', remedy='rosparam set /bot3/robot_type')

    def test_robot_of_unknown_type(self):
        self.robot('bot3', kind='turtlebot33')
        self.found('robot_type_unknown', about='bot3',
                   remedy='rosparam set /bot3/robot_type turtlebot3')

    def test_parameter_that_cannot_be_used(self):
        self.clinic.set('/bot3/mhri/limits/linear_mps', 'fast')
        self.robot('bot3')
        self.found('parameter_bad', about='bot3', remedy='rosparam delete /bot3')

    def test_velocity_that_nobody_hears(self):
        self.clinic.set('/bot3/robot_type', 'generic')
        self.clinic.patient('/bot3/base', '--odometry', 'odom')
        self.found('velocity_unheard', about='bot3', remedy='/bot3/mhri/command')

    def test_velocity_from_somebody_else(self):
        self.clinic.patient('/teleop_key', '--publish', '/bot1/teleop/input', TWIST)
        self.found('velocity_foreign', about='bot1', remedy='rosnode kill /teleop_key')

    def test_velocity_from_somebody_hidden(self):
        self.clinic.patient('/ghost', '--publish', '/bot1/teleop/input', TWIST)
        self.clinic.wait_connected('/ghost', '/bot1/teleop/input')
        self.clinic.forget('/ghost')
        self.found('velocity_hidden', about='bot1', remedy='ss -tlnp')

    def test_topic_of_another_type_than_the_template_says(self):
        self.robot('bot3', '--publish', 'imu', BOOL)
        item = self.found('topic_type', about='bot3', remedy='/bot3/mhri/imu')['topic_type']
        self.assertIn('/bot3/imu is std_msgs/Bool', item['problem'])

    def test_odometry_missing(self):
        self.clinic.set('/bot3/robot_type', 'generic')
        self.clinic.patient('/bot3/base', '--subscribe', 'cmd_vel', TWIST)
        self.found('odometry_missing', about='bot3', remedy='/bot3/mhri/odometry')

    def test_odometry_silent(self):
        self.clinic.set('/bot3/robot_type', 'generic')
        self.clinic.patient('/bot3/base', '--publish', 'odom', ODOMETRY,
                            '--subscribe', 'cmd_vel', TWIST)
        self.found('odometry_silent', about='bot3', remedy='rostopic hz /bot3/odom')

    def test_laser_that_is_silent(self):
        self.robot('bot3', '--publish', 'scan', 'sensor_msgs/LaserScan')
        self.found('scan_silent', about='bot3', remedy='rostopic hz /bot3/scan')

    def test_lasers_that_measure_nothing(self):
        """What says "nothing there" is a matter of the type; beyond its reach none measures."""
        for name, kind, said in (('bot3', 'generic', 'nan'), ('bot4', 'generic', '4.0'),
                                 ('bot5', 'turtlebot3', '0.0'), ('bot6', 'generic', 'inf'),
                                 ('bot7', 'turtlebot3', '1.0')):
            self.robot(name, '--scan', said, kind=kind, wait=False)
        self.clinic.wait_ready()
        self.found('scan_blind', remedy='rostopic echo -n1 /bot')
        blind = {item['about']: item['sure'] for item in self.report['findings']
                 if item['check'] == 'scan_blind'}
        self.assertEqual(set(blind), {'bot3', 'bot4', 'bot5'})
        self.assertEqual({name for name, sure in blind.items() if sure}, {'bot5'})

    def test_two_robots_with_the_same_frames(self):
        for name in ('bot3', 'bot4'):
            self.robot(name, '--frames', 'odom', 'base_footprint', wait=False)
        self.clinic.wait_ready()
        item = self.found('frames_same', about='bot3', remedy='tf_prefix')['frames_same']
        for word in ('bot4', 'odom', 'base_footprint'):
            self.assertIn(word, item['problem'])

    def test_two_robots_of_one_name(self):
        self.robot('bot3')
        self.clinic.patient('/bot3/other', '--odometry', 'odom')
        self.found('odometry_twice', about='bot3', remedy='a name of its own')

    def test_leftover_parameters(self):
        self.clinic.set('/bot9/robot_type', 'generic')
        self.found('robot_leftover', about='bot9', remedy='rosparam delete /bot9')

    def mend(self, command):
        """Do what a remedy says, as the one who reads it; nothing is wrong then."""
        subprocess.run(command, shell=True, check=True, env=self.clinic.system.env,
                       stdout=subprocess.DEVNULL)
        _, report = self.clinic.examine('--quick')
        self.assertEqual(wrong(report), {})

    def test_leftover_parameters_of_a_robot_without_a_namespace(self):
        self.clinic.set('/robot_type', 'generic')
        self.clinic.set('/robot_name', 'lonely')
        findings = self.found('robot_leftover', about='lonely')
        self.mend(findings['robot_leftover']['remedy'])

    def test_parameter_of_a_robot_without_a_namespace(self):
        self.clinic.set('/robot_type', 'turtlebot3')
        self.clinic.set('/robot_model', 'limousine')
        self.clinic.patient('/base', *ROBOT)
        findings = self.found('parameter_bad', about='robot')
        self.mend(findings['parameter_bad']['remedy'])

    def test_robot_without_a_namespace_that_nobody_hears(self):
        self.clinic.set('/robot_type', 'generic')
        self.clinic.patient('/base', '--odometry', 'odom')
        item = self.found('velocity_unheard', about='robot')['velocity_unheard']
        command = item['remedy'].partition('#')[0]
        listed = subprocess.run(command, shell=True, check=True, env=self.clinic.system.env,
                                stdout=subprocess.PIPE, universal_newlines=True).stdout
        self.assertIn('/odom', listed.split())

    def test_robot_that_is_not_there(self):
        item = self.found('robot_absent', about='bott1', remedy='turtle_remote.sh',
                          robots=['bott1'])['robot_absent']
        self.assertIn('is "bot1" meant?', item['problem'])

    def test_simulated_time_without_a_clock(self):
        self.clinic.set('/use_sim_time', True)
        self.found('sim_time', remedy='rosparam delete /use_sim_time')


if __name__ == '__main__':
    rostest.rosrun('mhri', 'doctor', DoctorTest)
