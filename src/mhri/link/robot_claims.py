# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Validates a robot's claims over its link: names, numbers, frames, sizes, text.

An attacker with a robot's key, or with access to a link without keys, can send anything. So on the
host a linked robot only has topics and frames below its own name, of known types, and it can only
lower its limits. Parameters set on the host's own master are not affected.
"""
from dataclasses import replace
import re
from typing import Collection, Dict, Mapping, Optional, Sequence, Tuple, Union

from mhri.base.robot_hardware import HardwareStopSpec, MotorPowerSpec, SET_BOOL
from mhri.base.robot_types import (
    common_limits, ODOMETRY_TYPES, resolve_robot_type, RobotType, TOPIC_KEYS, WINDOW_KEY)
from mhri.base.text import tidy_text
from mhri.link.carried import (
    FRAME_NAMES, GUARD_COMMAND, GUARD_ECHO, SHARED_FRAMES, TF, TF_STATIC, TF_TYPE)
from mhri.link.renaming import packed_transforms, renamer, rewritten, transforms

PARAMETERS = ('robot_type', 'robot_model', 'mhri')
# Total number of topics: each costs a registration at the host's master.
MAX_TOPICS = 100
# Per kind, such as cameras; the same as the mux's limit of velocity topics.
MAX_TOPICS_EACH = 8
MAX_LABEL = 40
# Maximum sizes of picture and point messages, and of all others [bytes].
MAX_PICTURE_BYTES, MAX_STATE_BYTES = 1 << 25, 1 << 22
# Maxima of a piece of a recording, of a whole offer [bytes], and of its start: the year 2100 [ms].
MAX_PIECE_BYTES, MAX_OFFERED_BYTES, MAX_BEGUN_MS = 1 << 32, 10 ** 12, 4102444800000
# Limits of number and duration, which are part of the file name.
MAX_PIECE_NUMBER, MAX_LASTS_MS = 10 ** 10 - 1, 10 ** 9 - 1
PICTURE_TYPES = ('sensor_msgs/Image', 'sensor_msgs/CompressedImage', 'sensor_msgs/PointCloud2')
_GUARD = {GUARD_ECHO: 'geometry_msgs/TwistStamped',
          'mhri_guard/dropped': 'geometry_msgs/TwistStamped', 'mhri_guard/state': 'std_msgs/String'}
# Types with known frames, or without frames.
_TYPES = frozenset(FRAME_NAMES) | frozenset(ODOMETRY_TYPES)
# Of mhri's own topics only those of the guard may come from a robot.
_OWN = ('mhri_guard', 'mhri_link')
_TOPIC = re.compile(r'[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*\Z')
_MAX_NAME = 250
_WORD = re.compile(r'[A-Za-z0-9_-]{1,64}\Z')
# Overrides that are accepted unchanged if they are valid.
_PLAIN = ('odometry_type', 'silent_after_s', 'radius_m', 'laser_x_m', 'lasers', 'no_return',
          'depth_x_m', 'depth_z_m')
_Spec = Union[MotorPowerSpec, HardwareStopSpec]


def is_offer(topic: object, kind: object) -> bool:
    """Return whether a robot may publish a topic of a ROS type on the host.

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
    """Return whether the size of a message is plausible for its type."""
    return len(data) <= (MAX_PICTURE_BYTES if kind in PICTURE_TYPES else MAX_STATE_BYTES)


def offer_problem(rows: Sequence[object]) -> str:
    """Return the problem with the recordings that a robot offers, '' if valid.

    :param rows: number, start [ms], duration [ms], size [bytes] and checksum of each
    """
    limits = (('number', MAX_PIECE_NUMBER), ('begin [ms]', MAX_BEGUN_MS),
              ('length [ms]', MAX_LASTS_MS), ('size [bytes]', MAX_PIECE_BYTES),
              ('checksum', (1 << 32) - 1))
    size = 0
    for row in rows:
        if not (isinstance(row, list) and len(row) == len(limits)
                and all(type(part) is int and part >= 0 for part in row)):
            return 'it offers an invalid recording'
        for part, (what, most) in zip(row, limits):
            if part > most:
                return 'it offers a recording whose {} is more than {}'.format(what, most)
        size += row[3]
    if size > MAX_OFFERED_BYTES:
        return 'it offers more than {} bytes of recordings'.format(MAX_OFFERED_BYTES)
    return ''


def recorded_name(robot: str, topic: str, kind: str, carried: Collection[str]) -> str:
    """Return the host's name of a topic in a robot's recording, '' if it is not allowed.

    :param topic: absolute name as recorded, in the robot's namespace on its own master
    :param carried: the topics of the robot, relative to its namespace
    """
    if topic in (TF, TF_STATIC):
        return topic if is_offer(topic, kind) else ''
    start = '/{}/'.format(robot)
    own = [name for name in carried if topic.endswith('/' + name)]
    name = max(own, key=len) if own else topic[len(start):] if topic.startswith(start) else ''
    # The host's own commands are recorded, too.
    its = name == GUARD_COMMAND and kind == 'geometry_msgs/TwistStamped'
    return start + name if its or is_offer(name, kind) else ''


class OwnFrames:
    """Restricts a robot to frames below its own name, with shared frames only as parents.

    :param shared: frames shared by all robots
    """

    def __init__(self, robot: str, shared: Tuple[str, ...] = SHARED_FRAMES) -> None:
        self._rename = renamer(robot, shared)
        self._own = robot.encode('ascii') + b'/'

    def of(self, topic: str, kind: str, data: bytes) -> bytes:
        """Return a message with the host's names of its frames.

        Transforms of shared frames are dropped, since they would move all robots.

        :raises ValueError: it is malformed
        """
        if topic in (TF, TF_STATIC):
            return packed_transforms([row for child, row in transforms(data, self._rename)
                                      if child.startswith(self._own)])
        return rewritten(data, int.from_bytes(data[:4], 'little'), FRAME_NAMES.get(kind, 0),
                         self._rename)


def own_topic(robot: str, topic: str) -> str:
    """Return the name of a topic on the host, relative to the robot's namespace."""
    start = '/{}/'.format(robot)
    return topic[len(start):] if topic.startswith(start) else topic.lstrip('/')


def accepted_claims(robot: str, said: Mapping[str, object], types: Mapping[str, RobotType]
                    ) -> Tuple[Dict[str, object], str]:
    """Return (accepted parameters of a robot, the reason for dropped ones or '').

    Topics are below its own name, even if absolute in its type's file; limits are at most those of
    its type and model; windows are those of installed types.

    :param said: ``robot_type``, ``robot_model`` and ``mhri`` as claimed by the robot
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
    low = common_limits([kind.limits, base.limits])
    if low != base.limits:
        kept['limits'] = {'linear_mps': low.linear_mps, 'angular_rad_s': low.angular_rad_s}
        kept['holonomic'] = low.holonomic
    if 'label' in overrides:
        kept['label'] = tidy_text(kind.label, MAX_LABEL)
    if kind.window != base.window:
        kept['window'] = kind.window
    if kept:
        found['mhri'] = kept
    return found, str(wrong[0]) if wrong else _left_out(robot, replace(kind, limits=low), kind)


def _left_out(robot: str, taken: RobotType, said: RobotType) -> str:
    """Describe the claims of a robot that are not accepted."""
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
    """Return a part of a robot type as a parameter, as in the type's file."""
    if spec is None:
        return 'none'
    if isinstance(spec, HardwareStopSpec):
        return {'topic': spec.name, 'type': spec.kind, 'field': spec.field,
                'stopped': list(spec.stopped)}
    if spec.service:
        return {'service': spec.name, 'type': spec.kind}
    return {'topic': spec.name, 'type': spec.kind, 'field': spec.field, 'powered': spec.powered,
            'cut': spec.cut}
