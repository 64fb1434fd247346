# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the lines of a session recall of a moment: proofs of stops, tasks to continue, bad links."""
import pytest

from mhri.base.views import FlagView, PROOF_NOT_CONFIRMED, PROOF_STOPPED, ProofView
from mhri.recording.folder import SessionEvent
from mhri.session.history import SessionHistory


def line(ros, kind, text, severity='info', robot='bot1', **data):
    return SessionEvent(ros, ros, kind, text, severity, robot, data)


HISTORY = SessionHistory(reversed([
    line(1.0, 'stop', 'STOP ALL', 'warning', '', stop_all=True),
    line(1.2, 'stop', 'stopped in 80 ms', code='proof.stopped'),
    line(1.3, 'stop', 'stopped in 90 ms', 'warning', code='power.cut'),
    line(2.0, 'stop', 'over', robot='', stop_all=False),
    line(3.0, 'stop', 'STOP ALL', 'warning', '', stop_all=True),
    line(3.5, 'stop', 'no odometry arrives', 'error', code='proof.doubtful'),
    line(3.9, 'stop', 'standstill seen after 0.8 s', code='proof.stopped'),
    line(5.0, 'task', 'drive to started', carry_on=''),
    line(6.0, 'task', 'drive to: half of the way'),
    line(7.0, 'task', 'drive to taken over', carry_on='goto'),
    line(8.0, 'task', 'patrol started', carry_on=''),
    line(9.0, 'task', 'patrol stopped', carry_on=''),
    line(12.0, 'link', 'weak: 12 % lost', 'warning'),
    line(13.0, 'link', 'good again')]))


@pytest.mark.parametrize('now, proof', [
    (0.5, None), (1.1, None), (1.2, (PROOF_STOPPED, 'stopped in 80 ms')),
    (1.9, (PROOF_STOPPED, 'stopped in 80 ms')), (2.0, None), (3.1, None),
    (3.6, (PROOF_NOT_CONFIRMED, 'no odometry arrives')),
    (4.0, (PROOF_STOPPED, 'standstill seen after 0.8 s'))])
def test_a_stop_is_proved_as_it_was_then(now, proof):
    assert HISTORY.proof('bot1', now) == (ProofView(*proof) if proof else None)
    assert HISTORY.proof('bot2', now) is None


@pytest.mark.parametrize('now, key', [
    (4.0, ''), (6.5, ''), (7.0, 'goto'), (8.0, ''), (9.5, '')])
def test_a_task_that_was_interrupted_can_be_continued(now, key):
    assert HISTORY.interrupted('bot1', now) == key
    assert HISTORY.interrupted('bot2', now) == ''


def test_a_link_is_bad_until_it_is_good():
    assert [HISTORY.link_note('bot1', now) for now in (11.0, 12.5, 13.0)] == [
        '', 'weak: 12 % lost', '']


def test_a_flag_stands_from_its_mark_on_with_its_note():
    poses = {name: [x_m, 2.0, 0.0, 'map'] for x_m, name in enumerate(('a', 'b'), 1)}
    history = SessionHistory([
        line(1.0, 'mark', 'mark 1', robot='b', id='m1', poses=poses),
        line(2.0, 'note', 'a door', robot='', mark='m1'),
        line(3.0, 'mark', 'mark 2', robot='', id='m2', poses=poses),
        line(4.0, 'mark', 'mark 3', robot='c', id='m3', poses=poses)])
    assert [history.flags(now) for now in (0.5, 1.0)] == [(), (FlagView('1 a door', 2, 2, 'map'),)]
    # Of an old session the first robot counts; where one was is unknown, no other robot was.
    assert history.flags(9.0)[1:] == (FlagView('2', 1, 2, 'map'),)


def test_who_was_selected_is_known_without_any_message():
    lines = [SessionEvent(at_s, at_s, kind, '', data=data) for at_s, kind, data in (
        (1.0, 'start', {'selected': ['bot2']}), (2.0, 'selection', {'selected': ['bot1', 'bot2']}),
        (3.0, 'selection', {'selected': []}), (4.0, 'mode', {}))]
    history = SessionHistory(lines)
    assert [history.selected(now) for now in (0.5, 1.5, 2.5, 4.5)] == [
        None, ('bot2',), ('bot1', 'bot2'), ()]


def test_of_a_line_without_data_nothing_is_derived():
    history = SessionHistory([line(1.0, 'stop', 'STOP ALL', 'warning', ''),
                              line(1.2, 'stop', 'stopped in 80 ms'),
                              line(7.0, 'task', 'drive to taken over: you checked it')])
    assert history.proof('bot1', 2.0) is None and history.interrupted('bot1', 8.0) == ''
