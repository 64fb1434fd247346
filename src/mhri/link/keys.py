# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rights of each key on the link: names in certificates, and zenoh's access rules for them.

The names are those of :mod:`mhri.robots.owners`; ``utils/host/mhri_keys.sh`` creates the
certificates. A link without keys uses the same names.
"""
from dataclasses import dataclass
from datetime import datetime, timezone
import re
from typing import Dict, FrozenSet, Iterable, List, Sequence, Tuple

from mhri.link.sealed import OFFER
from mhri.robots.owners import DRIVES, is_host, may_drive, ROBOT, ROUTER, split, WATCHED, WATCHES

_ODD = re.compile(r'[^A-Za-z0-9_-]')
# Endpoints that are only reachable from this computer.
_HERE = re.compile(r'([a-z]+/)?(127\.[0-9.]+|localhost|\[::1\]):[0-9]+\Z')
_SERIAL = re.compile(r'^\s*Serial Number:\s*([0-9A-Fa-f]+)\s*$', re.MULTILINE)
# Streams that a watching host may send: its beats, and its key for datagrams.
LITTLE = ('_beat', OFFER)


# Causes of a KeysError.
MISSING, EXPIRED, EARLY, WRONG = 'missing', 'expired', 'early', 'wrong'


class KeysError(Exception):
    """Unusable keys; the text names the problem and the remedy.

    :param cause: MISSING, EXPIRED, EARLY (not valid yet) or WRONG
    """

    def __init__(self, text: str, cause: str = WRONG) -> None:
        super().__init__(text)
        self.cause = cause


@dataclass(frozen=True)
class Keys:
    """The keys in use.

    :param own: name in the own certificate
    :param peers: names that have a key
    :param withdrawn: names whose keys are withdrawn
    :param ends: (name, expiry of one of its certificates [s since 1970]) if known
    """

    own: str
    peers: FrozenSet[str] = frozenset()
    withdrawn: FrozenSet[str] = frozenset()
    ends: FrozenSet[Tuple[str, float]] = frozenset()

    def ended(self, since: float, now: float) -> FrozenSet[str]:
        """Return the names with a certificate that expired between two times [s since 1970]."""
        return frozenset(owner for owner, end in self.ends if since < end <= now)


def says_all(robot: str, host: str) -> bool:
    """Return whether a host may send everything to a robot, by the names in their keys."""
    return may_drive(host) and split(robot)[0] == ROBOT


def host_of(computer: str) -> str:
    """Return the name of a host without a key, derived from its computer's name."""
    return '{}:{}'.format(DRIVES, _ODD.sub('_', computer.partition('.')[0])[:40] or 'unknown')


def read_lists(own: str, peers: str, withdrawn: str, signed: str) -> Keys:
    """Return the keys described by lists.

    :param peers: lines of a name and the expiry of its certificate in X.509 format; without
        expiry from an older mhri
    :param withdrawn: lines of a serial number and a name
    :param signed: output of ``openssl crl -text`` for the signed list
    :raises KeysError: the lists contradict each other
    """
    rows = [line.split() for line in withdrawn.splitlines() if line.strip()]
    if any(len(row) != 2 for row in rows):
        raise KeysError('the list of withdrawn keys cannot be read: put the key in place again')
    if {row[0].lower() for row in rows} != {
            serial.lower() for serial in _SERIAL.findall(signed)}:
        raise KeysError('the list of withdrawn keys is not the one that the authority signed: put '
                        'the key in place again')
    known = [line.split() for line in peers.splitlines() if line.strip()]
    return Keys(own, frozenset(row[0] for row in known), frozenset(row[1] for row in rows),
                frozenset((row[0], _moment(row[1])) for row in known if row[1:]))


def _moment(text: str) -> float:
    """Return a time in X.509 format (RFC 5280, 4.1.2.5) as s since 1970.

    :raises KeysError: it is malformed
    """
    try:
        found = datetime.strptime(text, '%y%m%d%H%M%SZ' if len(text) == 13 else '%Y%m%d%H%M%SZ')
    except ValueError:
        raise KeysError('the list of keys cannot be read: put the key in place '
                        'again') from None
    return found.replace(tzinfo=timezone.utc).timestamp()


def is_of(owner: str, robot: str, host: str) -> bool:
    """Return whether a name belongs to an end of the link between a robot and a host."""
    role, name = split(owner)
    return owner == host or role in (ROBOT, WATCHED) and name == robot


def check_own(keys: Keys, side: str, robot: str) -> None:
    """Reject a key for another end of a link.

    :param side: ``robot``, ``host`` or ``router``
    :raises KeysError: it belongs to another end, or is withdrawn
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
    """Return the names admitted at this end of a robot's link, sorted."""
    kinds = (DRIVES, WATCHES) if side == 'robot' else (ROBOT, WATCHED)
    return sorted(owner for owner in keys.peers - keys.withdrawn
                  if split(owner)[0] in kinds and (side == 'robot' or split(owner)[1] == robot))


def routers(keys: Keys) -> List[str]:
    """Return the names of the routers with a key, sorted."""
    return sorted(owner for owner in keys.peers - keys.withdrawn if split(owner)[0] == ROUTER)


def access(keys: Keys, side: str, robot: str, routed: bool = False) -> Dict[str, object]:
    """Return zenoh's ``access_control``: each partner on its own key expressions, nothing else.

    A host sends and receives only below ``mhri/<robot>/<its name>``, so the name in a key
    expression is that of the certificate. A watching host may only send :data:`LITTLE`.

    :param routed: whether all traffic comes through a router: zenoh then only sees the
        certificate of the router, which enforces that each peer uses its own name
    """
    coming, going = ('down', 'up') if side == 'robot' else ('up', 'down')
    known = partners(keys, side, robot)
    table = _Table(routers(keys) if routed else known, routers(keys) if routed else ())
    # A robot discovers hosts by their beats; this subscription may be visible to every host.
    beats = 'mhri/{}/*/down/_beat'.format(robot)
    for owner in known:
        root = 'mhri/{}/{}/'.format(robot, owner if side == 'robot' else keys.own)
        streams = ('**',) if side == 'host' or says_all(keys.own, owner) else LITTLE
        table.allow(owner, ['{}{}/{}'.format(root, coming, stream) for stream in streams],
                    root + going + '/**', [root + going + '/**', beats],
                    [root + coming + '/**', beats])
    return table.settings()


def access_of_router(keys: Keys) -> Dict[str, object]:
    """Return zenoh's ``access_control`` of a router: each peer on its own key expressions only."""
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
    """Builds zenoh's rules.

    :param subjects: names in the certificates of the callers
    :param instead: routers whose certificates represent all peers; () without a router
    """

    def __init__(self, subjects: Iterable[str], instead: Sequence[str] = ()) -> None:
        self._subjects = [{'id': owner, 'cert_common_names': [owner]} for owner in subjects]
        self._instead = list(instead)
        self._rules: List[Dict[str, object]] = []
        self._policies: List[Dict[str, object]] = []

    def allow(self, owner: str, says: List[str], gets: str, subscribes: List[str],
              asked: List[str]) -> None:
        """Allow a peer to send, receive, subscribe, and be subscribed."""
        for flow, message, on in (
                ('ingress', 'put', says), ('egress', 'put', [gets]),
                ('ingress', 'declare_subscriber', subscribes),
                ('egress', 'declare_subscriber', asked)):
            self._rules.append({'id': 'rule{}'.format(len(self._rules)), 'permission': 'allow',
                                'flows': [flow], 'messages': [message], 'key_exprs': on})
            self._policies.append({'rules': [self._rules[-1]['id']],
                                   'subjects': self._instead or [owner]})

    def settings(self) -> Dict[str, object]:
        """Return zenoh's ``access_control``."""
        return {'enabled': True, 'default_permission': 'deny', 'rules': self._rules,
                'subjects': self._subjects, 'policies': self._policies}


def check_open(ends: Iterable[str]) -> None:
    """Refuse to link without keys where another computer could drive, or pass for the robot.

    With ``--keys off`` this is not checked.

    :param ends: endpoints to listen on, and to connect to
    :raises KeysError: an endpoint is not only of this computer; the text names it and the remedy
    """
    for end in ends:
        if not _HERE.match(end):
            raise KeysError(
                'there is no key in place, and anybody on the network of {} could drive: make keys '
                '(mhri_keys.sh, five minutes), or, if you trust that network, say --keys off '
                '(keys:=off to a launch file)'.format(end), MISSING)


def protocol_of(secret: bool) -> str:
    """Return the protocol of a link with keys, or without."""
    return 'tls' if secret else 'tcp'


def endpoint(text: str, secret: bool) -> str:
    """Return an endpoint with a protocol, by default that of :func:`protocol_of`."""
    return text if '/' in text or not text else protocol_of(secret) + '/' + text
