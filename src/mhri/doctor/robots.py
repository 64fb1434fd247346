# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the robots: type, topics, sources of velocity, clocks."""
from dataclasses import dataclass, field
from difflib import get_close_matches
from statistics import median
from typing import Any, Dict, Iterable, List, Mapping, Set, Tuple

from mhri.base.config import ConfigError
from mhri.base.names import topic_of
from mhri.base.robot_types import resolve_robot_type, RobotType, SENSOR_TYPES
from mhri.base.text import listed
from mhri.doctor.accessories import find_on_accessories
from mhri.doctor.facts import ANSWERS, Facts, FAULT, Finding, FINE, Graph, LISTENED_S, WARNING
from mhri.doctor.nodes import start_robot
from mhri.doctor.sensors import find_on_cameras, find_on_lasers, find_same_frames
from mhri.doctor.system import muxes
from mhri.robots.discovery import (
    Candidate, find_candidates, IgnoreList, NAME_PARAMETER, parameters_of, ROOT_PARAMETERS)
from mhri.robots.found_streams import choice_words, found_words, FoundStreams, own_topics
from mhri.robots.stamp_age import delay_of

TWIST = 'geometry_msgs/Twist'
# Nodes that may publish a robot's velocity: mux, its own guard, a doctor testing its watchdog.
MUX, TRIAL, GUARD, LINK = '/mux', '/mhri_doctor', 'mhri_guard', 'mhri_link'
OFFSET_WARN_S, OFFSET_FAULT_S = 0.1, 0.5


@dataclass(frozen=True)
class Robot:
    """A candidate from the graph with its parameters and its template.

    ``choices`` are :attr:`FoundStreams.choices`.
    """

    candidate: Candidate
    template: RobotType
    parameters: Dict[str, Any] = field(default_factory=dict)
    errors: Tuple[ConfigError, ...] = ()
    choices: Mapping[str, List[str]] = field(default_factory=dict)

    def topics(self, *keys: str) -> List[str]:
        """Return the absolute names of the topics under some keys of its template, in order."""
        return [topic_of(self.candidate.name, topic)
                for key in keys for topic in getattr(self.template, key)]

    def parameter(self, key: str) -> str:
        """Return the absolute name of one of its parameters, ``key`` as in its messages."""
        path = key.partition('[')[0].replace('.', '/')
        if self.candidate.seen.at_root and path in ROOT_PARAMETERS:
            return '/' + path
        return '/{}/{}'.format(self.candidate.name, path)

    def list_topics(self) -> str:
        """Return the command that lists its topics, possibly among those of others."""
        return 'rostopic list' if self.candidate.seen.at_root else \
            'rostopic list | grep /{}/'.format(self.candidate.name)


def robots_of(graph: Graph, types: Mapping[str, RobotType], ignore: IgnoreList) -> List[Robot]:
    """Return the :class:`Robot` list of a graph, sorted by name.

    :param types: {name: :class:`mhri.base.robot_types.RobotType`} with at least ``generic``
    :param ignore: :class:`mhri.robots.discovery.IgnoreList`
    """
    robots = []
    candidates = find_candidates(graph.state(), graph.parameters, ignore,
                                 topic_types=graph.types.items(), types=types)
    published = {topic: graph.types.get(topic, '') for topic in graph.publishers}
    spaces = {one.name.partition('/')[0] for one in candidates if not one.seen.at_root}
    for candidate in candidates:
        name, at_root = candidate.name, candidate.seen.at_root
        parameters = parameters_of(name, graph.parameters, at_root)
        template, errors = resolve_robot_type(types, name, parameters, candidate.seen)
        found = FoundStreams()
        own = own_topics(name, published, spaces if at_root else None)
        template = found.update(template, own, parameters)
        robots.append(Robot(candidate, template, parameters, tuple(errors), found.choices))
    return robots


def find_on_robots(facts: Facts, types: Mapping[str, RobotType],
                   robots: List[Robot]) -> List[Finding]:
    """Return the findings about the robots, a list of :class:`Robot`."""
    found = _absent(facts, [robot.candidate for robot in robots])
    for robot in robots:
        candidate = robot.candidate
        if facts.requested and candidate.name not in facts.requested:
            continue
        if candidate.problem:
            found.append(Finding(
                FAULT, 'robot_name_bad', candidate.name, 'this is not a possible name for a robot: '
                + candidate.problem, 'the panel refuses to add it',
                'rosparam set /{} <its name>'.format(NAME_PARAMETER) if candidate.seen.at_root
                else start_robot(facts, 'bot1')))
        elif not candidate.nodes:
            found.append(Finding(
                WARNING, 'robot_leftover', candidate.name, 'only its parameters are left; '
                'none of its nodes is registered', 'the panel shows a robot that is not there',
                '; '.join('rosparam delete /' + key for key in _left_over(facts, candidate))))
        else:
            found += _robot(facts, types, robot)
    return found + find_same_frames(facts, {
        robot.candidate.name: robot.topics('odometry') for robot in robots})


def _left_over(facts: Facts, candidate: Candidate) -> List[str]:
    """Return the parameters of a robot; a namespace stands for all parameters below it."""
    own = [candidate.name] if isinstance(facts.graph.parameters.get(candidate.name), dict) else []
    if not candidate.seen.at_root:
        return own
    return [key for key in ROOT_PARAMETERS + (NAME_PARAMETER,)
            if key in facts.graph.parameters] + own


def _absent(facts: Facts, candidates: Iterable[Candidate]) -> List[Finding]:
    """Report robots that were requested or are listed in the panel, but not on the graph."""
    there = {candidate.name for candidate in candidates}
    mhri = facts.graph.parameters.get('mhri')
    listing = mhri.get('robots') if isinstance(mhri, dict) else None
    in_list = {str(name) for name in listing} if isinstance(listing, list) else set()
    found = []
    for name in sorted((set(facts.requested) or in_list) - there):
        near = get_close_matches(name, there, 1)
        found.append(Finding(
            FAULT, 'robot_absent', name, 'nothing of it is on the graph{}; there {}'.format(
                ' (is "{}" meant?)'.format(near[0]) if near else '',
                'are ' + listed(sorted(there), 12) if there else 'are no robots at all'),
            'its row in the panel says that it has not been heard yet',
            start_robot(facts, name)))
    return found


def _robot(facts: Facts, types: Mapping[str, RobotType], robot: Robot) -> List[Finding]:
    """Return the findings about one robot that has nodes."""
    name, nodes = robot.candidate.name, robot.candidate.nodes
    found = _type(robot, types)
    if not any(facts.answering(node) for node in nodes):
        return found
    found += (_velocity(facts, robot) + _topics(facts, robot) + _found(robot)
              + _odometry(facts, robot) + _clock(facts, robot)
              + find_on_lasers(facts, name, robot.topics('scan'))
              + find_on_cameras(facts, name, robot.topics('rgb', 'depth'))
              + find_on_accessories(facts, name, robot.template.accessories))
    if all(item.severity == FINE for item in found):
        found.append(Finding(FINE, 'robot', name, '{}, {} nodes, can be driven'.format(
            robot.template.label, len(nodes))))
    return found


def _type(robot: Robot, types: Mapping[str, RobotType]) -> List[Finding]:
    """Check ``robot_type`` and the other parameters."""
    name, found = robot.candidate.name, []
    key = robot.parameter('robot_type')
    if 'robot_type' not in robot.parameters:
        found.append(Finding(
            WARNING, 'robot_untyped', name, 'it has no robot_type, so it is driven as {}{}'.format(
                robot.template.name, ', which its topics suggest' if robot.candidate.seen.kind
                else ''), 'wrong speed limits; no IMU or camera where its topics have other names',
            'rosparam set {} <type>   # one of {}; better in its launch file'.format(
                key, ', '.join(sorted(types)))))
    for error in robot.errors:
        check = 'robot_type_unknown' if error.key == 'robot_type' else 'parameter_bad'
        near = get_close_matches(str(robot.parameters.get('robot_type')), types, 1)
        found.append(Finding(
            FAULT, check, name, str(error), 'wrong speed limits, topics or window',
            'rosparam set {} {}'.format(key, near[0] if near else 'generic')
            if check == 'robot_type_unknown' else 'rosparam get /{}; rosparam delete {}'.format(
                robot.parameter(error.key).split('/')[1], robot.parameter(error.key))))
    return found


def _velocity(facts: Facts, robot: Robot) -> List[Finding]:
    """Check the subscribers and publishers of the robot's velocity topics."""
    name, topics = robot.candidate.name, robot.topics('command')
    guard = '/' + GUARD if robot.candidate.seen.at_root else topic_of(name, GUARD)
    # Mux and guard subscribe there only to detect other publishers.
    drivers = [MUX, guard] + muxes(facts)
    # If the base only subscribes to its guard, the guard republishes to another topic.
    topics += [topic for topic in facts.graph.topics_of(guard)[0]
               if topic.startswith(guard + '/') and facts.graph.types.get(topic) == TWIST]
    alive = {topic: [node for node in facts.graph.subscribers.get(topic, ())
                     if facts.nodes[node].state == ANSWERS and node not in drivers]
             for topic in topics}
    chosen = next((topic for topic in topics if alive[topic]), None)
    # A robot with its own master is driven through its guard, over the link.
    if chosen is None and not _by_link(facts, name):
        return [Finding(
            FAULT, 'velocity_unheard', name, 'nothing subscribes to {}'.format(' or '.join(topics)),
            'the robot is selected, but does not move',
            '{}   # its real topic, then: rosparam set /{}/mhri/command "[<topic>]"; or start its '
            'base: {}'.format(robot.list_topics(), name, start_robot(facts, name)))]
    found = []
    hosts = {facts.nodes[node].host for nodes in alive.values() for node in nodes}
    for topic in topics + [guard + '/command']:
        others = [node for node in facts.graph.publishers.get(topic, ())
                  if node not in drivers and not node.startswith(TRIAL)]
        own = [] if topic.startswith(guard) else [
            node for node in others if _runs_on(facts, robot, node, hosts)]
        found += _beside(facts, name, topic, own)
        foreign = [node for node in others if node not in own]
        listeners = facts.graph.subscribers.get(topic, ())
        if foreign and (alive[topic] if topic in alive else listeners):
            found.append(_foreign(name, topic, foreign))
        elif foreign and guard in listeners and chosen:
            # The base only subscribes to the guard.
            found.append(_passed_on(name, topic, foreign))
    return found + (_hidden(facts, name, chosen, alive[chosen]) if chosen else [])


def _runs_on(facts: Facts, robot: Robot, node: str, hosts: Set[str]) -> bool:
    """Return whether a node is a robot's own.

    It runs on the robot's computer, and its name is below the robot's or in no namespace.

    :param hosts: hosts of the subscribers of its velocity
    """
    host = facts.nodes[node].host
    if hosts and host not in hosts:
        return False
    if node.startswith('/{}/'.format(robot.candidate.name)):
        return True
    of_none = robot.candidate.seen.at_root or node.count('/') == 1
    # On a shared computer only nodes that relay commands are known to be the robot's.
    return of_none and (not facts.computer.is_own(host) or robot.candidate.seen.at_root
                        and _passes_on(facts, node))


def _passes_on(facts: Facts, node: str) -> bool:
    """Return whether a node subscribes to velocities, like a smoother or a twist_mux."""
    return any(facts.graph.types.get(topic) == TWIST for topic in facts.graph.topics_of(node)[1])


def _beside(facts: Facts, name: str, topic: str, own: List[str]) -> List[Finding]:
    """List the robot's own programs that drive it besides mhri."""
    nodes = [node for node in own if not _passes_on(facts, node)]
    return [Finding(FINE, 'velocity_own', name, '{} of its own {} {}, too'.format(
        listed(nodes), 'publishes' if len(nodes) == 1 else 'publish', topic))] * bool(nodes)


def _by_link(facts: Facts, name: str) -> bool:
    return any(facts.answering(node) for node in facts.graph.subscribers.get(
        topic_of(name, GUARD) + '/command', ()) if node == topic_of(name, LINK))


def _foreign(name: str, topic: str, nodes: List[str]) -> Finding:
    """Report nodes that drive a robot bypassing the mux, or try to."""
    words = '{} {} {}, past the mux'.format(
        listed(nodes), 'publishes' if len(nodes) == 1 else 'publish', topic)
    if topic.endswith(GUARD + '/command'):
        return Finding(
            WARNING, 'velocity_foreign', name, words + '; its guard drops it',
            'nothing while the guard runs; another program tries to drive this robot',
            'rosnode kill {}   # unknown program? see "Security" in the guide'.format(
                ' '.join(nodes)))
    return Finding(
        WARNING, 'velocity_foreign', name, words,
        'the robot twitches, or goes on although the mux sends zero: stop all does not reach that '
        'program', 'rosnode kill {}   # or let it publish into a cmd_vel_mux'.format(
            ' '.join(nodes)))


def _passed_on(name: str, topic: str, nodes: List[str]) -> Finding:
    """Report nodes that drive a robot through its guard, besides mhri."""
    return Finding(
        WARNING, 'velocity_foreign', name, '{} {} {} from another computer, and its guard passes '
        'that on'.format(listed(nodes), 'publishes' if len(nodes) == 1 else 'publish', topic),
        'the robot goes on as soon as mhri does not drive it; it obeys stop all',
        'rosnode kill {}   # if it should not drive this robot'.format(' '.join(nodes)))


def _uri(text: str) -> str:
    return text.rstrip('/')


def _hidden(facts: Facts, name: str, topic: str, listeners: Iterable[str]) -> List[Finding]:
    """Report programs that publish velocity but are unknown to the master."""
    known = {_uri(facts.nodes[node].uri) for node in facts.graph.publishers.get(topic, ())}
    if facts.later is not None:
        known |= {_uri(facts.nodes[node].uri_later or facts.nodes[node].uri)
                  for node in facts.later.publishers.get(topic, ()) if node in facts.nodes}
    peers: Dict[str, Set[str]] = {}
    for listener in listeners:
        again = facts.later_nodes.get(listener)
        if again is None:
            continue
        for link in facts.nodes[listener].connections or ():
            if not link.out and link.topic == topic and _uri(link.peer) not in known \
                    and link in (again.connections or ()):
                peers.setdefault(_uri(link.peer), set()).add(listener)
    return [Finding(
        FAULT, 'velocity_hidden', name, 'a program at {} is connected to {}, and the master does '
        'not know it'.format(peer, topic),
        'another program may drive the robot; stop all does not reach it',
        'end that program   # on its computer: ss -tlnp | grep {}'.format(peer.rpartition(':')[2]))
        for peer in sorted(peers)]


def hidden_listeners(facts: Facts, topics: Iterable[str]) -> Set[str]:
    """Return the nodes that receive velocity from an unknown publisher, to query again."""
    odd = set()
    for topic in topics:
        known = {_uri(facts.nodes[node].uri) for node in facts.graph.publishers.get(topic, ())}
        for listener in facts.graph.subscribers.get(topic, ()):
            if any(not link.out and link.topic == topic and _uri(link.peer) not in known
                   for link in facts.nodes[listener].connections or ()):
                odd.add(listener)
    return odd


def _topics(facts: Facts, robot: Robot) -> List[Finding]:
    """Compare the types of the robot's topics with those of its template."""
    name, template, found = robot.candidate.name, robot.template, []
    kinds = [('command', TWIST), ('odometry', template.odometry_type), *SENSOR_TYPES.items()]
    for key, full, kind in [(key, topic, kind) for key, kind in kinds
                            for topic in robot.topics(key)]:
        # The master keeps the types of topics that are no longer used.
        used = facts.graph.publishers.get(full) or facts.graph.subscribers.get(full)
        real = facts.graph.types.get(full, '*') if used else '*'
        if real not in ('*', '', kind):
            found.append(Finding(
                FAULT, 'topic_type', name, '{} is {}, but template "{}" expects {}'.format(
                    full, real, template.name, kind),
                'the robot does not obey' if kind == TWIST else 'the panel shows none of it',
                'rosparam set {} <its type>   # or name the right topic: rosparam set '
                '/{}/mhri/{} "[<topic>]"'.format(robot.parameter('robot_type'), name, key)))
    return found


def _found(robot: Robot) -> List[Finding]:
    """Report the sensors that have other names than in the template."""
    name = robot.candidate.name
    found = []
    for key in robot.template.found:
        what, remedy = found_words(name, key, robot.template)
        found.append(Finding(FINE, 'sensor_found', name, what, remedy=remedy))
    for key, topics in robot.choices.items():
        what, remedy = choice_words(name, key, topics)
        found.append(Finding(
            WARNING, 'sensor_names', name, '{}: {}'.format(key, what),
            'the panel shows no speed, and no stop is confirmed' if key == 'odometry'
            else 'the panel shows none of them', remedy))
    return found


def _odometry(facts: Facts, robot: Robot) -> List[Finding]:
    """Check that odometry is published, by one node per topic."""
    name, topics = robot.candidate.name, robot.topics('odometry')
    publishers = {topic: facts.graph.publishers.get(topic, ()) for topic in topics}
    mute = 'the panel shows no speed, says "silent", and no stop is confirmed'
    if topics and not any(publishers.values()):
        return [] if 'odometry' in robot.choices else [Finding(
            WARNING, 'odometry_missing', name, 'nothing publishes {}'.format(' or '.join(topics)),
            mute, '{}   # its real topic, then: rosparam set /{}/mhri/odometry "[<topic>]"; on '
            'the robot: is its base switched on?'.format(robot.list_topics(), name))]
    found = []
    for topic, nodes in publishers.items():
        if len(nodes) > 1:
            found.append(Finding(
                WARNING, 'odometry_twice', name, '{} publish {}'.format(listed(nodes), topic),
                'its speed and heading jump; perhaps two robots have one name',
                'rosnode info {}   # give the second robot a name of its own, or: rosnode kill '
                '{}'.format(nodes[0], nodes[-1])))
        for stream in facts.streams:
            if stream.topic == topic and stream.listened_s > LISTENED_S and not stream.messages:
                found.append(Finding(
                    WARNING, 'odometry_silent', name, '{} is published by {}, but nothing came '
                    'in {:.1f} s'.format(topic, stream.node, stream.listened_s), mute,
                    'rostopic hz {}   # base switched on? cable to the base? then restart the '
                    'robot\'s launch file'.format(topic)))
    return found


def clock_offset(samples: Iterable[Tuple[float, float]]) -> Tuple[float, float]:
    """Return (offset [s], uncertainty [s]) of a sender's clock, positive if it is ahead.

    A message arrives after its stamp by its travel time, which is never negative: the fastest
    message gives the best estimate, and the scatter of the others is a measure of the delay.

    :param samples: pairs (received, stamp) [s], at least one
    """
    delays = sorted(received - stamp for received, stamp in samples)
    scatter = median(delays) - delays[0]
    # Few samples prove little: assume 0.1 s, a delay that messages rarely exceed on networks
    # used for driving robots.
    return -delays[0], max(0.005, scatter, 0.1 if len(delays) < 5 else 0.0)


def _clock(facts: Facts, robot: Robot) -> List[Finding]:
    """Check the offset of the robot's clock by the stamps of its odometry and IMU."""
    name, topics = robot.candidate.name, robot.topics('odometry', 'imu')
    samples = [sample for stream in facts.streams if stream.topic in topics
               for sample in stream.samples]
    if not samples or facts.graph.parameters.get('use_sim_time') is True:
        return []
    received_s, newest_s = max(samples)
    if delay_of(received_s, newest_s) is None:
        return [Finding(
            WARNING, 'clock_offset', name, 'its stamps are not real time (the newest: {:.1f} s '
            'after 1970): a simulator\'s, or its clock was never set'.format(newest_s),
            'transforms and recordings do not match those of the others',
            'rosparam set use_sim_time true   # if a simulator publishes /clock; on a robot: '
            'sudo apt install chrony; sudo chronyc makestep')]
    offset_s, error_s = clock_offset(samples)
    words = 'its clock is {:.3f} s {} the clock here'.format(
        abs(offset_s), 'ahead of' if offset_s > 0 else 'behind')
    confidence = 'within {:.0f} ms, from the stamps of {} messages; a delay before the stamp ' \
        'counts as offset'.format(error_s * 1e3, len(samples))
    if abs(offset_s) - error_s <= OFFSET_WARN_S:
        return [Finding(FINE, 'clock', name, words, confidence=confidence)]
    return [Finding(
        FAULT if abs(offset_s) - error_s > OFFSET_FAULT_S else WARNING, 'clock_offset', name, words,
        'pictures and transforms are refused as too old or from the future; recordings do not '
        'fit together', 'on {0}: sudo apt install chrony; sudo chronyc makestep   # or once: sudo '
        'date -s @$(ssh <this computer> date +%s.%N)'.format(name), confidence)]
