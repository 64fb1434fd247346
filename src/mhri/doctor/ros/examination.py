# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Examines the ROS system from this computer; the entry point is :func:`examine`.

It has no side effects: no node is registered, no parameter set, and connections are closed.
"""
import os
import time
from dataclasses import replace

import rosgraph
import rospkg

from mhri.base.accessories import SERVICE
from mhri.base.config import ConfigError
from mhri.doctor.accessories import types_of
from mhri.doctor.facts import Facts, Graph, UNRESOLVED
from mhri.doctor.host import find_on_host
from mhri.doctor.judgement import diagnose, odd_ones
from mhri.doctor.linked import links_of
from mhri.doctor.robots import robots_of
from mhri.doctor.ros.files import look_at_files
from mhri.doctor.ros.host import look_at_computer
from mhri.doctor.ros.linked import ask_links, linked_of
from mhri.doctor.ros.masters import look_elsewhere, parse_uri
from mhri.doctor.ros.probe import Probe, state_of
from mhri.doctor.system import muxes, STATE
from mhri.graph.ros.parallel_calls import Answers
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.messages import message_class, MessageMissing
from mhri.graph.ros.resources import robot_types
from mhri.robots.discovery import IgnoreList
from mhri.robots.ros.graph_scan import shipped_ignore_list

# Deadlines of the first query of the nodes, and of all queries, from the start [s]: the rest of the
# 3 s is for evaluation, report and exit. An examination that began late has less time, but at least
# the time that a live node needs to respond.
ASKED_S, END_S = 1.9, 2.6
MIN_S, MIN_AGAIN_S = 0.8, 0.3
# Two programs with one name take it from each other about once a second.
WATCH_S, WATCH_EACH_S = 1.5, 0.2
_MASTER_S = 0.8


def examine(robots=(), environ=None, begun=None, watch_s=WATCH_S):
    """Examine the system (blocking, 3 s at most; never on the GUI thread).

    :param robots: names of the robots to check, () for all
    :param environ: the environment to check, default that of this program
    :param begun: start of the caller's wait [s, monotonic], default now
    :param watch_s: how long to watch for programs that take a name from each other [s]
    :returns: list of :class:`mhri.doctor.facts.Finding`: faults, warnings, then fine ones
    """
    begun = time.monotonic() if begun is None else begun
    environ = os.environ if environ is None else environ
    caller_id = '/mhri_doctor_{}'.format(os.getpid())
    try:
        types, errors = robot_types()
        ignore, faults = _ignore_list()
    except rospkg.ResourceNotFound:
        # Checked first: without the workspace there are no templates for the robots.
        master = parse_uri(environ.get('ROS_MASTER_URI') or rosgraph.rosenv.DEFAULT_MASTER_URI)
        return find_on_host(Facts(computer=look_at_computer(environ, master.host), master=master))
    facts = replace(look(environ, types, ignore, begun, watch_s, robots, caller_id),
                    template_errors=tuple(str(error) for error in errors + faults))
    return diagnose(facts, types, ignore)


def _ignore_list():
    """Return (:class:`IgnoreList`, [problems with its file])."""
    try:
        return shipped_ignore_list(), []
    except (ConfigError, OSError) as error:
        return IgnoreList(), [error]


def look(environ, types, ignore, begun, watch_s, robots=(), caller_id='/mhri_doctor'):
    """Return the current :class:`Facts` (blocking, at most until 3 s after ``begun``)."""
    master = parse_uri(environ.get('ROS_MASTER_URI') or rosgraph.rosenv.DEFAULT_MASTER_URI)
    computer = look_at_computer(environ, master.host)
    facts = Facts(computer=computer, requested=tuple(robots), caller_id=caller_id)
    if master.uri_problem:
        return _without_master(facts, master, begun)
    if not computer.addresses_of(master.host):
        return _without_master(facts, replace(master, state=UNRESOLVED), begun)
    api = MasterApi(caller_id, _MASTER_S, master.uri)
    try:
        master, graph, uris = _ask_master(api, master)
    except MasterError as error:
        return _without_master(facts, _why_not(master, error), begun)
    facts = replace(facts, master=master, graph=graph)
    watch_until = min(time.monotonic() + watch_s, begun + END_S)
    known = robots_of(graph, types, ignore)
    notes, aside = links_of(graph), Answers()
    aside.ask('files', look_at_files, graph.parameters)
    ask_links(aside, notes)
    asked = _deadline(begun + ASKED_S, MIN_S)
    facts = _ask_nodes(facts, known, uris, asked)
    found = aside.by(asked)
    linked, keys = linked_of(notes, found)
    facts = replace(facts, linked=linked, keys=keys, **found.get('files', {}))
    if not muxes(facts):
        facts = replace(facts, master=replace(master, elsewhere=look_elsewhere(
            master, computer, caller_id, only_with_mux=True)))
    facts = _look_again(facts, known, _deadline(begun + END_S, MIN_AGAIN_S))
    return _watch_names(facts, watch_until)


def _deadline(deadline, least_s):
    """Return a deadline, or a later one if that leaves too little time."""
    return max(deadline, time.monotonic() + least_s)


def _master_until(facts, deadline):
    """Return the master's API, with the time left until a deadline as timeout of each call."""
    return MasterApi(facts.caller_id, min(_MASTER_S, max(0.05, deadline - time.monotonic())),
                     facts.master.uri)


def _without_master(facts, master, begun):
    """Return the facts without a responding master, and with the other masters."""
    aside = Answers()
    aside.ask('files', look_at_files, {})
    facts = replace(facts, master=replace(master, elsewhere=look_elsewhere(
        master, facts.computer, facts.caller_id)))
    found = aside.by(_deadline(begun + ASKED_S, MIN_AGAIN_S))
    return replace(facts, **found.get('files', {}))


def _ask_master(api, master):
    """Return (master, graph, {node: URI}); three requests.

    :raises MasterError: no response, or not that of a master
    """
    begun = time.monotonic()
    graph = _graph(api)
    took_s = time.monotonic() - begun
    graph, uris = _with_uris(api, graph)
    return replace(master, took_s=took_s), graph, uris


def _with_uris(api, graph):
    """Return a consistent (graph, {node: URI}); one request.

    A node that left between two requests is in the graph without a URI: drop it from both.
    """
    uris = _uris(api, graph)
    return graph.of(uris), uris


def _graph(api):
    """Return the :class:`Graph`; one request."""
    state, types, parameters = api.call_many(
        [('getSystemState',), ('getTopicTypes',), ('getParam', '/')])
    if state is None or types is None:
        raise MasterError('it does not know getSystemState')
    groups = [{name: tuple(nodes) for name, nodes in group} for group in state]
    return Graph(*groups, types=dict(types),
                 parameters=parameters if isinstance(parameters, dict) else {})


def _uris(api, graph):
    """Return {node: URI} of the nodes with a URI at the master; one request."""
    names = graph.nodes()
    answers = api.call_many([('lookupNode', name) for name in names]) if names else []
    return {name: uri for name, uri in zip(names, answers) if uri}


def _why_not(master, error):
    """Return the master with the reason why it does not respond."""
    cause = error.__context__
    detail = str(getattr(cause, 'strerror', None) or cause or error)
    return replace(master, state=state_of(cause), detail=detail)


def _ask_nodes(facts, robots, uris, deadline):
    """Query all nodes in parallel; listen to the mux, and to odometry, IMU and scans of robots."""
    probe = Probe(facts.caller_id, deadline, {
        topic: robot.template.no_return for robot in robots for topic in robot.topics('scan')})
    listened = {topic for robot in robots
                if not facts.requested or robot.candidate.name in facts.requested
                for topic in robot.topics('odometry', 'imu', 'scan')} | {STATE}
    for name, uri in sorted(uris.items()):
        published = facts.graph.topics_of(name)[0]
        probe.ask(name, uri, [(topic, facts.graph.types.get(topic, ''), topic in listened)
                              for topic in published])
    # Meanwhile, since importing message types is slow.
    known = {kind: _own_md5(kind) for kind in {
        facts.graph.types.get(topic, '*') for topic in facts.graph.publishers} - {'', '*'}}
    known.update((kind, _own_md5(kind, 'srv' if row.way == SERVICE and kind == row.type else 'msg'))
                 for robot in robots for row in robot.template.accessories
                 for kind in types_of(row))
    nodes, streams, resolved = probe.result()
    computer = replace(facts.computer, resolved=dict(facts.computer.resolved, **resolved))
    known.update((stream.type, _own_md5(stream.type)) for stream in streams
                 if stream.type not in known and stream.type not in ('', '*'))
    return replace(facts, computer=computer, nodes=nodes, streams=tuple(streams),
                   unheard=probe.unheard, known=known)


def _own_md5(kind, place='msg'):
    """Return the md5 sum of a type of messages or services here, None if not installed."""
    try:
        return message_class(kind, place)._md5sum
    except MessageMissing:
        return None


def _look_again(facts, robots, deadline):
    """Query the master and the suspicious nodes again."""
    try:
        odd = odd_ones(facts, robots)
        if odd:
            time.sleep(0.25)  # time to connect, for programs that have just started
        graph = _graph(_master_until(facts, deadline))
        graph, uris = _with_uris(_master_until(facts, deadline), graph)
    except MasterError:
        return facts
    probe = Probe(facts.caller_id, _deadline(deadline, MIN_AGAIN_S))
    for name in sorted(odd & set(uris)):
        probe.ask(name, uris[name])
    nodes = {name: replace(node, uri_later=uris.get(name, ''))
             for name, node in facts.nodes.items()}
    return replace(facts, nodes=nodes).with_later(graph, probe.result()[0])


def _watch_names(facts, until):
    """Poll the master until a time; return the facts with the changed URIs of nodes."""
    nodes = facts.nodes
    try:
        while not any(node.uri_later not in ('', node.uri) for node in nodes.values()):
            left_s = until - time.monotonic()
            if left_s <= 0.0:
                break
            time.sleep(min(WATCH_EACH_S, left_s))
            uris = _uris(_master_until(facts, until), facts.graph)
            nodes = {name: replace(node, uri_later=uris.get(name, ''))
                     for name, node in nodes.items()}
    except MasterError:
        pass  # the master has just ended: keep the earlier facts
    return replace(facts, nodes=nodes)
