# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the doctor tells one to do: the command has to be right for the one who has the ailment."""
from dataclasses import replace

import pytest

from mhri.doctor.facts import Connection, FINE, Master, REFUSED, SILENT, UNRESOLVED
from mhri.doctor.judgement import diagnose
from mhri.doctor.nodes import start_robot

from support.doctor_world import (
    add, answer, BOOL, BOT_IP, COMPUTER, HOST_IP, IGNORE, links, seen_at, stream, TYPES, without,
    World)


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
    assert finding.remedy.endswith('rosrun mhri mux')
    assert 'ROS_MASTER_URI' not in world.wrong()[0].remedy


@pytest.mark.parametrize('host, state, where, words', [
    ('198.51.100.5', SILENT, '', 'on {0}: export ROS_IP={0}, then start /bot1/base'),
    ('198.51.100.5', REFUSED, BOT_IP, 'on {0}: export ROS_IP={0}, then start /bot1/base'),
    ('198.51.100.5', SILENT, HOST_IP, 'here: export ROS_IP=' + HOST_IP),
    ('127.0.0.1', REFUSED, '', 'on its computer: export ROS_IP={0},'),
    ('bot1.local', UNRESOLVED, '', 'export ROS_IP={0}, then start it again   # or here: echo '
     '"{0} bot1.local"')])
def test_node_that_lives_is_not_taken_off_the_master(host, state, where, words):
    """It tells a wrong address, which is mended there: "rosnode cleanup" would end its topics."""
    world = World()
    answer(host=host, state=state)(world)
    add('/bot1/cam', ['/bot1/x'], host=BOT_IP)(world)
    if where:
        seen_at(base=where)(world)
    finding = [item for item in world.wrong() if item.check.startswith(('node', 'host'))][0]
    assert words.format(BOT_IP) in finding.remedy
    assert 'y: it removes dead nodes' not in finding.remedy


def test_computer_known_by_two_names():
    world = World()
    answer(host='bot1.local', state=SILENT)(world)
    world.hosts['/camera'] = 'bot1'
    add('/camera', ['/camera/x'], host='bot1')(world)
    facts = replace(world.facts(), computer=replace(COMPUTER, resolved={'bot1': (BOT_IP,)}))
    finding = [item for item in diagnose(facts, TYPES, IGNORE) if item.check == 'node_address'][0]
    assert 'on {0}: export ROS_IP={0}'.format(BOT_IP) in finding.remedy and finding.confidence


def at_root(**parameters):
    """Return a world in which the robot has no namespace, but these parameters at the root."""
    world = World()
    world.hosts['/base'] = world.hosts.pop('/bot1/base')
    for group in (world.publish, world.subscribe):
        for topic, names in list(group.items()):
            group[topic.replace('/bot1/', '/')] = [
                name.replace('/bot1/', '/') for name in group.pop(topic)]
    world.kinds = {topic.replace('/bot1/', '/'): kind for topic, kind in world.kinds.items()}
    world.parameters = parameters
    return world


AT_ROOT = {
    'parameter_bad': ({'robot_model': 'x'}, 'rosparam get /robot_model; rosparam delete '
                      '/robot_model'),
    'parameter_bad below': ({'robot': {'mhri': {'limits': 3}}},
                            'rosparam get /robot; rosparam delete /robot/mhri/limits'),
    'robot_type_unknown': ({'robot_type': 'generik'}, 'rosparam set /robot_type generic'),
    'odometry_missing': ({}, 'rostopic list   # its real topic, then: rosparam set '
                         '/robot/mhri/odometry "[<topic>]"'),
    'velocity_unheard': ({}, 'rostopic list   # its real topic, then: rosparam set '
                         '/robot/mhri/command "[<topic>]"'),
    'robot_leftover': ({}, 'rosparam delete /robot_type'),
    'robot_leftover of a name': ({'robot_name': 'r2', 'robot_model': 'x', 'r2': {'mhri': {}}},
                                 'rosparam delete /robot_type; rosparam delete /robot_model; '
                                 'rosparam delete /robot_name; rosparam delete /r2'),
    'robot_name_bad': ({'robot_name': '_r'}, 'rosparam set /robot_name <its name>'),
    'topic_type': ({}, 'rosparam set /robot_type <its type>'),
}


@pytest.mark.parametrize('case', sorted(AT_ROOT))
def test_remedies_for_the_robot_without_a_namespace(case):
    parameters, remedy = AT_ROOT[case]
    world = at_root(**dict({'robot_type': 'generic'}, **parameters))
    check = case.split()[0]
    if check == 'odometry_missing':
        del world.publish['/odom']
    elif check == 'velocity_unheard':
        del world.subscribe['/cmd_vel']
    elif check == 'topic_type':
        world.kinds['/imu'], world.publish['/imu'] = BOOL, ['/base']
    elif check == 'robot_leftover':
        without('/base')(world)
        without('/mhri_panel')(world)
        del world.publish['/cmd_vel']
    finding, = [item for item in world.wrong() if item.severity != FINE]
    assert finding.check == check
    assert finding.remedy.startswith(remedy)


def test_robot_without_a_namespace_can_be_healthy():
    assert at_root(robot_type='generic').wrong() == []


def test_real_robots_are_started_by_their_script():
    """The name is not all: their frames need a prefix, too, which turtle_remote.sh sees to."""
    words = 'on the robot: turtle_remote.sh {} '.format(HOST_IP)
    for spoil in (answer(uri_later='http://192.0.2.8:4000/'), add('/_bot/base', ['/_bot/x']),
                  links('/mux', Connection(True, '/bot1/cmd_vel', '/bot1/base'))):
        world = World()
        spoil(world)
        assert words in world.wrong()[0].remedy
    world = World()
    world.subscribe.pop('/bot1/cmd_vel')
    assert words + 'bot1' in world.wrong()[0].remedy
    facts = replace(world.facts(), master=Master('http://192.0.2.9:11311', '192.0.2.9', 11311))
    assert start_robot(facts, 'bot1').endswith('turtle_remote.sh 192.0.2.9 bot1')


def test_remedies_never_end_the_wrong_node():
    """At the address of the dead node another one lives: to kill by name would end that one."""
    world = World()
    stream('/bot1/odom', callerid='/other')(world)
    assert 'not "rosnode kill /bot1/base"' in world.wrong()[0].remedy
    world = World()
    answer(publications={})(world)
    assert 'rosnode kill' not in world.wrong()[0].remedy
