# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags of other programs: robots recognized by the names and types of topics."""
import re
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple

from mhri.base.names import name_problem, topic_of
from mhri.base.numbers import natural_key
from mhri.base.robot_types import PICTURE_KEYS, RobotType
from mhri.base.text import listed
from mhri.recording.folder import NotASession

#: types that could move a robot; a replay never publishes them
VELOCITY_TYPES = frozenset((
    'geometry_msgs/Twist', 'geometry_msgs/TwistStamped', 'geometry_msgs/TwistWithCovariance',
    'geometry_msgs/TwistWithCovarianceStamped', 'mhri/TeamTwist'))
# Requests are not replayed, either; their results are.
_INPUTS = ('/mux_in/', '/panel_in/', '/panel/', '/mhri_session/', '/mhri_replay/', '/clock',
           '/rosout')
_REQUESTS = ('/goal', '/cancel')
_COMPRESSED = ('sensor_msgs/CompressedImage',)
_UNFIT = re.compile(r'[^A-Za-z0-9_]+')


def may_be_replayed(topic: str, kind: str) -> bool:
    """Return whether a replay publishes a topic; commands and requests are excluded."""
    return kind not in VELOCITY_TYPES and not topic.startswith(_INPUTS) \
        and not topic.endswith(_REQUESTS)


def name_of_file(stem: str) -> str:
    """Return a robot name made from a file name, e.g. ``run_3`` from "run 3"."""
    name = _UNFIT.sub('_', stem).strip('_')[:40]
    return name if name_problem(name) is None else 'robot_' + name if name else 'robot'


def robots_of_topics(topics: Mapping[str, str], types: Mapping[str, RobotType],
                     stem: str) -> Tuple[Dict[str, Dict[str, Any]], str]:
    """Return the robots of a bag in the form of ``session.yaml``, and the prefix of their topics.

    :param topics: {absolute topic: ROS type}
    :param types: {name: RobotType}
    :param stem: name of the file, to name a robot without a namespace
    :returns: ({name: {type, number, ...}}, prefix for each topic: '' or ``/<name>``)
    :raises NotASession: no topic belongs to a known robot type; the text gives an example
    """
    spaces = {topic.split('/')[1] for topic in topics if topic.count('/') > 1}
    robots = {}
    for name in sorted(spaces, key=natural_key):
        if name_problem(name) is None:
            kind = _kind(name, topics, types)
            if kind is not None and _speaks(name, topics, kind):
                robots[name] = kind
    if robots:
        return _numbered(robots), ''
    name = name_of_file(stem)
    below = {'/{}{}'.format(name, topic): kind for topic, kind in topics.items()}
    kind = _kind(name, below, types)
    if kind is not None:
        return _numbered({name: kind}), '/' + name
    raise NotASession('no topic in it is one of a robot type: it has {}; a robot needs e.g. '
                      '/bot1/odom (nav_msgs/Odometry)'.format(_listed(topics)))


def _numbered(robots: Mapping[str, RobotType]) -> Dict[str, Dict[str, Any]]:
    return {name: {'number': number, 'type': kind.name, 'parameters': {}}
            for number, (name, kind) in enumerate(robots.items(), 1)}


def _kind(name: str, topics: Mapping[str, str],
          types: Mapping[str, RobotType]) -> Optional[RobotType]:
    """Return the robot type that matches most topics, None if no topic matches."""
    scores: List[Tuple[int, bool, str]] = []
    for kind in types.values():
        known = sum(topics.get(topic_of(name, topic)) == of for topic, of in kind.known_by.items())
        scores.append((10 * known + _matches(name, topics, kind), kind.name == 'generic',
                       kind.name))
    best = max(scores, default=(0, False, ''))
    return types[best[2]] if best[0] else None


def _matches(name: str, topics: Mapping[str, str], kind: RobotType) -> int:
    """Return how many sensor kinds of a robot type are present."""
    return sum(_has(name, topics, getattr(kind, key), (of,) + _COMPRESSED * (key in PICTURE_KEYS))
               for key, of in kind.sensor_types.items())


def _has(name: str, topics: Mapping[str, str], candidates: Iterable[str],
         of: Tuple[str, ...]) -> bool:
    """Return whether a candidate topic is present, raw or with a picture transport."""
    names = [topic_of(name, topic) for topic in candidates]
    return any(kind in of and any(topic == one or topic.startswith(one + '/compressed')
                                  for one in names) for topic, kind in topics.items())


def _speaks(name: str, topics: Mapping[str, str], kind: RobotType) -> bool:
    """Return whether a namespace is a robot, not a part of one at the root, like /camera."""
    return _has(name, topics, kind.odometry, (kind.odometry_type,)) or _matches(
        name, topics, kind) > 1


def _listed(topics: Mapping[str, str]) -> str:
    """Return a description of some topics."""
    return listed(('{} ({})'.format(topic, kind) for topic, kind in sorted(topics.items())),
                  3) or 'none'
