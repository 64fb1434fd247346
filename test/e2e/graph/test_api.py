# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""doc/ros_api.md says what the running nodes do, no more and no less."""
import os
import re
import unittest

import rosgraph
import rospkg
import yaml

from mhri.base.accessories import ACTION, READOUT, TOPIC
from mhri.base.robot_types import resolve_robot_type
from mhri.graph.ros.resources import read_text, resource_path, robot_types
from support.paths import MESSAGES
from support.ros_system import free_port, System, wait_for

INPUTS = ('mhri_joy', 'mhri_pedal', 'mhri_voice')
# Behind what is installed: the message that takes the power from a TurtleBot2's motors.
SERVICES = {'end': 'mhri/EndTask',
            'set_suspended': 'mhri/SetSuspended', 'take_control': 'std_srvs/Trigger',
            'set_place': 'mhri/SetPlace', 'fit_place': 'mhri/FitPlace',
            'set_fault': 'mhri/SetFault', 'set_fence': 'mhri/SetFence', 'set_mark': 'mhri/SetMark',
            'stop_robots': 'mhri/StopRobots', 'mark': 'mhri/MarkSession',
            'note': 'mhri/AddNote', 'still': 'std_srvs/Trigger',
            'give': 'mhri/GiveLink', 'take': 'mhri/TakeLink'}
EVERYWHERE = ('/rosout', '/clock')
ROW = re.compile(r'^\| (publishes|subscribes|serves) \| `([^`]+)` \| (?:`([^`]+)`|[^|]+) \|', re.M)


def documented(section, *parts):
    """Return {(direction, name, type)} of one section of the page, or of it from part to part.

    :param parts: the line that a table stands behind, and the next such line or none
    """
    path = os.path.join(rospkg.RosPack().get_path('mhri'), 'doc', 'ros_api.md')
    text = read_text(path).split('\n## {}\n'.format(section), 1)[1].split('\n## ', 1)[0]
    for part, side in zip(parts, (1, 0)):
        text = text.split('\n{}\n'.format(part), 1)[side]
    return set(ROW.findall(text))


def running(node, uri=None):
    """Return {(direction, name, type)} of a node as a master knows it, by default this one."""
    master = rosgraph.Master('/api_test', uri)
    publishers, subscribers, services = master.getSystemState()
    types = dict(master.getTopicTypes())
    found = {('publishes', name, types[name]) for name, nodes in publishers
             if node in nodes and name not in EVERYWHERE}
    found |= {('subscribes', name, types.get(name, '')) for name, nodes in subscribers
              if node in nodes and name not in EVERYWHERE}
    found |= {('serves', name, SERVICES.get(name.rpartition('/')[2], 'std_srvs/SetBool'))
              for name, nodes in services
              if node in nodes and not name.endswith(('/get_loggers', '/set_logger_level'))}
    return found


def always(node, uri=None):
    """Return what a node has, without the camera and laser that a tile on show subscribes."""
    of_tile = ('/scan', '/tf', '/tf_static') if node == '/mhri_panel' else ('/scan',)
    return {row for row in running(node, uri) if row[0] != 'subscribes'
            or '/camera/' not in row[1] and not row[1].endswith(of_tile)}


def filled(rows, robot, streams):
    """Return documented rows of a link for a robot of which these streams are carried.

    :param streams: {topic below the robot: type}
    """
    found = set()
    for direction, name, kind in rows:
        if '<topic>' in name:
            found |= {(direction, '/{}/{}'.format(robot, topic), streams[topic])
                      for topic in streams}
        else:
            found.add((direction, name.replace('<robot>', robot), kind))
    return found


def camera_topics(template):
    """Return the topics of a template's simulated cameras, below the robot."""
    topics = []
    for names, transport in ((template.rgb, 'compressed'), (template.depth, 'compressedDepth')):
        if names:
            topics += [names[0], names[0] + '/' + transport,
                       names[0].rpartition('/')[0] + '/camera_info']
    return topics


def accessories():
    """Return the accessories of a simulated TurtleBot2."""
    rows = yaml.safe_load(read_text(resource_path('sim', 'accessories.yaml')))
    return resolve_robot_type(robot_types()[0], 'bot1', {
        'robot_type': 'turtlebot2', 'mhri': {'accessories': rows}})[0].accessories


def of_accessories(direction, name):
    """Return the rows that stand for one of the placeholders of accessories, of bot1."""
    ends = {'/goal': 'ActionGoal', '/result': 'ActionResult', '/cancel': None}
    end = '/' + name.rpartition('/')[2]
    found = set()
    for row in accessories():
        topics = {}
        if '<accessory_state>' in name:
            topics = {row.state.name: row.state.kind} if row.state else {}
        elif end in ends:
            if row.way == ACTION:
                topics = {row.name + end: row.type + ends[end] if ends[end]
                          else 'actionlib_msgs/GoalID'}
        elif row.way == TOPIC and (row.kind == READOUT) == ('<readout>' in name):
            topics = {row.name: row.type}
        found |= {(direction, '/bot1/' + topic, kind) for topic, kind in topics.items()}
    return found


class ApiTest(unittest.TestCase):

    maxDiff = None

    @classmethod
    def setUpClass(cls):
        cls.system = System()
        cls.system.screen()
        cls.system.start_master()
        cls.system.env['PYTHONPATH'] = os.pathsep.join(
            (os.environ.get('PYTHONPATH', ''), MESSAGES))
        cls.system.node('mux', '__name:=mux')
        cls.system.node('tasks')
        cls.system.node('mhri_session')
        cls.system.node('mhri_web', '_port:=0', '_local_port:=0')
        for name in INPUTS:
            cls.system.node(name, '__name:=' + name)
        for number, kind in enumerate(('turtlebot2', 'turtlebot3_burger')):
            cls.system.launch('turtlebot.launch', 'name:=bot{}'.format(number + 1),
                              'type:=' + kind, 'x:={}'.format(1 + 2 * number), 'y:=1')
        cls.system.node('panel', '--fresh', '--select', 'bot1')

    @classmethod
    def tearDownClass(cls):
        cls.system.close()

    def test_mux(self):
        self.page_is_true('mux')

    def test_panel(self):
        self.page_is_true('mhri_panel')

    def test_tasks(self):
        self.page_is_true('mhri_tasks')

    def test_session(self):
        self.page_is_true('mhri_session')

    def test_web(self):
        self.page_is_true('mhri_web')

    def page_is_true(self, node):
        """Hold a node's page, its placeholders filled in, against the node."""
        turtlebot2 = robot_types()[0]['turtlebot2']
        wanted = set()
        for direction, name, kind in documented(node):
            if '<command>' in name:
                wanted |= {(direction, '/bot1/' + topic, kind) for topic in turtlebot2.command}
            elif '<odometry>' in name:
                wanted.add((direction, '/bot1/odom', 'nav_msgs/Odometry'))
            elif '<motor_power>' in name:
                power = turtlebot2.motor_power
                wanted.add((direction, '/bot1/' + power.name, power.kind))
            elif '<hardware_stop>' in name:
                self.assertIsNone(turtlebot2.hardware_stop)
            elif '<accessory' in name or '<readout>' in name:
                wanted |= of_accessories(direction, name)
            else:
                wanted.add((direction, name.replace('<robot>', 'bot1'), kind))
        self.becomes('/' + node, None, wanted, always)

    def test_both_ends_of_a_link(self):
        with System(adopt=False) as robot:
            robot.start_master()
            end = 'tcp/127.0.0.1:{}'.format(free_port())
            robot.launch('turtlebot.launch', 'name:=bot3', 'type:=turtlebot3_waffle')
            robot.launch('link.launch', 'side:=robot', 'name:=bot3', 'keys:=off', 'listen:=' + end)
            link = self.system.node('mhri_link', '--side', 'host', '--name', 'bot3', '--keys',
                                    'off', '--connect', end, '__ns:=/bot3')
            self.addCleanup(self.system.kill, link)
            kind = robot_types()[0]['turtlebot3']
            carried = {topic for topic in (
                *kind.imu, *kind.odometry, *kind.scan, *kind.battery, kind.rgb[0] + '/compressed')}
            uri = robot.env['ROS_MASTER_URI']
            streams = {}

            def known():
                types = dict(rosgraph.Master('/api_test', uri).getTopicTypes())
                streams.update({topic: types[name] for topic in carried
                                for name in ['/bot3/' + topic] if name in types})
                return set(streams) == carried
            wait_for(known, 60, lambda: 'the topics of bot3: {}'.format(sorted(streams)))
            there = "On the robot's own master:"
            self.becomes('/bot3/mhri_link', None, filled(
                documented('mhri_link', 'On the host:', there), 'bot3', streams))
            # Somebody listens to all of it.
            self.system.start('rostopic', 'hz', *sorted(
                name for direction, name, _ in running('/bot3/mhri_link')
                if direction == 'publishes' and name != '/diagnostics'))
            self.becomes('/bot3/mhri_link', uri, filled(
                documented('mhri_link', there), 'bot3', streams))

    @staticmethod
    def becomes(node, uri, wanted, read=running):
        """Wait until a node has this and nothing else."""
        wait_for(lambda: read(node, uri) == wanted, what=lambda: '{}: missing {}, more {}'.format(
            node, wanted - read(node, uri), read(node, uri) - wanted), poll_s=0.1)

    def test_input_nodes(self):
        for name in INPUTS:
            self.becomes('/' + name, None, documented(name))

    def test_drill(self):
        self.system.node('mhri_drill', 'maze')
        self.becomes('/mhri_drill', None, documented('mhri_drill'))

    def test_simulated_robots(self):
        pages = documented('Simulated robot')
        for robot, kind, node in (('bot1', 'turtlebot2', '/bot1/base'),
                                  ('bot2', 'turtlebot3', '/bot2/base')):
            template = robot_types()[0][kind]
            own = {'/tf', '/tf_static', node + '/set_fault', node + '/faults'}
            own |= {'/bot1/' + topic for row in accessories() for topic in (
                *([row.name] if row.way == TOPIC else [
                    row.name + end for end in ('/goal', '/cancel', '/status', '/feedback',
                                               '/result')]),
                *([row.state.name] if row.state else []))} if robot == 'bot1' else set()
            own |= {'/{}/{}'.format(robot, topic) for topic in (
                *template.command, *template.imu, *template.odometry, *template.scan,
                *template.cloud, *template.battery, template.motor_power.name,
                *camera_topics(template))}
            wanted = {(direction, name.replace('<robot>', robot), kind)
                      for direction, name, kind in pages
                      if name.replace('<robot>', robot) in own}
            self.assertEqual({name for _, name, _ in wanted}, own)
            self.becomes(node, None, wanted)
