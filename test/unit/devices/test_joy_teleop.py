# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is made of configurations of joy_teleop, and what is refused by file and key."""
import pytest

from mhri.base.accessories import (
    ACTION, AXIS, AXIS2, CANCEL, HOLD, MAX_ACCESSORIES, read_accessories, SERVICE, STOP, TAP)
from mhri.base.config import ConfigError, parse_yaml
from mhri.devices.joy_teleop import as_yaml, read_joy_teleop, UNKNOWN_TYPE
from mhri.devices.profile import parse_profile

# Commands as in joy_teleop_example.yaml of teleop_tools (noetic-devel), and others of its format.
COMMANDS = """
joy_node: {deadzone: 0.1}
teleop:
  walk:
    type: topic
    message_type: geometry_msgs/Twist
    topic_name: cmd_vel
    deadman_buttons: [4]
    axis_mappings: [{axis: 1, target: linear.x, scale: 0.5, offset: -0.03}]
  force_push:
    type: topic
    message_type: geometry_msgs/Wrench
    topic_name: base_link_wrench
    deadman_buttons: [5, 7]
    axis_mappings:
      - {axis: 3, target: force.x, scale: 40}
      - {axis: 2, target: force.y, scale: -20, offset: 5}
  lift: {type: topic, message_type: std_msgs/Float64, topic_name: /lift, axis_mappings: [
    {axis: 4, target: data}]}
  3Blow: {type: topic, message_type: std_msgs/Float64MultiArray, topic_name: fan, axis_mappings: [
    {button: 2, target: "data[1]", scale: -3.0, offset: 1}]}
  hello:
    type: topic
    message_type: std_msgs/String
    topic_name: chatter
    deadman_buttons: [1]
    message_value: [{target: data, value: 'Hello'}]
    allow_multiple_commands: False
  Torso-up: {type: action, action_name: /torso/increment, buttons: [4],
             action_goal: {increment_by: [0.05], limits: {speed: 2, soft: true}}}
  torso up: {type: action, action_name: torso/increment}
  add: {type: service, service_name: add, service_request: {a: 11, b: 31}, buttons: [10, 4]}
  all_at_once: {type: topic, message_type: sensor_msgs/JoyFeedback, topic_name: a, axis_mappings: [
    {axis: 0, target: x}, {axis: 1, target: y}, {axis: 2, target: z}]}
  mixed: {type: topic, message_type: geometry_msgs/Point, topic_name: a, axis_mappings: [
    {axis: 0, target: x}, {button: 1, target: y}]}
  names: {type: action, action_name: a, action_goal: {joints: [arm, hand]}}
"""


PROFILE = 'name: pad\nforward: {axis: 1, scale: -1.0}\nturn: {axis: 0, scale: -1.0}\n'


def bindings_of(text):
    """Return the keys that a profile with this text acts on."""
    return {one.key for one in parse_profile(PROFILE + text, 'pad.yaml').bindings}


def rows_of(text):
    """Return {key: Accessory} of what is printed for a file."""
    found, left_out = read_joy_teleop(text, 'pad.yaml')
    printed, _, pad = as_yaml(found, left_out, 'pad.yaml').partition('\n---\n')
    assert all(name in printed for name, _ in left_out)
    assert bindings_of(pad) == {one.key for one in found if one.binding()}
    rows = read_accessories(parse_yaml(printed, 'printed.yaml'))
    return {row.key: row for row in rows}, {one.key: one for one in found}, dict(left_out)


def test_every_command_is_an_accessory_or_is_said():
    rows, found, left_out = rows_of(COMMANDS)
    assert list(rows) == list(found) == [
        'force_push', 'lift', 'a_3blow', 'hello', 'torso_up', 'torso_up_2', 'add']
    assert list(left_out) == ['walk', 'all_at_once', 'mixed', 'names']
    assert 'cmd_vel' in left_out['walk'] and 'joints' in left_out['names']
    push, lift, blow, hello, torso, again, add = rows.values()
    assert (push.kind, push.name, push.type, push.fields, push.ranges, push.neutral) == (
        AXIS2, 'base_link_wrench', 'geometry_msgs/Wrench', ('force.x', 'force.y'),
        ((-40.0, 40.0), (-15.0, 25.0)), (0.0, 5.0))
    assert (lift.kind, lift.name, lift.ranges, lift.on_stop) == (AXIS, 'lift', ((-1.0, 1.0),), STOP)
    assert (blow.kind, blow.label, blow.fields, blow.ranges, blow.neutral) == (
        HOLD, '3Blow', ('data[1]',), ((-2.0, 1.0),), (1.0,))
    assert (hello.kind, hello.choices) == (TAP, (('', (('data', 'Hello'),)),))
    assert (torso.way, torso.name, torso.type, torso.on_stop, torso.label) == (
        ACTION, 'torso/increment', UNKNOWN_TYPE, CANCEL, 'Torso-up')
    assert torso.choices == (('', (
        ('increment_by', (0.05,)), ('limits.speed', 2), ('limits.soft', True))),)
    assert again.choices == (('', ()),)
    assert (add.way, add.on_stop, dict(add.choices[0][1])) == (
        SERVICE, STOP, {'a': 11, 'b': 31})
    # An axis of joy_node is + where that of the device is -.
    assert {key: one.binding() for key, one in found.items()} == {
        'force_push': {'axes': [3, 2], 'value': [-1.0, 1.0]}, 'lift': {'axis': 4, 'value': -1.0},
        'a_3blow': {'button': 2, 'value': -1.0}, 'hello': {'button': 1}, 'torso_up': {'button': 4},
        'torso_up_2': None, 'add': None}


def test_no_more_than_a_type_may_have():
    command = 'type: topic, message_type: std_msgs/Empty, topic_name: a, message_value: []'
    text = 'teleop:\n' + ''.join(
        '  c{}: {{{}}}\n'.format(number, command) for number in range(MAX_ACCESSORIES + 2))
    rows, _, left_out = rows_of(text)
    assert len(rows) == MAX_ACCESSORIES and len(left_out) == 2


TOPIC = 'type: topic, message_type: std_msgs/Float64, topic_name: lift'


@pytest.mark.parametrize('command, key', [
    ('', 'teleop'), ('teleop: [a]', 'teleop'), ('teleop: {a: {topic_name: b}}', 'teleop.a.type'),
    ('teleop: {a: {type: nose}}', 'teleop.a.type'),
    ('teleop: {a: {type: topic, interface_type: std_msgs/msg/Float64}}', 'teleop.a.interface_type'),
    ('teleop: {a: {type: topic, topic_name: b}}', 'teleop.a.message_type'),
    ('teleop: {a: {type: topic, message_type: Float64}}', 'teleop.a.message_type'),
    ('teleop: {a: {type: topic, message_type: std_msgs/Float64}}', 'teleop.a.topic_name'),
    ('teleop: {a: {%s}}' % TOPIC, 'teleop.a.axis_mappings'),
    ('teleop: {a: {%s, axis_mappings: {x: 1}}}' % TOPIC, 'teleop.a.axis_mappings'),
    ('teleop: {a: {%s, axis_mappings: [{axis: 1}]}}' % TOPIC, 'teleop.a.axis_mappings[0].target'),
    ('teleop: {a: {%s, axis_mappings: [{target: data}]}}' % TOPIC,
     'teleop.a.axis_mappings[0].button'),
    ('teleop: {a: {%s, axis_mappings: [{target: data, axis: -1}]}}' % TOPIC,
     'teleop.a.axis_mappings[0].axis'),
    ('teleop: {a: {%s, axis_mappings: [{target: data, axis: 1, scale: 0}]}}' % TOPIC,
     'teleop.a.axis_mappings[0].scale'),
    ('teleop: {a: {%s, deadman_buttons: 4, message_value: []}}' % TOPIC,
     'teleop.a.deadman_buttons'),
    ('teleop: {a: {%s, message_value: [{target: data}]}}' % TOPIC,
     'teleop.a.message_value[0].value'),
    ('teleop: {a: {type: action, action_name: "~a"}}', 'teleop.a.action_name'),
    ('teleop: {a: {type: service, service_name: a, service_request: {"b c": 1}}}',
     'teleop.a.service_request.b c')])
def test_a_wrong_file_is_refused_by_file_and_key(command, key):
    with pytest.raises(ConfigError) as refused:
        read_joy_teleop(command or '{}', 'pad.yaml')
    assert refused.value.key == key and 'pad.yaml' in str(refused.value)
