# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sessions of two simulated robots, as ``mhri_session`` records them and others read them."""
import io
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import xmlrpc.client

import rosbag
import rosgraph
import rospy
from std_srvs.srv import SetBool, Trigger

from mhri.msg import Places, SeenPicture, SessionEvent, SessionState
from mhri.recording.folder import bags_of, marks_of, read_events, read_info, robots_of
from mhri.srv import AddNote, MarkSession, SetFault
from sensor_msgs.msg import CompressedImage
from support import graph
from support.fake_mux import FakeOperator
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('session', 'session.launch')

TIMEOUT_S = 60.0
ROBOTS = ('bot1', 'bot2')
PLACES = '/mhri_tasks/places'
LATCHED = (graph.MODE, graph.DRIVE_STATE, '/tf_static', '/map')
MOVING = ('/tf', '/bot1/odom', '/bot2/odom')


def run(*command):
    """Run a tool; return what it said."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
    assert done.returncode == 0, done.stdout.decode()
    return done.stdout.decode()


def times_of(path, topic):
    """Return the receipt times [s] of a topic in a bag."""
    with rosbag.Bag(path) as bag:
        return [when.to_sec() for _, _, when in bag.read_messages(topics=[topic], raw=True)]


class SessionTest(unittest.TestCase):
    """Each case has a folder and a process of the node of its own."""

    def setUp(self):
        self.home = tempfile.mkdtemp(prefix='mhri_session_')
        self.processes = []
        self.state = SessionState()
        self.subscriber = rospy.Subscriber('/mhri_session/state', SessionState, self.on_state)

    def tearDown(self):
        self.subscriber.unregister()
        for process in self.processes:
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
                process.wait(TIMEOUT_S)
        rospy.set_param('/mhri_session', {})
        shutil.rmtree(self.home)

    def on_state(self, message):
        self.state = message

    def start(self, **parameters):
        """Start the node, and wait until it hears both robots, and where they are on the map."""
        earlier = self.ears_for_places()
        usual = {'folder': self.home, 'stop_free_mb': 1, 'warn_free_mb': 1}
        for name, value in dict(usual, **parameters).items():
            rospy.set_param('/mhri_session/' + name, value)
        self.state = SessionState()
        process = subprocess.Popen(['rosrun', 'mhri', 'mhri_session'],
                                   env=dict(os.environ, ROS_HOME=self.home))
        self.processes.append(process)
        self.service = {name: rospy.ServiceProxy('/mhri_session/' + name, kind) for name, kind in (
            ('record', SetBool), ('mark', MarkSession), ('note', AddNote), ('still', Trigger))}
        for service in self.service.values():
            service.wait_for_service(TIMEOUT_S)
        wait_for(lambda: set(self.state.robots) == set(ROBOTS), TIMEOUT_S, 'both robots')
        # Until then, a mark is where the odometry says, which is nowhere on the map.
        wait_for(lambda: self.ears_for_places() - earlier, TIMEOUT_S, 'a way to the places')
        return process

    @staticmethod
    def ears_for_places():
        """Return the connections from the tasks, which know the places, to a session."""
        rospy.wait_for_message(PLACES, Places, TIMEOUT_S)
        tasks = xmlrpc.client.ServerProxy(rosgraph.Master('/session').lookupNode('/mhri_tasks'))
        return {info for _, node, _, _, topic, _, info in tasks.getBusInfo('/session')[2]
                if (node, topic) == ('/mhri_session_recorder', PLACES)}

    def record(self):
        """Begin to record; return the folder."""
        answer = self.service['record'](True)
        self.assertTrue(answer.success, answer.message)
        wait_for(lambda: self.state.recording, TIMEOUT_S, 'the state says that it records')
        return self.state.folder

    def wait_for_messages(self, more=400):
        """Wait until so many more messages are written."""
        before = self.state.messages
        wait_for(lambda: self.state.messages > before + more, TIMEOUT_S, 'messages in the bags')

    @staticmethod
    def are_placed():
        """Whether both robots are known to be somewhere on the map."""
        places = rospy.wait_for_message(PLACES, Places, TIMEOUT_S)
        return {place.robot for place in places.robots if place.by} == set(ROBOTS)

    @staticmethod
    def flags():
        """Return the frame and the words of the flags, as whoever asks now gets them."""
        marks = rospy.wait_for_message('/mhri_session/marks', Places, TIMEOUT_S)
        return marks.header.frame_id, [mark.name for mark in marks.marks]

    def events(self, folder):
        with open(os.path.join(folder, 'events.jsonl'), encoding='utf-8') as file:
            return read_events(file.read())

    def test_a_session_is_whole(self):
        """Bags, each to be opened alone; yaml; events; marks with poses, notes."""
        self.start(bag_s=3)
        folder = self.record()
        operator = FakeOperator()
        operator.check('bot1')
        wait_for(lambda: any(event.kind == 'selection' for event in self.events(folder)),
                 TIMEOUT_S, 'the selection among the events')
        wait_for(self.are_placed, TIMEOUT_S, 'both robots on the map')
        fail = rospy.ServiceProxy('/bot2/base/set_fault', SetFault)
        for told, duration_s in (('fault: left', 0.0), ('fault over: left', -1.0)):
            fail('wheel_slow', 40.0, duration_s)
            wait_for(lambda: any(event.kind == 'fault' and told in event.text
                                 for event in self.events(folder)), TIMEOUT_S, told)
        marked = self.service['mark']('')
        self.assertTrue(marked.success, marked.message)
        self.assertEqual(marked.id, 'm1')
        self.assertTrue(self.service['note']('', 'a red door').success)
        self.assertFalse(self.service['note']('m7', 'of nothing').success)
        wait_for(lambda: self.flags() == ('map', ['1 a red door']), TIMEOUT_S,
                 lambda: 'its flag: {}, {}'.format(self.flags(), [
                     event for event in self.events(folder) if event.kind == 'mark']))
        wait_for(lambda: len(bags_of(os.listdir(folder))) >= 3, TIMEOUT_S, 'a third bag')
        self.wait_for_messages()
        operator.leave()
        answer = self.service['record'](False)
        self.assertIn('saved', answer.message)
        bags = bags_of(os.listdir(folder))
        self.assertEqual([name for name in bags if name.endswith('.active')], [])
        for name in bags:
            path = os.path.join(folder, name)
            with rosbag.Bag(path) as bag:
                topics = bag.get_type_and_topic_info().topics
                self.assertLess(bag.get_end_time() - bag.get_start_time(), 6.0)
            # The last one may have been begun a moment ago.
            missing = [topic for topic in LATCHED + MOVING * (name != bags[-1])
                       if topic not in topics]
            self.assertEqual(missing, [], name)
        self.assertIn('/bot1/odom', run('rosbag', 'info', os.path.join(folder, bags[0])))
        run('rosbag', 'check', os.path.join(folder, bags[0]))
        self.no_odometry_is_missing(folder, bags)
        with open(os.path.join(folder, 'session.yaml'), encoding='utf-8') as file:
            info = read_info(file.read())
        events = self.events(folder)
        self.assertEqual(set(robots_of(info, events)), set(ROBOTS))
        self.assertEqual(info.robots['bot1']['topics']['odometry'], '/bot1/odom')
        kinds = [event.kind for event in events]
        self.assertEqual((kinds.count('start'), kinds.count('end'), kinds[-1]), (1, 1, 'end'))
        mark, = marks_of(events)
        self.assertEqual((mark.text, mark.robot), ('a red door', 'bot1'))
        self.assertEqual({pose[3] for pose in mark.poses.values()}, {'map'})
        self.assertEqual(set(mark.poses), set(ROBOTS))

    def no_odometry_is_missing(self, folder, bags):
        """The numbers of a robot's odometry run on from bag to bag."""
        for robot in ROBOTS:
            numbers = []
            for name in bags:
                with rosbag.Bag(os.path.join(folder, name)) as bag:
                    numbers += [message.header.seq for _, message, _ in bag.read_messages(
                        topics=['/{}/odom'.format(robot)])]
            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))))

    def test_a_mark_has_its_run_up_and_its_stills(self):
        """With nothing recorded, a mark keeps what came before it, and the pictures in sight."""
        self.start(ring_s=20)
        publisher = rospy.Publisher('/panel/pictures', SeenPicture, queue_size=5)
        picture = rospy.wait_for_message('/bot1/camera/rgb/image_raw/compressed', CompressedImage,
                                         TIMEOUT_S)
        told = rospy.Publisher('/panel/events', SessionEvent, queue_size=5)
        wait_for(lambda: publisher.get_num_connections() and told.get_num_connections(),
                 TIMEOUT_S, 'the session hears the screen')
        buffer = io.BytesIO()
        picture.serialize(buffer)
        topic = '/bot1/camera/rgb/image_raw/compressed'
        publisher.publish(topic, buffer.getvalue())
        published = [topic]
        told.publish(rospy.Time(1), 'battery.low', 'attention', 'bot1', 'battery 25 %', '')
        told.publish(rospy.Time(1), 'mode.changed', 'calm', '', 'seen on the graph itself', '')
        before = time.time()
        heard = []
        ear = rospy.Subscriber('/bot1/odom', rospy.AnyMsg, heard.append)
        wait_for(lambda: len(heard) > 20, TIMEOUT_S, 'a second of odometry')
        ear.unregister()
        marks = []

        def still_of_mark():
            """Mark, until the picture has come; after a while it is not in sight any more."""
            publisher.publish(topic, buffer.getvalue())
            published.append(topic)
            marks.append(self.service['mark']('here'))
            return '1 still' in marks[-1].message
        wait_for(still_of_mark, TIMEOUT_S, 'a still of a mark', poll_s=0.2)
        wait_for(lambda: self.state.recording, TIMEOUT_S, 'it records')
        folder = self.state.folder

        def still():
            publisher.publish(topic, buffer.getvalue())
            published.append(topic)
            return self.service['still']().success
        wait_for(still, TIMEOUT_S, 'a still', poll_s=0.2)
        self.service['record'](False)
        bag = os.path.join(folder, '0000.bag')
        self.assertLess(min(times_of(bag, '/bot1/odom')), before)
        self.assertLessEqual(1, len(times_of(bag, topic)))
        self.assertLessEqual(len(times_of(bag, topic)), len(published))
        events = self.events(folder)
        mark = marks_of(events)[-1]
        with open(os.path.join(folder, mark.stills[0]), 'rb') as file:
            self.assertEqual(file.read(), bytes(picture.data))
        texts = [event.text for event in events]
        self.assertEqual(texts.count('battery 25 %'), 1)
        self.assertNotIn('seen on the graph itself', texts)
