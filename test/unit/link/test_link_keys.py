# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whose key may do what on the link: link/keys."""
import pytest

from mhri.link.keys import (
    access, access_of_router, check_open, check_own, host_of, is_of, Keys, KeysError,
    partners, read_lists)
from mhri.robots.owners import called, may_drive, split

PEERS = frozenset((
    'host:lab', 'host:desk.2', 'watch:gallery', 'robot:bot1', 'robot:bot2', 'watched:bot3'))
SIGNED = '''Certificate Revocation List (CRL):
    Serial Number: 0AFF12
        Revocation Date: Nov 22 21:39:09 2026 GMT
    Serial Number: 77
'''


@pytest.mark.parametrize('owner, role, name', [
    ('host:lab', 'host', 'lab'), ('robot:bot1.12', 'robot', 'bot1'), ('watch:a-b', 'watch', 'a-b'),
    ('watched:bot1', 'watched', 'bot1'), ('admin:lab', '', ''), ('host:', '', ''), ('', '', ''),
    ('host:lab/../x', '', ''), ('host:lab\n', '', ''), ('host:*', '', ''), ('host:lab.x', '', ''),
    ('host:lab.x0c5e21a9', '', ''), ('host:lab.0c5e21a9', '', '')])
def test_names(owner, role, name):
    assert split(owner) == (role, name)


def test_words_and_rights():
    assert called('host:lab.2') == 'lab' and called('odd') == 'odd'
    assert [may_drive(owner) for owner in sorted(PEERS)] == [True, True, False, False, False, False]
    assert host_of('lab-pc2.local') == 'host:lab-pc2' and host_of('') == 'host:unknown'
    assert host_of('a b$') == 'host:a_b_'


@pytest.mark.parametrize('side, robot, let_in', [
    ('robot', 'bot1', ['host:desk.2', 'host:lab', 'watch:gallery']),
    ('host', 'bot1', ['robot:bot1']), ('host', 'bot3', ['watched:bot3']), ('host', 'bot9', [])])
def test_who_is_let_in(side, robot, let_in):
    assert partners(Keys('x', PEERS), side, robot) == let_in


def test_who_is_withdrawn_is_not_let_in():
    keys = Keys('robot:bot1', PEERS, frozenset(('host:lab', 'robot:bot2')))
    assert partners(keys, 'robot', 'bot1') == ['host:desk.2', 'watch:gallery']
    assert partners(keys, 'host', 'bot2') == []


def allowed(rules, owner, flow, message):
    """Return the key expressions on which somebody may do something."""
    named = {name for policy in rules['policies'] if policy['subjects'] == [owner]
             for name in policy['rules']}
    return sorted(key for rule in rules['rules'] if rule['id'] in named
                  and rule['flows'] == [flow] and message in rule['messages']
                  for key in rule['key_exprs'])


def test_a_host_speaks_below_its_own_name_and_a_watching_one_hardly():
    rules = access(Keys('robot:bot1', PEERS), 'robot', 'bot1')
    assert rules['enabled'] and rules['default_permission'] == 'deny'
    assert {row['id']: row['cert_common_names'] for row in rules['subjects']} == {
        owner: [owner] for owner in ('host:lab', 'host:desk.2', 'watch:gallery')}
    assert allowed(rules, 'host:lab', 'ingress', 'put') == ['mhri/bot1/host:lab/down/**']
    assert allowed(rules, 'host:lab', 'egress', 'put') == ['mhri/bot1/host:lab/up/**']
    assert allowed(rules, 'watch:gallery', 'ingress', 'put') == [
        'mhri/bot1/watch:gallery/down/_beat', 'mhri/bot1/watch:gallery/down/_key']


def test_nobody_commands_a_robot_that_is_only_watched():
    rules = access(Keys('watched:bot3', PEERS), 'robot', 'bot3')
    assert allowed(rules, 'host:lab', 'ingress', 'put') == [
        'mhri/bot3/host:lab/down/_beat', 'mhri/bot3/host:lab/down/_key']


def test_a_host_hears_of_a_robot_from_itself_alone():
    rules = access(Keys('host:lab', PEERS), 'host', 'bot1')
    assert [row['id'] for row in rules['subjects']] == ['robot:bot1']
    assert allowed(rules, 'robot:bot1', 'ingress', 'put') == ['mhri/bot1/host:lab/up/**']


@pytest.mark.parametrize('side, robot, own, says', [
    ('host', 'bot1', 'robot:bot1', 'mhri_keys.sh host NAME'),
    ('robot', 'bot1', 'robot:bot2', 'that of robot:bot2, and this is the robot bot1'),
    ('robot', 'bot1', 'host:lab', 'mhri_keys.sh robot bot1'),
    ('host', 'bot1', '', 'this is a host'),
    ('host', 'bot1', 'host:old', 'is withdrawn')])
def test_a_key_that_is_not_for_this_end(side, robot, own, says):
    with pytest.raises(KeysError, match=says):
        check_own(Keys(own, PEERS, frozenset(('host:old',))), side, robot)


def test_lists():
    keys = read_lists('host:lab', 'host:lab\nrobot:bot1\n', '0aff12 host:x\n77 robot:y\n', SIGNED)
    assert keys == Keys('host:lab', frozenset(('host:lab', 'robot:bot1')),
                        frozenset(('host:x', 'robot:y')))


def test_when_certificates_run_out():
    """One of a name ends, another one goes on; RFC 5280 writes the year with two digits or four."""
    keys = read_lists('robot:bot1', 'host:lab 261125000000Z\nhost:lab 271125000001Z\n'
                      'watch:gallery 20510101000000Z\nrobot:bot1\n', '0aff12 x\n77 y\n', SIGNED)
    assert keys.peers == {'host:lab', 'watch:gallery', 'robot:bot1'}
    end_s, late_s = 1795564800.0, 2556144000.0
    assert keys.ended(end_s - 1.0, end_s) == {'host:lab'} == keys.ended(end_s, end_s + 4e7)
    assert keys.ended(end_s, end_s + 1e7) == frozenset() == keys.ended(end_s + 1.0, end_s - 1.0)
    assert keys.ended(late_s - 1.0, late_s) == {'watch:gallery'}


@pytest.mark.parametrize('end', ['soon', '261325000000Z', '261125000000', '1e999', '-'])
def test_an_end_that_none_can_be(end):
    with pytest.raises(KeysError, match='put the key in place again'):
        read_lists('host:lab', 'host:lab ' + end, '0aff12 x\n77 y\n', SIGNED)


@pytest.mark.parametrize('owner, found', [
    ('host:lab', True), ('host:lab.2', False), ('robot:bot1', True), ('robot:bot1.3', True),
    ('watched:bot1', True), ('robot:bot10', False), ('host:bot1', False), ('router:hub', False)])
def test_whose_link_it_is(owner, found):
    assert is_of(owner, 'bot1', 'host:lab') is found


@pytest.mark.parametrize('withdrawn', ['', '77 robot:y', '0AFF12 a\n77 b\n78 c', '0AFF12\n77 b'])
def test_a_list_that_the_authority_did_not_sign(withdrawn):
    with pytest.raises(KeysError, match='put the key in place again'):
        read_lists('host:lab', '', withdrawn, SIGNED)


@pytest.mark.parametrize('end', [
    'tcp/0.0.0.0:7447', 'tcp/192.168.0.7:7447', 'tcp/[::]:7447',
    'tcp/[fe80::1]:7447', 'tcp/bot1.local:7447', 'tcp/localhost.evil.org:7447',
    'tcp/127.0.0.1.evil.org:7447', 'tcp/[::ffff:10.0.0.1]:7447'])
def test_without_keys_nobody_beyond_this_computer_is_listened_to(end):
    with pytest.raises(KeysError, match='mhri_keys.sh.*--keys off') as refused:
        check_open(['tcp/127.0.0.1:7447', end])
    assert end in str(refused.value)


def test_a_router_lets_everybody_speak_below_the_own_name():
    rules = access_of_router(Keys('router:hub', PEERS | {'router:hub'}))
    assert rules['default_permission'] == 'deny'
    assert {row['id'] for row in rules['subjects']} == PEERS
    assert allowed(rules, 'host:lab', 'ingress', 'put') == ['mhri/*/host:lab/down/**']
    assert allowed(rules, 'host:lab', 'egress', 'put') == ['mhri/*/host:lab/up/**']
    assert allowed(rules, 'watch:gallery', 'ingress', 'put') == ['mhri/*/watch:gallery/down/_beat']
    assert allowed(rules, 'robot:bot1', 'ingress', 'put') == ['mhri/bot1/*/up/**']
    assert allowed(rules, 'robot:bot1', 'egress', 'put') == ['mhri/bot1/*/down/**']


def test_who_is_withdrawn_is_not_let_in_by_a_router():
    rules = access_of_router(Keys('router:hub', PEERS, frozenset(('host:lab',))))
    assert {row['id'] for row in rules['subjects']} == PEERS - {'host:lab'}


def test_behind_a_router_its_certificate_stands_for_all():
    keys = Keys('robot:bot1', PEERS | {'router:hub', 'router:old'}, frozenset(('router:old',)))
    rules = access(keys, 'robot', 'bot1', routed=True)
    assert [row['cert_common_names'] for row in rules['subjects']] == [['router:hub']]
    said = allowed(rules, 'router:hub', 'ingress', 'put')
    assert 'mhri/bot1/host:lab/down/**' in said and 'mhri/bot1/watch:gallery/down/_beat' in said
    assert not [key for key in said if 'bot2' in key]


@pytest.mark.parametrize('own, side', [('host:lab', 'router'), ('router:hub', 'host'),
                                       ('router:hub', 'robot')])
def test_the_key_of_a_router_is_for_a_router(own, side):
    with pytest.raises(KeysError, match='the key in place is that of ' + own):
        check_own(Keys(own), side, 'bot1')
    check_own(Keys('router:hub'), 'router', '')
