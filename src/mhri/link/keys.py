# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whose key may do what on the link: the names in certificates, and zenoh's rules made of them.

The names are those of :mod:`mhri.robots.owners`; ``utils/host/mhri_keys.sh`` makes the
certificates. The same names say who speaks on a link without keys.
"""
from dataclasses import dataclass
from datetime import datetime, timezone
import hashlib
import re
from typing import Dict, FrozenSet, Iterable, List, Sequence, Tuple

from mhri.link.sealed import OFFER
from mhri.robots.owners import DRIVES, is_host, may_drive, ROBOT, ROUTER, split, WATCHED, WATCHES

_ODD = re.compile(r'[^A-Za-z0-9_-]')
# An endpoint that nobody outside this computer reaches.
_HERE = re.compile(r'([a-z]+/)?(127\.[0-9.]+|localhost|\[::1\]):[0-9]+\Z')
_SERIAL = re.compile(r'^\s*Serial Number:\s*([0-9A-Fa-f]+)\s*$', re.MULTILINE)
ALONE, TLS = ('tcp', 'udp'), ('tls', 'quic')
# What who may only watch says: that it is there, and its key for datagrams.
LITTLE = ('_beat', OFFER)


class KeysError(Exception):
    """Keys that cannot be used; says what is wrong, and the remedy."""


@dataclass(frozen=True)
class Keys:
    """What is in place.

    :param own: the name in the own certificate
    :param peers: names of those who have a key
    :param withdrawn: names whose keys were taken back
    :param ends: (a name of those, when one of its certificates runs out [s since 1970]), as far as
        that is known
    """

    own: str
    peers: FrozenSet[str] = frozenset()
    withdrawn: FrozenSet[str] = frozenset()
    ends: FrozenSet[Tuple[str, float]] = frozenset()

    def ended(self, since: float, now: float) -> FrozenSet[str]:
        """Return the names that have a certificate which ran out in between [s since 1970]."""
        return frozenset(owner for owner, end in self.ends if since < end <= now)


def says_all(robot: str, host: str) -> bool:
    """Tell whether a host may say all to a robot, by the names in their keys, or :data:`LITTLE`."""
    return may_drive(host) and split(robot)[0] == ROBOT


def host_of(computer: str) -> str:
    """Return the name of a host without a key, from that of its computer."""
    return '{}:{}'.format(DRIVES, _ODD.sub('_', computer.partition('.')[0])[:40] or 'unknown')


def marked(host: str, facts: Iterable[str]) -> str:
    """Return the name of a host without a key, with a mark; as it is if it has one.

    :param facts: of its computer, such as no other one has
    """
    if '.' in host:
        return host
    text = '\n'.join(facts).encode('utf-8', 'replace')
    return '{}.x{}'.format(host, hashlib.sha256(text).hexdigest()[:8])


def read_lists(own: str, peers: str, withdrawn: str, signed: str) -> Keys:
    """Return the keys that lists tell of.

    :param peers: on each line a name and when its certificate runs out, as X.509 writes that; that
        of an older mhri has names alone
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
    known = [line.split() for line in peers.splitlines() if line.strip()]
    return Keys(own, frozenset(row[0] for row in known), frozenset(row[1] for row in rows),
                frozenset((row[0], _moment(row[1])) for row in known if row[1:]))


def _moment(text: str) -> float:
    """Return the time of X.509 (RFC 5280, 4.1.2.5) in words as s since 1970.

    :raises KeysError: it is none
    """
    try:
        found = datetime.strptime(text, '%y%m%d%H%M%SZ' if len(text) == 13 else '%Y%m%d%H%M%SZ')
    except ValueError:
        raise KeysError('the list of those who have a key cannot be read: put the key in place '
                        'again') from None
    return found.replace(tzinfo=timezone.utc).timestamp()


def is_of(owner: str, robot: str, host: str) -> bool:
    """Tell whether a name in a certificate is that of one end of a robot's link with a host."""
    role, name = split(owner)
    return owner == host or role in (ROBOT, WATCHED) and name == robot


def check_own(keys: Keys, side: str, robot: str) -> None:
    """Refuse a key that is not for this end of a link.

    :param side: ``robot``, ``host`` or ``router``
    :raises KeysError: it is somebody else's, or withdrawn
    """
    role, name = split(keys.own)
    if keys.own in keys.withdrawn:
        raise KeysError('the key of {} is withdrawn: make another one'.format(keys.own))
    if side == 'host' and role not in (DRIVES, WATCHES):
        raise KeysError('the key in place is that of {}, and this is a host: put one in place that '
                        '"mhri_keys.sh host NAME" made'.format(keys.own))
    if side == 'router' and role != ROUTER:
        raise KeysError('the key in place is that of {}, and this is a router: put one in place '
                        'that "mhri_keys.sh router NAME" made'.format(keys.own))
    if side == 'robot' and (role not in (ROBOT, WATCHED) or name != robot):
        raise KeysError('the key in place is that of {}, and this is the robot {}: put one in '
                        'place that "mhri_keys.sh robot {}" made'.format(keys.own, robot, robot))


def partners(keys: Keys, side: str, robot: str) -> List[str]:
    """Return the names that are let in at this end of a robot's link, in order."""
    wanted = (DRIVES, WATCHES) if side == 'robot' else (ROBOT, WATCHED)
    return sorted(owner for owner in keys.peers - keys.withdrawn
                  if split(owner)[0] in wanted and (side == 'robot' or split(owner)[1] == robot))


def routers(keys: Keys) -> List[str]:
    """Return the names of the routers that have a key, in order."""
    return sorted(owner for owner in keys.peers - keys.withdrawn if split(owner)[0] == ROUTER)


def access(keys: Keys, side: str, robot: str, routed: bool = False) -> Dict[str, object]:
    """Return zenoh's ``access_control``: each partner on its own keys, all else refused.

    A host speaks and hears below ``mhri/<robot>/<its name>`` alone, so the name in a key is that of
    the certificate. One that may only watch says what it wants to see, and nothing else.

    :param routed: all comes through a router, so its certificate is the only one that zenoh sees
        here; it has to be of one with a key, and sees to it that everybody uses the own name
    """
    coming, going = ('down', 'up') if side == 'robot' else ('up', 'down')
    known = partners(keys, side, robot)
    table = _Table(routers(keys) if routed else known, routers(keys) if routed else ())
    # By the beats a robot finds out who is there; every host may know that it wants them.
    beats = 'mhri/{}/*/down/_beat'.format(robot)
    for owner in known:
        root = 'mhri/{}/{}/'.format(robot, owner if side == 'robot' else keys.own)
        streams = ('**',) if side == 'host' or says_all(keys.own, owner) else LITTLE
        table.allow(owner, ['{}{}/{}'.format(root, coming, stream) for stream in streams],
                    root + going + '/**', [root + going + '/**', beats],
                    [root + coming + '/**', beats])
    return table.settings()


def access_of_router(keys: Keys) -> Dict[str, object]:
    """Return zenoh's ``access_control`` of a router: each on its own keys, all else refused."""
    known = sorted(owner for owner in keys.peers - keys.withdrawn if split(owner)[0] != ROUTER)
    table = _Table(known)
    for owner in known:
        role, name = split(owner)
        beats = 'mhri/{}/*/down/_beat'.format('*' if is_host(owner) else name)
        if is_host(owner):
            up, down = 'mhri/*/{}/up/**'.format(owner), 'mhri/*/{}/down/'.format(owner)
            table.allow(owner, [down + ('**' if role == DRIVES else '_beat')], up, [up, beats],
                        [down + '**', beats])
        else:
            up, down = 'mhri/{}/*/up/**'.format(name), 'mhri/{}/*/down/**'.format(name)
            table.allow(owner, [up], down, [down, beats], [up, beats])
    return table.settings()


class _Table:
    """Zenoh's rules, in the making.

    :param subjects: the names in the certificates of those who call
    :param instead: of them, who stands for everybody; () for nobody
    """

    def __init__(self, subjects: Iterable[str], instead: Sequence[str] = ()) -> None:
        self._subjects = [{'id': owner, 'cert_common_names': [owner]} for owner in subjects]
        self._instead = list(instead)
        self._rules: List[Dict[str, object]] = []
        self._policies: List[Dict[str, object]] = []

    def allow(self, owner: str, says: List[str], gets: str, wants: List[str],
              asked: List[str]) -> None:
        """Let somebody say and get messages, want some, and be asked for some."""
        for flow, message, on in (
                ('ingress', 'put', says), ('egress', 'put', [gets]),
                ('ingress', 'declare_subscriber', wants), ('egress', 'declare_subscriber', asked)):
            self._rules.append({'id': 'rule{}'.format(len(self._rules)), 'permission': 'allow',
                                'flows': [flow], 'messages': [message], 'key_exprs': on})
            self._policies.append({'rules': [self._rules[-1]['id']],
                                   'subjects': self._instead or [owner]})

    def settings(self) -> Dict[str, object]:
        """Return zenoh's ``access_control``."""
        return {'enabled': True, 'default_permission': 'deny', 'rules': self._rules,
                'subjects': self._subjects, 'policies': self._policies}


def check_open(listen: Iterable[str]) -> None:
    """Refuse to listen without keys where another computer may call: it could drive the robot.

    Who wants that says ``--keys off``, and is not asked here.

    :param listen: endpoints
    :raises KeysError: names the first that others reach, and the remedy
    """
    for end in listen:
        if not _HERE.match(end):
            raise KeysError(
                'there is no key in place, and whoever reaches {} could drive: make keys '
                '(mhri_keys.sh, five minutes), or say --keys off (keys:=off to a launch '
                'file)'.format(end))


def endpoint(text: str, secret: bool) -> str:
    """Return an endpoint with its protocol, ``tls`` or ``tcp`` where it says none."""
    return text if '/' in text or not text else ('tls/' if secret else 'tcp/') + text
