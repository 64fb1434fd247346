# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a session keeps before it begins, where its lines come from, what a screen says of it."""
from dataclasses import replace

import pytest

from mhri.base.accessories import (
    Accessory, ACTION, Feedback, READOUT, SERVICE, TOGGLE)
from mhri.base.robot_types import Limits, RobotType
from mhri.events.events import KINDS, MARKED
from mhri.recording.folder import KINDS as LINES
from mhri.session.lines import GraphWatch, line_of_screen
from mhri.session.ring import Chunk, Latched, Ring
from mhri.session.topics import (
    accessory_commands, camera_topics, inputs_of, robot_entry, robot_topics)

S = 10 ** 9
KIND = RobotType('x', 'X', 'generic', Limits(1.0, 1.0), command=('cmd_vel',), imu=('imu',),
                 odometry=('odom', '/abs/odom'), rgb=('camera/image_raw',), battery=('battery',))


class Publisher:
    def __init__(self, latching=False):
        self.fields = {'latching': '1'} if latching else {}


def chunk(publisher, *at_s, size=10):
    return Chunk([(publisher, round(at * S), b'%g' % at) for at in at_s], size)


def test_the_ring_keeps_what_is_new():
    ring = Ring(10.0, 1000, Latched())
    for second in range(30):
        ring.put(chunk(Publisher(), second, second + 0.5))
    kept = list(ring.take())
    assert [part.begun_ns for part in kept] == [second * S for second in range(20, 30)]
    assert ring.size == 0 and list(ring.take()) == []


def test_the_ring_keeps_to_its_memory():
    ring = Ring(1000.0, 100, Latched())
    for second in range(30):
        ring.put(chunk(Publisher(), second, size=30))
    assert ring.size == 90 and len(list(ring.take())) == 3
    ring.put(chunk(Publisher(), 1.0, size=101))
    assert ring.size == 0


def test_what_is_latched_is_known_from_before_the_ring():
    latched, publisher, other = Latched(), Publisher(True), Publisher(True)
    ring = Ring(5.0, 1000, latched)
    ring.put(chunk(publisher, 0.0))
    ring.put(chunk(other, 1.0))
    ring.put(chunk(Publisher(), 1.5))
    ring.put(chunk(publisher, 20.0))
    assert latched.at(7) == [(publisher, 7, b'0'), (other, 7, b'1')]
    heads = []
    for part in ring.take():
        heads.append((part.begun_ns, latched.at(part.begun_ns)[0][2]))
    assert heads == [(20 * S, b'0')]
    assert latched.at(7)[0] == (publisher, 7, b'20')
    latched.forget(publisher)
    assert latched.at(7) == [(other, 7, b'1')]


def test_topics_of_a_robot():
    topics = robot_topics('bot1', KIND)
    assert topics[:4] == ('/bot1/odom', '/abs/odom', '/bot1/imu', '/bot1/battery')
    assert '/bot1/cmd_vel' in topics and '/bot1/mhri_guard/command' in topics
    assert not any('camera' in topic for topic in topics)
    assert camera_topics('bot1', KIND) == ('/bot1/camera/image_raw/compressed',)
    assert inputs_of(['/a', '/mux_in/lab', '/mux_in/joy']) == ('/mux_in/joy', '/mux_in/lab')


def test_topics_of_accessories():
    """Those that command one are not replayed."""
    specs = (Accessory('lamp', key='lamp', kind=TOGGLE, state=Feedback('lamp_state')),
             Accessory('grip', key='grip', way=ACTION), Accessory('horn', key='horn', way=SERVICE),
             Accessory('gas', key='gas', kind=READOUT))
    kind = replace(KIND, accessories=specs)
    commands = ('/bot1/lamp', '/bot1/grip/goal', '/bot1/grip/cancel')
    assert accessory_commands('bot1', kind) == commands
    assert set(robot_topics('bot1', kind)) - set(robot_topics('bot1', KIND)) == {
        *commands, '/bot1/grip/result', '/bot1/lamp_state', '/bot1/gas'}


def test_the_entry_of_a_robot_names_what_is_published():
    entry = robot_entry('bot1', 3, KIND, {'a': {'b': [1, b'x']}}, {'/abs/odom'})
    assert entry['topics'] == {
        'odometry': '/abs/odom', 'imu': '/bot1/imu', 'battery': '/bot1/battery',
        'rgb': '/bot1/camera/image_raw/compressed', 'command': '/bot1/cmd_vel'}
    raw = {'/bot1/camera/image_raw', '/bot1/battery'}
    assert robot_entry('bot1', 3, KIND, {}, raw)['topics']['rgb'] == entry['topics']['rgb']

    assert (entry['number'], entry['type'], entry['model']) == (3, 'x', None)
    assert entry['parameters'] == {'a': {'b': [1, "b'x'"]}}


def test_found_topics_are_kept_for_the_replay():
    """There, only what the parameters say is known of a robot."""
    kind = replace(KIND, odometry=KIND.odometry + ('odometry/filtered',), found=('odometry',))
    entry = robot_entry('bot1', 3, kind, {'mhri': {'radius_m': 0.4}}, {'/bot1/odometry/filtered'})
    assert entry['topics']['odometry'] == '/bot1/odometry/filtered'
    assert entry['parameters']['mhri'] == {'radius_m': 0.4, 'odometry': list(kind.odometry)}


@pytest.mark.parametrize('kind', sorted(KINDS))
def test_every_event_of_a_screen_has_a_kind_or_is_seen_elsewhere(kind):
    line = line_of_screen(kind, KINDS[kind][0], 'bot1', 'words', '{"task": "goto", "code": []}')
    assert line is None or (line[0] in LINES and line[2:] == (
        'bot1', 'words', {'code': kind, 'task': 'goto'}))
    here = kind.startswith(('mode.', 'drive.', 'control.', 'session.')) or kind in (
        'stop.engaged', 'stop.released')
    assert (line is None) == here


def test_a_screen_says_at_which_robot_a_mark_was_made():
    assert line_of_screen(MARKED, 'calm', 'bot2', 'mark 3', '{"mark": "m3"}') == (
        'event', 'info', 'bot2', 'mark 3', {'mark': 'm3', 'code': MARKED})
    assert line_of_screen(MARKED, 'calm', '', 'mark 3', '{"mark": "m3"}') is None


@pytest.mark.parametrize('data', [
    '{', '[1]', 'null', '[' * 99999, '{"a": {"b": 1}, "c": [1], "d": null}'])
def test_of_strange_data_nothing_is_kept(data):
    assert line_of_screen('link.back', 'calm', 'bot1', 'back', data)[4] == {'code': 'link.back'}


def test_lines_of_the_graph_come_once():
    watch = GraphWatch()
    assert watch.mode('joy') == watch.mode('joy') == []
    assert GraphWatch().stop(True)[0][:2] == ('stop', 'warning'), 'in force at the start'
    assert [(line[0], line[4]) for line in watch.mode('pedal')] == [('mode', {'mode': 'pedal'})]
    assert watch.stop(False) == [] and watch.stop(True)[0][1] == 'warning'
    assert watch.stop(True) == [] and watch.stop(False)[0][4] == {'stop_all': False}
    assert watch.selection([]) == []
    assert watch.selection(['a', 'b'])[0][4] == {'selected': ['a', 'b']}
    assert watch.selection(['a', 'b']) == [] and watch.selection([])[0][4] == {'selected': []}
    assert watch.control('', '') == []
    line, = watch.control('/panel', 'pc')
    assert 'pc' in line[3] and line[4] == {'operator': '/panel'}
    assert watch.operator == '/panel' and watch.control('', '')[0][4] == {'operator': ''}
    assert watch.state() == {'mode': 'pedal', 'stop_all': False, 'operator': '', 'selected': []}


def test_silence_is_told_once_and_so_is_its_end():
    watch = GraphWatch()
    watch.selection(['b'])
    assert watch.silence({'a': (0.1, 1.0), 'b': (0.1, 1.0), 'c': (99.0, 0.0)}, 10.0) == []
    lost = watch.silence({'a': (2.0, 1.0), 'b': (2.0, 1.0)}, 12.0)
    assert [(line[0], line[1], line[2]) for line in lost] == [
        ('lost', 'warning', 'a'), ('lost', 'error', 'b')]
    assert watch.silence({'a': (3.0, 1.0)}, 13.0) == []
    line, = watch.silence({'a': (0.0, 1.0)}, 15.0)
    assert line[:3] == ('link', 'info', 'a') and '5 s' in line[3]
    assert line[4] == {'code': 'link.back'}


def test_faults_on_request_are_told_with_their_end():
    watch, slow, silent = GraphWatch(), 'delay each way 0.4 s', 'laser silent'
    assert watch.faults('a', '') == []
    line, = watch.faults('a', slow)
    assert line[:3] == ('fault', 'warning', 'a') and line[4] == {'fault': slow}
    assert watch.faults('a', slow) == watch.faults('b', '') == []
    assert [line[1::3] for line in watch.faults('a', silent)] == [
        ('warning', {'fault': silent}), ('info', {'over': slow})]
    assert [line[4] for line in watch.faults('b', silent)] == [{'fault': silent}]
    assert [line[1::3] for line in watch.faults('a', '')] == [('info', {'over': silent})]
    assert len(watch.faults('c', 'x\x1b' * 99 + '\n' + 'many\n' * 99)) == 20
