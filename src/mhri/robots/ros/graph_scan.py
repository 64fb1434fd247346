# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Looks for robots on the ROS graph: one query of the master, then a connection to each node."""
from dataclasses import dataclass, field
from typing import Tuple

from mhri.base.robot_types import Seen
from mhri.graph.ros.parallel_calls import connectable
from mhri.graph.ros.master_api import MasterApi
from mhri.graph.ros.resources import read_resource, resource_path, robot_types
from mhri.robots.discovery import (
    find_candidates, NAME_PARAMETER, named_instances, parameters_of, parse_ignore_list,
    ROOT_PARAMETERS)
from mhri.robots.found_streams import own_topics

NODES_EACH = 3


@dataclass(frozen=True)
class Facts:
    """Facts of the graph about a robot before it is in the list.

    :param parameters: parameters of the robot as a nested dict, {} if it has none
    :param seen: :class:`Seen`, None if the graph was not queried or does not have the robot
    :param published: its topics, see :func:`mhri.robots.found_streams.own_topics`; None if unknown
    """

    parameters: dict = field(default_factory=dict)
    seen: Seen = None
    published: dict = None


@dataclass(frozen=True)
class Found:
    """The result of looking for robots.

    ``live`` are candidates with a node that answers; ``leftovers`` are registered, but nothing
    answers (crashed, switched off, out of reach) or only parameters are left; ``refused`` have
    impossible names. ``facts`` is {name: :class:`Facts`} of all of them.
    """

    live: Tuple = ()
    leftovers: Tuple = ()
    refused: Tuple = ()
    facts: dict = None


def look_for_robots(caller_id, ignore, known=(), api=None, types=None):
    """Look for robots (blocking; never on the GUI thread).

    One request to the master fetches its whole state, the types of all topics and all parameters,
    another one the addresses of the robots found.

    :param ignore: :class:`mhri.robots.discovery.IgnoreList`
    :param known: robots already in the list
    :param api: the :class:`MasterApi` to ask, default that of ``ROS_MASTER_URI``
    :param types: {name: RobotType}, default all installed ones
    :returns: :class:`Found`
    :raises MasterError: the master cannot be reached
    """
    api = api or MasterApi(caller_id, timeout_s=5.0)
    *graph, parameters = api.call_many(
        [('getSystemState',), ('getTopicTypes',), ('getParam', '/')])
    state, topic_types = graph[0] or [], graph[1] or ()
    parameters = parameters or {}
    candidates = find_candidates(state, parameters, ignore, known, topic_types,
                                 robot_types()[0] if types is None else types, with_parts=True)
    asked = [(candidate, node) for candidate in candidates
             for node in candidate.nodes[:NODES_EACH] if candidate.problem is None]
    uris = api.call_many([('lookupNode', node) for _, node in asked]) if asked else []
    answered = connectable([uri for uri in uris if uri])
    alive = {candidate.name for (candidate, _), uri in zip(asked, uris) if uri in answered}
    # A part of a living robot is not a robot itself; a dead robot has no parts.
    root_lives = any(item.seen.at_root and item.name in alive for item in candidates)
    candidates = [item for item in candidates
                  if not item.seen.input_of
                  and (not item.part or item.name in alive and not root_lives)]
    published = _published(state, topic_types)
    spaces = _spaces(candidates).union(known)
    return Found(
        live=tuple(item for item in candidates if item.name in alive),
        leftovers=tuple(item for item in candidates
                        if item.problem is None and item.name not in alive),
        refused=tuple(item for item in candidates if item.problem),
        facts={item.name: Facts(
            parameters_of(item.name, parameters, item.seen.at_root), item.seen,
            own_topics(item.name, published, spaces if item.seen.at_root else None))
               for item in candidates})


def _published(state, topic_types):
    """Return {published topic: type}."""
    kinds = dict(topic_types)
    return {topic: kinds.get(topic, '') for topic, _ in state[0]} if state else {}


def _spaces(candidates):
    """Return the first segments of the robots with a namespace, as a set."""
    return {item.name.partition('/')[0] for item in candidates
            if not (item.part or item.seen.at_root)}


def shipped_ignore_list():
    """Return the :class:`IgnoreList` of ``resource/discovery.yaml``.

    :raises ConfigError: the file has a mistake
    :raises OSError: the file cannot be read
    """
    return parse_ignore_list(read_resource('discovery.yaml'), resource_path('discovery.yaml'))


def robot_facts(caller_id, names, types, seen=None, incomplete=()):
    """Return {name: :class:`Facts`}: the parameters of robots, in one request.

    The graph is queried, in another request, only for robots that ``seen`` lacks and that have no
    ``robot_type`` or are ``generic``, and for the topics of one without a namespace.

    :param types: {name: RobotType}
    :param seen: {name: :class:`Seen`}, as far as already known
    :param incomplete: names of the robots whose published topics are wanted
    :raises MasterError: the master cannot be reached
    """
    names, incomplete, seen = list(names), list(incomplete), dict(seen or {})
    if not names:
        return {}
    api = MasterApi(caller_id, timeout_s=2.0)
    keys = list(dict.fromkeys(names + [NAME_PARAMETER, *ROOT_PARAMETERS]))
    values = api.call_many([('getParam', '/' + key) for key in keys]
                           + [('getPublishedTopics', '/' + name) for name in incomplete])
    parameters = {key: value for key, value in zip(keys, values) if value is not None}
    published = {name: own_topics(name, dict(topics or ()))
                 for name, topics in zip(incomplete, values[len(keys):])}
    unseen = [name for name in names if name not in seen
              and parameters_of(name, parameters).get('robot_type', 'generic') == 'generic']
    if unseen or any(name in seen and seen[name].at_root for name in incomplete):
        state, topic_types = api.call_many([('getSystemState',), ('getTopicTypes',)])
        graph = (state or [], parameters, shipped_ignore_list())
        candidates = find_candidates(*graph, (), topic_types or (), types, with_parts=True)
        found = named_instances(*graph, topic_types or (), types)
        found.update((item.name, item.seen) for item in candidates if item.problem is None)
        seen.update((name, found[name]) for name in unseen if name in found)
        everything = _published(graph[0], topic_types or ())
        published.update((name, own_topics(name, everything, _spaces(candidates)))
                         for name in incomplete if name in seen and seen[name].at_root)
    return {name: Facts(parameters_of(name, parameters, name in seen and seen[name].at_root),
                        seen.get(name), published.get(name)) for name in names}
