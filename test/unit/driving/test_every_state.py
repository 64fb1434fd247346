# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every state of the real ``Drive`` within a bound keeps what the contract demands.

MHRI_EVERY_STATE is the number of states for each scene (default: a short look at each). What was
searched is printed: states, transitions, depth. A violation comes with its shortest list of events.
"""
import collections
import os

from support.driving_packing import Packing
from mhri.driving import arbiter, robot_rule
from support.every_state import Search, Violation

WHOLE = 11500
MOST = int(os.environ.get('MHRI_EVERY_STATE', WHOLE))
# The least of the whole short form.
LEAST = 100000
DRIVING = ('wait 1', 'wish a ', 'wish a gp', 'stick a rest', 'stick a out', 'wait 1')
PADDING = ('wait 1', 'wish a ', 'wish a gp', 'mode a pad', 'stick pedal out', 'stick pad free',
           'stick pad rest', 'wait 1', 'stick pad out', 'wait 1')
QUIET = DRIVING + ('stick a rest', 'wait 1', 'stick a off', 'wait 11')
RESTING = DRIVING + ('stick a rest', 'mode a pad')
ON_TASK = ('wait 1', 'wish a ', 'stick a rest', 'task gp', 'wait 1', 'task gp')
STOPPED = DRIVING + ('stop -', 'stick a rest', 'wait 1')
SEEING = ('wait 1', 'wish a ', 'wish a gp', 'scan free', 'stick a rest', 'stick a out', 'wait 1')
PROVING = DRIVING + ('odometry live', 'wait 1', 'stop -')
FLIPPING = DRIVING + ('stick a rest', 'wait 11', 'tool hold', 'wait 1')
STICK = ('stick a rest', 'stick a out', 'stick a off')
WAITS = ('wait 1', 'wait 6', 'wait 11')


# What can happen in one search, and the ways to where it begins.
Scene = collections.namedtuple('Scene', 'options ways events')

SCENES = {
    'operators': Scene((), ((), DRIVING, DRIVING + ('wish b gp', 'gone a', 'wait 32')), (
        *STICK, *WAITS, 'wait 32', 'wish a gp', 'wish a p', 'wish b gp', 'take a', 'take b',
        'mute a', 'latch a', 'latch b', 'gone a', 'again a', 'old a', 'stick b out',
        'stick b rest', 'mode b pad', 'restart -')),
    'stops': Scene((), ((), DRIVING, QUIET, STOPPED), (
        *STICK, *WAITS, 'wish a gp', 'wish a p', 'wish a ', 'take b', 'wish b gp', 'stop -',
        'release -', 'button a', 'alone p', 'alone g', 'restart -', 'hang tick', 'hang say')),
    'sources': Scene(('enabling',), ((), PADDING), (
        *WAITS, 'stick pad free', 'stick pad rest', 'stick pad out', 'stick pad loose',
        'stick pad off', 'stick pedal out', 'stick pedal rest', 'stick pedal off', 'plug -',
        'swap -', 'mode a joy', 'mode a pad', 'stick a rest', 'stick a out', 'wish a p',
        'wish a gp', 'task p', 'hang tick')),
    'velocities': Scene(('twist', 'automatic'), ((), DRIVING, RESTING), (
        *STICK, *WAITS, 'stick pad free', 'stick pad rest', 'stick pad out', 'swap -',
        'mode a joy', 'mode a pad', 'stop -', 'release -', 'gone a', 'wish a gp', 'take b',
        'hang say', 'hold master')),
    'robots': Scene((), ((), DRIVING, ON_TASK), (
        *STICK, *WAITS, 'wish a gp', 'wish a g', 'wish a ', 'task gp', 'task p', 'task', 'alone p',
        'stop -', 'release -', 'join p', 'take b', 'wish b gp', 'twins p 1', 'twins p 0',
        'reopen p 1', 'reopen p 0', 'reopen g 0',
        'wall 1', 'wall 0', 'undertaker 0', 'undertaker 1')),
    'link': Scene((), ((), DRIVING, STOPPED, DRIVING + ('cut g', 'wait 1')), (
        *STICK, *WAITS, 'wish a gp', 'stop -', 'release -', 'cut g', 'mend g', 'deliver g',
        'deliver g twice', 'deliver g lost', 'repeat -', 'cut p', 'mend p', 'deliver p',
        'guard killed', 'guard started', 'foreign -', 'restart -', 'hang tick')),
    'laser': Scene(('eye',), ((), SEEING, SEEING + ('scan wall', 'wait 1')), (
        *STICK, *WAITS, 'scan free', 'scan wall', 'scan dead', 'scan nothing', 'scan off',
        'jump -', 'brake a', 'wish a gp', 'wish a g', 'wish b gp', 'take b', 'reopen p 0', 'stop -',
        'release -', 'restart -', 'hang tick')),
    'proof': Scene(('proof',), ((), DRIVING, PROVING, PROVING + ('wait 6', 'cut p')), (
        *STICK, *WAITS, 'wish a gp', 'stop -', 'release -', 'odometry live', 'odometry off',
        'odometry old', 'odometry none', 'cut p', 'mend p', 'deliver p', 'restart -')),
    'tools': Scene(('tool',), ((), FLIPPING, FLIPPING + ('stop -', 'release -')), (
        *STICK, *WAITS, 'wait 32', 'tool hold', 'tool rest', 'tool off', 'wish a gp', 'wish a g',
        'stop -', 'release -', 'button a', 'alone p', 'take b', 'take a', 'wish b gp', 'mute a',
        'gone a', 'undertaker 0', 'undertaker 1', 'hold master', 'hang tick', 'hang say',
        'restart -', 'twins p 1', 'twins p 0', 'reopen p 0', 'task p')),
}
# Each has to be all that keeps a robot from moving in some state, or be asked at some event.
PREMISES = {
    'stop-all', 'stopped alone', 'no undertaker', 'not selected', 'no lease', 'a silent source',
    'at rest', 'neutral first', 'the pedal', 'the brake', 'not reachable', 'moves',
    'a task that may not', 'a limit that rises', 'the word of an older drive', 'a stale command',
    'released with the stick out', 'a mode of another', 'a seat that was not free',
    'the seat is left at once', 'the seat is never left', 'a setting of another',
    'a stop that ends by itself', 'a latched stop', 'a stop that is not latched', 'a dead sensor',
    'stopped without newer odometry', 'a flipper moves'} | {'a flipper: ' + what for what in (
        'stop-all', 'stopped alone', 'no undertaker', 'not selected', 'no lease', 'not reachable',
        'not in control', 'released first', 'silent')}


def search(name, most, premises, look=lambda world, way: None, ways=()):
    """Search a scene, from its own ways or others; return the search."""
    options, own, events = SCENES[name]
    packing = Packing(frozenset(options), premises)
    found = Search(packing.fresh, packing.load, packing.pack, events, ways or own)
    found.run(most, look, every=40)
    return found


def recovers(world, way):
    """No state is a dead end."""
    try:
        problem = '' if world.recovers() else 'a dead end'
    except Violation as found:
        problem = 'on the way back: {}'.format(found)
    if problem:
        raise Violation('{}; after: {}'.format(problem, ', '.join(way())))


class Counted(dict):
    """A table that counts the rows that are taken."""

    def __init__(self, rows):
        super().__init__(rows)
        self.taken = collections.Counter()

    def get(self, key, default=None):
        self.taken[key] += key in self
        return super().get(key, default)

    def __getitem__(self, key):
        self.taken[key] += 1
        return super().__getitem__(key)


def test_every_state(monkeypatch):
    premises, taken, states = collections.Counter(), collections.Counter(), 0
    tables = Counted(arbiter.TRANSITIONS), Counted(robot_rule.ZERO_ON_ENTRY)
    monkeypatch.setattr(arbiter, 'TRANSITIONS', tables[0])
    monkeypatch.setattr(robot_rule, 'ZERO_ON_ENTRY', tables[1])

    def counted(state, holds):
        return state, lambda rule, now: holds(rule, now) and not taken.update((state,))
    monkeypatch.setattr(robot_rule, 'PRECEDENCE', tuple(
        counted(*row) for row in robot_rule.PRECEDENCE))
    for name in SCENES:
        found = search(name, MOST, premises, recovers)
        states += found.states
        print('{}: {} states, {} transitions, depth {} behind {} ways'.format(
            name, found.states, found.transitions, found.depth, len(SCENES[name].ways)))
    print('{} states; {}'.format(states, dict(premises)))
    assert states >= min(LEAST, MOST * len(SCENES))
    if MOST < WHOLE:
        return  # the quick look of test/mutants.py: too short to meet everything
    assert set(tables[0]) - set(tables[0].taken) == set()
    # A task begins by its own command, which looks into no table.
    assert set(tables[1]) - set(tables[1].taken) == {robot_rule.TASK}
    assert set(robot_rule.STATES) - set(taken) == set()
    assert PREMISES - set(+premises) == set()
