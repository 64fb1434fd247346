#!/usr/bin/env python3
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
import time
import unittest

import rosbag
import rospy
import rostest
from sensor_msgs.msg import Image, Imu
from std_msgs.msg import String

SUPPORT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..')
sys.path.insert(0, SUPPORT)

from mhri.recording.recording import ENDED, RECORDING  # noqa: E402
from mhri.recording.ros.recorder import Recorder  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

SECONDS = 60.0 if os.environ.get('MHRI_LONG') == '1' else 4.0
ROBOTS = ['bot{}'.format(number + 1) for number in range(4)]


def in_file_order(bag):
    """Return the index entries of a bag (time, topic) in the order in which they stand in it."""
    entries = [(entry.chunk_pos, entry.offset, entry.time.to_nsec(), bag._connections[number].topic)
               for number, index in bag._connection_indexes.items() for entry in index]
    return [entry[2:] for entry in sorted(entries)]


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


def run(*command):
    """Run a tool; return what it said."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
    assert done.returncode == 0, done.stdout.decode()
    return done.stdout.decode()


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
            [sys.executable, os.path.join(SUPPORT, 'support', 'imu_sender.py'), str(SECONDS), '200']
            + topics, stdout=subprocess.PIPE)
        wait_for(lambda: all(recorder.status().rate_hz > 150 for recorder in recorders), 20,
                 'four robots at 200 Hz')
        out, _ = sender.communicate(timeout=SECONDS + 60)
        self.assertEqual(sender.returncode, 0)
        sent = json.loads(out.decode().splitlines()[-1])
        self.assertEqual(sorted(sent), sorted(topics))
        for recorder, topic in zip(recorders, topics):
            path = self.stop(recorder)
            self.assertEqual(content_of(path), {topic: sent[topic]})
            self.assertEqual(recorder.status().messages, sent[topic][0])
            self.times_are_in_order(path)
        print('MEASURED {:.0f} s of {} robots at 200 Hz: {} messages sent, {} in the bags'.format(
            SECONDS, len(ROBOTS), sum(count for count, _ in sent.values()),
            sum(recorder.status().messages for recorder in recorders)))
        self.read_by_the_tools(recorders[0].status().path, topics[0], sent[topics[0]][0])

    def times_are_in_order(self, path):
        """Receipt times never go back, and each is later than the stamp by little."""
        with rosbag.Bag(path) as bag:
            times = [time_ns for time_ns, _ in in_file_order(bag)]
            lags = [(when - message.header.stamp).to_sec()
                    for _, message, when in bag.read_messages()]
        self.assertEqual(times, sorted(times))
        self.assertGreater(min(lags), -0.005)
        print('MEASURED receipt after the stamp: median {:.2f} ms, longest {:.1f} ms'.format(
            sorted(lags)[len(lags) // 2] * 1e3, max(lags) * 1e3))

    def read_by_the_tools(self, path, topic, count):
        self.assertIn('{} msgs'.format(count), run('rosbag', 'info', path))
        self.assertIn('does not need any migrations', run('rosbag', 'check', path))
        played = []
        subscriber = rospy.Subscriber(topic, Imu, played.append, queue_size=100000)
        run('rosbag', 'play', '--wait-for-subscribers', '-q', '-r', '4', path)
        wait_for(lambda: len(played) == count, 10, 'all messages to be played')
        subscriber.unregister()

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
            header = bag._get_connections(['/bot5/name']).__next__().header
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
            self.assertEqual(len(bag._connections), 1, 'one node and topic, one connection')

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
        self.assertIsInstance(shown[0], String)
        publisher.publish('after')
        wait_for(lambda: shown[-1].data == 'after', 5, 'the display, still alive')
        display.unregister()
        publisher.unregister()

    def test_messages_of_this_program(self):
        """What it sends itself is put in, without a subscription; low rates reach the disk, too."""
        recorder = self.record('bot8')
        wait_for(lambda: recorder.status().path, 5, 'the file')
        wait_for(lambda: recorder.put('/bot8/cmd', String('0')) or recorder.status().messages, 5,
                 'the first message')
        recorder.put('/bot8/cmd', String('1'))
        active = recorder.status().path + '.active'
        since = time.monotonic()
        wait_for(lambda: b'\x01\x00\x00\x001' in open(active, 'rb').read(), 3, 'it on the disk')
        self.assertLess(time.monotonic() - since, 1.0)
        path = self.stop(recorder)
        recorder.put('/bot8/cmd', String('late'))
        self.assertEqual(strings_of(path, '/bot8/cmd'), ['0', '1'])

    def test_what_has_come_is_written_at_the_stop(self):
        publisher = rospy.Publisher('/bot9/text', String, queue_size=1000)
        recorder = self.record('bot9', '/bot9/text')
        wait_for(publisher.get_num_connections, 10, 'the recorder')
        publisher.publish('x')
        wait_for(lambda: recorder.status().messages, 5, 'the first message')
        begun = time.monotonic()
        self.assertIn(recorder.stop(), (True, False))
        self.assertLess(time.monotonic() - begun, 0.5, 'stop() returns at once')
        self.assertEqual(strings_of(self.stop(recorder), '/bot9/text'), ['x'])
        publisher.unregister()

    def test_many_recordings_leave_nothing_behind(self):
        publisher = rospy.Publisher('/bot1/again', String, queue_size=10)
        threads = descriptors = None
        for turn in range(25):
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
        print('MEASURED after 5 and 25 recordings: threads {} and {}, files {} and {}'.format(
            threads, threading.active_count(), descriptors, open_files()))
        publisher.unregister()


def own_threads():
    names = ('bag_writer', 'raw_reader', 'raw_connect', 'tap_address', 'tap_mhri', 'recording')
    return [thread for thread in threading.enumerate() if thread.name.startswith(names)]


def open_files():
    return len(os.listdir('/proc/self/fd'))


if __name__ == '__main__':
    rospy.init_node('recorder_test')
    rostest.rosrun('mhri', 'recorder', RecorderTest)
