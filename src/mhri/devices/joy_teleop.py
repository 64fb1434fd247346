# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories from a configuration of joy_teleop (ros-teleop/teleop_tools of ROS 1).

That node sends messages, goals and requests by the buttons and axes of a pad. Each becomes a row of
``accessories`` of a robot type, and one of a pad's profile (:mod:`mhri.devices.bindings`). The file
has no types of services and actions: joy_teleop asks the graph. What stops the motion it does not
have either: see :data:`HEAD_LINES`.
"""
import re
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import yaml

from mhri.base.accessories import (
    ACTION, AXIS, AXIS2, CANCEL, HOLD, MAX_ACCESSORIES, SERVICE, STOP, TAP, TOPIC)
from mhri.base.config import parse_yaml, Section, shown
from mhri.base.robot_hardware import FIELD, matching, NAME, TYPE

#: What stands for a type that the file does not have.
UNKNOWN_TYPE = 'PACKAGE/Type'
# Messages that drive a robot: that is not an accessory.
_DRIVING = ('geometry_msgs/Twist', 'geometry_msgs/TwistStamped')
_MAX = 1e6
_LONGEST_KEY = 24
HEAD_LINES = (
    '# From {origin}. Put this into the file of the robot type, or load it as the parameters',
    '# /<robot>/mhri of one robot. Check every row first:',
    '# - on_stop: stop and cancel are right for what moves; a lamp or a sound has keep.',
    '# - Axes: on release and on a stop neutral is sent. Where the value is a position, that would',
    '#   move it: add mode: position, and state, the topic where the robot reports it.')
PAD_LINES = (
    '---',
    '# The buttons, for the profile of the pad (doc/input_pad.md). A hat may have other numbers,',
    '# and a trigger needs rest: -1.0.')


class Imported(NamedTuple):
    """One command as an accessory.

    :param key: of its row
    :param row: its row, as it is written into the file of a robot type
    :param buttons: the buttons that had to be pressed together
    :param axes: pairs (axis or button, whether it was inverted) of its values; () for a tap
    :param note: what has to be filled in, '' for nothing
    """

    key: str
    row: Dict[str, Any]
    buttons: Tuple[int, ...]
    axes: Tuple[Tuple[int, bool], ...] = ()
    note: str = ''

    def binding(self) -> Optional[Dict[str, Any]]:
        """Return its row in a pad's profile, None if a profile cannot have it.

        joy_node turns all axes round, so that left and up are +; in a profile they are as they
        are. A button that had to be held for an axis is left out: a profile has one for all.
        """
        if not self.axes:
            return {'button': self.buttons[0]} if len(self.buttons) == 1 else None
        if self.row['kind'] == HOLD:
            (button, inverted), = self.axes
            return {'button': button, 'value': -1.0 if inverted else 1.0}
        numbers = [number for number, _ in self.axes]
        values = [1.0 if inverted else -1.0 for _, inverted in self.axes]
        return {'axis': numbers[0], 'value': values[0]} if len(numbers) == 1 else {
            'axes': numbers, 'value': values}


def read_joy_teleop(text: str, origin: str) -> Tuple[List[Imported], List[Tuple[str, str]]]:
    """Return (accessories, pairs (command, why it was left out)) of a file.

    :raises ConfigError: the file is not one of joy_teleop; the text names file and key
    """
    top = parse_yaml(text, origin)
    if 'teleop' not in top:
        raise top.error('teleop', 'is missing: is this a file of joy_teleop?')
    found: List[Imported] = []
    left_out: List[Tuple[str, str]] = []
    for name, section in top.named_sections('teleop').items():
        read = _WAYS.get(section.text('type'))
        if read is None:
            raise section.error('type', 'expected one of {}'.format(', '.join(_WAYS)))
        if 'interface_type' in section:
            raise section.error('interface_type', 'is of ROS 2; in ROS 1 it is message_type')
        try:
            if len(found) >= MAX_ACCESSORIES:
                raise _Unsuitable('more than {} accessories'.format(MAX_ACCESSORIES))
            found.append(_named(name, read(section), [one.key for one in found]))
        except _Unsuitable as why:
            left_out.append((name, str(why)))
    return found, left_out


def as_yaml(found: List[Imported], left_out: List[Tuple[str, str]], origin: str) -> str:
    """Return the text to put into the file of a robot type, and that for a pad's profile."""
    lines = [line.format(origin=origin) for line in HEAD_LINES] + [
        'accessories:' + ('' if found else ' {}')]
    for one in found:
        if one.note:
            lines.append('  # ' + one.note)
        lines.append('  {}: {}'.format(one.key, _shown(one.row)))
    lines += ['# left out: {}: {}'.format(name, why) for name, why in left_out]
    bound = [(one, one.binding()) for one in found]
    lines += PAD_LINES + ('accessories:' + ('' if any(row for _, row in bound) else ' {}'),)
    for one, row in bound:
        held = 'with {} held'.format(_listed(one.buttons)) if one.axes and one.buttons else ''
        if row is not None:
            lines.append('  {}: {}{}'.format(one.key, _shown(row), held and '   # ' + held))
        elif one.buttons:
            lines.append('  # {}: {} together'.format(one.key, _listed(one.buttons)))
    return '\n'.join(lines) + '\n'


def _listed(buttons: Tuple[int, ...]) -> str:
    return 'button{} {}'.format('s' if len(buttons) > 1 else '', ', '.join(map(str, buttons)))


def _shown(value: Any) -> str:
    """Return a value as YAML on one line."""
    if isinstance(value, dict):
        return '{{{}}}'.format(', '.join('{}: {}'.format(name or "''", _shown(inner))
                                         for name, inner in value.items()))
    text = yaml.safe_dump([value], default_flow_style=True, width=1e6).strip()
    return str(text[1:-1])


class _Unsuitable(ValueError):
    """A command that cannot be one accessory; the text is the reason."""


def _named(name: str, found: Imported, taken: List[str]) -> Imported:
    """Return it with a key made of its name, and with the name as its label."""
    key = re.sub('[^a-z0-9_]', '_', name.lower())[:_LONGEST_KEY - 3]
    key = key if key[:1].isalpha() else 'a_' + key
    number, first = 1, key
    while key in taken:
        number += 1
        key = '{}_{}'.format(first, number)
    label = {} if key.replace('_', ' ') == name.replace('_', ' ') else {'label': name}
    return found._replace(key=key, row=dict(found.row, **label))


def _of_topic(section: Section) -> Imported:
    """Read a command that publishes messages."""
    kind = matching(section, 'message_type', TYPE)
    name = matching(section, 'topic_name', NAME).lstrip('/')
    buttons = _indices(section, 'deadman_buttons')
    if kind in _DRIVING:
        raise _Unsuitable('it drives the robot; that is "command: [{}]" of the type'.format(name))
    if 'message_value' in section:
        fields = {matching(part, 'target', FIELD): _value(part, 'value', part.take('value'))
                  for part in section.sections('message_value')}
        return Imported('', {'kind': TAP, TOPIC: name, 'type': kind, 'choices': {'': fields},
                             'on_stop': STOP}, buttons)
    parts = [_Mapping.of(part) for part in section.sections('axis_mappings')]
    pressed = [part.button for part in parts]
    if len(parts) not in (1, 2) or any(pressed) and len(parts) > 1:
        raise _Unsuitable('{} values of axes and buttons in one message; one or two axes, or one '
                          'button, can be an accessory'.format(len(parts)))
    ranges = [part.range for part in parts]
    row = {'kind': HOLD if pressed[0] else (AXIS, AXIS2)[len(parts) - 1], TOPIC: name, 'type': kind,
           'fields': [part.target for part in parts],
           'range': ranges[0] if len(parts) == 1 else ranges,
           'neutral': [part.offset for part in parts], 'on_stop': STOP}
    return Imported('', row, buttons, tuple((part.number, part.scale < 0.0) for part in parts))


class _Mapping(NamedTuple):
    """A field that follows an axis or a button."""

    target: str
    number: int
    button: bool
    scale: float
    offset: float

    @classmethod
    def of(cls, part: Section) -> '_Mapping':
        """Read it."""
        button = 'axis' not in part
        found = cls(matching(part, 'target', FIELD), part.index('button' if button else 'axis'),
                    button, part.number('scale', -_MAX, _MAX, 1.0),
                    part.number('offset', -_MAX, _MAX, 0.0))
        if not found.scale:
            raise part.error('scale', 'is 0: it has no effect')
        return found

    @property
    def range(self) -> List[float]:
        """The lowest and the highest value; an axis goes both ways, a button one way."""
        ends = [self.offset + self.scale, self.offset if self.button else self.offset - self.scale]
        return sorted(ends)


def _of_action(section: Section) -> Imported:
    """Read a command that sends a goal."""
    name = matching(section, 'action_name', NAME).lstrip('/')
    return Imported('', {
        'kind': TAP, ACTION: name, 'type': UNKNOWN_TYPE,
        'choices': {'': _fields(section, 'action_goal')}, 'on_stop': CANCEL},
        _indices(section, 'buttons'),
        note='Its type: that of "rostopic type /<robot>/{}/goal" without ActionGoal.'.format(name))


def _of_service(section: Section) -> Imported:
    """Read a command that calls a service."""
    name = matching(section, 'service_name', NAME).lstrip('/')
    return Imported('', {
        'kind': TAP, SERVICE: name, 'type': UNKNOWN_TYPE,
        'choices': {'': _fields(section, 'service_request')}, 'on_stop': STOP},
        _indices(section, 'buttons'),
        note='Its type: "rosservice type /<robot>/{}".'.format(name))


_WAYS = {TOPIC: _of_topic, ACTION: _of_action, SERVICE: _of_service}


def _indices(section: Section, key: str) -> Tuple[int, ...]:
    """Read a list of buttons."""
    found: Any = section.take(key, [])
    if not isinstance(found, list) or not all(
            type(one) is int and 0 <= one < 100 for one in found):
        raise section.error(key, 'expected a list of buttons, such as [4, 6], got {}'.format(
            shown(found)))
    return tuple(found)


def _fields(section: Section, key: str) -> Dict[str, Any]:
    """Read a mapping of fields, with dotted names for inner ones."""
    part = section.section(key, None)
    if part is None:
        return {}
    return _flat(part, '')


def _flat(part: Section, before: str) -> Dict[str, Any]:
    found: Dict[str, Any] = {}
    for name in part.names():
        value = part.take(name, '')
        dotted = before + name
        if not FIELD.match(dotted):
            raise part.error(name, 'is not the name of a field')
        if isinstance(value, dict):
            found.update(_flat(part.sub_section(name, value), dotted + '.'))
        else:
            found[dotted] = _value(part, name, value)
    return found


def _value(part: Section, key: str, value: Any) -> Any:
    """Return a value that a field of an accessory can have."""
    if isinstance(value, (bool, int, float, str)) or isinstance(value, list) and all(
            type(one) in (int, float) for one in value):
        return value
    raise _Unsuitable('{} is {}; an accessory sets numbers, texts and lists of numbers'.format(
        part.key(key), shown(value)))
