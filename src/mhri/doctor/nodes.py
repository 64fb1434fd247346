# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the nodes: responding, dead, sharing a name."""
from typing import Callable, Collection, Dict, Iterable, List, Set, Tuple, TypeVar

from mhri.base.text import listed
from mhri.doctor.facts import (
    ANSWERS, Facts, FAULT, Finding, FINE, Graph, is_ipv4, is_loopback, MASTER, Node, REFUSED,
    SILENT, STRANGER, SYSTEM, UNRESOLVED, WARNING)

CLEAN_UP = 'rosnode cleanup   # answer y: it removes dead nodes from the master'
_GHOST = 'a robot or node is listed that is not there; others try in vain to reach it'
# Every node of rospy and roscpp has these topics, so they do not identify a node.
COMMON = ('/rosout', '/rosout_agg', '/clock')
# Sortable key by which nodes are grouped.
_Key = TypeVar('_Key', str, Tuple[str, ...])


def robot_of(node: str) -> str:
    """Return the namespace of a node, '' if it has none."""
    namespace, _, rest = node.lstrip('/').partition('/')
    return namespace if rest else ''


def start_robot(facts: Facts, name: str) -> str:
    """Return the command that starts a real robot under a name."""
    computer, master = facts.computer, facts.master.host
    address = computer.good_ip() if computer.is_own(master) else master
    return 'on the robot: turtle_remote.sh {} {}'.format(address or '<IP of this computer>', name)


def _other_name(facts: Facts, name: str) -> str:
    """Return the remedy for two programs with the same name."""
    robot = robot_of(name)
    return 'give each robot a name of its own ({})'.format(start_robot(facts, robot + '_2')) \
        if robot else 'give one of them another name (__name:={}_2)'.format(name.lstrip('/'))


def find_on_nodes(facts: Facts, known: Collection[str] = ()) -> List[Finding]:
    """Return the findings about reachability, registrations and names of the nodes.

    :param known: names of hanging nodes that another finding reports
    """
    found = (_dead(facts) + _hosts(facts, known) + _wrong_address(facts) + _strangers(facts)
             + _loopback(facts) + _stale(facts) + _fought(facts) + _doubles(facts)
             + _forgotten(facts))
    if not found and facts.nodes and not known:
        answering = [node for node in facts.nodes.values() if node.state == ANSWERS]
        slowest = max(answering, key=lambda node: node.took_s, default=None)
        if slowest is not None:
            found.append(Finding(FINE, 'nodes', SYSTEM, 'all {} nodes answer, the slowest ({}) in '
                                 '{:.0f} ms'.format(len(answering), slowest.name,
                                                    slowest.took_s * 1e3)))
    return found


def _by(nodes: Iterable[Node], key: Callable[[Node], _Key]) -> List[Tuple[_Key, List[Node]]]:
    """Return [(key(node), [node])] sorted by key."""
    groups: Dict[_Key, List[Node]] = {}
    for node in nodes:
        groups.setdefault(key(node), []).append(node)
    return sorted(groups.items())


def _in_state(facts: Facts, *states: str) -> List[Node]:
    return [node for _, node in sorted(facts.nodes.items()) if node.state in states]


def _about(nodes: List[Node], host: str = '') -> str:
    """Return the subject of a finding about some nodes: their robot, else their computer."""
    robots = {robot_of(node.name) for node in nodes}
    if len(robots) == 1 and '' not in robots:
        return robots.pop()
    return nodes[0].name if len(nodes) == 1 else host or SYSTEM


def _names(nodes: List[Node]) -> str:
    return listed(node.name for node in nodes)


def _dead(facts: Facts) -> List[Finding]:
    """Report registered nodes that refuse connections: crashed or killed."""
    nodes = [node for node in _in_state(facts, REFUSED) if not true_address(facts, node)]
    return [Finding(
        FAULT, 'node_dead', _about(group, host), '{} registered at {}, but not running'.format(
            _names(group) + (' is' if len(group) == 1 else ' are'), host), _GHOST,
        '{}; then start {} again'.format(CLEAN_UP, _about(group, 'them')))
        for (host, _), group in _by(nodes, lambda node: (node.host, robot_of(node.name)))]


def _hosts(facts: Facts, known: Collection[str]) -> List[Finding]:
    """Report computers that do not respond, or whose name is unknown."""
    found = []
    silent = [node for node in _in_state(facts, SILENT)
              if node.name not in known and not true_address(facts, node)]
    for host, nodes in _by(silent, lambda node: node.host):
        hung = [node for node in facts.nodes.values()
                if node.host == host and node.state in (ANSWERS, REFUSED)]
        if hung:
            found.append(Finding(
                FAULT, 'node_silent', _about(nodes, host), '{} at {} no answer in time, though '
                'its computer answers'.format(_names(nodes), 'gives' if len(nodes) == 1 else
                                              'give'),
                'it hangs: its topics stand still, and nothing can connect to it',
                'rosnode kill {}   # then start it again; if that hangs too: {}'.format(
                    nodes[0].name, CLEAN_UP)))
            continue
        found.append(Finding(
            FAULT, 'host_silent', _about(nodes, host), '{} does not answer; {} {} there'.format(
                host, _names(nodes), 'is' if len(nodes) == 1 else 'are'),
            'the robot is listed, but silent: its picture and its odometry stand still',
            'ping -c 3 {}   # switched on? same network? firewall? If it is gone for good: '
            '{}'.format(host, CLEAN_UP), '; '.join(sorted({node.detail for node in nodes}))))
    for host, nodes in _by(_in_state(facts, UNRESOLVED), lambda node: node.host):
        about = _about(nodes, host)
        address = true_address(facts, nodes[0]) or '<its IP address>'
        found.append(Finding(
            FAULT, 'host_unresolved', about, 'the name "{}" is unknown here; {} {} known by '
            'it'.format(host, _names(nodes), 'is' if len(nodes) == 1 else 'are'),
            'its topics are listed, but no data arrives',
            'on {0}: export ROS_IP={1}, then start it again   # or here: echo "{1} {0}" | sudo '
            'tee -a /etc/hosts'.format(host, address)))
    return found


def _seen_at(facts: Facts, node: Node) -> Set[str]:
    """Return the addresses that a node connects from, as reported by its publishers."""
    return {link.address for other in facts.nodes.values() if facts.answering(other.name)
            for link in other.connections or ()
            if link.out and link.peer == node.name and link.address
            and not is_loopback(link.address)}


def _beside(facts: Facts, node: Node) -> Set[str]:
    """Return the addresses of other responding nodes with the same robot or computer name."""
    def machine(host: str) -> str:
        """Return the name of a computer without its domain, '' for an address."""
        return '' if is_ipv4(host) else host.partition('.')[0]

    robot, name = robot_of(node.name), machine(node.host)
    return {(facts.computer.addresses_of(other.host) or (other.host,))[0]
            for other in facts.nodes.values()
            if facts.answering(other.name) and facts.is_remote(other)
            and not is_loopback(other.host)
            and (robot and robot_of(other.name) == robot or name and machine(other.host) == name)}


def true_address(facts: Facts, node: Node) -> str:
    """Return the address that a silent node should advertise, '' if unknown.

    This is the address that it connects from, if different from the advertised one. Else, if
    nothing responds at the advertised address, it is that of the other nodes of its robot.
    """
    advertised = set(facts.computer.addresses_of(node.host)) | {node.host}
    seen = _seen_at(facts, node)
    if seen:
        return '' if seen & advertised else sorted(seen)[0]
    lost = node.state in (SILENT, UNRESOLVED) or node.state == REFUSED and is_loopback(node.host)
    beside = _beside(facts, node) if lost else set()
    return '' if beside & advertised else min(beside, default='')


def _wrong_address(facts: Facts) -> List[Finding]:
    """Report nodes that seem alive, but advertise a wrong address."""
    nodes = [node for node in _in_state(facts, SILENT, REFUSED)
             if true_address(facts, node)
             and not (is_loopback(node.host) and facts.several_computers())]
    found = []
    for (host, address, _), group in _by(nodes, lambda node: (
            node.host, true_address(facts, node), robot_of(node.name))):
        seen = any(_seen_at(facts, node) for node in group)
        own = facts.computer.is_own(address)
        found.append(Finding(
            FAULT, 'node_address', _about(group, host), '{} {} the address {}, where it '
            'does not answer; {} {}'.format(
                _names(group), 'advertises' if len(group) == 1 else 'advertise', host,
                'its connections come from' if seen else 'the rest of its robot answers at',
                address), 'its topics are listed, but no data arrives',
            '{}: export ROS_IP={}, then start {} again   # not "rosnode cleanup": it would remove '
            'living nodes from the master'.format(
                'here' if own else 'on ' + address, address, _names(group)),
            '' if seen else 'concluded; if it is on a computer of its own: ping -c 3 ' + host))
    return found


def _strangers(facts: Facts) -> List[Finding]:
    """Report nodes that ended, and whose port is now used by another program."""
    found = [Finding(
        FAULT, 'node_stranger', node.name, 'what answers at {} is not a ROS node: {}'.format(
            node.uri, node.detail), _GHOST, CLEAN_UP) for node in _in_state(facts, STRANGER)]
    for name, other in sorted(_taken(facts).items()):
        found.append(Finding(
            FAULT, 'node_stranger', name, 'at its address {} the node {} answers: {} has ended, '
            'and the other one has its port'.format(facts.nodes[name].uri, other, name), _GHOST,
            'start {0} again, or restart the master   # not "rosnode kill {0}": it would end '
            '{1}'.format(name, other)))
    return found


def _taken(facts: Facts) -> Dict[str, str]:
    """Return {dead node: the node that responds at its address}."""
    taken = {stream.node: stream.callerid for stream in facts.streams
             if stream.callerid and stream.callerid != stream.node}
    for _, nodes in _by(facts.nodes.values(), lambda node: node.uri):
        dead = [node for node in nodes if _knows_nothing(facts.graph, node)]
        alive = [node for node in nodes if node not in dead and node.state == ANSWERS]
        taken.update({node.name: alive[0].name for node in dead if alive})
    return taken


def _knows_nothing(graph: Graph, node: Node) -> bool:
    """Return whether the program at a node's address has none of that node's topics."""
    published, subscribed = graph.topics_of(node.name)
    topics = set(published + subscribed) - set(COMMON)
    return node.state == ANSWERS and bool(topics) and topics <= set(stale_topics(graph, node))


def _loopback(facts: Facts) -> List[Finding]:
    """Report nodes that advertise a loopback address in a system of several computers."""
    if not facts.several_computers():
        return []
    # Responding ones run here; if this computer's own address is loopback, another finding
    # already reports that cause.
    here = is_loopback(facts.computer.own_host()[0])
    nodes = [node for _, node in sorted(facts.nodes.items())
             if is_loopback(node.host) and not (here and node.state == ANSWERS)]
    return [Finding(
        FAULT, 'node_loopback', _about(group, host), '{} registered at {}, an address that means '
        'another computer on each computer'.format(
            _names(group) + (' is' if len(group) == 1 else ' are'), host),
        'no data between this node and other computers, in one direction or both',
        'on its computer: export ROS_IP={}, then start it again'.format(
            true_address(facts, group[0]) or '<its address on the robots\' network>'))
            for host, group in _by(nodes, lambda node: node.host)]


def _second(facts: Facts) -> Tuple[Graph, Dict[str, Node]]:
    """Return (graph, nodes) of the second query; without one, the first graph."""
    return facts.later or facts.graph, facts.later_nodes


def stale_topics(graph: Graph, node: Node) -> List[str]:
    """Return the topics that are registered for a node but missing from it, sorted."""
    published, subscribed = graph.topics_of(node.name)
    stale = set()
    if node.publications is not None:
        stale |= set(published) - set(node.publications)
    if node.subscriptions is not None:
        stale |= set(subscribed) - set(node.subscriptions)
    return sorted(stale - set(COMMON))


def _stale(facts: Facts) -> List[Finding]:
    """Report stale registrations of live nodes, without a publisher or subscriber."""
    graph, later = _second(facts)
    taken = _taken(facts)
    found = []
    for name in sorted(facts.nodes):
        node = facts.answering(name)
        if node is None or name in taken:
            continue
        again = later.get(name, node)
        if again.state != ANSWERS:
            continue
        stale = [topic for topic in stale_topics(facts.graph, node)
                 if topic in stale_topics(graph, again)]
        if stale:
            found.append(Finding(
                WARNING, 'registration_stale', name, 'the master lists it for {}, but the node '
                'itself does not know {}'.format(listed(stale), 'that topic' if len(stale) == 1
                                                 else 'those topics'),
                'a topic is listed that never has data',
                'start {} again   # or restart the master'.format(name)))
    return found


def _fought(facts: Facts) -> List[Finding]:
    """Report nodes whose registered URI changed during the examination."""
    return [Finding(
        WARNING, 'name_fought', name, 'it changed from {} to {} during the examination'.format(
            node.uri, node.uri_later),
        'robots come and go by themselves; programs end with "new node registered with same name"',
        '{}, or start one copy of {} only'.format(_other_name(facts, name), name),
        'two programs take the name from each other, or it was started again just now')
        for name, node in sorted(facts.nodes.items())
        if node.uri_later and node.uri and node.uri_later != node.uri]


def _double_links(node: Node) -> Set[Tuple[str, str]]:
    """Return the (topic, peer) pairs to which a publisher is connected more than once."""
    seen: Set[Tuple[str, str]] = set()
    double: Set[Tuple[str, str]] = set()
    for link in node.connections or ():
        if link.out:
            key = (link.topic, link.peer)
            (double if key in seen else seen).add(key)
    return double


def _own(facts: Facts, name: str) -> bool:
    """Return whether a name belongs to a doctor."""
    return name == facts.caller_id or name.startswith('/mhri_doctor')


def _doubles(facts: Facts) -> List[Finding]:
    """Report two subscribers of one name at one publisher: two programs share the name."""
    names: Dict[str, Set[str]] = {}
    for node in facts.nodes.values():
        again = facts.later_nodes.get(node.name)
        if again is None:
            continue
        for topic, peer in _double_links(node) & _double_links(again):
            if not _own(facts, peer):
                names.setdefault(peer, set()).add(topic)
    return [Finding(
        WARNING, 'name_twice', peer, 'two connections of that name take {}'.format(
            listed(sorted(topics))),
        'one of two robots obeys commands meant for the other, or its data jumps',
        '{}; rosnode info {}   # shows where the one is that the master knows: end the '
        'other'.format(_other_name(facts, peer), peer),
        'two programs share the name, or one was switched off without a shutdown')
        for peer, topics in sorted(names.items())]


def _forgotten(facts: Facts) -> List[Finding]:
    """Report nodes with connections that are not registered (any more)."""
    graph, later = _second(facts)
    if facts.later is None:
        return []
    known = set(facts.graph.nodes()) | set(graph.nodes())
    seen: Dict[str, Set[str]] = {}
    for node in facts.nodes.values():
        again = later.get(node.name)
        if again is None:
            continue
        peers = {link.peer for link in node.connections or () if link.out}
        for peer in peers & {link.peer for link in again.connections or () if link.out}:
            if peer.startswith('/') and peer not in known and not _own(facts, peer):
                seen.setdefault(peer, set()).add(node.name)
    return [Finding(
        WARNING, 'node_forgotten', peer, 'it is connected to {}, but the {} does not know '
        'it'.format(listed(sorted(names)), MASTER),
        'it keeps its existing connections, but no new node finds it',
        'start {} again   # the master was restarted, or another node took its name'.format(peer))
        for peer, names in sorted(seen.items())]


def odd_nodes(facts: Facts) -> Set[str]:
    """Return the names of the nodes to query again before reporting a fault."""
    known = set(facts.graph.nodes())
    odd = set()
    for name in facts.nodes:
        node = facts.answering(name)
        if node is None:
            continue
        peers = {link.peer for link in node.connections or () if link.out}
        if (stale_topics(facts.graph, node) or _double_links(node)
                or any(peer.startswith('/') and peer not in known and not _own(facts, peer)
                       for peer in peers)):
            odd.add(name)
    return odd
