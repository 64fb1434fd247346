# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every fault of the simulator, as the operator's row, events and views tell it."""
import math
import time
import unittest

from geometry_msgs.msg import PoseStamped
import rospy
from sensor_msgs.msg import Image, LaserScan

from mhri.events.changes import ScreenChanges
from mhri.recording.recording import RecordingStatus
from mhri.screen.ros.backend import ScreenBackend
from mhri.sim.faults import FAULTS
from mhri.srv import SetFault
from support.own_node import own_node
from support.ros_system import wait_for
from support.node_tools import Recorder

system = own_node('sim_faults', 'sim_faults.launch')

TIMEOUT_S = 90.0
SILENT_S = 1.0
LONG_S = 600.0
NAN = float('nan')


class SimFaults(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.operator = ScreenBackend(['panel'])
        cls.operator.start()
        cls.operator.add('bot1')
        cls.operator.request_limits(0.2, 1.0)
        cls.changes = ScreenChanges(lambda _: RecordingStatus())
        cls.stick = (0.0, 0.0)
        cls.events = []
        wait_for(lambda: cls.operator.view().ros == 'connected', TIMEOUT_S, 'the screen')
        cls.set_fault = rospy.ServiceProxy('/bot1/base/set_fault', SetFault)
        cls.set_fault.wait_for_service(TIMEOUT_S)

    @classmethod
    def tearDownClass(cls):
        cls.operator.close()

    def setUp(self):
        self.see_until(lambda row: row.link == 'live' and not row.moving, 'a robot at rest')
        self.events.clear()
        self.addCleanup(self.heal)

    def heal(self):
        type(self).stick = (0.0, 0.0)
        self.ask('all', duration_s=-1.0)

    def ask(self, fault, value=NAN, duration_s=LONG_S, good=True):
        answer = self.set_fault(fault, value, duration_s)
        self.assertEqual(answer.success, good, answer.message)
        return answer.message

    def look(self):
        """Do what a screen does 20 times a second; return the row of the robot."""
        self.operator.select(['bot1'])
        self.operator.repeat_selection()
        view = self.operator.view()
        self.status = view.status
        ready = view.robots[0].driven or 'ready' in view.status
        self.operator.send_stick(*(self.stick if ready else (0.0, 0.0)))
        self.events += self.changes.update(view, time.monotonic())
        return view.robots[0]

    def see_until(self, good, what):
        wait_for(lambda: good(self.look()), TIMEOUT_S, lambda: '{}; {}; {}'.format(
            what, self.look(), self.status), poll_s=0.05)

    def hear(self, kind, word=''):
        """Wait for an event of a kind with a word in it; return its text."""
        def texts():
            return [change.text for change in self.events
                    if change.kind.startswith(kind) and word in change.text]
        self.see_until(lambda _: texts(), kind)
        return texts()[0]

    def drive(self, good, what):
        type(self).stick = (1.0, 0.0)
        self.see_until(good, what)

    def falls_silent(self, recorder, fault):
        """See that a topic comes, falls silent on request, and comes again."""
        self.addCleanup(recorder.close)
        recorder.wait(lambda _: True, patience_s=TIMEOUT_S)
        self.ask(fault)
        recorder.wait_silence(SILENT_S, TIMEOUT_S)
        self.see_until(lambda row: row.link == 'live', 'a live robot')
        self.ask(fault, duration_s=-1.0)
        recorder.wait(lambda _: True, time.monotonic(), TIMEOUT_S)

    def test_wrong_words_are_refused_with_the_remedy(self):
        self.assertIn('there are odometry_silent, ', self.ask('deley', good=False))
        self.assertIn('from 0.01 to 5 s', self.ask('delay', 70.0, good=False))
        self.assertIn('give a duration', self.ask('node_dead', duration_s=0.0, good=False))
        self.assertEqual(self.ask(''), 'bot1: no faults active')

    def test_odometry_silent(self):
        self.ask('odometry_silent')
        self.hear('link.lost', 'nothing for')
        self.see_until(lambda row: row.note.startswith('nothing for'), 'the row to say it')

    def test_camera_silent(self):
        self.falls_silent(Recorder('/bot1/camera/rgb/image_raw', Image, lambda _: True),
                          'camera_silent')

    def test_scan_silent(self):
        self.falls_silent(Recorder('/bot1/scan', LaserScan, lambda _: True), 'scan_silent')

    def test_delay(self):
        self.ask('delay', 0.4)
        self.see_until(lambda row: 'slow link' in row.note and row.figures.round_trip_s >= 0.8,
                       'the row to say it')

    def test_loss(self):
        self.ask('loss', 40.0)
        self.see_until(lambda row: '% of its messages lost' in row.note, 'the row to say it')

    def test_clock_off(self):
        self.ask('clock_off', 7.0)
        self.see_until(lambda row: 's ahead: set both by chrony' in row.note, 'the row to say it')

    def test_motor_stuck_and_wheel_slow(self):
        for fault in ('motor_stuck', 'wheel_slow'):
            self.ask(fault)
            self.drive(lambda row: row.moving and row.angular_rad_s > 0.1, 'it to turn')
            self.ask(fault, duration_s=-1.0)
            self.see_until(lambda row: row.moving and abs(row.angular_rad_s) < 0.1, 'it to mend')

    def test_drift(self):
        true = Recorder('/vrpn_client_node/bot1/pose', PoseStamped, lambda message: (
            2.0 * math.atan2(message.pose.orientation.z, message.pose.orientation.w)))
        self.addCleanup(true.close)
        begun = true.wait(lambda _: True, patience_s=TIMEOUT_S).value
        heading = self.look().heading_rad
        self.ask('drift', 60.0)
        self.drive(lambda _: abs(math.remainder(true.last() - begun, math.tau)) > 0.3,
                   'the robot to turn in truth')
        self.assertLess(abs(math.remainder(self.look().heading_rad - heading, math.tau)), 0.15)

    def test_battery_falling(self):
        self.ask('battery_falling', 3000.0)
        self.assertIn('charge it', self.hear('battery.'))

    def test_computer_frozen(self):
        self.ask('computer_frozen')
        self.hear('link.lost', 'nothing for')
        self.see_until(lambda row: row.figures.round_trip_s is None, 'its answers to fail')
        self.ask('computer_frozen', duration_s=-1.0)
        self.hear('link.back')

    def test_node_dead(self):
        place = Recorder('/vrpn_client_node/bot1/pose', PoseStamped,
                         lambda message: message.pose.position.x)
        self.addCleanup(place.close)
        before = place.wait(lambda _: True, patience_s=TIMEOUT_S).value
        self.ask('node_dead', duration_s=4.0)
        self.hear('link.lost')
        self.hear('link.back')
        after = place.wait(lambda _: True, time.monotonic(), TIMEOUT_S).value
        self.assertAlmostEqual(before, after, 2)

    def test_person_in_the_way(self):
        scan = Recorder('/bot1/scan', LaserScan, lambda message: message.ranges[0])
        self.addCleanup(scan.close)
        free = scan.wait(lambda _: True, patience_s=TIMEOUT_S).value
        self.ask('person', 0.6)
        # From the laser, in the middle of a Burger, to a person 0.6 m before its front.
        scan.wait(lambda ahead: abs(ahead - 0.705) < 0.1, patience_s=TIMEOUT_S)
        self.ask('person', duration_s=-1.0)
        scan.wait(lambda ahead: ahead > 0.9 or ahead == free, time.monotonic(), TIMEOUT_S)

    def test_no_fault_is_left_out(self):
        told = ' '.join(name for name in dir(self) if name.startswith('test_'))
        self.assertEqual([fault.key for fault in FAULTS if fault.key not in told], [])
