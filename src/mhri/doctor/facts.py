# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the doctor sees and what it says: plain values between examination and judgement."""
from dataclasses import dataclass, field, replace
from typing import Any, Collection, Dict, Iterable, List, Optional, Tuple

FAULT, WARNING, FINE = 'fault', 'warning', 'fine'
SEVERITIES = (FAULT, WARNING, FINE)

# How an address answered. REFUSED: the computer is there, the program is not. SILENT: nothing came
# back in time. UNRESOLVED: its name is unknown here. STRANGER: something else answers there.
ANSWERS, REFUSED, SILENT, UNRESOLVED, STRANGER = (
    'answers', 'refused', 'silent', 'unresolved', 'stranger')
# How a linked robot takes the key of this computer, and this computer that of the robot. EARLY: by
# the clock here that is not valid yet. RUN_OUT: nor any more. UNTIMELY: so the robot says of the
# one here. UNWELCOME: they are of two authorities.
EARLY, RUN_OUT, UNTIMELY, UNWELCOME = 'early', 'run out', 'untimely', 'unwelcome'

# So long a stream has to be listened to before its silence says anything [s].
LISTENED_S = 0.4

HOST = 'this computer'
MASTER = 'ROS master'
SYSTEM = 'system'


@dataclass(frozen=True)
class Finding:
    """One thing that the doctor looked at.

    ``check`` is its stable name for scripts; ``about`` the robot, node, computer or part concerned;
    ``problem`` what is wrong (or, for FINE, what is right); ``shows`` how the operator notices;
    ``remedy`` the command that mends it; ``sure`` how certain this is, '' for "fully".
    """

    severity: str
    check: str
    about: str
    problem: str
    shows: str = ''
    remedy: str = ''
    sure: str = ''


@dataclass(frozen=True)
class Folder:
    """A folder that mhri writes to.

    ``what`` it is for ('recordings', 'logs'), ``problem`` why mhri cannot write to it, '' if it
    can; ``device`` is the same for two folders on one disk.
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
        """Tell whether a host name or address means this computer."""
        return any(is_loopback(address) or address in self.addresses
                   for address in self.addresses_of(host))

    def good_ip(self) -> Optional[str]:
        """Return the address to give to robots, None if there is only loopback."""
        outward = [address for address in self.addresses if not is_loopback(address)]
        return self.route_ip or (outward[0] if outward else None)

    def own_host(self) -> Tuple[str, str]:
        """Return (host that programs started here advertise, the variable that says so or '')."""
        for key in ('ROS_HOSTNAME', 'ROS_IP'):
            if self.variables.get(key):
                return self.variables[key], key
        return self.name, ''


@dataclass(frozen=True)
class Master:
    """The master: its configured URI, how it answered, in words if it did not, and how fast [s].

    ``elsewhere`` are the URIs of other masters: if this one does not answer, those that do; if it
    has no mux, those that have one.
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
    """What the master knows: {topic: nodes}, {topic: type}, all parameters as a nested dict."""

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
        """Return the part of it that concerns some nodes."""
        def part(group: Dict[str, Tuple[str, ...]]) -> Dict[str, Tuple[str, ...]]:
            return {topic: kept for topic, nodes in group.items()
                    for kept in [tuple(node for node in nodes if node in names)] if kept}

        return replace(self, publishers=part(self.publishers), subscribers=part(self.subscribers),
                       services=part(self.services))

    def state(self) -> List[List[Any]]:
        """Return it as ``getSystemState`` does."""
        return [[[name, list(nodes)] for name, nodes in group.items()]
                for group in (self.publishers, self.subscribers, self.services)]

    def topics_of(self, node: str) -> Tuple[Tuple[str, ...], Tuple[str, ...]]:
        """Return (topics it publishes, topics it subscribes), as registered."""
        return (tuple(sorted(name for name, nodes in self.publishers.items() if node in nodes)),
                tuple(sorted(name for name, nodes in self.subscribers.items() if node in nodes)))


@dataclass(frozen=True)
class Connection:
    """A connection as a node reports it: ``out`` or not, its topic, who is at the other end.

    ``peer`` is the other node's name if outgoing, its URI if incoming; ``address`` the real IPv4
    address of the other end, '' if not reported.
    """

    out: bool
    topic: str
    peer: str
    address: str = ''


@dataclass(frozen=True)
class Node:
    """A registered node and how it answered.

    ``publications`` and ``subscriptions`` are {topic: type} in its own words, ``connections`` its
    :class:`Connection` list; each is None if it did not say. ``uri_later`` is where it was
    registered at the end of the examination.
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
    """What a publisher said when asked for a topic, and the stamps that came.

    ``problem`` says why there was no connection; ``listened_s`` is how long the doctor waited for
    messages [s], 0 if it did not; ``samples`` are (received, stamp) pairs by the clock here and the
    sender's [s]; ``refused`` what the gates refused, in their own words: '/node: twist, 3 times'.
    ``frames`` are those that odometry names; ``beams`` of a scan are (how many, how many measured
    something, how many say that nothing is there, how many say what may as well mean a dead laser).
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
    """What this computer's side of the link to a robot on a master of its own says of itself.

    ``endpoint`` is whom it calls, ``router`` whether that is a router, ``secret`` whether with
    keys; ``heard`` is ``yes``, ``no`` (not any more) or ``never``. ``problem`` says why it could
    not start, ``trouble`` what with: ``library``, ``keys`` or ``endpoint``. ``own`` and ``peer``
    are the versions of both sides: {``mhri`` or ``zenoh``: version}. ``reach`` says how the
    endpoint answers, with keys also how they are taken; '' if nobody asked.
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
    """The keys for links on this computer: where, why they are of no use; an authority beside."""

    folder: str = ''
    problem: str = ''
    authority: bool = False


@dataclass(frozen=True)
class Facts:
    """Everything that the doctor saw.

    ``later`` is the graph, ``later_nodes`` the nodes asked once more at the end, if something
    looked odd: the doctor only reports what is odd both times. ``known`` maps message types to
    their md5 sum on this computer, None if it has none. ``wanted`` are the robots asked for, () for
    all. ``pad_errors`` and ``mux_error`` say what is wrong with the files of pads and of the mux.
    ``linked`` are the links to robots on masters of their own; ``unheard`` the topics to which
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
    wanted: Tuple[str, ...] = ()
    template_errors: Tuple[str, ...] = ()
    pad_errors: Tuple[str, ...] = ()
    mux_error: str = ''
    caller_id: str = '/mhri_doctor'
    linked: Tuple[LinkNote, ...] = ()
    keys: KeysSeen = KeysSeen()
    unheard: Tuple[str, ...] = ()

    def with_later(self, graph: Graph, nodes: Dict[str, Node]) -> 'Facts':
        """Return these facts plus the second look."""
        return replace(self, later=graph, later_nodes=nodes)

    def answering(self, name: str) -> Optional[Node]:
        """Return a node that answers, or None."""
        node = self.nodes.get(name)
        return node if node is not None and node.state == ANSWERS else None

    def is_remote(self, node: Node) -> bool:
        """Tell whether a node is on another computer, as far as its address says."""
        return bool(node.host) and not self.computer.is_own(node.host)

    def several_computers(self) -> bool:
        """Tell whether other computers take part, too."""
        if self.master.state != STRANGER and not self.computer.is_own(self.master.host) \
                and self.computer.addresses_of(self.master.host):
            return True
        return any(self.is_remote(node) for node in self.nodes.values())


def is_ipv4(text: str) -> bool:
    """Tell whether a text is an IPv4 address in four decimal parts."""
    parts = text.split('.')
    return len(parts) == 4 and all(part.isdigit() and len(part) < 4 and int(part) < 256
                                   for part in parts)


def is_loopback(address: str) -> bool:
    """Tell whether an address or name reaches only the computer that uses it."""
    return address in ('localhost', '::1') or (is_ipv4(address) and address.startswith('127.'))


def listed(names: Iterable[str], most: int = 4) -> str:
    """Return names as a person lists them: 'a, b and 3 more'."""
    names = list(names)
    if len(names) <= most:
        return ', '.join(names)
    return '{} and {} more'.format(', '.join(names[:most]), len(names) - most)
