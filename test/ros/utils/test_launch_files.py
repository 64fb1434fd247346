# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The launch files, as roslaunch reads them."""
from pathlib import Path
import shlex
import xml.etree.ElementTree as ElementTree

import pytest
import roslaunch.config
import roslaunch.xmlloader

LAUNCH = Path(__file__).resolve().parents[3] / 'launch'
MHRI = LAUNCH / 'mhri.launch'


def load(path, *arguments):
    """Return roslaunch's configuration of a launch file with ARG:=VALUE arguments.

    :raises RLException: the file or an argument is wrong
    """
    config = roslaunch.config.ROSLaunchConfig()
    roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(
        str(path), config, argv=list(arguments), verbose=False)
    assert config.config_errors == []
    return config


def nodes(config):
    """Return {full name: node}."""
    return {node.namespace + node.name: node for node in config.nodes}


@pytest.mark.parametrize('path', [*LAUNCH.glob('*'), *(LAUNCH.parent / 'utils').rglob('*.launch')],
                         ids=lambda path: path.name)
def test_file_says_its_licence_and_its_arguments(path):
    text = path.read_text()
    assert '<!-- SPDX-FileCopyrightText: ' in text
    assert '<!-- SPDX-License-Identifier: BSD-3-Clause -->' in text
    assert [arg.get('name') for arg in ElementTree.fromstring(text).findall('arg')
            if not arg.get('doc')] == []


def test_host_by_default():
    config = load(MHRI)
    found = nodes(config)
    assert sorted(found) == ['/mhri_joy', '/mhri_panel', '/mhri_pedal',
                             '/mhri_session', '/mhri_tasks', '/mhri_voice', '/mux']
    assert found['/mhri_panel'].required and '--gui auto' in found['/mhri_panel'].args
    assert '--demo ' not in found['/mhri_panel'].args + ' '
    assert all(node.respawn and '--stand-by' in node.args for name, node in found.items()
               if name != '/mhri_panel'), 'alone, two hosts on one master would fight for a name'
    assert Path(config.params['/mux/config'].value).is_file()


@pytest.mark.parametrize('arguments, said, unsaid', [
    (['gui:=rqt'], ['--gui rqt'], ['--demo ']),
    (['gui:=standalone', 'robots:=bot1 bot2'], ['--gui standalone', "--robots 'bot1 bot2'"], []),
    (['demo:=true', 'screenshot:=/tmp/a b.png', 'demo_result:=/tmp/c d'],
     ['--demo ', "--screenshot '/tmp/a b.png'", "--demo-result '/tmp/c d'"], []),
    (['demo:=false', 'screenshot:=/tmp/a.png'], [], ['--demo ']),
])
def test_panels_command_line(arguments, said, unsaid):
    args = nodes(load(MHRI, *arguments))['/mhri_panel'].args
    assert [text for text in said if text not in args] == []
    assert [text for text in unsaid if text in args] == []


@pytest.mark.parametrize('robots', ["bot1' --demo --select 'bot1", "'", 'bot1\\', 'bot1" x'])
def test_names_of_robots_add_no_options_to_the_panel(robots):
    # Split as roslaunch does it.
    words = shlex.split(nodes(load(MHRI, 'robots:=' + robots))['/mhri_panel'].args)
    assert words[words.index('--robots') + 1] == robots.replace("'", '?')
    assert words[words.index('--robots') + 2] == '--screenshot'


def test_arguments_of_the_host():
    assert sorted(nodes(load(MHRI, 'gui:=none', 'inputs:=none'))) == [
        '/mhri_session', '/mhri_tasks', '/mux']
    assert sorted(nodes(load(MHRI, 'gui:=none', 'inputs:=joy'))) == [
        '/mhri_joy', '/mhri_session', '/mhri_tasks', '/mux']
    enabled = load(MHRI, 'enabling:=pedal').params
    assert enabled['/mhri_pedal/role'].value == 'enable'
    assert enabled['/mux/enabling'].value == 'pedal'
    assert load(MHRI, 'automatic_switching:=true').params['/mux/automatic_switching'].value is True
    assert '/mux/automatic_switching' not in load(MHRI).params, "the file's word counts then"
    recorded = load(MHRI, 'record:=true', 'record_cameras:=2').params
    assert recorded['/mhri_session/record'].value is True
    assert recorded['/mhri_session/cameras'].value == 2
    assert load(MHRI).params['/mhri_session/cameras'].value == 'all'
    assert not nodes(load(MHRI, 'required:=false'))['/mhri_panel'].required
    assert load(MHRI, 'mux_config:=/x.yaml').params['/mux/config'].value == '/x.yaml'
    budget = '/mhri/panel/camera_budget_mbit_s'
    assert load(MHRI, 'camera_budget_mbit_s:=20').params[budget].value == 20
    assert load(MHRI, 'camera_budget_mbit_s:=0').params[budget].value == 0
    assert budget not in load(MHRI).params, 'what a lab has set counts then'


@pytest.mark.parametrize('argument', ['sim:=many', 'demo:=perhaps', 'required:=perhaps'])
def test_wrong_value_is_refused(argument):
    with pytest.raises(Exception, match='many|perhaps|not supported'):
        load(MHRI, argument)


@pytest.mark.parametrize('count', [1, 3, 12])
def test_simulated_robots(count):
    config = load(MHRI, 'sim:={}'.format(count))
    names = ['bot{}'.format(number) for number in range(1, count + 1)]
    types = [config.params['/{}/robot_type'.format(name)].value for name in names]
    assert all(robot_type.startswith('turtlebot') for robot_type in types)
    assert '/bot{}/robot_type'.format(count + 1) not in config.params
    assert len([node for node in config.nodes if node.type == 'sim_robot']) == count


def test_simulated_robots_of_given_types_and_names():
    config = load(MHRI, 'sim:=3', 'sim_types:=turtlebot2 turtlebot3_burger', 'sim_prefix:=r')
    types = [config.params['/r{}/robot_type'.format(number)].value for number in (1, 2, 3)]
    assert types[0] == types[2] == 'turtlebot2' and types[1].startswith('turtlebot3')


def test_a_link_for_each_robot_with_a_master_of_its_own():
    config = load(MHRI, 'links:=bot1=tcp/10.0.0.1:7447 bot2', 'router:=10.0.0.2:7447',
                  'keep:=pictures')
    links = [node for node in config.nodes if node.type == 'mhri_link']
    assert sorted(node.namespace for node in links) == ['/bot1/', '/bot2/']
    assert all('--side host' in node.args and '--keep pictures' in node.args for node in links)
    by_name = {node.namespace: node.args for node in links}
    assert "--connect 'tcp/10.0.0.1:7447' --router ''" in by_name['/bot1/']
    assert "--connect '' --router '10.0.0.2:7447'" in by_name['/bot2/']
    assert not [node for node in config.nodes if node.type == 'mhri_guard']
    assert not [node for node in load(MHRI).nodes if node.type == 'mhri_link']


@pytest.mark.parametrize('more, namespaces', [
    ([], ['/bot1/', '/bot1/']), (['namespace:=/'], ['/', '/bot1/']),
    (['guard:=false'], ['/bot1/']), (['router:=10.0.0.2:7447'], ['/bot1/', '/bot1/'])])
def test_a_robot_with_a_master_of_its_own_has_link_and_guard(more, namespaces):
    config = load(LAUNCH / 'link.launch', 'side:=robot', 'name:=bot1', *more)
    assert sorted(node.namespace for node in config.nodes) == namespaces
    args = next(node.args for node in config.nodes if node.type == 'mhri_link')
    assert '--side robot' in args
    assert "--listen '{}'".format('' if 'router' in ''.join(more) else '0.0.0.0:7447') in args
    assert "--keys 'auto'" in args and '--keep-mb 500' in args


def test_test_nodes_have_names_of_their_own():
    """A result file is called after its test node: a second one would write over the first."""
    names = [test.get('test-name') for path in sorted(LAUNCH.parent.glob('test/*/*/*.test'))
             for test in ElementTree.parse(str(path)).getroot().iter('test')]
    assert sorted(names) == sorted(set(names))


def names(config):
    """Return (full names of nodes, {parameter: value})."""
    return sorted(nodes(config)), {name: one.value for name, one in config.params.items()}


@pytest.mark.parametrize('path, arguments', [
    ('mhri', ['sim:=2', 'web:=true', 'enabling:=pedal', 'voice:=ann', 'map:=m.yaml', 'drill:=x',
              'automatic_switching:=true', 'links:=bot8=192.0.2.1:7447 bot9=192.0.2.2:7447']),
    ('replay', ['path:=x']), ('inputs', ['inputs:=joy pedal']), ('sim', ['n:=2']),
    ('turtlebot', ['name:=bot1']), ('links', ['links:=bot9=192.0.2.2:7447']),
    ('link', ['side:=robot', 'name:=bot1']),
    ('link', ['side:=robot', 'name:=bot1', 'namespace:=/']),
    ('link', ['side:=host', 'name:=bot1', 'connect:=192.0.2.1:7447'])])
def test_names_are_the_same_in_a_terminal_or_a_group_of_any_namespace(
        path, arguments, monkeypatch, tmp_path):
    file, group = LAUNCH / (path + '.launch'), tmp_path / 'group.launch'
    plain = names(load(file, *arguments))
    given = ''.join('<arg name="{}" value="{}"/>'.format(*one.split(':=')) for one in arguments)
    group.write_text('<launch><group ns="lab"><include file="{}">{}</include></group>'
                     '</launch>'.format(file, given))
    assert plain[0] and names(load(group)) == plain
    monkeypatch.setenv('ROS_NAMESPACE', 'tb3_0')
    assert names(load(file, *arguments)) == plain
