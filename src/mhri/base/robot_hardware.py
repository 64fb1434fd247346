# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Data on how to cut a robot's motor power, and where it reports its own emergency stop."""
import re
from dataclasses import dataclass, replace
from typing import Any, List, Optional, Pattern, Tuple, TypeVar, Union

from mhri.base.config import Section

SET_BOOL = 'std_srvs/SetBool'
NONE = 'none'
TYPE = re.compile(r'[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*\Z')
# A field of a message by its dotted name; of an array, one element: data[0].
FIELD = re.compile(r'[A-Za-z][A-Za-z0-9_]*(\.[A-Za-z][A-Za-z0-9_]*)*(\[[0-9]{1,2}\])?\Z')
NAME = re.compile(r'/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*\Z')

Value = Union[bool, int, float, str]
Part = TypeVar('Part', bound='AtRoot')


@dataclass(frozen=True)
class AtRoot:
    """A part with one ``name``, relative to its robot's namespace."""

    name: str

    def at_root(self: Part) -> Part:
        """Return the part with an absolute name, for a robot without a namespace."""
        return replace(self, name='/' + self.name.lstrip('/'))


@dataclass(frozen=True)
class MotorPowerSpec(AtRoot):
    """Topic or service that cuts and restores the motor power of robots of a type.

    :param name: the topic or service, relative to the robot's namespace
    :param service: whether it is a service (``std_srvs/SetBool``, false cuts the power)
    :param kind: ROS type of the topic or service
    :param field: field of the topic's message that holds the value
    :param powered: value of the field for power on
    :param cut: value of the field for power off
    """

    service: bool = False
    kind: str = 'std_msgs/Bool'
    field: str = 'data'
    powered: Value = True
    cut: Value = False


@dataclass(frozen=True)
class HardwareStopSpec(AtRoot):
    """Topic on which a robot reports its own emergency stop.

    :param name: the topic, relative to the robot's namespace
    :param kind: its ROS type
    :param field: the field of its message with the state
    :param stopped: the values that mean stopped; any other means released
    """

    kind: str = 'std_msgs/Bool'
    field: str = 'data'
    stopped: Tuple[Value, ...] = (True,)


def read_motor_power(section: Section) -> Optional[MotorPowerSpec]:
    """Return the :class:`MotorPowerSpec` at ``motor_power``, None without one.

    :param section: :class:`mhri.base.config.Section` of a robot type
    :raises ConfigError: a key is wrong; the text names it
    """
    part = _part(section, 'motor_power')
    if part is None:
        return None
    if ('topic' in part) == ('service' in part):
        raise section.error('motor_power', 'name either a topic or a service')
    if 'service' in part:
        spec = MotorPowerSpec(matching(part, 'service', NAME), True,
                              matching(part, 'type', TYPE, SET_BOOL), '')
        if spec.kind != SET_BOOL:
            raise part.error('type', 'a service of motor power is {}, got {!r}'.format(
                SET_BOOL, spec.kind))
    else:
        spec = MotorPowerSpec(
            matching(part, 'topic', NAME), False, matching(part, 'type', TYPE, 'std_msgs/Bool'),
            matching(part, 'field', FIELD, 'data'), _value(part, 'powered', True),
            _value(part, 'cut', False))
        if spec.powered == spec.cut:
            raise part.error('cut', 'must differ from powered, got {!r}'.format(spec.cut))
    part.close()
    return spec


def read_hardware_stop(section: Section) -> Optional[HardwareStopSpec]:
    """Return the :class:`HardwareStopSpec` at ``hardware_stop``, None without one.

    :param section: :class:`mhri.base.config.Section` of a robot type
    :raises ConfigError: a key is wrong; the text names it
    """
    part = _part(section, 'hardware_stop')
    if part is None:
        return None
    given = part.take('stopped', [True])
    values: List[Any] = given if isinstance(given, list) else [given]
    if not values or not all(isinstance(value, (bool, int, float, str)) for value in values):
        raise part.error('stopped', 'expected the values that mean stopped, e.g. [true], got '
                         '{!r}'.format(values))
    spec = HardwareStopSpec(
        matching(part, 'topic', NAME), matching(part, 'type', TYPE, 'std_msgs/Bool'),
        matching(part, 'field', FIELD, 'data'), tuple(values))
    part.close()
    return spec


def _part(section: Section, key: str) -> Optional[Section]:
    """Return the sub-section of a key; None if it is missing or ``none``."""
    raw = section.take(key, NONE)
    return None if raw == NONE else section.sub_section(key, raw)


def matching(part: Section, key: str, pattern: Pattern[str],
             default: Optional[str] = None) -> str:
    """Read a text that matches a pattern; it is required unless there is a default."""
    text = part.text(key) if default is None else part.text(key, default)
    if not pattern.match(text):
        example = {'type': 'std_msgs/Bool', 'field': 'data'}.get(key, 'motor_power')
        raise part.error(key, 'expected something like {}, got {!r}'.format(example, text))
    return text


def _value(part: Section, key: str, default: Value) -> Value:
    """Read a boolean or a number."""
    value = part.take(key, default)
    if not isinstance(value, (bool, int, float)):
        raise part.error(key, 'expected true, false or a number, got {!r}'.format(value))
    return value
