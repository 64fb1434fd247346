# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the lines of a session recall of a moment: proofs of stops, tasks to continue, bad links."""
import pytest

from mhri.base.task_words import ended_as, ended_line
from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, ProofView
from mhri.recording.folder import SessionEvent
from mhri.session.recalled import newest, Recalled


def line(ros, kind, text, severity='info', robot='bot1'):
    return SessionEvent(ros, ros, kind, text, severity, robot, {})


RECALLED = Recalled(reversed([
    line(1.0, 'stop', 'STOP ALL', 'warning', ''),
    line(1.2, 'stop', 'stopped in 80 ms'),
    line(1.3, 'stop', 'motor power cut', 'warning'),
    line(2.0, 'stop', 'STOP ALL released', robot=''),
    line(3.0, 'stop', 'STOP ALL', 'warning', ''),
    line(3.5, 'stop', 'NOT CONFIRMED: it cannot be heard', 'error'),
    line(3.9, 'stop', 'standstill seen after 0.8 s'),
    line(5.0, 'task', 'drive to started'),
    line(6.0, 'task', 'drive to: half of the way'),
    line(7.0, 'task', 'drive to taken over: you checked it'),
    line(8.0, 'task', 'patrol started'),
    line(9.0, 'task', 'patrol stopped: it was cancelled'),
    line(10.0, 'task', 'patrol started'),
    line(11.0, 'task', 'patrol done: all rounds'),
    line(12.0, 'link', 'weak: 12 % lost', 'warning'),
    line(13.0, 'link', 'good again')]))


@pytest.mark.parametrize('now, proof', [
    (0.5, None), (1.1, None), (1.2, (PROOF_STOPPED, 'stopped in 80 ms')),
    (1.9, (PROOF_STOPPED, 'stopped in 80 ms')), (2.0, None), (3.1, None),
    (3.6, (PROOF_NOT_CONFIRMED, 'NOT CONFIRMED: it cannot be heard')),
    (4.0, (PROOF_STOPPED, 'standstill seen after 0.8 s'))])
def test_a_stop_is_proved_as_it_was_then(now, proof):
    assert RECALLED.proof('bot1', now) == (ProofView(*proof) if proof else None)
    assert RECALLED.proof('bot2', now) is None


@pytest.mark.parametrize('now, label', [
    (4.0, ''), (6.5, ''), (7.0, 'drive to'), (8.0, ''), (9.5, ''), (11.5, '')])
def test_a_task_that_was_interrupted_can_be_continued(now, label):
    assert RECALLED.interrupted('bot1', now) == label
    assert RECALLED.interrupted('bot2', now) == ''


def test_a_link_is_bad_until_it_is_good():
    assert [RECALLED.link_note('bot1', now) for now in (11.0, 12.5, 13.0)] == [
        '', 'weak: 12 % lost', '']


def test_who_was_selected_is_known_without_any_message():
    lines = [SessionEvent(at_s, at_s, kind, '', data=data) for at_s, kind, data in (
        (1.0, 'start', {'selected': ['bot2']}), (2.0, 'selection', {'robots': ['bot1', 'bot2']}),
        (3.0, 'selection', {'robots': []}), (4.0, 'mode', {}))]
    recalled = Recalled(lines)
    assert [recalled.selected(now) for now in (0.5, 1.5, 2.5, 4.5)] == [
        None, ('bot2',), ('bot1', 'bot2'), ()]


def test_nothing_is_newest_of_nothing():
    assert newest((), 1.0) is None and newest([(2.0, 'a')], 1.0) is None


@pytest.mark.parametrize('state, text', [
    ('done', ''), ('timeout', 'after 3 s: no way'), ('taken_over', 'you checked it')])
def test_how_a_task_ended_is_read_from_its_line(state, text):
    assert ended_as(ended_line('Drive to', state, text)) == ('drive to', state, text)


@pytest.mark.parametrize('text', ['square started', 'square: stopped: here', 'stopped: now', ''])
def test_other_lines_are_no_ends(text):
    assert ended_as(text) is None
