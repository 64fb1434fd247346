# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the accessories of a robot: types that are not installed, topics that nobody reads."""
from typing import Dict, Iterable, List, Tuple

from mhri.base.accessories import Accessory, ACTION, READOUT, SERVICE
from mhri.base.names import topic_of
from mhri.base.text import listed
from mhri.doctor.facts import Facts, Finding, WARNING
from mhri.doctor.host import package_of
from mhri.robots.listeners import obeying


def types_of(accessory: Accessory) -> List[str]:
    """Return the types that it needs: of messages, or of its service."""
    first = accessory.type + ('ActionGoal' if accessory.way == ACTION else '')
    return [first] + ([accessory.state.kind] if accessory.state else [])


def find_on_accessories(facts: Facts, name: str, rows: Iterable[Accessory]) -> List[Finding]:
    """Return what keeps accessories of a robot from acting; optional ones may be absent."""
    found: List[Finding] = []
    missing: Dict[str, List[str]] = {}
    unheard: List[Tuple[str, str]] = []
    for row in rows:
        topic = topic_of(name, row.name) + ('/goal' if row.way == ACTION else '')
        # A recorder that listens is no driver.
        there = facts.graph.publishers.get(topic) if row.kind == READOUT else any(
            obeying(name, [facts.graph.subscribers.get(topic, ())]))
        if row.optional and not there:
            continue
        for kind in types_of(row):
            if facts.known.get(kind, '') is None:
                missing.setdefault(kind.split('/')[0], []).append(row.key)
        if row.kind != READOUT and row.way != SERVICE and not there:
            unheard.append((row.key, topic))
    if missing:
        found.append(Finding(
            WARNING, 'accessory_type', name, 'the messages of {} are not installed here'.format(
                listed(sorted({key for keys in missing.values() for key in keys}))),
            'these accessories are dimmed; all others work',
            'sudo apt install {}   # or source the workspace that has them'.format(' '.join(
                package_of(package, facts.computer) for package in sorted(missing)))))
    if unheard:
        found.append(Finding(
            WARNING, 'accessory_unheard', name, 'nothing subscribes to {}'.format(
                listed(topic for _, topic in unheard)),
            '{} cannot be used'.format(listed(key for key, _ in unheard)),
            'start its driver on the robot, or correct the row in its type, or in '
            '/{}/mhri/accessories'.format(name)))
    return found
