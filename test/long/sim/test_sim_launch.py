# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""turtlebot.launch and sim.launch, as roslaunch reads them; no master, nothing is started."""
import os
from pathlib import Path
import subprocess

import pytest
import roslaunch.config
import roslaunch.xmlloader

LAUNCH = Path(__file__).resolve().parents[3] / 'launch'
TYPES = ('turtlebot2', 'turtlebot3_burger', 'turtlebot3_waffle')
PACKAGE = ('<package format="2"><name>{0}</name><version>0.0.0</version><description>{0}'
           '</description><maintainer email="a@b.c">a</maintainer><license>x</license></package>')
# What stands for the robots' own bringup: files, their arguments, one node each.
CAMERA = ('', 'camera')
BRINGUP = {
    'turtlebot_bringup': {'minimal.launch': ('', 'kobuki'), '3dsensor.launch': CAMERA},
    'turtlebot3_bringup': {'turtlebot3_realsense.launch': CAMERA, 'turtlebot3_robot.launch': (
        '<arg name="multi_robot_name" default=""/>'
        '<arg name="set_lidar_frame_id" default="base_scan"/>'
        '<arg name="model" default="$(env TURTLEBOT3_MODEL)"/>'
        '<param name="tf_prefix" value="$(arg multi_robot_name)"/>', 'core')},
}
SMOOTHER = 'turtlebot_bringup/param/defaults/smoother.yaml'


def load(name, *arguments):
    """Return ({full name: node}, {parameter: value}) of a launch file."""
    config = roslaunch.config.ROSLaunchConfig()
    roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(
        str(LAUNCH / name), config, argv=list(arguments), verbose=False)
    assert config.config_errors == []
    return ({node.namespace + node.name: node for node in config.nodes},
            {key: param.value for key, param in config.params.items()})


def roslaunch_nodes(*arguments, **env):
    """Return (status, output) of the real roslaunch, asked what it would start."""
    done = subprocess.run(['roslaunch', '--nodes', str(LAUNCH / 'turtlebot.launch')]
                          + list(arguments), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, env=dict(os.environ, **env))
    return done.returncode, done.stdout


@pytest.fixture
def bringup(tmp_path):
    """Return the package path with fake bringup packages in front."""
    for package, files in BRINGUP.items():
        folder = tmp_path / package
        (folder / 'launch').mkdir(parents=True)
        (folder / 'package.xml').write_text(PACKAGE.format(package))
        for name, (body, node) in files.items():
            (folder / 'launch' / name).write_text('<launch>{}<node pkg="mhri" type="sim_robot" '
                                                  'name="{}"/></launch>'.format(body, node))
    (tmp_path / SMOOTHER).parent.mkdir(parents=True)
    (tmp_path / SMOOTHER).write_text('{}')
    return '{}:{}'.format(tmp_path, os.environ['ROS_PACKAGE_PATH'])


@pytest.mark.parametrize('count', [1, 4])
def test_sim_starts_so_many_robots(count):
    nodes, params = load('sim.launch', 'n:={}'.format(count))
    names = ['bot{}'.format(number + 1) for number in range(count)]
    assert sorted(nodes) == sorted('/{}/base'.format(name) for name in names)
    assert {(node.package, node.type) for node in nodes.values()} == {('mhri', 'sim_robot')}
    for number, name in enumerate(names):
        robot_type, _, model = TYPES[number % 3].partition('_')
        assert params['/{}/robot_type'.format(name)] == robot_type
        assert params.get('/{}/robot_model'.format(name), '') == model


def test_sim_of_given_types_and_names():
    nodes, params = load('sim.launch', 'n:=4', 'types:=turtlebot2 turtlebot3_waffle_pi',
                         'prefix:=lab')
    assert len(nodes) == 4 and '/lab4/base' in nodes
    assert [params.get('/lab{}/robot_model'.format(number)) for number in (1, 2, 3, 4)] == [
        None, 'waffle_pi', None, 'waffle_pi']


@pytest.mark.parametrize('arguments, robot_type, model', [
    (['type:=turtlebot2'], 'turtlebot2', None),
    (['type:=turtlebot3'], 'turtlebot3', 'burger'),
    (['type:=turtlebot3', 'model:=waffle'], 'turtlebot3', 'waffle'),
    (['type:=turtlebot3_waffle_pi'], 'turtlebot3', 'waffle_pi'),
])
def test_turtlebot(arguments, robot_type, model):
    nodes, params = load('turtlebot.launch', 'name:=bot7', *arguments)
    assert sorted(nodes) == ['/bot7/base']
    assert params['/bot7/robot_type'] == robot_type
    assert params.get('/bot7/robot_model') == model
    assert Path(params['/bot7/base/plan']).is_file()
    assert [params['/bot7/base/' + key] for key in ('x', 'y', 'yaw')] == ['', '', '']


@pytest.mark.parametrize('kind, wanted', [
    ('turtlebot2', ['/bot7/camera', '/bot7/kobuki', '/bot7/teleop_velocity_smoother']),
    ('turtlebot3_burger', ['/bot7/core']), ('turtlebot3_waffle', ['/bot7/camera', '/bot7/core'])])
def test_real_robot_includes_its_bringup(bringup, kind, wanted):
    status, output = roslaunch_nodes('name:=bot7', 'sim:=false', 'type:=' + kind,
                                     ROS_PACKAGE_PATH=bringup, TURTLEBOT3_MODEL='burger')
    assert status == 0, output
    assert sorted(output.split()) == wanted, 'and no simulator beside it'
