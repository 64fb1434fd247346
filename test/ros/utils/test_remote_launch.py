# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot's launch files, as roslaunch reads them, over stand-ins for a robot's own packages."""
import os
import shutil

from support.checkout import REPO
import pytest
import roslaunch.config
import roslaunch.substitution_args
import roslaunch.xmlloader

REMOTE = REPO / 'utils' / 'remote'
PACKAGES = REPO / 'test' / 'support' / 'robot_packages'
OLDER = REPO / 'test' / 'support' / 'older_robot_packages'
TURTLEBOT = {'TURTLEBOT_BASE': 'kobuki', 'TURTLEBOT_3D_SENSOR': 'kinect',
             'TURTLEBOT_SIMULATION': 'false'}


@pytest.fixture(autouse=True)
def robot(monkeypatch):
    """Have the packages and variables of a robot, and a ROS_NAMESPACE that must not matter."""
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(
        PACKAGES, os.environ.get('ROS_PACKAGE_PATH', '')))
    for name, value in dict(TURTLEBOT, LDS_MODEL='LDS-01', ROS_NAMESPACE='TurtleBot7').items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv('TURTLEBOT3_MODEL', raising=False)


def put_before(folder, monkeypatch):
    """Have the packages of a folder before those that are there."""
    monkeypatch.setenv('ROS_PACKAGE_PATH', '{}:{}'.format(folder, os.environ['ROS_PACKAGE_PATH']))
    # roslaunch remembers where it found what.
    monkeypatch.setattr(roslaunch.substitution_args, '_rospack', None)


def load(name, *arguments, folder=REMOTE):
    """Return roslaunch's configuration of one of the robot's launch files."""
    config = roslaunch.config.ROSLaunchConfig()
    roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(
        str(folder / name), config, argv=list(arguments), verbose=False)
    assert config.config_errors == []
    return config


def nodes(config):
    return {node.namespace + node.name: node for node in config.nodes}


def values(config, prefix):
    """Return {rest of the name: value} of the parameters below a name."""
    return {name[len(prefix):]: param.value for name, param in config.params.items()
            if name.startswith(prefix)}


def test_nothing_of_the_robots_part_needs_mhri():
    texts = {path.name: path.read_text() for path in REMOTE.glob('*') if path.is_file()}
    assert [name for name, text in texts.items()
            if 'find mhri)' in text or 'pkg="mhri"' in text] == []


def test_turtlebot2_is_in_its_group():
    config = load('mhri_turtlebot2.launch', 'name:=bot1')
    found = nodes(config)
    assert sorted(found) == ['/bot1/cmd_vel_mux', '/bot1/mobile_base',
                             '/bot1/mobile_base_nodelet_manager', '/bot1/teleop_velocity_smoother']
    assert config.params['/bot1/robot_type'].value == 'turtlebot2'
    # What minimal.launch says of the robot is where it says it, in the group.
    assert config.params['/bot1/robot/type'].value == 'turtlebot'


def test_turtlebot2_is_smoothed():
    config = load('mhri_turtlebot2.launch', 'name:=bot1')
    smoother = nodes(config)['/bot1/teleop_velocity_smoother']
    assert smoother.args == ('load yocs_velocity_smoother/VelocitySmootherNodelet '
                             'mobile_base_nodelet_manager')
    assert dict(smoother.remap_args) == {
        'teleop_velocity_smoother/raw_cmd_vel': 'teleop/input',
        'teleop_velocity_smoother/smooth_cmd_vel': 'cmd_vel_mux/input/teleop',
        'teleop_velocity_smoother/odometry': 'odom',
        'teleop_velocity_smoother/robot_cmd_vel': 'mobile_base/commands/velocity'}
    assert values(config, '/bot1/teleop_velocity_smoother/')['accel_lim_v'] == 1.0
    assert '/bot1/teleop_velocity_smoother' not in nodes(
        load('mhri_turtlebot2.launch', 'name:=bot1', 'smoother:=false'))


def test_frames_of_two_turtlebot2_do_not_mix():
    frames = []
    for name in ('bot1', 'bot2'):
        base = load('mhri_turtlebot2.launch', 'name:=' + name).params
        camera = load('mhri_sensor.launch', 'name:=' + name).params
        assert base['/{}/tf_prefix'.format(name)].value == name
        frames.append({param.value for config in (base, camera) for key, param in config.items()
                       if key.endswith(('_frame', '_frame_id'))})
    assert frames[0] == {'bot1/odom', 'bot1/base_footprint', 'bot1/base_link',
                         'bot1/camera_rgb_optical_frame',
                         'bot1/camera_depth_optical_frame', 'bot1/camera_depth_frame'}
    assert not frames[0] & frames[1]


@pytest.mark.parametrize('model', ['burger', 'waffle_pi'])
def test_turtlebot3(model, monkeypatch):
    # The robot's own file wants it, whatever it is given; turtle_remote.sh sets it.
    monkeypatch.setenv('TURTLEBOT3_MODEL', 'burger')
    config = load('mhri_turtlebot3.launch', 'name:=bot3', 'model:=' + model)
    assert sorted(nodes(config)) == ['/bot3/turtlebot3_core']
    found = values(config, '/bot3/')
    assert found['robot_type'] == 'turtlebot3' and found['robot_model'] == model
    assert found['tf_prefix'] == found['turtlebot3_core/tf_prefix'] == 'bot3'
    assert found['turtlebot3_lds/frame_id'] == 'bot3/base_scan'
    for camera in ('cv_camera/frame_id', 'raspicam_node/camera_frame_id'):
        assert found.get(camera) == ('bot3/camera' if model == 'waffle_pi' else None)
    remaps = dict(nodes(config)['/bot3/turtlebot3_core'].remap_args)
    assert remaps['cv_camera/image_raw'] == 'camera/rgb/image_raw'


def test_turtlebot3_listens_to_its_guard_alone(monkeypatch):
    monkeypatch.setenv('TURTLEBOT3_MODEL', 'burger')
    arguments = 'mhri_turtlebot3.launch', 'name:=bot3', 'model:=burger'
    for guarded in (True, False):
        config = load(*arguments, 'guarded:={}'.format(guarded).lower())
        remaps = dict(nodes(config)['/bot3/turtlebot3_core'].remap_args)
        assert remaps.get('cmd_vel') == ('mhri_guard/velocity' if guarded else None)


def test_turtlebot3_of_older_releases(monkeypatch, tmp_path):
    """From 1.1.0 to 1.2.5 there was no argument called model, and up to 1.0.0 none at all."""
    model = 'waffle'
    monkeypatch.setenv('TURTLEBOT3_MODEL', 'burger')
    arguments = 'mhri_turtlebot3.launch', 'name:=bot3', 'model:=' + model
    shutil.copytree(str(OLDER / 'turtlebot3_bringup'), str(tmp_path / 'turtlebot3_bringup'))
    file = tmp_path / 'turtlebot3_bringup' / 'launch' / 'turtlebot3_robot.launch'
    file.write_text('<launch><param name="turtlebot3_lds/frame_id" value="base_scan"/></launch>')
    for folder, running in ((OLDER, ['/bot3/turtlebot3_core']), (tmp_path, [])):
        put_before(folder, monkeypatch)
        config = load(*arguments)
        assert sorted(nodes(config)) == running
        said = values(config, '/bot3/')
        assert said['turtlebot3_core/tf_prefix'] == 'bot3' and said['robot_model'] == model
        assert said['turtlebot3_lds/frame_id'] == 'bot3/base_scan'


def test_camera_of_a_waffle_pi_that_does_not_come_with_the_base(monkeypatch):
    put_before(OLDER, monkeypatch)
    config = load('mhri_turtlebot3_rpicamera.launch', 'name:=bot3')
    assert sorted(nodes(config)) == ['/bot3/raspicam_node']
    for camera in ('raspicam_node/camera_frame_id', 'cv_camera/frame_id'):
        assert config.params['/bot3/' + camera].value == 'bot3/camera'


def test_turtlebot3_model_of_the_environment(monkeypatch):
    with pytest.raises(Exception, match='TURTLEBOT3_MODEL'):
        load('mhri_turtlebot3.launch', 'name:=bot3')
    monkeypatch.setenv('TURTLEBOT3_MODEL', 'waffle')
    assert load('mhri_turtlebot3.launch',
                'name:=bot3').params['/bot3/robot_model'].value == 'waffle'


def test_turtlebot3_waffle_has_a_camera_in_its_group():
    config = load('mhri_turtlebot3_sensor.launch', 'name:=bot3')
    assert sorted(nodes(config)) == ['/bot3/camera/driver']
    remaps = dict(nodes(config)['/bot3/camera/driver'].remap_args)
    assert remaps['camera/color/image_raw'] == 'camera/rgb/image_raw'
    frames = values(config, '/bot3/camera/driver/')
    assert frames['color_optical_frame_id'] == 'bot3/camera_rgb_optical_frame'
    assert all(frame.startswith('bot3/') for frame in frames.values())


def real(*arguments):
    """Return the configuration of turtlebot.launch for a real robot."""
    return load('turtlebot.launch', 'sim:=false', *arguments, folder=REPO / 'launch')


def told(*configs):
    """Return ({node: (program, arguments, remaps)}, {parameter: value}) of configurations."""
    found = {name: (node.package, node.type, node.args, sorted(node.remap_args))
             for config in configs for name, node in nodes(config).items()}
    return found, {key: param.value for config in configs for key, param in config.params.items()}


@pytest.mark.parametrize('arguments, files', [
    (['type:=turtlebot2'], [['mhri_turtlebot2.launch'], ['mhri_sensor.launch']]),
    (['type:=turtlebot2', 'camera:=false', 'smoother:=false'],
     [['mhri_turtlebot2.launch', 'smoother:=false']]),
    (['type:=turtlebot3'], [['mhri_turtlebot3.launch', 'model:=burger']]),
    (['type:=turtlebot3_waffle_pi'], [['mhri_turtlebot3.launch', 'model:=waffle_pi']]),
    (['type:=turtlebot3_waffle'], [['mhri_turtlebot3.launch', 'model:=waffle'],
                                   ['mhri_turtlebot3_sensor.launch']]),
    (['type:=turtlebot3_waffle', 'camera:=false'], [['mhri_turtlebot3.launch', 'model:=waffle']]),
])
def test_turtlebot_launch_starts_a_real_robot_the_same_way(arguments, files, monkeypatch):
    monkeypatch.setenv('TURTLEBOT3_MODEL', 'burger')
    expected = told(*[load(name, 'name:=bot1', *more) for name, *more in files])
    assert expected[0]
    assert told(real('name:=bot1', *arguments)) == expected


GENERIC = '''<launch>
  {}
  <param name="told" value="$(arg {})"/>
  <node pkg="mhri" type="sim_robot" name="base"/>
</launch>
'''


@pytest.mark.parametrize('argument', ['name', 'robot_name', 'multi_robot_name', 'tf_prefix'])
def test_generic_robot_is_told_its_name(tmp_path, argument):
    file = tmp_path / 'own.launch'
    file.write_text(GENERIC.format('<arg name="{}" default="x"/>'.format(argument), argument))
    config = load('mhri_generic.launch', 'name:=husky1', 'robot_launch:={}'.format(file))
    found = values(config, '/husky1/')
    assert sorted(nodes(config)) == ['/husky1/base']
    assert found == {'robot_type': 'generic', 'tf_prefix': 'husky1', 'told': 'husky1'}


def test_generic_robot_of_a_labs_type(tmp_path):
    file = tmp_path / 'own.launch'
    file.write_text(GENERIC.format('<arg name="speed" default="1"/>', 'speed'))
    config = load('mhri_generic.launch', 'name:=r1', 'robot_launch:={}'.format(file),
                  'robot_type:=crawler')
    assert values(config, '/r1/') == {'robot_type': 'crawler', 'tf_prefix': 'r1', 'told': 1}
