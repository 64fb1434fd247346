# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds a robot's sensors that have other names than in its type, by their message types."""
import re
from dataclasses import replace
from typing import Collection, Dict, FrozenSet, List, Mapping, Optional, Sequence, Set, Tuple

from mhri.base.names import topic_of
from mhri.base.robot_types import is_topic, PICTURE_KEYS, RobotType, SENSOR_TYPES
from mhri.base.text import listed

_COMPRESSED = 'sensor_msgs/CompressedImage'
_TRANSPORTS = ('/compressed', '/compressedDepth')
_DEPTH = re.compile(r'depth|disparity')
_INFRARED = re.compile(r'(^|[/_])(ir|infra\w*)\d*(/|_|$)')
# One camera's pictures (http://wiki.ros.org/image_proc), the most useful first.
_PICTURES = ('image_raw', 'image', 'image_color', 'image_rect_color', 'image_rect_raw',
             'image_rect', 'image_mono')


def own_topics(robot: str, published: Mapping[str, str],
               others: Optional[Collection[str]] = None) -> Dict[str, str]:
    """Return the published topics of a robot as {topic as in a type: ROS type}.

    :param published: {absolute topic: ROS type}
    :param others: first segments of other robots, for a robot without a namespace; else None
    """
    if others is not None:
        return {topic: kind for topic, kind in published.items()
                if topic.split('/')[1] not in others}
    start = '/{}/'.format(robot)
    return {topic[len(start):]: kind for topic, kind in published.items()
            if topic.startswith(start)}


def _of_type(key: str, message_type: str, published: Mapping[str, str]) -> Set[str]:
    """Return the topics with the messages of a sensor, pictures without transport."""
    found = {topic for topic, kind in published.items() if kind == message_type}
    if key in PICTURE_KEYS:
        found |= {topic[:-len(end)] for topic, kind in published.items() for end in _TRANSPORTS
                  if kind == _COMPRESSED and topic.endswith(end)}
    return set(filter(is_topic, found))


def likely_topics(key: str, message_type: str, published: Mapping[str, str]) -> List[str]:
    """Return the sorted topics that may be a sensor of a robot, pictures without transport.

    :param key: the sensor, as in a type
    :param published: of :func:`own_topics`
    """
    found = _of_type(key, message_type, published)
    if key in PICTURE_KEYS:
        found = {topic for topic in found if bool(_DEPTH.search(topic)) == (key == 'depth')}
        found = {topic for topic in found if not _INFRARED.search(topic)} or found
    return sorted(found)


def choice_words(robot: str, key: str, topics: Sequence[str]) -> Tuple[str, str]:
    """Return (what there is, the command that uses it) for a sensor with several candidates."""
    return 'no topic in its type is published, but {} {}'.format(
        listed(topics, 3), 'is' if len(topics) == 1 else 'are'), parameter_line(
            robot, key, topics[0])


def found_words(robot: str, key: str, kind: RobotType) -> Tuple[str, str]:
    """Return (what is used as a sensor, the command that sets it) for a found one."""
    *own, topic = getattr(kind, key)
    return '{} is used as {}, since nobody publishes {}'.format(
        topic_of(robot, topic), key, listed(own, 3)), parameter_line(robot, key, topic)


def parameter_line(robot: str, key: str, topic: str) -> str:
    """Return the command that sets the topic of a sensor."""
    return 'rosparam set /{}/mhri/{} "[{}]"'.format(robot, key, topic)


class FoundStreams:
    """The sensors of one robot, those that its type lists and those found.

    If no topic that its type lists for a sensor is published, but another one of its message type
    is, and only one, that is used; pictures in one namespace are those of one camera. It stays in
    use, since the robot may be moving, until a listed one appears. A listed one that vanishes is
    not replaced. An empty list means that the robot has none.

    :param sensors: those to look for; default: all
    """

    def __init__(self, sensors: Collection[str] = tuple(SENSOR_TYPES) + ('odometry',)) -> None:
        self._sensors = sensors
        self._kind: Optional[RobotType] = None
        self._named: FrozenSet[str] = frozenset()
        self._there: Set[str] = set()
        self._taken: Dict[str, str] = {}
        #: {sensor: its candidates, at least one, none of which is used}
        self.choices: Dict[str, List[str]] = {}

    @property
    def complete(self) -> bool:
        """Whether a listed topic of every sensor has been seen, so that nothing is to be found."""
        return self._kind is not None and self._there >= set(self._keys(self._kind))

    def _keys(self, kind: RobotType) -> List[str]:
        """Return the sensors that may have another name.

        Where a depth camera is all that the brake sees with, its mount is that of the type's own.
        """
        if kind.instance:
            return []
        return [key for key in self._sensors if getattr(kind, key)
                and not (key == 'depth' and not kind.scan)]

    def update(self, kind: RobotType, published: Optional[Mapping[str, str]],
               parameters: Mapping[str, object]) -> RobotType:
        """Return the type with the found topics appended to its lists.

        :param kind: the robot's type without them
        :param published: of :func:`own_topics`; None if unknown: nothing changes
        :param parameters: of the robot, nested; for a sensor with topics of its own there nothing
            else is used
        """
        overrides = parameters.get('mhri')
        named = frozenset(overrides if isinstance(overrides, dict) else ())
        if kind != self._kind or named != self._named:
            self._kind, self._named = kind, named
            self._there, self._taken, self.choices = set(), {}, {}
        for key in self._keys(kind) if published is not None else ():
            self._look(kind, key, published or {})
        changes = {key: getattr(kind, key) + (topic,) for key, topic in self._taken.items()}
        return replace(kind, found=tuple(sorted(self._taken)), **changes)

    def _look(self, kind: RobotType, key: str, published: Mapping[str, str]) -> None:
        message_type = kind.sensor_types[key]
        there = _of_type(key, message_type, published)
        # Of a listed one outside of the robot's namespace it is not known whether it is there.
        below = any(not topic.startswith('/') for topic in published)
        if any(topic in there or below and topic.startswith('/') for topic in getattr(kind, key)):
            self._there.add(key)
        self.choices.pop(key, None)
        if key in self._there:
            self._taken.pop(key, None)
        elif key not in self._taken:
            others = {topic for other in kind.sensor_types for topic in getattr(kind, other)}
            topics = [topic for topic in likely_topics(key, message_type, published)
                      if topic not in others]
            only = _only(key, topics) if key not in self._named else ''
            if only:
                self._taken[key] = only
            elif topics:
                self.choices[key] = topics


def _only(key: str, topics: List[str]) -> str:
    """Return the only one of some topics, or the best of the only camera; '' if there are more."""
    if len(topics) > 1 and key in PICTURE_KEYS and len(
            {topic.rpartition('/')[0] for topic in topics}) == 1:
        names = {topic.rpartition('/')[2]: topic for topic in topics}
        return next((names[name] for name in _PICTURES if name in names), '')
    return topics[0] if len(topics) == 1 else ''
