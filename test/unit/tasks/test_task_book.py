# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen knows of all tasks, in whatever order it is told; and in which words."""
from dataclasses import replace

import pytest
import yaml

from mhri.base.task_views import KindView, Progress, RunView, TasksView, TaskView
from mhri.base.task_words import NOT_RUNNING, start_problem
from mhri.base.views import Change, ControlView, ScreenView
from mhri.events.events import KINDS
from mhri.tasks.base import ENDS
from mhri.tasks.task_book import ANSWER_S, Goal, RESULT_S, TaskBook

SQUARE = (KindView('square', 'Square'),)
GOAL = Goal('square', ('bot1',), '{side: 1.0}')
ON = Progress('bot1', 'running', 'corner 2 of 4: 1.3 m to go', 4.3)
RUN = RunView('a', 'square', '{side: 1.0}', (ON,))


def ended(state, text='because', robot='bot1'):
    return (Progress(robot, state, text),)


@pytest.fixture
def book():
    made = TaskBook()
    made.on_list(SQUARE, (RUN,), 0.0)
    return made


def kinds_of(book):
    return [news.kind for news in book.take_news()]


def test_a_run_that_is_listed_has_begun_and_is_shown(book):
    assert book.take_news() == [Change('bot1', 'task.begun', 'square started', data={
        'task': 'square', 'carry_on': ''})]
    assert book.of('bot1') == TaskView('Square', ON.text, False, 4.3)
    assert book.of('bot2') is None and book.parts_of(('bot2', 'bot1')) == [('a', ())]
    assert book.view().label('square') == 'Square' and book.view().label('dance') == 'dance'


def test_feedback_renews_it_and_says_each_line_once(book):
    book.take_news()
    said = replace(ON, state='waiting', text='something is in its way',
                   said=('corner 1: x 1.00 m',))
    for _ in range(2):
        book.on_feedback('a', (said,))
    assert book.take_news() == [
        Change('bot1', 'task.said', 'square: corner 1: x 1.00 m')]
    assert book.of('bot1').waits
    book.on_feedback('unknown', (said,))
    assert kinds_of(book) == []


@pytest.mark.parametrize('state', ENDS)
@pytest.mark.parametrize('by', ['feedback', 'result', 'result first'])
def test_each_end_is_an_event_with_its_sentence_once(book, state, by):
    book.take_news()
    if by == 'feedback':
        book.on_feedback('a', ended(state))
    if by == 'result first':
        book.on_list(SQUARE, (), 1.0)
    book.on_result('a', '', ended(state))
    book.on_list(SQUARE, (), 2.0)
    book.on_result('a', '', ended(state))
    book.tick(2.0 + 2 * RESULT_S)
    (news,) = book.take_news()
    assert news.kind == 'task.' + state and news.kind in KINDS and news.robot == 'bot1'
    assert news.text.startswith('square ') and news.text.endswith(': because')
    assert book.of('bot1') is None and book.view().runs == ()


@pytest.mark.parametrize('state', ENDS)
def test_what_was_taken_or_stopped_can_be_continued_and_nothing_else(book, state):
    book.on_result('a', '', ended(state))
    left = book.left('bot1')
    assert book.take_news()[-1].data['carry_on'] == (left.key if left else '')
    if state in ('done', 'failed'):
        assert left is None
    else:
        assert (left.key, left.robots, left.parameters) == ('square', ('bot1',), '{side: 1.0}')


def test_what_is_asked_for_is_not_offered_meanwhile(book):
    book.on_result('a', '', ended('lost'))
    book.ask('b', GOAL, 1.0)
    assert book.left('bot1') is None
    book.on_result('b', 'no', ())
    assert book.left('bot1') is not None


@pytest.mark.parametrize('by', ['operator', 'somebody'])
def test_what_was_cancelled_is_not_offered_again(book, by):
    if by == 'operator':
        book.cancel('a')
    book.on_result('a', '', ended('stopped'), cancelled=by == 'somebody')
    assert book.left('bot1') is None


def test_who_is_ended_alone_is_not_offered_again_and_the_others_are(book):
    team = RunView('b', 'goto', '', tuple(replace(ON, robot=name) for name in ('x', 'y', 'z')))
    book.on_list(SQUARE, (RUN, team), 1.0, ('dock',))
    assert book.view().marks == ('dock',)
    assert book.parts_of(('x', 'bot1')) == [('a', ()), ('b', ('x',))]
    book.cancel('b', ('x',))
    book.cancel('b', ('y',))
    for name in ('x', 'y', 'z'):
        book.on_feedback('b', tuple(
            replace(one, state='stopped') if one.robot <= name else one for one in team.robots))
    assert [book.left(name) is None for name in ('x', 'y', 'z')] == [True, True, False]
    assert book.parts_of(('x', 'y', 'z')) == []


@pytest.mark.parametrize('newer_first', [True, False])
def test_another_task_ends_the_offer(book, newer_first):
    def begin():
        book.on_list(SQUARE, (RUN, RunView('b', 'goto', '', (ON,))), 1.0)

    def take():
        book.on_result('a', '', ended('taken_over', 'it got another task: goto'))
    for step in (begin, take) if newer_first else (take, begin):
        step()
    assert book.left('bot1') is None
    book.on_result('b', '', ended('done'))
    assert book.left('bot1') is None


def test_a_member_of_a_team_is_continued_alone_with_its_place_kept():
    book, two = TaskBook(), (ON, replace(ON, robot='bot2'))
    book.on_list(SQUARE, (RunView('a', 'goto', '{x: 1}', two),), 0.0)
    book.on_feedback('a', (ON, *ended('taken_over', robot='bot2')))
    assert book.of('bot1') and not book.of('bot2')
    left = book.left('bot2')
    assert (left.key, left.robots) == ('goto', ('bot2',))
    assert yaml.safe_load(left.parameters) == {'x': 1, 'team': ['bot1', 'bot2']}
    # And once more, when it is alone.
    book.on_list(SQUARE, (RunView('b', 'goto', left.parameters, (two[1],)),), 1.0)
    book.on_feedback('b', ended('taken_over', robot='bot2'))
    assert yaml.safe_load(book.left('bot2').parameters)['team'] == ['bot1', 'bot2']


def test_a_late_list_does_not_bring_back_what_has_ended(book):
    book.on_result('a', '', ended('done'))
    book.take_news()
    book.on_list(SQUARE, (RUN,), 3.0)
    assert book.of('bot1') is None and kinds_of(book) == []


@pytest.mark.parametrize('how', ['refused', 'silence'])
def test_a_goal_that_comes_to_nothing_is_refused_in_words(how):
    book = TaskBook()
    book.on_list(SQUARE, (), 0.0)
    book.ask('mine', GOAL, 0.0)
    if how == 'refused':
        book.on_result('mine', 'why it is refused', ())
        words = 'why it is refused'
    else:
        book.tick(ANSWER_S)
        assert kinds_of(book) == []
        book.tick(ANSWER_S + 0.1)
        words = 'square'
    (news,) = book.take_news()
    assert (news.robot, news.kind) == ('bot1', 'task.refused') and words in news.text
    book.tick(100.0)
    assert kinds_of(book) == []


def test_a_run_that_leaves_the_list_without_a_result_is_lost(book):
    book.take_news()
    book.on_list(SQUARE, (), 1.0)
    book.tick(1.0 + RESULT_S)
    assert book.of('bot1') is not None
    book.tick(1.1 + RESULT_S)
    assert kinds_of(book) == ['task.lost']


def test_when_who_runs_the_tasks_goes_every_run_is_lost_and_may_come_back(book):
    book.take_news()
    book.lose('it has ended')
    assert kinds_of(book) == ['task.lost'] and book.left('bot1').key == 'square'
    book.on_list(SQUARE, (RUN,), 5.0)
    assert kinds_of(book) == ['task.begun'] and book.left('bot1') is None


@pytest.mark.parametrize('panel, problem, robots, words', [
    ({}, '', ('bot1',), ''),
    ({}, '', (), 'robot'), ({}, NOT_RUNNING, ('bot1',), NOT_RUNNING),
    ({'stop_all': True}, '', ('bot1',), 'STOP ALL'), ({'answers': False}, '', ('bot1',), 'drive'),
    ({'control': ControlView(False, 'panel on pc2', '14:02')}, '', ('bot1',), 'panel on pc2')])
def test_why_no_task_can_be_started(panel, problem, robots, words):
    found = start_problem(ScreenView(**panel), TasksView(problem), robots)
    assert words in found and bool(found) == bool(words)
