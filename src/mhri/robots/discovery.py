# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decides which parts of a ROS graph are robots, for "Look for Connected Bots"."""
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from typing import (
    Container, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Set, Tuple)

from mhri.base.config import parse_yaml
from mhri.base.names import name_problem
from mhri.base.robot_types import RobotType, Seen

# The master's getSystemState: publishers, subscribers and services, each with their nodes.
SystemState = Sequence[Iterable[Tuple[str, Sequence[str]]]]
# A nested dict of parameters.
Parameters = Mapping[str, object]
Types = Mapping[str, RobotType]

TWIST = 'geometry_msgs/Twist'
# Message types that a robot's base or sensors publish, but not a multiplexer; and exceptions.
_MEASURED = ('nav_msgs/Odometry', 'sensor_msgs/')
_NOT_MEASURED = ('sensor_msgs/Joy', 'sensor_msgs/JointState')
ROOT = ''
# At most one robot has no namespace; this is its name unless /robot_name sets another.
ROOT_NAME = 'robot'
NAME_PARAMETER = 'robot_name'
# Parameters at the root that belong to a robot without a namespace.
ROOT_PARAMETERS = ('robot_type', 'robot_model')


@dataclass(frozen=True)
class IgnoreList:
    """Names that are never robots: shell patterns (``*``, ``?``) for nodes and namespaces.

    ``tools`` are nodes' own names, in any namespace: a terminal's ``ROS_NAMESPACE`` may be any.
    ``bridges`` are nodes outside of any namespace that are never a robot by themselves, but may
    connect some that are no ROS nodes.
    """

    nodes: Tuple[str, ...] = ()
    namespaces: Tuple[str, ...] = ()
    tools: Tuple[str, ...] = ()
    bridges: Tuple[str, ...] = ()

    def is_bridge(self, node: str) -> bool:
        """Return whether a node (with leading slash) connects what are no ROS nodes."""
        return any(fnmatchcase(node, pattern) for pattern in self.bridges)

    def is_tool(self, node: str) -> bool:
        """Return whether a node is a tool, such as rviz, and not part of a robot."""
        own = node.rpartition('/')[2]
        return any(fnmatchcase(own, pattern) for pattern in self.tools)

    def covers(self, node: str, namespace: str) -> bool:
        """Return whether a node (with leading slash) or its namespace (without) is ignored."""
        return (any(fnmatchcase(node, pattern) for pattern in self.nodes + self.bridges)
                or any(fnmatchcase(namespace, pattern) for pattern in self.namespaces))


@dataclass(frozen=True)
class Candidate:
    """A candidate for a robot.

    ``robot_type`` is its parameter, None if it has none; ``nodes`` are the nodes registered under
    it, empty if only its parameters are left; ``problem`` says why it cannot be added. ``seen``
    holds the other facts of the graph about it. ``part`` is true for a namespace that counts as a
    part of the robot without a namespace while that robot is alive.
    """

    name: str
    robot_type: Optional[str] = None
    nodes: Tuple[str, ...] = ()
    problem: Optional[str] = None
    seen: Seen = Seen()
    part: bool = False


def parse_ignore_list(text: str, origin: str) -> IgnoreList:
    """Return the :class:`IgnoreList` of a YAML text.

    :raises ConfigError: names the file and the wrong key
    """
    section = parse_yaml(text, origin)
    ignore = IgnoreList(*(section.texts(key, ()) for key in (
        'nodes', 'namespaces', 'tools', 'bridges')))
    section.close()
    return ignore


def is_measured(kind: str) -> bool:
    """Return whether only the base of a robot, or its sensors, publish a message type."""
    return kind.startswith(_MEASURED) and not kind.startswith(_NOT_MEASURED)


def nodes_of(system_state: SystemState) -> List[str]:
    """Return the sorted names of all nodes in a ``getSystemState`` answer of the master."""
    return sorted({node for group in system_state for _, nodes in group for node in nodes})


def split(name: str) -> Tuple[str, str]:
    """Return (first segment, rest) of an absolute name; the first is :data:`ROOT` of ``/name``."""
    first, _, rest = name.lstrip('/').partition('/')
    return (first, rest) if rest else (ROOT, first)


def root_name(parameters: Parameters) -> str:
    """Return the name of the robot without a namespace, given the parameters at the root."""
    return str(parameters.get(NAME_PARAMETER, ROOT_NAME))


def parameters_of(name: str, parameters: Parameters, at_root: bool = False) -> Dict[str, object]:
    """Return the parameters of a robot as a nested dict.

    A robot without a namespace has ``/robot_type`` and ``/robot_model``, but the overrides of its
    template are below its name, since ``/mhri`` belongs to the panel.

    :param parameters: all parameters as one nested dict
    """
    below = parameters.get(name)
    own: Dict[str, object] = below if isinstance(below, dict) else {}
    if not at_root:
        return own
    found = {key: parameters[key] for key in ROOT_PARAMETERS if key in parameters}
    return dict(found, mhri=own['mhri']) if 'mhri' in own else found


def find_candidates(system_state: SystemState, parameters: Parameters, ignore: IgnoreList,
                    known: Container[str] = (), topic_types: Iterable[Tuple[str, str]] = (),
                    types: Optional[Types] = None, with_parts: bool = False) -> List[Candidate]:
    """Return the robots of a graph, sorted by name.

    A namespace is a robot if it has a ``robot_type``, or nodes under it that are neither ignored
    nor under a known robot, or velocity topics that a node outside of it reads (a simulator); of a
    bridge, only those that it alone reads, in a namespace where it publishes anything else. The
    root is a robot, named :func:`root_name`, if it has a ``robot_type`` or velocity topics;
    namespaces without either then count as its parts. A node with several robots (``instance`` of
    a type) yields each of them. A namespace without a type whose velocity only reaches the base of
    another robot (``joy_teleop`` of husky_control) is left out: no two robots have one base.

    :param system_state: publishers, subscribers, services as the master lists them
    :param parameters: all parameters as one nested dict
    :param ignore: :class:`IgnoreList`
    :param known: names of the robots already in the list; they are left out
    :param topic_types: pairs (topic, ROS type) as the master lists them
    :param types: {name: RobotType}, used to recognise robots and their velocity topics
    :param with_parts: include the parts of the robot without a namespace, and the namespaces that
        only command another robot (``seen.input_of``)
    """
    survey = Survey(system_state, parameters, ignore, topic_types, types or {})
    return [item for item in survey.candidates() if not known_by_name(item, known, types or {})
            and (with_parts or not (item.part or item.seen.input_of))]


def known_by_name(candidate: Candidate, known: Container[str], types: Types) -> bool:
    """Return whether a robot is already in the list, by its name or its instance's name."""
    kind = None if candidate.seen.kind is None else types.get(candidate.seen.kind)
    return candidate.name in known or bool(
        kind and kind.instance and candidate.seen.at_root and kind.instance in known)


def named_instances(system_state: SystemState, parameters: Parameters, ignore: IgnoreList,
                    topic_types: Iterable[Tuple[str, str]], types: Types) -> Dict[str, Seen]:
    """Return {name: :class:`Seen`} of every robot at the root with siblings in its node.

    Unlike :func:`find_candidates`, this gives the first robot its own name, too, so that it can be
    added by hand. The parameters are the same.
    """
    survey = Survey(system_state, parameters, ignore, topic_types, types)
    return {place.lstrip('/'): Seen(False, kind.name, None, place)
            for place, (kind, _) in survey.instances.items() if place.count('/') == 1}


class Survey:
    """A survey of a whole graph; parameters as for :func:`find_candidates`."""

    def __init__(self, system_state: SystemState, parameters: Parameters, ignore: IgnoreList,
                 topic_types: Iterable[Tuple[str, str]], types: Types) -> None:
        self._parameters = parameters
        self._ignore = ignore
        self._types = types
        self._topic_types = {topic: kind for topic, kind in topic_types}
        self._publishers, self._subscribers = (
            {topic: nodes for topic, nodes in group} for group in (*system_state, (), ())[:2])
        self._nested = sorted(set(self._typed_below()) - {
            node.lstrip('/') for node in nodes_of(system_state)})
        self._typed = {name: str(value['robot_type']) for name, value in parameters.items()
                       if isinstance(value, dict) and 'robot_type' in value}
        self._members: Dict[str, List[str]] = {}
        for node in nodes_of(system_state):
            namespace, _ = split(node)
            if self._may_be_robot(node) and not self._is_nested(node):
                self._members.setdefault(namespace, []).append(node)
        self._root_nodes = set(self._members.pop(ROOT, ()))
        #: {place of one robot of a node with several, e.g. ``/turtle2``: (RobotType, its nodes)}
        self.instances = dict(self._find_instances())
        self._readers = dict(self._velocities(self._subscribers))
        self._bridged = dict(self._find_bridged())
        self._written: Dict[str, List[str]] = {}
        for topic, nodes in self._velocities(self._publishers):
            for node in nodes:
                self._written.setdefault(node, []).append(topic)
        self._commands: Dict[str, List[str]] = {}
        self._listeners: Dict[str, Set[str]] = {}
        self._share_out_commands()
        # {namespace: the nodes of its own base}; {namespace that is not a robot: the one whose base
        # it commands}.
        self._bases: Dict[str, Set[str]] = {}
        self._inputs = self._find_inputs()

    def _ignored(self, name: str) -> bool:
        """Return whether a node or a topic is ignored, by its name or its namespace.

        A namespace with a ``robot_type`` may have an otherwise ignored name: then only the nodes
        named by a pattern of two segments are ignored.
        """
        namespace, _ = split(name)
        if namespace in self._typed:
            return any(fnmatchcase(name, pattern) for pattern in self._ignore.nodes
                       if pattern.count('/') > 1)
        return self._ignore.covers(name, namespace)

    def _may_be_robot(self, node: str) -> bool:
        return not (self._ignore.is_tool(node) or self._ignored(node))

    def _typed_below(self) -> Iterator[str]:
        """Yield ``lab/bot1`` if a robot was started two namespaces deep."""
        for name, value in self._parameters.items():
            if not isinstance(value, dict) or 'robot_type' in value \
                    or self._ignore.covers('/' + name, name):
                continue
            for inner, below in value.items():
                if isinstance(below, dict) and 'robot_type' in below:
                    yield '{}/{}'.format(name, inner)

    def _is_nested(self, name: str) -> bool:
        return any(name.startswith('/{}/'.format(robot)) for robot in self._nested)

    def _find_instances(self) -> Iterator[Tuple[str, Tuple[RobotType, Tuple[str, ...]]]]:
        """Yield (place, (RobotType, nodes)) of each robot of a node that may have several."""
        for kind, first in ((kind, kind.instance) for kind in self._types.values()
                            if kind.instance):
            signs = [(topic[len(first):], sign) for topic, sign in kind.known_by.items()]
            tail, _ = signs[0]
            for topic in self._publishers:
                place = topic[:-len(tail)]
                name, below = split(place)
                own_space = name == ROOT and (below in self._typed or below in self._members)
                if topic.endswith(tail) and place.count('/') in (1, 2) and not own_space \
                        and not self._ignored(topic) and not self._is_nested(topic) \
                        and all(self._published(place + end, one) for end, one in signs):
                    command = kind.for_instance(place).command[0]
                    yield place, (kind, tuple(sorted(
                        self._subscribers.get(command) or self._publishers[topic])))

    def _siblings(self) -> Iterator[Tuple[str, RobotType, Tuple[str, ...]]]:
        """Yield (place, RobotType, nodes) of all instances except the template's own."""
        for place, (kind, nodes) in sorted(self.instances.items()):
            if place.rpartition('/')[2] != kind.instance:
                yield place, kind, nodes

    def _share_out_commands(self) -> None:
        """Find the robot of each velocity topic that has a subscriber."""
        of_siblings = tuple(place + '/' for place, *_ in self._siblings())
        for topic, nodes in self._subscribers.items():
            if self._topic_types.get(topic) != TWIST or self._ignored(topic) \
                    or self._is_nested(topic) or topic.startswith(of_siblings):
                continue
            nodes = list(filter(self._may_be_robot, nodes)) or self._bridged.get(topic, [])
            owner, name = self._owner(topic, nodes) if nodes else (None, '')
            if owner is not None:
                self._commands.setdefault(owner, []).append(name)
                self._listeners.setdefault(owner, set()).update(nodes)

    def _owner(self, topic: str, nodes: Iterable[str]) -> Tuple[Optional[str], str]:
        """Return (namespace of the robot, name of the topic in its template), or (None, '').

        A topic at the root that nodes of several robots read belongs to none of them: it would
        drive them all at once.
        """
        namespace, rest = split(topic)
        if namespace and (namespace in self._members or namespace in self._typed):
            return namespace, rest
        readers = {split(node)[0] for node in nodes}
        if ROOT not in readers:
            return (readers.pop(), topic) if len(readers) == 1 else (None, '')
        name = topic.lstrip('/')
        if namespace == ROOT or any(name in kind.command for kind in self._types.values()):
            return ROOT, name
        return namespace, rest

    def _velocities(self, group: Mapping[str, Sequence[str]]) -> Iterator[Tuple[str, List[str]]]:
        """Yield (velocity topic, its nodes) of the publishers or the subscribers."""
        for topic, nodes in group.items():
            if self._topic_types.get(topic) == TWIST and not self._ignored(topic):
                yield topic, list(filter(self._may_be_robot, nodes))

    def _find_bridged(self) -> Iterator[Tuple[str, List[str]]]:
        """Yield (velocity topic, the bridges that alone read it and publish a robot's data).

        At the root a bridge publishes for everybody: only what a robot measures counts there.
        """
        published: Dict[str, Set[str]] = {}
        for topic, nodes in self._publishers.items():
            kind, namespace = self._topic_types.get(topic, ''), split(topic)[0]
            if kind != TWIST and (namespace != ROOT or is_measured(kind)):
                for node in filter(self._ignore.is_bridge, nodes):
                    published.setdefault(node, set()).add(namespace)
        for topic, nodes in self._subscribers.items():
            bridges = [node for node in nodes if split(topic)[0] in published.get(node, ())]
            if bridges and not any(map(self._may_be_robot, nodes)):
                yield topic, bridges

    def _reach(self, namespace: str) -> Tuple[Set[str], Set[str], Set[str]]:
        """Return where the velocity of a namespace goes: (all nodes, the last ones, topics).

        A node that reads velocity and writes velocity passes it on: a multiplexer, a smoother.
        """
        visited: Set[str] = set()
        ends: Set[str] = set()
        topics: Set[str] = set()
        left = list(self._listeners.get(namespace, ()))
        while left:
            node = left.pop()
            if node in visited:
                continue
            visited.add(node)
            written = self._written.get(node, ())
            topics.update(written)
            onward = {reader for topic in written
                      for reader in self._readers.get(topic, ())} - {node}
            left += sorted(onward)
            if not onward:
                ends.add(node)
        return visited, ends or visited, topics

    def _find_inputs(self) -> Dict[str, str]:
        """Return {namespace: another one, which has the base that its velocity reaches}."""
        reach = {name: self._reach(name) for name in self._commands}
        measuring: Dict[str, Set[str]] = {}
        for topic, nodes in self._publishers.items():
            if is_measured(self._topic_types.get(topic, '')):
                measuring.setdefault(split(topic)[0], set()).update(nodes)
        for name, (visited, ends, _) in reach.items():
            inside = {node for node in ends if split(node)[0] == name}
            self._bases[name] = inside | set(filter(self._ignore.is_bridge, ends)) | (
                visited & measuring.get(name, set()) if name != ROOT else set())
        inputs = {}
        for name, (_, ends, _) in reach.items():
            if name in self._typed or name == ROOT and 'robot_type' in self._parameters:
                continue
            # Not all ends: somebody may merely listen to the velocity of that base.
            others = [other for other in reach if other != name and ends & self._bases[other]]
            if others and (not self._bases[name] or others == [ROOT] and self._is_controller(
                    name, reach[ROOT][2])):
                inputs[name] = others[0]
        return inputs

    def _is_controller(self, name: str, reached: Set[str]) -> bool:
        """Return whether a namespace without nodes lies behind the multiplexer at the root.

        The controller of a robot at the root may have its own namespace, with its odometry.
        """
        prefix = '/{}/'.format(name)
        return name not in self._members and all(
            self._full(prefix, topic) in reached for topic in self._commands[name])

    def candidates(self) -> List[Candidate]:
        """Return every :class:`Candidate`, sorted by name."""
        root = self._root()
        names = set(self._typed) | set(self._commands) | set(self._members)
        names.discard(ROOT)
        parts = set()
        if root and root.nodes and not root.seen.input_of:
            parts = {name for name in names if name not in self._typed
                     and not (name in self._members and name in self._commands)}
        found = [replace(self._in_namespace(name), part=name in parts) for name in names
                 if name in self._typed or not self._ignore.covers('/' + name, name)]
        for place, kind, nodes in self._siblings():
            name = place.lstrip('/').replace('/', '_')
            found.append(Candidate(name, None, nodes, name_problem(name),
                                   Seen(False, kind.name, None, place)))
        found += [Candidate(name, problem=name_problem(name)) for name in self._nested]
        if root:
            taken = any(item.name == root.name for item in found)
            found.append(self._renamed(root) if taken else root)
        return sorted(found, key=lambda item: (item.name, item.seen.at_root))

    @staticmethod
    def _renamed(root: Candidate) -> Candidate:
        """Return the robot at the root, marked as indistinguishable from another one."""
        return Candidate(
            '/', root.robot_type, root.nodes, 'there is a robot /{0} as well; give the one without '
            'a namespace another name: rosparam set /{1} <name>'.format(root.name, NAME_PARAMETER),
            root.seen)

    def _in_namespace(self, name: str) -> Candidate:
        nodes = self._members.get(name) or sorted(self._listeners.get(name, ()))
        return Candidate(name, self._typed.get(name), tuple(nodes), name_problem(name),
                         self._seen(name, '/{}/'.format(name)))

    def _root(self) -> Optional[Candidate]:
        """Return the robot without a namespace, or None."""
        robot_type = self._parameters.get('robot_type')
        if not (isinstance(robot_type, str) or ROOT in self._commands):
            return None
        name = root_name(self._parameters)
        seen = self._seen(ROOT, '/')
        named = robot_type if isinstance(robot_type, str) else seen.kind
        kind = None if named is None else self._types.get(named)
        topics = ['/' + topic for topic in self._commands.get(ROOT, ())]
        for key in ('command', 'odometry', 'imu') if kind else ():
            topics += ['/' + topic for topic in getattr(kind, key)]
        nodes = {node for topic in topics for group in (self._subscribers, self._publishers)
                 for node in group.get(topic, ())}
        nodes &= self._root_nodes | self._listeners.get(ROOT, set())
        return Candidate(name, robot_type if isinstance(robot_type, str) else None,
                         tuple(sorted(nodes)), name_problem(name), seen)

    def _seen(self, namespace: str, prefix: str) -> Seen:
        """Return the :class:`Seen` of a robot, whose topics begin with a prefix."""
        kind = next((name for name, item in sorted(self._types.items())
                     if item.known_by and all(self._published(prefix + topic, sign)
                                              for topic, sign in item.known_by.items())), None)
        behind = tuple(topic for topic in sorted(self._commands.get(namespace, ()))
                       if self._is_behind(namespace, self._full(prefix, topic)))
        guard = '/{}/mhri_guard'.format(namespace)
        owner = self._inputs.get(namespace)
        return Seen(namespace == ROOT, kind, self._likeliest(namespace, prefix), None, behind,
                    tuple(topic for topic in behind
                          if guard in self._publishers.get(self._full(prefix, topic), ())),
                    root_name(self._parameters) if owner == ROOT else owner)

    @staticmethod
    def _full(prefix: str, topic: str) -> str:
        return topic if topic.startswith('/') else prefix + topic

    def _is_behind(self, namespace: str, topic: str) -> bool:
        """Return whether a node of the robot writes a velocity topic that reads velocity itself.

        Examples are a multiplexer and a smoother. A navigation does not subscribe velocity: it
        commands the robot in parallel with us.
        """
        # mhri's own nodes are at the root, too, but not part of a robot without a namespace.
        ignored = partial(self._ignore.covers, namespace=namespace) if namespace == ROOT \
            else self._ignored
        writers = {node for node in self._publishers.get(topic, ())
                   if not (self._ignore.is_tool(node) or ignored(node))}
        # A node outside of it may follow the velocity of another robot.
        return any(
            split(node)[0] == namespace or not self._belongs_to_another(other, namespace)
            for other, nodes in self._readers.items() if other != topic
            for node in writers.intersection(nodes))

    def _belongs_to_another(self, topic: str, namespace: str) -> bool:
        """Return whether a topic commands a robot of another namespace, with a base of its own."""
        return any(topic in (self._full('/{}/'.format(name), one) for one in topics)
                   for name, topics in self._commands.items()
                   if name not in (namespace, ROOT) and self._bases.get(name))

    def _published(self, topic: str, kind: str) -> bool:
        return topic in self._publishers and self._topic_types.get(topic) == kind

    def _likeliest(self, namespace: str, prefix: str) -> Optional[str]:
        """Return the velocity topic of a robot; None if two are equally likely.

        First come the names in the templates, then those that end in ``cmd_vel``, then the
        shortest. A topic written from inside the robot (behind its own multiplexer) comes last.
        """
        usual = [topic for kind in self._types.values() for topic in kind.command]

        def rank(topic: str) -> Tuple[bool, int, bool, int]:
            """Return a tuple: the smaller, the likelier."""
            full = self._full(prefix, topic)
            inside = self._is_behind(namespace, full) or namespace != ROOT and any(
                split(node)[0] == namespace and self._may_be_robot(node)
                for node in self._publishers.get(full, ()))
            return (inside, usual.index(topic) if topic in usual else len(usual),
                    not topic.endswith('cmd_vel'), topic.count('/'))

        ranked = sorted(self._commands.get(namespace, ()), key=rank)
        if len(ranked) > 1 and rank(ranked[0]) == rank(ranked[1]):
            return None
        return ranked[0] if ranked else None
