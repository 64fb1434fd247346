# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor's judgement of nodes, connections, robots, mhri's own nodes: a table of ailments."""
from dataclasses import replace
import json
import os

import pytest

from mhri.core.discovery import IgnoreList
from mhri.core.doctor import as_dict, as_lines, diagnose, exit_status, odd_ones
from mhri.core.doctor_facts import (
    Computer, Connection, FAULT, Facts, FINE, Graph, Master, Node, REFUSED, SILENT, STRANGER,
    Stream, UNRESOLVED, WARNING)
from mhri.core.doctor_robots import clock_offset, robots_of
from mhri.core.robot_types import load_robot_types

FOLDER = os.path.join(os.path.dirname(__file__), '..', '..', 'resource', 'robots')
TYPES = load_robot_types([(name, open(os.path.join(FOLDER, name), encoding='utf-8').read())
                          for name in sorted(os.listdir(FOLDER))])[0]
IGNORE = IgnoreList(('/rosout',), ('mux', 'robot_controller', 'mhri_*'))
TWIST, ODOMETRY, BOOL = 'geometry_msgs/Twist', 'nav_msgs/Odometry', 'std_msgs/Bool'
HOST_IP, BOT_IP = '192.0.2.1', '192.0.2.7'
COMPUTER = Computer(
    name='desk', variables={'ROS_MASTER_URI': 'http://192.0.2.1:11311', 'ROS_IP': HOST_IP},
    addresses=('127.0.0.1', HOST_IP), package_path='/ws/src/mhri',
    python_paths=('/ws/src/mhri/src/mhri',))
KINDS = {'/bot1/cmd_vel': TWIST, '/bot1/odom': ODOMETRY, '/robot_controller/twist': TWIST,
         '/mux/mode': 'mhri/ControlMode', '/robot_controller/robot_select': 'mhri/RobotSelect'}


class World:
    """A healthy system of a mux, a panel and one robot on another computer; to be spoilt."""

    def __init__(self):
        self.hosts = {'/mux': HOST_IP, '/mhri_panel': HOST_IP, '/bot1/base': BOT_IP}
        self.publish = {'/mux/mode': ['/mux'], '/robot_controller/twist': ['/mux'],
                        '/robot_controller/robot_select': ['/mhri_panel'],
                        '/bot1/cmd_vel': ['/mhri_panel'], '/bot1/odom': ['/bot1/base']}
        self.subscribe = {'/bot1/cmd_vel': ['/bot1/base'], '/bot1/odom': ['/mhri_panel'],
                          '/robot_controller/twist': ['/mhri_panel']}
        self.kinds = dict(KINDS)
        self.parameters = {'bot1': {'robot_type': 'generic'}}
        self.changed = {}
        self.apart = set()
        self.extra = {}
        self.streams = {}
        self.wanted = ()
        self.again = None

    def topics(self, node, group):
        return {topic: self.kinds[topic] for topic, nodes in group.items() if node in nodes}

    def node(self, name, number):
        links = [Connection(True, topic, listener)
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
            graph=self.graph(), nodes=nodes, streams=tuple(streams.values()), wanted=self.wanted,
            known={kind: None if kind.endswith('/Odd') else 'same'
                   for kind in self.kinds.values()})
        if self.again:
            self.again(self)
        return facts.with_later(self.graph(), {
            name: self.node(name, number) for number, name in enumerate(sorted(self.hosts))})

    def wrong(self):
        findings = diagnose(self.facts(), TYPES, IGNORE)
        assert all(item.shows and item.remedy for item in findings if item.severity != FINE)
        return [item for item in findings if item.severity != FINE]


def answer(**changes):
    """Return an ailment: the robot's node answers otherwise."""
    def spoil(world):
        world.changed['/bot1/base'] = changes
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


def samples(ahead_s, count=20):
    return tuple((100.0 + number, 100.0 + number + ahead_s - 0.002 * (1 + number % 3))
                 for number in range(count))


def seen_as(topic, kind, node):
    """Return an ailment: a node takes a topic for another type than the others do."""
    def spoil(world):
        world.changed[node] = {'subscriptions': {topic: kind}}
    return spoil


CASES = {
    'healthy': ([], []),
    'dead': ([answer(state=REFUSED)], ['node_dead']),
    'silent': ([answer(state=SILENT)], ['host_silent']),
    'hangs beside one that answers': (
        [answer(state=SILENT), add('/bot1/camera', host=BOT_IP, publish=['/bot1/x'])],
        ['node_silent', 'velocity_unheard']),
    'unresolved': ([answer(state=UNRESOLVED)], ['host_unresolved']),
    'no node at all': ([answer(state=STRANGER)], ['node_stranger']),
    'another node there': ([stream('/bot1/odom', callerid='/other')], ['node_stranger']),
    'loopback': ([answer(host='127.0.0.1'), add('/bot1/cam', ['/bot1/x'], host=BOT_IP)],
                 ['node_loopback']),
    'forgotten topic': ([answer(publications={})], ['registration_stale']),
    'moved': ([answer(uri_later='http://192.0.2.8:4000/')], ['name_fought']),
    'same name twice': ([links('/mhri_panel', Connection(True, '/bot1/cmd_vel', '/bot1/base'))],
                        ['name_twice']),
    'forgotten node': ([links('/mux', Connection(True, '/mux/mode', '/lost'))],
                       ['node_forgotten']),
    'a doctor is no forgotten node': (
        [links('/mux', Connection(True, '/mux/mode', '/mhri_doctor_77'))], []),
    'does not reach back': ([apart(('/bot1/cmd_vel', '/mhri_panel', '/bot1/base'))], ['one_way']),
    'not reached': ([apart(('/bot1/odom', '/bot1/base', '/mhri_panel'))], ['one_way']),
    'definitions differ': (
        [apart(('/robot_controller/twist', '/mux', '/mhri_panel'))], ['definition_differs']),
    'names of types differ': (
        [apart(('/bot1/cmd_vel', '/mhri_panel', '/bot1/base')),
         seen_as('/bot1/cmd_vel', BOOL, '/bot1/base')], ['type_differs']),
    'md5 differs': ([stream('/bot1/odom', md5sum='other')], ['md5_differs']),
    'message unknown': ([add('/x', ['/x/y'], kind='turtlesim/Odd')], ['message_unknown']),
    'message that mhri does not read': ([add('/x', ['/x/y'], kind='kobuki_msgs/Odd')], []),
    'no mux': ([without('/mux')], ['mux_missing']),
    'no panel': ([without('/mhri_panel')], []),
    'two muxes': ([add('/mux_2', ['/mux/mode'])], ['mux_several']),
    'mux bypassed': ([add('/rogue', ['/robot_controller/twist'])], ['mux_bypassed']),
    'stop bypassed': ([add('/rogue', ['/robot_controller/stop_all'])], ['mux_bypassed']),
    'two panels': ([add('/panel_2', ['/robot_controller/robot_select'])], ['panel_several']),
    'no clock': ([parameter(use_sim_time=True)], ['sim_time']),
    'clock': ([parameter(use_sim_time=True), add('/gazebo', ['/clock'])], []),
    'untyped': ([parameter(bot1={})], ['robot_untyped']),
    'unknown type': ([parameter(bot1={'robot_type': 'tank'})], ['robot_type_unknown']),
    'bad parameter': ([parameter(bot1={'robot_type': 'generic', 'mhri': {'limits': 3}})],
                      ['parameter_bad']),
    'unknown model': ([parameter(bot1={'robot_type': 'generic', 'robot_model': 'x'})],
                      ['parameter_bad']),
    'leftover': ([parameter(bot9={'robot_type': 'generic'})], ['robot_leftover']),
    'bad name': ([add('/_bot/base', ['/_bot/x'])], ['robot_name_bad']),
    'in the list of the panel': ([parameter(mhri={'robots': ['bot1', 'bot7']})], ['robot_absent']),
    'foreign velocity': ([add('/key', ['/bot1/cmd_vel'])], ['velocity_foreign']),
    'its own navigation': ([add('/bot1/move_base', ['/bot1/cmd_vel'], host=BOT_IP)],
                           ['velocity_foreign']),
    'its guard': ([add('/bot1/mhri_guard', ['/bot1/cmd_vel'], host=BOT_IP)], []),
    'its keeper': ([add('/mhri_gate_keeper_1', ['/bot1/cmd_vel'])], []),
    'hidden velocity': (
        [links('/bot1/base', Connection(False, '/bot1/cmd_vel', 'http://192.0.2.9:1/'))],
        ['velocity_hidden']),
    'topic of another type': ([add('/bot1/imu', ['/bot1/imu'], host=BOT_IP)], ['topic_type']),
    'two odometries': ([add('/bot1/other', ['/bot1/odom'], host=BOT_IP)], ['odometry_twice']),
    'silent odometry': ([stream('/bot1/odom', messages=0)], ['odometry_silent']),
    'clock a little off': ([stream('/bot1/odom', samples=samples(-0.05))], []),
    'clock off': ([stream('/bot1/odom', samples=samples(-0.3))], ['clock_offset']),
    'clock far off': ([stream('/bot1/odom', samples=samples(5.0))], ['clock_offset']),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_ailment(case):
    """Each is found, and nothing else."""
    spoils, expected = CASES[case]
    world = World()
    for spoil in spoils:
        spoil(world)
    assert sorted(item.check for item in world.wrong()) == expected


def test_what_heals_by_itself_is_not_told():
    """Only what is wrong in both looks counts: nodes come and go all the time."""
    for spoil in ('forgotten topic', 'same name twice', 'forgotten node', 'does not reach back',
                  'definitions differ', 'hidden velocity'):
        world = World()
        CASES[spoil][0][0](world)

        def heal(one):
            one.changed, one.extra, one.apart = {}, {}, set()
        world.again = heal
        assert world.wrong() == [], spoil


def test_nodes_that_look_odd_are_asked_again():
    for spoil, node in (('forgotten topic', '/bot1/base'), ('same name twice', '/mhri_panel'),
                        ('hidden velocity', '/bot1/base'), ('does not reach back', '/bot1/base')):
        world = World()
        CASES[spoil][0][0](world)
        facts = world.facts()
        assert node in odd_ones(facts, robots_of(facts.graph, TYPES, IGNORE)), spoil
    facts = World().facts()
    assert odd_ones(facts, robots_of(facts.graph, TYPES, IGNORE)) == set()


def test_only_the_robots_asked_for():
    world = World()
    add('/bot2/base', ['/bot2/odom'], kind=ODOMETRY, host=BOT_IP)(world)
    world.changed['/bot2/base'] = {'state': REFUSED}
    assert [item.about for item in world.wrong()] == ['bot2', 'bot2']
    world.wanted = ('bot1',)
    assert world.wrong() == []
    world.wanted = ('bot11',)
    assert [(item.check, item.about) for item in world.wrong()] == [('robot_absent', 'bot11')]


def test_nobody_listens_and_nobody_tells():
    world = World()
    world.subscribe.pop('/bot1/cmd_vel')
    assert [item.check for item in world.wrong()] == ['velocity_unheard']
    world = World()
    world.publish.pop('/bot1/odom')
    assert [item.check for item in world.wrong()] == ['odometry_missing']


def test_without_a_mux_the_master_may_be_the_wrong_one():
    world = World()
    without('/mux')(world)
    facts = world.facts()
    there = 'http://192.0.2.1:11322', 'http://192.0.2.9:11311'
    finding, = [item for item in diagnose(replace(facts, master=replace(
        facts.master, elsewhere=there)), TYPES, IGNORE) if item.severity != FINE]
    assert finding.check == 'mux_missing' and facts.master.uri in finding.problem
    for uri in there:
        assert uri in finding.problem and 'export ROS_MASTER_URI=' + uri in finding.remedy
    assert finding.remedy.endswith('if this one is right: rosrun mhri mux')
    assert 'ROS_MASTER_URI' not in world.wrong()[0].remedy


def test_publishers_disagree():
    world = World()
    add('/two', ['/bot1/odom'])(world)
    world.streams['second'] = Stream('/bot1/odom', '/two', ODOMETRY, 'x', '/two')
    assert 'publishers_differ' in [item.check for item in world.wrong()]


def test_remedies_never_end_the_wrong_node():
    """At the address of the dead node another one lives: to kill by name would end that one."""
    world = World()
    CASES['another node there'][0][0](world)
    assert 'not "rosnode kill /bot1/base"' in world.wrong()[0].remedy
    world = World()
    CASES['forgotten topic'][0][0](world)
    assert 'rosnode kill' not in world.wrong()[0].remedy


def test_a_robot_that_reaches_back_is_said_so():
    found = {item.check: item for item in diagnose(World().facts(), TYPES, IGNORE)}
    assert found['reaches_back'].severity == FINE and 'connections' in found['reaches_back'].problem
    world = World()
    without('/mhri_panel')(world)
    found = {item.check: item for item in diagnose(world.facts(), TYPES, IGNORE)}
    assert found['reaches_back'].sure == 'unknown'


@pytest.mark.parametrize('ahead_s', [-100.0, -0.2, 0.0, 0.2, 1e6])
def test_clock_offset(ahead_s):
    offset_s, error_s = clock_offset(samples(ahead_s))
    assert abs(offset_s - ahead_s) <= 0.003
    assert 0.005 <= error_s < 0.01


def test_few_stamps_prove_little():
    assert clock_offset(samples(0.0, 1))[1] == 0.1
    assert clock_offset(samples(0.0, 5))[1] < 0.1


@pytest.mark.parametrize('ahead_s, severity', [(0.3, WARNING), (-0.7, FAULT)])
def test_clock_severity(ahead_s, severity):
    world = World()
    stream('/bot1/odom', samples=samples(ahead_s))(world)
    finding, = world.wrong()
    assert finding.severity == severity and 'messages' in finding.sure
    assert ('ahead of' if ahead_s > 0 else 'behind') in finding.problem


def test_report():
    world = World()
    answer(state=REFUSED)(world)
    findings = diagnose(world.facts(), TYPES, IGNORE)
    lines = as_lines(findings, 1.234)
    assert lines[0].startswith('[X] fault  bot1: ') and lines[1].startswith('      shows as:')
    assert lines[-1].startswith('1 faults, 0 warnings') and lines[-1].endswith('1.2 s')
    report = json.loads(json.dumps(as_dict(findings, 1.234)))
    assert (report['faults'], report['warnings'], report['took_s']) == (1, 0, 1.234)
    assert report['findings'][0]['check'] == 'node_dead'
    assert exit_status(findings) == 1
    assert exit_status(diagnose(World().facts(), TYPES, IGNORE)) == 0
