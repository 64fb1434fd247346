# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a session: names, lines, session.yaml."""
from datetime import datetime
import json

import pytest

from mhri.recording.folder import (
    bag_name, bag_number, bags_of, event_line, folder_name, free_names, info_text, is_folder_name,
    marks_of, next_bag, NotASession, read_events, read_info, robots_of, SessionEvent, SessionInfo,
    sessions_home, still_name, with_notes, words_of_still)

WHEN = datetime(2026, 3, 1, 14, 3, 22)
NAME = '2026-03-01-14-03-22'


def test_a_folder_is_called_after_its_beginning_and_never_as_another():
    assert sessions_home({'ROS_HOME': '/r'}) == '/r/mhri/sessions'
    assert folder_name(WHEN) == NAME
    names = free_names(NAME)
    assert [next(names) for _ in range(3)] == [NAME, NAME + '-2', NAME + '-3']
    assert is_folder_name(NAME) and is_folder_name(NAME + '-12')
    assert not is_folder_name('2026') and not is_folder_name(NAME + '.old')


def test_bags_are_counted_whether_closed_or_not():
    names = ['0002.bag.active', 'session.yaml', '0001.bag', '0000.bag', '0000.bag.active', 'x.bag']
    assert bags_of(names) == ('0000.bag', '0001.bag', '0002.bag.active')
    assert [bag_number(name) for name in names] == [2, None, 1, 0, 0, None]
    assert bag_name(7) == '0007.bag' and bag_number(bag_name(12345)) == 12345
    assert next_bag(names) == 3 and next_bag([]) == 0


def test_a_still_is_named_so_that_it_stays_in_the_folder():
    assert still_name('m1', 'bot1') == 'stills/m1_bot1.jpg'
    assert still_name('../m', '/a/../b') == 'stills/---m_a----b.jpg'
    assert still_name('m1', 'bot1', True) == 'stills/m1_bot1-depth.jpg'
    assert words_of_still('stills/m1_a_b.jpg') == 'a_b'
    assert words_of_still('stills/m1_a_b-depth.jpg') == 'a_b, depth'


def test_events_come_back_as_they_were_written():
    events = [SessionEvent(1.5, 2.5, 'mark', 'mark 1', data={'id': 'm1', 'poses': {}}),
              SessionEvent(2.0, 3.0, 'link', 'gone\nfor “good”', 'warning', 'bot1')]
    text = ''.join(map(event_line, events))
    assert text.count('\n') == 2
    assert read_events(text) == events
    assert set(json.loads(text.splitlines()[0])) == {
        'wall', 'ros', 'kind', 'severity', 'robot', 'text', 'data'}


@pytest.mark.parametrize('line', [
    '', '{"wall": 1', 'null', '[1]', '{}', '{"wall": "x", "ros": 1, "kind": "", "text": ""}',
    '{"wall": NaN, "ros": 1, "kind": "", "text": ""}', '[' * 100000],
    ids=lambda line: line[:20])
def test_what_is_no_event_is_left_out(line):
    whole = event_line(SessionEvent(1.0, 1.0, 'mode', 'pad'))
    assert len(read_events(whole + line)) == 1
    assert len(read_events(whole + line + '\n' + whole)) == 2


def test_what_no_page_may_have_in_it_is_not_read():
    text = event_line(SessionEvent(1.0, 1.0, 'note', 'a\0b\x1b[31m\ud800\tc\nd',
                                   data={'k\0': ['\0']}))
    event, = read_events(text)
    assert event.text == 'a\ufffdb\ufffd[31m\ufffd\tc\nd'
    assert event.data == {'k\ufffd': ['\ufffd']}
    assert event.text.encode()


def test_a_note_to_no_mark_is_left_out():
    mark = SessionEvent(1.0, 1.0, 'mark', 'mark 1', data={'id': 'm1'})
    notes = [SessionEvent(2.0, 2.0, 'note', 'to none', data={'mark': name})
             for name in (['m1'], {}, None, 'm2')]
    found, = marks_of([mark, *notes])
    assert found.text == 'mark 1'


def test_a_number_that_json_has_not_becomes_null():
    line = event_line(SessionEvent(1.0, 1.0, 'mark', '', data={'p': [float('nan'), (1.0,)]}))
    assert json.loads(line)['data'] == {'p': [None, [1.0]]}


def test_session_yaml_comes_back():
    info = SessionInfo(1700000000.25, '1.2.3', 'base', 'map', 'rate_hz', 2.0,
                       {'bot1': {'number': 1, 'type': 'generic', 'model': None,
                                 'parameters': {'a': 1}, 'topics': {'odometry': '/bot1/odom'}}})
    text = info_text(info)
    assert text.startswith('format: 1\n')
    assert read_info(text) == info
    assert read_info(text + 'later: 3\n') == info


@pytest.mark.parametrize('text, words', [
    ('', 'format'), ('[1', 'cannot be read'), ('format: 9', 'format 9'),
    ('format: 1', 'started'), ('format: 1\nstarted: {seconds: true}', 'started')])
def test_what_is_no_session_is_refused_with_the_reason(text, words):
    with pytest.raises(NotASession, match=words):
        read_info(text)


def test_robots_that_come_later_count():
    late = {'number': 2, 'topics': {}}
    info = SessionInfo(1.0, robots={'bot1': {'number': 1}})
    assert robots_of(info, [SessionEvent(1, 1, 'found', '', robot='bot2', data=late)]) == {
        'bot1': {'number': 1}, 'bot2': late}


def test_the_last_note_is_the_text_of_its_mark():
    events = [SessionEvent(1, 2, 'mark', 'mark 1', data={
                  'id': 'm1', 'poses': {'a': [0, 0, 0, 'map']}, 'stills': ['stills/m1_a.jpg']}),
              SessionEvent(3, 4, 'mark', 'mark 2', data={'id': 'm2'}),
              SessionEvent(4, 4, 'note', 'a door', data={'mark': 'm1'}),
              SessionEvent(5, 5, 'note', 'a red door', data={'mark': 'm1'}),
              SessionEvent(5, 5, 'note', 'of nothing', data={'mark': 'm9'})]
    first, second = marks_of(events)
    assert (first.id, first.wall, first.ros, first.text) == ('m1', 1, 2, 'a red door')
    assert first.stills == ('stills/m1_a.jpg',) and first.poses['a'][3] == 'map'
    assert second.text == 'mark 2' and second.stills == ()


MARK = SessionEvent(1, 1, 'mark', 'mark 3', robot='bot1', data={'id': 'm3'})


def test_a_mark_and_its_note_are_one_line():
    robot = SessionEvent(2, 2, 'event', 'mark 3, 1 still', robot='bot2', data={'mark': 'm3'})
    note = SessionEvent(3, 3, 'note', 'a red\ndoor', data={'mark': 'm3'})
    other = SessionEvent(4, 4, 'note', 'of nothing', data={'mark': 'm9'})
    assert [(event.text, event.robot) for event in with_notes([MARK, other])] == [
        ('mark 3', 'bot1'), ('of nothing', '')]
    line, = with_notes([MARK, robot, note])
    assert (line.text, line.robot, line.wall) == ('mark 3: a red door', 'bot2', 1)


@pytest.mark.parametrize('name, text, label', [
    ('m3', 'mark 3', '3'), ('m3', 'mark', '3'), ('m3', 'mark 4', '3 mark 4'),
    ('m12', 'a red door', '12 a red door'), ('m3', 'x' * 24, '3 ' + 'x' * 24),
    ('m3', 'x' * 25, '3 ' + 'x' * 23 + '\u2026'),
    ('m3', 'water on the floor, below the stairs', '3 water on the floor\u2026'),
    ('door', 'mark', 'door')])
def test_a_flag_has_the_first_words_of_the_note(name, text, label):
    mark, = marks_of([SessionEvent(1, 1, 'mark', text, data={'id': name})])
    assert mark.label == label
