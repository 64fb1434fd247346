# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor on robots with a master of their own: links, versions, keys, robots linked twice."""
from dataclasses import replace

import pytest

from mhri.doctor.facts import (
    ANSWERS, EARLY, FINE, KeysSeen, LinkNote, REFUSED, RUN_OUT, SILENT, Stream, UNRESOLVED,
    UNTIMELY, UNWELCOME)
from mhri.doctor.judgement import diagnose
from mhri.doctor.linked import links_of

from support.doctor_world import (
    BOT_IP, HOST_IP, IGNORE, ODOMETRY, TYPES, World)

END = '{}:7447'.format(BOT_IP)
BOTH = {'mhri': '1.0.0', 'zenoh': '1.5.1'}
LINK = '/bot1/mhri_link'
KINDS = {'/bot1/mhri_guard/command': 'geometry_msgs/TwistStamped',
         '/bot1/mhri_guard/echo': 'geometry_msgs/TwistStamped'}


def linked_world(**note):
    """Return a world in which bot1 has a master of its own, and its link says this of itself."""
    world = World()
    world.hosts[LINK] = HOST_IP
    del world.hosts['/bot1/base']
    world.kinds.update(KINDS)
    world.publish.update({'/bot1/odom': [LINK], '/bot1/mhri_guard/echo': [LINK],
                          '/bot1/mhri_guard/command': ['/mux']})
    world.subscribe.update({'/bot1/mhri_guard/command': [LINK],
                            '/bot1/mhri_guard/echo': ['/mux']})
    del world.publish['/bot1/cmd_vel'], world.subscribe['/bot1/cmd_vel']
    world.parameters['bot1']['mhri_link'] = {'link': dict(
        {'endpoint': END, 'router': False, 'secret': False, 'heard': 'yes', 'own': BOTH,
         'peer': BOTH}, **note)}
    return world


def wrong(world, reach='', keys=None):
    """Return the findings that are not fine."""
    facts = world.facts()
    facts = replace(facts, keys=keys or KeysSeen(), linked=tuple(
        replace(note, reach=reach) for note in links_of(facts.graph)))
    found = [item for item in diagnose(facts, TYPES, IGNORE) if item.severity != FINE]
    assert all(item.symptom and item.remedy for item in found)
    return found


def test_a_linked_robot_is_healthy():
    world = linked_world()
    assert wrong(world) == []
    facts = replace(world.facts(), linked=links_of(world.graph()))
    linked, = [item for item in diagnose(facts, TYPES, IGNORE) if item.check == 'linked']
    assert END in linked.problem


@pytest.mark.parametrize('note, reach, check, words', [
    # Not heard, and what its end shows of the reason.
    ({'heard': 'never'}, REFUSED, 'link_silent', 'never'),
    ({'heard': 'never'}, SILENT, 'link_silent', 'does not answer'),
    ({'heard': 'never'}, UNRESOLVED, 'link_silent', 'unknown here'),
    ({'heard': 'never'}, ANSWERS, 'link_silent', 'answers, but not for bot1'),
    ({'heard': 'no', 'endpoint': 'tls/1.2.3.4:5'}, '', 'link_silent', 'no longer'),
    ({'heard': 'never', 'router': True}, REFUSED, 'router_unreachable', 'the router 192.0.2.7:'),
    ({'heard': 'no', 'router': True}, SILENT, 'router_unreachable', 'does not answer'),
    ({'heard': 'never', 'router': True}, ANSWERS, 'link_silent', 'answers, but not for bot1'),
    # Keys that are not taken, and whose clock it is.
    ({'heard': 'never', 'secret': True}, EARLY, 'keys_clock', 'clock here'),
    ({'heard': 'no', 'secret': True}, RUN_OUT, 'keys_expired', 'its key has run out'),
    ({'heard': 'no', 'secret': True}, UNTIMELY, 'keys_clock', 'its clock'),
    ({'heard': 'never', 'secret': True}, UNWELCOME, 'keys_wrong', 'authorities'),
    # Sides that differ.
    ({'peer': {'mhri': '0.9.0', 'zenoh': '1.5.1'}}, '', 'link_versions', '1.0.0 here, 0.9.0 on'),
    ({'peer': {'mhri': '1.0.0', 'zenoh': '1.4.0'}}, '', 'zenoh_versions', '1.5.1 here, 1.4.0 on'),
    # Sides that cannot start.
    ({'heard': 'never', 'trouble': 'library', 'problem': 'the link needs the library zenoh'}, '',
     'zenoh_missing', 'the link needs the library zenoh'),
    ({'heard': 'never', 'trouble': 'endpoint', 'problem': '--connect: x is no endpoint'}, '',
     'link_endpoint', 'is no endpoint'),
    ({'heard': 'never', 'trouble': 'missing', 'problem': 'there is no own.key in /k: put it'}, '',
     'keys_missing', 'there is no own.key'),
    ({'heard': 'never', 'trouble': 'expired', 'problem': 'the key has run out: renew it'}, '',
     'keys_expired', 'has run out'),
    ({'heard': 'never', 'trouble': 'early', 'problem': 'the time of the key has not begun'}, '',
     'keys_clock', 'not begun'),
    ({'heard': 'never', 'trouble': 'wrong', 'problem': 'the key is of another authority'}, '',
     'keys_wrong', 'another authority'),
])
def test_one_ailment_is_one_finding(note, reach, check, words):
    found = wrong(linked_world(**note), reach)
    assert [item.check for item in found] == [check] and words in found[0].problem
    assert found[0].about == 'bot1'


def test_what_a_robot_lacks_that_is_not_heard_is_no_finding_of_its_own():
    world = linked_world(heard='never')
    del world.publish['/bot1/odom'], world.parameters['bot1']['robot_type']
    assert [item.check for item in wrong(world, SILENT)] == ['link_silent']


def test_silent_robots_are_named_with_their_keys_and_their_router():
    remedy = wrong(linked_world(heard='never', secret=True), ANSWERS)[0].remedy
    assert 'mhri_keys.sh check' in remedy and 'date' in remedy
    remedy = wrong(linked_world(heard='never', router=True), ANSWERS)[0].remedy
    assert 'turtle_remote.sh --link bot1 --router ' + END in remedy
    assert '--listen 0.0.0.0:7447 --keys off' in wrong(
        linked_world(heard='never', router=True), REFUSED)[0].remedy


@pytest.mark.parametrize('secret', [False, True])
@pytest.mark.parametrize('reach', [ANSWERS, REFUSED, SILENT])
def test_a_robot_without_a_key_is_told_to_listen_without(reach, secret):
    remedy = wrong(linked_world(heard='never', secret=secret), reach)[0].remedy
    assert ('turtle_remote.sh --link bot1 --keys off' in remedy) is not secret


def test_link_that_has_ended():
    world = linked_world(heard='yes')
    del world.hosts[LINK]
    for group in (world.publish, world.subscribe):
        for topic in [topic for topic, nodes in group.items() if LINK in nodes]:
            del group[topic]
    found = [item for item in wrong(world) if item.check == 'link_ended']
    assert 'side:=host name:=bot1 connect:=' + END in found[0].remedy


def test_robot_that_is_linked_and_on_this_master_too():
    world = linked_world()
    world.hosts['/bot1/base'] = BOT_IP
    world.publish['/bot1/odom'] = [LINK, '/bot1/base']
    found = {item.check: item for item in wrong(world)}
    assert set(found) == {'linked_twice', 'odometry_twice'}
    assert '/bot1/base' in found['linked_twice'].problem
    world.changed['/bot1/base'] = {'state': REFUSED}
    assert 'linked_twice' not in {item.check for item in wrong(world)}, 'a dead one is none'


def test_two_sides_for_one_robot():
    world = linked_world()
    world.hosts['/bot1/mhri_link_2'] = HOST_IP
    world.publish['/bot1/mhri_guard/echo'] = [LINK, '/bot1/mhri_link_2']
    assert [item.check for item in wrong(world)] == ['linked_twice']


def test_one_robot_by_two_names():
    world = linked_world()
    world.hosts['/bot2/mhri_link'] = HOST_IP
    world.publish['/bot2/mhri_link/state'] = ['/bot2/mhri_link']
    world.kinds['/bot2/mhri_link/state'] = 'std_msgs/String'
    world.parameters['bot2'] = {'mhri_link': {'link': {'endpoint': END, 'heard': 'never'}}}
    found = {item.check: item for item in wrong(world, ANSWERS)}
    assert set(found) == {'linked_twice', 'link_silent'}
    assert found['linked_twice'].about == 'bot1, bot2'


@pytest.mark.parametrize('cause, check', [
    ('missing', 'keys_missing'), ('expired', 'keys_expired'), ('early', 'keys_clock'),
    ('wrong', 'keys_wrong'), ('', 'keys_wrong')])
def test_keys_of_this_computer(cause, check):
    found = wrong(linked_world(), keys=KeysSeen('/k', 'the problem', cause=cause))
    assert [(item.check, item.about) for item in found] == [(check, 'this computer')]


def test_link_without_keys_where_there_is_an_authority():
    keys = KeysSeen(authority=True)
    assert [item.check for item in wrong(linked_world(), keys=keys)] == ['keys_missing']
    assert wrong(linked_world(secret=True), keys=keys) == []


def test_clock_of_a_robot_with_keys():
    world = linked_world(secret=True)
    world.streams['/bot1/odom'] = Stream(
        '/bot1/odom', LINK, ODOMETRY, 'same', LINK, '', 0.6, 20,
        tuple((100.0 + number, 100.0 + number - 86400.0) for number in range(20)))
    found = {item.check: item for item in wrong(world)}
    assert set(found) == {'keys_clock', 'clock_offset'}
    assert '1440 minutes behind' in found['keys_clock'].problem
    world.parameters['bot1']['mhri_link']['link']['secret'] = False
    assert {item.check for item in wrong(world)} == {'clock_offset'}


@pytest.mark.parametrize('parameters', [
    {'bot1': {'mhri_link': 3}}, {'bot1': {'mhri_link': {'link': 'x'}}}, {'bot1': 3}, {}])
def test_parameters_that_are_no_note(parameters):
    world = World()
    world.parameters = parameters
    assert links_of(world.graph()) == []


def test_parts_of_a_note_that_cannot_be_are_left_out():
    world = World()
    world.parameters = {'bot1': {'mhri_link': {'link': {
        'endpoint': 3, 'router': 'yes', 'heard': ['no'], 'own': 'x', 'more': 1}}}}
    assert links_of(world.graph()) == [LinkNote('bot1')]
