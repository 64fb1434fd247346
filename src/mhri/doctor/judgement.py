# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Derives findings from the facts of an examination (:mod:`mhri.doctor.facts`)."""
from typing import Any, Dict, Iterable, List, Mapping, Sequence, Set

from mhri.base.robot_types import RobotType
from mhri.doctor.facts import ANSWERS, Facts, FAULT, Finding, FINE, SEVERITIES, WARNING
from mhri.doctor.host import find_on_host, find_on_master
from mhri.doctor.linked import find_on_linked, unheard
from mhri.doctor.links import find_on_links, missing_links
from mhri.doctor.nodes import find_on_nodes, odd_nodes, robot_of
from mhri.doctor.robots import find_on_robots, hidden_listeners, Robot, robots_of
from mhri.doctor.sensors import find_unheard
from mhri.doctor.system import find_on_system, hung
from mhri.robots.discovery import IgnoreList

_MARKS = {FAULT: '[X] fault', WARNING: '/!\\ warning', FINE: '(o) fine'}


def diagnose(facts: Facts, types: Mapping[str, RobotType], ignore: IgnoreList) -> List[Finding]:
    """Return the :class:`Finding` list of an examination: faults first, then warnings, then fine.

    :param facts: :class:`mhri.doctor.facts.Facts`
    :param types: {name: :class:`mhri.base.robot_types.RobotType`} with at least ``generic``
    :param ignore: :class:`mhri.robots.discovery.IgnoreList`
    """
    found = find_on_host(facts) + find_on_master(facts)
    if facts.master.state == ANSWERS and not facts.master.uri_problem:
        silent = unheard(facts)
        found += (find_unheard(facts) + find_on_system(facts) + find_on_nodes(facts, hung(facts))
                  + find_on_links(facts) + find_on_linked(facts) + [
                      item for item in find_on_robots(
                          facts, types, robots_of(facts.graph, types, ignore))
                      if item.about not in silent])
    return sorted(_of_wanted(facts, found), key=lambda item: SEVERITIES.index(item.severity))


def _of_wanted(facts: Facts, found: List[Finding]) -> List[Finding]:
    """Drop findings about robots that were not requested."""
    if not facts.requested:
        return found
    others = {robot_of(node) for node in facts.nodes} - set(facts.requested) - {''}
    return [item for item in found if item.about.lstrip('/').split('/')[0] not in others]


def odd_ones(facts: Facts, robots: Iterable[Robot]) -> Set[str]:
    """Return the names of the nodes to query again before reporting a fault.

    A node that is starting or stopping looks faulty for a moment.

    :param robots: list of :class:`mhri.doctor.robots.Robot`
    """
    topics = [topic for robot in robots for topic in robot.topics('command')]
    odd = odd_nodes(facts) | hidden_listeners(facts, topics)
    for _, publisher, subscriber in missing_links(facts, facts.nodes, facts.graph):
        odd |= {publisher, subscriber}
    return odd


def exit_status(findings: Sequence[Finding]) -> int:
    """Return 1 if there are faults or warnings, else 0."""
    return int(any(item.severity != FINE for item in findings))


def as_lines(findings: Sequence[Finding], took_s: float) -> List[str]:
    """Return the report as lines of text for humans."""
    lines = []
    for item in findings:
        lines.append('{}  {}: {}'.format(_MARKS[item.severity], item.about, item.problem))
        lines += ['      {:<11} {}'.format(key, text) for key, text in (
            ('symptom:', item.symptom), ('fix:', item.remedy),
            ('confidence:', item.confidence)) if text]
    counts = {severity: sum(1 for item in findings if item.severity == severity)
              for severity in SEVERITIES}
    lines.append('{} faults, {} warnings, {} fine; examined in {:.1f} s'.format(
        counts[FAULT], counts[WARNING], counts[FINE], took_s))
    # Any program can register any name: escape sequences must not reach the terminal.
    return [''.join(char if char.isprintable() else '?' for char in line) for line in lines]


def as_dict(findings: Sequence[Finding], took_s: float) -> Dict[str, Any]:
    """Return the report for scripts: ``faults``, ``warnings``, ``took_s`` and ``findings``."""
    return {
        'faults': sum(1 for item in findings if item.severity == FAULT),
        'warnings': sum(1 for item in findings if item.severity == WARNING),
        'took_s': round(took_s, 3),
        'findings': [dict(vars(item)) for item in findings]}
