# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whose key may do what on the link: the names in certificates, and zenoh's rules made of them.

A name is ``host:lab`` (may drive), ``watch:lab`` (may only watch), ``robot:bot1`` or
``watched:bot1`` (nobody drives it), with a number where others were withdrawn (``robot:bot1.2``).
``utils/host/mhri_keys.sh`` makes them. The same names say who speaks on a link without keys.
"""
from dataclasses import dataclass
import re
from typing import Dict, FrozenSet, Iterable, List, Sequence, Tuple

DRIVES, WATCHES, ROBOT, WATCHED = 'host', 'watch', 'robot', 'watched'
_NAME = re.compile(r'(host|watch|robot|watched):([A-Za-z0-9_-]{1,64})(\.[0-9]{1,6})?\Z')
_ODD = re.compile(r'[^A-Za-z0-9_-]')
_SERIAL = re.compile(r'^\s*Serial Number:\s*([0-9A-Fa-f]+)\s*$', re.MULTILINE)
ALONE, TLS = ('tcp', 'udp'), ('tls', 'quic')


class KeysError(Exception):
    """Keys that cannot be used; says what is wrong, and the remedy."""


@dataclass(frozen=True)
class Keys:
    """What is in place.

    :param own: the name in the own certificate
    :param peers: names of those who have a key
    :param withdrawn: names whose keys were taken back
    """

    own: str
    peers: FrozenSet[str] = frozenset()
    withdrawn: FrozenSet[str] = frozenset()


def split(owner: str) -> Tuple[str, str]:
    """Return (role, name) of a name in a certificate, ('', '') if it is none."""
    found = _NAME.match(owner)
    return (found.group(1), found.group(2)) if found else ('', '')


def called(owner: str) -> str:
    """Return what people call it: "lab" of ``host:lab.2``."""
    return split(owner)[1] or owner


def is_host(owner: str) -> bool:
    """Tell whether a name is that of an operator's computer."""
    return split(owner)[0] in (DRIVES, WATCHES)


def may_drive(owner: str) -> bool:
    """Tell whether a computer of this name may command a robot."""
    return split(owner)[0] == DRIVES


def host_of(computer: str) -> str:
    """Return the name of a host without a key, from that of its computer."""
    return '{}:{}'.format(DRIVES, _ODD.sub('_', computer.partition('.')[0])[:40] or 'unknown')


def read_lists(own: str, peers: str, withdrawn: str, signed: str) -> Keys:
    """Return the keys that lists tell of.

    :param peers: a name on each line
    :param withdrawn: a serial number and a name on each line
    :param signed: what ``openssl crl -text`` says of the signed list
    :raises KeysError: the lists do not belong together
    """
    rows = [line.split() for line in withdrawn.splitlines() if line.strip()]
    if any(len(row) != 2 for row in rows):
        raise KeysError('the list of those withdrawn cannot be read: put the key in place again')
    if {row[0].lower() for row in rows} != {
            serial.lower() for serial in _SERIAL.findall(signed)}:
        raise KeysError('the list of those withdrawn is not the one that the authority signed: put '
                        'the key in place again')
    return Keys(own, frozenset(peers.split()), frozenset(row[1] for row in rows))


def check_own(keys: Keys, side: str, robot: str) -> None:
    """Refuse a key that is not for this end of a link.

    :param side: ``robot`` or ``host``
    :raises KeysError: it is somebody else's, or withdrawn
    """
    role, name = split(keys.own)
    if keys.own in keys.withdrawn:
        raise KeysError('the key of {} is withdrawn: make another one'.format(keys.own))
    if side == 'host' and role not in (DRIVES, WATCHES):
        raise KeysError('the key in place is that of {}, and this is a host: put one in place that '
                        '"mhri_keys.sh host NAME" made'.format(keys.own))
    if side == 'robot' and (role not in (ROBOT, WATCHED) or name != robot):
        raise KeysError('the key in place is that of {}, and this is the robot {}: put one in '
                        'place that "mhri_keys.sh robot {}" made'.format(keys.own, robot, robot))


def partners(keys: Keys, side: str, robot: str) -> List[str]:
    """Return the names that are let in at this end of a robot's link, in order."""
    wanted = (DRIVES, WATCHES) if side == 'robot' else (ROBOT, WATCHED)
    return sorted(owner for owner in keys.peers - keys.withdrawn
                  if split(owner)[0] in wanted and (side == 'robot' or split(owner)[1] == robot))


def access(keys: Keys, side: str, robot: str) -> Dict[str, object]:
    """Return zenoh's ``access_control``: each partner on its own keys, all else refused.

    A host speaks and hears below ``mhri/<robot>/<its name>`` alone, so the name in a key is that of
    the certificate. One that may only watch says what it wants to see, and nothing else.
    """
    rules: List[Dict[str, object]] = []
    subjects: List[Dict[str, object]] = []
    policies: List[Dict[str, object]] = []

    def allow(owner: str, flow: str, messages: Sequence[str], keys_of: Iterable[str]) -> None:
        rules.append({'id': 'rule{}'.format(len(rules)), 'permission': 'allow', 'flows': [flow],
                      'messages': list(messages), 'key_exprs': list(keys_of)})
        policies.append({'rules': [rules[-1]['id']], 'subjects': [owner]})

    coming, going = ('down', 'up') if side == 'robot' else ('up', 'down')
    for owner in partners(keys, side, robot):
        subjects.append({'id': owner, 'cert_common_names': [owner]})
        root = 'mhri/{}/{}/'.format(robot, owner if side == 'robot' else keys.own)
        silent = side == 'robot' and not (may_drive(owner) and split(keys.own)[0] == ROBOT)
        said = root + coming + ('/_beat' if silent else '/**')
        allow(owner, 'ingress', ['put'], [said])
        allow(owner, 'egress', ['put'], [root + going + '/**'])
        # By the beats a robot finds out who is there; every host may know that it wants them.
        beats = 'mhri/{}/*/down/_beat'.format(robot)
        allow(owner, 'ingress', ['declare_subscriber'], [root + going + '/**', beats])
        allow(owner, 'egress', ['declare_subscriber'], [root + coming + '/**', beats])
    return {'enabled': True, 'default_permission': 'deny', 'rules': rules, 'subjects': subjects,
            'policies': policies}


def endpoint(text: str, secret: bool) -> str:
    """Return an endpoint with its protocol, ``tls`` or ``tcp`` where it says none."""
    return text if '/' in text or not text else ('tls/' if secret else 'tcp/') + text
