# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How fast the drive lets robots go: the operator's settings, the link, and limits that change."""
import json

import pytest
from test_drive import A, B, driving, FORWARD, GO, NEUTRAL, Rig, SLOW

from mhri.base.limits import Velocity
from mhri.base.robot_types import Limits
from mhri.driving.operator_lease import Caller, RETURN_S
from mhri.driving.settings import Settings
from mhri.robots.link_quality import link_share


@pytest.mark.parametrize('bad', [
    [SLOW, SLOW], *[[SLOW._replace(**{name: value})] for name, most in (
        ('linear_mps', 5.0), ('angular_rad_s', 10.0))
        for value in (0.0, -1.0, most + 0.001, float('nan'), float('inf'))]])
def test_settings_that_cannot_be_leave_all_as_it_is(bad):
    rig = driving('bot1')
    assert rig.wish('bot2', settings=bad)
    assert rig.drive.settings.limits == (0.5, 1.5) and rig.drive.lease.selected == ('bot1',)
    assert rig.refused == [('/a', 'settings')]
    assert not rig.wish('bot1', settings=[SLOW._replace(linear_mps=5.0, angular_rad_s=10.0)])
    assert not rig.wish('bot1', settings=[SLOW])
    assert rig.sent['bot1'] == Velocity(0.2, 0.0), 'a moving robot follows at once'


@pytest.mark.parametrize('took, restarted', [(True, False), (False, False), (True, True)])
def test_who_gets_control_back_has_nothing_less_safe_than_before(took, restarted):
    rig = driving('bot1')
    rig.wish('bot1', settings=[SLOW])
    rig.note(rig.drive.on_take(B, rig.now))
    assert rig.drive.settings == SLOW, 'those in force stay'
    rig.wish('bot1', who=B, settings=[Settings(5.0, 0.5, False, True, False)])
    if restarted:
        rig = Rig(json.loads(json.dumps(rig.drive.kept())), now=rig.now)
    if took:
        rig.note(rig.drive.on_take(A, rig.now))
    else:
        rig.note(rig.drive.on_gone(B, rig.now))
        rig.there = [A]
        rig.run(RETURN_S + 0.1)
        rig.wish('bot1')
    assert rig.drive.lease.holder == A
    assert rig.drive.settings == Settings(0.2, 0.5, False, True, True)
    rig.wish('bot1', settings=[Settings(0.3, 1.0)])
    assert rig.drive.settings.linear_mps == 0.3, 'what the operator says counts'


def test_the_settings_of_operators_are_bounded():
    rig = driving('bot1')
    for number in range(200):
        rig.note(rig.drive.on_take(Caller('/x{}'.format(number)), rig.now))
        rig.wish('bot1', who=Caller('/x{}'.format(number)))
    assert len(rig.drive.kept()['settings'][1]) == 64


def test_the_selected_robots_keep_together_and_slow_down_for_a_link():
    rig = driving()
    rig.note(rig.drive.open('bot2', Limits(0.2, 1.0), rig.now))
    rig.wish('bot1', 'bot2', settings=[SLOW._replace(linear_mps=0.5)])
    rig.stick(NEUTRAL)
    rig.stick(FORWARD)
    assert rig.sent['bot1'] == rig.sent['bot2'] == Velocity(0.2, 0.0)
    rig.wish('bot1', 'bot2', settings=[SLOW._replace(linear_mps=0.5, together=False)])
    rig.stick(FORWARD)
    assert (rig.sent['bot1'], rig.sent['bot2']) == (GO, Velocity(0.2, 0.0))
    rig.drive.on_round_trip('bot2', 0.8)
    rig.wish('bot1', 'bot2', settings=[SLOW._replace(linear_mps=0.5, slow_with_link=True)])
    rig.stick(FORWARD)
    assert rig.drive.share == link_share(0.8) < 0.4
    assert rig.sent['bot1'].linear_mps == pytest.approx(0.5 * link_share(0.8))
    for trip_s in (0.4, float('nan')):
        rig.drive.on_round_trip('bot1', 0.3)
        rig.drive.on_round_trip('bot2', trip_s)
        rig.run(0.1)
        assert rig.drive.share == link_share(0.4 if trip_s == 0.4 else 0.3)
    rig.wish('bot2')
    rig.run(0.1)
    assert rig.drive.share == 1.0, 'nothing is known of that link'


@pytest.mark.parametrize('selected, presumed, held', [
    (False, False, False), (True, False, True), (True, True, False)])
def test_a_limit_that_rises_counts_at_once_only_for_one_not_selected_or_of_unknown_type(
        selected, presumed, held):
    rig = Rig()
    rig.note(rig.drive.open('bot1', Limits(0.1, 1.0), rig.now, presumed=presumed))
    rig.wish(*['bot1'] if selected else [])
    rig.run(0.1)
    rig.note(rig.drive.open('bot1', Limits(0.5, 1.0), rig.now))
    assert rig.drive.stop_reason('bot1') == ('limit_raised' if held else '')
    rig.wish('bot1', mode='joy')
    for axes in (NEUTRAL, FORWARD):
        rig.stick(axes)
    assert rig.sent['bot1'].linear_mps == (0.1 if held else 0.5)


def test_a_robot_of_unknown_type_that_moves_keeps_its_limits():
    rig = Rig()
    rig.note(rig.drive.open('bot1', Limits(0.1, 1.0), rig.now, presumed=True))
    rig.wish('bot1')
    for axes in (NEUTRAL, FORWARD):
        rig.stick(axes)
    rig.run(0.1)
    rig.note(rig.drive.open('bot1', Limits(0.5, 1.0), rig.now))
    for axes in (NEUTRAL, FORWARD):
        rig.stick(axes)
    assert rig.sent['bot1'].linear_mps == 0.1 and rig.drive.stop_reason('bot1') == 'limit_raised'


def test_a_limit_that_falls_is_kept_at_once_also_where_the_stick_is_let_go_just_then():
    rig = driving('bot1')
    rig.run(0.1)
    for limit_mps in (0.3, 0.5):
        rig.note(rig.drive.open('bot1', Limits(limit_mps, 1.0), rig.now))
        rig.stick(NEUTRAL)
    assert rig.drive.stop_reason('bot1') == 'limit_raised'
    rig.stick(FORWARD)
    assert rig.sent['bot1'].linear_mps == 0.3


@pytest.mark.parametrize('who', [A, B])
def test_a_limit_that_rises_counts_once_the_robot_is_selected_anew(who):
    rig = driving('bot1')
    rig.run(0.1)
    for limit_mps, held_mps, stands in ((0.3, 0.3, ''), (0.5, 0.3, 'limit_raised')):
        rig.note(rig.drive.open('bot1', Limits(limit_mps, 1.0), rig.now))
        for axes in (NEUTRAL, FORWARD):
            rig.stick(axes)
        rig.run(0.1)
        assert (rig.sent['bot1'].linear_mps, rig.drive.stop_reason('bot1')) == (held_mps, stands)
    rig.wish('bot1', 'bot2')
    assert rig.drive.stop_reason('bot1') == 'limit_raised', 'it was selected all the time'
    if who == A:
        rig.wish()
    else:
        rig.do('on_gone', A)
        rig.there = [B]
        rig.run(RETURN_S + 0.1)
    rig.wish('bot1', who=who)
    for axes in (NEUTRAL, FORWARD):
        rig.stick(axes, who=who.name)
    assert (rig.sent['bot1'], rig.drive.stop_reason('bot1')) == (GO, '')
