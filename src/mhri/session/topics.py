# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What of the graph belongs to a session."""
from typing import Any, Container, Dict, Iterable, Mapping, Tuple

from mhri.base.names import topic_of
from mhri.base.robot_types import RobotType
from mhri.recording.recording import GUARD_COMMAND
from mhri.robots.figures import FETCHING, FIGURES

# Whatever is published below this is an input of somebody.
INPUTS = '/mux_in/'
EVENTS, PANEL_EVENTS = '/mhri_session/events', '/panel/events'
PICTURES = '/panel/pictures'
DRILL = '/mhri_drill/state'
#: what the host says, whoever drives
HOST_TOPICS = (
    '/mux_in/mode_select', '/mux/mode', '/mux/waits_for', '/mux/pushed', '/mux/advice',
    '/mux/dead_man', '/mux/speed_limit', '/robot_controller/twist', '/robot_controller/task_twist',
    '/robot_controller/stop_all', '/robot_controller/robot_select', '/gates/state',
    '/mhri_tasks/list', '/mhri_tasks/places', '/mhri_tasks/run/feedback',
    '/mhri_tasks/run/result', '/mhri_voice/heard', DRILL, '/tf', '/tf_static', '/map',
    EVENTS)
_MOCAP = '/vrpn_client_node/{}/pose'
# What a robot's row says of its link and its guard, beside its own sensors.
_TOLD = ('mhri_guard/dropped', 'mhri_link/state', FIGURES, FETCHING)
# Kinds of a robot's sensors, as keys of a RobotType and of session.yaml.
_SENSORS = ('odometry', 'imu', 'scan', 'battery')
_CAMERAS = (('rgb', '/compressed'), ('depth', '/compressedDepth'))


def robot_topics(robot: str, kind: RobotType) -> Tuple[str, ...]:
    """Return the topics to record of a robot besides its cameras, absolute, none twice.

    As in :func:`mhri.recording.recording.topics_of`, every candidate is taken; who merely
    listens to commands changes nothing.
    """
    names = [name for key in _SENSORS for name in getattr(kind, key)]
    switch = (kind.hardware_stop.name,) if kind.hardware_stop else ()
    topics = [topic_of(robot, name) for name in (*names, *kind.command, GUARD_COMMAND, *_TOLD,
                                                 *switch)]
    return tuple(dict.fromkeys((*topics, _MOCAP.format(robot))))


def fault_topic(robot: str) -> str:
    """Return where a simulated robot says what it was asked to let fail, absolute."""
    return '/{}/base/faults'.format(robot)


def camera_topics(robot: str, kind: RobotType) -> Tuple[str, ...]:
    """Return the compressed pictures of a robot's cameras, absolute."""
    return tuple(topic_of(robot, name) + suffix
                 for key, suffix in _CAMERAS for name in getattr(kind, key))


def robot_entry(robot: str, number: int, kind: RobotType, parameters: Mapping[str, Any],
                published: Container[str]) -> Dict[str, Any]:
    """Return what ``session.yaml`` says of a robot.

    :param parameters: those of its namespace
    :param published: absolute names; of several candidates the first that is published counts, be
        it raw (a screen compresses it), of none the first
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
    return {'number': number, 'type': kind.name, 'model': kind.model,
            'parameters': _plain(parameters), 'topics': topics}


def _plain(value: Any) -> Any:
    """Return a parameter as YAML and JSON can say it: dates and bytes as text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value if value is None or isinstance(value, (bool, int, float, str)) else str(value)


def inputs_of(published: Iterable[str]) -> Tuple[str, ...]:
    """Return those of some topics that are inputs."""
    return tuple(sorted(topic for topic in published if topic.startswith(INPUTS)))
