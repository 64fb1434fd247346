# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rows of accessories of a robot type: what they are read as, and what is refused by name."""
import pytest

from mhri.base.accessories import (
    ACTION, AXIS2, CANCEL, HOLD, KEEP, MAX_ACCESSORIES, POSITION, READOUT, SERVICE, STOP, TOGGLE)
from mhri.base.config import ConfigError
from mhri.base.robot_types import parse_robot_type, resolve_robot_type

HEAD = 'name: lab\nlimits: {linear_mps: 0.5, angular_rad_s: 1}\ncommand: [cmd_vel]\n'
# The rows of the guide, and of the issue.
ROWS = """
  lamp: {kind: toggle, topic: lamp, type: std_msgs/Bool, state: lamp_state, on_stop: keep}
  gripper: {kind: tap, action: gripper_cmd, type: control_msgs/GripperCommand,
            choices: {open: {command.position: 0.08}, close: {command.position: 0.0}},
            on_stop: cancel}
  flipper: {kind: hold, topic: flipper/velocity, type: std_msgs/Float64, range: [-2.0, 1.0],
            rate_hz: 20, neutral: 0.5, on_stop: stop}
  head: {kind: axis2, mode: position, topic: head/cmd, type: geometry_msgs/Vector3,
         state: head_state, range: [[-1.5, 1.5], [-0.5, 0.8]], on_stop: stop}
  gas: {kind: readout, topic: gas, type: std_msgs/Float32, unit: ppm, warn: 50}
  horn: {kind: tap, service: horn, type: std_srvs/Trigger, on_stop: keep, words: [horn, hoot]}
"""


def parsed(rows, head=HEAD):
    """Return {key: Accessory} of rows."""
    found = parse_robot_type(head + 'accessories:' + rows, 'lab.yaml').accessories
    return {one.key: one for one in found}


def test_rows_of_every_kind():
    found = parsed(ROWS)
    lamp, gripper, flipper, head, gas, horn = found.values()
    assert (lamp.kind, lamp.on_stop, lamp.state.name, lamp.state.fields) == (
        TOGGLE, KEEP, 'lamp_state', ('data',))
    assert dict(lamp.choices) == {'on': (('data', True),), 'off': (('data', False),)}
    assert (gripper.way, gripper.on_stop) == (ACTION, CANCEL)
    assert dict(gripper.choices)['open'] == (('command.position', 0.08),)
    assert (flipper.kind, flipper.on_stop, flipper.rate_hz) == (HOLD, STOP, 20.0)
    assert [flipper.scaled([share]) for share in (-1.0, -0.5, 0.0, 0.5, 1.0)] == [
        (-2.0,), (-0.75,), (0.5,), (0.75,), (1.0,)]
    assert (head.kind, head.mode, head.fields, head.state.fields) == (
        AXIS2, POSITION, ('x', 'y'), ('x', 'y'))
    assert head.scaled((-1.0, 1.0)) == (-1.5, 0.8)
    assert (gas.kind, gas.unit, gas.warns(50.0), gas.warns(50.1), gas.warns(float('nan'))) == (
        READOUT, 'ppm', False, True, False)
    assert not gas.moves and not lamp.moves and flipper.moves and gripper.moves
    assert (horn.way, horn.words, horn.choices) == (SERVICE, ('horn', 'hoot'), (('', ()),))


@pytest.mark.parametrize('row, key', [
    ('{topic: lamp, on_stop: keep}', 'kind'),
    ('{kind: wheel, topic: lamp, on_stop: keep}', 'kind'),
    ('{kind: toggle, on_stop: keep}', 'topic'),
    ('{kind: toggle, topic: lamp, service: lamp, on_stop: keep}', 'service'),
    ('{kind: toggle, topic: lamp}', 'on_stop'),
    ('{kind: toggle, topic: lamp, on_stop: cancel}', 'on_stop'),
    ('{kind: tap, action: grip, type: a/B, on_stop: stop}', 'on_stop'),
    ('{kind: hold, service: flip, on_stop: stop}', 'service'),
    ('{kind: toggle, topic: "~lamp", on_stop: keep}', 'topic'),
    ('{kind: toggle, topic: lamp, type: Bool, on_stop: keep}', 'type'),
    ('{kind: toggle, topic: lamp, on_stop: keep, choices: {on: {data: 1}}}', 'choices'),
    ('{kind: toggle, service: lamp, type: std_srvs/SetBool, on_stop: keep}', 'choices'),
    ('{kind: choice, topic: mode, on_stop: keep}', 'choices'),
    ('{kind: choice, topic: mode, on_stop: keep, choices: {slow: 1}}', 'choices'),
    ('{kind: choice, topic: mode, on_stop: keep, choices: {slow: {data: [a]}}}', 'choices'),
    ('{kind: choice, topic: mode, on_stop: keep, choices: {slow: {data: %s}}}' % ([1] * 33),
     'choices'),
    ('{kind: choice, topic: mode, on_stop: keep, choices: {"a b": {data: 1}}}', 'choices'),
    ('{kind: hold, topic: flip, on_stop: stop, range: [1, -1]}', 'range'),
    ('{kind: hold, topic: flip, on_stop: stop, range: [0, .inf]}', 'range'),
    ('{kind: hold, topic: flip, on_stop: stop, range: 1}', 'range'),
    ('{kind: hold, topic: flip, on_stop: stop, neutral: 2}', 'neutral'),
    ('{kind: hold, topic: flip, on_stop: stop, rate_hz: 0}', 'rate_hz'),
    ('{kind: hold, topic: flip, on_stop: stop, mode: force}', 'mode'),
    ('{kind: axis2, topic: head, on_stop: stop}', 'fields'),
    ('{kind: axis2, topic: head, on_stop: stop, fields: [x, "y z"]}', 'fields'),
    ('{kind: readout, topic: gas, field: "data[x]"}', 'field'),
    ('{kind: readout, topic: gas, bits: [%s]}' % ', '.join('abc' * 11), 'bits'),
    ('{kind: readout, topic: gas, of: driven}', 'of'),
    # Words of a voice: those of other commands, no words, too many, and what is held.
    *(('{kind: toggle, topic: lamp, on_stop: keep, words: [lamp, %s]}' % word, 'words')
      for word in ('stop', 'lamp stop', 'left lamp', 'robot', 'Lamp', 'lamp 1', '" lamp"', '""',
                   'a1, b, c, d', 'b, c, d, e', 'x' * 25)),
    ('{kind: hold, topic: flip, on_stop: keep, words: [flip]}', 'words'),
    ('{kind: readout, topic: gas, words: [gas]}', 'words'),
    ('{kind: toggle, topic: lamp, on_stop: keep, words: 1}', 'words'),
    ('{kind: toggle, topic: lamp, on_stop: keep, colour: red}', 'colour')])
def test_a_wrong_row_is_refused_by_file_and_key(row, key):
    with pytest.raises(ConfigError) as refused:
        parsed('\n  lamp: ' + row)
    assert refused.value.key == 'accessories.lamp.' + key
    assert 'lab.yaml' in str(refused.value)


@pytest.mark.parametrize('rows', [
    '\n  "a b": {kind: toggle, topic: lamp, on_stop: keep}', ' [lamp]', '\n  lamp: on',
    ''.join('\n  a{}: {{kind: toggle, topic: lamp, on_stop: keep}}'.format(number)
            for number in range(MAX_ACCESSORIES + 1))])
def test_wrong_rows_are_refused(rows):
    with pytest.raises(ConfigError):
        parsed(rows)


@pytest.mark.parametrize('row, values', [
    ('unit: ppm', {12.34567: '12.35 ppm', float('nan'): '– ppm', -0.5: '-0.5 ppm'}),
    ('field: "data[3]"', {2.0: '2'}),
    ('bits: [right, centre, left], warn: 0', {
        0.0: '–', 1.0: 'right', 6.0: 'centre, left', 8.0: '–', float('inf'): '–'})])
def test_a_readout_as_text(row, values):
    bumper = parsed('\n  bumper: {kind: readout, topic: core, %s}' % row)['bumper']
    assert {value: bumper.reading(value) for value in values} == values


@pytest.mark.parametrize('value, rests', [
    ((0.0, 0.0), True), ((0.05, -0.02), True), ((0.2, 0.0), False), ((0.0, 0.1), False),
    ((), False), ((0.0,), False), ((float('nan'), 0.0), False)])
def test_a_head_looks_ahead(value, rests):
    assert parsed(ROWS)['head'].is_at_rest(value) == rests


def test_an_array_is_set_at_once():
    found = parsed('\n  grip: {kind: tap, topic: grip, type: std_msgs/Float64MultiArray, '
                   'choices: {open: {data: [0.01, 2]}}, on_stop: stop, optional: true}')['grip']
    assert dict(found.choices)['open'] == (('data', (0.01, 2)),) and found.optional


def test_names_follow_the_robot():
    kind = parse_robot_type(HEAD + 'accessories:' + ROWS, 'lab.yaml')
    assert [name for one in kind.at_root().accessories for name in one.names][:2] == [
        '/lamp', '/lamp_state']
    rows = ROWS.replace('topic: ', 'topic: t/').replace('state: ', 'state: t/')
    rows = rows.replace('action: ', 'action: t/').replace('service: ', 'service: t/')
    head = HEAD.replace('cmd_vel', 't/cmd_vel') + 'instance: t\nknown_by: {t/pose: lab/Pose}\n'
    kind = parse_robot_type(head + 'accessories:' + rows, 'lab.yaml')
    assert kind.for_instance('/t2').accessories[0].names == ('/t2/lamp', '/t2/lamp_state')
    with pytest.raises(ConfigError):
        parsed(ROWS, head)


def test_a_robot_may_name_its_own():
    kind = parse_robot_type(HEAD, 'lab.yaml')
    own = {'robot_type': 'lab', 'mhri': {'accessories': {
        'lamp': {'kind': 'toggle', 'topic': 'lamp', 'on_stop': 'keep'}}}}
    found, errors = resolve_robot_type({'lab': kind, 'generic': kind}, 'bot1', own)
    assert not errors and [one.key for one in found.accessories] == ['lamp']
    own['mhri']['accessories']['lamp']['kind'] = 'bell'
    found, errors = resolve_robot_type({'lab': kind, 'generic': kind}, 'bot1', own)
    assert errors[0].key == 'mhri.accessories.lamp.kind' and found.accessories == ()
