# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot types: the shipped templates, the parameters over them, and slips in both."""
import glob
import math
import os

import pytest
import yaml

from mhri.base.config import ConfigError
from mhri.base.robot_hardware import HardwareStopSpec, MotorPowerSpec
from mhri.base.robot_types import (
    Export, Limits, load_robot_types, parse_robot_type, resolve_robot_type, Seen)

RESOURCE = os.path.join(os.path.dirname(__file__), '..', '..', '..', 'resource', 'robots')
GOOD = 'name: crawler\nlimits: {linear_mps: 0.3, angular_rad_s: 1.0}\ncommand: cmd_vel\n'


def shipped():
    """Return the templates that come with mhri."""
    files = []
    for path in sorted(glob.glob(os.path.join(RESOURCE, '*.yaml'))):
        with open(path, encoding='utf-8') as stream:
            files.append((path, stream.read()))
    types, errors = load_robot_types(files)
    assert errors == []
    return types


CONTRACT = {
    'turtlebot2': ((0.65, 3.14), ('teleop/input', 'cmd_vel_mux/input/teleop'),
                   ('mobile_base/sensors/imu_data',), ('odom',), ('camera/rgb/image_raw',),
                   ('camera/depth_registered/image_raw',), ('camera/depth_registered/points',),
                   ('scan',), ()),
    'turtlebot3': ((0.22, 1.82), ('cmd_vel',), ('imu',), ('odom',),
                   ('camera/rgb/image_raw', 'raspicam_node/image'), (), (), ('scan',),
                   ('battery_state',)),
    'turtlesim': ((2.0, 2.0), ('turtle1/cmd_vel',), (), ('turtle1/pose',), (), (), (), (), ()),
    'generic': ((0.5, 1.0), ('cmd_vel',), ('imu', 'imu/data'), ('odom',),
                ('camera/rgb/image_raw', 'camera/image_raw'), ('camera/depth/image_raw',),
                ('camera/depth/points', 'points'), ('scan',), ('battery_state',)),
}


@pytest.mark.parametrize('name', sorted(CONTRACT))
def test_shipped_templates_are_those_of_the_contract(name):
    """Topics and limits are public interface."""
    kind = shipped()[name]
    limits = (kind.limits.linear_mps, kind.limits.angular_rad_s)
    assert (limits, kind.command, kind.imu, kind.odometry, kind.rgb, kind.depth, kind.cloud,
            kind.scan, kind.battery) == CONTRACT[name]
    assert kind.odometry_type == ('turtlesim/Pose' if name == 'turtlesim' else 'nav_msgs/Odometry')


@pytest.mark.parametrize('model, limits', [
    ('burger', (0.22, 2.84)), ('waffle', (0.26, 1.82)), ('waffle_pi', (0.26, 1.82)),
    (None, (0.22, 1.82)), ('sandwich', (0.22, 1.82))])
def test_models_of_turtlebot3(model, limits):
    """Without a known model, no component is faster than any model allows."""
    params = {'robot_type': 'turtlebot3'}
    if model:
        params['robot_model'] = model
    kind, errors = resolve_robot_type(shipped(), 'bot1', params)
    assert (kind.limits.linear_mps, kind.limits.angular_rad_s) == limits
    assert [error.key for error in errors] == (['robot_model'] if model == 'sandwich' else [])
    assert kind.label == 'TurtleBot3' + (
        ' ' + model.replace('_', ' ').title() if model in kind.models else '')


def test_only_a_type_that_says_so_goes_sideways():
    """All its models do; a robot's own parameter comes first."""
    text = GOOD + 'models: {slow: {linear_mps: 0.1, angular_rad_s: 1.0}}\n'
    types, _ = load_robot_types([('a.yaml', text + 'holonomic: true\n')])
    types.update(shipped())
    assert {name for name, kind in types.items() if kind.limits.holonomic} == {
        'crawler', 'holonomic'}
    assert types['crawler'].with_model('slow').limits == Limits(0.1, 1.0, True)
    for name, said, found in (('crawler', False, False), ('turtlebot2', True, True),
                              ('turtlebot2', 'yes', False)):
        kind, errors = resolve_robot_type(types, 'bot1', {'robot_type': name, 'mhri': {
            'holonomic': said}})
        assert kind.limits.holonomic == found
        assert [error.key for error in errors] == (['mhri.holonomic'] if said == 'yes' else [])
    kind, _ = resolve_robot_type(types, 'bot1', {'robot_type': 'crawler', 'mhri': {
        'limits': {'linear_mps': 0.2}}})
    assert kind.limits.linear_mps == 0.2 and kind.limits.holonomic


def test_unknown_type_is_driven_as_generic_and_said():
    """The robot is usable, the slip is not hidden."""
    kind, errors = resolve_robot_type(shipped(), 'bot1', {'robot_type': 'turtlebot9'})
    assert kind.name == 'generic' and 'turtlebot9' in str(errors[0])
    assert resolve_robot_type(shipped(), 'bot1', {})[1] == []


def test_parameters_override_any_of_it():
    """Only what is named."""
    kind, errors = resolve_robot_type(shipped(), 'bot1', {'robot_type': 'turtlebot2', 'mhri': {
        'command': 'go', 'scan': [], 'label': 'Lab 2', 'limits': {'linear_mps': 0.1}}})
    assert errors == []
    assert (kind.command, kind.scan, kind.label) == (('go',), (), 'Lab 2')
    assert kind.limits == Limits(0.1, 3.14) and kind.odometry == ('odom',)


@pytest.mark.parametrize('window, taken', [
    ('antigravity.Window', False), ('os', False), ('', False), ('a_robot.window.Crawler', True),
    ('turtlebot', True)])
def test_a_robot_names_no_window_but_one_that_is_installed(window, taken):
    """Whoever shows a window runs its code."""
    types, _ = load_robot_types([], [
        Export('a_robot', '/a/crawler.yaml', GOOD, 'a_robot.window.Crawler')])
    types.update(shipped())
    kind, errors = resolve_robot_type(types, 'bot1', {'robot_type': 'turtlebot2', 'mhri': {
        'window': window, 'limits': {'linear_mps': 0.1}}})
    assert kind.window == (window if taken else 'turtlebot') and kind.limits.linear_mps == 0.1
    assert [error.key for error in errors] == ([] if taken else ['mhri.window'])


HARDWARE = {
    'power_by_topic': ('motor_power: {topic: motor_power}', MotorPowerSpec('motor_power'), None),
    'power_by_number': (
        'motor_power: {topic: base/power, type: kobuki_msgs/MotorPower, field: state, powered: 1, '
        'cut: 0}', MotorPowerSpec('base/power', False, 'kobuki_msgs/MotorPower', 'state', 1, 0),
        None),
    'power_by_service': ('motor_power: {service: motor_power}',
                         MotorPowerSpec('motor_power', True, 'std_srvs/SetBool', ''), None),
    'stop': ('hardware_stop: {topic: e_stop}', None, HardwareStopSpec('e_stop')),
    'stop_by_values': (
        'hardware_stop: {topic: e_stop, type: lab_msgs/State, field: base.mode, stopped: [2, 3]}',
        None, HardwareStopSpec('e_stop', 'lab_msgs/State', 'base.mode', (2, 3))),
    'none': ('motor_power: none', None, None),
}


@pytest.mark.parametrize('case', sorted(HARDWARE))
def test_hardware_of_a_type_and_by_parameter(case):
    """What takes the power from its motors, and what tells of its own emergency stop."""
    text, power, stop = HARDWARE[case]
    kind = parse_robot_type(GOOD + text, 'crawler.yaml')
    assert (kind.motor_power, kind.hardware_stop) == (power, stop)
    kind, errors = resolve_robot_type(shipped(), 'bot1', {'mhri': yaml.safe_load(text)})
    assert (kind.motor_power, kind.hardware_stop, errors) == (power, stop, [])


def test_hardware_of_the_shipped_types():
    """And of a robot without a namespace."""
    powers = {name: shipped()[name].motor_power for name in CONTRACT}
    assert powers == {
        'generic': None, 'turtlesim': None, 'turtlebot3': MotorPowerSpec('motor_power'),
        'turtlebot2': MotorPowerSpec('mobile_base/commands/motor_power', False,
                                     'kobuki_msgs/MotorPower', 'state', 1, 0)}
    assert shipped()['turtlebot3'].at_root().motor_power.name == '/motor_power'
    kind, errors = resolve_robot_type(shipped(), 'bot1', {
        'robot_type': 'turtlebot3', 'mhri': {'motor_power': 'none'}})
    assert (kind.motor_power, errors) == (None, [])


@pytest.mark.parametrize('said, silent_after_s', [(None, 1.0), (2.5, 2.5), (0, 0.0), (60, 60.0)])
def test_type_and_parameter_say_when_a_robot_is_silent(said, silent_after_s):
    """Odometry at 1 Hz, or in motion only."""
    text = GOOD if said is None else GOOD + 'silent_after_s: {}\n'.format(said)
    assert parse_robot_type(text, 'crawler.yaml').silent_after_s == silent_after_s
    params = {} if said is None else {'mhri': {'silent_after_s': said}}
    kind, errors = resolve_robot_type(shipped(), 'bot1', params)
    assert (kind.silent_after_s, errors) == (silent_after_s, [])


OVERRIDES = {
    'mhri': 'fast', 'mhri.limits.linear_mps': {'limits': {'linear_mps': -1}},
    'mhri.limits.linear': {'limits': {'linear': 1}}, 'mhri.colour': {'colour': 'red'},
    'mhri.command': {'command': 3}, 'mhri.limits': {'limits': 3},
    'mhri.silent_after_s': {'silent_after_s': 0.1}}
UNCHECKED = {
    'mhri.odometry_type': {'mhri': {'odometry_type': 'foo/Bar'}},
    'mhri.command': {'mhri': {'command': []}},
    'mhri.imu': {'mhri': {'imu': ['imu', 'no name!']}},
    'robot_type': {'robot_type': ['turtlebot2']},
    'robot_model': {'robot_model': {'a': 1}},
}


@pytest.mark.parametrize('key', sorted(OVERRIDES))
def test_override_that_cannot_be_used_is_reported_and_left_out(key):
    """The robot keeps its template."""
    params = {'robot_type': 'turtlebot2', 'mhri': OVERRIDES[key]}
    kind, errors = resolve_robot_type(shipped(), 'bot1', params)
    assert kind == shipped()['turtlebot2']
    assert [str(error).startswith('/bot1: {}:'.format(key)) for error in errors] == [True]


@pytest.mark.parametrize('key', sorted(UNCHECKED))
def test_parameter_that_cannot_be_used_is_reported(key):
    """Anybody may write a parameter; none of them may stop the panel."""
    kind, errors = resolve_robot_type(shipped(), 'bot1', UNCHECKED[key])
    assert [error.key for error in errors] == [key] and kind == shipped()['generic']


@pytest.mark.parametrize('said, found', [
    ('[0.0, .inf]', {None: (0.0, math.inf)}), ('[]', {None: ()}),
    ('{3.5: [0, .inf], "8": [inf]}', {3.5: (0.0, math.inf), 8.0: (math.inf,)}),
    ('0.0', None), ('[near]', None), ('[true]', None), ('[[0.0]]', None), ('{far: [0.0]}', None),
    ('{3.5: 0.0}', None), ('{.inf: [0.0]}', None), ('{-1: [0.0]}', None)])
def test_what_a_laser_sends_for_nothing(said, found):
    text = GOOD + 'no_return: ' + said
    if found is None:
        with pytest.raises(ConfigError, match='no_return: expected'):
            parse_robot_type(text, 'crawler.yaml')
        return
    assert parse_robot_type(text, 'crawler.yaml').no_return == found
    by_parameter, errors = resolve_robot_type(
        shipped(), 'bot1', {'mhri': {'no_return': yaml.safe_load(said)}})
    assert by_parameter.no_return == found and errors == []


def test_what_the_lasers_of_the_shipped_types_send_for_nothing():
    """NaN is not equal to itself."""
    types = shipped()
    assert repr(types['turtlebot2'].no_return) == '{None: (nan, inf)}'
    assert repr(types['turtlebot3'].no_return) == '{3.5: (0.0, inf), 100.0: (0.0, nan, inf)}'
    assert types['generic'].no_return == {}


def test_defaults_of_a_template():
    """A name, limits and one command are enough."""
    kind = parse_robot_type(GOOD, 'crawler.yaml')
    assert (kind.label, kind.window, kind.command) == ('crawler', 'turtlebot', ('cmd_vel',))
    assert kind.odometry == kind.imu == () and kind.models == {}


BAD = {
    'command': GOOD.replace('command: cmd_vel', ''),
    'limits': 'name: crawler\ncommand: cmd_vel\n',
    'limits.linear_mps': GOOD.replace('0.3', '0'),
    'limits.angular_rad_s': GOOD.replace('1.0', '.inf'),
    'odometry_type': GOOD + 'odometry_type: geometry_msgs/Pose\n',
    'wheels': GOOD + 'wheels: 4\n',
    'models.big.linear_mps': GOOD + 'models: {big: {angular_rad_s: 1}}\n',
    'name': GOOD.replace('crawler', '3'),
    'known_by': GOOD + 'known_by: {feet: 3}\n',
    'instance': GOOD + 'instance: left\n',
    'silent_after_s': GOOD + 'silent_after_s: -1\n',
    'motor_power': GOOD + 'motor_power: {topic: a, service: b}\n',
    'motor_power.type': GOOD + 'motor_power: {service: a, type: std_srvs/Trigger}\n',
    'motor_power.topic': GOOD + 'motor_power: {topic: "a b"}\n',
    'motor_power.cut': GOOD + 'motor_power: {topic: a, powered: 1, cut: 1}\n',
    'motor_power.powered': GOOD + 'motor_power: {topic: a, powered: [1]}\n',
    'motor_power.field': GOOD + 'motor_power: {topic: a, field: _buff}\n',
    'motor_power.off': GOOD + 'motor_power: {topic: a, "off": 0}\n',
    'hardware_stop.topic': GOOD + 'hardware_stop: {}\n',
    'hardware_stop': GOOD + 'hardware_stop: 3\n',
    'hardware_stop.stopped': GOOD + 'hardware_stop: {topic: a, stopped: []}\n',
    'hardware_stop.type': GOOD + 'hardware_stop: {topic: a, type: Bool}\n',
    'hardware_stop.colour': GOOD + 'hardware_stop: {topic: a, colour: red}\n',
}


@pytest.mark.parametrize('key', sorted(BAD))
def test_template_error_names_file_and_key(key):
    """A lab writes these."""
    with pytest.raises(ConfigError) as error:
        parse_robot_type(BAD[key], 'crawler.yaml')
    assert str(error.value).startswith('crawler.yaml: {}:'.format(key))


NO_NAMES = (
    '', '/', '//x', 'x/', 'a//b', 'no name!', '~cmd', '1st', '\u00e9', 'cmd_vel\n', 'a' * 5000,
    'x{y}', '..', '$(reboot)')


@pytest.mark.parametrize('name', NO_NAMES)
def test_a_topic_that_is_no_name_is_refused(name):
    """rospy would report it where it is used, and the robot never be reached."""
    kind, errors = resolve_robot_type(shipped(), 'bot1', {'mhri': {'command': [name]}})
    assert kind == shipped()['generic'] and [error.key for error in errors] == ['mhri.command']


@pytest.mark.parametrize('name', ['cmd_vel', '/cmd_vel', 'a/b_2/c', '/turtle1/cmd_vel', 'a/2d'])
def test_a_topic_that_ros_takes_is_taken(name):
    """Relative or not; a segment behind the first may begin with a digit."""
    kind, errors = resolve_robot_type(shipped(), 'bot1', {'mhri': {'command': [name]}})
    assert kind.command == (name,) and not errors


def test_one_bad_file_never_hides_the_good_ones():
    """And of two with one name the first stays."""
    types, errors = load_robot_types([
        ('bad.yaml', '['), ('a.yaml', GOOD), ('b.yaml', GOOD.replace('0.3', '0.9'))])
    assert types['crawler'].limits.linear_mps == 0.3
    assert [error.origin for error in errors] == ['bad.yaml', 'b.yaml']


def test_a_robot_without_a_namespace_has_absolute_topics():
    """Its template is the same, and so are its limits."""
    kind, errors = resolve_robot_type(shipped(), 'robot', {
        'robot_type': 'turtlebot3', 'robot_model': 'burger', 'mhri': {'scan': 'front/scan'}},
        Seen(at_root=True))
    assert errors == [] and kind.limits == Limits(0.22, 2.84)
    assert (kind.command, kind.imu, kind.odometry) == (('/cmd_vel',), ('/imu',), ('/odom',))
    assert kind.rgb == ('/camera/rgb/image_raw', '/raspicam_node/image')
    assert kind.scan == ('/front/scan',) and kind.depth == ()


def test_a_type_of_one_robot_in_a_node_has_no_instances():
    types = shipped()
    assert types['turtlesim'].for_instance('/turtle2').command == ('/turtle2/cmd_vel',)
    with pytest.raises(ValueError, match='generic has no instance'):
        types['generic'].for_instance('/turtle2')


SEEN = {
    'recognised': ({}, Seen(kind='turtlesim', command='turtle1/cmd_vel'),
                   'turtlesim', ('turtle1/cmd_vel',)),
    'its_parameter_counts': ({'robot_type': 'turtlebot3'}, Seen(kind='turtlesim', command='go'),
                             'turtlebot3', ('cmd_vel',)),
    'another_topic': ({}, Seen(command='go'), 'generic', ('go', 'cmd_vel')),
    'generic_by_its_parameter': ({'robot_type': 'generic'}, Seen(command='go'),
                                 'generic', ('go', 'cmd_vel')),
    'the_usual_topic': ({}, Seen(command='cmd_vel'), 'generic', ('cmd_vel',)),
    'overridden': ({'mhri': {'command': 'run'}}, Seen(command='go'), 'generic', ('run',)),
    'unknown_type': ({'robot_type': 'turtlebot9'}, Seen(command='go'),
                     'generic', ('go', 'cmd_vel')),
    'at_the_root': ({}, Seen(at_root=True, command='go'), 'generic', ('/go', '/cmd_vel')),
}


@pytest.mark.parametrize('case', sorted(SEEN))
def test_what_is_seen_of_a_robot_decides_where_its_parameters_do_not(case):
    """A robot without a type is driven by the topic it really has."""
    params, seen, name, command = SEEN[case]
    kind, errors = resolve_robot_type(shipped(), 'bot1', params, seen)
    assert (kind.name, kind.command) == (name, command)
    assert len(errors) == (case == 'unknown_type')


@pytest.mark.parametrize('parameters, seen, behind, is_behind, guard_behind, said', [
    ({}, Seen(behind=('cmd_vel',)), ('cmd_vel',), True, False, True),
    ({'robot_type': 'generic'}, Seen(behind=('cmd_vel',), guard_behind=('cmd_vel',)),
     ('cmd_vel',), True, True, True),
    ({}, Seen(command='joy', behind=('cmd_vel',)), ('cmd_vel',), False, False, False),
    ({'mhri': {'command': ['joy']}}, Seen(behind=('cmd_vel',), guard_behind=('cmd_vel',)),
     (), False, True, False),
    ({'mhri': {'command': ['cmd_vel']}}, Seen(behind=('cmd_vel',), guard_behind=('cmd_vel',)),
     (), False, False, False),
    ({'mhri': {'radius_m': 0.3}}, Seen(behind=('cmd_vel',)), ('cmd_vel',), True, False, True),
    ({'robot_type': 'turtlebot2'}, Seen(behind=('cmd_vel_mux/input/teleop',)),
     (), False, False, False)])
def test_a_generic_robot_is_not_driven_behind_its_own_multiplexer(
        parameters, seen, behind, is_behind, guard_behind, said):
    robot_type, errors = resolve_robot_type(shipped(), 'bot1', parameters, seen)
    assert (robot_type.behind, robot_type.is_behind, robot_type.guard_behind) == (
        behind, is_behind, guard_behind)
    assert ['mhri/command' in str(error) for error in errors] == [True] * said


def test_exported_types_join_the_shipped_ones():
    """The window that the package names counts, else that of the template."""
    types, errors = load_robot_types([('generic.yaml', GOOD.replace('crawler', 'generic'))], [
        Export('a_robot', '/a/crawler.yaml', GOOD, 'a_robot.window.Crawler'),
        Export('b_robot', '/b/b.yaml', GOOD.replace('crawler', 'b') + 'window: plain\n')])
    assert errors == [] and sorted(types) == ['b', 'crawler', 'generic']
    assert (types['crawler'].window, types['b'].window) == ('a_robot.window.Crawler', 'plain')


BAD_EXPORTS = {
    'wheels': GOOD + 'wheels: 4\n', 'name': GOOD.replace('crawler', 'generic'), 'limits': 'name: x',
    '': '['}


@pytest.mark.parametrize('key', sorted(BAD_EXPORTS))
def test_broken_export_is_left_out_and_named(key):
    """Package and file; the others stay, and nobody replaces what is there."""
    shipped_file = ('generic.yaml', GOOD.replace('crawler', 'generic'))
    types, errors = load_robot_types([shipped_file], [
        Export('bad_robot', '/bad/x.yaml', BAD_EXPORTS[key]), Export('good', '/good.yaml', GOOD)])
    assert sorted(types) == ['crawler', 'generic']
    assert types['generic'].limits.linear_mps == 0.3
    assert [str(error).startswith('package bad_robot: /bad/x.yaml: {}'.format(key))
            for error in errors] == [True]


TWO = GOOD + 'scan: [front, rear]\n'


def test_where_each_of_several_lasers_sits():
    placed = parse_robot_type(TWO + 'lasers: [[0.2, 0, 0], [-0.2, 0.1, 180]]\n', 'crawler.yaml')
    assert placed.laser_place(1) == (-0.2, 0.1, math.pi)
    nobody_says = parse_robot_type(TWO + 'laser_x_m: 0.3\n', 'crawler.yaml')
    assert nobody_says.laser_place(0) is nobody_says.laser_place(1) is None
    alone = parse_robot_type(GOOD + 'scan: scan\nlaser_x_m: 0.3\n', 'crawler.yaml')
    assert alone.laser_place(0) == (0.3, 0.0, 0.0)
    # Other topics in a robot's parameters are other lasers.
    types = dict(shipped(), crawler=placed)
    for over, place in (({'scan': ['rear', 'front']}, None),
                        ({'scan': ['a', 'b'], 'lasers': [[1, 0, 0], [0, 1, 90]]},
                         (0.0, 1.0, math.pi / 2.0)), ({}, (-0.2, 0.1, math.pi))):
        kind, errors = resolve_robot_type(types, 'bot1', {'robot_type': 'crawler', 'mhri': over})
        assert (kind.laser_place(1), errors) == (place, [])


@pytest.mark.parametrize('value', [
    '[[0.2, 0, 0]]', '[[0.2, 0], [0, 0]]', '7', '{front: [0, 0, 0]}', '[[a, 0, 0], [0, 0, 0]]',
    '[[.nan, 0, 0], [0, 0, 0]]', '[[11, 0, 0], [0, 0, 0]]', '[[0, 0, 361], [0, 0, 0]]',
    '[[0, 0, true], [0, 0, 0]]', "''"])
def test_places_of_lasers_that_cannot_be(value):
    with pytest.raises(ConfigError) as caught:
        parse_robot_type(TWO + 'lasers: {}\n'.format(value), 'crawler.yaml')
    assert caught.value.key == 'lasers'
