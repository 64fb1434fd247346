# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which namespaces are robots."""
import glob
import os

import pytest

from mhri.base.config import ConfigError
from mhri.base.robot_types import load_robot_types, resolve_robot_type, Seen
from mhri.robots.discovery import (
    Candidate, find_candidates, IgnoreList, named_instances, parameters_of, parse_ignore_list,
    TWIST)

IGNORE = IgnoreList(('/rosout', '/*/rosout', '/bot*/helper'), ('mux', 'rqt_*'), ('rqt_*',))
RESOURCE = os.path.join(os.path.dirname(__file__), '..', '..', '..', 'resource', 'discovery.yaml')


def state(*nodes):
    """Return a system state in which each node publishes, subscribes or serves something."""
    groups = [[], [], []]
    for number, node in enumerate(nodes):
        groups[number % 3].append(['/topic{}'.format(number), [node]])
    return groups


CASES = {
    'by_type': ((), {'bot1': {'robot_type': 'turtlebot2'}}, (), [Candidate('bot1', 'turtlebot2')]),
    'by_nodes': (('/bot1/base',), {}, (), [Candidate('bot1', None, ('/bot1/base',))]),
    'type_without_a_namespace': (
        ('/base', '/rosout'), {'robot_type': 'x'}, (),
        [Candidate('robot', 'x', seen=Seen(at_root=True))]),
    'ignored_node': (('/bot1/rosout', '/bot1/helper'), {}, (), []),
    'ignored_node_does_not_hide_others': (
        ('/bot1/rosout', '/bot1/base'), {}, (), [Candidate('bot1', None, ('/bot1/base',))]),
    'ignored_name_of_one_that_says_it_is_a_robot': (
        ('/rqt_bot/a', '/rqt_bot/rosout'), {'rqt_bot': {'robot_type': 'x'}}, (),
        [Candidate('rqt_bot', 'x', ('/rqt_bot/a',))]),
    'ignored_node_of_one_that_says_it_is_a_robot': (
        ('/bot1/base', '/bot1/helper'), {'bot1': {'robot_type': 'x'}}, (),
        [Candidate('bot1', 'x', ('/bot1/base',))]),
    'tools_of_a_terminal_with_the_namespace_of_a_robot': (
        ('/tb3_0/rqt_gui_py_node_1', '/lab/a/rqt_plot'), {}, (), []),
    'a_tool_does_not_hide_others': (
        ('/bot1/base', '/bot1/rqt_plot'), {}, (), [Candidate('bot1', None, ('/bot1/base',))]),
    'a_tool_beside_a_robot_that_is_off': (
        ('/bot1/rqt_plot',), {'bot1': {'robot_type': 'x'}}, (), [Candidate('bot1', 'x')]),
    'a_multiplexer_of_its_own': (('/bot1/mux',), {}, (), [Candidate('bot1', None, ('/bot1/mux',))]),
    'name_of_mhri_itself': ((), {'mux': {'robot_type': 'x'}}, (), [Candidate(
        'mux', 'x', problem='"mux" is a name of mhri itself: choose another one')]),
    'known': (('/bot1/base', '/bot2/base'), {'bot1': {'robot_type': 'x'}}, ('bot1',),
              [Candidate('bot2', None, ('/bot2/base',))]),
    'sorted': (('/b/n', '/c/n'), {'a': {'robot_type': 'x'}}, (), [
        Candidate('a', 'x'), Candidate('b', None, ('/b/n',)), Candidate('c', None, ('/c/n',))]),
}


@pytest.mark.parametrize('name', ['turtlebot', 'gazebo', 'tfbot', 'mhri_1', 'rviz_bot', 'rqt_2'])
def test_no_pattern_of_the_shipped_list_hides_a_robot_with_a_type(name):
    """The contract: a namespace with a robot_type is a robot."""
    with open(RESOURCE) as file:
        ignore = parse_ignore_list(file.read(), RESOURCE)
    node, topic = '/{}/base'.format(name), '/{}/cmd_vel'.format(name)
    graph = [[['/{}/odom'.format(name), [node]]], [[topic, [node]]], []]
    found = find_candidates(graph, {name: {'robot_type': 'turtlebot3'}}, ignore,
                            topic_types=[(topic, TWIST)])
    assert [(item.name, item.nodes, item.problem) for item in found] == [(name, (node,), None)]


@pytest.mark.parametrize('case', sorted(CASES))
def test_find_candidates(case):
    """A robot has a type, or nodes that are neither ignored nor under a known robot."""
    nodes, parameters, known, expected = CASES[case]
    assert find_candidates(state(*nodes), parameters, IGNORE, known) == expected


def test_invalid_names_are_found_with_their_problem():
    """Shown as refused, not left out in silence."""
    found = find_candidates(state('/_bot/base'), {'1bot': {'robot_type': 'x'}}, IGNORE)
    assert [(item.name, bool(item.problem)) for item in found] == [('1bot', True), ('_bot', True)]


def test_shipped_ignore_list_hides_mhri_itself_and_no_robot():
    """The host's own nodes are never offered."""
    with open(RESOURCE, encoding='utf-8') as stream:
        ignore = parse_ignore_list(stream.read(), 'discovery.yaml')
    own = state('/mux', '/rosbridge_websocket', '/rosapi', '/bot2/rosbridge_websocket',
                '/rosout', '/mhri_panel', '/robot_controller/x', '/mux_in/x',
                '/vrpn_client_node/x', '/bot1/base', '/rosbag/record', '/tb3_0/rqt_gui_py_node_1',
                '/tb3_0/rviz_2', '/tb3_0/record_3', '/tb3_0/rostopic_4', '/tb3_0/rosout')
    assert [item.name for item in find_candidates(own, {}, ignore)] == ['bot1', 'bot2']


@pytest.mark.parametrize('text, key', [
    ('nodes: 3', 'nodes'), ('spaces: [a]', 'spaces'), ('namespaces: {a: b}', 'namespaces')])
def test_ignore_list_error_names_file_and_key(text, key):
    """A lab adds to it."""
    with pytest.raises(ConfigError, match='f.yaml: {}: '.format(key)):
        parse_ignore_list(text, 'f.yaml')


def graph(*lines):
    """Return (system state, topic types) of lines such as ``/base reads /cmd_vel``.

    A topic is a Twist unless a type follows it.
    """
    publishers, subscribers, kinds = {}, {}, {}
    for line in lines:
        node, does, topic, *kind = line.split()
        group = {'reads': subscribers, 'writes': publishers}[does]
        group.setdefault(topic, []).append(node)
        kinds[topic] = kind[0] if kind else TWIST
    groups = [[[topic, nodes] for topic, nodes in group.items()]
              for group in (publishers, subscribers, {})]
    return groups, [list(item) for item in kinds.items()]


def shipped(folder, load):
    """Return what a function makes of the shipped files of a folder."""
    files = []
    for path in sorted(glob.glob(os.path.join(os.path.dirname(RESOURCE), folder))):
        with open(path, encoding='utf-8') as stream:
            files.append((path, stream.read()))
    return load(files)


TYPES = shipped('robots/*.yaml', load_robot_types)[0]
SHIPPED_IGNORE = shipped('discovery.yaml', lambda files: parse_ignore_list(files[0][1], 'file'))
TB3 = ('/turtlebot3_core reads /cmd_vel', '/turtlebot3_core writes /odom nav_msgs/Odometry',
       '/turtlebot3_core writes /sensor_state turtlebot3_msgs/SensorState',
       '/turtlebot3_lds writes /scan sensor_msgs/LaserScan')
TURTLE = ('/turtlesim reads /turtle1/cmd_vel', '/turtlesim writes /turtle1/pose turtlesim/Pose')
TURTLE2 = tuple(line.replace('turtle1', 'turtle2') for line in TURTLE)
TB2 = ('/cmd_vel_mux reads /cmd_vel_mux/input/teleop', '/cmd_vel_mux reads /cmd_vel_mux/input/navi',
       '/velocity_smoother reads /teleop/input',
       '/cmd_vel_mux writes /mobile_base/commands/velocity',
       '/mobile_base reads /mobile_base/commands/velocity',
       '/mobile_base writes /mobile_base/sensors/core kobuki_msgs/SensorState',
       '/mobile_base writes /odom nav_msgs/Odometry',
       '/camera/driver writes /camera/rgb/image_raw sensor_msgs/Image')

HUSKY = ('/joy_teleop/joy_node writes /joy_teleop/joy sensor_msgs/Joy',
         '/joy_teleop/teleop_twist_joy reads /joy_teleop/joy sensor_msgs/Joy',
         '/joy_teleop/teleop_twist_joy writes /joy_teleop/cmd_vel',
         '/twist_marker_server writes /twist_marker_server/cmd_vel',
         '/twist_mux reads /joy_teleop/cmd_vel', '/twist_mux reads /twist_marker_server/cmd_vel',
         '/twist_mux reads /joy_teleop/lock std_msgs/Bool',
         '/twist_mux writes /joy_teleop/active std_msgs/String',
         '/watcher reads /joy_teleop/active std_msgs/String',
         '/twist_mux reads /cmd_vel', '/twist_mux writes /husky_velocity_controller/cmd_vel',
         '/husky_node reads /husky_velocity_controller/cmd_vel',
         '/husky_node writes /husky_velocity_controller/odom nav_msgs/Odometry')
HUSKY_SEEN = Seen(True, None, 'cmd_vel')

# Name, robot_type and Seen of what is offered; None for Seen: it has a problem.
GRAPHS = {
    'turtlebot3_at_the_root': (TB3, {}, [('robot', None, Seen(True, 'turtlebot3', 'cmd_vel'))]),
    'with_a_name_that_cannot_be': (TB3, {'robot_name': 'my burger'}, [('my burger', None, None)]),
    'beside_a_robot_of_its_name': (TB3 + ('/robot/base reads /robot/cmd_vel',), {}, [
        ('/', None, None), ('robot', None, Seen(False, None, 'cmd_vel'))]),
    'beside_robots_with_namespaces': (
        TB3 + ('/bot1/base reads /bot1/cmd_vel', '/bot1/base writes /bot1/odom nav_msgs/Odometry'),
        {'bot2': {'robot_type': 'turtlebot2'}}, [
            ('bot1', None, Seen(False, None, 'cmd_vel')), ('bot2', 'turtlebot2', Seen()),
            ('robot', None, Seen(True, 'turtlebot3', 'cmd_vel'))]),
    'its_camera_is_no_robot': (TB2, {}, [
        ('robot', None, Seen(True, 'turtlebot2', 'teleop/input'))]),
    'turtlesim_at_the_root': (TURTLE, {}, [
        ('robot', None, Seen(True, 'turtlesim', 'turtle1/cmd_vel'))]),
    'two_turtles': (TURTLE + TURTLE2, {}, [
        ('robot', None, Seen(True, 'turtlesim', 'turtle1/cmd_vel')),
        ('turtle2', None, Seen(False, 'turtlesim', None, '/turtle2'))]),
    'two_turtles_in_a_namespace': (
        tuple(line.replace(' /turtle', ' /sim/turtle').replace('/turtlesim ', '/sim/turtlesim ')
              for line in TURTLE + TURTLE2), {'sim': {'robot_type': 'turtlesim'}},
        [('sim', 'turtlesim', Seen(False, 'turtlesim', 'turtle1/cmd_vel')),
         ('sim_turtle2', None, Seen(False, 'turtlesim', None, '/sim/turtle2'))]),
    'a_robot_of_the_name_of_a_turtle': (
        TURTLE + TURTLE2 + ('/turtle2/base reads /turtle2/drive',), {}, [
            ('robot', None, Seen(True, 'turtlesim', 'turtle1/cmd_vel')),
            ('turtle2', None, Seen(False, None, 'cmd_vel'))]),
    'another_topic': (('/crawler/base reads /crawler/drive/velocity',), {}, [
        ('crawler', None, Seen(False, None, 'drive/velocity'))]),
    'behind_its_own_multiplexer': (
        ('/b/mux reads /b/input', '/b/mux writes /b/cmd_vel', '/b/base reads /b/cmd_vel'), {},
        [('b', None, Seen(False, None, 'input', None, ('cmd_vel',)))]),
    'behind_its_own_multiplexer_with_several_inputs': (
        ('/b/mux reads /b/joy', '/b/mux reads /b/nav', '/b/mux writes /b/cmd_vel',
         '/b/base reads /b/cmd_vel', '/b/mhri_guard writes /b/cmd_vel'), {},
        [('b', None, Seen(False, None, None, None, ('cmd_vel',), ('cmd_vel',)))]),
    'beside_its_own_navigation': (
        ('/b/move_base writes /b/cmd_vel', '/b/base reads /b/cmd_vel'), {},
        [('b', None, Seen(False, None, 'cmd_vel'))]),
    'beside_somebody_elses_multiplexer': (
        ('/lab/mux reads /lab/joy', '/lab/mux writes /b/cmd_vel', '/b/base reads /b/cmd_vel'), {},
        [('b', None, Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'behind_a_multiplexer_outside_of_it': (
        ('/mux_of_b reads /b/input', '/mux_of_b reads /pad/cmd_vel', '/mux_of_b writes /b/cmd_vel',
         '/b/base reads /b/cmd_vel'), {},
        [('b', None, Seen(False, None, 'input', None, ('cmd_vel',)))]),
    'beside_one_that_follows_another_robot': (
        ('/a/base reads /a/cmd_vel', '/follower reads /a/cmd_vel', '/follower writes /b/cmd_vel',
         '/b/base reads /b/cmd_vel'), {},
        [('a', None, Seen(False, None, 'cmd_vel')), ('b', None, Seen(False, None, 'cmd_vel'))]),
    'beside_one_that_follows_the_speed_of_another_robot': (
        ('/a/base reads /a/cmd_vel', '/a/base writes /a/speed',
         '/a/base writes /a/odom nav_msgs/Odometry', '/b/follower reads /a/speed',
         '/b/follower writes /b/cmd_vel',
         '/b/base reads /b/cmd_vel'), {},
        [('a', None, Seen(False, None, 'cmd_vel', None, ('speed',))),
         ('b', None, Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'one_is_the_likeliest': (('/b/x reads /b/aux', '/b/y reads /b/base_cmd_vel'), {}, [
        ('b', None, Seen(False, None, 'base_cmd_vel'))]),
    'no_twist': (('/base reads /cmd_vel std_msgs/String',), {}, []),
    'tools_that_read_along': (
        ('/rostopic_123_4 reads /cmd_vel', '/record_99 reads /cmd_vel', '/mux reads /cmd_vel',
         '/mhri_panel reads /robot_controller/twist', '/rqt_gui_py_node_7 reads /cmd_vel',
         '/watcher reads /robot_controller/twist', '/rosbridge_websocket reads /cmd_vel'), {}, []),
    'behind_a_bridge': (
        ('/rosbridge_websocket reads /b/cmd_vel', '/rosbridge_websocket writes /b/pose x/Pose'), {},
        [('b', None, Seen(False, None, 'cmd_vel'))]),
    'several_behind_one_bridge': (
        ('/rosbridge_websocket reads /a/drive', '/rosbridge_websocket writes /a/state x/State',
         '/rosbridge_websocket reads /b/cmd_vel',
         '/rosbridge_websocket writes /b/odom nav_msgs/Odometry'), {'a': {'robot_type': 'generic'}},
        [('a', 'generic', Seen(False, None, 'drive')), ('b', None, Seen(False, None, 'cmd_vel'))]),
    'behind_a_bridge_without_a_namespace': (
        ('/rosbridge_websocket reads /cmd_vel',
         '/rosbridge_websocket writes /odom nav_msgs/Odometry'), {},
        [('robot', None, Seen(True, None, 'cmd_vel'))]),
    'a_bridge_of_a_page_that_shows_and_drives': (
        ('/rosbridge_websocket reads /b/cmd_vel', '/rosbridge_websocket writes /b/cmd_vel',
         '/rosbridge_websocket reads /cmd_vel', '/rosbridge_websocket writes /goal x/Goal'),
        {}, []),
    'a_bridge_of_a_page_beside_the_robot': (
        ('/rosbridge_websocket reads /b/cmd_vel', '/rosbridge_websocket writes /b/web/cmd_vel',
         '/rosbridge_websocket writes /b/goal x/Goal', '/b/base reads /b/cmd_vel'), {},
        [('b', None, Seen(False, None, 'cmd_vel'))]),
    'tools_that_listen_and_publish': (
        ('/play_3 reads /b/cmd_vel', '/play_3 writes /b/odom nav_msgs/Odometry',
         '/mux reads /b/cmd_vel', '/mux writes /b/mhri_guard/command geometry_msgs/TwistStamped',
         '/mhri_replay writes /b/odom nav_msgs/Odometry', '/mhri_session reads /b/cmd_vel'), {},
        []),
    'with_its_guard': (
        TB3 + ('/robot/mhri_guard reads /robot/mhri_guard/command geometry_msgs/TwistStamped',
               '/robot/mhri_guard writes /cmd_vel'), {},
        [('robot', None, Seen(True, 'turtlebot3', 'cmd_vel'))]),
    'a_guard_alone': (
        ('/b/mhri_guard reads /b/mhri_guard/command geometry_msgs/TwistStamped',
         '/b/mhri_guard writes /b/cmd_vel'), {}, []),
    'two_namespaces_deep': (
        ('/lab/bot1/base reads /lab/bot1/cmd_vel', '/lab/bot2/base reads /lab/bot2/cmd_vel'),
        {'lab': {'bot1': {'robot_type': 'turtlebot3'}, 'bot2': {'robot_type': 'turtlebot3'}}},
        [('lab/bot1', None, None), ('lab/bot2', None, None)]),
    'husky_control': (HUSKY, {}, [('robot', None, HUSKY_SEEN)]),
    'husky_control_of_a_name_and_a_type': (
        HUSKY, {'robot_type': 'generic', 'robot_name': 'husky'},
        [('husky', 'generic', HUSKY_SEEN)]),
    'husky_control_in_gazebo_beside_others': (
        tuple(line.replace('/husky_node', '/gazebo') for line in HUSKY) + (
            '/tb3/state_publisher writes /tf tf2_msgs/TFMessage',
            '/gazebo reads /tb3/cmd_vel', '/gazebo writes /tb3/odom nav_msgs/Odometry'), {},
        [('robot', None, HUSKY_SEEN), ('tb3', None, Seen(False, None, 'cmd_vel'))]),
    'husky_control_without_an_external_input': (
        tuple(line for line in HUSKY if line != '/twist_mux reads /cmd_vel'), {},
        [('husky_velocity_controller', None, Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'a_pad_of_a_robot_with_a_namespace': (
        ('/bluetooth_teleop/teleop writes /bluetooth_teleop/cmd_vel',
         '/twist_mux reads /bluetooth_teleop/cmd_vel', '/twist_mux writes /jackal/cmd_vel',
         '/jackal/base reads /jackal/cmd_vel'), {'jackal': {'robot_type': 'generic'}},
        [('jackal', 'generic', Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'a_pad_of_a_robot_to_which_somebody_listens': (
        ('/twist_mux reads /pad/cmd_vel', '/twist_mux writes /b/cmd_vel',
         '/b/base reads /b/cmd_vel', '/logger reads /b/cmd_vel', '/logger reads /pad/cmd_vel'), {},
        [('b', None, Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'a_pad_that_the_base_itself_listens_to': (
        ('/handle/joy writes /handle/joy sensor_msgs/Joy', '/handle/teleop writes /handle/cmd_vel',
         '/base reads /handle/cmd_vel', '/base reads /cmd_vel',
         '/base writes /odom nav_msgs/Odometry'), {},
        [('robot', None, Seen(True, None, 'cmd_vel'))]),
    'one_that_says_it_is_a_robot_though_another_has_its_base': (
        ('/b/base reads /b/cmd_vel', '/a/mux reads /a/cmd_vel', '/a/mux writes /b/cmd_vel'),
        {'a': {'robot_type': 'generic'}},
        [('a', 'generic', Seen(False, None, 'cmd_vel')),
         ('b', None, Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'a_root_that_commands_a_robot_with_a_namespace': (
        ('/twist_mux reads /cmd_vel', '/twist_mux writes /b/cmd_vel', '/b/base reads /b/cmd_vel'),
        {}, [('b', None, Seen(False, None, 'cmd_vel', None, ('cmd_vel',)))]),
    'robots_of_one_simulator': (
        ('/stage reads /a/cmd_vel', '/stage reads /b/cmd_vel',
         '/stage writes /a/odom nav_msgs/Odometry', '/stage writes /b/odom nav_msgs/Odometry'), {},
        [('a', None, Seen(False, None, 'cmd_vel')), ('b', None, Seen(False, None, 'cmd_vel'))]),
    'robots_of_one_simulator_that_tells_nothing': (
        ('/sim reads /a/cmd_vel', '/sim reads /b/cmd_vel'), {},
        [('a', None, Seen(False, None, 'cmd_vel')), ('b', None, Seen(False, None, 'cmd_vel'))]),
    'a_node_with_a_parameter_of_that_name': (
        ('/bot1/base reads /bot1/cmd_vel',), {'bot1': {'base': {'robot_type': 'x'}}},
        [('bot1', None, Seen(False, None, 'cmd_vel'))]),
    'mirrored_by_multimaster_fkie': (
        # The nodes of two robots' masters and of this one, on which fkie has put them, too; its own
        # are called after their computers where there are several.
        ('/master_discovery writes /master_discovery/changes fkie_multimaster_msgs/MasterState',
         '/master_discovery writes /master_discovery/linkstats x/LinkStatesStamped',
         '/master_sync reads /master_discovery/changes fkie_multimaster_msgs/MasterState',
         '/master_discovery_pi1 writes /master_discovery/changes fkie_multimaster_msgs/MasterState',
         '/pi2/master_discovery writes /pi2/master_discovery/changes x/MasterState',
         '/pi2/master_sync reads /pi2/master_discovery/changes x/MasterState',
         '/node_manager reads /rosout_agg rosgraph_msgs/Log',
         '/pi2/node_manager_daemon writes /pi2/diagnostics_agg diagnostic_msgs/DiagnosticArray',
         '/pi2/default_cfg/x writes /pi2/x std_msgs/String',
         '/bot1/base reads /bot1/cmd_vel', '/bot1/base writes /bot1/odom nav_msgs/Odometry',
         '/bot2/mhri_guard writes /bot2/cmd_vel', '/bot2/base reads /bot2/cmd_vel'), {},
        # Parameters are not mirrored: no robot says its type.
        [('bot1', None, Seen(False, None, 'cmd_vel')),
         ('bot2', None, Seen(False, None, 'cmd_vel'))]),
}


@pytest.mark.parametrize('case', sorted(GRAPHS))
def test_what_the_graph_tells(case):
    """Robots without a namespace, without a type, and with a velocity topic of their own name."""
    lines, parameters, expected = GRAPHS[case]
    groups, kinds = graph(*lines)
    found = find_candidates(groups, parameters, SHIPPED_IGNORE, (), kinds, TYPES)
    assert [(item.name, item.robot_type, None if item.problem else item.seen)
            for item in found] == expected


def test_the_nodes_of_a_robot_at_the_root_are_those_that_drive_and_tell():
    """At these doors it is knocked, to know whether the robot is alive."""
    groups, kinds = graph(*TB3, '/teleop writes /cmd_vel', '/rviz_1 reads /odom nav_msgs/Odometry')
    found, = find_candidates(groups, {'robot_type': 'turtlebot3'}, SHIPPED_IGNORE, (), kinds, TYPES)
    assert '/turtlebot3_core' in found.nodes and '/rviz_1' not in found.nodes


@pytest.mark.parametrize('known, left', [
    ((), ['robot', 'turtle2']), (('robot',), ['turtle2']), (('turtle2',), ['robot']),
    (('turtle1',), ['turtle2']), (('turtle1', 'turtle2'), [])])
def test_no_turtle_is_offered_twice(known, left):
    """The first one may have been added by hand, by its own name."""
    groups, kinds = graph(*TURTLE, *TURTLE2)
    found = find_candidates(groups, {}, SHIPPED_IGNORE, known, kinds, TYPES)
    assert [item.name for item in found] == left
    assert named_instances(groups, {}, SHIPPED_IGNORE, kinds, TYPES) == {
        name: Seen(False, 'turtlesim', None, '/' + name) for name in ('turtle1', 'turtle2')}


@pytest.mark.parametrize('at_root, expected', [
    (True, {'robot_type': 'turtlebot3', 'robot_model': 'burger', 'mhri': {'label': 'Lab'}}),
    (False, {'mhri': {'label': 'Lab'}})])
def test_parameters_of_a_robot(at_root, expected):
    """Without a namespace they are at the root, but for those that override its template."""
    parameters = {'robot_type': 'turtlebot3', 'robot_model': 'burger', 'rosdistro': 'noetic',
                  'mhri': {'robots': ['robot']}, 'robot': {'mhri': {'label': 'Lab'}}}
    assert parameters_of('robot', parameters, at_root) == expected
    assert parameters_of('other', {'other': 3}) == {}


@pytest.mark.parametrize('lines, name, owner', [
    (HUSKY, 'joy_teleop', 'robot'), (HUSKY, 'husky_velocity_controller', 'robot'),
    (HUSKY, 'twist_marker_server', 'robot'),
    (('/twist_mux reads /cmd_vel', '/twist_mux writes /b/cmd_vel', '/b/base reads /b/cmd_vel'),
     'robot', 'b')])
def test_what_only_commands_another_robot_is_never_driven(lines, name, owner):
    """Not offered, and held still where an operator types its name."""
    groups, kinds = graph(*lines)
    parts = find_candidates(groups, {}, SHIPPED_IGNORE, (), kinds, TYPES, with_parts=True)
    seen, = [item.seen for item in parts if item.name == name]
    assert seen.input_of == owner
    kind, errors = resolve_robot_type(TYPES, name, {}, seen)
    assert kind.is_behind and owner in str(errors[0])
    kind, errors = resolve_robot_type(TYPES, name, {'mhri': {'command': ['chosen']}}, seen)
    assert not kind.is_behind and not errors
