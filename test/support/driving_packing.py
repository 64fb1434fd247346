# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Worlds of the drive as numbers: which of their attributes are times, and which no state."""
from collections import deque, OrderedDict
import copy
import math

from mhri.base.limits import ZERO
from mhri.robots.stop_proof import PoseWatch
from mhri.sensors.brake import Unplaced
from mhri.sensors.readings import FELL_FROM, FELL_WITHIN_S
from support.driving_contract import (
    ANSWER_S, ENABLING_S, LEASE_S, LOOK_S, LOST_S, ODOMETRY_S, READINGS, RETURN_S, STALE_S, STEP_S,
    TASK_STALE_S)
from support.driving_senses import HERE, OLD_S, RADIUS_M
from support.driving_tools import SILENT_S
from support.driving_world import World
from support.every_state import Shape


def normalise(world):
    """Give tokens and numbers of commands the least names, and queues the time from now."""
    entries = [world.last_command, *world.queue['g']]
    ids = [entry[0].split(':') for entry in entries if entry and entry[0]]
    guard, link = world.guard, world.link
    used = {token for _, _, token in ids} | {link.token}
    young = [token for token, at in guard._issued.items()
             if token in used and world.now - at < ANSWER_S]
    names = {token: '{}-{:x}'.format(guard._run, rank + 1) for rank, token in enumerate(young)}
    guard._issued = OrderedDict((names[token], guard._issued[token]) for token in young)
    guard._count = len(young)
    link._token = names.get(link.token, 'old') if link.token else ''
    numbers = {}
    for session, number, _ in ids + [(link._session, link._number, ''),
                                     (link._session, link._stop_number, ''),
                                     (guard._session, guard._number, '')]:
        numbers.setdefault(session.rstrip('!'), set()).add(int(number))
    ranks = {(session, number): rank for session, found in numbers.items()
             for rank, number in enumerate(sorted(found))}
    link._number, link._stop_number = (
        ranks[link._session, number] for number in (link._number, link._stop_number))
    guard._number = ranks[guard._session, guard._number]
    link.obeyed_number = min(link.obeyed_number, 1)

    def again(entry):
        frame_id, velocity, sent = entry
        if frame_id:
            session, number, token = frame_id.split(':')
            frame_id = '{}:{}:{}'.format(session, ranks[session.rstrip('!'), int(number)],
                                         names.get(token, 'old'))
        return frame_id, velocity, round(max(-ANSWER_S, sent - world.now), 3)
    world.last_command = world.last_command and again(world.last_command)
    world.queue = {name: tuple(map(again, queue)) for name, queue in world.queue.items()}
    proof = world.proof
    proof._run = min(proof._run, READINGS)
    proof.stopped_ms = None if proof.stopped_ms is None else 0.0


class SightShape:
    """What a brake has seen with its one laser, as numbers, like a Shape."""

    def __init__(self):
        self._numbers, self._forms = {}, []

    def pack(self, seen, now):
        """Return the number of what was seen."""
        life, newest = seen._lives.get(''), seen._newest.get('')
        past = list(life._past) if life else []
        # The newest that measured enough, and the newest of all, tell whether the laser lives.
        past = [entry for entry in past if entry[1] >= FELL_FROM][-1:] + past[-1:]
        times = tuple([(round(max(at - now, -FELL_WITHIN_S - STEP_S), 3), share)
                       for at, share, _ in past])
        form = (newest and newest.scan.looks_anywhere, seen._clear[1], len(seen._met), seen._fresh,
                life and life._alive, times)
        if form not in self._numbers:
            self._numbers[form] = len(self._forms)
            self._forms.append((seen, life, times))
        return self._numbers[form]

    def unpack(self, number):
        """Return what was seen; the time is 0."""
        seen, life, times = self._forms[number]
        again = copy.copy(seen)
        again._newest, again._lives = dict(seen._newest), {}
        if life:
            again._lives[''] = lives = copy.copy(life)
            lives._past = deque((at, share, HERE) for at, share in times)
        return again


class Packing:
    """Worlds as numbers, and back; see :class:`support.every_state.Shape`."""

    def __init__(self, options, premises):
        self._options, self._premises = options, premises
        world = self.fresh()
        drive = world.drive
        self._config = world.config
        kinds = (
            (world, {'wish_at': LEASE_S, 'gone_at': RETURN_S + STEP_S, 'deaf_until': 0.0,
                     'enabled_at': ENABLING_S, 'heard': STALE_S, 'late': LOST_S + 4.0 * STEP_S,
                     'task_at': TASK_STALE_S, 'cut_at': LOST_S,
                     'guard_gone_at': LOST_S + 2.0 * STEP_S, 'saw_at': LOOK_S, 'proof_at': OLD_S,
                     'read_at': ODOMETRY_S, 'tool_at': SILENT_S, 'tool_late': STEP_S},
             {'now': 0.0, 'options': options, 'premises': premises, 'config': world.config,
              'drive': None, 'link': None, 'guard': None, 'live': None, 'rule_g': None,
              'tasking': False, 'eye': None, 'proof': None,
              'tools': world.tools}),
            (drive, {}, {name: vars(drive)[name] for name in (
                'arbiter', '_sources', '_owners', '_pulse', 'lease', '_driven', 'relay',
                '_buttons', '_settings', '_alone', 'accessories', '_on_refused',
                '_connected', '_rules', 'said', 'share', 'wishes', 'changes')}),
            (drive.arbiter, {'_stick_at': STALE_S, '_enabled_at': ENABLING_S, '_zeros_until': 0.0,
                             '_next_repeat': 0.0},
             {name: vars(drive.arbiter)[name] for name in (
                 '_sources', '_enabling', '_automatic', 'refused', 'ignored', '_cause')}),
            (drive._pulse, {'_beat_at': 0.5, '_deaf_until': 0.0}, {}),
            (drive.lease, {'_repeated_at': LEASE_S, '_empty_at': 0.0}, {'since': 0.0}),
            (drive._driven, {}, {}),
            (drive.relay, {}, {'refused': drive.relay.refused, 'held': drive.relay.held}),
            (drive._buttons, {}, {}),
            (drive._settings, {}, {}),
            (drive._alone, {}, {}),
            *((owner, {}, {}) for owner in drive._owners.values()),
            *((rule, {'_task_at': TASK_STALE_S, '_zeros_until': 0.0, '_zero_at': STEP_S},
               {'_share': 1.0, '_brake': None}) for rule in drive.robots.values()),
            (drive.accessories, {'_refused_at': SILENT_S},
             {name: None for name in ('_robots', '_authority', '_rules')}),
            *((rule, {'_asked_at': SILENT_S, '_sent_at': SILENT_S}, {'spec': rule.spec})
              for rule in drive.accessories.of('p').values()),
            (world.link, {'_echo_at': 0.35}, {}),
            (world.guard, {'_until': 0.0, '_issued': ANSWER_S},
             {'_lease_s': 0.3, '_answer_s': 1.0, '_left_at': -math.inf, '_given_at': -math.inf,
              'dropped': 0}),
            (world.live, {}, {}),
            (world.eye, {'_scan_at': LOOK_S},
             {'_radius_m': RADIUS_M, '_has_eye': True, '_seen': None, '_unplaced': Unplaced(),
              '_pose': HERE, '_wanted': ZERO, '_slowed_at': -math.inf, '_unseen': False}),
            (world.proof, {'_begun': 2.0 + STEP_S, '_counts_from': OLD_S + STEP_S,
                           '_measured': OLD_S + STEP_S, '_run_began': 0.1},
             {'_silent_after_s': ODOMETRY_S, '_heard': 0.0, '_pose': PoseWatch(), '_crept': '',
              '_crept_at': -math.inf}))
        self._shapes = [Shape(*kind) for kind in kinds] + [SightShape()]
        self._sources = list(drive._owners)

    def fresh(self):
        """Return a world at the beginning."""
        return World(self._options, self._premises)

    def pack(self, world):
        """Return a world as numbers; it is of no more use."""
        normalise(world)
        drive = world.drive
        parts = (world, drive, drive.arbiter, drive._pulse, drive.lease, drive._driven,
                 drive.relay, drive._buttons, drive._settings, drive._alone,
                 *drive._owners.values(),
                 drive.robots['g'], drive.robots['p'],
                 drive.accessories, *drive.accessories.of('p').values(),
                 world.link, world.guard, world.live, world.eye, world.proof, world.eye._seen)
        return [shape.pack(part, world.now) for shape, part in zip(self._shapes, parts)]

    def load(self, numbers):
        """Return the world of some numbers; the time is 0."""
        parts = [shape.unpack(number) for shape, number in zip(self._shapes, numbers)]
        world, drive, drive.arbiter, drive._pulse, drive.lease, drive._driven, drive.relay, \
            drive._buttons, drive._settings, drive._alone = parts[:10]
        *rest, world.link, world.guard, world.live, world.eye, world.proof, seen = parts[10:]
        owners, (rule_g, rule_p, drive.accessories, *tools) = (
            rest[:len(self._sources)], rest[len(self._sources):])
        world.eye._seen = seen
        drive._owners = dict(zip(self._sources, owners))
        drive._rules, world.rule_g = {'g': rule_g, 'p': rule_p}, rule_g
        vars(drive.accessories).update(
            _robots=drive._rules, _authority=drive._authority,
            _rules={'g': {}, 'p': {rule.spec.key: rule for rule in tools}})
        drive._connected, world.drive = world._connected, drive
        rule_g._brake, rule_p._brake = world._brake, world.allow
        return world
