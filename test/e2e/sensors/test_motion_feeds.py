# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The feeds of graph and scan against real publishers: values, preference, impossible ones."""
from dataclasses import replace
import logging
import math
import threading
import time
import unittest

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
import numpy as np
import pytest
import rospy
from sensor_msgs.msg import Imu, LaserScan
from tf2_msgs.msg import TFMessage

from mhri.base.tf_tree import OdometryFrames
from mhri.graph.ros.log_throttle import quiet_repeats
from mhri.graph.ros.resources import robot_types
from mhri.sensors.gui.scan_view import scan_points
from mhri.sensors.ros.imu_feed import ImuFeed
from mhri.sensors.ros.lasers import Lasers
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('motion_feeds')

KIND = robot_types()[0]['generic']
HERE = OdometryFrames()
# No robot turns or drives so fast.
ABSURD = (1e30, 1.6e308, -1e30, math.inf, -math.inf, math.nan)


def imu(rate=0.5, lacks=()):
    message = Imu()
    message.orientation.z, message.orientation.w = math.sin(0.25), math.cos(0.25)
    message.angular_velocity.z, message.linear_acceleration.z = rate, 9.81
    for name in lacks:
        getattr(message, name + '_covariance')[0] = -1.0
    return message


def odometry(linear=0.3, angular=0.4):
    message = Odometry()
    message.twist.twist.linear.x, message.twist.twist.angular.z = linear, angular
    return message


def scan(ranges=(0.05, 1.5, math.inf, 3.6, math.nan, 3.5), step=0.5):
    return LaserScan(angle_min=-1.0, angle_increment=step, range_min=0.1, range_max=3.5,
                     ranges=ranges)


class Talk:
    """Publishes one message at a rate on a topic until it is stopped."""

    def __init__(self, topic, message, rate_hz=100.0):
        self._publisher = rospy.Publisher(topic, type(message), queue_size=10)
        self._message, self._period_s = message, 1.0 / rate_hz
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._done.wait(self._period_s):
            self._publisher.publish(self._message)

    def stop(self):
        self._done.set()
        self._thread.join()
        self._publisher.unregister()


class MotionFeedsTest(unittest.TestCase):

    def talk(self, topic, message, rate_hz=100.0):
        talk = Talk(topic, message, rate_hz)
        self.addCleanup(talk.stop)
        return talk

    def feed(self, made):
        made.open()
        self.addCleanup(made.close)
        return made

    def test_values(self):
        self.talk('/values/imu', imu())
        self.talk('/values/odom', odometry())
        feed = self.feed(ImuFeed('values', KIND))
        for key, value in (('linear', 0.3), ('yaw_rate', 0.4), ('gyro_z', 0.5), ('accel_z', 9.81),
                           ('yaw', 0.5), ('roll', 0.0)):
            wait_for(lambda: feed.take().latest(key) == pytest.approx(value), what=key)
            wait_for(lambda: len(feed.take().curve(key, 5)[0]) > 10, what='a curve of ' + key)

    def test_what_a_sensor_lacks_is_not_drawn(self):
        self.talk('/lacks/imu', imu(lacks=('orientation', 'linear_acceleration')))
        feed = self.feed(ImuFeed('lacks', KIND))
        wait_for(lambda: len(feed.take().curve('gyro_z', 5)[0]) > 10, what='the gyro')
        for key in ('yaw', 'accel_x'):
            wait_for(lambda: math.isnan(feed.take().latest(key) or 0.0), what=key)
            self.assertEqual(len(feed.take().curve(key, 5)[0]), 0)

    def test_bytes_are_read_where_another_subscriber_asked_for_those(self):
        first = rospy.Subscriber('/bytes/imu', rospy.AnyMsg, lambda message: None)
        self.addCleanup(first.unregister)
        self.talk('/bytes/imu', imu())
        feed = self.feed(ImuFeed('bytes', KIND))
        wait_for(lambda: feed.take().latest('gyro_z') == 0.5, what='a value out of bytes')

    def test_of_two_topics_the_first_that_speaks(self):
        self.talk('/two/imu/data', imu(rate=2.0))
        feed = self.feed(ImuFeed('two', KIND))
        wait_for(lambda: feed.take().latest('gyro_z') == 2.0, what='the second topic')
        first = Talk('/two/imu', imu(rate=1.0))
        # After a pause of this process either may come first.
        wait_for(lambda: set(feed.take().curve('gyro_z', 5)[1][-30:]) == {1.0},
                 what='the first topic alone')
        first.stop()
        wait_for(lambda: feed.take().latest('gyro_z') == 2.0, what='the second one again')

    def test_an_unknown_odometry_is_left_out(self):
        self.talk('/turtle/imu', imu())
        feed = self.feed(ImuFeed('turtle', replace(
            KIND, odometry=('pose',), odometry_type='turtlesim/Pose')))
        wait_for(lambda: feed.take().latest('gyro_z') == 0.5, what='the rest')
        self.assertIsNone(feed.take().latest('linear'))

    def test_a_scan_is_taken_once_and_says_what_is_no_measurement(self):
        talk = self.talk('/room/scan', scan(), 20.0)
        feed = self.feed(Lasers('room', KIND))
        ranges, *numbers = wait_for(lambda: feed.take(HERE), what='a scan')
        np.testing.assert_allclose(ranges, [math.nan, 1.5] + 4 * [math.nan])
        self.assertEqual(numbers, [-1.0, 0.5, 3.5])
        talk.stop()
        wait_for(lambda: feed.age_s() > 0.3, what='silence')
        wait_for(lambda: feed.take(HERE) is None, what='no scan twice')
        feed.close()
        self.assertIsNone(feed.age_s())

    def test_the_map_has_a_scan_from_where_the_laser_sits(self):
        """Ahead, turned about and upside down; before tf is heard, as its type says."""
        message = scan()
        message.header.frame_id = 'mounted/laser'
        self.talk('/mounted/scan', message)
        mount = TransformStamped(child_frame_id='mounted/laser')
        mount.header.frame_id = 'mounted/base'
        mount.transform.translation.x = 0.5
        mount.transform.rotation.y = 1.0
        static = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        self.addCleanup(static.unregister)
        self.talk('/mounted/rear_scan', scan())
        scans = self.feed(Lasers('mounted', replace(
            robot_types()[0]['turtlebot3'], scan=('scan', 'rear_scan'),
            lasers=((-0.1, 0.0, 0.0), (-0.2, 0.0, 0.0)))))
        found, lasers = [], set()

        def sits(x_m):
            taken = scans.each(OdometryFrames('mounted/base'))
            lasers.update(taken)
            found.extend(filter(None, [taken.get(0)]))
            return found and abs(found[-1][2][0].x_m - x_m) < 1e-6
        wait_for(lambda: sits(-0.1), 60, 'a scan')
        static.publish([mount])
        wait_for(lambda: sits(0.5), 60, lambda: 'the mount: {}'.format(found[-1][2]))
        _, _, (pose, turned_over) = found[-1]
        self.assertTrue(turned_over)
        self.assertAlmostEqual(abs(pose.heading_rad), math.pi)
        wait_for(lambda: sits(0.5) and lasers == {0, 1}, 60, 'the scans of both lasers')

    def test_a_tile_sees_with_all_lasers_of_its_robot(self):
        """The one behind is turned about; what it saw goes when it falls silent."""
        ahead, behind = (LaserScan(range_min=0.1, range_max=3.5, angle_increment=0.01,
                                   ranges=[distance]) for distance in (2.0, 1.0))
        ahead.header.frame_id, behind.header.frame_id = 'twin/base', 'twin/rear'
        self.talk('/twin/scan', ahead)
        rear = self.talk('/twin/rear_scan', behind)
        mount = TransformStamped(child_frame_id='twin/rear')
        mount.header.frame_id = 'twin/base'
        mount.transform.rotation.z = 1.0
        self.talk('/tf', TFMessage([mount]))
        lasers, seen = self.feed(Lasers('twin', replace(
            robot_types()[0]['turtlebot3'], scan=('scan', 'rear_scan')))), {}

        def sees(*wanted):
            found = lasers.take(OdometryFrames('twin/base'))
            if found is not None:
                x, y, _ = scan_points(*found[:3])
                seen['points'] = sorted(zip(np.round(x, 1), np.round(y, 1)))
            return seen.get('points') == sorted(wanted)
        wait_for(lambda: sees((2.0, 0.0), (-1.0, 0.0)), 60, lambda: 'both, seen {}'.format(seen))
        rear.stop()
        wait_for(lambda: sees((2.0, 0.0)), 60, lambda: 'one alone, seen {}'.format(seen))

    def log_lines(self):
        """Return a list of what is logged from now on."""
        lines, handler = [], logging.Handler()
        handler.emit = lambda record: lines.append(record.getMessage())
        logging.getLogger('rosout').addHandler(handler)
        self.addCleanup(logging.getLogger('rosout').removeHandler, handler)
        return lines

    def publisher(self, topic, kind):
        made = rospy.Publisher(topic, kind, queue_size=1000)
        self.addCleanup(made.unregister)
        wait_for(made.get_num_connections, what='the subscriber')
        return made

    def test_impossible_values_are_left_out_and_logged_once_a_second(self):
        lines, begun = self.log_lines(), time.monotonic()
        feed = self.feed(ImuFeed('wild', KIND))
        imus, odoms = self.publisher('/wild/imu', Imu), self.publisher('/wild/odom', Odometry)
        for _ in range(50):
            for value in ABSURD:
                imus.publish(imu(value))
                odoms.publish(odometry(value, value))
        imus.publish(imu(0.25))
        wait_for(lambda: feed.take().latest('gyro_z') == 0.25, what='the next good value')
        self.assertGreater(feed.refused(), 100)
        self.assertTrue(0 < len(lines) <= 2 * (time.monotonic() - begun + 1.0), lines)
        for key in ('gyro_z', 'linear', 'yaw_rate'):
            _, y = feed.take().curve(key, 5)
            self.assertLessEqual(set(y[y == y]), {0.25}, key)

    def test_a_scan_that_cannot_be_is_refused_and_a_large_one_thinned(self):
        feed = self.feed(Lasers('many', KIND))
        scans = self.publisher('/many/scan', LaserScan)
        refused = [scan([2.0] * 1_000_000, 6.28e-6), scan([1.0] * 360, math.nan),
                   scan([1.0] * 360, 3e38)]
        for message in refused + [scan([-1e30, 3e38, 2.0] * 33_333, 6.28e-5)]:
            scans.publish(message)
        ranges, first, step, _ = wait_for(lambda: feed.take(HERE), what='the scan that can be')
        self.assertEqual(feed.refused(), len(refused))
        self.assertLessEqual(len(ranges), 4000)
        self.assertEqual(set(ranges), {2.0})
        self.assertAlmostEqual(step * (len(ranges) - 1), 6.28, delta=0.02)

    def test_a_callback_that_fails_is_logged_once_a_second(self):
        """As one does that reads torn bytes: rospy logs a traceback for each message."""
        quiet_repeats()
        lines, failed = self.log_lines(), []

        def fail(message):
            failed.append(message)
            raise ValueError('torn')
        subscriber = rospy.Subscriber('/garbled/odom', Odometry, fail)
        self.addCleanup(subscriber.unregister)
        publisher, begun = self.publisher('/garbled/odom', Odometry), time.monotonic()
        for _ in range(100):
            publisher.publish(odometry())
        wait_for(lambda: len(failed) == 100, what='all messages')
        count = len([line for line in lines if 'bad callback' in line])
        self.assertTrue(0 < count <= time.monotonic() - begun + 1.0, count)
