# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen knows of all tasks, in whatever order it is told; and in which words."""
from dataclasses import replace

import pytest
import yaml

from mhri.base.task_views import KindView, Progress, RunView, TasksView, TaskView
from mhri.base.task_words import (
    carry_on_line, ended_line, for_whom, interrupted_line, NOT_RUNNING, start_problem, task_line,
    task_lines)
from mhri.base.views import ControlView, PanelView, RobotView
from mhri.events.events import KINDS
from mhri.tasks.base import ENDS
from mhri.tasks.rows import TASKS
from mhri.tasks.task_book import ANSWER_S, Goal, RESULT_S, TaskBook, with_team

SQUARE = (KindView('square', 'Square'),)
GOAL = Goal('square', ('bot1',), '{side: 1.0}')
ON = Progress('bot1', 'running', 'corner 2 of 4: 1.3 m to go', 4.3)
RUN = RunView('a', 'square', '{side: 1.0}', (ON,))


def ended(state, text='because', robot='bot1'):
    return (Progress(robot, state, text),)


@pytest.fixture
def book():
    made = TaskBook()
    made.hear_list(SQUARE, (RUN,), 0.0)
    return made


def kinds_of(book):
    return [news.kind for news in book.take_news()]


def test_a_run_that_is_listed_has_begun_and_is_shown(book):
    assert book.take_news() == [('task.begun', 'bot1', 'square started')]
    assert book.of('bot1') == TaskView('Square', ON.text, False, 4.3)
    assert book.of('bot2') is None and book.parts_of(('bot2', 'bot1')) == [('a', ())]
    assert book.view().label('square') == 'Square' and book.view().label('dance') == 'dance'


def test_feedback_renews_it_and_says_each_line_once(book):
    book.take_news()
    said = replace(ON, state='waiting', text='something is in its way',
                   said=('corner 1: x 1.00 m',))
    for _ in range(2):
        book.hear_feedback('a', (said,))
    assert book.take_news() == [('task.said', 'bot1', 'square: corner 1: x 1.00 m')]
    assert book.of('bot1').waits
    book.hear_feedback('unknown', (said,))
    assert kinds_of(book) == []


@pytest.mark.parametrize('state', ENDS)
@pytest.mark.parametrize('by', ['feedback', 'result', 'result first'])
def test_each_end_is_an_event_with_its_sentence_once(book, state, by):
    book.take_news()
    if by == 'feedback':
        book.hear_feedback('a', ended(state))
    if by == 'result first':
        book.hear_list(SQUARE, (), 1.0)
    book.hear_result('a', '', ended(state))
    book.hear_list(SQUARE, (), 2.0)
    book.hear_result('a', '', ended(state))
    book.tick(2.0 + 2 * RESULT_S)
    (news,) = book.take_news()
    assert news.kind == 'task.' + state and news.kind in KINDS and news.robot == 'bot1'
    assert news.text.startswith('square ') and news.text.endswith(': because')
    assert book.of('bot1') is None and book.view().runs == ()


@pytest.mark.parametrize('state', ENDS)
def test_what_was_taken_or_stopped_can_be_continued_and_nothing_else(book, state):
    book.hear_result('a', '', ended(state))
    left = book.left('bot1')
    if state in ('done', 'failed'):
        assert left is None
    else:
        assert (left.key, left.robots, left.parameters) == ('square', ('bot1',), '{side: 1.0}')


def test_what_is_asked_for_is_not_offered_meanwhile(book):
    book.hear_result('a', '', ended('lost'))
    book.ask('b', GOAL, 1.0)
    assert book.left('bot1') is None
    book.hear_result('b', 'no', ())
    assert book.left('bot1') is not None


@pytest.mark.parametrize('by', ['operator', 'somebody'])
def test_what_was_cancelled_is_not_offered_again(book, by):
    if by == 'operator':
        book.cancel('a')
    book.hear_result('a', '', ended('stopped'), cancelled=by == 'somebody')
    assert book.left('bot1') is None


def test_who_is_ended_alone_is_not_offered_again_and_the_others_are(book):
    team = RunView('b', 'goto', '', tuple(replace(ON, robot=name) for name in ('x', 'y', 'z')))
    book.hear_list(SQUARE, (RUN, team), 1.0, ('dock',))
    assert book.view().marks == ('dock',)
    assert book.parts_of(('x', 'bot1')) == [('a', ()), ('b', ('x',))]
    book.cancel('b', ('x',))
    book.cancel('b', ('y',))
    for name in ('x', 'y', 'z'):
        book.hear_feedback('b', tuple(
            replace(one, state='stopped') if one.robot <= name else one for one in team.robots))
    assert [book.left(name) is None for name in ('x', 'y', 'z')] == [True, True, False]
    assert book.parts_of(('x', 'y', 'z')) == []


def test_a_task_that_could_not_be_ended_is_told(book):
    book.take_news()
    book.keep_on(('bot1',), 'nobody answers')
    assert book.take_news() == [
        ('task.refused', 'bot1', 'its task is not ended: nobody answers')]


@pytest.mark.parametrize('newer_first', [True, False])
def test_another_task_ends_the_offer(book, newer_first):
    def begin():
        book.hear_list(SQUARE, (RUN, RunView('b', 'goto', '', (ON,))), 1.0)

    def take():
        book.hear_result('a', '', ended('taken_over', 'it got another task: goto'))
    for step in (begin, take) if newer_first else (take, begin):
        step()
    assert book.left('bot1') is None
    book.hear_result('b', '', ended('done'))
    assert book.left('bot1') is None


def test_a_member_of_a_team_is_continued_alone_with_its_place_kept():
    book, two = TaskBook(), (ON, replace(ON, robot='bot2'))
    book.hear_list(SQUARE, (RunView('a', 'goto', '{x: 1}', two),), 0.0)
    book.hear_feedback('a', (ON, *ended('taken_over', robot='bot2')))
    assert book.of('bot1') and not book.of('bot2')
    left = book.left('bot2')
    assert (left.key, left.robots) == ('goto', ('bot2',))
    assert yaml.safe_load(left.parameters) == {'x': 1, 'team': ['bot1', 'bot2']}
    # And once more, when it is alone.
    book.hear_list(SQUARE, (RunView('b', 'goto', left.parameters, (two[1],)),), 1.0)
    book.hear_feedback('b', ended('taken_over', robot='bot2'))
    assert yaml.safe_load(book.left('bot2').parameters)['team'] == ['bot1', 'bot2']


@pytest.mark.parametrize('parameters', ['{x: 1', '[1]', ''])
def test_parameters_that_cannot_be_read_are_left_as_they_are(parameters):
    assert with_team(parameters, ('bot1',)) == parameters
    if parameters:
        assert with_team(parameters, ('bot1', 'bot2')) == parameters


def test_a_late_list_does_not_bring_back_what_has_ended(book):
    book.hear_result('a', '', ended('done'))
    book.take_news()
    book.hear_list(SQUARE, (RUN,), 3.0)
    assert book.of('bot1') is None and kinds_of(book) == []


def test_a_goal_that_ends_before_it_is_listed_is_told():
    book = TaskBook()
    book.ask('mine', GOAL, 0.0)
    book.hear_result('mine', '', ended('lost', 'the drive service does not know it'))
    assert book.take_news() == [
        ('task.lost', 'bot1', 'square lost: the drive service does not know it')]


@pytest.mark.parametrize('how', ['refused', 'silence'])
def test_a_goal_that_comes_to_nothing_is_refused_in_words(how):
    book = TaskBook()
    book.hear_list(SQUARE, (), 0.0)
    book.ask('mine', GOAL, 0.0)
    if how == 'refused':
        book.hear_result('mine', 'task square: side: 0.1 is too small', ())
        words = 'square not started: task square: side: 0.1 is too small'
    else:
        book.tick(ANSWER_S)
        assert kinds_of(book) == []
        book.tick(ANSWER_S + 0.1)
        words = 'square not started: the task service has not answered'
    assert book.take_news() == [('task.refused', 'bot1', words)]
    book.tick(100.0)
    assert kinds_of(book) == []


def test_a_result_nobody_here_asked_for_is_no_news():
    book = TaskBook()
    book.hear_result('of another', 'wrong', ())
    book.hear_result('of another', '', ended('done'))
    assert kinds_of(book) == []


def test_a_run_that_leaves_the_list_without_a_result_is_lost(book):
    book.take_news()
    book.hear_list(SQUARE, (), 1.0)
    book.tick(1.0 + RESULT_S)
    assert book.of('bot1') is not None
    book.tick(1.1 + RESULT_S)
    assert book.take_news() == [('task.lost', 'bot1', 'square lost: nobody said how it ended')]


def test_when_who_runs_the_tasks_goes_every_run_is_lost_and_may_come_back(book):
    book.take_news()
    book.lose('it has ended')
    assert kinds_of(book) == ['task.lost'] and book.left('bot1').key == 'square'
    book.hear_list(SQUARE, (RUN,), 5.0)
    assert kinds_of(book) == ['task.begun'] and book.left('bot1') is None


@pytest.mark.parametrize('task, words', [
    (TaskView('Square', 'corner 2 of 4: 1.3 m to go', False, 4.3),
     'square: corner 2 of 4, 1.3 m to go'),
    (TaskView('Hold', 'it stands'), 'hold: it stands'),
    (TaskView('Go to', 'turns to its heading', False, 0.04),
     'go to: turns to its heading, 0.0 m left'),
    (TaskView('Dance'), 'dance'),
    (TaskView('Square', 'something is in its way', True, 4.3),
     'square waits: something is in its way'),
    (TaskView('Square', 'waits for its odometry', True), 'square waits for its odometry')])
def test_how_it_is_getting_on(task, words):
    assert task_line(task) == words == task_lines(task)[0]
    assert [len(line) for line in task_lines(task)] == sorted(
        (len(line) for line in task_lines(task)), reverse=True)


def test_where_there_is_little_room_what_is_left_or_why_it_waits_is_said():
    assert task_lines(TaskView('Square', 'corner 2 of 4: 1.3 m to go'))[1:] == (
        'square, 1.3 m to go', '1.3 m to go')
    assert task_lines(TaskView('Square', 'something is in its way', True))[1:] == (
        'waits: something is in its way', 'something is in its way')


def test_the_words_of_an_end_and_of_going_on():
    assert interrupted_line('Go to') == 'go to interrupted'
    assert interrupted_line('Go to', 'C') == 'go to interrupted: press C to continue it'
    assert ended_line('Go to', 'taken_over', 'it is checked') == 'go to taken over: it is checked'
    assert carry_on_line('square') == carry_on_line('a task of a lab') \
        == 'begins anew from where it stands'
    for kind in TASKS:
        assert carry_on_line(kind.key)


@pytest.mark.parametrize('panel, problem, robots, words', [
    ({}, '', ('bot1',), ''),
    ({}, '', (), 'check a robot, or look at one'),
    ({}, NOT_RUNNING, ('bot1',), NOT_RUNNING),
    ({'stop_all': True}, '', ('bot1',), 'STOP ALL is in force: release it first'),
    ({'answers': False}, '', ('bot1',), 'the drive service does not answer'),
    ({'control': ControlView(False, 'panel on pc2 since 14:02')}, '', ('bot1',),
     'panel on pc2 drives: take control first')])
def test_why_no_task_can_be_started(panel, problem, robots, words):
    assert start_problem(PanelView(**panel), TasksView(problem), robots) == words


def test_for_whom_a_task_is_started():
    looked, checked = RobotView('bot1'), RobotView('bot2', selected=True)
    assert for_whom([]) == ('for nobody yet: check a robot, or look at one',)
    assert for_whom([looked])[0] == 'for bot1, which you look at'
    assert for_whom([checked, checked])[-1] == 'for 2 robots'
    assert 'unchecked first' in for_whom([checked])[0] and for_whom([checked])[-1] == 'for bot2'
