# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_doctor in environments that are wrong, and trying watchdogs."""
import importlib.util
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import unittest
from xmlrpc.server import SimpleXMLRPCServer


import mhri.msg
from mhri.graph.ros.resources import resource_path

from support.paths import REPO
from support.ros_system import free_port, System, wait_for
from support.surgery import BlackHole, Clinic, EXAMINE_S, wrong


def server(test):
    """Return the URI of an XML-RPC server that is no ROS node."""
    found = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
    threading.Thread(target=found.serve_forever, kwargs={'poll_interval': 0.01},
                     daemon=True).start()
    test.addCleanup(found.server_close)
    test.addCleanup(found.shutdown)
    return 'http://127.0.0.1:{}'.format(found.server_address[1])


class EnvironmentTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.clinic = Clinic()
        cls.addClassCleanup(cls.clinic.system.close)
        cls.clinic.start_light()

    def found(self, *checks, remedy=None, **options):
        """Examine; these checks are wrong, and the remedy of the first says this."""
        status, report = self.clinic.examine_until(checks, '--quick', **options)
        findings = wrong(report)
        self.assertEqual(status, 1)
        for item in findings.values():
            print('FOUND {check}: {about}: {problem} | {symptom} | {remedy}'.format(**item))
        self.problem = findings[checks[0]]['problem']
        self.assertIn(remedy or '', findings[checks[0]]['remedy'])

    def test_host_name_that_does_not_resolve(self):
        self.found('address_unresolved', remedy='unset ROS_HOSTNAME', unset=['ROS_IP'],
                   env={'ROS_HOSTNAME': 'no-such-name.invalid'})

    def test_master_that_does_not_answer_while_another_does(self):
        self.found('master_elsewhere', remedy='export ROS_MASTER_URI=' + self.clinic.uri,
                   env={'ROS_MASTER_URI': 'http://127.0.0.1:{}'.format(free_port())})

    def test_master_that_answers_but_is_the_wrong_one(self):
        with System(adopt=False) as wrong_one:
            wrong_one.start_master()
            uri = wrong_one.env['ROS_MASTER_URI']
            self.found('mux_missing', remedy='export ROS_MASTER_URI=' + self.clinic.uri,
                       env={'ROS_MASTER_URI': uri})

    def test_folder_that_cannot_be_made(self):
        with tempfile.NamedTemporaryFile() as file:
            self.found('folder_unwritable', remedy='ROS_HOME',
                       env={'ROS_HOME': os.path.join(file.name, 'ros')})

    def folder(self):
        """Return a folder that is there until the end of the test."""
        folder = tempfile.mkdtemp(prefix='mhri_test_')
        self.addCleanup(shutil.rmtree, folder)
        return folder

    def behind_a_disk(self, folder):
        """Return the words that run a command for which a folder is a small empty disk."""
        mount = 'mount -t tmpfs -o size=1m none "$0" && exec "$@"'
        own = ['unshare', '--mount', 'sh', '-c', mount, folder]
        if not shutil.which('unshare') or subprocess.run(
                own + ['true'], stderr=subprocess.DEVNULL).returncode:
            self.skipTest('a small disk needs root and mount namespaces')
        return own

    def test_disk_that_is_full(self):
        folder = self.folder()
        self.found('disk_full', remedy='rosclean purge', prefix=self.behind_a_disk(folder),
                   env={'ROS_HOME': folder})

    def test_module_that_was_uninstalled(self):
        """Of a package that was taken away, its folder stays where something is in it."""
        place = os.path.dirname(importlib.util.find_spec('evdev').origin)
        self.found('package_missing', remedy='sudo apt install python3-evdev',
                   prefix=self.behind_a_disk(place))

    def test_another_workspace_for_python(self):
        """Its setup.bash was sourced, and then that of this one by a line that lacks Python."""
        other = self.folder()
        source = str(REPO / 'src')
        shutil.copytree(os.path.join(source, 'mhri'), os.path.join(other, 'mhri'))
        shutil.copytree(mhri.msg.__path__[0], os.path.join(other, 'mhri', 'msg'))
        self.found('workspace_two', remedy='source one workspace only',
                   env={'PYTHONPATH': '{}:{}'.format(other, os.environ['PYTHONPATH'])})

    def test_another_workspace_for_rosrun_and_a_package_that_it_wants(self):
        other = os.path.join(self.folder(), 'mhri')
        shutil.copytree(resource_path(), os.path.join(other, 'resource'))
        with open(resource_path('..', 'package.xml'), encoding='utf-8') as file:
            package = file.read()
        wants = '<exec_depend>rospy</exec_depend>'
        self.assertIn(wants, package)
        with open(os.path.join(other, 'package.xml'), 'w', encoding='utf-8') as file:
            file.write(package.replace(wants, wants + wants.replace('rospy', 'kobuki_driver')))
        self.found('package_missing', 'workspace_two', remedy='sudo apt install ros-noetic-kobuki',
                   env={'ROS_PACKAGE_PATH': '{}:{}'.format(other, os.environ['ROS_PACKAGE_PATH']),
                        'ROS_DISTRO': 'noetic'})

    def test_workspace_that_is_not_sourced(self):
        self.found('workspace_missing', remedy='devel/setup.bash', unset=['ROS_PACKAGE_PATH'])

    def test_own_pad_profile_that_is_broken(self):
        folder = self.folder()
        pads = os.path.join(folder, 'mhri', 'pads')
        os.makedirs(pads)
        with open(os.path.join(pads, 'attic.yaml'), 'w') as file:
            file.write('name: attic\nforward: {axis: left}\n')
        self.found('pad_bad', remedy='page Pad', env={'ROS_HOME': folder})
        self.assertIn('attic.yaml', self.problem)

    def test_why_there_is_no_mux(self):
        """Not only that there is none, and what its file has wrong while one still runs."""
        broken = os.path.join(self.folder(), 'lab_mux.yaml')
        with open(broken, 'w') as file:
            file.write('sources: [{name: pad, topic: 7}]\n')
        self.clinic.master.setParam('/mux/config', broken)
        self.addCleanup(self.clinic.master.deleteParam, '/mux/config')
        for running in (True, False):
            if not running:
                self.clinic.stop('/mhri_mux')
                self.addCleanup(self.clinic.start_light)
            self.found('mux_config_bad', remedy='rosrun mhri mux')
            self.assertIn(broken, self.problem)
            self.assertIn('sources[0]', self.problem)

    def test_wrong_use(self):
        for arguments in (['bot1; reboot'], ['--nonsense'], ['--watchdog'], ['--yes'],
                          ['bot1', '--watchdog']):
            done = self.clinic.run(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertIn('mhri_doctor: error:', done.stderr)


class NoMasterTest(unittest.TestCase):
    """There is no master on this computer, unless somebody else has one."""

    @classmethod
    def setUpClass(cls):
        cls.clinic = Clinic()
        cls.addClassCleanup(cls.clinic.system.close)
        cls.clinic.start_light()
        cls.node_uri = cls.clinic.master.lookupNode('/mhri_mux')
        cls.clinic.system.kill(cls.clinic.system.master)

    def master(self, uri, check, remedy):
        """Examine with this master, of which this is said, or that one is elsewhere."""
        findings = wait_for(lambda: next((one for one in [
            wrong(self.clinic.examine('--quick', env={'ROS_MASTER_URI': uri})[1])]
            if 'master_elsewhere' in one or set(one) == {check}), None), EXAMINE_S, check)
        if 'master_elsewhere' in findings:
            self.assertNotIn(uri, findings['master_elsewhere']['remedy'])
        else:
            self.assertIn(remedy, findings[check]['remedy'])

    def test_master_that_is_not_there(self):
        hole = BlackHole()
        self.addCleanup(hole.close)
        for uri, check, remedy in (
                ('http://127.0.0.1:{}'.format(free_port()), 'master_refused',
                 'roslaunch mhri mhri.launch'),
                (hole.uri, 'master_silent', 'ping -c 3'),
                ('http://no-such-name.invalid:11311', 'master_unresolved', '/etc/hosts'),
                (server(self), 'master_stranger', 'export ROS_MASTER_URI=')):
            self.master(uri, check, remedy)


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

    @staticmethod
    def commands(process):
        """Return the turns that a robot was commanded [rad/s]."""
        with open(process.log, encoding='utf-8') as log:
            return [float(line.split()[1]) for line in log
                    if line.startswith('told') and line.endswith('\n')]

    def test_robot_that_stops_by_itself(self):
        self.robot('--watchdog', '0.5')
        status, report = self.clinic.examine_until((), 'bot1', '--watchdog', '--yes')
        first = report['findings'][0]
        self.assertEqual((status, first['check'], first['severity']), (0, 'watchdog', 'fine'))
        print('MEASURED', first['problem'])

    def test_robot_without_a_watchdog_is_found_and_left_at_rest(self):
        process = self.robot()
        report = self.clinic.examine_until(['watchdog_none'], 'bot1', '--watchdog', '--yes')[1]
        item = wrong(report)['watchdog_none']
        self.assertIn('mhri_guard', item['remedy'])
        # The robot may print later than the doctor ends.
        wait_for(lambda: self.commands(process)[-5:] == [0.0] * 5, 30.0, 'zeros at the end')
        self.assertIn(0.3, self.commands(process))
        self.assertNotIn('/mhri_doctor', str(self.clinic.nodes()))

    def test_interrupted_trial_ends_with_zeros(self):
        process = self.robot()
        doctor = self.clinic.begin('bot1', '--watchdog', '--yes')
        wait_for(lambda: 0.3 in self.commands(process), 30.0, 'the robot to turn')
        doctor.send_signal(signal.SIGTERM)
        self.assertNotEqual(doctor.wait(30.0), 0)
        wait_for(lambda: self.commands(process)[-1] == 0.0, 30.0, 'zeros')

    def test_robot_that_is_selected_is_not_touched(self):
        process = self.robot()
        self.clinic.patient('/mhri_panel', '--select', 'bot1')
        wait_for(lambda: 'selected' in wrong(self.clinic.examine('bot1', '--watchdog', '--yes')[1])[
            'watchdog_unknown']['problem'], EXAMINE_S, 'the reason')
        self.assertEqual(self.commands(process), [])
