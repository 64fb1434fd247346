# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A terminal's ROS_NAMESPACE, or a lab's group, changes neither mhri's names nor its parameters."""
import signal
import sys

import pytest
import rosgraph
import rospy

from mhri.graph.ros.resources import read_resource
from mhri.robots.ros.graph_scan import look_for_robots, shipped_ignore_list
from support.drive_case import Driver
from support.fake_mux import StateEar
from support.own_node import own_node
from support.ros_system import node_words, wait_for
from support.velocity import VelocityEnd

system = own_node('namespace_test')

# As in the terminal of a robot, and the speed of a careful lab [m/s]; the shipped one is 0.5.
ROBOTS_OWN = {'ROS_NAMESPACE': 'tb3_0'}
LAB_MPS = 0.1
NODE = '<group {}><node pkg="mhri" type="mux" name="mux"><param name="config" ' \
       'value="{}"/><param name="kept" value=""/></node></group>'
INCLUDED = '<group ns="lab"><include file="$(find mhri)/launch/mhri.launch"><arg name="gui" ' \
           'value="none"/><arg name="inputs" value="joy"/><arg name="mux_config" value="{}"/>' \
           '</include></group>'
OF_LAUNCH = {'/mux', '/mhri_tasks', '/mhri_session', '/mhri_joy'}


@pytest.fixture(scope='module')
def config(tmp_path_factory):
    path = tmp_path_factory.mktemp('lab') / 'mux.yaml'
    text = read_resource('mux.yaml')
    assert text.count('linear_mps: 0.5') == 1
    path.write_text(text.replace('linear_mps: 0.5', 'linear_mps: {}'.format(LAB_MPS)))
    return path


def by_launch(system, config):
    return [system.start('roslaunch', 'mhri', 'mhri.launch', 'gui:=none', 'inputs:=joy',
                         'mux_config:={}'.format(config), env=ROBOTS_OWN)], OF_LAUNCH


def labs_file(system, config, text, env=None):
    path = config.parent / 'lab.launch'
    path.write_text('<launch>{}</launch>'.format(text))
    return system.start('roslaunch', str(path), env=env)


def included(system, config):
    return [labs_file(system, config, INCLUDED.format(config))], OF_LAUNCH


def node_of_a_group(system, config):
    return [labs_file(system, config, NODE.format('ns="lab"', config))], {'/mux'}


def node_of_a_labs_file(system, config):
    """The variable alone puts the lab's node, and its parameters, into a namespace."""
    return [labs_file(system, config, NODE.format('', config), ROBOTS_OWN)], {'/mux'}


def by_hand(system, config):
    words = [('mux', '_config:={}'.format(config)), ('tasks',), ('mhri_session', '__ns:=lab'),
             ('mhri_input', 'joy'),
             ('mhri_link', '--side', 'host', '--name', 'bot9', '--connect', '127.0.0.1:7447')]
    return [system.start(*node_words(*one), env=ROBOTS_OWN) for one in words], OF_LAUNCH | {
        '/bot9/mhri_link'}


@pytest.fixture(scope='module')
def operator():
    """An operator who says nothing of the speed: that of the file is in force."""
    made = Driver()
    made.set(None, None)
    made.check('robot1')
    return made


def nodes():
    """Return the names of all nodes."""
    return {node for group in rosgraph.Master('/namespace_test').getSystemState()
            for _, names in group for node in names}


@pytest.mark.parametrize('way', [by_launch, included, node_of_a_group, node_of_a_labs_file,
                                 by_hand])
def test_names_and_parameters_are_those_of_the_root(system, config, operator, way):
    others, end, state = nodes(), VelocityEnd('/robot1/cmd_vel'), StateEar()
    processes, own = way(system, config)
    try:
        wait_for(lambda: nodes() - others >= own, 120.0, lambda: 'nodes: {}'.format(nodes()))
        operator.stick.wait_listener()
        operator.centre()
        state.wait(lambda said: said.operator == rospy.get_name() and not said.waits_for
                   and any(one.topic and one.selected and not one.stands
                           for one in said.robots), 'to be ready')
        assert state.message.settings.linear_mps == pytest.approx(LAB_MPS)
        operator.push(operator.limits[0])
        wait_for(end.moves, what=lambda: 'the robot to be told to go; {!r}'.format(state))
        wait_for(lambda: round(end.last()[0], 3) == LAB_MPS, what='the speed of the file')
        assert max(mps for mps, _ in end.values()) < LAB_MPS + 1e-6
        operator.centre()
        assert [name for name in nodes() - others - own if name.count('/') > 1] == []
        found = look_for_robots(rospy.get_name(), shipped_ignore_list())
        assert {item.name for item in found.live} - {'bot9'} == {'robot1'}
    finally:
        for process in processes:
            system.kill(process, signal.SIGTERM, family=False)
        end.subscriber.unregister()
        wait_for(lambda: not nodes() & own, what=lambda: 'the end: {}'.format(nodes()))
        for name in ('mux', 'tb3_0', 'lab'):
            if rospy.has_param('/' + name):
                rospy.delete_param('/' + name)


def test_commands_of_a_terminal_are_not_a_robots_either(system, tmp_path):
    said = tmp_path / 'names'
    for name, words in (('mhri_task', ('robot1', 'goto', 'x=1', 'y=0')),
                        ('mhri_doctor', ('robot1', '--watchdog', '--yes', '--quick'))):
        text = 'import rospy; plain = rospy.init_node\ndef init(*words, **more):\n' \
            '  plain(*words, **more)\n  open("{}", "a").write(rospy.get_name() + " ")\n' \
            '  raise SystemExit\nrospy.init_node = init\n' \
            'from mhri.nodes.{} import main; main()'.format(said, name)
        process = system.start(sys.executable, '-c', text, *words, env=ROBOTS_OWN)
        process.wait(60)
    names = said.read_text().split()
    assert [name.rpartition('/')[0] for name in names] == ['', ''], names
