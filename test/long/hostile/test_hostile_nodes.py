# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The input nodes and the simulated robot under attack: parameters, topics, services, ports.

A parameter that cannot be used is a named error or nothing at all, never a traceback; a node that
runs goes on, answers, and moves nothing. ``MHRI_SEED`` repeats a run, ``MHRI_LONG=1`` is the long
form.
"""
import contextlib
import math
import socket
import struct
import threading
import time
from urllib.parse import urlsplit
import xmlrpc.client

import psutil
import pytest

from support import graph
from support.hostile import Hostile, is_long, seed_of
from support.hostile_wire import call, class_of, handshake, torn_call, torn_class
from support.own_node import own_node
from support.ros_system import family_of, wait_for

system = own_node('hostile_nodes')

FACTOR = 20 if is_long() else 1
MESSAGES = 30 * FACTOR
NODES = {'/mhri_joy': 'mhri_joy', '/mhri_pedal': 'mhri_pedal', '/mhri_voice': 'mhri_voice'}
SIM = '/sim1/base'
GROWTH_MB = 60.0
MAX_LINES, MAX_LINES_PER_S = 60, 12.0
JOYS = (graph.PAD, graph.PEDAL, graph.VOICE)
TOPICS = (
    ('/mhri_joy/rumble', 'std_msgs/Empty'), (graph.STOP_ALL, 'std_msgs/Bool'),
    ('/mhri_voice/push_to_talk', 'std_msgs/Bool'), (graph.MODE, 'mhri/ControlMode'),
    (graph.SELECT, 'mhri/RobotSelect'),
    ('/sim1/teleop/input', 'geometry_msgs/Twist'))
PARAMETERS = ('/mhri_joy/device', '/mhri_pedal/device', '/mhri_pedal/profile', '/mhri_voice/source',
              '/mhri/robots')


def start_all(system):
    """Start every node; return {name: process}."""
    import rospy
    processes = {name: system.node(module) for name, module in NODES.items()}
    rospy.set_param('/sim1/robot_type', 'turtlebot2')
    processes[SIM] = system.node('sim_robot', '__ns:=/sim1')
    return processes


def memory_mb(process):
    """Return the memory of a process, none of one that has ended meanwhile."""
    with contextlib.suppress(psutil.NoSuchProcess):
        return process.memory_info().rss / 1e6
    return 0.0


class Field:
    """The nodes under attack, and what they publish."""

    def __init__(self, system):
        import rospy
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import Joy
        self.system, self.hostile = system, Hostile(seed_of(20261123))
        self.moved, self.poses = [], []
        for topic in JOYS:
            rospy.Subscriber(topic, Joy, lambda message, topic=topic: any(message.axes)
                             and self.moved.append((topic, message.axes)))
        rospy.Subscriber('/sim1/odom', Odometry, self._hear)
        self.processes = start_all(system)
        for name in NODES:
            rospy.wait_for_service(name + '/set_suspended', 60.0)
        wait_for(lambda: self.poses, 60.0, 'the simulated robot')
        self.speakers = {}

    def _hear(self, message):
        self.poses.append((message.pose.pose.position.x, message.pose.pose.position.y,
                           message.twist.twist.linear.x, message.twist.twist.angular.z))
        del self.poses[:-500]

    def text(self, name):
        """Return what a node has written."""
        with open(self.processes[name].log, errors='replace') as log:
            return log.read()

    def suspend(self, name, suspended):
        """Call a node's service; return its answer."""
        import rospy
        from mhri.srv import SetSuspended
        return rospy.ServiceProxy(name + '/set_suspended', SetSuspended)(suspended)

    def check(self, lines, seconds):
        """Fail where a node has ended, stumbled, does not answer, moves, or writes without end."""
        for name, process in self.processes.items():
            text = self.text(name)
            assert process.poll() is None, '{} ended:\n{}'.format(name, text[-3000:])
            assert 'Traceback' not in text, '{}:\n{}'.format(name, text[-3000:])
            wrote = text.count('\n') - lines[name]
            assert wrote <= MAX_LINES + MAX_LINES_PER_S * seconds, \
                '{}: {} lines in {:.0f} s'.format(name, wrote, seconds)
        for name in NODES:
            assert self.suspend(name, True).success
        assert not self.moved, self.moved[:3]
        assert all(map(math.isfinite, sum(self.poses[-50:], ()))), self.poses[-3:]

    def sizes(self):
        """Return {name: memory [MB] of a node and its children}."""
        return {name: sum(map(memory_mb, family_of(process)))
                for name, process in self.processes.items()}


@pytest.fixture(scope='module')
def field(system):
    made = Field(system)
    begun = made.sizes()
    yield made
    print('\nMEASURED memory: ' + ', '.join('{} {:.0f} to {:.0f} MB'.format(
        name, begun[name], size) for name, size in made.sizes().items()))
    for process in made.processes.values():
        system.kill(process, 15)


@pytest.fixture
def held_to(field):
    """Attack, then hold everybody to the promises."""
    def run(attack):
        lines, begun = {name: field.text(name).count('\n') for name in field.processes}, \
            time.monotonic()
        attack()
        time.sleep(0.3)
        field.check(lines, time.monotonic() - begun)
    return run


def speak(field, topic, ros_type):
    """Send hostile messages and torn ones on a topic."""
    import rospy
    kind, hostile = class_of(ros_type), field.hostile
    if topic not in field.speakers:
        field.speakers[topic] = rospy.Publisher(topic, kind, queue_size=1000)
    publisher, torn = field.speakers[topic], torn_class(kind, hostile)
    wait_for(publisher.get_num_connections, 10.0, 'somebody to listen to ' + topic)
    for place in range(MESSAGES):
        try:
            publisher.publish(torn() if place > 0.8 * MESSAGES else hostile.message(kind, class_of))
        except rospy.ROSSerializationException:
            pass  # it could not be sent
        time.sleep(0.002)


def test_topics(field, held_to):
    held_to(lambda: [speak(field, *row) for row in TOPICS])


def test_parameters_while_they_run(field, held_to):
    """While they look for their devices, they read them once a second."""
    import rospy

    def attack():
        for name in NODES:
            assert field.suspend(name, False).success
        for _ in range(3 * FACTOR):
            for key in PARAMETERS:
                try:
                    rospy.set_param(key, field.hostile.value())
                except (OverflowError, TypeError, xmlrpc.client.Error, rospy.ROSException):
                    pass  # it could not be sent
            time.sleep(1.1)
        for key in PARAMETERS:
            if rospy.has_param(key):
                rospy.delete_param(key)
    held_to(attack)


def test_services_and_ports(field, held_to):
    """Torn calls, absurd ones, and connections that say nothing: others are served all the same."""
    import rosgraph
    hostile, silent = field.hostile, []
    master = rosgraph.Master('/attacker')

    def attack():
        for name in NODES:
            uri = urlsplit(master.lookupService(name + '/set_suspended'))
            header = handshake(callerid='/attacker', service=name + '/set_suspended', md5sum='*')
            for _ in range(5 * FACTOR):
                torn_call(uri, header, struct.pack('<I', 99) + hostile.torn(), 0.05)
                torn_call(uri, b'', hostile.torn(), 0.05)
        for name in list(NODES) + [SIM]:
            uri = urlsplit(master.lookupNode(name))
            proxy = xmlrpc.client.ServerProxy(uri.geturl())
            port = proxy.requestTopic('/attacker', '/rosout', [['TCPROS']])[2][2]
            silent.extend(socket.create_connection((uri.hostname, port), 20.0) for _ in range(8))
            for _ in range(5 * FACTOR):
                call(proxy, hostile)
        begun, answers = time.monotonic(), []
        for name in NODES:
            # One that is held up would be held up for ever.
            threading.Thread(target=lambda name=name: answers.append(field.suspend(name, True)),
                             daemon=True).start()
        wait_for(lambda: len(answers) == len(NODES), 60.0, 'all services to answer')
        took = time.monotonic() - begun
        print('MEASURED three services answer behind 8 silent connections each: {:.2f} s'.format(
            took))
    held_to(attack)
    for link in silent:
        link.close()


# What a node is given before it starts: (module, its parameters, what it has to say).
DEEP = [[[{'a': [1]}]]]
STARTS = [
    ('mhri_joy', {'device': 'x' * 100000}, None), ('mhri_pedal', {'role': 'x' * 5000}, '~role'),
    ('mhri_pedal', {'device': DEEP, 'profile': '../../x'}, None),
    ('mhri_voice', {'source': DEEP}, None)] + [
    ('mhri_voice', {'language': value}, 'cannot start') for value in (
        DEEP, '../../../etc/passwd', '/dev/zero')] + [
    ('sim_robot', {key: value}, 'cannot be simulated') for key, value in (
        ('plan', '/dev/zero'), ('seed', 'abc'), ('x', float('nan')), ('mocap', 2))]
AT_ONCE = 5


def begin(system, number, module, parameters):
    """Start a node with parameters; return its process."""
    import rospy
    place = '/start{}'.format(number)
    # Only a robot goes by its namespace.
    name, node = '__name:=start{}_{}'.format(number, module), node_at(number, module)
    if module == 'sim_robot':
        name, node = '__ns:=' + place, place + '/base'
        rospy.set_param(place + '/robot_type', 'turtlebot2')
    for key, value in parameters.items():
        rospy.set_param('{}/{}'.format(node, key), value)
    return system.node(module, name)


def node_at(number, module):
    return '/start{}_{}'.format(number, module)


@pytest.mark.parametrize('first', range(0, len(STARTS), AT_ONCE))
def test_parameters_at_the_start(system, first):
    """A named error and status 1, or a node that runs."""
    import rosgraph
    rows = list(enumerate(STARTS))[first:first + AT_ONCE]
    processes = [begin(system, number, *row[:2]) for number, row in rows]
    for (number, (module, parameters, said)), process in zip(rows, processes):
        what = '{} {!r:.100}'.format(module, parameters)
        service = node_at(number, module) + '/set_suspended'
        services = rosgraph.Master('/attacker').getSystemState
        wait_for(lambda: process.poll() is not None or not said and any(
            name == service for name, _ in services()[2]), 60.0, what + ': an end or a service',
            poll_s=0.1)
        with open(process.log, errors='replace') as log:
            text = log.read()
        assert 'Traceback' not in text, what + '\n' + text[-2000:]
        if said:
            assert process.poll() == 1 and said in text, what + '\n' + text[-2000:]
            assert len(max(text.split('\n'), key=len)) < 700, what
        else:
            assert process.poll() is None, what + '\n' + text[-2000:]
            system.kill(process)
