# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sensors of any kind on the topics of a robot, as its row shows them."""
import math
import unittest

import rospy
from sensor_msgs.msg import BatteryState, Range
from std_msgs.msg import Bool, Float32

from mhri.base.robot_types import resolve_robot_type
from mhri.driving.ros.drive_client import DriveClient
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.worker import Worker
from mhri.robots.ros.bot_feeds import BotFeeds
from mhri.robots.ros.robot_monitor import RobotMonitor
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('readouts')

ROWS = {
    'gas': {'kind': 'readout', 'topic': 'gas', 'type': 'std_msgs/Float32', 'unit': 'ppm',
            'warn': 50},
    'bumper': {'kind': 'readout', 'topic': 'bumper', 'type': 'std_msgs/Bool', 'warn': 0.5},
    'sonar': {'kind': 'readout', 'topic': 'sonar', 'type': 'sensor_msgs/Range', 'field': 'range'},
    'cell': {'kind': 'readout', 'topic': 'cells', 'type': 'sensor_msgs/BatteryState',
             'field': 'cell_voltage[1]', 'unit': 'V'},
    'hat': {'kind': 'readout', 'topic': 'hat', 'type': 'std_msgs/Float32', 'optional': True},
    'odour': {'kind': 'readout', 'topic': 'odour', 'type': 'no_such_msgs/Odour'},
    'coat': {'kind': 'readout', 'topic': 'coat', 'type': 'no_such_msgs/Coat', 'optional': True},
    'colour': {'kind': 'readout', 'topic': 'colour', 'type': 'std_msgs/String'},
    'taste': {'kind': 'readout', 'topic': 'taste', 'type': 'std_msgs/Float32', 'field': 'sweet'},
    'lamp': {'kind': 'toggle', 'topic': 'lamp', 'on_stop': 'keep'}}


class ReadoutsTest(unittest.TestCase):

    def setUp(self):
        types, _ = robot_types()
        kind, errors = resolve_robot_type(types, 'bot1', {
            'robot_type': 'generic', 'mhri': {'accessories': ROWS}})
        self.assertFalse(errors)
        self.link = RobotMonitor('bot1', kind, DriveClient(lambda *_: None),
                                 BotFeeds('bot1', kind, Worker('feeds').start()))
        self.addCleanup(self.link.close)

    def seen(self, key):
        return {view.spec.key: view for view in self.link.view().accessories}[key]

    def keys(self):
        return [view.spec.key for view in self.link.view().accessories]

    def publisher(self, topic, kind, key=''):
        """Return the publisher of a sensor once it is connected."""
        found = rospy.Publisher('/bot1/' + topic, kind, queue_size=10)
        self.addCleanup(found.unregister)
        wait_for(lambda: found.get_num_connections()
                 and 'received' in self.seen(key or topic).stands, what='the connection')
        return found

    def test_the_newest_number_counts_in_the_order_of_the_rows(self):
        self.assertEqual(self.keys(), [key for key in ROWS if key not in ('hat', 'coat')])
        self.assertIn('std_msgs/Float32', self.seen('gas').stands)
        gas = self.publisher('gas', Float32)
        self.assertEqual((self.seen('gas').known, self.seen('gas').value), (False, ()))
        for value in (3.5, 60.0):
            gas.publish(value)
            wait_for(lambda: self.seen('gas').value == (value,), what='the value')
            self.assertEqual((self.seen('gas').known, self.seen('gas').stands), (True, ''))
        for value in (math.inf, math.nan, 1e30):
            gas.publish(3.5)
            wait_for(lambda: self.seen('gas').value == (3.5,), what='a value between')
            gas.publish(value)
            wait_for(lambda: math.isnan(self.seen('gas').value[0]), what='no number')
        gas.unregister()
        wait_for(lambda: self.seen('gas').stands, what='the end of its publisher')
        self.assertTrue(self.seen('gas').known)

    def test_fields_and_true_or_false(self):
        self.publisher('sonar', Range).publish(range=0.25)
        wait_for(lambda: self.seen('sonar').value == (0.25,), what='the sonar')
        bumper = self.publisher('bumper', Bool)
        bumper.publish(True)
        wait_for(lambda: self.seen('bumper').value == (1.0,), what='the bumper')
        bumper.publish(False)
        wait_for(lambda: self.seen('bumper').value == (0.0,), what='its release')

    def test_an_element_of_an_array_and_one_that_is_missing(self):
        cells = self.publisher('cells', BatteryState, 'cell')
        for voltages, value in (([3.5, 3.25], 3.25), ([3.5], None)):
            cells.publish(cell_voltage=voltages)
            wait_for(lambda: self.seen('cell').value and (
                self.seen('cell').value == (value,) if value
                else math.isnan(self.seen('cell').value[0])), what='the cell')

    def test_one_that_is_optional_is_there_once_it_is_published(self):
        hat = rospy.Publisher('/bot1/hat', Float32, queue_size=10)
        self.addCleanup(hat.unregister)
        wait_for(lambda: hat.get_num_connections() and 'hat' in self.keys(), what='the sensor')
        self.assertNotIn('coat', self.keys())
        hat.publish(1.0)
        wait_for(lambda: self.seen('hat').known, what='its value')
        hat.unregister()
        wait_for(lambda: self.seen('hat').stands, what='its end')

    def test_what_cannot_be_read_is_said_and_harms_nothing(self):
        for key, word in (('odour', 'no_such_msgs'), ('colour', 'std_msgs/String'),
                          ('taste', 'sweet')):
            self.assertIn(word, self.seen(key).stands)
            self.assertFalse(self.seen(key).known)
        self.assertEqual((self.seen('lamp').known, self.seen('lamp').stands), (False, ''))
