# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topics and parameters that belong to a session."""
from typing import Any, Container, Dict, Iterable, List, Mapping, Tuple

from mhri.base.accessories import ACTION, READOUT, SERVICE, TOPIC
from mhri.base.names import topic_of
from mhri.base.robot_types import RobotType
from mhri.recording.recording import GUARD_COMMAND
from mhri.robots.figures import FETCHING, FIGURES

# Prefix of the input topics.
INPUTS = '/mux_in/'
EVENTS, PANEL_EVENTS = '/mhri_session/events', '/panel/events'
DRILL, DRIVE = '/mhri_drill/state', '/mux/state'
#: topics of the host, independent of the robots
HOST_TOPICS = (
    DRIVE, '/mux/mode', '/mux_in/mode_select', '/robot_controller/twist',
    '/robot_controller/stop_all', '/robot_controller/robot_select', '/mhri_tasks/list',
    '/mhri_tasks/places', '/mhri_tasks/run/feedback', '/mhri_tasks/run/result',
    '/mhri_voice/heard', DRILL, '/tf', '/tf_static', '/map', EVENTS)
_MOCAP = '/vrpn_client_node/{}/pose'
# A robot's link and guard topics, besides its sensors.
_TOLD = ('mhri_guard/dropped', 'mhri_link/state', FIGURES, FETCHING)
# Kinds of a robot's sensors, as keys of a RobotType and of session.yaml.
_SENSORS = ('odometry', 'imu', 'scan', 'battery')
# Topics of an accessory by the way in which it is used: those that command it, and what it says.
_COMMANDS = {TOPIC: ('',), ACTION: ('/goal', '/cancel'), SERVICE: ()}
_RESULTS = {TOPIC: (), ACTION: ('/result',), SERVICE: ()}
_CAMERAS = (('rgb', '/compressed'), ('depth', '/compressedDepth'))


def robot_topics(robot: str, kind: RobotType) -> Tuple[str, ...]:
    """Return the topics to record of a robot except its cameras, absolute, without duplicates.

    As in :func:`mhri.recording.recording.topics_of`, every candidate is included; merely
    subscribing to commands changes nothing.
    """
    names = [name for key in _SENSORS for name in getattr(kind, key)]
    switch = (kind.hardware_stop.name,) if kind.hardware_stop else ()
    topics = [topic_of(robot, name) for name in (*names, *kind.command, GUARD_COMMAND, *_TOLD,
                                                 *switch)]
    topics += [topic_of(robot, name) for name in _names_of_accessories(kind)]
    return tuple(dict.fromkeys((*topics, _MOCAP.format(robot))))


def _names_of_accessories(kind: RobotType) -> List[str]:
    """Return the topics of accessories and other sensors, below the robot."""
    found = [spec.name + end for spec in kind.accessories
             for end in _COMMANDS[spec.way] + _RESULTS[spec.way]]
    return found + [spec.state.name for spec in kind.accessories if spec.state is not None]


def accessory_commands(robot: str, kind: RobotType) -> Tuple[str, ...]:
    """Return the topics that command the accessories of a robot, absolute."""
    return tuple(topic_of(robot, spec.name) + end for spec in kind.accessories
                 if spec.kind != READOUT for end in _COMMANDS[spec.way])


def fault_topic(robot: str) -> str:
    """Return the topic of a simulated robot's faults, absolute."""
    return '/{}/base/faults'.format(robot)


def camera_topics(robot: str, kind: RobotType) -> Tuple[str, ...]:
    """Return the compressed pictures of a robot's cameras, absolute."""
    return tuple(topic_of(robot, name) + suffix
                 for key, suffix in _CAMERAS for name in getattr(kind, key))


def is_depth(topic: str) -> bool:
    """Return whether one of :func:`camera_topics` carries depth."""
    return topic.endswith(_CAMERAS[1][1])


def robot_entry(robot: str, number: int, kind: RobotType, parameters: Mapping[str, Any],
                published: Container[str]) -> Dict[str, Any]:
    """Return the entry of a robot in ``session.yaml``.

    :param parameters: parameters of its namespace
    :param published: absolute names; of several candidates the first published one is used, even
        if only raw (a screen compresses it); if none is published, the first candidate
    """
    topics: Dict[str, str] = {}
    suffixes = dict(_CAMERAS)
    for key in (*_SENSORS, 'rgb', 'depth', 'command'):
        suffix = suffixes.get(key, '')
        names = [topic_of(robot, name) for name in getattr(kind, key)]
        for name in names:
            if name + suffix in published or name in published:
                topics[key] = name + suffix
                break
        else:
            topics.update({key: name + suffix for name in names[:1]})
    # What was found on the graph is not found again in a replay.
    found = {key: list(getattr(kind, key)) for key in kind.found}
    if found:
        overrides = parameters.get('mhri')
        parameters = {**parameters, 'mhri': {
            **(overrides if isinstance(overrides, Mapping) else {}), **found}}
    return {'number': number, 'type': kind.name, 'model': kind.model,
            'silent_after_s': kind.silent_after_s, 'parameters': _plain(parameters),
            'topics': topics}


def _plain(value: Any) -> Any:
    """Return a parameter as values of YAML and JSON, with dates and bytes as text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value if value is None or isinstance(value, (bool, int, float, str)) else str(value)


def inputs_of(published: Iterable[str]) -> Tuple[str, ...]:
    """Return the input topics among these."""
    return tuple(sorted(topic for topic in published if topic.startswith(INPUTS)))
