# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories under the drive: who may use them, when they act, and what ends them."""
import pytest
from test_drive import A, B, FORWARD, NEUTRAL, Rig, STOPS

from mhri.base.accessories import (
    Accessory, Act, ACTION, AXIS2, CANCEL, CANCELLED, Feedback, HOLD, KEEP, LOOKED_AT, POSITION,
    TAP, TOGGLE)
from mhri.base.limits import Velocity
from mhri.base.robot_types import Limits
from mhri.driving.accessory_rule import choice_of, SILENT_S

ON_OFF = (('on', (('data', True),)), ('off', (('data', False),)))
RANGE = {'ranges': ((-2.0, 1.0),), 'neutral': (0.0,)}
FLIPPER = Accessory('flipper', key='flipper', kind=HOLD, type='std_msgs/Float64', **RANGE)
LAMP = Accessory('lamp', key='lamp', kind=TOGGLE, choices=ON_OFF, on_stop=KEEP)
ARM = Accessory('arm', key='arm', kind=TAP, way=ACTION, choices=(('open', ()), ('close', ())),
                on_stop=CANCEL)
HEAD = Accessory('head', key='head', kind=AXIS2, mode=POSITION, type='geometry_msgs/Vector3',
                 ranges=((-1.0, 1.0),) * 2, neutral=(0.0, 0.0), fields=('x', 'y'),
                 state=Feedback('head_state'))
WINCH = Accessory('winch', key='winch', kind=HOLD, team=True, of=LOOKED_AT, **RANGE)
BEACON = Accessory('beacon', key='beacon', kind=HOLD, on_stop=KEEP, **RANGE)
ALL = FLIPPER, LAMP, ARM, HEAD, WINCH, BEACON


class Desk(Rig):
    """A rig whose robots have accessories, and what these were sent."""

    def __init__(self, *robots, **options):
        self.acts = []
        super().__init__(**options)
        for name in ('bot1', 'bot2'):
            self.note(self.drive.open(name, Limits(0.5, 1.0), self.now, accessories=ALL))
        self.wish(*robots or ('bot1',))
        self.stick(NEUTRAL)
        self.run(0.5, lambda: self.wish(*robots or ('bot1',)))

    def note(self, orders):
        """Note the acts among orders."""
        orders, problem = orders if isinstance(orders, tuple) else (orders, orders)
        self.acts += [(self.now, name, act) for name, act in orders if isinstance(act, Act)]
        return super().note(([order for order in orders if isinstance(order[1], Velocity)],
                             problem))

    def use(self, key, choice='', value=(), robots=('bot1',), who='/a', **options):
        """Use an accessory; return what is wrong with it."""
        self.now += 1e-3
        return self.note(self.drive.on_accessory(who, robots, key, choice, value, self.now,
                                                 **options))

    def hold(self, seconds, value=0.5, key='flipper', **options):
        """Hold one, as a key does, while the wish is repeated."""
        self.run(seconds, lambda: self.use(key, value=(value,), **options),
                 lambda: self.wish('bot1'))

    def last(self, key='flipper', name='bot1'):
        """Return what one was sent last, None for nothing."""
        return next((act for _, robot, act in reversed(self.acts)
                     if (robot, act.key) == (name, key)), None)


def flipping():
    """Return a desk at which the flipper of bot1, the arm and the head are in motion."""
    desk = Desk('bot1')
    desk.use('arm', 'open')
    desk.drive.on_report('bot1', 'head', (0.2, 0.3), '')
    desk.hold(0.3)
    desk.use('head', value=(1.0, 1.0))
    assert desk.last() == Act('flipper', value=(0.5,))
    assert desk.last('arm') == Act('arm', 'open')
    return desk


ENDS = {name: act for name, act in STOPS.items() if name not in (
    'source lost', 'joined', 'centred')}


@pytest.mark.parametrize('stop', ENDS.values(), ids=ENDS)
def test_every_end_of_driving_ends_moving_parts_at_once(stop):
    desk = flipping()
    at = desk.now
    stop(desk)
    ended = {act.key: act for when, name, act in desk.acts if when >= at and act.ends}
    assert ended == {'flipper': Act('flipper', value=(0.0,), ends=True),
                     'arm': Act('arm', CANCELLED, ends=True),
                     # A neutral position would swing it: it stays where it was reported.
                     'head': Act('head', value=(0.2, 0.3), ends=True)}
    count = len(desk.acts)
    # Nothing sets off again while the input is held: not even once all is released.
    desk.do('on_undertaker', True)
    if 'bot1' in desk.drive.robots:
        desk.do('on_held', 'bot1', '')
    desk.do('on_release')
    desk.run(0.3, lambda: desk.wish('bot2'), lambda: desk.use('flipper', value=(0.5,)))
    desk.run(1.0, lambda: desk.wish('bot1'), lambda: desk.use('flipper', value=(0.5,)))
    assert [act for _, _, act in desk.acts[count:] if not act.ends] == []


@pytest.mark.parametrize('release', ['neutral', 'silent'])
def test_it_acts_again_once_it_was_released(release):
    desk = flipping()
    desk.do('on_stop')
    assert desk.use('flipper', value=(0.5,))
    desk.do('on_release')
    desk.wish('bot1')
    desk.hold(0.5)
    assert desk.last().ends
    if release == 'neutral':
        desk.use('flipper', value=(0.0,))
    else:
        desk.run(SILENT_S + 0.05, lambda: desk.wish('bot1'))
    desk.hold(0.1)
    assert desk.last() == Act('flipper', value=(0.5,))


def test_a_held_value_is_repeated_scaled_and_released_by_silence():
    desk = Desk('bot1')
    desk.hold(1.0, -0.5)
    sent = [when for when, _, act in desk.acts]
    assert 9 <= len(sent) <= 12 and desk.last() == Act('flipper', value=(-1.0,))
    at = desk.now
    desk.run(0.5, lambda: desk.wish('bot1'))
    assert desk.last() == Act('flipper', value=(0.0,), ends=True)
    assert desk.acts[-1][0] <= at + SILENT_S + 0.01
    count = len(desk.acts)
    desk.run(0.5, lambda: desk.wish('bot1'))
    assert len(desk.acts) == count


def test_without_a_report_the_end_of_a_position_sends_nothing():
    desk = Desk('bot1')
    desk.use('head', value=(0.5, 0.0))
    count = len(desk.acts)
    desk.do('on_stop')
    assert len(desk.acts) == count


def test_what_was_held_while_another_was_in_control_is_released_first():
    desk = flipping()
    desk.do('on_take', B)
    for who in (B, A):
        desk.run(0.5, lambda: desk.wish('bot1', who=B), lambda: desk.use('flipper', value=(0.5,)))
        desk.do('on_take', A)
    desk.hold(1.0)
    assert desk.last() == Act('flipper', value=(0.0,), ends=True)
    desk.use('flipper', value=(0.0,))
    desk.hold(0.2)
    assert desk.last() == Act('flipper', value=(0.5,))


@pytest.mark.parametrize('key, choice, value, robots, who', [
    ('flipper', '', (0.5,), ('bot2',), '/a'),       # not selected
    ('flipper', '', (0.5,), ('bot1',), '/b'),       # not in control
    ('flipper', '', (0.5,), ('bot1', 'bot2'), '/a'),    # not for a team
    ('flipper', '', (0.5,), (), '/a'),
    ('flipper', '', (1.5,), ('bot1',), '/a'),
    ('flipper', '', (float('nan'),), ('bot1',), '/a'),
    ('flipper', '', (0.5, 0.5), ('bot1',), '/a'),
    ('flipper', 'open', (), ('bot1',), '/a'),
    ('arm', 'swing', (), ('bot1',), '/a'),
    ('arm', 'open', (0.5,), ('bot1',), '/a'),
    ('rudder', '', (0.5,), ('bot1',), '/a'),
    ('arm', 'open', (), ('bot9',), '/a')])
def test_who_may_use_what(key, choice, value, robots, who):
    desk = Desk('bot1')
    assert desk.use(key, choice, value, robots, who)
    assert desk.acts == []


def test_a_lamp_works_under_a_stop_and_a_moving_part_does_not():
    desk = Desk('bot1')
    desk.do('on_stop')
    assert desk.use('arm', 'open') and not desk.use('lamp', 'on')
    assert [act for _, _, act in desk.acts] == [Act('lamp', 'on')]
    desk.do('on_held', 'bot1', 'not_heard')
    assert desk.use('lamp', 'off')


@pytest.mark.parametrize('end', [
    lambda desk: desk.wish('bot2'), lambda desk: desk.do('on_held', 'bot1', 'not_heard')])
def test_what_is_held_and_kept_under_a_stop_ends_with_the_authority(end):
    desk = Desk('bot1')
    desk.use('beacon', value=(0.5,))
    desk.do('on_stop')
    desk.use('beacon', value=(0.5,))
    assert not desk.last('beacon').ends
    end(desk)
    desk.run(0.5, lambda: desk.use('beacon', value=(0.5,)))
    assert desk.last('beacon') == Act('beacon', value=(0.0,), ends=True)


@pytest.mark.parametrize('value', [(float('nan'), 0.0), (0.0, float('inf'))])
def test_a_position_that_is_no_number_is_not_sent_back(value):
    desk = flipping()
    desk.drive.on_report('bot1', 'head', value, '')
    count = len(desk.acts)
    desk.do('on_stop')
    assert 'head' not in [act.key for _, _, act in desk.acts[count:]]


def test_a_team_acts_together_and_another_robot_only_after_a_release():
    desk = Desk('bot1')
    desk.hold(0.3, key='winch', robots=())
    both = ('bot1', 'bot2')
    desk.run(0.5, lambda: desk.use('winch', value=(0.5,), robots=()), lambda: desk.wish(*both))
    assert desk.last('winch') and desk.last('winch', 'bot2') is None
    desk.use('winch', value=(0.0,), robots=())
    desk.run(0.3, lambda: desk.use('winch', value=(0.5,), robots=()), lambda: desk.wish(*both))
    assert desk.last('winch') == desk.last('winch', 'bot2') == Act('winch', value=(0.5,))


def test_the_robot_looked_at_needs_no_selection():
    desk = Desk('bot1')
    assert not desk.use('winch', value=(0.5,), robots=('bot2',))
    assert desk.last('winch', 'bot2') == Act('winch', value=(0.5,))
    desk.do('on_stop_robots', ['bot2'])
    assert desk.last('winch', 'bot2').ends
    desk.run(5.0)
    assert desk.use('winch', value=(0.5,)) and desk.use('lamp', 'on'), 'without a lease'


def test_a_task_uses_what_belongs_to_the_robot_that_obeys_it():
    desk = Desk('bot2')
    assert desk.use('arm', 'open', task=True)
    desk.run(0.5, desk.task, lambda: desk.wish('bot2'))
    assert not desk.use('arm', 'open', task=True)
    assert desk.use('arm', 'open', robots=('bot2',), task=True)
    desk.wish('bot1')
    assert desk.last('arm') == Act('arm', CANCELLED, ends=True)


def test_a_goal_that_has_ended_is_not_cancelled():
    desk = Desk('bot1')
    desk.use('arm', 'close')
    desk.drive.on_finished('bot1', 'arm')
    desk.do('on_stop')
    assert desk.last('arm') == Act('arm', 'close')


def test_what_was_held_before_the_start_is_released_first():
    desk = Desk('bot1')
    desk.note(desk.drive.open('bot1', Limits(0.5, 1.0), desk.now, accessories=ALL))
    desk.hold(1.0)
    assert desk.last() is None


def test_a_report_is_known_and_news():
    desk = Desk('bot1')
    lamp, before = desk.drive.accessories.of('bot1')['lamp'], desk.drive.changes
    assert not lamp.known
    for value in (True, True, False):
        desk.drive.on_report('bot1', 'lamp', (float(value),), choice_of(LAMP, [value]))
    assert lamp.known and lamp.choice == 'off' and desk.drive.changes == before + 2
    assert choice_of(ARM, [3]) == ''


def test_driving_is_as_before():
    desk = flipping()
    desk.stick(NEUTRAL)
    desk.stick(FORWARD)
    assert desk.sent['bot1'] == Velocity(0.5, 0.0)
    desk.do('on_take', B)
    assert desk.sent['bot1'].is_zero() and A != B
