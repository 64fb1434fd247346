# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How long mhri_doctor takes with a large system, and what it does without."""
import unittest

from support.surgery import BlackHole, Clinic

TWIST, ODOMETRY = 'geometry_msgs/Twist', 'nav_msgs/Odometry'
ROBOTS = 12
PROMISED_S = 3.0
# What does not end in time at all takes minutes; a machine under load, a few seconds more.
LOADED_S = 10.0


class TimeTest(unittest.TestCase):
    """How long the whole command takes, as the one who gave it sees it."""

    @classmethod
    def setUpClass(cls):
        cls.clinic = clinic = Clinic()
        cls.addClassCleanup(clinic.system.close)
        clinic.start_light()
        holes = [BlackHole(), BlackHole('127.0.0.98')]
        for number in range(1, ROBOTS + 1):
            name = 'bot{}'.format(number)
            clinic.set('/{}/robot_type'.format(name), 'generic')
            if number > ROBOTS - len(holes):
                hole = holes[number - ROBOTS - 1]
                cls.addClassCleanup(hole.close)
                for node in ('base', 'camera', 'scan', 'diagnostics'):
                    clinic.register('/{}/{}'.format(name, node), '/{}/odom'.format(name), hole.uri,
                                    ODOMETRY)
            else:
                clinic.patient('/{}/base'.format(name), '--odometry', 'odom', '--subscribe',
                               'cmd_vel', TWIST, wait=False)
        clinic.wait_ready()

    def quickest(self):
        """Return how long the quickest of some examinations takes, which has to be right.

        The promise is for a machine that has the time; one that other programs load is given more
        tries, and a limit in which none hangs.
        """
        best = None
        for _ in range(8):
            status, report = self.clinic.examine()
            self.assertEqual(status, 1)
            self.assertLess(report['wall_s'], LOADED_S)
            self.assertLessEqual(report['took_s'], report['wall_s'] + 0.02)
            best = min(best or report, report, key=lambda item: item['wall_s'])
            if best['wall_s'] < PROMISED_S:
                break
        print('MEASURED mhri_doctor, {} robots, 2 out of reach: {:.2f} s (promised: {:g} '
              's)'.format(ROBOTS, best['wall_s'], PROMISED_S))
        about = [item['about'] for item in best['findings'] if item['severity'] != 'fine']
        self.assertEqual(sorted(about), ['bot11', 'bot12'])
        self.assertLess(best['wall_s'] - best['took_s'], 1.0, 'the time told is too short')
        return best['wall_s']

    def test_twelve_robots_of_which_two_are_out_of_reach(self):
        self.assertLess(self.quickest(), PROMISED_S)

    def test_help_is_there_at_once(self):
        """It needs a few modules of Python's own; OpenCV alone would take a second."""
        for arguments in (['--help'], ['--nonsense']):
            done = self.clinic.run(*arguments, env={'PYTHONPROFILEIMPORTTIME': '1'})
            modules = {line.rpartition('|')[2].strip() for line in done.stderr.splitlines()
                       if line.startswith('import time:')}
            self.assertIn('mhri.nodes.mhri_doctor', modules)
            self.assertEqual(modules & {'cv2', 'numpy', 'rospy', 'mhri.doctor.ros.examination'},
                             set())

    def test_examination_does_without_large_libraries(self):
        done = self.clinic.run('bot1', env={'PYTHONPROFILEIMPORTTIME': '1'})
        modules = {line.rpartition('|')[2].strip() for line in done.stderr.splitlines()}
        self.assertIn('mhri.doctor.ros.examination', modules)
        self.assertEqual(modules & {'cv2', 'rospy'}, set())
