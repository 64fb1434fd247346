# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks for missing connections and their cause, and of message definitions."""
from typing import Dict, Iterator, List, Mapping, Set, Tuple

from mhri.base.text import listed
from mhri.doctor.facts import Facts, FAULT, Finding, FINE, Graph, HOST, Node, SYSTEM, WARNING
from mhri.doctor.host import package_of
from mhri.doctor.nodes import robot_of

# Topic, name of its publisher, name of its subscriber.
_Link = Tuple[str, str, str]
# (Source, target) computer.
_Way = Tuple[str, str]

ANY = '*'
# Packages whose messages mhri itself reads; robots may have additional ones.
_READ = ('diagnostic_msgs', 'geometry_msgs', 'mhri', 'nav_msgs', 'sensor_msgs', 'std_msgs',
         'tf2_msgs', 'turtlesim')
_ONE_WAY = 'topics are listed, but no data arrives, or in one direction only'
_REBUILD = 'rosmsg md5 {0}   # on both computers; the same release of its package on both, then: ' \
    'cd <catkin workspace> && catkin_make, and start both programs again'


def find_on_links(facts: Facts) -> List[Finding]:
    """Return the findings about connections and message definitions."""
    return _connections(facts) + _definitions(facts)


def expected_links(nodes: Mapping[str, Node],
                   graph: Graph) -> Iterator[Tuple[str, Node, Node]]:
    """Yield (topic, publisher, subscriber) that should be connected.

    Master and both nodes list the topic, and both nodes respond.
    """
    for topic, publishers in sorted(graph.publishers.items()):
        for publisher in publishers:
            sender = nodes.get(publisher)
            if sender is None or sender.connections is None \
                    or topic not in (sender.publications or {}):
                continue
            for subscriber in graph.subscribers.get(topic, ()):
                listener = nodes.get(subscriber)
                if listener is not None and subscriber != publisher \
                        and topic in (listener.subscriptions or {}):
                    yield topic, sender, listener


def is_connected(topic: str, sender: Node, listener: Node) -> bool:
    """Return whether a publisher lists a subscriber among its connections."""
    return any(link.out and link.topic == topic and link.peer == listener.name
               for link in sender.connections or ())


def missing_links(facts: Facts, nodes: Mapping[str, Node], graph: Graph) -> Set[_Link]:
    """Return the (topic, publisher name, subscriber name) that should be connected but are not."""
    alive = {name: node for name, node in nodes.items() if facts.answering(name)}
    return {(topic, sender.name, listener.name)
            for topic, sender, listener in expected_links(alive, graph)
            if not is_connected(topic, sender, listener)}


def _present_hosts(facts: Facts) -> Set[Tuple[str, str, str, str]]:
    """Return the (host of publisher, host of subscriber, publisher, subscriber) with a link."""
    return {(sender.host, listener.host, sender.name, listener.name)
            for topic, sender, listener in expected_links(facts.nodes, facts.graph)
            if is_connected(topic, sender, listener)}


def _connections(facts: Facts) -> List[Finding]:
    """Report the cause of links that are missing in both queries."""
    missing = missing_links(facts, facts.nodes, facts.graph)
    if facts.later is None:
        missing = set()
    else:
        both = dict(facts.nodes, **facts.later_nodes)
        missing &= missing_links(facts, both, facts.later)
    present = _present_hosts(facts)
    hosts = {(source, target) for source, target, _, _ in present}
    ways: Dict[_Way, List[_Link]] = {}
    found = []
    for topic, publisher, subscriber in sorted(missing):
        sender, listener = facts.nodes[publisher], facts.nodes[subscriber]
        said = (sender.publications or {})[topic], (listener.subscriptions or {})[topic]
        if said[0] != said[1] and ANY not in said:
            found.append(_type_differs(topic, publisher, subscriber, said))
        elif sender.host == listener.host or (sender.host, listener.host) in hosts:
            found.append(_not_connected(topic, publisher, subscriber, said[0]))
        else:
            ways.setdefault((sender.host, listener.host), []).append(
                (topic, publisher, subscriber))
    found += [_no_way(facts, hosts, links) for hosts, links in sorted(ways.items())]
    return found + _back(facts, present, ways)


def _type_differs(topic: str, publisher: str, subscriber: str, said: Tuple[str, str]) -> Finding:
    return Finding(
        FAULT, 'type_differs', publisher, '{} publishes {} as {}, but {} expects {}'.format(
            publisher, topic, said[0], subscriber, said[1]),
        'the topic is listed, but {} gets nothing'.format(subscriber),
        'rostopic info {}   # remap one of the two to another name: rosrun ... {}:={}_other'.format(
            topic, topic, topic))


def _not_connected(topic: str, publisher: str, subscriber: str, kind: str) -> Finding:
    """Report differing definitions of a type: other links between the computers work."""
    return Finding(
        FAULT, 'definition_differs', publisher, '{} does not get {} from {}, though others are '
        'connected the same way: their definitions of {} differ'.format(
            subscriber, topic, publisher, kind),
        'the topic is listed, but {} gets nothing'.format(subscriber), _REBUILD.format(kind),
        'concluded: neither the network nor the name of the type is the reason')


def _no_way(facts: Facts, hosts: _Way, links: List[_Link]) -> Finding:
    """Report that one computer cannot reach another: the network, or a wrong name."""
    source, target = hosts
    own = facts.computer.is_own(source)
    topics = sorted({topic for topic, _, _ in links})
    robots = sorted({robot_of(subscriber) for _, _, subscriber in links} - {''})
    mend = 'unset ROS_HOSTNAME; export ROS_IP={}; then start again what runs here   # firewall? ' \
        'sudo ufw status'.format(facts.computer.good_ip() or '<address of this computer>') \
        if own else 'on {0}: export ROS_IP=<its address>, then start it again   # on {1}: ping ' \
        '-c 3 {0}; firewall?'.format(source, target)
    return Finding(
        FAULT, 'one_way', robots[0] if len(robots) == 1 else target,
        '{} does not reach {}: {} of {} {} not arrive there'.format(
            target, 'this computer back at ' + source if own else source, listed(topics),
            listed(sorted({publisher for _, publisher, _ in links})),
            'does' if len(topics) == 1 else 'do'),
        'the robot is heard, but does not obey' if own else _ONE_WAY, mend,
        'seen by its connections: the doctor cannot ask the robot to try')


def _back(facts: Facts, present: Set[Tuple[str, str, str, str]],
          ways: Dict[_Way, List[_Link]]) -> List[Finding]:
    """Report for each remote robot whether it reaches this computer, if known."""
    found = []
    robots: Dict[str, Set[str]] = {}
    for node in facts.nodes.values():
        if facts.answering(node.name) and facts.is_remote(node) and robot_of(node.name):
            robots.setdefault(robot_of(node.name), set()).add(node.name)
    for robot, names in sorted(robots.items()):
        count = sum(1 for source, _, _, listener in present
                    if listener in names and facts.computer.is_own(source))
        if count:
            found.append(Finding(FINE, 'reaches_back', robot, 'reaches this computer back '
                                 '({} connections)'.format(count)))
        elif not any(facts.computer.is_own(source) for source, _ in ways):
            found.append(Finding(
                FINE, 'reaches_back', robot, 'answers this computer; whether it reaches back '
                'cannot be told, since it listens to nothing here yet', confidence='unknown'))
    return found


def _definitions(facts: Facts) -> List[Finding]:
    """Compare the md5 sums of publishers with this computer, and with each other."""
    found = []
    kinds: Dict[Tuple[str, str], List[str]] = {}
    topics: Dict[str, Dict[str, Tuple[str, str]]] = {}
    for stream in facts.streams:
        if not stream.md5sum or stream.callerid != stream.node:
            continue
        topics.setdefault(stream.topic, {})[stream.node] = (stream.type, stream.md5sum)
        own = facts.known.get(stream.type)
        if own is not None and own != stream.md5sum:
            kinds.setdefault((stream.type, stream.node), []).append(stream.topic)
    for (kind, node), names in sorted(kinds.items()):
        found.append(Finding(
            FAULT, 'md5_differs', robot_of(node) or node, '{} sends {} with another definition '
            'of {} than {} has'.format(node, listed(sorted(names)), kind, HOST),
            'the topic is listed, but the panel shows none of it', _REBUILD.format(kind)))
    for topic, said in sorted(topics.items()):
        if len(set(said.values())) > 1:
            found.append(Finding(
                FAULT, 'publishers_differ', topic, 'its publishers disagree on what it is: '
                + listed('{} says {}'.format(node, kind) for node, (kind, _) in
                         sorted(said.items())), 'some data of the topic is missing',
                'rostopic info {}   # end the wrong one: rosnode kill <its name>'.format(topic)))
    unknown = sorted({stream.type for stream in facts.streams
                      if stream.type.split('/')[0] in _READ
                      and facts.known.get(stream.type, '') is None})
    if unknown:
        found.append(Finding(
            WARNING, 'message_unknown', HOST, 'no definition of {} here'.format(listed(unknown)),
            'those topics cannot be shown or echoed here',
            'sudo apt install {}   # or source the workspace that has them'.format(' '.join(sorted(
                {package_of(kind.split('/')[0], facts.computer) for kind in unknown})))))
    if not found and topics:
        found.append(Finding(FINE, 'definitions', SYSTEM, 'all {} topics use matching '
                             'message definitions'.format(len(topics))))
    return found
