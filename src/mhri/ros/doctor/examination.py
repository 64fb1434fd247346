# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Examines the ROS system from this computer; others need only :func:`examine`.

It disturbs nothing: it registers no node, sets no parameter, and hangs up after listening.
"""
import os
import time
from dataclasses import replace
import xmlrpc.client

import rosgraph
import rospkg

from mhri.core.config import ConfigError
from mhri.core.robots.discovery import IgnoreList
from mhri.core.doctor.judgement import diagnose, odd_ones
from mhri.core.doctor.facts import (
    Facts, Graph, REFUSED, SILENT, STRANGER, UNRESOLVED)
from mhri.core.doctor.host import find_on_host
from mhri.core.doctor.linked import links_of
from mhri.core.doctor.robots import robots_of
from mhri.core.doctor.system import GATES_STATE, muxes
from mhri.core.driving.sources import parse_mux_config
from mhri.ros.devices.pad_profiles import read_profiles
from mhri.ros.doctor.host import look_at_computer
from mhri.ros.doctor.linked import LinkLook
from mhri.ros.doctor.masters import look_elsewhere, parse_uri
from mhri.ros.doctor.probe import Probe
from mhri.ros.graph.look import shipped_ignore_list
from mhri.ros.graph.master_api import MasterApi, MasterError
from mhri.ros.messages import message_class, MessageMissing
from mhri.ros.resources import profile_reader, read_text, resource_path, robot_types

# Deadlines for asking the nodes and for asking again, counted from the start [s]; an examination
# that began late has less time, but never less than a living node needs to answer.
ASKED_S, AGAIN_S = 1.9, 2.6
LEAST_S, LEAST_AGAIN_S = 0.8, 0.3
# Programs that fight over a name take it from each other about once a second.
WATCH_S, WATCH_EACH_S = 1.5, 0.2
_MASTER_S = 0.8


def examine(robots=(), environ=None, begun=None):
    """Examine the system (blocking, 3 s at most; never on the GUI thread).

    :param robots: names of the robots to judge, () for all
    :param environ: the environment to judge, default that of this program
    :param begun: since when somebody has waited for it [s, monotonic], default now
    :returns: list of :class:`mhri.core.doctor.facts.Finding`: faults, warnings, then fine ones
    """
    begun = time.monotonic() if begun is None else begun
    environ = os.environ if environ is None else environ
    caller_id = '/mhri_doctor_{}'.format(os.getpid())
    try:
        types, errors = robot_types()
        ignore, faults = _ignore_list()
    except rospkg.ResourceNotFound:
        # Without the workspace there are no templates to judge robots by: check it first.
        master = parse_uri(environ.get('ROS_MASTER_URI') or rosgraph.rosenv.DEFAULT_MASTER_URI)
        return find_on_host(Facts(computer=look_at_computer(environ, master.host), master=master))
    facts = replace(look(environ, types, ignore, begun, robots, caller_id),
                    template_errors=tuple(str(error) for error in errors + faults),
                    pad_errors=tuple(str(error) for error in read_profiles()[1]))
    facts = replace(facts, mux_error=_mux_error(facts.graph.parameters))
    return diagnose(facts, types, ignore)


def _mux_error(parameters):
    """Return why the file that the mux reads cannot be used, '' if it can."""
    mux = parameters.get('mux')
    path = mux.get('config') if isinstance(mux, dict) else None
    path = path if path and isinstance(path, str) else resource_path('mux.yaml')
    try:
        parse_mux_config(read_text(path), path, profile_reader(path))
    except ConfigError as error:
        return str(error)
    except OSError as error:
        return '{}: {}'.format(path, error.strerror)
    return ''


def _ignore_list():
    """Return (:class:`IgnoreList`, [problems with its file])."""
    try:
        return shipped_ignore_list(), []
    except (ConfigError, OSError) as error:
        return IgnoreList(), [error]


def look(environ, types, ignore, begun, robots=(), caller_id='/mhri_doctor'):
    """Return the :class:`Facts` of this moment (blocking, at most until 3 s after ``begun``)."""
    master = parse_uri(environ.get('ROS_MASTER_URI') or rosgraph.rosenv.DEFAULT_MASTER_URI)
    computer = look_at_computer(environ, master.host)
    facts = Facts(computer=computer, wanted=tuple(robots), caller_id=caller_id)
    if master.uri_problem:
        return _without_master(facts, master)
    if not computer.addresses_of(master.host):
        return _without_master(facts, replace(master, state=UNRESOLVED))
    api = MasterApi(caller_id, _MASTER_S, master.uri)
    try:
        master, graph, uris = _ask_master(api, master)
    except MasterError as error:
        return _without_master(facts, _why_not(master, error))
    facts = replace(facts, master=master, graph=graph)
    watch_until = min(time.monotonic() + WATCH_S, begun + AGAIN_S)
    known = robots_of(graph, types, ignore)
    links = LinkLook(links_of(graph))
    facts = _ask_nodes(facts, known, uris, _deadline(begun + ASKED_S, LEAST_S))
    linked, keys = links.result(_deadline(begun + ASKED_S, LEAST_S))
    facts = replace(facts, linked=linked, keys=keys)
    if not muxes(facts):
        facts = replace(facts, master=replace(master, elsewhere=look_elsewhere(
            master, computer, caller_id, only_with_mux=True)))
    facts = _look_again(facts, known, api, begun + AGAIN_S)
    return _watch_names(facts, api, watch_until)


def _deadline(wanted, least_s):
    """Return a deadline, or a later one if that leaves too little time."""
    return max(wanted, time.monotonic() + least_s)


def _without_master(facts, master):
    """Return the facts with a master that does not answer, and others that do."""
    return replace(facts, master=replace(master, elsewhere=look_elsewhere(
        master, facts.computer, facts.caller_id)))


def _ask_master(api, master):
    """Return (master, graph, {node: URI}); three requests.

    :raises MasterError: no answer, or not a master's
    """
    begun = time.monotonic()
    graph = _graph(api)
    took_s = time.monotonic() - begun
    graph, uris = _with_uris(api, graph)
    return replace(master, took_s=took_s), graph, uris


def _with_uris(api, graph):
    """Return (graph, {node: URI}) of one moment; one request.

    A node that left between two requests is in the graph but has no URI: leave it out of both.
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
    """Return {node: URI} where the master has a URI; one request."""
    names = graph.nodes()
    answers = api.call_many([('lookupNode', name) for name in names]) if names else []
    return {name: uri for name, uri in zip(names, answers) if uri}


def _why_not(master, error):
    """Return the master with the reason why it does not answer."""
    cause = error.__context__
    if isinstance(cause, ConnectionRefusedError):
        state = REFUSED
    elif isinstance(cause, xmlrpc.client.Error) or not isinstance(cause, OSError) \
            or isinstance(cause, ConnectionError):
        state = STRANGER
    else:
        state = SILENT
    detail = str(getattr(cause, 'strerror', None) or cause or error)
    return replace(master, state=state, detail=detail)


def _ask_nodes(facts, robots, uris, deadline):
    """Ask every node at once; listen to the gates, and to odometry, IMU and scans of robots."""
    probe = Probe(facts.caller_id, deadline)
    listened = {topic for robot in robots
                if not facts.wanted or robot.candidate.name in facts.wanted
                for topic in robot.topics('odometry', 'imu', 'scan')} | {GATES_STATE}
    for name, uri in sorted(uris.items()):
        published = facts.graph.topics_of(name)[0]
        # Listening comes last: it takes time.
        probe.ask(name, uri, sorted(((topic, facts.graph.types.get(topic, ''), topic in listened)
                                     for topic in published), key=lambda item: item[2]))
    nodes, streams, resolved = probe.result()
    computer = replace(facts.computer, resolved=dict(facts.computer.resolved, **resolved))
    kinds = {stream.type for stream in streams if stream.type not in ('', '*')}
    return replace(facts, computer=computer, nodes=nodes, streams=tuple(streams),
                   known={kind: _own_md5(kind) for kind in kinds})


def _own_md5(kind):
    """Return the md5 sum of a message type on this computer, None if the type is not here."""
    try:
        return message_class(kind)._md5sum
    except MessageMissing:
        return None


def _look_again(facts, robots, api, wanted):
    """Ask the master once more, and the nodes that looked odd."""
    try:
        odd = odd_ones(facts, robots)
        if odd:
            time.sleep(0.25)  # time to connect, for programs that have only just started
        graph, uris = _with_uris(api, _graph(api))
    except MasterError:
        return facts
    probe = Probe(facts.caller_id, _deadline(wanted, LEAST_AGAIN_S))
    for name in sorted(odd & set(uris)):
        probe.ask(name, uris[name])
    nodes = {name: replace(node, uri_later=uris.get(name, ''))
             for name, node in facts.nodes.items()}
    return replace(facts, nodes=nodes).with_later(graph, probe.result()[0])


def _watch_names(facts, api, until):
    """Return the facts with the nodes that register elsewhere meanwhile; keep asking to the end."""
    nodes = facts.nodes
    try:
        while not any(node.uri_later not in ('', node.uri) for node in nodes.values()) \
                and time.monotonic() < until:
            time.sleep(WATCH_EACH_S)
            uris = _uris(api, facts.graph)
            nodes = {name: replace(node, uri_later=uris.get(name, ''))
                     for name, node in nodes.items()}
    except MasterError:
        pass  # it has just ended: the facts from before still hold
    return replace(facts, nodes=nodes)
