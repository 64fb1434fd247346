# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot may say to the host over its link: names, numbers, frames, sizes, text.

Who has a robot's key, or reaches a link without keys, says whatever it likes. So on the host's
master a linked robot has topics and frames below its own name alone, of types that are known here,
and its limits only fall. Parameters that the lab sets on the host's own master are the lab's.
"""
from dataclasses import replace
import re
from typing import Collection, Dict, Mapping, Optional, Sequence, Tuple, Union

from mhri.base.robot_hardware import HardwareStopSpec, MotorPowerSpec, SET_BOOL
from mhri.base.robot_types import (
    Limits, ODOMETRY_TYPES, resolve_robot_type, RobotType, TOPIC_KEYS, WINDOW_KEY)
from mhri.base.text import tidy_text
from mhri.link.carried import (
    FRAME_NAMES, GUARD_COMMAND, GUARD_ECHO, SHARED_FRAMES, TF, TF_STATIC, TF_TYPE)
from mhri.link.renaming import packed_transforms, renamer, rewritten, transforms

PARAMETERS = ('robot_type', 'robot_model', 'mhri')
# In all, ever: each costs the host's master a registration.
MAX_TOPICS = 100
# Of one kind, such as its cameras; the gates take no more velocity topics either.
MAX_TOPICS_EACH = 8
MAX_LABEL = 40
# A message of pictures or points, and any other [bytes].
MAX_PICTURE_BYTES, MAX_STATE_BYTES = 1 << 25, 1 << 22
# A piece of a recording, all that are offered, and when one begins: before 2100 [bytes, ms].
MAX_PIECE_BYTES, MAX_OFFERED_BYTES, MAX_BEGUN_MS = 1 << 32, 10 ** 12, 4102444800000
# Its number and how long it is have to go into the name of its file.
MAX_PIECE_NUMBER, MAX_LASTS_MS = 10 ** 10 - 1, 10 ** 9 - 1
PICTURE_TYPES = ('sensor_msgs/Image', 'sensor_msgs/CompressedImage', 'sensor_msgs/PointCloud2')
_GUARD = {GUARD_ECHO: 'geometry_msgs/TwistStamped',
          'mhri_guard/dropped': 'geometry_msgs/TwistStamped', 'mhri_guard/state': 'std_msgs/String'}
# Their frames are known, or they have none.
_TYPES = frozenset(FRAME_NAMES) | frozenset(ODOMETRY_TYPES)
# Nothing of mhri's own comes from a robot but what its guard says.
_OWN = ('mhri_guard', 'mhri_link')
_TOPIC = re.compile(r'[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*\Z')
_MAX_NAME = 250
_WORD = re.compile(r'[A-Za-z0-9_-]{1,64}\Z')
# Of the overrides these are taken as they are, once they are valid.
_PLAIN = ('odometry_type', 'silent_after_s', 'radius_m', 'laser_x_m', 'lasers', 'no_return',
          'depth_x_m', 'depth_z_m')
_Spec = Union[MotorPowerSpec, HardwareStopSpec]


def is_offer(topic: object, kind: object) -> bool:
    """Tell whether a robot may publish a topic of a ROS type on the host.

    :param topic: relative to the robot's namespace, or ``/tf``, ``/tf_static``
    """
    if not isinstance(topic, str) or not isinstance(kind, str) or len(topic) > _MAX_NAME:
        return False
    if topic in (TF, TF_STATIC):
        return kind == TF_TYPE
    if topic.partition('/')[0] in _OWN:
        return _GUARD.get(topic) == kind
    return bool(_TOPIC.match(topic)) and kind in _TYPES


def fits(kind: str, data: bytes) -> bool:
    """Tell whether a message is not larger than one of its type can be."""
    return len(data) <= (MAX_PICTURE_BYTES if kind in PICTURE_TYPES else MAX_STATE_BYTES)


def offer_problem(rows: Sequence[object]) -> str:
    """Return what is wrong with the recordings that a robot offers, '' for nothing.

    :param rows: of each its number, begin [ms], length [ms], size [bytes] and checksum
    """
    limits = (('number', MAX_PIECE_NUMBER), ('begin [ms]', MAX_BEGUN_MS),
              ('length [ms]', MAX_LASTS_MS), ('size [bytes]', MAX_PIECE_BYTES),
              ('checksum', (1 << 32) - 1))
    size = 0
    for row in rows:
        if not (isinstance(row, list) and len(row) == len(limits)
                and all(type(part) is int and part >= 0 for part in row)):
            return 'it offers a recording that none can be'
        for part, (what, most) in zip(row, limits):
            if part > most:
                return 'it offers a recording whose {} is more than {}'.format(what, most)
        size += row[3]
    if size > MAX_OFFERED_BYTES:
        return 'it offers more than {} bytes of recordings'.format(MAX_OFFERED_BYTES)
    return ''


def recorded_name(robot: str, topic: str, kind: str, carried: Collection[str]) -> str:
    """Return the name on the host of a topic in a robot's recording, '' if it is not its own.

    :param topic: as the recording has it: absolute, with whatever namespace the robot has there
    :param carried: the topics of the robot, relative to its namespace
    """
    if topic in (TF, TF_STATIC):
        return topic if is_offer(topic, kind) else ''
    start = '/{}/'.format(robot)
    own = [name for name in carried if topic.endswith('/' + name)]
    name = max(own, key=len) if own else topic[len(start):] if topic.startswith(start) else ''
    # What the host itself commanded is in there, too.
    its = name == GUARD_COMMAND and kind == 'geometry_msgs/TwistStamped'
    return start + name if its or is_offer(name, kind) else ''


class OwnFrames:
    """Sees to it that a robot speaks of frames below its own name, and of shared ones as parents.

    :param shared: frames that are everybody's
    """

    def __init__(self, robot: str, shared: Tuple[str, ...] = SHARED_FRAMES) -> None:
        self._rename = renamer(robot, shared)
        self._own = robot.encode('ascii') + b'/'

    def of(self, topic: str, kind: str, data: bytes) -> bytes:
        """Return a message with the names that its frames have on the host.

        A transform of a shared frame is left out: it would move all robots.

        :raises ValueError: it is no message of that type
        """
        if topic in (TF, TF_STATIC):
            return packed_transforms([row for child, row in transforms(data, self._rename)
                                      if child.startswith(self._own)])
        return rewritten(data, int.from_bytes(data[:4], 'little'), FRAME_NAMES.get(kind, 0),
                         self._rename)


def own_topic(robot: str, topic: str) -> str:
    """Return the name below a robot's own that a topic has on the host, relative to that."""
    start = '/{}/'.format(robot)
    return topic[len(start):] if topic.startswith(start) else topic.lstrip('/')


def believed(robot: str, said: Mapping[str, object], types: Mapping[str, RobotType]
             ) -> Tuple[Dict[str, object], str]:
    """Return (parameters that a robot may have on the host, why some were left out or '').

    Topics are below its own name, also where its type's file has absolute ones; limits are those of
    its type and model, or lower; a window is one of an installed type.

    :param said: ``robot_type``, ``robot_model`` and ``mhri``, as the robot says them
    :param types: {name: RobotType} of the host
    """
    found: Dict[str, object] = {
        key: said[key] for key in PARAMETERS[:2]
        if isinstance(said.get(key), str) and _WORD.match(str(said[key]))}
    base, _ = resolve_robot_type(types, robot, found)
    overrides = said.get('mhri')
    kind, errors = resolve_robot_type(types, robot, dict(found, mhri=overrides))
    wrong = [error for error in errors if error.key.startswith('mhri') and error.key != WINDOW_KEY]
    if wrong or not isinstance(overrides, dict):
        kind, overrides = base, {}
    kept = {key: overrides[key] for key in _PLAIN if key in overrides}
    if isinstance(overrides.get('lasers'), list):
        kept['lasers'] = overrides['lasers'][:MAX_TOPICS_EACH]
    kept.update(_topics(robot, kind, base))
    kept.update(_hardware(robot, kind, base, types))
    low = Limits(min(kind.limits.linear_mps, base.limits.linear_mps),
                 min(kind.limits.angular_rad_s, base.limits.angular_rad_s))
    if low != base.limits:
        kept['limits'] = {'linear_mps': low.linear_mps, 'angular_rad_s': low.angular_rad_s}
    if 'label' in overrides:
        kept['label'] = tidy_text(kind.label, MAX_LABEL)
    if kind.window != base.window:
        kept['window'] = kind.window
    if kept:
        found['mhri'] = kept
    return found, str(wrong[0]) if wrong else _left_out(robot, replace(kind, limits=low), kind)


def _left_out(robot: str, taken: RobotType, said: RobotType) -> str:
    """Return what a robot has said and is not believed."""
    away = [topic for key in TOPIC_KEYS for topic in getattr(said, key)
            if topic.startswith('/') and not topic.startswith('/{}/'.format(robot))]
    words = ['{} is taken as one of its own'.format(topic) for topic in away[:3]]
    if taken.limits != said.limits:
        words.append('its limits do not rise over the link')
    return '; '.join(words)


def _topics(robot: str, kind: RobotType, base: RobotType) -> Dict[str, object]:
    found: Dict[str, object] = {}
    for key in TOPIC_KEYS:
        own = [own_topic(robot, topic) for topic in getattr(kind, key)[:MAX_TOPICS_EACH]]
        if own != list(getattr(base, key)):
            found[key] = own
    return found


def _hardware(robot: str, kind: RobotType, base: RobotType, types: Mapping[str, RobotType]
              ) -> Dict[str, object]:
    found: Dict[str, object] = {}
    for key in ('motor_power', 'hardware_stop'):
        spec, usual = getattr(kind, key), getattr(base, key)
        if spec is not None:
            spec = replace(spec, name=own_topic(robot, spec.name))
            known = {getattr(one, key).kind for one in types.values() if getattr(one, key)}
            if spec.kind not in known | {SET_BOOL} and not spec.kind.startswith('std_msgs/'):
                spec = usual and replace(usual, name=own_topic(robot, usual.name))
        if spec != usual:
            found[key] = _parameter(spec)
    return found


def _parameter(spec: Optional[_Spec]) -> object:
    """Return what a part of a robot type is called in its file."""
    if spec is None:
        return 'none'
    if isinstance(spec, HardwareStopSpec):
        return {'topic': spec.name, 'type': spec.kind, 'field': spec.field,
                'stopped': list(spec.stopped)}
    if spec.service:
        return {'service': spec.name, 'type': spec.kind}
    return {'topic': spec.name, 'type': spec.kind, 'field': spec.field, 'powered': spec.powered,
            'cut': spec.cut}
