# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor's facts and findings: plain values between examination and judgement."""
from dataclasses import dataclass, field, replace
from typing import Any, Collection, Dict, List, Optional, Tuple

FAULT, WARNING, FINE = 'fault', 'warning', 'fine'
SEVERITIES = (FAULT, WARNING, FINE)

# How an address responded. REFUSED: its computer responds, but the program is not running. SILENT:
# no response in time. UNRESOLVED: its name is unknown here. STRANGER: another program responds.
ANSWERS, REFUSED, SILENT, UNRESOLVED, STRANGER = (
    'answers', 'refused', 'silent', 'unresolved', 'stranger')
# Why a linked robot rejects the key of this computer, or this computer that of the robot. EARLY:
# not valid yet by the clock here. RUN_OUT: expired. UNTIMELY: either of these by the robot's
# clock. UNWELCOME: the keys were issued by different authorities.
EARLY, RUN_OUT, UNTIMELY, UNWELCOME = 'early', 'run out', 'untimely', 'unwelcome'

# A stream counts as silent after this long without a message [s].
LISTENED_S = 0.4

HOST = 'this computer'
MASTER = 'ROS master'
SYSTEM = 'system'


@dataclass(frozen=True)
class Finding:
    """The result of one check.

    ``check`` is its stable name for scripts; ``about`` the robot, node, computer or part concerned;
    ``problem`` the fault (or, for FINE, the good state); ``symptom`` what the operator
    sees of it; ``remedy`` the command that fixes it; ``confidence`` how certain it is, '' if quite.
    """

    severity: str
    check: str
    about: str
    problem: str
    symptom: str = ''
    remedy: str = ''
    confidence: str = ''


@dataclass(frozen=True)
class Folder:
    """A folder that mhri writes to.

    ``what`` is its purpose ('recordings', 'logs'), ``problem`` why mhri cannot write to it, '' if
    it can; ``device`` is the same for two folders on one disk.
    """

    what: str
    path: str
    free_bytes: int = 0
    problem: str = ''
    device: str = ''


@dataclass(frozen=True)
class Computer:
    """The computer the doctor runs on.

    ``variables`` are its environment variables that begin with ``ROS_``; ``resolved`` maps names to
    their IPv4 addresses, None if a name is unknown; ``route_ip`` is the local address from which
    packets to the master leave, None if there is no route or the master is on this computer;
    ``packages`` maps each dependency of mhri to the reason why it is unusable, '' if it is usable.
    """

    name: str = 'host'
    variables: Dict[str, str] = field(default_factory=dict)
    addresses: Tuple[str, ...] = ('127.0.0.1',)
    resolved: Dict[str, Optional[Tuple[str, ...]]] = field(default_factory=dict)
    route_ip: Optional[str] = None
    folders: Tuple[Folder, ...] = ()
    package_path: Optional[str] = None
    python_paths: Tuple[str, ...] = ()
    packages: Dict[str, str] = field(default_factory=dict)

    def addresses_of(self, host: str) -> Tuple[str, ...]:
        """Return the IPv4 addresses of a host name or address, () if it is unknown."""
        if is_ipv4(host):
            return (host,)
        return self.resolved.get(host) or ()

    def is_own(self, host: str) -> bool:
        """Return whether a host name or address refers to this computer."""
        return any(is_loopback(address) or address in self.addresses
                   for address in self.addresses_of(host))

    def good_ip(self) -> Optional[str]:
        """Return the address by which robots can reach this computer, None if only loopback."""
        outward = [address for address in self.addresses if not is_loopback(address)]
        return self.route_ip or (outward[0] if outward else None)

    def own_host(self) -> Tuple[str, str]:
        """Return (host that programs started here advertise, the variable that sets it or '')."""
        for key in ('ROS_HOSTNAME', 'ROS_IP'):
            if self.variables.get(key):
                return self.variables[key], key
        return self.name, ''


@dataclass(frozen=True)
class Master:
    """The master: its configured URI, its response, the error text, and the response time [s].

    ``elsewhere`` are the URIs of other masters: of responding ones if this one does not respond,
    of ones with a mux if this one has none.
    """

    uri: str = 'http://localhost:11311'
    host: str = 'localhost'
    port: int = 11311
    state: str = ANSWERS
    detail: str = ''
    took_s: float = 0.0
    elsewhere: Tuple[str, ...] = ()
    uri_problem: str = ''


@dataclass(frozen=True)
class Graph:
    """The state of the master: {topic: nodes}, {topic: type}, parameters as a nested dict."""

    publishers: Dict[str, Tuple[str, ...]] = field(default_factory=dict)
    subscribers: Dict[str, Tuple[str, ...]] = field(default_factory=dict)
    services: Dict[str, Tuple[str, ...]] = field(default_factory=dict)
    types: Dict[str, str] = field(default_factory=dict)
    parameters: Dict[str, Any] = field(default_factory=dict)

    def nodes(self) -> List[str]:
        """Return the names of all nodes, sorted."""
        return sorted({node for group in (self.publishers, self.subscribers, self.services)
                       for nodes in group.values() for node in nodes})

    def of(self, names: Collection[str]) -> 'Graph':
        """Return the part of the graph that concerns some nodes."""
        def part(group: Dict[str, Tuple[str, ...]]) -> Dict[str, Tuple[str, ...]]:
            return {topic: kept for topic, nodes in group.items()
                    for kept in [tuple(node for node in nodes if node in names)] if kept}

        return replace(self, publishers=part(self.publishers), subscribers=part(self.subscribers),
                       services=part(self.services))

    def state(self) -> List[List[Any]]:
        """Return the graph in the form of ``getSystemState``."""
        return [[[name, list(nodes)] for name, nodes in group.items()]
                for group in (self.publishers, self.subscribers, self.services)]

    def topics_of(self, node: str) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
        """Return (topics it publishes, topics it subscribes), as registered."""
        return (tuple(sorted(name for name, nodes in self.publishers.items() if node in nodes)),
                tuple(sorted(name for name, nodes in self.subscribers.items() if node in nodes)))


@dataclass(frozen=True)
class Connection:
    """A connection as a node reports it: ``out`` or not, its topic, and the other end.

    ``peer`` is the other node's name if outgoing, its URI if incoming; ``address`` the real IPv4
    address of the other end, '' if not reported.
    """

    out: bool
    topic: str
    peer: str
    address: str = ''


@dataclass(frozen=True)
class Node:
    """A registered node and its response.

    ``publications`` and ``subscriptions`` are {topic: type} as reported by the node,
    ``connections`` its :class:`Connection` list; each is None if not reported. ``uri_later`` is its
    registered URI at the end of the examination.
    """

    name: str
    uri: str = ''
    host: str = ''
    state: str = ANSWERS
    detail: str = ''
    took_s: float = 0.0
    publications: Optional[Dict[str, str]] = None
    subscriptions: Optional[Dict[str, str]] = None
    connections: Optional[Tuple[Connection, ...]] = None
    uri_later: str = ''


@dataclass(frozen=True)
class Stream:
    """A publisher's response to a subscription, and the received stamps.

    ``problem`` is the reason for a failed connection; ``listened_s`` how long the doctor waited
    for messages [s], 0 if it did not; ``samples`` are (received, stamp) pairs by the clock here and
    the sender's [s]; ``refused`` what the mux rejected, as published: '/node: robot_select, 3
    times'. ``frames`` are the frames of odometry; ``beams`` of a scan are (all, with a measurement,
    with free space, ambiguous: free space or a dead laser).
    """

    topic: str
    node: str
    type: str = ''
    md5sum: str = ''
    callerid: str = ''
    problem: str = ''
    listened_s: float = 0.0
    messages: int = 0
    samples: Tuple[Tuple[float, float], ...] = ()
    refused: Tuple[str, ...] = ()
    frames: Tuple[str, ...] = ()
    beams: Tuple[int, ...] = ()


@dataclass(frozen=True)
class LinkNote:
    """The status of this computer's side of the link to a robot on a master of its own.

    ``endpoint`` is the address that it connects to, ``router`` whether that is a router,
    ``secret`` whether keys are used; ``heard`` whether the robot is received: ``yes``, ``no`` (not
    any more) or ``never``. ``problem`` is the reason why it could not start, ``trouble`` the cause:
    ``library``, ``endpoint``, or for keys ``missing``, ``expired``, ``early`` or ``wrong``. ``own``
    and ``peer`` are the versions of both sides: {``mhri`` or ``zenoh``: version}. ``reach`` is the
    response of the endpoint, or why keys are rejected; '' if it was not tested.
    """

    robot: str
    endpoint: str = ''
    router: bool = False
    secret: bool = False
    heard: str = 'never'
    trouble: str = ''
    problem: str = ''
    own: Dict[str, Any] = field(default_factory=dict)
    peer: Dict[str, Any] = field(default_factory=dict)
    reach: str = ''


@dataclass(frozen=True)
class KeysSeen:
    """The keys for links on this computer: folder, problem, and whether an authority exists.

    ``cause`` is the cause of ``problem``, like ``trouble`` of :class:`LinkNote`.
    """

    folder: str = ''
    problem: str = ''
    authority: bool = False
    cause: str = ''


@dataclass(frozen=True)
class Facts:
    """All facts of one examination.

    ``later`` is the graph, ``later_nodes`` the suspicious nodes, queried again at the end: the
    doctor only reports a fault present both times. ``known`` maps message types to their md5 sum
    on this computer, None if not installed. ``requested`` are the robots to examine, () for all.
    ``pad_errors`` and ``mux_error`` are the errors in the files of pads and of the mux.
    ``linked`` are the links to robots on masters of their own; ``unheard`` the topics for which
    there was no time to listen.
    """

    computer: Computer = Computer()
    master: Master = Master()
    graph: Graph = Graph()
    nodes: Dict[str, Node] = field(default_factory=dict)
    streams: Tuple[Stream, ...] = ()
    known: Dict[str, Optional[str]] = field(default_factory=dict)
    later: Optional[Graph] = None
    later_nodes: Dict[str, Node] = field(default_factory=dict)
    requested: Tuple[str, ...] = ()
    template_errors: Tuple[str, ...] = ()
    pad_errors: Tuple[str, ...] = ()
    mux_error: str = ''
    caller_id: str = '/mhri_doctor'
    linked: Tuple[LinkNote, ...] = ()
    keys: KeysSeen = KeysSeen()
    unheard: Tuple[str, ...] = ()

    def with_later(self, graph: Graph, nodes: Dict[str, Node]) -> 'Facts':
        """Return these facts with those of the second query."""
        return replace(self, later=graph, later_nodes=nodes)

    def answering(self, name: str) -> Optional[Node]:
        """Return a node if it responds, else None."""
        node = self.nodes.get(name)
        return node if node is not None and node.state == ANSWERS else None

    def is_remote(self, node: Node) -> bool:
        """Return whether a node is on another computer, according to its address."""
        return bool(node.host) and not self.computer.is_own(node.host)

    def several_computers(self) -> bool:
        """Return whether the system includes other computers."""
        if self.master.state != STRANGER and not self.computer.is_own(self.master.host) \
                and self.computer.addresses_of(self.master.host):
            return True
        return any(self.is_remote(node) for node in self.nodes.values())


def is_ipv4(text: str) -> bool:
    """Return whether a text is an IPv4 address in four decimal parts."""
    parts = text.split('.')
    return len(parts) == 4 and all(part.isdigit() and len(part) < 4 and int(part) < 256
                                   for part in parts)


def is_loopback(address: str) -> bool:
    """Return whether an address or name reaches only the computer that uses it."""
    return address in ('localhost', '::1') or (is_ipv4(address) and address.startswith('127.'))
