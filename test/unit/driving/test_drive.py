# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All that decides, in one object: who may drive, what stops robots, what outlives a restart."""
from dataclasses import replace
import json

import pytest

from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits
from mhri.base.sleep_detector import DEAF_S, SLEPT_S
from mhri.devices.profile import Axis, NEXT_ROBOT, Profile, STOP_ALL
from mhri.driving.drive import Drive, LOST
from mhri.driving.operator_lease import Caller, LAPSED, LEASE_S, MAX_ROBOTS, RETURN_S
from mhri.driving.settings import Settings
from mhri.driving.sources import MuxConfig, Source

PROFILE = Profile('stick', Axis(1, 1.0), Axis(0, 1.0))
CONFIG = MuxConfig((Source('joy', 'Stick', '/joy', PROFILE), Source('pad', 'Pad', '/pad', PROFILE)),
                   'joy', 0.5, 1.5)
A, B = (Caller('/' + name, 'http://lab:{}/'.format(port), 'lab')
        for name, port in (('a', 5001), ('b', 5002)))
FORWARD, NEUTRAL = (0.0, 1.0), (0.0, 0.0)
GO, WORK = Velocity(0.5, 0.0), Velocity(0.1, 0.0)
SLOW = Settings(0.2, 1.0, True, False, True)


class Rig:
    """A drive with two robots, the time, and what each robot was sent last."""

    def __init__(self, kept=None, now=100.0, config=CONFIG, **brakes):
        self.now, self.refused, self.sent, self.log = now, [], {}, []
        self.there, self.spoke = [A, B], {'/a', '/b', '/pad_node'}
        self.drive = Drive(config, now, kept, lambda who, what: self.refused.append((who, what)),
                           lambda source: self.spoke)
        for name in ('bot1', 'bot2'):
            self.note(self.drive.open(name, Limits(0.5, 1.0), now, brakes.get(
                name, lambda velocity, _: velocity)))

    def note(self, orders):
        """Note orders; return them, or what is wrong, if that is there as well."""
        orders, problem = orders if isinstance(orders, tuple) else (orders, orders)
        for name, velocity in orders:
            self.sent[name] = velocity
            self.log.append((self.now, name, velocity))
        return problem

    def run(self, seconds, *repeated):
        """Let time pass as the node does; what is repeated is done ten times a second."""
        end, again = self.now + seconds, self.now
        while self.now < end:
            if self.now >= again:
                again += 0.1
                for act in repeated:
                    act()
            self.now = max(self.now + 1e-6, min(end, again, self.drive.next_tick(self.now)))
            self.note(self.drive.tick(self.now, self.there))

    def wish(self, *robots, who=A, settings=(), mode=''):
        """Say a wish; return what is wrong with it."""
        return self.note(self.drive.on_wish(who, robots, list(settings), mode, self.now))

    def stick(self, axes, name='joy', who='/a', **facts):
        """Hold a stick; return what is wrong with it."""
        return self.note(self.drive.on_source(
            name, who, who, lambda sideways: PROFILE.read(axes, (), sideways), self.now, **facts))

    def task(self, speed=0.1, robots=('bot1',)):
        """Say what robots on a task shall do; return what is wrong with it."""
        return self.note(self.drive.on_task(robots, [(speed, 0, 0, 0, 0, 0)] * len(robots),
                                            self.now))

    def do(self, event, *facts):
        """Let an event of the drive happen now."""
        return self.note(getattr(self.drive, event)(*facts, self.now))

    def since(self, when, name):
        """Return [(time, velocity)] of what a robot was sent after a time."""
        return [(at, velocity) for at, robot, velocity in self.log if at >= when and robot == name]


def driving(*robots, **options):
    """Return a rig in which /a drives robots."""
    rig = Rig(**options)
    rig.wish(*robots or ('bot1', 'bot2'))
    rig.stick(NEUTRAL)
    rig.run(0.2)
    rig.stick(FORWARD)
    rig.now += 0.01
    return rig


def moves(rig, name='bot1'):
    return not rig.sent.get(name, ZERO).is_zero()


STOPS = {
    'stop-all': lambda rig: rig.do('on_stop'),
    'a stop button': lambda rig: rig.stick(NEUTRAL, 'pad', '/stranger',
                                           pressed=frozenset([STOP_ALL])),
    'stopped alone': lambda rig: rig.do('on_stop_robots', ['bot1']),
    'deselected': lambda rig: rig.wish('bot2'),
    'control taken': lambda rig: rig.do('on_take', B),
    'operator gone': lambda rig: rig.do('on_gone', A),
    'another mode': lambda rig: rig.do('on_mode', '/a', 'pad'),
    'wished mode': lambda rig: rig.wish('bot1', 'bot2', mode='pad'),
    'source lost': lambda rig: rig.do('on_lost', 'joy', 'lost'),
    'device lost': lambda rig: rig.stick(NEUTRAL, lost=True),
    'master lost': lambda rig: rig.do('on_hold', 'master'),
    'undertaker': lambda rig: rig.do('on_undertaker', False),
    'held': lambda rig: rig.do('on_held', 'bot1', 'not_heard'),
    'joined': lambda rig: rig.do('on_joined', 'bot1'),
    'closed': lambda rig: rig.do('close_robot', 'bot1'),
    'the end': lambda rig: rig.do('close'),
    'centred': lambda rig: rig.stick(NEUTRAL),
    'slept': lambda rig: (setattr(rig, 'now', rig.now + 0.6), rig.do('on_stop_robots', [])),
}


def test_a_robot_that_comes_up_after_the_end_is_driven_by_nobody():
    rig = driving()
    rig.do('close')
    assert rig.drive.command == ZERO
    rig.note(rig.drive.open('bot3', Limits(0.5, 1.0), rig.now, lambda velocity, _: velocity))
    for axes in (NEUTRAL, FORWARD):
        rig.run(1.0, lambda: rig.stick(axes), lambda: rig.wish('bot3'))
        assert not moves(rig, 'bot3')
    rig.wish()
    for robots in (('bot2',), ('bot3',)):
        rig.run(2.0, lambda: rig.task(robots=robots))
    assert not moves(rig, 'bot3')


@pytest.mark.parametrize('way', sorted(STOPS))
def test_what_stops_a_robot_does_so_at_once_and_a_held_stick_moves_it_no_more(way):
    rig = driving()
    assert (rig.sent['bot1'], rig.sent['bot2']) == (GO, GO)
    STOPS[way](rig)
    begun = rig.now
    assert rig.sent['bot1'] == ZERO and rig.since(begun, 'bot1')
    if way != 'centred':
        rig.run(3.0, lambda: rig.stick(FORWARD), lambda: rig.wish('bot1', 'bot2'))
    assert {velocity for _, velocity in rig.since(begun, 'bot1')} == {ZERO}


@pytest.mark.parametrize('quiet, limit_s', [('stick', 0.5), ('wish', LEASE_S)])
def test_who_falls_silent_drives_no_longer(quiet, limit_s):
    rig = driving()
    begun = rig.now
    rig.wish('bot1')
    rig.run(2.5, *[lambda: rig.stick(FORWARD)] * (quiet != 'stick'),
            *[lambda: rig.wish('bot1')] * (quiet != 'wish'))
    first = next(at for at, velocity in rig.since(begun, 'bot1') if velocity.is_zero())
    assert first - begun == pytest.approx(limit_s, abs=0.12)
    if quiet == 'wish':
        assert [rig.drive.stop_reason(name) for name in ('bot1', 'bot2')] == ['no_lease', '']
        assert rig.drive.lease.state == LAPSED


def test_who_comes_back_within_its_lease_has_to_centre():
    rig = driving()
    rig.run(2.0, lambda: rig.stick(FORWARD))
    rig.wish('bot1')
    rig.run(1.0, lambda: rig.stick(FORWARD), lambda: rig.wish('bot1'))
    assert not moves(rig) and rig.drive.waits_for(rig.now) == 'neutral'
    rig.stick(NEUTRAL)
    rig.stick(FORWARD)
    assert moves(rig)


def test_one_operator_whose_settings_and_stick_count():
    rig = driving()
    rig.wish('bot2', who=B, settings=[SLOW], mode='pad')
    rig.stick((0.0, -1.0), who='/b')
    assert ('/b', 'robot_select') in rig.refused and ('/b', '/joy') in rig.refused
    assert (rig.sent['bot1'], rig.drive.mode, rig.drive.settings.limits) == (GO, 'joy', (0.5, 1.5))
    rig.do('on_take', B)
    assert rig.drive.lease.holder == B and rig.drive.lease.selected == ()
    rig.wish('bot1', who=B, settings=[SLOW])
    rig.wish('bot1')
    rig.stick(FORWARD)
    rig.stick(NEUTRAL, who='/b')
    rig.stick(FORWARD, who='/b')
    assert rig.sent['bot1'] == Velocity(0.2, 0.0) and rig.drive.settings == SLOW
    assert not moves(rig, 'bot2')


@pytest.mark.parametrize('who, trusted, changes', [
    ('/a', False, True), ('/b', False, False), ('/mhri_voice', True, True)])
def test_who_may_choose_the_mode(who, trusted, changes):
    rig = driving()
    problem = rig.note(rig.drive.on_mode(who, 'pad', rig.now, trusted))
    assert bool(problem) != changes and (rig.drive.mode == 'pad') == changes
    assert ((who, '/mux_in/mode_select') in rig.refused) != changes
    assert 'no source' in rig.do('on_mode', '/a', 'telepathy')


def test_anybody_may_choose_the_mode_while_nobody_is_in_control():
    rig = Rig()
    assert not rig.do('on_mode', '/b', 'pad') and rig.drive.mode == 'pad'


def test_a_mode_in_a_wish_counts_when_it_changes():
    rig = driving()
    rig.wish('bot1', mode='pad')
    rig.note(rig.drive.on_mode('/mhri_voice', 'joy', rig.now, True))
    rig.wish('bot1', mode='pad')
    assert rig.drive.mode == 'joy', 'it was merely repeated'
    rig.wish('bot1', mode='')
    assert rig.wish('bot1', mode='telepathy') and not rig.wish('bot1', mode='pad')
    assert rig.drive.mode == 'pad'


def test_a_button_counts_once_and_from_the_source_that_drives():
    rig = driving()
    pressed = {'pressed': frozenset([NEXT_ROBOT])}
    rig.stick(NEUTRAL, 'pad')
    for _ in range(3):
        rig.stick(NEUTRAL, 'pad', **pressed)
        rig.stick(FORWARD, **pressed)
    assert rig.drive.asked == [NEXT_ROBOT]


def test_stop_all_ends_with_its_release_at_neutral_alone():
    rig = driving()
    rig.do('on_stop')
    assert rig.do('on_release') and rig.drive.stop_all
    rig.wish()
    rig.wish('bot1')
    rig.do('on_take', B)
    rig.wish('bot1', who=B)
    rig.stick(NEUTRAL, who='/b')
    rig.run(1.0, lambda: rig.task(robots=('bot2',)), lambda: rig.stick(FORWARD, who='/b'))
    assert not moves(rig) and not moves(rig, 'bot2') and rig.drive.stop_reason('bot1') == 'stopped'
    rig.stick(NEUTRAL, who='/b')
    assert not rig.do('on_release') and not rig.drive.stop_all


def test_stop_all_pressed_again_sends_zeros_again():
    rig = driving('bot1')
    rig.do('on_stop')
    assert [name for _, name, _ in rig.log].count('bot2') == 1
    rig.run(3.0)
    begun = rig.now
    rig.do('on_stop')
    rig.run(3.0)
    assert 9 <= len(rig.since(begun, 'bot1')) <= 12


@pytest.mark.parametrize('event, counts', [
    (lambda rig: rig.do('on_stop'), True), (lambda rig: rig.do('on_stop_robots', ['bot1']), True),
    (lambda rig: rig.do('on_take', B), True), (lambda rig: rig.do('on_gone', A), True),
    (lambda rig: rig.do('on_mode', '/a', 'pad'), True), (lambda rig: rig.wish('bot1'), True),
    (lambda rig: rig.do('on_held', 'bot1', 'not_heard'), True),
    (lambda rig: rig.do('on_undertaker', False), True),
    (lambda rig: rig.do('on_undertaker', True), False), (lambda rig: rig.do('on_gone', B), False),
    (lambda rig: rig.wish('bot1', 'bot2'), False), (lambda rig: rig.stick(NEUTRAL), False),
    (lambda rig: rig.do('on_held', 'bot1', ''), False)])
def test_what_anybody_must_be_told_is_counted(event, counts):
    rig = driving()
    before = rig.drive.changes
    event(rig)
    assert (rig.drive.changes > before) == counts and (counts or moves(rig) or rig.sent == {
        'bot1': ZERO, 'bot2': ZERO})


def test_whom_its_operator_has_chosen_is_known_after_the_lease():
    rig = driving()
    lease = rig.drive.lease
    assert lease.chosen == lease.selected == ('bot1', 'bot2') and rig.drive.share == 1.0
    rig.run(2.0)
    assert (lease.chosen, lease.selected) == (('bot1', 'bot2'), ())


# Of bot1, stopped alone while /a had selected it: who selects it how, and whether that ends it.
ENDS = {
    'a repetition': ([(A, ('bot1',))] * 5, False),
    'its settings change': ([(A, ('bot1', 'bot2'))], False),
    'deselected': ([(A, ())], False),
    'selected anew': ([(A, ()), (A, ('bot1',))], True),
    'selected anew beside others': ([(A, ('bot2',)), (A, ('bot2', 'bot1'))], True),
    'a stranger selects it anew': ([(B, ()), (B, ('bot1',))], False),
    'control taken': ([B], False),
    'a new operator selects it': ([B, (B, ('bot1',))], True),
    'its operator takes control again': ([A, (A, ('bot1',))], False),
}


@pytest.mark.parametrize('way', sorted(ENDS))
def test_what_ends_the_stop_of_one_robot(way):
    rig = driving()
    rig.do('on_stop_robots', ['bot1', 'unknown'])
    assert rig.drive.alone == {'bot1', 'unknown'} and moves(rig, 'bot2')
    steps, ends = ENDS[way]
    for step in steps:
        if isinstance(step, Caller):
            rig.do('on_take', step)
        else:
            rig.wish(*step[1], who=step[0])
    assert ('bot1' not in rig.drive.alone) == ends
    if not ends:
        assert rig.drive.stop_reason('bot1') == 'stopped_alone'
        for who in '/a', '/b':
            rig.stick(NEUTRAL, who=who)
            rig.stick(FORWARD, who=who)
        assert not moves(rig)
    rig.do('close_robot', 'unknown')
    rig.note(rig.drive.open('unknown', Limits(0.5, 1.0), rig.now))
    assert rig.drive.stop_reason('unknown') == 'stopped_alone', 'kept by name, before it was known'


def test_a_robot_that_was_not_selected_stays_stopped_until_a_wish_has_left_it_out():
    rig = driving('bot2')
    rig.do('on_stop_robots', ['bot1'])
    rig.wish('bot1')
    assert rig.drive.alone == {'bot1'}, 'that was on its way when it was stopped'
    rig.wish()
    rig.wish('bot1')
    assert rig.drive.alone == frozenset()


def test_stops_of_robots_that_are_not_there_are_kept_for_so_many():
    rig = driving()
    rig.do('on_stop_robots', ['x{}'.format(number) for number in range(99)] + ['bot1'])
    assert len(rig.drive.alone) == MAX_ROBOTS + 1 and 'bot1' in rig.drive.alone


def test_a_task_whose_program_has_died_leaves_zeros_but_for_a_robot_that_is_driven():
    rig = driving('bot1')
    rig.task(robots=('bot2',))
    for name in ('bot1', 'bot2', 'unknown'):
        rig.do('on_abandoned', name)
    assert rig.sent == {'bot1': GO, 'bot2': ZERO}


def test_what_does_not_stop_a_robot():
    rig = driving()
    assert rig.stick((float('nan'), 0.0)) and rig.stick((0.0,)), 'refused, with a reason'
    rig.stick(NEUTRAL, 'pad', lost=True)
    assert moves(rig)
    rig = Rig()
    rig.wish('bot1')
    rig.stick(NEUTRAL)
    rig.run(1.2)
    rig.sent.clear()
    rig.do('on_lost', 'joy', 'lost')
    assert rig.sent == {}, 'zeros would keep its own navigation off'


@pytest.mark.parametrize('selected, counts', [(('bot1',), False), (('bot1', 'bot2'), True)])
def test_what_goes_sideways_counts_while_a_selected_robot_can(selected, counts):
    rig, asked = Rig(), []
    rig.note(rig.drive.open('bot2', Limits(0.5, 1.0, True), rig.now))
    rig.wish(*selected)
    rig.note(rig.drive.on_source('joy', '/a', '/a', lambda sideways: asked.append(
        sideways) or PROFILE.read(NEUTRAL, (), sideways), rig.now))
    rig.note(rig.drive.on_task(['bot2'], [(0.1, 0.2, 9.0, 9.0, 9.0, 0.3)], rig.now))
    assert asked == [counts] and (counts or rig.sent['bot2'] == Velocity(0.1, 0.3, 0.2))


def test_a_stick_that_rests_and_is_repeated_need_not_be_centred_anew():
    rig = driving()
    rig.stick(NEUTRAL)
    rig.run(10.0, lambda: rig.stick(NEUTRAL), lambda: rig.wish('bot1', 'bot2'))
    rig.stick(FORWARD)
    assert moves(rig, 'bot1') and moves(rig, 'bot2')


def test_a_selection_that_waited_during_a_sleep_ends_no_stop():
    rig = driving('bot1')
    rig.now += SLEPT_S
    rig.do('on_stop_robots', ['bot1'])
    for robots in ((), ('bot1',)):
        rig.wish(*robots)
    assert rig.drive.alone == {'bot1'}
    rig.run(DEAF_S)
    rig.wish('bot1')
    assert rig.drive.alone == {'bot1'}, 'a repetition'
    for robots in ((), ('bot1',)):
        rig.wish(*robots)
    assert rig.drive.alone == frozenset()


def test_a_repeated_selection_ends_the_stop_that_its_first_one_could_not():
    """It came while the drive did not trust what may have waited: then nothing else changes."""
    rig = driving('bot1')
    rig.do('on_stop_robots', ['bot1'])
    rig.wish()
    rig.now += SLEPT_S
    rig.wish('bot1')
    assert rig.drive.stop_reason('bot1') == 'stopped_alone'
    rig.run(DEAF_S)
    before = rig.drive.changes
    rig.wish('bot1')
    assert rig.drive.stop_reason('bot1') != 'stopped_alone' and rig.drive.changes > before


TAKEN = {
    'selected': lambda rig: (rig.wish('bot1'), rig.run(0.3, rig.task), rig.wish()),
    'stop-all': lambda rig: (rig.do('on_stop'), rig.run(1.0, rig.task), rig.do('on_release')),
    'stopped alone': lambda rig: (rig.do('on_stop_robots', ['bot1']), rig.run(1.0, rig.task),
                                  rig.wish('bot1'), rig.wish(), rig.wish('bot1'), rig.wish()),
    'not heard': lambda rig: (rig.do('on_held', 'bot1', 'not_heard'), rig.run(1.0, rig.task),
                              rig.do('on_held', 'bot1', '')),
    'control taken': lambda rig: rig.do('on_take', B),
    'slept': lambda rig: (setattr(rig, 'now', rig.now + 0.7), rig.task(robots=()), rig.task()),
}


@pytest.mark.parametrize('end', ['left out', 'silent'])
@pytest.mark.parametrize('way', sorted(TAKEN))
def test_a_task_that_was_interrupted_does_not_go_on_by_itself(way, end):
    rig = Rig()
    rig.wish()
    rig.stick(NEUTRAL)
    rig.run(1.0, rig.task)
    assert rig.sent['bot1'] == WORK
    TAKEN[way](rig)
    begun = rig.now
    rig.run(2.0, rig.task)
    assert {velocity for _, velocity in rig.since(begun, 'bot1')} <= {ZERO}
    if end == 'silent':
        rig.run(0.3)
    else:
        rig.task(robots=('bot2',))
    rig.task()
    assert rig.sent['bot1'] == WORK


def test_a_task_moves_nobody_whom_the_operator_drives_nor_beyond_its_type():
    rig = driving('bot1')
    rig.task(9.0, ('bot1', 'bot2'))
    assert rig.sent == {'bot1': GO, 'bot2': GO}
    assert 'NaN' in rig.task(float('nan'), ('bot2',))
    begun = rig.now
    rig.run(1.0)
    first = next(at for at, velocity in rig.since(begun, 'bot2') if velocity.is_zero())
    assert first - begun == pytest.approx(0.25, abs=0.01)


def test_while_the_undertaker_is_silent_nothing_moves():
    rig = driving('bot1')
    rig.task(robots=('bot2',))
    rig.do('on_undertaker', False)
    assert rig.sent == {'bot1': ZERO, 'bot2': ZERO}
    assert rig.drive.waits_for(rig.now) == 'undertaker'
    begun = rig.now
    for _ in range(3):
        rig.run(0.3, lambda: rig.task(robots=('bot2',)))
        rig.run(0.3, lambda: rig.wish('bot1'))
        rig.stick(NEUTRAL)
        rig.stick(FORWARD)
    assert {velocity for at, _, velocity in rig.log if at > begun} <= {ZERO}
    rig.do('on_undertaker', True)
    rig.stick(FORWARD)
    assert not moves(rig) and rig.drive.waits_for(rig.now) == 'neutral'
    rig.stick(NEUTRAL)
    rig.stick(FORWARD)
    assert moves(rig)


def test_what_was_in_the_sockets_during_a_sleep_moves_nothing():
    rig = driving('bot1')
    rig.now += 2.0
    rig.stick(NEUTRAL)
    rig.stick(FORWARD)
    assert not moves(rig)
    rig.run(0.5)
    rig.stick(FORWARD)
    assert not moves(rig)


def test_what_the_next_drive_knows():
    rig = driving(config=CONFIG)
    rig.wish('bot1', settings=[SLOW], mode='pad')
    rig.wish('bot2', who=B)
    rig.do('on_stop_robots', ['bot2'])
    rig.do('on_stop')
    kept = json.loads(json.dumps(rig.drive.kept()))
    after = Rig(kept, now=rig.now + 1.0)
    drive = after.drive
    assert (drive.lease.holder, drive.settings, drive.mode, drive.stop_all, drive.alone) == (
        A, SLOW, 'pad', True, {'bot2'})
    assert (drive.lease.selected, drive.lease.state) == ((), LAPSED)
    assert drive.kept() == kept, 'nothing is lost on the way'
    after.wish('bot1', who=B)
    assert drive.lease.selected == (), 'refused before, refused now'
    after.wish('bot1', 'bot2')
    after.stick(NEUTRAL, 'pad')
    assert not after.do('on_release')
    after.stick(FORWARD, 'pad')
    assert not moves(after)
    after.stick(NEUTRAL, 'pad')
    after.stick(FORWARD, 'pad')
    assert after.sent['bot1'] == Velocity(0.2, 0.0) and not moves(after, 'bot2')


def test_a_publisher_of_a_source_that_was_refused_is_refused_by_the_next_drive():
    rig = driving('bot1')
    rig.stick(FORWARD, who='/stranger')
    kept = json.loads(json.dumps(rig.drive.kept()))
    after = Rig(kept, now=rig.now + 1.0)
    after.stick(NEUTRAL, who='/stranger')
    after.wish('bot1')
    for axes in (NEUTRAL, FORWARD):
        after.stick(axes, who='/stranger')
    assert not moves(after), 'it speaks first, and says neutral'
    for axes in (NEUTRAL, FORWARD):
        after.stick(axes)
    assert after.sent['bot1'] == GO


def test_a_drive_whose_memory_is_lost_stands_and_gives_the_seat_to_one_who_takes_it():
    after = Rig(dict(LOST))
    for _ in range(5):
        for who in (A, B):
            after.wish('bot1', who=who)
        after.run(1.0)
    assert after.drive.stop_all and after.drive.lease.holder is None
    after.note(after.drive.on_take(A, after.now))
    assert after.drive.lease.holder == A


@pytest.mark.parametrize('change', [
    {'seat': 5}, {'seat': {}}, {'settings': [[99.0, 1.0], []]},
    {'settings': [['fast', 1.0], []]}, {'settings': [[float('nan'), 1.0], []]},
    {'settings': [[0.5, 1.0], [['/a', [99.0, 1.0]]]]},
    {'driven': {'bot1': [1.0]}}, {'alone': ['bot1']},
    {'driven': {'bot1': [float('nan'), 1.0, False]}}, {'driven': {'bot1': [0.5, 0.0, False]}},
    {'driven': {'bot1': [0.5, float('nan'), False]}},
    {'alone': {'bot1': []}}, {'sources': None}, {'sources': {'joy': 'x'}}, {'mode': []},
    {'sources': {'joy': [None, '', None, ['/a', 5]]}}])
def test_a_malformed_memory_is_refused(change):
    kept = dict(json.loads(json.dumps(driving('bot1').drive.kept())), **change)
    with pytest.raises((AttributeError, LookupError, TypeError, ValueError)):
        Drive(CONFIG, 0.0, kept).kept()


def test_a_seat_whose_holder_did_not_come_back_is_empty_and_the_settings_stay():
    rig = driving()
    rig.wish('bot1', settings=[SLOW])
    after = Rig(json.loads(json.dumps(rig.drive.kept())), now=rig.now)
    after.there = []
    after.run(RETURN_S + 0.1)
    assert (after.drive.lease.holder, after.drive.settings) == (None, SLOW)
    after.wish('bot1', who=B)
    assert after.drive.lease.holder == B


def test_a_mode_that_is_no_longer_there_is_not_restored():
    assert Rig(dict(driving().drive.kept(), mode='telepathy')).drive.mode == 'joy'


def test_what_a_new_drive_says():
    drive = Drive(CONFIG, 7.0)
    assert (drive.share, drive.wishes, drive.changes, drive.asked, drive.said) == (
        1.0, 0, 0, [], None)
    assert (drive.command, drive.owner('joy'), drive.source.topic) == (ZERO, None, '/joy')
    drive.on_wish(A, ['bot1'], (), '', 7.5)
    assert (drive.wishes, drive.lease.since, drive.lease.holder) == (1, 7.5, A)


def test_how_soon_it_looks_again():
    rig = Rig()
    rig.run(2.0)
    assert rig.drive.next_tick(rig.now) == pytest.approx(rig.now + 0.05)
    rig = driving()
    rig.run(0.01)
    assert rig.drive.next_tick(rig.now) < rig.now + 0.05, 'the next repetition'


def test_only_a_stop_is_known_where_everything_was_restarted():
    rig = Rig({'stop': True})
    assert rig.drive.stop_all and rig.drive.settings.limits == (0.5, 1.5)


def test_a_brake_that_fails_gives_its_robot_a_zero_and_the_others_go_on():
    works = [True]

    def brake(velocity, now):
        if not works[0]:
            raise ValueError('no scan')
        return velocity
    rig = driving(bot1=brake)
    assert (rig.sent['bot1'], rig.sent['bot2']) == (GO, GO)
    works[0] = False
    rig.run(0.1)
    rig.stick(FORWARD)
    assert (rig.sent['bot1'], rig.sent['bot2']) == (ZERO, GO)
    assert rig.drive.robots['bot1'].sent == ZERO
    assert ('bot1', "ValueError('no scan')") in rig.refused


def test_a_task_moves_no_robot_without_the_enabling_pedal():
    rig = Rig(config=replace(CONFIG, enabling='pad'))
    for pressed, sent in ((True, WORK), (False, ZERO)):
        rig.stick(NEUTRAL, 'pad', '/pad_node', enables=pressed)
        rig.task()
        assert rig.sent['bot1'] == sent
