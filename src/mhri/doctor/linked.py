# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the links to robots with their own master (``mhri_link``), and of keys."""
from typing import Dict, List, Set

from mhri.base.text import listed
from mhri.doctor.facts import (
    ANSWERS, EARLY, Facts, FAULT, Finding, FINE, Graph, HOST, LinkNote, REFUSED, RUN_OUT,
    UNRESOLVED, UNTIMELY, UNWELCOME, WARNING)
from mhri.doctor.robots import clock_offset, LINK

# The status that the host's side publishes, as a parameter below its name.
NOTE = 'link'
# With a larger clock offset a key may be rejected [s].
CLOCK_S = 300.0
_STANDS = 'the robot stands still, and its row says "not heard"'
_SEND_AGAIN = 'turtlebot_deploy.sh USER@IP --link   # then start the robot again, and mhri here'
# Causes for which a side could not start: check, and remedy.
_TROUBLES = {
    'library': ('zenoh_missing', 'utils/host/mhri_run.sh --link {}=<address>   # installs it'),
    'endpoint': ('link_endpoint', 'utils/host/mhri_run.sh --link {}=<address>   # a right one')}
# The check for each cause of unusable keys.
_KEY_CHECKS = {'missing': 'keys_missing', 'expired': 'keys_expired', 'early': 'keys_clock'}
_KEY_REMEDIES = {
    'keys_missing': 'utils/host/mhri_keys.sh put <name of this computer\'s key>',
    'keys_expired': 'utils/host/mhri_keys.sh renew <name>; utils/host/mhri_keys.sh put <name>',
    'keys_clock': 'timedatectl   # sudo timedatectl set-ntp true, or: sudo date -s <the time>',
    'keys_wrong': 'utils/host/mhri_keys.sh check   # then put the right key in place'}
_CLOCK_THERE = 'on the robot: date   # sudo timedatectl set-ntp true, or: sudo date -s <the time>'
# Reasons for rejected keys: check, problem, and remedy.
_TAKEN = {
    EARLY: ('keys_clock', 'by the clock here the time of its key has not begun', 'date   # wrong '
            'here? sudo timedatectl set-ntp true; right? mhri_keys.sh renew {0}, and put it there'),
    RUN_OUT: ('keys_expired', 'by the clock here its key has run out', 'date   # right here? '
              'utils/host/mhri_keys.sh renew {0}; utils/host/mhri_keys.sh put {0} USER@IP'),
    UNTIMELY: ('keys_clock', 'it answers that by its clock the key of this computer is not valid '
               'today, and by the clock here it is', _CLOCK_THERE),
    UNWELCOME: ('keys_wrong', 'its key and that of this computer are of two authorities',
                _KEY_REMEDIES['keys_wrong'] + ', and put {0} USER@IP')}


def links_of(graph: Graph) -> List[LinkNote]:
    """Return the status of the host's side of each link, sorted by robot."""
    found = []
    for robot, below in sorted(graph.parameters.items()):
        node = below.get(LINK) if isinstance(below, dict) else None
        note = node.get(NOTE) if isinstance(node, dict) else None
        if isinstance(note, dict):
            found.append(LinkNote(robot, **{
                key: note[key] for key, kind in (
                    ('endpoint', str), ('router', bool), ('secret', bool), ('heard', str),
                    ('trouble', str), ('problem', str), ('own', dict), ('peer', dict))
                if isinstance(note.get(key), kind)}))
    return found


def unheard(facts: Facts) -> Set[str]:
    """Return the robots whose link fault explains all their other faults."""
    return {note.robot for note in facts.linked if note.problem or note.heard != 'yes'}


def find_on_linked(facts: Facts) -> List[Finding]:
    """Return the findings about links to robots with their own master, and about keys."""
    found = _keys(facts) + _same_end(facts)
    for note in facts.linked:
        found += (_not_started(note) or _ended(facts, note) or _silent(note)
                  or _versions(note) + _twice(facts, note) + _clock(facts, note)
                  or [Finding(FINE, 'linked', note.robot, 'linked by {}{}'.format(
                      note.endpoint, ', with keys' if note.secret else ''))])
    return found


def _keys(facts: Facts) -> List[Finding]:
    """Check the keys installed on this computer."""
    keys = facts.keys
    if keys.problem:
        check = _KEY_CHECKS.get(keys.cause, 'keys_wrong')
        return [Finding(FAULT, check, HOST, 'the key in {} cannot be used: {}'.format(
            keys.folder, keys.problem), 'linked robots do not let this computer in',
            _KEY_REMEDIES[check])]
    open_links = [note.robot for note in facts.linked if not note.secret and not note.problem]
    if keys.authority and open_links:
        return [Finding(
            WARNING, 'keys_missing', HOST, 'there is an authority for keys here, but {} linked '
            'without'.format(listed(open_links) + (' is' if len(open_links) == 1 else ' are')),
            'anybody on its network can drive the robot',
            _KEY_REMEDIES['keys_missing'] + '; then one on each robot, and start both again')]
    return []


def _not_started(note: LinkNote) -> List[Finding]:
    """Report why this computer's side of a link does not start."""
    if not note.problem:
        return []
    check, remedy = _TROUBLES.get(note.trouble, ('', ''))
    if not check:
        check = _KEY_CHECKS.get(note.trouble, 'keys_wrong')
        remedy = _KEY_REMEDIES[check]
    return [Finding(FAULT, check, note.robot, 'its link does not start here: ' + note.problem,
                    _STANDS, remedy.format(note.robot))]


def _ended(facts: Facts, note: LinkNote) -> List[Finding]:
    """Report a link that was started here but is not running."""
    if '/{}/{}'.format(note.robot, LINK) in facts.nodes:
        return []
    return [Finding(
        WARNING, 'link_ended', note.robot, 'its link was started here, and is not running',
        _STANDS, 'roslaunch mhri link.launch side:=host name:={0} {1}:={2}   # or, if it is not '
        'to: rosparam delete /{0}/{3}'.format(
            note.robot, 'router' if note.router else 'connect', note.endpoint, LINK))]


def _silent(note: LinkNote) -> List[Finding]:
    """Report why nothing is received over a link, as far as the endpoint shows."""
    if note.heard == 'yes':
        return []
    where, robot = note.endpoint, note.robot
    # Without a key a robot accepts no connection, unless it was started with --keys off.
    keys_off = '' if note.secret else ' --keys off'
    if note.reach in _TAKEN:
        check, problem, remedy = _TAKEN[note.reach]
        return [Finding(FAULT, check, robot, 'sends nothing over its link ({}): {}'.format(
            where, problem), _STANDS, remedy.format(robot))]
    if note.router and note.reach not in (ANSWERS, ''):
        return [Finding(
            FAULT, 'router_unreachable', robot, 'the router {} between this computer and the robot '
            '{}'.format(where, _reached(note.reach)), _STANDS, 'on the computer of the router: '
            'rosrun mhri mhri_link --side router --listen 0.0.0.0:{}{}   # and its firewall'.format(
                where.rpartition(':')[2], keys_off))]
    words = 'has never sent anything over its link ({})' if note.heard == 'never' else \
        'no longer sends anything over its link ({})'
    keys = '; utils/host/mhri_keys.sh check, and there: date, ls ~/mhri/keys' if note.secret else ''
    if note.router or note.reach == ANSWERS:
        return [Finding(
            FAULT, 'link_silent', robot, words.format(
                '{} answers, but not for {}'.format(where, robot)), _STANDS,
            'on the robot: turtle_remote.sh --link {}{}   # of this very name{}{}'.format(
                robot, ' --router ' + where if note.router else keys_off,
                ', and with a key or without as here', keys))]
    return [Finding(
        FAULT, 'link_silent', robot, words.format('{} {}'.format(
            where, _reached(note.reach) if note.reach else 'does not say whether it is there')),
        _STANDS, 'on the robot: turtle_remote.sh --link {}{}{}'.format(
            robot, keys_off, '' if note.reach == REFUSED else '   # in reach? ping {}'.format(
                where.rpartition('/')[2].rpartition(':')[0])))]


def _reached(reach: str) -> str:
    return {REFUSED: 'does not run, though its computer is there',
            UNRESOLVED: 'has a name that is unknown here'}.get(reach, 'does not answer')


def _versions(note: LinkNote) -> List[Finding]:
    """Compare the versions of both sides of a link."""
    return [Finding(
        WARNING, check, note.robot, 'both sides of its link differ in {}: {} here, {} on the '
        'robot'.format(what, note.own.get(key), note.peer.get(key)),
        'parts of the link may not work', _SEND_AGAIN)
        for key, check, what in (('mhri', 'link_versions', 'their version of mhri'),
                                 ('zenoh', 'zenoh_versions', 'their version of zenoh'))
        if note.peer.get(key) and note.own.get(key) and note.peer[key] != note.own[key]]


def _same_end(facts: Facts) -> List[Finding]:
    """Report a robot that is linked by two names."""
    names: Dict[str, List[str]] = {}
    for note in facts.linked:
        if note.endpoint and not note.router:
            names.setdefault(note.endpoint, []).append(note.robot)
    return [Finding(
        WARNING, 'linked_twice', listed(robots), 'all are linked to {}, which is one robot'.format(
            where), 'only that of the name it has itself is heard',
        'utils/host/mhri_run.sh --link "..."   # with each robot once')
        for where, robots in sorted(names.items()) if len(robots) > 1]


def _twice(facts: Facts, note: LinkNote) -> List[Finding]:
    """Report a linked robot that is also on this master: nodes publish the topics of its link."""
    own = '/{}/{}'.format(note.robot, LINK)
    others = sorted({
        node for topic, nodes in facts.graph.publishers.items()
        if own in nodes and topic.startswith('/{}/'.format(note.robot))
        for node in nodes if node != own and facts.answering(node)})
    if not others:
        return []
    return [Finding(
        FAULT, 'linked_twice', note.robot, 'it is linked by {}, and on this master, too: {}'.format(
            own, listed(others)), 'its figures jump between two robots, and commands go two ways',
        'rosnode kill {}   # or end the one that is not meant: on the robot, turtle_remote.sh '
        'either with --link or without'.format(own))]


def _clock(facts: Facts, note: LinkNote) -> List[Finding]:
    """Check the clock of a robot linked with keys, which are only valid for a period."""
    if not note.secret:
        return []
    for stream in facts.streams:
        if stream.samples and stream.topic.startswith('/{}/'.format(note.robot)):
            offset_s = clock_offset(stream.samples)[0]
            if abs(offset_s) > CLOCK_S:
                return [Finding(
                    WARNING, 'keys_clock', note.robot, 'its clock is {:.0f} minutes {}: a day off, '
                    'and it refuses every key'.format(
                        abs(offset_s) / 60.0, 'ahead' if offset_s > 0.0 else 'behind'),
                    'the link ends, or does not begin again',
                    'on the robot: sudo timedatectl set-ntp true   # or: sudo date -s <the time>')]
    return []
