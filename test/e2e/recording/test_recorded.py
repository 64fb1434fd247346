# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A recorded bag against what was published. ``MHRI_LONG=1``: a minute instead of four seconds."""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

import rosbag
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import String

from mhri.recording.recording import ENDED, RECORDING
from mhri.recording.ros.recorder import Recorder
from support.own_node import own_node
from support.paths import SUPPORT
from support.ros_system import wait_for
from support.node_tools import measured

system = own_node('recorder')

SECONDS = 60.0 if os.environ.get('MHRI_LONG') == '1' else 4.0
ROBOTS = ['bot{}'.format(number + 1) for number in range(4)]


def content_of(path):
    """Return {topic: [count, SHA-1 of all messages in order]} of a bag."""
    found = {}
    with rosbag.Bag(path) as bag:
        for topic, raw, _ in bag.read_messages(raw=True):
            entry = found.setdefault(topic, [0, hashlib.sha1()])
            entry[0] += 1
            entry[1].update(raw[1])
    return {topic: [count, digest.hexdigest()] for topic, (count, digest) in found.items()}


def strings_of(path, topic):
    with rosbag.Bag(path) as bag:
        return [message.data for _, message, _ in bag.read_messages(topics=[topic])]


class RecorderTest(unittest.TestCase):
    """Each test records into a folder of its own."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix='mhri_recorder_')
        self.recorders = []

    def tearDown(self):
        for recorder in self.recorders:
            recorder.stop(wait=True)
        shutil.rmtree(self.folder)

    def record(self, robot, *topics):
        recorder = Recorder(robot, topics, os.path.join(self.folder, robot))
        self.recorders.append(recorder)
        recorder.start()
        return recorder

    def stop(self, recorder):
        """Stop, and return the path of the bag."""
        self.assertTrue(recorder.stop(wait=True), recorder.status())
        status = recorder.status()
        self.assertEqual(status.state, ENDED, status)
        self.assertEqual(os.listdir(os.path.dirname(status.path)).count(
            os.path.basename(status.path) + '.active'), 0)
        return status.path

    def test_bags_equal_what_was_sent(self):
        topics = ['/{}/imu'.format(robot) for robot in ROBOTS]
        recorders = [self.record(robot, topic, '/{}/imu/data'.format(robot))
                     for robot, topic in zip(ROBOTS, topics)]
        sender = subprocess.Popen(
            [sys.executable, str(SUPPORT / 'imu_sender.py'), str(SECONDS), '200']
            + topics, stdout=subprocess.PIPE)
        out, _ = sender.communicate(timeout=SECONDS + 60)
        self.assertEqual(sender.returncode, 0)
        sent = json.loads(out.decode().splitlines()[-1])
        self.assertEqual(sorted(sent), sorted(topics))
        for recorder, topic in zip(recorders, topics):
            wait_for(lambda: recorder.status().messages == sent[topic][0], 20, 'all messages')
            path = self.stop(recorder)
            self.assertEqual(content_of(path), {topic: sent[topic]})
            self.receipt_follows_the_stamp(path)
        print('MEASURED {:.0f} s of {} robots at 200 Hz: {} messages sent, {} in the bags'.format(
            SECONDS, len(ROBOTS), sum(count for count, _ in sent.values()),
            sum(recorder.status().messages for recorder in recorders)))

    def receipt_follows_the_stamp(self, path):
        """Check that the time of each message is that of its receipt."""
        with rosbag.Bag(path) as bag:
            lags = [(when - message.header.stamp).to_sec()
                    for _, message, when in bag.read_messages()]
        self.assertGreater(min(lags), -0.005)
        print('MEASURED receipt after the stamp: median {:.2f} ms, longest {:.1f} ms'.format(
            sorted(lags)[len(lags) // 2] * 1e3, max(lags) * 1e3))

    def test_latched_large_and_many(self):
        latched = rospy.Publisher('/bot5/name', String, queue_size=1, latch=True)
        latched.publish('said before')
        images = rospy.Publisher('/bot5/image', Image, queue_size=100)
        recorder = self.record('bot5', '/bot5/name', '/bot5/image', '/bot5/nothing')
        wait_for(lambda: images.get_num_connections() == 1, 10, 'the recorder')
        wait_for(lambda: recorder.status().messages == 1, 10, 'the latched message')
        picture = Image(height=480, width=640, encoding='rgb8', step=1920,
                        data=bytes(range(256)) * 3600)
        for _ in range(20):
            images.publish(picture)
        wait_for(lambda: recorder.status().messages == 21, 20, 'the pictures')
        path = self.stop(recorder)
        self.assertEqual(strings_of(path, '/bot5/name'), ['said before'])
        with rosbag.Bag(path) as bag:
            pictures = [message.data for _, message, _ in bag.read_messages('/bot5/image')]
            self.assertEqual(pictures, [picture.data] * 20)
            header, = (row[3] for row in bag.read_messages(
                '/bot5/name', return_connection_header=True))
            self.assertEqual(header['latching'], b'1')
        latched.unregister()
        images.unregister()

    def test_publishers_come_and_go(self):
        recorder = self.record('bot6', '/bot6/text')
        wanted = []
        for turn in range(3):
            publisher = rospy.Publisher('/bot6/text', String, queue_size=100)
            wait_for(publisher.get_num_connections, 10, 'the recorder to connect')
            for number in range(50):
                wanted.append('{} {}'.format(turn, number))
                publisher.publish(wanted[-1])
            wait_for(lambda: recorder.status().messages == len(wanted), 10, 'the messages')
            publisher.unregister()
        path = self.stop(recorder)
        self.assertEqual(strings_of(path, '/bot6/text'), wanted)
        with rosbag.Bag(path) as bag:
            info = bag.get_type_and_topic_info().topics['/bot6/text']
            self.assertEqual(info.connections, 1, 'one node and topic, one connection')

    def test_a_display_of_the_same_topic_disturbs_nothing(self):
        """A subscriber of rospy with a queue of one, in the same program, loses nothing here."""
        shown = []
        display = rospy.Subscriber('/bot7/text', String, shown.append, queue_size=1)
        publisher = rospy.Publisher('/bot7/text', String, queue_size=1000)
        recorder = self.record('bot7', '/bot7/text')
        wait_for(lambda: publisher.get_num_connections() == 2, 10, 'both')
        wanted = [str(number) for number in range(1000)]
        for text in wanted:
            publisher.publish(text)
        wait_for(lambda: recorder.status().messages == 1000, 10, 'the messages')
        self.assertEqual(strings_of(self.stop(recorder), '/bot7/text'), wanted)
        publisher.publish('after')
        wait_for(lambda: shown and shown[-1].data == 'after', what='the display, still alive')
        display.unregister()
        publisher.unregister()

    def test_low_rates_reach_the_disk_too(self):
        publisher = rospy.Publisher('/bot8/text', String, queue_size=10)
        recorder = self.record('bot8', '/bot8/text')
        wait_for(publisher.get_num_connections, 10, 'the recorder')
        active = recorder.status().path + '.active'
        publisher.publish('1')
        wait_for(lambda: b'\x01\x00\x00\x001' in open(active, 'rb').read(), 20, 'it on the disk')
        written = os.stat(active).st_mtime
        with rosbag.Bag(self.stop(recorder)) as bag:
            (_, message, when), = bag.read_messages()
        self.assertEqual(message.data, '1')
        measured('on the disk after', written - when.to_sec(), 1.0)

    def test_many_recordings_leave_nothing_behind(self):
        publisher = rospy.Publisher('/bot1/again', String, queue_size=10)
        threads = descriptors = None
        for turn in range(12):
            recorder = self.record('bot1', '/bot1/again', '/bot1/other')
            wait_for(publisher.get_num_connections, 10, 'the recorder')
            publisher.publish('x')
            wait_for(lambda: recorder.status().messages == 1, 10, 'the message')
            self.assertEqual(recorder.status().state, RECORDING)
            self.stop(recorder)
            wait_for(lambda: publisher.get_num_connections() == 0 or publisher.publish('y'), 10,
                     'the connection to end')
            if turn == 4:
                wait_for(lambda: not own_threads(), 10, 'the threads to end')
                threads, descriptors = threading.active_count(), open_files()
        wait_for(lambda: not own_threads(), 10, 'the threads to end')
        wait_for(lambda: threading.active_count() <= threads + 1, 10, 'all threads to end')
        wait_for(lambda: open_files() <= descriptors + 2, 10, 'all files to be closed')
        print('MEASURED after 5 and 12 recordings: threads {} and {}, files {} and {}'.format(
            threads, threading.active_count(), descriptors, open_files()))
        publisher.unregister()


def own_threads():
    names = ('bag_writer', 'raw_reader', 'raw_connect', 'tap_address', 'tap_mhri', 'recording')
    return [thread for thread in threading.enumerate() if thread.name.startswith(names)]


def open_files():
    return len(os.listdir('/proc/self/fd'))
