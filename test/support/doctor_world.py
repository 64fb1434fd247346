# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A healthy system in the words of the doctor's facts, and ailments for it: no ROS, no network."""
from dataclasses import replace
import os

from mhri.base.robot_types import load_robot_types
from mhri.doctor.facts import Computer, Connection, Facts, FINE, Graph, Master, Node, Stream
from mhri.doctor.judgement import diagnose
from mhri.robots.discovery import IgnoreList

FOLDER = os.path.join(os.path.dirname(__file__), '..', '..', 'resource', 'robots')
TYPES = load_robot_types([(name, open(os.path.join(FOLDER, name), encoding='utf-8').read())
                          for name in sorted(os.listdir(FOLDER))])[0]
IGNORE = IgnoreList(('/rosout', '/mux', '/mhri_*'), ('mux', 'robot_controller', 'mhri_*'))
TWIST, ODOMETRY, BOOL = 'geometry_msgs/Twist', 'nav_msgs/Odometry', 'std_msgs/Bool'
HOST_IP, BOT_IP = '192.0.2.1', '192.0.2.7'
COMPUTER = Computer(
    name='desk', variables={'ROS_MASTER_URI': 'http://192.0.2.1:11311', 'ROS_IP': HOST_IP},
    addresses=('127.0.0.1', HOST_IP), package_path='/ws/src/mhri',
    python_paths=('/ws/src/mhri/src/mhri',))
KINDS = {'/bot1/cmd_vel': TWIST, '/bot1/odom': ODOMETRY, '/robot_controller/twist': TWIST,
         '/mux/mode': 'mhri/ControlMode', '/robot_controller/robot_select': 'mhri/RobotSelect',
         '/mux/state': 'mhri/DriveState'}


class World:
    """A healthy system: mux, panel, and one robot on another computer; to be spoilt."""

    def __init__(self):
        self.hosts = {'/mux': HOST_IP, '/mhri_panel': HOST_IP, '/bot1/base': BOT_IP}
        self.publish = {'/mux/mode': ['/mux'], '/robot_controller/twist': ['/mux'],
                        '/robot_controller/robot_select': ['/mhri_panel'],
                        '/mux/state': ['/mux'], '/bot1/cmd_vel': ['/mux'],
                        '/bot1/odom': ['/bot1/base']}
        self.subscribe = {'/bot1/cmd_vel': ['/bot1/base'], '/bot1/odom': ['/mhri_panel'],
                          '/mux/state': ['/mhri_panel']}
        self.kinds = dict(KINDS)
        self.parameters = {'bot1': {'robot_type': 'generic'}}
        self.changed = {}
        self.apart = set()
        self.extra = {}
        self.streams = {}
        self.seen_at = {}
        self.requested = ()
        self.again = None

    def topics(self, node, group):
        return {topic: self.kinds[topic] for topic, nodes in group.items() if node in nodes}

    def node(self, name, number):
        links = [Connection(True, topic, listener, self.seen_at.get(listener, ''))
                 for topic, nodes in self.publish.items() if name in nodes
                 for listener in self.subscribe.get(topic, ())
                 if (topic, name, listener) not in self.apart]
        links += self.extra.get(name, [])
        host = self.hosts[name]
        node = Node(name, 'http://{}:{}/'.format(host, 4000 + number), host, took_s=0.01,
                    publications=self.topics(name, self.publish),
                    subscriptions=self.topics(name, self.subscribe), connections=tuple(links))
        return replace(node, **self.changed.get(name, {}))

    def graph(self):
        return Graph({topic: tuple(nodes) for topic, nodes in self.publish.items()},
                     {topic: tuple(nodes) for topic, nodes in self.subscribe.items()},
                     {}, self.kinds, self.parameters)

    def facts(self):
        nodes = {name: self.node(name, number)
                 for number, name in enumerate(sorted(self.hosts))}
        streams = {topic: Stream(topic, names[0], self.kinds[topic], 'same', names[0], '', 0.6, 9)
                   for topic, names in self.publish.items()}
        streams.update(self.streams)
        facts = Facts(
            computer=COMPUTER, master=Master('http://192.0.2.1:11311', HOST_IP, 11311),
            graph=self.graph(), nodes=nodes, streams=tuple(streams.values()),
            requested=self.requested,
            known={kind: None if kind.endswith('/Odd') else 'same'
                   for kind in self.kinds.values()})
        if self.again:
            self.again(self)
        return facts.with_later(self.graph(), {
            name: self.node(name, number) for number, name in enumerate(sorted(self.hosts))})

    def wrong(self):
        findings = diagnose(self.facts(), TYPES, IGNORE)
        assert all(item.symptom and item.remedy for item in findings if item.severity != FINE)
        return [item for item in findings if item.severity != FINE]


def change(name, **changes):
    """Return an ailment: a node answers otherwise."""
    def spoil(world):
        world.changed[name] = changes
    return spoil


def answer(**changes):
    """Return an ailment: the robot's node answers otherwise."""
    return change('/bot1/base', **changes)


def at(name, host):
    """Return an ailment: a node runs on another computer."""
    def spoil(world):
        world.hosts[name] = host
    return spoil


def seen_at(**addresses):
    """Return an ailment: the robot's nodes are seen to be connected from these addresses."""
    def spoil(world):
        world.seen_at.update({'/bot1/' + name: address for name, address in addresses.items()})
    return spoil


def add(name, publish=(), subscribe=(), kind=BOOL, host=HOST_IP):
    """Return an ailment: one more node."""
    def spoil(world):
        world.hosts[name] = host
        for topics, group in ((publish, world.publish), (subscribe, world.subscribe)):
            for topic in topics:
                world.kinds.setdefault(topic, kind)
                group[topic] = group.get(topic, []) + [name]
    return spoil


def without(name):
    """Return an ailment: a node does not run."""
    def spoil(world):
        del world.hosts[name]
        for group in (world.publish, world.subscribe):
            for topic, nodes in list(group.items()):
                group[topic] = [node for node in nodes if node != name]
                if not group[topic]:
                    del group[topic]
    return spoil


def parameter(**values):
    def spoil(world):
        world.parameters.update(values)
    return spoil


def stream(topic, **changes):
    def spoil(world):
        node = world.publish[topic][0]
        world.streams[topic] = replace(
            Stream(topic, node, world.kinds[topic], 'same', node, '', 0.6, 9), **changes)
    return spoil


def apart(*links):
    def spoil(world):
        world.apart.update(links)
    return spoil


def links(name, *extra):
    def spoil(world):
        world.extra[name] = list(extra)
    return spoil


def seen_as(topic, kind, node):
    """Return an ailment: a node takes a topic for another type than the others do."""
    def spoil(world):
        world.changed[node] = {'subscriptions': {topic: kind}}
    return spoil
