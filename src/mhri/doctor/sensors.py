# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the sensors: bandwidth of cameras, blind lasers, duplicate frames."""
from typing import Dict, Iterable, List, Set, Tuple

from mhri.base.text import listed
from mhri.doctor.facts import Facts, Finding, HOST, LISTENED_S, Stream, WARNING
from mhri.link.carried import SHARED_FRAMES

IMAGE = 'sensor_msgs/Image'


def find_on_cameras(facts: Facts, name: str, topics: Iterable[str]) -> List[Finding]:
    """Report pictures of a robot that are sent uncompressed over the network.

    :param topics: absolute names of its pictures, colour and depth
    """
    raw = []
    for topic in topics:
        nodes = [facts.answering(node) for node in facts.graph.publishers.get(topic, ())]
        packed = any(other.startswith(topic + '/compressed') for other in facts.graph.publishers)
        if facts.graph.types.get(topic) == IMAGE and not packed \
                and any(node is not None and facts.is_remote(node) for node in nodes):
            raw.append(topic)
    return [Finding(
        WARNING, 'camera_raw', name, '{} {} only raw, about 220 Mbit/s at 640x480 and 30 Hz: no '
        '/compressed beside it'.format(listed(raw), 'is' if len(raw) == 1 else 'are'),
        'over radio the picture stutters, and commands wait behind it',
        'on the robot: sudo apt install ros-noetic-compressed-image-transport '
        'ros-noetic-compressed-depth-image-transport   # then restart its camera')] * bool(raw)


def find_on_lasers(facts: Facts, name: str, topics: Iterable[str]) -> List[Finding]:
    """Check that the lasers of a robot publish, and measure anything.

    :param topics: absolute names of its scans
    """
    found = []
    for stream in facts.streams:
        if stream.topic not in topics:
            continue
        symptom = 'the obstacle brake does not see with it, and the view of the scan is empty'
        if stream.listened_s > LISTENED_S and not stream.messages:
            found.append(Finding(
                WARNING, 'scan_silent', name, '{} is published by {}, but nothing came in {:.1f} '
                's'.format(stream.topic, stream.node, stream.listened_s), symptom,
                'rostopic hz {}   # does it turn? cable? then restart its driver'.format(
                    stream.topic)))
        elif stream.beams and not any(stream.beams[1:3]):
            found.append(_blind(name, stream, symptom))
    return found


def _blind(name: str, stream: Stream, symptom: str) -> Finding:
    """Report that a laser measures nothing."""
    count, unsure = stream.beams[0], stream.beams[3]
    return Finding(
        WARNING, 'scan_blind', name, 'none of the {} beams of {} measures anything{}'.format(
            count, stream.topic, '' if unsure else ', nor says that nothing is there'), symptom,
        'rostopic echo -n1 {}/ranges   # stand before it: if nothing changes, restart its '
        'driver'.format(stream.topic),
        'unless nothing is within its reach: its driver says so by this value' if unsure else '')


def find_unheard(facts: Facts) -> List[Finding]:
    """Report the topics for which there was no time, so that their faults are unknown."""
    return [Finding(
        WARNING, 'time_short', HOST, 'there was no time to listen to {}'.format(
            listed(facts.unheard)), 'faults there are not reported',
        'rosrun mhri mhri_doctor   # again, once this computer has less to do'
    )] * bool(facts.unheard)


def find_same_frames(facts: Facts, odometry: Dict[str, List[str]]) -> List[Finding]:
    """Report robots with the same frame names.

    :param odometry: {robot: the absolute names of its odometry}
    """
    users: Dict[str, Set[str]] = {}
    for name, topics in odometry.items():
        for stream in facts.streams:
            for frame in stream.frames if stream.topic in topics else ():
                if frame and frame not in SHARED_FRAMES:
                    users.setdefault(frame, set()).add(name)
    groups: Dict[Tuple[str, ...], List[str]] = {}
    for frame, names in sorted(users.items()):
        if len(names) > 1:
            groups.setdefault(tuple(sorted(names)), []).append(frame)
    return [Finding(
        WARNING, 'frames_same', min(set(names) & set(facts.requested or names)),
        '{} all have {} {}'.format(
            listed(names), 'the frame' if len(frames) == 1 else 'the frames', listed(frames)),
        'on the map and in tf each is where the other one is, by turns',
        'in the launch file of each: <param name="tf_prefix" value="<its name>"/>, and the frames '
        'of its driver, such as odom_frame: <its name>/odom') for names, frames in groups.items()
        if not facts.requested or set(names) & set(facts.requested)]
